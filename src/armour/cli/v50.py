"""``armour v50``."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli.options import AsJson, Changes, OnlyPlotFile
from armour.cli.runner import Answer, read_scenario, run
from armour.errors import InputError, Problem


def v50(
    shots: Annotated[
        Path,
        typer.Argument(
            metavar="SHOTS",
            help='CSV file with the columns velocity_m_s and result ("partial" or "complete").',
            show_default=False,
        ),
    ],
    scenario: Annotated[
        Path | None,
        typer.Argument(
            metavar="SCENARIO", help="Scenario of the same armour, for the model's limit.", show_default=False
        ),
    ] = None,
    pairs: Annotated[
        int | None,
        typer.Option(min=1, help="Shots of each kind in the mean; by default 5, 3 or 2.", show_default=False),
    ] = None,
    span_m_s: Annotated[
        float | None,
        typer.Option(
            "--span-m-s",
            min=0.0,
            max=1e4,
            help="Largest span of these shots, m/s; by default that of MIL-STD-662F.",
            show_default=False,
        ),
    ] = None,
    confidence: Annotated[float, typer.Option(min=0.5, max=0.9999, help="Confidence of the intervals.")] = 0.95,
    plot: OnlyPlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Estimate V50 from firing results."""
    from armour.reporting.tables.statistics import v50_tables
    from armour.statistics import v50 as statistics

    if changes and scenario is None:
        raise InputError([Problem("v50", "--set", "changes a scenario, which is not given")])

    def answer() -> Answer:
        read = statistics.read_shots(shots)
        loaded = None if scenario is None else read_scenario(scenario, changes)
        result = statistics.v50(read, loaded, pairs=pairs, span_m_s=span_m_s, confidence=confidence)
        return Answer(
            data=result.to_dict,
            tables=lambda: v50_tables(result),
            title=str(shots),
            chart=lambda charts: charts.v50_chart(read, result),
        )

    run(answer, reads=[shots, scenario], plot=plot, as_json=as_json)
