"""``armour compare``."""

from armour.cli.options import AsJson, Changes, OnlyPlotFile, ScenarioFile
from armour.cli.runner import Answer, read_scenario, run, warnings_of


def compare(
    scenario: ScenarioFile, plot: OnlyPlotFile = None, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Compare the model with closed-form formulas."""
    from armour.analysis import comparison
    from armour.reporting.tables.comparison import comparison_tables

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        result = comparison.compare(loaded)
        return Answer(
            data=result.to_dict,
            tables=lambda: comparison_tables(result),
            title=loaded.title,
            chart=lambda charts: charts.comparison_chart(result, loaded.title),
            warnings=warnings_of(loaded, result.limit.warnings),
        )

    run(answer, reads=[scenario], plot=plot, as_json=as_json)
