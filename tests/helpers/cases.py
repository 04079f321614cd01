"""Scenarios, armours and files."""

from functools import cache
from pathlib import Path
from typing import Any

from armour.analysis.impact import run_impact
from armour.core.state import Outcome, Parameters
from armour.scenario.scenario import Scenario, load_scenario, parse_scenario
from armour.sweeps.cases import Grid, axis_of

SCENARIOS = Path(__file__).parents[2] / "scenarios"
# Shipped scenarios that lack nothing, and those to complete.
TEMPLATES = sorted(SCENARIOS.glob("templates/*.toml"))
COMPLETE = sorted({*SCENARIOS.rglob("*.toml")} - {*TEMPLATES})
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
    {"material": "AD99.5", "thickness_mm": [4.5, 6.5, 9.0], "cost_per_kg": 30.0},
]
METALS = [
    {"material": "6061-T6", "thickness_mm": RANGE, "cost_per_kg": 7.0, "cost_per_m2": 15.0},
    {"material": "7075-T6", "thickness_mm": [4.0, 6.0, 8.0], "cost_per_kg": 11.0},
]


# The model error, of armours that were tested and others.
GIVEN = {"scale_percent": 7.0, "degrees_of_freedom": 12.0, "source": "13 tests"}


def sourced(flow_stress_GPa: float) -> dict[str, Any]:
    """The flow stress of a ceramic without tests, as two sources give it."""
    value = {"value": flow_stress_GPa, "source": "two reports"}
    return {"flow_stress_GPa": value, "flow_stress_sources_GPa": [flow_stress_GPa, flow_stress_GPa]}


def catalogue(threats: Any = THREATS, uncertain: Any = None, **design: Any) -> Scenario:
    """A scenario with a catalogue of two ceramics and two metals against two threats."""
    sections: dict[str, Any] = {"threat": threats, "design": {"ceramic": CERAMICS, "backing": METALS, **design}}
    return scenario(**sections, uncertainty=uncertain or {"model": GIVEN})


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
        "ceramic": {"c": {"density_kg_m3": ceramic[0], "youngs_modulus_GPa": ceramic[1], **sourced(ceramic[2])}},
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


def grid(ceramic: tuple[float, float, float], backing: tuple[float, float, float]) -> dict[str, Any]:
    """Thicknesses of a grid, by the least and the greatest of each layer and the step, mm."""
    ranges = (dict(zip(("min", "max", "step"), ends, strict=True)) for ends in (ceramic, backing))
    return dict(zip(("ceramic_thickness_mm", "backing_thickness_mm"), ranges, strict=True))


def offer(ceramic: str, ceramic_mm: Any, backing: str, backing_mm: Any) -> dict[str, Any]:
    """A design section of one ceramic and one metal with their thicknesses: a list, or a range."""
    layers = (ceramic, ceramic_mm), (backing, backing_mm)
    sections = ([{"material": name, "thickness_mm": thickness}] for name, thickness in layers)
    return dict(zip(("ceramic", "backing"), sections, strict=True))


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


def perforates(scenario: Scenario, velocity: float) -> bool:
    """Whether the projectile of a scenario perforates its armour at an impact velocity, m/s."""
    return run_impact(scenario, velocity)[0].outcome == Outcome.PERFORATED
