"""Results of design."""

from dataclasses import replace
from functools import cache
from typing import Any

from armour.design.check import CheckResult, check
from armour.design.optimise import BestDesign, Design, DesignResult, Pair
from tests.helpers.cases import scenario

THREAT, OTHER = "7.62 mm AP at 800 m/s", "M2"


@cache
def checked(*threats: str) -> CheckResult:
    """The check of an armour that passes against some of the two threats."""
    faced = [
        {"projectile": "7.62 mm AP", "velocity_m_s": 800.0},
        {"projectile": "7.62 mm APM2", "velocity_m_s": 760.0, "name": OTHER},
    ]
    return check(scenario(ceramic_mm=8.0, backing_mm=6.0, threat=faced[: len(threats)]))


def design(ceramic: str, ceramic_mm: float, backing_mm: float, areal_density: float, cost: float = 0.0) -> Design:
    """A design on 6061-T6."""
    thickness = ceramic_mm + backing_mm
    others = False, areal_density, thickness, 20.0, THREAT, ()
    return Design(ceramic, "6061-T6", ceramic_mm, backing_mm, areal_density, thickness, cost, *others)


def best_of(result: DesignResult) -> BestDesign:
    """The best design of a result that has one."""
    assert result.best is not None, result
    assert result.reason == ""
    return result.best


def best_design(*args: Any, threats: tuple[str, ...] = (THREAT,), **changes: Any) -> BestDesign:
    """A best design: that of `design` with a check of an armour like it; by default 8 mm of AD85 on 6 mm."""
    values: dict[str, Any] = {
        **vars(design(*args or ("AD85", 8.0, 6.0, 43.6))),
        "check": checked(*threats),
        "ceramic_density_kg_m3": 3430.0,
        "backing_density_kg_m3": 2700.0,
        "short_m_s": dict.fromkeys(threats, 0.0),
    }
    return BestDesign(**{**values, **changes})


def design_result(*, threats: tuple[str, ...] = (THREAT,), pareto: bool = False, ceramic: str = "AD85") -> DesignResult:
    """Three designs of a pair, of which the second is the best, and with a Pareto front a pair that is heavier."""
    found = best_design(ceramic, 8.0, 6.0, 43.6, 100.0, threats=threats)
    frontier = (design(ceramic, 10.0, 4.0, 45.0), design(ceramic, 8.0, 6.0, 43.6), design(ceramic, 7.0, 8.0, 45.6))
    heavier = best_design("AD99.5", 7.5, 7.0, 48.0, 80.0, threats=threats)
    others = (
        Pair("AD99.5", "6061-T6", heavier, None, 10.1, True, True),
        Pair("Al-N", "6061-T6", None, None, None, True, True),
    )
    return DesignResult(
        minimised="areal_density_kg_m2",
        threats=threats,
        best=found,
        reason="",
        nearest=None,
        frontier=frontier,
        pairs=(Pair(ceramic, "6061-T6", found, None, 0.0, True, False), *(others if pareto else ())),
        criteria=("areal_density_kg_m2", "cost_per_m2") if pareto else (),
        pareto=(
            design(ceramic, 8.0, 6.0, 43.6, 100.0),
            replace(design("AD99.5", 7.5, 7.0, 48.0, 80.0), far_from_tests=("AD99.5 (no test)",)),
        )
        if pareto
        else (),
        designs=100,
        runs=200,
        notes=(),
    )
