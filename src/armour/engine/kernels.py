"""Loops over rows of arrays for numba to compile; they call the functions of the core.

`armour.engine.cache` imports this module, and with it numba, when the engine is first used.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numba
from numba import config, types
from numba.extending import overload_method, register_jitable

from armour.core import bounds, equations, events, rk4, run, search, stages, state, stepping
from armour.core.state import Parameters

Kernel = Callable[..., None]


def make_callable(module: ModuleType) -> None:
    """Make the functions of a module callable from compiled code."""
    for function in vars(module).values():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            register_jitable(function)


for _module in (equations, state, stages, stepping, rk4, events, run, bounds, search):
    make_callable(_module)


@overload_method(types.NamedTuple, "_replace")
def replace_ceramic_thickness(p: Any, Hc0: Any) -> Any:  # noqa: ARG001 (numba gives types, by these names)
    """Compile `Parameters._replace` of the ceramic thickness, which numba does not know."""
    start = p.fields.index("Hc0")
    end = start + 1

    def replaced(p: Any, Hc0: Any) -> Any:
        return Parameters(*p[:start], Hc0, *p[end:])  # type: ignore[call-arg]

    return replaced


@register_jitable
def parameters_at(rows: Any, i: int) -> Parameters:
    """Return row i as `Parameters`."""
    r = rows[i]
    return Parameters(
        r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10], r[11], r[12], r[13], r[14], r[15], int(r[16])
    )  # fmt: skip


def impacts(rows: Any, velocities: Any, settings: Any, counts: Any, ends: Any) -> None:
    """Write the outcome and steps of each impact to ``counts``, the duration and final state to ``ends``."""
    V_arrest, given, max_steps = settings
    for i in range(len(rows)):
        p = parameters_at(rows, i)
        end = run.run(p, velocities[i], stepping.time_step(p, velocities[i], given), V_arrest, max_steps)
        counts[i, 0], counts[i, 1] = end.outcome, end.steps
        ends[i, 0] = end.t
        ends[i, 1], ends[i, 2], ends[i, 3], ends[i, 4], ends[i, 5] = end.y


def ballistic_limits(rows: Any, settings: Any, counts: Any, ends: Any) -> None:
    """Write the runs of each search and whether it is resolved to ``counts``, its bracket to ``ends``."""
    for i in range(len(rows)):
        found = search.find_ballistic_limit(parameters_at(rows, i), *settings)
        counts[i, 0], counts[i, 1] = found.runs, found.resolved
        ends[i, 0], ends[i, 1] = found.low, found.high


def least_thicknesses(rows: Any, velocities: Any, settings: Any, counts: Any, ends: Any) -> None:
    """Do the same for the least ceramic thickness that defeats each impact."""
    for i in range(len(rows)):
        found = search.find_least_ceramic_thickness(parameters_at(rows, i), velocities[i], *settings)
        counts[i, 0], counts[i, 1] = found.runs, found.resolved
        ends[i, 0], ends[i, 1] = -found.low, -found.high


_float, _int = types.float64, types.int64
_velocities = types.Array(_float, 1, "C", readonly=True)
_rows = types.Array(_float, 2, "C", readonly=True)
_counts, _ends = _int[:, ::1], _float[:, ::1]
_tuple: Any = types.Tuple
_solver = _tuple((_float, _float, _int))
_scan = _tuple((_velocities, _float, _float, _float, _int))
_search = _tuple((_float, _float, _float, _float, _float, _int))

SIGNATURES: dict[str, tuple[Any, ...]] = {
    "impacts": (_rows, _velocities, _solver, _counts, _ends),
    "ballistic_limits": (_rows, _scan, _counts, _ends),
    "least_thicknesses": (_rows, _velocities, _search, _counts, _ends),
}


def compiled(name: str, folder: Path | None = None) -> Kernel:
    """Return a kernel: compiled or, with a folder, loaded from there if it is there, else kept there."""
    function = globals()[name]
    kernel = numba.njit(nogil=True, error_model="numpy")(function)
    if kernel is not function:  # as numba's setting DISABLE_JIT makes it
        if folder is not None:
            with numba_cache(folder):
                kernel.enable_caching()
        kernel.compile(types.void(*SIGNATURES[name]))
        kernel.disable_compile()
    return kernel


@contextmanager
def numba_cache(folder: Path) -> Iterator[None]:
    """Make numba use a folder, and nothing else, for the functions whose caching is enabled within the context.

    The settings are those of the process: the context must be short, for the sake of other threads.
    """
    settings = {"CACHE_DIR": str(folder), "CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}
    before = {name: getattr(config, name) for name in settings}
    try:
        for name, value in settings.items():
            setattr(config, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(config, name, value)
