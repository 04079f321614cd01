"""Read the cases of a sweep from options or a table, and run the command `sweep`."""

import os
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import armour
from armour.analysis.quantities import QUANTITIES, REQUIRED_QUANTITIES, VERDICT
from armour.cli import runner
from armour.cli.console import progress, say
from armour.errors import counted, mistake
from armour.reporting.views.sweeps import SWEEP_ROWS, first_rows, tables_of_sweep
from armour.scenario.scenario import Scenario
from armour.sweeps.cases import Grid, SweepCases
from armour.sweeps.sweep import Effort, result_of, sweep_in_memory, write_sweep
from armour.sweeps.tables import read_table

# Quantity of a table by default, and those shown without a table.
LIMIT = "ballistic_limit_m_s"
ANSWERED = (LIMIT, "expected_limit_m_s", "probability_of_stopping", VERDICT)
# Sweeps that take longer than this, s, are announced.
ANNOUNCED_S = 10.0


def cases_of(file: str | Path, sheet: str | None = None, keep: Sequence[str] = ()) -> SweepCases:
    """Open a table of cases, and say how it was read if that was not obvious; `sheet` is that of a workbook."""
    cases = SweepCases(file, sheet, keep)
    say(*[f"read {file}: {cases.read}"] * bool(cases.read))
    return cases


def write_and_show(
    scenario: Scenario,
    source: Grid | SweepCases,
    quantities: Sequence[str],
    output: Path,
    plot: Path | None,
    *,
    scheduler: str,
    replace: bool,
    yes: bool,
    as_json: bool,
) -> None:
    """Compute a sweep, write its rows to ``output`` and show them, and draw the first quantity to ``plot``.

    ``scheduler`` is the address of a cluster, if there is one.  A sweep that takes a while is announced; a large one is
    refused without ``yes``.
    """
    with ExitStack() as stack:
        count = stack.enter_context(progress("rows", source.count))
        workers = None
        if scheduler:
            from armour.sweeps.cluster import connected, workers_of  # imports Dask

            # Or else the processes that "local" starts would import modules from the current folder.
            os.environ["PYTHONSAFEPATH"] = "1"
            workers = stack.enter_context(workers_of(stack.enter_context(connected(scheduler))))

        def approve(effort: Effort) -> None:
            if effort.is_large and not yes:
                raise mistake("sweep", "", f"{effort.words}; add --yes to go on")
            if effort.seconds > ANNOUNCED_S:
                say(effort.words)

        callbacks: Any = {"approve": approve, "tell": say, "command": runner.command_line()}
        callbacks["on_chunk"] = lambda rows, stored: count(rows, stored=stored)
        write_sweep(scenario, source, quantities, output, workers=workers, replace=replace, **callbacks)
    say(f"wrote {output}: {counted(source.count, 'row')}", *_notes(quantities))
    shown = first_rows(read_table(output), scenario, source.keys) if source.count <= SWEEP_ROWS else []
    runner.show_answer({"rows": source.count, "output": str(output)}, shown, scenario, as_json=as_json)
    result = result_of(scenario, source, quantities, (), output=output)
    runner.write({plot: runner.picture(lambda: armour.plot(result), scenario)})


def show_rows(
    scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str], plot: Path | None, *, as_json: bool
) -> None:
    """Compute a sweep without a table to write, show its first rows, and draw the first quantity to ``plot``."""
    with progress("rows", source.count) as count:
        result = sweep_in_memory(scenario, source, quantities, None, 1000)  # at most so many rows
        count(source.count, None)
    data = {"rows": source.count, "output": None, "columns": result.to_dict()} if as_json else {}
    runner.show_answer(data, () if as_json else tables_of_sweep(result), scenario, as_json=as_json)
    warnings = [*_notes(quantities), *(f"warning: {note}" for note in result.notes)]
    runner.write({plot: runner.picture(lambda: armour.plot(result), scenario)}, warnings)


def _notes(names: Sequence[str]) -> list[str]:
    """Return a note on what "required_..." means if there are such quantities among these names, else none."""
    required = [name for name in names if QUANTITIES[name].on_grid]
    return [f"note: {', '.join(required)}: {REQUIRED_QUANTITIES}"] if required else []
