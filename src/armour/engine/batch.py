"""Compute impacts and ballistic limits of many armours, as arrays, in threads."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.core.search import SCAN_POINTS, RunSettings, scan
from armour.core.state import Parameters
from armour.engine import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Rows that a thread takes at a time, about 2 ms.
PORTIONS = {"impacts": 256, "ballistic_limits": 32}


class ImpactBatch(NamedTuple):
    """Results of n impacts, an array of shape (n,) each."""

    outcome: Ints  # an Outcome
    t: Floats  # duration, s
    Z: Floats  # state at the end, see armour.core.state.State
    L: Floats
    V: Floats
    W: Floats
    h: Floats
    steps: Ints  # number of time steps


class Brackets(NamedTuple):
    """Results of n searches for a ballistic limit, m/s; an array of shape (n,) each.

    If nothing in the range is stopped, or perforated, that end of the bracket is infinite.
    """

    stopped: Floats  # the end of the bracket that is stopped
    perforated: Floats  # the end of the bracket that perforates
    runs: Ints  # number of impacts computed
    resolved: NDArray[np.bool_]  # whether every run ended within the maximum number of steps


DEFAULT_SETTINGS = RunSettings(V_arrest=1.0, dt=0.0, max_steps=500_000)


def packed(armours: Sequence[Parameters]) -> Floats:
    """Pack the parameters of n armours into an array, (n, fields), with a column for each field of `Parameters`."""
    return np.array(armours, dtype=np.float64).reshape(len(armours), len(Parameters._fields))


def fields(rows: Floats) -> Any:
    """Return the columns of an array of `packed` parameters as `Parameters`: views of it, (n,)."""
    return Parameters(*rows.T)


def impacts(
    rows: Floats, velocities: Floats, settings: RunSettings = DEFAULT_SETTINGS, threads: int | None = None
) -> ImpactBatch:
    """Compute the impacts of n armours, see `packed`, at n velocities, m/s; see `armour.core.run.run`.

    By default, there is a thread on each core; the results do not depend on the number of threads.
    """
    counts, ends = _run_loop("impacts", [rows, velocities], _solver(settings), 6, threads)
    t, Z, L, V, W, h = ends.T
    return ImpactBatch(counts[:, 0], t, Z, L, V, W, h, counts[:, 1])


def ballistic_limits(
    rows: Floats,
    low: float,
    high: float,
    tolerance: float,
    settings: RunSettings = DEFAULT_SETTINGS,
    points: int = SCAN_POINTS,
    threads: int | None = None,
) -> Brackets:
    """Find the ballistic limits of n armours between two velocities; see `armour.core.search.find_ballistic_limit`.

    ``low``, ``high`` and ``tolerance`` are in m/s; ``points`` is the number of velocities of the scan.
    """
    velocities = np.array(scan(low, high, points), dtype=np.float64)
    velocities.flags.writeable = False
    counts, ends = _run_loop("ballistic_limits", [rows], (velocities, float(tolerance), *_solver(settings)), 2, threads)
    return Brackets(ends[:, 0], ends[:, 1], counts[:, 0], counts[:, 1] != 0)


def _solver(settings: RunSettings) -> tuple[float, float, int]:
    """Return the settings of the solver as compiled code needs them, with exactly these types."""
    return float(settings.V_arrest), float(settings.dt), int(settings.max_steps)


def _run_loop(
    name: str, inputs: list[Floats], settings: tuple[Any, ...], width: int, threads: int | None
) -> tuple[Ints, Floats]:
    """Run a loop of `armour.engine.loops` on portions of n rows, in threads; return what it writes.

    These are integers, (n, 2), and numbers, (n, width).

    The inputs are rows of parameters and, for impacts, velocities, m/s, which broadcast to (n,).
    """
    rows, *velocities = (np.ascontiguousarray(array, dtype=np.float64) for array in inputs)
    count = len(rows)
    inputs = [rows, *(np.ascontiguousarray(np.broadcast_to(column, count)) for column in velocities)]
    counts, ends = np.empty((count, 2), np.int64), np.empty((count, width))
    starts = range(0, count, PORTIONS[name])
    kernel = compiled.kernel(name, is_long=len(starts) > 1)

    def compute(start: int) -> None:
        part = slice(start, start + starts.step)
        kernel(*(array[part] for array in inputs), settings, counts[part], ends[part])

    if len(starts) > 1:
        with ThreadPoolExecutor(min(threads or available_cores(), len(starts))) as pool:
            list(pool.map(compute, starts))
    elif count:
        compute(0)
    return counts, ends


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    # os.process_cpu_count is new in Python 3.13; not every system can restrict a process to some cores.
    if not hasattr(os, "process_cpu_count") and hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return getattr(os, "process_cpu_count", os.cpu_count)() or 1
