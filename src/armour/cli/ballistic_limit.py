"""``armour ballistic-limit``."""

import sys

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


def ballistic_limit(
    scenario: ScenarioFile, plot: PlotFile = None, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Find the lowest impact velocity that perforates."""
    from armour.analysis.ballistic_limit import ballistic_limit as find_limit
    from armour.analysis.ballistic_limit import curve_velocities, residual_velocity_curve
    from armour.reporting.tables import CROSSING_COLUMNS, crossing_rows, limit_rows

    check_outputs(plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    result = find_limit(loaded)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, limit_rows(result))
    if not result.monotonic:
        print("the outcome is not monotonic: it changes more than once in the range", file=sys.stderr)
        if not as_json:
            print()
            print_table(CROSSING_COLUMNS, crossing_rows(result), numbers=(0, 1))
    warn(loaded, result.warnings)
    if plot is not None:
        from armour.reporting.plots import limit_figure

        curve = residual_velocity_curve(loaded, curve_velocities(result, loaded))
        write_plot(plot, limit_figure(result, curve, loaded.title))
