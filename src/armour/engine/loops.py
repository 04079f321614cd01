"""Loops over rows of arrays, which call the functions of the core: numba compiles them, or Python runs them."""

from typing import Any

from armour.core.run import run
from armour.core.search import find_ballistic_limit
from armour.core.state import Parameters

LOOP_NAMES = "impacts", "ballistic_limits"


def parameters_at(rows: Any, i: int) -> Parameters:
    """Return row i as `Parameters` of Python's own numbers."""
    return Parameters(*rows[i].tolist())


def impacts(rows: Any, velocities: Any, settings: Any, counts: Any, ends: Any) -> None:
    """Write the outcome and steps of each impact to ``counts``, the duration and final state to ``ends``."""
    V_arrest, dt, max_steps = settings
    for i in range(len(rows)):
        end = run(parameters_at(rows, i), float(velocities[i]), dt, V_arrest, max_steps, None)
        counts[i, 0], counts[i, 1] = end.outcome, end.steps
        ends[i, 0] = end.t
        ends[i, 1], ends[i, 2], ends[i, 3], ends[i, 4], ends[i, 5] = end.y


def ballistic_limits(rows: Any, settings: Any, counts: Any, ends: Any) -> None:
    """Write the runs of each search and whether it is resolved to ``counts``, its bracket to ``ends``."""
    velocities, tolerance, V_arrest, dt, max_steps = settings
    for i in range(len(rows)):
        limit = find_ballistic_limit(parameters_at(rows, i), velocities, tolerance, V_arrest, dt, max_steps)
        counts[i, 0], counts[i, 1] = limit.runs, limit.resolved
        ends[i, 0], ends[i, 1] = limit.low, limit.high
