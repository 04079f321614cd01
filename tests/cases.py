"""Scenarios and armours that several tests use."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from armour.core.run import Instant, Run, run
from armour.core.state import Outcome, Parameters
from armour.core.stepping import default_time_step
from armour.design.optimise import BestDesign, Design, DesignResult, Pair
from armour.reporting.table import Table
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


RANGE = {"min": 4.0, "max": 12.0, "step": 1.0}
THREATS = [
    {"projectile": "7.62 mm AP", "velocity_m_s": 800.0},
    {"projectile": "7.62 mm APM2", "velocity_m_s": 780.0, "margin_m_s": 25.0, "name": "M2"},
]
CERAMICS = [
    {"material": "AD85", "thickness_mm": RANGE, "cost_per_kg": 12.0},
    {"material": "AD99.5", "thickness_mm": [4.5, 6.5, 9.0], "cost_per_kg": 30.0, "density_kg_m3": 3900.0},
]
METALS = [
    {"material": "6061-T6", "thickness_mm": RANGE, "cost_per_kg": 7.0, "cost_per_m2": 15.0},
    {"material": "7075-T6", "thickness_mm": [4.0, 6.0, 8.0], "cost_per_kg": 11.0},
]


def catalogue(threats: Any = THREATS, uncertain: Any = None, **design: Any) -> Scenario:
    """A scenario with a catalogue of two ceramics and two metals against two threats."""
    sections: dict[str, Any] = {"threat": threats, "design": {"ceramic": CERAMICS, "backing": METALS, **design}}
    return scenario(**sections, **({} if uncertain is None else {"uncertainty": uncertain}))


def library(
    projectile: tuple[float, float, float, float],
    ceramic: tuple[float, float, float],
    metal: tuple[float, float, float],
) -> dict[str, Any]:
    """A library of a projectile "x", a ceramic "c" and a metal "b".

    Parameters
    ----------
    projectile : tuple
        Penetrator diameter, mm, and mass, g, density, kg/m^3, and flow stress, GPa.
    ceramic : tuple
        Density, kg/m^3, Young's modulus, GPa, and flow stress, GPa.
    metal : tuple
        Density, kg/m^3, flow stress, GPa, and shear strength, MPa.
    """
    keys = ("penetrator_diameter_mm", "penetrator_mass_g", "density_kg_m3", "flow_stress_GPa")
    return {
        "projectile": {"x": dict(zip(keys, projectile, strict=True))},
        "ceramic": {"c": dict(zip(("density_kg_m3", "youngs_modulus_GPa", "flow_stress_GPa"), ceramic, strict=True))},
        "metal": {
            "b": {
                **dict(zip(("density_kg_m3", "flow_stress_GPa", "shear_strength_MPa"), metal, strict=True)),
                "dynamic_yield_strength_MPa": 300.0,
            }
        },
    }


def armour(*args: Any, **kwargs: Any) -> Parameters:
    """The core's parameters of a scenario; by default of the Wilkins case."""
    return scenario(*args, **kwargs).core_armour()


def traced(p: Parameters, velocity: float, dt: float | None = None) -> tuple[Run, list[Instant]]:
    """A run with all its instants."""
    trace: list[Instant] = []
    step = default_time_step(p, velocity) if dt is None else dt
    return run(p, velocity, step, 1.0, 200_000, trace), trace


def perforates(p: Parameters, velocity: float, part: float = 1.0) -> bool:
    """Whether an impact perforates, by plain Python with a part of the default time step."""
    return run(p, velocity, part * default_time_step(p, velocity), 1.0, 5_000_000).outcome == Outcome.PERFORATED


def path(trace: list[Instant]) -> list[str]:
    """The stages of a run, as letters: medium, projectile, material ahead, motion."""
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


class StagePath(NamedTuple):
    """An impact, and the stages that it passes through, in the letters of `path`."""

    parameters: Callable[[], Parameters]
    velocity: float
    stages: list[str]


