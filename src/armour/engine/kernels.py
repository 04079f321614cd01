"""The loops of `armour.engine.loops`, compiled by numba.

`armour.engine.cache` imports this module, and with it numba, when the engine is first used.
"""

from pathlib import Path
from types import FunctionType
from typing import Any

import numba
from numba import config, types
from numba.extending import overload, register_jitable

from armour.core import equations, events, replaced, rk4, roots, search, stages, state
from armour.core import run as core_run
from armour.core.state import Parameters
from armour.engine import loops

# Functions that only compiled code calls need no wrappers, and nothing here needs reference counts.
OPTIONS: Any = {"no_cfunc_wrapper": True, "_nrt": False}

# Called in every step: numba would not inline them by itself, which takes a fifth longer.
INLINED = stages.rates, rk4.step
# Make the functions of the core callable from compiled code.
for _module in (state, equations, stages, roots, rk4, events, core_run, search):
    for _function in vars(_module).values():
        if isinstance(_function, FunctionType) and _function.__module__ == _module.__name__:
            register_jitable(**OPTIONS, forceinline=_function in INLINED)(_function)


@overload(loops.parameters_at, jit_options=OPTIONS, strict=False)
def compiled_parameters_at(rows: Any, i: Any) -> Any:  # noqa: ARG001 (numba gives types, by these names)
    """Compile `loops.parameters_at`: numba cannot convert an array to a list."""
    return lambda rows, i: Parameters(
        rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5], rows[i, 6], rows[i, 7], rows[i, 8],
        rows[i, 9], rows[i, 10], rows[i, 11], rows[i, 12], rows[i, 13], rows[i, 14], rows[i, 15], int(rows[i, 16]),
    )  # fmt: skip


@overload(replaced.is_unchanged, jit_options=OPTIONS)
def compiled_is_unchanged() -> Any:
    """Compile `replaced.is_unchanged`: Python runs the loops where a function is replaced."""
    return lambda: True


_float, _int = types.float64, types.int64
_velocities = types.Array(_float, 1, "C", readonly=True)
_rows = types.Array(_float, 2, "C", readonly=True)
_counts, _ends = _int[:, ::1], _float[:, ::1]
_solver = types.Tuple((_float, _float, _int))
_scan = types.Tuple((_velocities, _float, _float, _float, _int))

SIGNATURES: dict[str, tuple[Any, ...]] = {
    "impacts": (_rows, _velocities, _solver, _counts, _ends),
    "ballistic_limits": (_rows, _scan, _counts, _ends),
}


def compiled(name: str, folder: Path | None = None) -> Any:
    """Compile a loop; with a folder, load its compiled code from there, or keep it there."""
    njit: Any = numba.njit  # its stubs lack both options
    kernel = njit(error_model="numpy", nogil=True, **OPTIONS)(getattr(loops, name))
    if folder is not None:
        # These settings belong to the whole process and are restored as soon as the kernel has its folder.
        settings: Any = config
        before = settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES
        settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = str(folder), "UserProvidedCacheLocator"
        kernel.enable_caching()
        settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = before
    kernel.compile(types.void(*SIGNATURES[name]))
    kernel.disable_compile()
    return kernel
