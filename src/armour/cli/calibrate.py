"""``armour calibrate``."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from armour.cli.runner import (
    AsJson,
    Changes,
    PlotFile,
    ScenarioFile,
    check_outputs,
    print_json,
    print_quantities,
    print_table,
    read_scenario,
    tell_of_compiling,
    write,
    write_plot,
)


def calibrate(
    tests: Annotated[
        Path,
        typer.Argument(metavar="TESTS", help="CSV file of tests: inputs, and what was measured.", show_default=False),
    ],
    scenario: ScenarioFile,
    fit: Annotated[
        list[str] | None,
        typer.Option(metavar="INPUT", help="Input to fit; left out: ceramic.flow_stress_GPa.", show_default=False),
    ] = None,
    law: Annotated[
        Literal["constant", "linear", "proportional", "thicknesses"],
        typer.Option(help="The ceramic's flow stress: constant, or by the ceramic's or both thicknesses."),
    ] = "constant",
    library: Annotated[
        Path | None,
        typer.Option("--write", metavar="LIB.toml", help="Write a library with the entries.", show_default=False),
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Fit parameters of a material or projectile to tests, and say how well they are known."""
    from armour.reporting.tables import (
        COEFFICIENT_COLUMNS,
        RESIDUAL_COLUMNS,
        calibration_rows,
        coefficient_rows,
        correlation_table,
        residual_rows,
    )
    from armour.statistics.calibration import calibrate as find
    from armour.statistics.fitted_library import library_text
    from armour.statistics.flow_stress_laws import FLOW_STRESS
    from armour.statistics.test_data import read_tests

    check_outputs(library, plot=plot, source=tests)
    check_outputs(library, plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    read = read_tests(tests, loaded)
    tell_of_compiling()
    result = find(read, loaded, fit or [FLOW_STRESS], law)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, calibration_rows(result))
        print()
        print_table(COEFFICIENT_COLUMNS, coefficient_rows(result), numbers=(1,))
        if len(result.coefficients) > 1:
            print()
            columns, rows = correlation_table(result)
            print_table(columns, rows, numbers=range(1, len(columns)))
        print()
        print_table(RESIDUAL_COLUMNS, residual_rows(result), numbers=(3, 4, 5, 6))
    if library is not None:
        write(library, library_text(result, read, loaded))
    if plot is not None:
        from armour.reporting.plots import calibration_figure

        write_plot(plot, calibration_figure(result, loaded.title))
