"""``armour optimise``."""

from pathlib import Path
from typing import Annotated

from armour.cli.options import AsJson, Changes, PlotFile, ScenarioFile, flag, output
from armour.cli.runner import Answer, read_scenario, run, say_if_compiling, warnings_of


def optimise(
    scenario: ScenarioFile,
    refine: Annotated[bool, flag("--refine", "Also find the best design between the values of the grid.")] = False,
    csv: Annotated[
        Path | None, output("--csv", "Write the Pareto front or, where none is asked for, the frontier as CSV.")
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Find the lightest armour that defeats the threat.

    The scenario may have several threats, a catalogue of materials, and another quantity to minimise.
    """
    from armour.design.optimise import optimise as find
    from armour.reporting.table import csv_text
    from armour.reporting.tables.design import design_tables, frontier_table, pareto_table

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        say_if_compiling()
        result = find(loaded, refine=refine)
        thicknesses = ", ".join(f"{thickness:g}" for thickness in result.not_monotonic_mm)
        perforated = [f"a thicker ceramic was perforated on a back plate of {thicknesses} mm"] if thicknesses else []
        return Answer(
            data=result.to_dict,
            tables=lambda: design_tables(result),
            title=loaded.title,
            files=[lambda: csv_text(pareto_table(result) if result.pareto else frontier_table(result))],
            chart=lambda charts: charts.design_chart(result, loaded.title),
            warnings=[*perforated, *warnings_of(loaded, result.warnings)],
        )

    run(answer, reads=[scenario], writes=[csv], plot=plot, as_json=as_json)
