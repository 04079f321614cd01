"""``armour sensitivity``."""

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
    write_plot,
)


def sensitivity(
    scenario: ScenarioFile, plot: PlotFile = None, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Tell by how many per cent limit, residual velocity and least areal density change when an input grows by one."""
    from armour.reporting.tables import elasticity_columns, elasticity_rows, sensitivity_rows
    from armour.statistics.sensitivity import sensitivity as find

    check_outputs(plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    tell_of_compiling()
    result = find(loaded)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, sensitivity_rows(result))
        print()
        columns = elasticity_columns(result)
        print_table(columns, elasticity_rows(result), numbers=range(1, len(columns)))
    if plot is not None:
        from armour.reporting.plots import sensitivity_figure

        write_plot(plot, sensitivity_figure(result, loaded.title))
