"""``armour plan tests``."""

from os.path import exists
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, option
from armour.cli.runner import check_outputs, named_as_options, read_scenario, respond, say_if_compiling
from armour.cli.sweep import grid_of
from armour.errors import InputError, Problem
from armour.files import table_file

if TYPE_CHECKING:
    from armour.sweeps.cases import Cases, Grid

EXAMPLES = (
    "plan tests wilkins --candidates armour.ceramic_thickness_mm=4:12:1 "
    "--candidates armour.backing_thickness_mm=4:10:1 --scatter-percent 3",
    "plan tests wilkins --candidates armour.ceramic_thickness_mm=4:12:1 --tests wilkins.csv --law ceramic "
    "--csv next.csv --plot next.svg",
)
# Arguments of plan_tests that options give.
SETTINGS = ("candidates", "fit", "law", "number", "criterion", "measure", "scatter_percent", "cost", "prior")


def plan_of_tests(
    scenario: ScenarioFile,
    candidates: Annotated[
        list[str] | None,
        option(
            "Armours that can be tested: a key and its values, as MIN:MAX:STEP or V,V,..., repeated to span a grid; or "
            "a CSV file whose header names keys and, where targets differ in it, cost.",
            metavar="KEY=VALUES|FILE",
            autocompletion=completion.numbers,
        ),
    ] = None,
    fit: Annotated[
        list[str] | None,
        option(
            "Input to determine; may be given several times. By default the ceramic's flow stress.",
            metavar="INPUT",
            autocompletion=completion.inputs,
        ),
    ] = None,
    law: Annotated[
        Literal["constant", "ceramic", "backing", "product", "linear"] | None,
        option("Law of the ceramic's flow stress, as in calibrate.", metavar="LAW"),
    ] = None,
    made: Annotated[
        Path | None,
        option("CSV file of tests made before.", "--tests", metavar="FILE", autocompletion=completion.tables),
    ] = None,
    number: Annotated[int, typer.Option(help="Tests to plan, 1 to 200.")] = 4,
    criterion: Annotated[
        Literal["D", "I"],
        typer.Option(help="Smallest region of the inputs (D), or least variance of the limits of designs (I)."),
    ] = "D",
    design: Annotated[
        list[Path] | None,
        option(
            "Scenario of a design in question; may be given several times. By default SCENARIO.",
            metavar="SCENARIO",
            autocompletion=completion.scenarios,
        ),
    ] = None,
    measure: Annotated[
        Literal["limit", "outcome"],
        typer.Option(help="What a test measures: the ballistic limit, or the outcome of a shot."),
    ] = "limit",
    scatter_percent: Annotated[
        float | None,
        option("Standard deviation of a test, % of its ballistic limit; by default that of the tests made before."),
    ] = None,
    cost: Annotated[float | None, option("Cost of a test beside that of its target.")] = None,
    prior: Annotated[
        bool, option("Count the scenario's distributions of the fitted inputs as prior knowledge.", "--prior")
    ] = False,
    csv: Annotated[
        Path | None,
        option("Write the tests made before and the planned ones, to fill in, as CSV.", "--csv", metavar="FILE"),
    ] = None,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Choose the armours whose tests tell most of model inputs, or of the limit of a design."""
    from armour.planning.plan_tests import plan_tests, weighted_by
    from armour.reporting.table import csv_text
    from armour.reporting.views import planned_tests as view
    from armour.statistics.calibration import FLOW_STRESS
    from armour.statistics.measured import read_tests

    check_outputs(csv, plot=plot, force=force)
    reads = ("impact", "armour", "ballistic_limit", *(["uncertainty"] if prior else []))
    loaded = read_scenario(scenario, changes, reads)
    with named_as_options("plan_tests", *SETTINGS):
        source = _source(candidates or [])
    read = None if made is None else read_tests(table_file(made), loaded)
    designs = [read_scenario(path, None, reads) for path in design or []]
    say_if_compiling()
    with progress("armours") as count, named_as_options("plan_tests", *SETTINGS):
        result = plan_tests(
            loaded,
            source,
            fit or [FLOW_STRESS],
            law,
            number=number,
            tests=read,
            criterion=criterion,
            designs=designs,
            measure=measure,
            scatter_percent=scatter_percent,
            cost=cost,
            prior=prior,
            on_progress=count,
        )
    if read is not None and scatter_percent is not None and not read.weighted:
        read = weighted_by(read, scatter_percent / 100.0)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        files=[(csv, lambda: csv_text(view.form_table(result, read)))],
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=[f"warning: {loaded.file}: {warning}" for warning in result.warnings],
    )


def _source(candidates: list[str]) -> "Grid | Cases":
    """Return the candidates."""
    from armour.planning.plan_tests import COST, of_candidates
    from armour.sweeps.cases import Cases

    where = "command line", "--candidates"
    files = [text for text in candidates if "=" not in text]
    if not candidates:
        raise InputError([Problem(*where, "is missing and must be given")])
    if files and len(candidates) > 1:
        raise InputError([Problem(*where, "must be one CSV file, or keys with values")])
    if files and not files[0].endswith(".csv") and not exists(files[0]):
        raise InputError([Problem(*where, f'must be KEY=VALUES or a CSV file, found "{files[0]}"')])
    if files:
        return Cases(Path(files[0]), (COST,))
    with of_candidates():
        return grid_of("--candidates", candidates)
