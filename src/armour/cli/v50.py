"""``armour v50``."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli import completion
from armour.cli.console import progress
from armour.cli.options import AsJson, Changes, Force, PlotFile, argument, option
from armour.cli.runner import check_outputs, read_scenario, respond, warnings_of
from armour.cli.scenario_commands import LIMIT
from armour.errors import InputError, Problem


def v50(
    shots: Annotated[
        Path,
        argument(
            "SHOTS",
            'CSV file with the columns velocity_m_s and result ("partial" or "complete").',
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
        int | None, option("Shots of each kind in the mean, at least 1; by default 5, else 3, else 2.")
    ] = None,
    span_m_s: Annotated[
        float | None,
        option(
            "Largest span of these shots, m/s, at most 10,000, as specified for the test; by default 38.1, 27.4 or "
            "18.3 (125, 90 or 60 ft/s) for 5, 3 or 2 of each kind. 30.5 (100 ft/s) is usual, too."
        ),
    ] = None,
    confidence: Annotated[float, typer.Option(help="Confidence of the intervals, 0.5 to 0.9999.")] = 0.95,
    plot: PlotFile = None,
    force: Force = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Estimate V50 from firing results."""
    from armour.reporting.tables.statistics import v50_tables
    from armour.statistics import v50 as statistics

    if changes and scenario is None:
        raise InputError([Problem("v50", "--set", "changes a scenario, which is not given")])
    check_outputs(plot=plot, force=force)
    read = statistics.read_shots(shots)
    loaded = None if scenario is None else read_scenario(scenario, changes, LIMIT)
    with progress("fits", first="fitting"):
        result = statistics.v50(read, loaded, pairs=pairs, span_m_s=span_m_s, confidence=confidence)
    respond(
        result.to_dict(),
        v50_tables(result),
        as_json=as_json,
        title=str(shots),
        plot=plot,
        chart=lambda charts: charts.v50_chart(read, result),
        warnings=[] if loaded is None else warnings_of(loaded, result.warnings),
    )
