"""``armour ballistic-limit``."""

from armour.cli.options import AsJson, Changes, OnlyPlotFile, ScenarioFile
from armour.cli.runner import Answer, read_scenario, run, warnings_of


def ballistic_limit(
    scenario: ScenarioFile, plot: OnlyPlotFile = None, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Find the ballistic limit."""
    from armour.analysis import ballistic_limit as analysis
    from armour.reporting.tables.impact import limit_tables

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        result = analysis.ballistic_limit(loaded)
        velocities = analysis.curve_velocities(result, loaded)
        several = "the outcome is not monotonic: it changes more than once in the range"
        return Answer(
            data=result.to_dict,
            tables=lambda: limit_tables(result),
            title=loaded.title,
            chart=lambda charts: charts.limit_chart(
                result, analysis.residual_velocity_curve(loaded, velocities), loaded.title
            ),
            warnings=[*([] if result.monotonic else [several]), *warnings_of(loaded, result.warnings)],
        )

    run(answer, reads=[scenario], plot=plot, as_json=as_json)
