"""Loops over rows of arrays for numba to compile; they call the functions of the core.

`armour.engine.cache` imports this module, and with it numba, when the engine is first used.
"""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
from numba import config, types
from numba.extending import overload_method, register_jitable

from armour.core import bounds, equations, events, rk4, roots, search, stages
from armour.core import run as core_run
from armour.core.run import run
from armour.core.state import Parameters

Kernel = Callable[..., None]

# Functions that only compiled code calls need no wrappers, and nothing here needs reference counts.
OPTIONS: Any = {"no_cfunc_wrapper": True, "_nrt": False}

# Called in every step: numba leaves them out of line by itself, which takes a fifth longer.
INLINED = stages.rates, rk4.step
# Make the functions of the core callable from compiled code.
for _module in (equations, stages, roots, rk4, events, bounds, core_run, search):
    for _function in vars(_module).values():
        if isinstance(_function, FunctionType) and _function.__module__ == _module.__name__:
            register_jitable(**OPTIONS, forceinline=_function in INLINED)(_function)


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
    V_arrest, dt, max_steps = settings
    for i in range(len(rows)):
        p = parameters_at(rows, i)
        end = run(p, velocities[i], dt, V_arrest, max_steps, None)
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
    """Do the same for the least ceramic thickness that stops each impact."""
    for i in range(len(rows)):
        found = search.find_least_ceramic_thickness(parameters_at(rows, i), velocities[i], *settings)
        counts[i, 0], counts[i, 1] = found.runs, found.resolved
        ends[i, 0], ends[i, 1] = -found.low, -found.high


_float, _int = types.float64, types.int64
_velocities = types.Array(_float, 1, "C", readonly=True)
_rows = types.Array(_float, 2, "C", readonly=True)
_counts, _ends = _int[:, ::1], _float[:, ::1]
_solver = types.Tuple((_float, _float, _int))
_scan = types.Tuple((_velocities, _float, _float, _float, _int))
_search = types.Tuple((_float, _float, _float, _float, _float, _int))

SIGNATURES: dict[str, tuple[Any, ...]] = {
    "impacts": (_rows, _velocities, _solver, _counts, _ends),
    "ballistic_limits": (_rows, _scan, _counts, _ends),
    "least_thicknesses": (_rows, _velocities, _search, _counts, _ends),
}


def compiled(name: str, folder: Path | None = None) -> Kernel:
    """Return a kernel: compiled or, with a folder, loaded from there if it is there, else kept there."""
    kernel: Kernel = globals()[name]
    if getattr(config, "DISABLE_JIT", False):
        return kernel
    # Numba makes so many objects that looking for garbage among them takes a tenth of the time.
    collecting = gc.isenabled()
    gc.disable()
    try:
        return compiled_function(kernel, types.void(*SIGNATURES[name]), folder, nogil=True)
    finally:
        if collecting:
            gc.enable()


def compiled_function(function: Callable[..., Any], signature: Any, folder: Path | None, **options: bool) -> Any:
    """Return a function compiled for a signature; see `compiled`."""
    njit: Any = numba.njit  # its stubs know neither of the options
    dispatcher = njit(error_model="numpy", **OPTIONS, **options)(function)
    if folder is not None:
        with numba_cache(folder):
            dispatcher.enable_caching()
    dispatcher.compile(signature)
    dispatcher.disable_compile()
    return dispatcher


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
