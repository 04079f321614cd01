"""``armour simulate``."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli.options import AsJson, Changes, PlotFile, ScenarioFile, output
from armour.cli.runner import Answer, read_scenario, run, warnings_of


def simulate(
    scenario: ScenarioFile,
    velocity: Annotated[
        float | None,
        typer.Option(help="Impact velocity in place of the scenario's, m/s.", show_default=False),
    ] = None,
    history: Annotated[Path | None, output("--history", "Write the run over time as CSV.")] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Simulate one impact."""
    from armour.analysis.impact import simulate as find
    from armour.reporting.table import csv_text
    from armour.reporting.tables.impact import history_table, impact_tables

    def answer() -> Answer:
        more = {} if velocity is None else {"impact.velocity_m_s": velocity}
        loaded = read_scenario(scenario, changes, more)
        result = find(loaded, history=history is not None or plot is not None)
        return Answer(
            data=result.to_dict,
            tables=lambda: impact_tables(result),
            title=loaded.title,
            files=[lambda: None if result.history is None else csv_text(history_table(result.history))],
            chart=lambda charts: charts.impact_chart(result, loaded.title),
            warnings=warnings_of(loaded, result.warnings),
        )

    run(answer, reads=[scenario], writes=[history], plot=plot, as_json=as_json)
