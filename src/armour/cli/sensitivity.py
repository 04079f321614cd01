"""``armour sensitivity``."""

from armour.cli.options import AsJson, Changes, OnlyPlotFile, ScenarioFile
from armour.cli.runner import Answer, read_scenario, run, say_if_compiling


def sensitivity(
    scenario: ScenarioFile, plot: OnlyPlotFile = None, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Rank the inputs by their effect on the answers.

    The effects are elasticities: the change of ballistic limit, residual velocity and least areal density, in per cent,
    when an input grows by 1 %.
    """
    from armour.reporting.tables.statistics import sensitivity_tables
    from armour.statistics.sensitivity import sensitivity as find

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        say_if_compiling()
        result = find(loaded)
        return Answer(
            data=result.to_dict,
            tables=lambda: sensitivity_tables(result),
            title=loaded.title,
            chart=lambda charts: charts.sensitivity_chart(result, loaded.title),
        )

    run(answer, reads=[scenario], plot=plot, as_json=as_json)
