"""How the time and memory of commands grow with what is asked, over three decades: whole processes, on all cores."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

GRID = "paper/optimum_7.62mm_AP"
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
STUDY = """
[impact]
projectile = "7.62 mm AP"
velocity_m_s = 850.0

[armour]
ceramic = "AD85"
ceramic_thickness_mm = 10.0
backing = "5083-H3"
backing_thickness_mm = 6.0

[[design.backing]]
material = "5083-H3"
thickness_mm = [3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
"""
# Designs of a ceramic in the study: 17 thicknesses on 6 back plates.
DESIGNS = 102
THREAT = """
[[threat]]
projectile = "7.62 mm AP"
velocity_m_s = {velocity}
"""
OFFER = """
[library.ceramic.{name}]
based_on = "AD85"
density_kg_m3 = {density}

[[design.ceramic]]
material = "{name}"
thickness_mm = {{ min = 6.0, max = 14.0, step = 0.5 }}
"""


def optimise_grid(designs: int, _folder: Path) -> list[str]:
    """A grid with as many ceramics as back plates."""
    steps = round(designs**0.5) - 1
    spans = {"ceramic_thickness_mm": 18.0, "backing_thickness_mm": 12.0}
    return ["optimise", GRID, *(f"--set=optimise.{key}.step={span / steps!r}" for key, span in spans.items())]


def study(ceramics: int, threats: int, folder: Path) -> list[str]:
    """A catalogue, in a scenario of its own."""
    offers = (OFFER.format(name=f"c{i}", density=3420.0 + 0.1 * i) for i in range(ceramics))
    impacts = (THREAT.format(velocity=850.0 - 0.1 * i) for i in range(threats))
    (folder / "study.toml").write_text("".join([STUDY, *offers, *impacts]))
    return ["optimise", str(folder / "study.toml")]


def sweep(rows: int, quantity: str, folder: Path) -> list[str]:
    """A sweep over both thicknesses."""
    over = [f"--over={CERAMIC}=2:11.98:0.02", f"--over={BACKING}=3:{3 + (rows // 500 - 1) * 4e-4:.4f}:4e-4"]
    return ["sweep", "wilkins", *over, "--quantities", quantity, "-o", str(folder / "t.csv")]


# Numbers of what grows, and the command for a number, by the command and what grows.
COSTS: dict[tuple[str, str], tuple[tuple[int, ...], Callable[[int, Path], list[str]]]] = {
    ("optimise", "design of a grid"): ((32**2, 100**2, 316**2, 1000**2), optimise_grid),
    ("optimise", f"ceramic, in {DESIGNS} designs"): ((1, 10, 100, 1000), lambda n, folder: study(n, 1, folder)),
    ("optimise", f"threat, to {DESIGNS} designs"): ((1, 10, 100, 1000), lambda n, folder: study(1, n, folder)),
    ("uncertainty", "sample of 5 inputs"): (
        (2**7, 2**10, 2**14, 2**17),
        lambda n, _: ["uncertainty", "uncertain", f"--set=uncertainty.samples={n}"],
    ),
    ("sweep", "ballistic limit"): (
        (500, 5000, 50_000, 500_000),
        lambda n, folder: sweep(n, "ballistic_limit_m_s", folder),
    ),
    ("sweep", "impact"): ((10**4, 10**5, 10**6, 10**7), lambda n, folder: sweep(n, "residual_velocity_m_s", folder)),
    ("sensitivity", "call"): ((1,), lambda _number, _folder: ["sensitivity", "wilkins"]),
}


@pytest.mark.parametrize(
    ("command", "unit", "number"), [(*key, number) for key, (numbers, _) in COSTS.items() for number in numbers]
)
def test_cost(benchmark: Any, tmp_path: Path, command: str, unit: str, number: int):
    numbers, arguments = COSTS[command, unit]
    args = [sys.executable, "-m", "armour", *arguments(number, tmp_path)]
    code = (
        "import json, resource, subprocess, sys;"
        "subprocess.run(json.loads(sys.argv[1]), check=True, stdout=-3, stderr=-3);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    )

    def run() -> None:
        done = subprocess.run(
            [sys.executable, "-c", code, json.dumps(args)], capture_output=True, text=True, check=True
        )
        benchmark.extra_info["peak_MiB"] = int(done.stdout) / 1024
        (tmp_path / "t.csv").unlink(missing_ok=True)

    benchmark.extra_info.update(what="cost", command=command, unit=unit, each=number)
    short = number in numbers[:2]
    benchmark.pedantic(run, rounds=2 if short else 1, warmup_rounds=1 if short else 0)
