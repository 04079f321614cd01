"""An impact and a ballistic limit of the same random designs by several methods, in turn in one run.

Of processor time other load on the machine changes little, and of the ratio of two methods in the same turn even less:
medians over the turns are given.
"""

import subprocess
from collections.abc import Callable
from ctypes import CDLL, c_double, c_long
from functools import partial
from pathlib import Path
from shutil import which
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np

from armour.core.search import find_ballistic_limit, scan
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from tests.helpers.runs import perforates, random_designs
from tests.numerics.reference import Reference

COUNT = 1000
TURNS = 60
# Designs for methods that take hundreds of times as long, and how often the engine computes them in a turn.
SOME, FEW_TURNS, REPEATED = slice(None, None, 25), 3, 50
LOW, HIGH, TOLERANCE = 20.0, 4000.0, 3.5e-4  # m/s
ONE, ALL = batch.SolverOptions(threads=1), batch.SolverOptions()
# Greatest error of the ballistic limit with the settings of scipy's solvers, m/s; the engine's is below it.
ALLOWED = 2e-3
SETTINGS = [(rtol, longest) for longest in (0.02, 0.01, 0.005, 0.002) for rtol in (1e-5, 1e-7)]
# What numba asks of LLVM: all of the processor's instructions, no rounding changed, and errno not set.
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno")
SOURCE = Path(__file__).with_name("reference.c")


Calls = dict[str, Callable[[], Any]]


class Time(NamedTuple):
    """Time of a method."""

    each: float  # of one impact or limit, s
    ratio: float  # over the engine's on one core


class Methods(NamedTuple):
    """What was measured."""

    impacts: dict[str, Time]  # by method
    limits: dict[str, Time]
    steps: float  # mean number of steps of an impact
    runs: float  # mean number of runs of a ballistic limit
    error_m_s: float  # largest error of the engine's ballistic limits
    settings: dict[str, tuple[float, float]]  # tolerance and longest step, diameters, of scipy's methods
    cores: float  # ballistic limits on all cores over those on one in the same elapsed time, the shortest


def in_turn(calls: Calls, turns: int, clock: Callable[[], float] = thread_time) -> dict[str, list[float]]:
    """Return the times of each call, s, of which one is made after the other in every turn, after one that warms."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for turn in range(-1, turns):
        for name, call in calls.items():
            start = clock()
            call()
            if turn >= 0:
                times[name].append(clock() - start)
    return times


def ratio(times: list[float], others: list[float]) -> float:
    """Return the median ratio of times to others in the same turn."""
    return median(time / other for time, other in zip(times, others, strict=True))


class InC:
    """The reference in C, compiled in a folder."""

    def __init__(self, folder: Path) -> None:
        library = folder / "reference.so"
        subprocess.run(["cc", *FLAGS, "-shared", "-fPIC", "-o", str(library), str(SOURCE), "-lm"], check=True)
        self.library = CDLL(str(library))

    def _computed(self, name: str, inputs: list[np.ndarray], search: list[Any], width: int) -> Any:
        rows = inputs[0]
        solver = c_double(ONE.V_arrest), c_double(ONE.time_step), c_long(ONE.max_steps)
        counts, ends = np.empty((len(rows), 2), np.int64), np.empty((len(rows), width))
        pointers = [array.ctypes for array in (*inputs, counts, ends)]
        getattr(self.library, name)(*pointers[:-2], c_long(len(rows)), *search, *solver, *pointers[-2:])
        return counts, ends

    def impacts(self, rows: np.ndarray, velocities: np.ndarray) -> batch.Impacts:
        """Compute the same as `armour.engine.batch.impacts`."""
        counts, ends = self._computed("impacts", [rows, velocities], [], 6)
        t, Z, L, V, W, h = ends.T
        return batch.Impacts(counts[:, 0], t, Z, L, V, W, h, counts[:, 1])

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
    impacts: Calls = {"engine": partial(batch.impacts, rows, velocities, ONE)}
    limits: Calls = {"engine": partial(batch.ballistic_limits, rows, LOW, HIGH, TOLERANCE, ONE)}
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


def fine_limits(designs: tuple[Parameters, ...], limits: np.ndarray) -> np.ndarray:
    """Return the ballistic limits that are given, to 1e-6 m/s with steps of a thousandth of a diameter, m/s."""
    rows = batch.packed(designs)
    low, high = limits - 0.01, limits + 0.01
    for _ in range(15):
        middle = 0.5 * (low + high)
        perforated = np.empty(len(rows), bool)
        for i, (p, V) in enumerate(zip(designs, middle, strict=True)):
            options = ONE._replace(time_step=p.D0 / V / 1000.0)
            perforated[i] = batch.impacts(rows[i : i + 1], V, options).outcome[0] == Outcome.PERFORATED
        high, low = np.where(perforated, middle, high), np.where(perforated, low, middle)
    return high


def by_scipy(method: str, rtol: float, longest: float) -> Callable[[Parameters, float], bool]:
    """Return a function that computes by scipy whether an impact perforates."""
    return lambda p, velocity: Reference(p, velocity, method, rtol, longest).perforated


def loosest(method: str, designs: tuple[Parameters, ...], limits: np.ndarray) -> tuple[float, float]:
    """Return the loosest tolerance and longest step with which scipy's ballistic limits are within `ALLOWED`."""
    for settings in SETTINGS:
        perforated = by_scipy(method, *settings)
        if all(
            perforated(p, V + ALLOWED) and not perforated(p, V - ALLOWED) for p, V in zip(designs, limits, strict=True)
        ):
            return settings
    raise ValueError(f"{method}: no setting is within {ALLOWED} m/s")


