"""Speed and error of several ways to compute impacts and ballistic limits of the same random designs.

Errors are differences from plain Python with time steps 20 times shorter.  The tolerance and the longest step of
scipy's solvers are the loosest of those tried by which ballistic limits are within 1e-3 m/s, as the engine's are.
Without a longest step scipy misses plates that move for less than a step, and the limit is off by metres per second
at any tolerance.
"""

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.state import Outcome, Parameters
from armour.core.stepping import default_time_step
from armour.engine import batch
from tests.helpers.runs import perforates, random_designs
from tests.numerics.reference import Reference

ALLOWED = 1e-3  # m/s
COUNT = 1000
DESIGNS = random_designs(COUNT)
ROWS = batch.packed(DESIGNS)
ONE = batch.SolverOptions(threads=1)
ALL = batch.SolverOptions()
TOLERANCE = 3.5e-4
# Designs for the slow ways.
SOME = range(0, COUNT, 100)
SCENARIO = Path(__file__).parents[2] / "scenarios" / "wilkins.toml"


def by_scipy(method: str, rtol: float, longest: float) -> Callable[[Parameters, float], bool]:
    """Return a function that computes by scipy whether an impact perforates."""
    return lambda p, velocity: Reference(p, velocity, method, rtol, longest).perforated


def error(perforated: Callable[[Parameters, float], bool], designs: Any) -> float:
    """Return the largest error of the ballistic limit, m/s, rounded up to a power of ten."""
    worst = 0.0
    for i in designs:
        limit = FINE[i]
        bound = next(
            w
            for w in (1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0)
            if perforated(DESIGNS[i], limit + w) and not perforated(DESIGNS[i], limit - w)
        )
        worst = max(worst, bound)
    return worst


def fine_limits() -> np.ndarray:
    """Return ballistic limits to 1e-6 m/s with time steps 20 times shorter, m/s."""
    coarse = batch.ballistic_limits(ROWS, 20.0, 4000.0, 1e-3).perforated
    found = np.empty(COUNT)
    low, high = coarse - 0.01, coarse + 0.01
    for _ in range(15):
        middle = 0.5 * (low + high)
        steps = np.array([default_time_step(p, v) / 20.0 for p, v in zip(DESIGNS, middle, strict=True)])
        outcomes = np.array(
            [
                batch.impacts(
                    ROWS[i : i + 1], middle[i : i + 1], batch.SolverOptions(time_step=steps[i], threads=1)
                ).outcome[0]
                for i in range(COUNT)
            ]
        )
        perforated = outcomes == Outcome.PERFORATED
        high, low = np.where(perforated, middle, high), np.where(perforated, low, middle)
    found[:] = high
    return found


FINE = fine_limits()
NEAR = 1.05 * FINE


def test_impact_engine(benchmark: Any):
    benchmark.extra_info.update(name="engine, one core", what="impact", each=COUNT)
    benchmark(batch.impacts, ROWS, NEAR, ONE)
    benchmark.extra_info["error_m_s"] = limit_error()


def test_impact_engine_on_all_cores(benchmark: Any):
    benchmark.extra_info.update(name="engine, all cores", what="impact", each=COUNT, error_m_s=limit_error())
    benchmark(batch.impacts, ROWS, NEAR, ALL)


def test_impact_plain(benchmark: Any):
    benchmark.extra_info.update(name="plain Python", what="impact", each=len(SOME), error_m_s=limit_error())
    benchmark(lambda: [perforates(DESIGNS[i], NEAR[i]) for i in SOME])


@pytest.mark.parametrize("method", ["DOP853", "LSODA"])
def test_impact_scipy(benchmark: Any, method: str):
    settings = [(rtol, longest) for longest in (0.02, 0.01, 0.005, 0.002) for rtol in (1e-5, 1e-7)]
    for rtol, longest in settings:
        found = error(by_scipy(method, rtol, longest), SOME)
        if found <= ALLOWED:
            break
    name = f"solve_ivp, {method}, rtol {rtol:g}, longest step {longest:g} of a diameter"
    benchmark.extra_info.update(name=name, what="impact", each=len(SOME), error_m_s=found)
    perforated = by_scipy(method, rtol, longest)
    benchmark.pedantic(lambda: [perforated(DESIGNS[i], NEAR[i]) for i in SOME], rounds=2)


def limit_error() -> float:
    found = batch.ballistic_limits(ROWS, 20.0, 4000.0, TOLERANCE).perforated
    return float(np.abs(found - FINE).max())


def test_limit_engine(benchmark: Any):
    benchmark.extra_info.update(name="engine, one core", what="limit", each=COUNT, error_m_s=limit_error())
    benchmark(batch.ballistic_limits, ROWS, 20.0, 4000.0, TOLERANCE, ONE)


def test_limit_engine_on_all_cores(benchmark: Any):
    many = np.tile(ROWS, (10, 1))
    benchmark.extra_info.update(name="engine, all cores", what="limit", each=len(many), error_m_s=limit_error())
    benchmark(batch.ballistic_limits, many, 20.0, 4000.0, TOLERANCE, ALL)


def test_limit_plain(benchmark: Any):
    benchmark.extra_info.update(name="plain Python, bisection", what="limit", each=len(SOME), error_m_s=limit_error())

    def limits() -> list[float]:
        return [bisect(partial(perforates, DESIGNS[i]), 20.0, 4000.0, TOLERANCE)[1] for i in SOME]

    benchmark.pedantic(limits, rounds=2)


@pytest.mark.parametrize("count", [10**n for n in range(2, 7)])
def test_growth(benchmark: Any, count: int):
    """In chunks, as in a sweep, so that memory does not grow."""
    benchmark.extra_info.update(name="engine, all cores", what="growth", each=count)
    chunk = min(count, 50_000)
    rows = np.resize(ROWS, (chunk, ROWS.shape[1]))
    velocities = np.resize(NEAR, chunk)

    def compute() -> None:
        for _ in range(0, count, chunk):
            batch.impacts(rows, velocities, ALL)

    benchmark.pedantic(compute, rounds=3, warmup_rounds=1)


@pytest.mark.parametrize(
    ("name", "args"),
    [
        ("armour --help", ["--help"]),
        ("armour simulate", ["simulate", str(SCENARIO)]),
        ("armour optimise", ["optimise", str(SCENARIO.parent / "paper" / "optimum_25mm_APDS.toml")]),
    ],
)
def test_start(benchmark: Any, name: str, args: list[str]):
    benchmark.extra_info.update(name=name, what="process", each=1)
    command = [sys.executable, "-m", "armour", *args]
    benchmark.pedantic(lambda: subprocess.run(command, capture_output=True, check=True), rounds=5, warmup_rounds=1)


def test_engine_ready(benchmark: Any):
    """A process that loads the compiled engine and computes an impact and a ballistic limit."""
    benchmark.extra_info.update(name="Python, an impact and a limit by the engine", what="process", each=1)
    code = (
        "from armour import load_scenario; from armour.engine import batch; import numpy as np;"
        f"rows = batch.packed([load_scenario({str(SCENARIO)!r}).core_armour()]);"
        "batch.impacts(rows, np.array([800.0])); batch.ballistic_limits(rows, 20.0, 4000.0, 1e-3)"
    )
    benchmark.pedantic(lambda: subprocess.run([sys.executable, "-c", code], check=True), rounds=5, warmup_rounds=1)
