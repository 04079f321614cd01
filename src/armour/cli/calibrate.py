"""``armour calibrate``."""

from pathlib import Path
from typing import Annotated, Literal, get_args

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, argument, one_of, option
from armour.cli.runner import check_outputs, named_as_options, read_scenario, respond, say_if_compiling
from armour.files import table_file

Law = Literal["constant", "ceramic", "backing", "product", "linear", "all"]


def calibrate(
    tests: Annotated[
        Path,
        argument(
            "TESTS",
            "CSV file of tests. Its columns are test (a name); armour.ceramic and other names and inputs that differ; "
            "and ballistic_limit_m_s, residual_velocity_m_s, residual_mass_g or outcome. "
            "`armour init FILE.csv --from wilkins.csv` writes an example.",
            autocompletion=completion.tables,
        ),
    ],
    scenario: ScenarioFile,
    fit: Annotated[
        list[str] | None,
        option(
            "Input to fit; may be given several times. By default the ceramic's flow stress.",
            metavar="INPUT",
            autocompletion=completion.inputs,
        ),
    ] = None,
    law: Annotated[
        Law | None,
        option(
            "Law of the ceramic's flow stress: constant, ceramic (linear in its thickness), backing (a power of "
            "the back plate's), product (a power of both), linear (in both), or all, to compare them; "
            "by default that of the scenario.",
            "--law",
            metavar="LAW",
            parser=one_of("--law", get_args(Law)),
            autocompletion=lambda: list(get_args(Law)),
        ),
    ] = None,
    prior: Annotated[
        bool, option("Count the scenario's distributions of the fitted inputs as prior knowledge.", "--prior")
    ] = False,
    library: Annotated[
        Path | None, option("Write a library file with the fitted entries.", "--write", metavar="LIB.toml")
    ] = None,
    fitted: Annotated[
        Path | None,
        option(
            "Write the scenario with the fitted entries and their uncertainty.", "--write-scenario", metavar="FILE.toml"
        ),
    ] = None,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Fit model inputs to tests."""
    check_outputs(library, fitted, plot=plot, force=force)
    reads = ("impact", "armour", "ballistic_limit", *(["uncertainty"] if prior else []))
    loaded = read_scenario(scenario, changes, reads)
    file = table_file(tests)
    # Imported here, as what they need takes long to load.
    from armour.reporting.views import calibration as view
    from armour.statistics import calibration
    from armour.statistics.calibration import FLOW_STRESS
    from armour.statistics.fitted_library import library_text, scenario_text
    from armour.statistics.measured import read_tests

    read = read_tests(file, loaded)
    say_if_compiling()
    with progress("tests") as count, named_as_options("calibrate", "fit", "law"):
        result = calibration.calibrate(read, loaded, fit or [FLOW_STRESS], law, prior=prior, on_progress=count)
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        files=[
            (library, lambda: library_text(result, read, loaded)),
            (fitted, lambda: None if fitted is None else scenario_text(result, read, loaded, fitted)),
        ],
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=[f"warning: {tests}: {warning}" for warning in result.warnings],
    )
