"""``armour optimise``."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli.report import (
    AsJson,
    PlotFile,
    ScenarioFile,
    check_outputs,
    counting,
    print_json,
    print_table,
    tell_of_compiling,
    warn,
    write,
    write_plot,
)

if TYPE_CHECKING:
    from armour.optimisation import Column


def optimise(
    scenario: ScenarioFile,
    full_grid: Annotated[
        bool,
        typer.Option("--full-grid", help="Compute every design of the grid.", show_default=False),
    ] = False,
    refine: Annotated[
        bool,
        typer.Option("--refine", help="Also find the optimum between the grid's values.", show_default=False),
    ] = False,
    csv: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the frontier to a CSV file.", show_default=False),
    ] = None,
    plot: PlotFile = None,
    as_json: AsJson = False,
) -> None:
    """Find the lightest design of the grid that defeats the impact."""
    from armour.optimisation import frontier_of
    from armour.optimisation import optimise as find_optimum
    from armour.scenario import load_scenario
    from armour.tables import BEST_COLUMNS, DESIGN_COLUMNS, best_rows, design_rows, frontier_csv

    check_outputs(csv, plot=plot, source=scenario)
    loaded = load_scenario(scenario)
    columns: list[Column] = []
    tell_of_compiling()
    try:
        with counting("backing thicknesses") as show:

            def on_column(column: "Column", total: int) -> None:
                columns.append(column)
                show(total)

            result = find_optimum(loaded, full_grid=full_grid, refine=refine, on_column=on_column)
    except KeyboardInterrupt:
        if csv is not None and columns:
            write(csv, frontier_csv(frontier_of(columns)))
        raise
    if as_json:
        print_json(result.to_dict())
    else:
        print_table(DESIGN_COLUMNS, design_rows(result), numbers=(0, 1, 2))
        print()
        print_table(BEST_COLUMNS, best_rows(result), numbers=(1, 2, 3, 4))
    if result.not_monotonic_mm:
        backings = ", ".join(f"{backing:g}" for backing in result.not_monotonic_mm)
        print(f"a thicker ceramic was perforated on a backing of {backings} mm", file=sys.stderr)
    warn(loaded, result.warnings)
    if csv is not None:
        write(csv, frontier_csv(result.frontier))
    if plot is not None:
        from armour.plots import optimum_figure

        write_plot(plot, optimum_figure(result, loaded.title))
