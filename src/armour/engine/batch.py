"""Many impacts, ballistic limits and thicknesses at once, over arrays, by the compiled core on all cores."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.core.state import Parameters
from armour.engine.compiled import kernel

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


class Brackets(NamedTuple):
    """Ballistic limits, m/s, or thicknesses, m, an entry each: between which two places the outcome changes."""

    defeated: Floats
    perforated: Floats
    runs: Ints
    resolved: NDArray[np.bool_]

    @property
    def bounded(self) -> NDArray[np.bool_]:
        """Whether the outcome changes within the range searched."""
        return np.isfinite(self.defeated) & np.isfinite(self.perforated)

    def within(self, low: float, high: float) -> Floats:
        """The lowest places that perforate or, where there is none or nothing is defeated, the end of the range."""
        highest = np.where(np.isfinite(self.perforated), self.perforated, high)
        return np.where(np.isfinite(self.defeated), highest, low)


class SolverOptions(NamedTuple):
    """How to compute."""

    V_arrest: float = 1.0  # velocity below which a projectile counts as stopped, m/s
    time_step: float = 0.0  # s; 0 for the default of each impact
    max_steps: int = 500_000  # steps after which an impact is given up as `Outcome.UNRESOLVED`
    threads: int | None = None  # by default one per core; the results do not depend on it


DEFAULT_OPTIONS = SolverOptions()


def packed(armours: Sequence[Parameters]) -> Floats:
    """Armours as rows of numbers, in the order of the fields of `Armour`."""
    return np.array(armours, dtype=np.float64).reshape(len(armours), len(Parameters._fields))


def fields(rows: Floats) -> Any:
    """The columns of rows as an `Armour` of arrays; they are views, which write through."""
    return Parameters(*rows.T)


def impacts(rows: Floats, velocities: Floats, told: SolverOptions = DEFAULT_OPTIONS) -> Impacts:
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
    counts, ends = _computed(kernel("impacts"), rows, velocities, told[:3], 6, told.threads)
    t, Z, L, V, W, h = ends.T
    return Impacts(counts[:, 0], t, Z, L, V, W, h, counts[:, 1])


def ballistic_limits(
    rows: Floats, low: float, high: float, tolerance: float, told: SolverOptions = DEFAULT_OPTIONS
) -> Brackets:
    """Find many ballistic limits between two velocities, m/s; see `armour.core.search.ballistic_limit_of`."""
    settings = (low, high, tolerance, *told[:3])
    return _places(*_computed(kernel("ballistic_limits"), rows, None, settings, 2, told.threads))


def least_thicknesses(
    rows: Floats, velocities: Floats, thin: float, thick: float, tolerance: float, told: SolverOptions = DEFAULT_OPTIONS
) -> Brackets:
    """Find the least ceramic thickness, m, that defeats each impact; see `armour.core.search.least_ceramic_thickness`."""
    settings = (thin, thick, tolerance, *told[:3])
    return _places(*_computed(kernel("least_thicknesses"), rows, velocities, settings, 2, told.threads))


def _places(counts: Ints, ends: Floats) -> Brackets:
    return Brackets(ends[:, 0], ends[:, 1], counts[:, 0], counts[:, 1] != 0)


def _computed(
    compiled: Callable[..., None],
    rows: Floats,
    velocities: Floats | None,
    settings: tuple[float, ...],
    width: int,
    threads: int | None,
) -> tuple[Ints, Floats]:
    """What a kernel says of the rows: (n, 2) integers and (n, width) numbers."""
    rows = np.ascontiguousarray(rows, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != len(Parameters._fields):
        raise ValueError(f"rows must be of the shape (n, {len(Parameters._fields)}), found {rows.shape}")
    count = len(rows)
    counts, ends = np.empty((count, 2), np.int64), np.empty((count, width))
    inputs = [rows]
    if velocities is not None:
        inputs.append(np.ascontiguousarray(np.broadcast_to(velocities, count), dtype=np.float64))

    def work(part: slice) -> None:
        arrays = [array[part].ctypes.data for array in (*inputs, counts, ends)]
        compiled(part.stop - part.start, *arrays[:-2], *settings, *arrays[-2:])

    _in_threads(work, count, threads)
    return counts, ends


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
