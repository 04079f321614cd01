"""Run the benchmarks and write their tables into docs/performance.md: medians of processor time.

python -m tools.benchmarks

They are commands that users wait for, commands whose time grows with what is asked, and an impact and a ballistic limit
of the same random designs by several methods.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from armour.core.equations import STRENGTH
from armour.core.search import find_ballistic_limit, scan
from armour.engine import batch
from tests.helpers.runs import perforates, random_designs
from tests.numerics.reference import Reference
from tools.tables import table, write_tables

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"
OPTIMUM = "paper/optimum_7.62mm_AP"
WAITED_FOR = (
    *("--help", "simulate wilkins", "ballistic-limit wilkins", "check wilkins", f"optimise {OPTIMUM}"),
    *(f"report {OPTIMUM} -o report.html --force", "uncertainty uncertain", "sensitivity wilkins"),
    *("calibrate tests/wilkins wilkins", "plan shots wilkins", "validate"),
)
TURNS = 3
COUNT = 1000
# Designs for methods that take hundreds of times as long.
SOME = slice(None, None, 25)
LOW, HIGH, TOLERANCE = 20.0, 4000.0, 3.5e-4  # m/s
SETTINGS = batch.DEFAULT_SETTINGS
# Tolerance and longest step, diameters, of scipy's LSODA: with looser ones limits are off by more than the engine's.
TOLERANCE_OF_LSODA, LONGEST_STEP = 1e-7, 0.005


def optimise_grid(designs: int) -> list[str]:
    """A grid with as many ceramics as back plates."""
    steps = round(designs**0.5) - 1
    spans = {"ceramic_thickness_mm": 18.0, "backing_thickness_mm": 12.0}
    return ["optimise", OPTIMUM, *(f"--set=optimise.{key}.step={span / steps!r}" for key, span in spans.items())]


def sweep(quantity: str, rows: int) -> list[str]:
    """A sweep over both thicknesses."""
    over = ["--over=armour.ceramic_thickness_mm=2:11.98:0.02"]
    over.append(f"--over=armour.backing_thickness_mm=3:{3 + (rows // 500 - 1) * 4e-4:.4f}:4e-4")
    return ["sweep", "wilkins", *over, "--quantities", quantity, "-o", "table.csv", "--force"]


def samples(number: int) -> list[str]:
    """A number of samples of uncertain inputs."""
    return ["uncertainty", "uncertain", f"--set=uncertainty.samples={number}"]


# What grows: the command for a number, and numbers.
GROWING: dict[str, tuple[Callable[[int], list[str]], tuple[int, ...]]] = {
    "`sweep`: impact": (partial(sweep, "residual_velocity_m_s"), (10**4, 10**5, 10**6)),
    "`sweep`: ballistic limit": (partial(sweep, "ballistic_limit_m_s"), (10**3, 10**4, 10**5)),
    "`optimise`: design of a grid": (optimise_grid, (10**2, 100**2, 1000**2)),
    "`uncertainty`: sample of 5 inputs": (samples, (2**7, 2**13, 2**16)),
}


def used(arguments: list[str], folder: str) -> float:
    """Return the processor time of a command run in a folder, s."""
    command, null = [sys.executable, "-m", "armour", *arguments], subprocess.DEVNULL
    with subprocess.Popen(command, cwd=folder, stdout=null, stderr=null) as process:
        _, status, usage = os.wait4(process.pid, 0)
        code = process.returncode = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        raise RuntimeError(f"armour {' '.join(arguments)}: exit code {code}")
    return usage.ru_utime + usage.ru_stime


def grown(unit: str, folder: str) -> list[str]:
    """Return the fixed time of a command and that of each unit, by the least relative errors, and the longest."""
    arguments, numbers = GROWING[unit]
    seconds = np.array([used(arguments(number), folder) for number in numbers])
    columns = np.column_stack([1.0 / seconds, np.array(numbers) / seconds])
    fixed, each = np.linalg.lstsq(columns, np.ones(len(numbers)))[0].tolist()
    return [unit, f"{fixed:.1f}", f"{1e6 * each:.2g}", f"{numbers[-1]:,}: {seconds[-1]:.1f} s"]


def time_of(call: Callable[[], Any]) -> float:
    """Return the median time of a call, s, after one that warms."""
    call()
    times = []
    for _ in range(TURNS):
        start = process_time()
        call()
        times.append(process_time() - start)
    return median(times)


def methods() -> Iterator[list[str]]:
    """Yield the times of an impact and of a ballistic limit by each method, µs."""
    designs = [p._replace(drive_law=STRENGTH) for p in random_designs(COUNT)]
    rows = batch.packed(designs)
    limits = partial(batch.ballistic_limits, rows, LOW, HIGH, TOLERANCE, threads=1)
    near = 1.05 * limits().perforated
    # As numbers of Python: those of numpy are slower in plain Python.
    some = [*zip(designs[SOME], near[SOME].tolist(), strict=True)]
    settings = scan(LOW, HIGH), TOLERANCE, SETTINGS.V_arrest, 0.0, SETTINGS.max_steps
    calls: dict[str, tuple[int, list[Callable[[], Any]]]] = {
        "engine": (COUNT, [partial(batch.impacts, rows, near, threads=1), limits]),
        "plain Python": (
            len(some),
            [
                lambda: [perforates(p, V) for p, V in some],
                lambda: [find_ballistic_limit(p, *settings) for p, _ in some],
            ],
        ),
        "scipy's LSODA": (
            len(some),
            [lambda: [Reference(p, V, "LSODA", TOLERANCE_OF_LSODA, LONGEST_STEP).perforated for p, V in some]],
        ),
    }
    for name, (count, of_method) in calls.items():
        times = [1e6 * time_of(call) / count for call in of_method]
        yield [name, *(f"{time:,.{int(time < 1e3)}f}" for time in times), *[""] * (2 - len(times))]


def main() -> None:
    """Write the tables of the page."""
    with TemporaryDirectory() as folder:
        waits = [
            [f"`{command.partition(' -o')[0]}`", f"{median(used(command.split(), folder) for _ in range(TURNS)):.1f}"]
            for command in WAITED_FOR
        ]
        growth = [grown(unit, folder) for unit in GROWING]
    write_tables(
        PAGE,
        table(("command", "s"), waits),
        table(("for each", "fixed, s", "each, µs", "example"), growth),
        table(("method", "impact, µs", "limit, µs"), [*methods()]),
    )


if __name__ == "__main__":
    main()
