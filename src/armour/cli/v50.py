"""``armour v50``."""

from pathlib import Path
from typing import Annotated

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, argument, number, option, probability
from armour.cli.runner import check_outputs, named_as_options, read_scenario, respond, warnings_of
from armour.cli.scenario_commands import LIMIT
from armour.errors import InputError, Problem
from armour.files import table_file


def v50(
    shots: Annotated[
        Path,
        argument(
            "SHOTS",
            'CSV file with the columns velocity_m_s and result ("partial" or "complete"). '
            "`armour init FILE.csv --from shots.csv` writes an example.",
            autocompletion=completion.tables,
        ),
    ],
    scenario: Annotated[
        Path | None,
        argument(
            "SCENARIO", "Scenario of the same armour, for the model's limit.", autocompletion=completion.scenarios
        ),
    ] = None,
    pairs: Annotated[
        int | None,
        option(
            "Shots of each kind in the mean, at least 1; by default 5, else 3, else 2.",
            "--pairs",
            parser=number("--pairs", int),
            metavar="NUMBER",
        ),
    ] = None,
    span_m_s: Annotated[
        float | None,
        option(
            "Largest span of these shots, m/s, at most 10,000, as specified for the test; by default 38.1, 27.4 or "
            "18.3 (125, 90 or 60 ft/s) for 5, 3 or 2 of each kind. 30.5 (100 ft/s) is usual, too.",
            "--span-m-s",
            parser=number("--span-m-s"),
            metavar="NUMBER",
        ),
    ] = None,
    confidence: Annotated[
        float,
        option(
            "Confidence of the intervals, 0.5 to 0.9999; by default 0.95.",
            "--confidence",
            parser=probability("--confidence"),
            metavar="PROBABILITY",
        ),
    ] = 0.95,
    prior: Annotated[
        bool, option("Add the posterior of V50, whose prior is the model's limit with its error.", "--prior")
    ] = False,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Estimate V50 from firing results."""
    if changes and scenario is None:
        raise InputError([Problem("v50", "--set", "changes a scenario, which is not given")])
    if prior and scenario is None:
        raise InputError([Problem("v50", "--prior", "is that of a scenario, which is not given")])
    check_outputs(plot=plot, force=force)
    file = table_file(shots)
    # Imported here, as what they need takes long to load.
    from armour.reporting.views import firing as view
    from armour.statistics import v50 as statistics

    read = statistics.read_shots(file, one_kind=prior)
    loaded = None if scenario is None else read_scenario(scenario, changes, LIMIT, what="the ballistic limit")
    with (
        progress("impacts", first="fitting") as count,
        named_as_options("v50", "pairs", "span_m_s", "confidence"),
    ):
        result = statistics.v50(
            read, loaded, pairs=pairs, span_m_s=span_m_s, confidence=confidence, prior=prior, on_progress=count
        )
    respond(
        result.to_dict(),
        view.tables(result),
        as_json=as_json,
        of=result._heading(),
        plot=plot,
        chart=lambda: view.chart(result),
        warnings=[] if loaded is None else warnings_of(loaded, result.warnings),
    )
