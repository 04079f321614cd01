"""``armour uncertainty``."""

from typing import Annotated

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
    warn,
    write_plot,
)


def uncertainty(
    scenario: ScenarioFile,
    samples: Annotated[
        int | None, typer.Option(min=1, help="Take the place of the scenario's.", show_default=False)
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Tell how sure the outcome and the ballistic limit are, under the scenario's distributions of inputs."""
    from armour.reporting.tables import ESTIMATE_COLUMNS, INDEX_COLUMNS, estimate_rows, index_rows, uncertainty_rows
    from armour.statistics.uncertainty import uncertainty as propagate

    check_outputs(plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes, {} if samples is None else {"uncertainty.samples": samples})
    tell_of_compiling()
    result = propagate(loaded)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, uncertainty_rows(result))
        print()
        print_table(ESTIMATE_COLUMNS, estimate_rows(result), numbers=(1,))
        print()
        print_table(INDEX_COLUMNS, index_rows(result), numbers=(1, 3, 5, 6))
        if loaded.uncertainty is not None and loaded.uncertainty.correlation:
            print("Sobol' indices are not defined for correlated inputs")
    warn(loaded, result.warnings)
    if plot is not None:
        from armour.reporting.plots import uncertainty_figure

        write_plot(plot, uncertainty_figure(result, loaded))
