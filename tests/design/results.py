"""Results of design."""

from typing import Any

from armour.design.optimise import BestDesign, Design, DesignResult, Pair
from armour.evidence.model_error import ModelError

THREAT, OTHER = "7.62 mm AP at 800 m/s", "M2"


def design(ceramic: str, ceramic_mm: float, backing_mm: float, areal_density: float, cost: float = 0.0) -> Design:
    """A design on 6061-T6."""
    thickness = ceramic_mm + backing_mm
    others = False, areal_density, thickness, dict[str, float]()
    return Design(ceramic, "6061-T6", ceramic_mm, backing_mm, areal_density, thickness, cost, None, *others)


def best_of(result: DesignResult) -> BestDesign:
    """The best design of a result that has one."""
    assert result.best is not None, result.explanation
    assert result.reason == ""
    return result.best


def best_design(*args: Any, **changes: Any) -> BestDesign:
    """A best design: that of `design`, with a ballistic limit of 820 m/s; by default 8 mm of AD85 on 6 mm."""
    values: dict[str, Any] = {
        **vars(design(*args or ("AD85", 8.0, 6.0, 43.6))),
        "margin_m_s": 20.0,
        "ballistic_limit_m_s": 820.0,
        "ceramic_density_kg_m3": 3430.0,
        "backing_density_kg_m3": 2700.0,
        "margins_m_s": {THREAT: 20.0},
        "governing": THREAT,
        "probabilities": {},
        "probabilities_of_stopping": {THREAT: 0.64, OTHER: None},
        "model_error": ModelError(0.0, 7.0, 12.0, "13 tests"),
        "short_m_s": {THREAT: 0.0},
        "exceeds": {},
    }
    return BestDesign(**{**values, **changes})


def design_result(
    *, refined: bool = False, threats: tuple[str, ...] = (THREAT,), pareto: bool = False, ceramic: str = "AD85"
) -> DesignResult:
    """Three designs of a pair, of which the second is the best, and with a Pareto front a pair that is heavier."""
    found = best_design(ceramic, 8.0, 6.0, 43.6, 100.0)
    frontier = (design(ceramic, 10.0, 4.0, 45.0), design(ceramic, 8.0, 6.0, 43.6), design(ceramic, 7.0, 8.0, 45.6))
    heavier = Pair("AD99.5", "6061-T6", best_design("AD99.5", 7.5, 7.0, 48.0, 80.0), 10.1, "10.1 % heavier")
    none = Pair("Al-N", "6061-T6", None, None, "perforated by M2")
    return DesignResult(
        minimised="areal_density_kg_m2",
        threats=threats,
        best=found,
        reason="",
        explanation="",
        nearest=None,
        without_limits=None,
        frontier=frontier,
        frontier_governed_by=(threats[-1],) * 3,
        refined=best_design(ceramic, 8.1, 5.8, 43.4) if refined else None,
        pairs=(Pair(ceramic, "6061-T6", found, 0.0, ""), *((heavier, none) if pareto else ())),
        criteria=("areal_density_kg_m2", "cost_per_m2") if pareto else (),
        pareto=(design(ceramic, 8.0, 6.0, 43.6, 100.0), design("AD99.5", 7.5, 7.0, 48.0, 80.0)) if pareto else (),
        designs=100,
        runs=200,
        not_monotonic_mm=(),
        notes=(),
    )
