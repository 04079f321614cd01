"""``armour optimise``."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli.runner import (
    AsJson,
    Changes,
    PlotFile,
    ScenarioFile,
    check_outputs,
    counting,
    print_json,
    print_quantities,
    print_table,
    read_scenario,
    tell_of_compiling,
    warn,
    write,
    write_plot,
)
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.design.optimisation import Column
    from armour.scenario.loading import Scenario


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
        typer.Option(metavar="FILE", help="Write the frontier, or the Pareto front, as CSV.", show_default=False),
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Find the best design: the lightest of the grid, or what the scenario's threats and catalogue ask for."""
    from armour.design.catalogue import asks_for_study
    from armour.design.optimisation import frontier_of
    from armour.design.optimisation import optimise as find_optimum
    from armour.reporting.tables import BEST_COLUMNS, DESIGN_COLUMNS, best_rows, design_rows, frontier_csv

    check_outputs(csv, plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    if asks_for_study(loaded):
        _study(loaded, csv, plot, as_json=as_json, asked=full_grid or refine)
        return
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
        from armour.reporting.plots import optimum_figure

        write_plot(plot, optimum_figure(result, loaded.title))


def _study(loaded: "Scenario", csv: Path | None, plot: Path | None, *, as_json: bool, asked: bool) -> None:
    """Answer what the scenario's threats and catalogue ask for."""
    from armour.design.catalogue import study
    from armour.reporting.tables import (
        MARGIN_COLUMNS,
        PAIR_COLUMNS,
        margin_rows,
        pair_rows,
        pareto_table,
        study_csv,
        study_rows,
    )

    if asked:
        message = "searches the grid of a scenario without threats and catalogue; leave it out"
        raise InputError([Problem("optimise", "--full-grid, --refine", message)])
    tell_of_compiling()
    result = study(loaded)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, study_rows(result))
        print()
        print_table(MARGIN_COLUMNS, margin_rows(result), numbers=(1, 2, 3))
        print()
        print_table(PAIR_COLUMNS, pair_rows(result), numbers=(2, 3, 4, 5, 6))
        if result.pareto:
            print()
            columns, rows = pareto_table(result)
            print_table(columns, rows, numbers=range(2, len(columns)))
    warn(loaded, result.warnings)
    if csv is not None:
        write(csv, study_csv(result))
    if plot is not None:
        from armour.reporting.plots import study_figure

        write_plot(plot, study_figure(result, loaded.title))