def measured() -> Methods:
    """Measure the methods on one core, and the engine on all."""
    designs = random_designs(COUNT)
    rows = batch.packed(designs)
    limits = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE, ONE)
    fine = fine_limits(designs, limits.perforated)
    near = 1.05 * fine

    def engine_impacts(part: slice) -> Any:
        return batch.impacts(rows[part], near[part], ONE)

    def engine_limits(part: slice) -> Any:
        return batch.ballistic_limits(rows[part], LOW, HIGH, TOLERANCE, ONE)

    with TemporaryDirectory() as folder:
        impacts, searches = by_engine_and_c(rows, near, Path(folder))
        impact_times, limit_times = in_turn(impacts, TURNS), in_turn(searches, TURNS // 4)

    def each(perforated: Callable[[Parameters, float], bool]) -> Callable[[], object]:
        return lambda: [perforated(p, V) for p, V in zip(designs[SOME], near[SOME], strict=True)]

    slow: Calls = {
        "engine": lambda: [engine_impacts(SOME) for _ in range(REPEATED)],
        "plain Python": each(perforates),
    }
    settings = {method: loosest(method, designs[SOME], fine[SOME]) for method in ("LSODA", "DOP853")}
    slow |= {f"`solve_ivp`, {method}": each(by_scipy(method, *of)) for method, of in settings.items()}
    velocities = scan(LOW, HIGH)
    slow_searches: Calls = {
        "engine": lambda: [engine_limits(SOME) for _ in range(REPEATED)],
        "plain Python": lambda: [
            find_ballistic_limit(p, velocities, TOLERANCE, ONE.V_arrest, 0.0, ONE.max_steps) for p in designs[SOME]
        ],
    }
    many = partial(batch.ballistic_limits, np.tile(rows, (10, 1)), LOW, HIGH, TOLERANCE)
    on_cores = in_turn({"one": partial(many, ONE), "all": partial(many, ALL)}, 2 * FEW_TURNS, perf_counter)
    return Methods(
        _times(impact_times, in_turn(slow, FEW_TURNS)),
        _times(limit_times, in_turn(slow_searches, FEW_TURNS)),
        float(impacts["engine"]().steps.mean()),
        float(limits.runs.mean()),
        float(np.abs(limits.perforated - fine).max()),
        settings,
        min(on_cores["one"]) / min(on_cores["all"]),
    )


def _times(fast: dict[str, list[float]], slow: dict[str, list[float]]) -> dict[str, Time]:
    """Return the times by method: of fast ones, on all designs, and of slow ones by their ratio to the engine's."""
    engine = median(fast["engine"]) / COUNT
    ratios = {name: REPEATED * ratio(times, slow["engine"]) for name, times in slow.items()}
    ratios |= {name: ratio(times, fast["engine"]) for name, times in fast.items()}
    return {name: Time(value * engine, value) for name, value in ratios.items()}
