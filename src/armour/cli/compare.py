"""``armour compare``."""

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
    warn,
    write_plot,
)


def compare(scenario: ScenarioFile, plot: PlotFile = None, changes: Changes = None, as_json: AsJson = False) -> None:
    """Put the model next to the closed forms of others: Florence's limit, Lambert-Jonas and Recht-Ipson fits."""
    from armour.analysis.comparison import compare as put_side_by_side
    from armour.reporting.tables import COMPARISON_COLUMNS, FIT_COLUMNS, comparison_rows, fit_rows

    check_outputs(plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    result = put_side_by_side(loaded)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, [("areal density", f"{result.areal_density_kg_m2:.2f}", "kg/m^2")])
        print()
        print_table(COMPARISON_COLUMNS, comparison_rows(result), numbers=range(1, 8))
        print()
        print_table(FIT_COLUMNS, fit_rows(result), numbers=(1, 2, 3))
        low, high = result.fitted_m_s
        print(f"fitted to the model's residual velocities of {low:.1f} to {high:.1f} m/s")
    warn(loaded, result.limit.warnings)
    if plot is not None:
        from armour.reporting.plots import comparison_figure

        write_plot(plot, comparison_figure(result, loaded.title))
