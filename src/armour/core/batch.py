"""The core's own functions compiled by numba, for many impacts at once.

Nothing of the physics is here: `compiled` has numba compile the functions of the other files as they are, so that both
ways give the same numbers.  What is compiled is cached on disk under the contents of all of these files.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import numba
import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from armour.core import equations, rk4, run, search, stages, state
from armour.core.state import Armour

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Rows that a thread takes at a time.
PORTION = 256


class Impacts(NamedTuple):
    """Impacts, an entry each."""

    outcome: Ints  # an Outcome
    t: Floats  # duration, s
    Z: Floats  # state at the end
    L: Floats
    V: Floats
    W: Floats
    h: Floats
    steps: Ints


class Places(NamedTuple):
    """Ballistic limits, m/s, or thicknesses, m, an entry each: between which two places the outcome changes."""

    defeated: Floats
    perforated: Floats
    runs: Ints
    resolved: NDArray[np.bool_]


class Told(NamedTuple):
    """How to compute."""

    V_arrest: float = 1.0  # velocity below which a projectile counts as stopped, m/s
    time_step: float = 0.0  # s; 0 for the default of each impact
    max_steps: int = 500_000  # steps after which an impact is given up as `Outcome.UNRESOLVED`
    threads: int | None = None  # by default one per core; the results do not depend on it


USUAL = Told()


def packed(armours: Sequence[Armour]) -> Floats:
    """Armours as rows of numbers, in the order of the fields of `Armour`."""
    return np.array(armours, dtype=np.float64).reshape(len(armours), len(Armour._fields))


def digest(core: Path = Path(__file__).parent) -> str:
    """What tells the contents of the core's files, and this numba, from any other."""
    told = sha256(numba.__version__.encode())
    for path in sorted(core.glob("*.py")):
        told.update(path.read_bytes())
    return told.hexdigest()


def cache_folder() -> Path:
    """Folder of this user's compiled code, of these very files."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "armour" / digest()[:16]


def is_compiled() -> bool:
    """Whether an earlier process has left its compiled code."""
    return any(cache_folder().rglob("*.nbi"))


def _compile(module: ModuleType) -> None:
    """Let compiled code call the functions of a module."""
    for function in vars(module).values():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            register_jitable(function)


for _module in (equations, state, stages, rk4, run, search):
    _compile(_module)

# numba looks at this when a function is marked for compilation.
_config: Any = numba.config
_usual_folder = _config.CACHE_DIR
_config.CACHE_DIR = str(cache_folder())


def _kernel(function: Callable[..., None]) -> Any:
    return numba.njit(nogil=True, cache=True, error_model="numpy")(function)


@register_jitable
def _armour(row: Floats) -> Armour:
    return Armour(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11], row[12] > 0.5
    )


@_kernel
def _impacts(
    rows: Floats,
    velocities: Floats,
    V_arrest: float,
    given: float,
    max_steps: int,
    outcome: Ints,
    steps: Ints,
    ends: Floats,
) -> None:
    for i in range(len(rows)):
        a = _armour(rows[i])
        end = run.run(a, velocities[i], search.time_step(a, velocities[i], given), V_arrest, max_steps)
        outcome[i] = end.outcome
        steps[i] = end.steps
        ends[i, 0] = end.t
        ends[i, 1] = end.y.Z
        ends[i, 2] = end.y.L
        ends[i, 3] = end.y.V
        ends[i, 4] = end.y.W
        ends[i, 5] = end.y.h


@_kernel
def _limits(
    rows: Floats,
    low: float,
    high: float,
    tolerance: float,
    V_arrest: float,
    given: float,
    max_steps: int,
    ends: Floats,
    runs: Ints,
    resolved: NDArray[np.bool_],
) -> None:
    for i in range(len(rows)):
        found = search.limit_of(_armour(rows[i]), low, high, tolerance, V_arrest, given, max_steps)
        ends[i, 0], ends[i, 1], runs[i], resolved[i] = found.low, found.high, found.runs, found.resolved


@_kernel
def _thinnest(
    rows: Floats,
    velocities: Floats,
    thin: float,
    thick: float,
    tolerance: float,
    V_arrest: float,
    given: float,
    max_steps: int,
    ends: Floats,
    runs: Ints,
    resolved: NDArray[np.bool_],
) -> None:
    for i in range(len(rows)):
        found = search.thinnest_of(_armour(rows[i]), velocities[i], thin, thick, tolerance, V_arrest, given, max_steps)
        ends[i, 0], ends[i, 1], runs[i], resolved[i] = -found.low, -found.high, found.runs, found.resolved


_config.CACHE_DIR = _usual_folder


def impacts(rows: Floats, velocities: Floats, told: Told = USUAL) -> Impacts:
    """Run many impacts.

    Parameters
    ----------
    rows : array, (n, 13)
        Armours, see `packed`.
    velocities : array, (n,)
        Impact velocities, m/s.
    told : Told
        How to compute.
    """
    count = len(rows)
    outcome, steps, ends = np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, 6))

    def work(part: slice) -> None:
        _impacts(rows[part], velocities[part], *told[:3], outcome[part], steps[part], ends[part])

    _in_threads(work, count, told.threads)
    t, Z, L, V, W, h = ends.T
    return Impacts(outcome, t, Z, L, V, W, h, steps)


def limits(rows: Floats, low: float, high: float, tolerance: float, told: Told = USUAL) -> Places:
    """Find many ballistic limits between two velocities, m/s; see `armour.core.search.limit_of`."""
    count = len(rows)
    ends, runs, resolved = np.empty((count, 2)), np.empty(count, np.int64), np.empty(count, np.bool_)

    def work(part: slice) -> None:
        _limits(rows[part], low, high, tolerance, *told[:3], ends[part], runs[part], resolved[part])

    _in_threads(work, count, told.threads)
    return Places(ends[:, 0], ends[:, 1], runs, resolved)


def thinnest(
    rows: Floats, velocities: Floats, thin: float, thick: float, tolerance: float, told: Told = USUAL
) -> Places:
    """Find the ceramic thickness, m, at which each impact is just defeated; see `armour.core.search.thinnest_of`."""
    count = len(rows)
    ends, runs, resolved = np.empty((count, 2)), np.empty(count, np.int64), np.empty(count, np.bool_)

    def work(part: slice) -> None:
        _thinnest(
            rows[part], velocities[part], thin, thick, tolerance, *told[:3], ends[part], runs[part], resolved[part]
        )

    _in_threads(work, count, told.threads)
    return Places(ends[:, 0], ends[:, 1], runs, resolved)


def _in_threads(work: Callable[[slice], None], count: int, threads: int | None) -> None:
    """Do the work portion by portion; each row is computed by itself, whichever thread takes it."""
    parts = [slice(start, min(start + PORTION, count)) for start in range(0, count, PORTION)]
    workers = min(threads or len(os.sched_getaffinity(0)), len(parts))
    if workers <= 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(workers) as pool:
        for done in [pool.submit(work, part) for part in parts]:
            done.result()
