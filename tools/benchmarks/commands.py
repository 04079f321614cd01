"""Processor time of commands, and how it grows with what is asked: whole processes, on all cores."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

OPTIMUM = "paper/optimum_7.62mm_AP"
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
# Commands that users wait for.
WAITED_FOR = (
    "--help",
    "simulate wilkins",
    "ballistic-limit wilkins",
    "check wilkins",
    f"optimise {OPTIMUM}",
    f"report {OPTIMUM} -o report.html --force",
    "uncertainty uncertain",
    "sensitivity wilkins",
    "calibrate tests/wilkins wilkins",
    "plan shots wilkins",
    "validate",
)
TURNS = 3


def optimise_grid(designs: int) -> list[str]:
    """A grid with as many ceramics as back plates."""
    steps = round(designs**0.5) - 1
    spans = {"ceramic_thickness_mm": 18.0, "backing_thickness_mm": 12.0}
    return ["optimise", OPTIMUM, *(f"--set=optimise.{key}.step={span / steps!r}" for key, span in spans.items())]


def sweep(rows: int, quantity: str) -> list[str]:
    """A sweep over both thicknesses."""
    over = [f"--over={CERAMIC}=2:11.98:0.02", f"--over={BACKING}=3:{3 + (rows // 500 - 1) * 4e-4:.4f}:4e-4"]
    return ["sweep", "wilkins", *over, "--quantities", quantity, "-o", "table.csv", "--force"]


# Numbers of what grows, and the command for a number, by the command and what grows.
GROWING: dict[tuple[str, str], tuple[tuple[int, ...], Callable[[int], list[str]]]] = {
    ("sweep", "impact"): ((10**4, 10**5, 10**6), lambda n: sweep(n, "residual_velocity_m_s")),
    ("sweep", "ballistic limit"): ((10**3, 10**4, 10**5), lambda n: sweep(n, "ballistic_limit_m_s")),
    ("optimise", "design of a grid"): ((10**2, 100**2, 1000**2), optimise_grid),
    ("uncertainty", "sample of 5 inputs"): (
        (2**7, 2**13, 2**16),
        lambda n: ["uncertainty", "uncertain", f"--set=uncertainty.samples={n}"],
    ),
}


class Growth(NamedTuple):
    """How the processor time of a command grows."""

    command: str
    unit: str
    fixed: float  # s
    each: float  # s
    error: float  # largest relative error of the sum
    most: int  # the greatest number, and its time
    seconds: float


class Commands(NamedTuple):
    """What was measured; processor times in s."""

    waits: dict[str, float]  # by command
    growth: list[Growth]


def measured() -> Commands:
    """Measure the commands."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        waits: dict[str, list[float]] = {command: [] for command in WAITED_FOR}
        for _ in range(TURNS):
            for command, times in waits.items():
                times.append(used(command.split(), folder))
        growth = [grown(command, unit, folder) for command, unit in GROWING]
    return Commands({command: median(times) for command, times in waits.items()}, growth)


def grown(command: str, unit: str, folder: Path) -> Growth:
    """Measure how a command grows; the fit has the least relative errors."""
    numbers, arguments = GROWING[command, unit]
    seconds = np.array([used(arguments(number), folder) for number in numbers])
    columns = np.column_stack([1.0 / seconds, np.array(numbers) / seconds])
    fixed, each = np.linalg.lstsq(columns, np.ones(len(numbers)))[0].tolist()
    error = float(np.abs(columns @ [fixed, each] - 1.0).max())
    return Growth(command, unit, fixed, each, error, numbers[-1], float(seconds[-1]))


def used(arguments: list[str], folder: Path) -> float:
    """Return the processor time of a command run in a folder, s."""
    command = [sys.executable, "-m", "armour", *arguments]
    null = subprocess.DEVNULL
    with subprocess.Popen(command, cwd=folder, stdout=null, stderr=null) as process:
        _, status, usage = os.wait4(process.pid, 0)
        code = process.returncode = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        raise RuntimeError(f"armour {' '.join(arguments)}: exit code {code}")
    return usage.ru_utime + usage.ru_stime