STAGE_PATHS = {
    "dwell, then moving plate": StagePath(
        lambda: armour("25 mm APDS", "AD99.5", "7075-T6", 4.0, 16.0, perimeter="projectile"),
        600.0,
        ["Iech", "Fecm", "Fepm", "Prpm", "Prcm"],
    ),
    "dwell on rubble that moves": StagePath(
        lambda: armour("25 mm APDS", "Al-N", "6061-T6", 10.0, 15.0, perimeter="projectile"),
        700.0,
        ["Iech", "Fecm", "Fepm", "Frpm", "Prpm"],
    ),
    "dwell begins late, plate stops": StagePath(
        lambda: armour("25 mm APDS", "AD99.5", "6061-T6", 12.6, 11.6),
        720.0,
        ["Ieph", "Iech", "Fecm", "Fepm", "Feph", "Prpm", "Prcm"],
    ),
    "plate moves, stops and moves": StagePath(
        armour,
        800.0,
        ["Ieph", "Fepm", "Feph", "Prpm", "Prcm"],
    ),
    "rigid in rubble": StagePath(
        lambda: armour("25 mm APDS", "AD85", "6061-T6", 25.5, 5.0),
        700.0,
        ["Ieph", "Fepm", "Feph", "Frph", "Prpm", "Prcm"],
    ),
    "rod erodes in the plate": StagePath(
        lambda: armour("7.62 mm AP", "Al-N", "7075-T6", 3.0, 20.0),
        1220.0,
        ["Ieph", "Feph", "Peph", "Pepm", "Prpm", "Prcm"],
    ),
    "plate carried by an eroding rod": StagePath(
        lambda: armour("25 mm APDS", "AD85", "6061-T6", 6.0, 8.0)._replace(YB=12e9),
        900.0,
        ["Ieph", "Fepm", "Pecm", "Prcm"],
    ),
}


@cache
def random_designs(count: int) -> tuple[Parameters, ...]:
    """Random armours of the paper's projectiles and materials."""
    rng = np.random.default_rng(20)
    designs = []
    for _ in range(count):
        projectile, diameter = [("7.62 mm AP", 6.5), ("25 mm APDS", 14.25)][rng.integers(2)]
        designs.append(
            armour(
                projectile,
                str(rng.choice(["AD85", "AD99.5", "Al-N"])),
                str(rng.choice(["6061-T6", "7075-T6", "5083-H3"])),
                diameter * float(rng.uniform(0.2, 3.0)) * float(rng.random() > 0.1),
                diameter * float(rng.uniform(0.3, 2.5)),
                perimeter=str(rng.choice(["conoid", "projectile"])),
            )
        )
    return tuple(designs)


def quantities(table: Table) -> dict[str, str]:
    """Texts of a record by heading."""
    [texts] = table.texts()
    return dict(zip(table.headings(), texts, strict=True))


def best_design(**changes: Any) -> BestDesign:
    """A best design; by default the paper's 7.62 mm optimum."""
    design: dict[str, Any] = {
        "ceramic": "AD85",
        "backing": "5083-H3",
        "ceramic_thickness_mm": 11.0,
        "backing_thickness_mm": 6.0,
        "areal_density_kg_m2": 54.23,
        "thickness_mm": 17.0,
        "cost_per_m2": 0.0,
        "margin_m_s": 3.1,
        "ballistic_limit_m_s": 853.1,
        "ceramic_density_kg_m3": 3430.0,
        "backing_density_kg_m3": 2750.0,
        "margins_m_s": {"AP": 3.1},
        "governing": "AP",
        "probabilities": {},
    }
    return BestDesign(**{**design, **changes})


def design_result(**changes: Any) -> DesignResult:
    """A design result of one pair against one threat."""
    best = changes.get("best", best_design())
    frontier = tuple(
        Design("AD85", "5083-H3", ceramic, backing, areal_density, ceramic + backing, 0.0, None)
        for ceramic, backing, areal_density in [(12.0, 5.0, 55.1), (11.0, 6.0, 54.23), (10.5, 7.0, 55.265)]
    )
    result: dict[str, Any] = {
        "minimised": "areal_density_kg_m2",
        "threats": ("AP",),
        "best": best,
        "frontier": frontier,
        "frontier_governed_by": ("AP",) * len(frontier),
        "refined": None,
        "pairs": (Pair("AD85", "5083-H3", best, 0.0, ""),),
        "criteria": (),
        "pareto": (),
        "designs": 52,
        "examined": 12,
        "runs": 40,
        "not_monotonic_mm": (),
        "warnings": (),
    }
    return DesignResult(**{**result, **changes})
