"""Scenarios and armours that several tests use."""

from functools import cache
from pathlib import Path
from typing import Any

from armour.core.run import Instant, Run, run
from armour.core.stages import default_time_step
from armour.core.state import Parameters
from armour.scenario.loading import Scenario, load_scenario, parse_scenario
from armour.sweeps.cases import Grid, axis_of

SCENARIOS = Path(__file__).parent.parent / "scenarios"
TESTS = SCENARIOS / "tests" / "wilkins.csv"


def data(
    projectile: str = "7.62 mm AP",
    ceramic: str | None = "AD85",
    backing: str = "6061-T6",
    ceramic_mm: float = 6.35,
    backing_mm: float = 6.35,
    velocity: float = 800.0,
    perimeter: str = "conoid",
    **sections: Any,
) -> dict[str, Any]:
    """A scenario as plain data; by default the Wilkins case."""
    armour = {
        "ceramic": ceramic,
        "ceramic_thickness_mm": ceramic_mm,
        "backing": backing,
        "backing_thickness_mm": backing_mm,
    }
    if ceramic is None:
        del armour["ceramic"]
    return {
        "impact": {"projectile": projectile, "velocity_m_s": velocity},
        "armour": armour,
        "model": {"shear_perimeter": perimeter},
        **sections,
    }


def scenario(*args: Any, **kwargs: Any) -> Scenario:
    """A scenario; by default the Wilkins case."""
    return parse_scenario(data(*args, **kwargs))


def armour(*args: Any, **kwargs: Any) -> Parameters:
    """A scenario's armour in the core's terms."""
    return scenario(*args, **kwargs).core_armour()


def traced(a: Parameters, velocity: float, dt: float | None = None) -> tuple[Run, list[Instant]]:
    """A run with all its instants."""
    trace: list[Instant] = []
    step = default_time_step(a, velocity) if dt is None else dt
    return run(a, velocity, step, 1.0, 200_000, trace), trace


def path(trace: list[Instant]) -> list[str]:
    """The stages of a run: medium, projectile, target ahead, motion, a letter each."""
    names: list[str] = []
    for instant in trace:
        s = instant.s
        name = "IFP"[s.medium] + "re"[s.eroding] + "cp"[s.penetrated] + "hm"[s.moving]
        if not names or names[-1] != name:
            names.append(name)
    return names


@cache
def shipped_scenario(name: str) -> Scenario:
    """A scenario of the folder of shipped scenarios."""
    return load_scenario(SCENARIOS / f"{name}.toml")


def sweep_scenario(**sections: Any) -> Scenario:
    """The Wilkins case with a grid, and ballistic limits to 0.1 mm/s."""
    thicknesses = {"min": 1.0, "max": 20.0, "step": 1.0}
    grid = {"ceramic_thickness_mm": thicknesses, "backing_thickness_mm": thicknesses}
    return scenario(optimise=grid, ballistic_limit={"tolerance_m_s": 1e-4}, **sections)


def sweep_grid(*texts: str) -> Grid:
    """A grid from the texts of its axes."""
    return Grid(tuple(axis_of(text) for text in texts))


def csv_file(path: Path, *lines: str) -> Path:
    """A file of lines."""
    path.write_text("\n".join(lines) + "\n")
    return path
