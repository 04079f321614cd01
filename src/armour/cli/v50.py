"""``armour v50``."""

from pathlib import Path
from typing import Annotated

import typer

from armour.cli.runner import (
    AsJson,
    Changes,
    PlotFile,
    check_outputs,
    print_json,
    print_quantities,
    print_table,
    read_scenario,
    write_plot,
)
from armour.errors import InputError, Problem


def v50(
    shots: Annotated[
        Path,
        typer.Argument(
            metavar="SHOTS",
            help='CSV file with the columns velocity_m_s and result ("partial" or "complete").',
            show_default=False,
        ),
    ],
    scenario: Annotated[
        Path | None,
        typer.Argument(metavar="[SCENARIO]", help="The same armour, for the model's limit.", show_default=False),
    ] = None,
    pairs: Annotated[
        int | None,
        typer.Option(min=1, help="Shots of each kind for the mean; left out: 5, 3 or 2.", show_default=False),
    ] = None,
    span_m_s: Annotated[
        float | None,
        typer.Option(
            "--span-m-s", min=0.0, max=1e4, help="Their greatest span; left out: MIL-STD-662F's.", show_default=False
        ),
    ] = None,
    confidence: Annotated[float, typer.Option(min=0.5, max=0.9999, help="Of the intervals.")] = 0.95,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Find the velocity that perforates every other time, from firing results."""
    from armour.reporting.tables import FIRING_COLUMNS, firing_fit_rows, firing_rows
    from armour.statistics.v50 import read_shots
    from armour.statistics.v50 import v50 as evaluate

    check_outputs(plot=plot, source=shots)
    if changes and scenario is None:
        raise InputError([Problem("v50", "--set", "changes a scenario, which is not given")])
    read = read_shots(shots)
    loaded = None if scenario is None else read_scenario(scenario, changes)
    result = evaluate(read, loaded, pairs=pairs, span_m_s=span_m_s, confidence=confidence)
    if as_json:
        print_json(result.to_dict())
    else:
        print_quantities(str(shots), firing_rows(result))
        print()
        print_table(FIRING_COLUMNS, firing_fit_rows(result), numbers=(1, 3))
        if result.separated:
            print("every complete penetration was faster than every partial one: any V50 between them is as likely")
        if result.model_ballistic_limit_m_s is not None:
            print(
                "the model's limit is deterministic: one velocity for one set of inputs, without the scatter of tests"
            )
    if plot is not None:
        from armour.reporting.plots import firing_figure

        write_plot(plot, firing_figure(read, result))
