"""``armour uncertainty``."""

from typing import Annotated

import typer

from armour.cli.options import AsJson, Changes, OnlyPlotFile, ScenarioFile
from armour.cli.runner import Answer, read_scenario, run, say_if_compiling, warnings_of


def uncertainty(
    scenario: ScenarioFile,
    samples: Annotated[
        int | None,
        typer.Option(min=1, help="Number of samples in place of the scenario's.", show_default=False),
    ] = None,
    plot: OnlyPlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Propagate input uncertainty to the outcome and the ballistic limit."""
    from armour.reporting.tables.statistics import uncertainty_tables
    from armour.statistics.uncertainty import uncertainty as propagate

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes, {} if samples is None else {"uncertainty.samples": samples})
        say_if_compiling()
        result = propagate(loaded)
        return Answer(
            data=result.to_dict,
            tables=lambda: uncertainty_tables(result),
            title=loaded.title,
            chart=lambda charts: charts.uncertainty_chart(result, loaded),
            warnings=warnings_of(loaded, result.warnings),
        )

    run(answer, reads=[scenario], plot=plot, as_json=as_json)
