"""An impact and a ballistic limit of the same random designs by several methods: medians of processor time."""

import subprocess
from collections.abc import Callable
from ctypes import CDLL, c_double, c_long
from functools import partial
from pathlib import Path
from shutil import which
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np

from armour.core.equations import STRENGTH
from armour.core.search import find_ballistic_limit, scan
from armour.core.state import Parameters
from armour.engine import batch
from tests.helpers.runs import perforates, random_designs
from tests.numerics.reference import Reference

COUNT = 1000
TURNS = 60
# Designs for methods that take hundreds of times as long.
SOME, FEW_TURNS = slice(None, None, 25), 3
LOW, HIGH, TOLERANCE = 20.0, 4000.0, 3.5e-4  # m/s
SETTINGS = batch.DEFAULT_SETTINGS
# Tolerance and longest step, diameters, of scipy's LSODA: with looser ones limits are off by more than the engine's.
TOLERANCE_OF_LSODA, LONGEST_STEP = 1e-7, 0.005
# What numba asks of LLVM: all of the processor's instructions, no rounding changed, and errno not set.
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno")
SOURCE = Path(__file__).with_name("reference.c")

Calls = dict[str, Callable[[], Any]]


class Methods(NamedTuple):
    """What was measured."""

    impacts: dict[str, float]  # time of one, s, by method
    limits: dict[str, float]
    steps: float  # mean number of steps of an impact
    runs: float  # mean number of runs of a ballistic limit
    cores: float  # ballistic limits on all cores over those on one in the same elapsed time, the shortest


def times_of(call: Callable[[], Any], turns: int, clock: Callable[[], float] = process_time) -> list[float]:
    """Return the times of a call, s, after one that warms."""
    call()
    times = []
    for _ in range(turns):
        start = clock()
        call()
        times.append(clock() - start)
    return times


class InC:
    """The reference in C, compiled in a folder."""

    def __init__(self, folder: Path) -> None:
        library = folder / "reference.so"
        subprocess.run(["cc", *FLAGS, "-shared", "-fPIC", "-o", str(library), str(SOURCE), "-lm"], check=True)
        self.library = CDLL(str(library))

    def _computed(self, name: str, inputs: list[np.ndarray], search: list[Any], width: int) -> Any:
        rows = inputs[0]
        solver = c_double(SETTINGS.V_arrest), c_double(SETTINGS.dt), c_long(SETTINGS.max_steps)
        counts, ends = np.empty((len(rows), 2), np.int64), np.empty((len(rows), width))
        pointers = [array.ctypes for array in (*inputs, counts, ends)]
        getattr(self.library, name)(*pointers[:-2], c_long(len(rows)), *search, *solver, *pointers[-2:])
        return counts, ends

    def impacts(self, rows: np.ndarray, velocities: np.ndarray) -> batch.ImpactBatch:
        """Compute the same as `armour.engine.batch.impacts`."""
        counts, ends = self._computed("impacts", [rows, velocities], [], 6)
        t, Z, L, V, W, h = ends.T
        return batch.ImpactBatch(counts[:, 0], t, Z, L, V, W, h, counts[:, 1])

    def ballistic_limits(self, rows: np.ndarray) -> batch.Brackets:
        """Compute the same as `armour.engine.batch.ballistic_limits`."""
        velocities = np.array(scan(LOW, HIGH))
        search = [velocities.ctypes, c_long(len(velocities)), c_double(TOLERANCE)]
        counts, ends = self._computed("ballistic_limits", [rows], search, 2)
        return batch.Brackets(ends[:, 0], ends[:, 1], counts[:, 0], counts[:, 1] != 0)


def by_engine_and_c(rows: np.ndarray, velocities: np.ndarray, folder: Path) -> tuple[Calls, Calls]:
    """Return the calls that compute impacts and ballistic limits by the engine and, with a compiler, by C.

    The numbers of both must be equal to the last bit.
    """
    impacts: Calls = {"engine": partial(batch.impacts, rows, velocities, threads=1)}
    limits: Calls = {"engine": partial(batch.ballistic_limits, rows, LOW, HIGH, TOLERANCE, threads=1)}
    if which("cc"):
        c = InC(folder)
        impacts["C"] = partial(c.impacts, rows, velocities)
        limits["C"] = partial(c.ballistic_limits, rows)
        for calls in (impacts, limits):
            found, expected = (np.array([*calls[name]()], dtype=float) for name in ("C", "engine"))
            different = int((found != expected).any(axis=0).sum())
            if different:
                raise ValueError(
                    f"{SOURCE}: the numbers of {different} of {len(rows)} designs differ from the engine's"
                )
    return impacts, limits


def by_lsoda(p: Parameters, velocity: float) -> bool:
    """Return whether an impact perforates, by scipy."""
    return Reference(p, velocity, "LSODA", TOLERANCE_OF_LSODA, LONGEST_STEP).perforated


def measured() -> Methods:
    """Measure the methods on one core, and the engine on all."""
    designs = [p._replace(drive_law=STRENGTH) for p in random_designs(COUNT)]
    rows = batch.packed(designs)
    limits = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE, threads=1)
    near = 1.05 * limits.perforated

    with TemporaryDirectory() as folder:
        # The numbers are compared by every law; the times are those of the default.
        by_engine_and_c(batch.packed(random_designs(COUNT)), near, Path(folder))
        impacts, searches = by_engine_and_c(rows, near, Path(folder))
        impact_s = {name: median(times_of(call, TURNS)) / COUNT for name, call in impacts.items()}
        limit_s = {name: median(times_of(call, TURNS // 4)) / COUNT for name, call in searches.items()}

    # As numbers of Python: those of numpy are slower in plain Python.
    some, speeds, velocities = designs[SOME], near[SOME].tolist(), scan(LOW, HIGH)
    slow: Calls = {
        "plain Python": lambda: [perforates(p, V) for p, V in zip(some, speeds, strict=True)],
        "scipy's LSODA": lambda: [by_lsoda(p, V) for p, V in zip(some, speeds, strict=True)],
    }
    impact_s |= {name: median(times_of(call, FEW_TURNS)) / len(some) for name, call in slow.items()}
    settings = velocities, TOLERANCE, SETTINGS.V_arrest, 0.0, SETTINGS.max_steps
    searched = times_of(lambda: [find_ballistic_limit(p, *settings) for p in some], FEW_TURNS)
    limit_s["plain Python"] = median(searched) / len(some)
    many = partial(batch.ballistic_limits, np.tile(rows, (10, 1)), LOW, HIGH, TOLERANCE)
    one, every = (min(times_of(partial(many, threads=threads), 2 * FEW_TURNS, perf_counter)) for threads in (1, None))
    steps, runs = float(impacts["engine"]().steps.mean()), float(limits.runs.mean())
    return Methods(impact_s, limit_s, steps, runs, one / every)
