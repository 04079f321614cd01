"""``armour simulate``."""

from pathlib import Path
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
    warn,
    write,
    write_plot,
)


def simulate(
    scenario: ScenarioFile,
    velocity: Annotated[
        float | None,
        typer.Option(help="Impact velocity in place of the scenario's, m/s.", show_default=False),
    ] = None,
    history: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the run over time to a CSV file.", show_default=False),
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Run one impact: outcome, what is left of the projectile, and the stages passed through."""
    from armour.analysis.impact import simulate as run_simulation
    from armour.reporting.tables import STAGE_COLUMNS, history_csv, impact_rows, stage_rows

    check_outputs(history, plot=plot, source=scenario)
    more = {} if velocity is None else {"impact.velocity_m_s": velocity}
    loaded = read_scenario(scenario, changes, more)
    result = run_simulation(loaded, history=history is not None or plot is not None)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(loaded.title, impact_rows(result))
        print()
        print_table(STAGE_COLUMNS, stage_rows(result), numbers=(2, 3, 4, 5, 6))
    warn(loaded, result.warnings)
    if history is not None and result.history is not None:
        write(history, history_csv(result.history))
    if plot is not None:
        from armour.reporting.plots import impact_figure

        write_plot(plot, impact_figure(result, loaded.title))
