"""The loops of `armour.engine.loops`, compiled by numba.

`armour.engine.cache` imports this module, and with it numba, when the engine is first used.
"""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType
from typing import Any

from armour.core import equations, events, replaced, rk4, roots, search, stages, state
from armour.core import run as core_run
from armour.core.state import Parameters
from armour.engine import loops


@contextmanager
def _without_warning() -> Iterator[None]:
    """Let numba not warn that it ignores a file of settings in the current folder."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="A Numba config file is found")
        yield


# Numba ignores that file, which may be somebody else's, if it finds no parser of YAML.
_modules: dict[str, Any] = sys.modules
_yaml = _modules.get("yaml")
_modules["yaml"] = None
try:
    with _without_warning():
        import numba
        from numba import config, types
        from numba.extending import overload, register_jitable
finally:
    del _modules["yaml"]
    if _yaml:
        _modules["yaml"] = _yaml

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
        int(rows[i, 17]),
    )  # fmt: skip


@overload(replaced.is_unchanged, jit_options=OPTIONS)
def compiled_is_unchanged() -> Any:
    """Compile `replaced.is_unchanged`: Python runs the loops where something is replaced."""
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


class Locator:
    """Tells numba where the compiled code of a loop is; numba's own locators need to write there."""

    def __init__(self, path: str) -> None:
        self.path = path

    @classmethod
    def from_function(cls, _function: object, _file: str) -> "Locator":
        """Return the locator of a function."""
        return cls(config.CACHE_DIR)  # type: ignore[attr-defined]

    def get_cache_path(self) -> str:
        """Return the folder."""
        return self.path

    def ensure_cache_path(self) -> None:
        """Leave the folder as it is."""

    def get_source_stamp(self) -> str:
        """Return nothing: the folder is named after the source."""
        return ""

    def get_disambiguator(self) -> str:
        """Return nothing: the names of loops differ."""
        return ""


def compiled(name: str, folder: Path | None = None) -> Any:
    """Compile a loop; with a folder, load its compiled code from there, or keep it there."""
    njit: Any = numba.njit  # its stubs lack both options
    kernel = njit(error_model="numpy", nogil=True, **OPTIONS)(getattr(loops, name))
    if folder is not None:
        # These settings belong to the whole process and are restored as soon as the kernel has its folder.
        settings: Any = config
        before = settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES
        settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = str(folder), f"{__name__}.{Locator.__name__}"
        kernel.enable_caching()
        settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = before
    with _without_warning():
        kernel.compile(types.void(*SIGNATURES[name]))
    kernel.disable_compile()
    return kernel
