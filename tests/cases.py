"""Scenarios and armours that several tests use."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from armour.core.run import Instant, Run, run
from armour.core.stages import default_time_step
from armour.core.state import Parameters
from armour.reporting.table import Table
from armour.scenario.loading import Scenario, parse_scenario

SCENARIOS = Path(__file__).parent.parent / "scenarios"


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


def quantities(table: Table) -> dict[str, str]:
    """Texts of a record by heading."""
    [texts] = table.texts()
    return dict(zip(table.headings(), texts, strict=True))


def best_design(**changes: Any) -> Any:
    """A design as `armour.design.optimise.BestDesign` has it; by default the paper's 7.62 mm optimum."""
    design = {
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
    return SimpleNamespace(**{**design, **changes})


def design_result(**changes: Any) -> Any:
    """A result as `armour.design.optimise.DesignResult` has it: one pair, one threat."""
    best = changes.get("best", best_design())
    frontier = [(12.0, 5.0, 55.1), (11.0, 6.0, 54.23), (10.5, 7.0, 55.265)]
    result = {
        "minimised": "areal_density_kg_m2",
        "threats": ("AP",),
        "best": best,
        "frontier": tuple(
            best_design(
                ceramic_thickness_mm=ceramic,
                backing_thickness_mm=backing,
                areal_density_kg_m2=areal_density,
                margin_m_s=None,
            )
            for ceramic, backing, areal_density in frontier
        ),
        "frontier_governed_by": ("AP",) * len(frontier),
        "refined": None,
        "pairs": (SimpleNamespace(ceramic="AD85", backing="5083-H3", best=best, excess_percent=0.0, reason=""),),
        "criteria": (),
        "pareto": (),
        "designs": 52,
        "examined": 12,
        "runs": 40,
        "not_monotonic_mm": (),
        "warnings": (),
    }
    return SimpleNamespace(**{**result, **changes})
