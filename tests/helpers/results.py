"""Results, and texts of tables."""

from functools import cache
from typing import Any

from armour.analysis.estimates import Estimate
from armour.analysis.impact import ImpactResult, simulate
from armour.design.optimise import BestDesign, Design, DesignResult, Pair
from armour.evidence.model_error import ModelError
from armour.planning.plan_tests import PlannedTest, PlannedTests
from armour.reporting.table import Table
from armour.scenario.inputs import CERAMIC
from armour.statistics.uncertainty import Influence, ProbabilityCurve, UncertaintyResult
from tests.helpers.cases import scenario

THREAT, OTHER = "7.62 mm AP at 800 m/s", "M2"


@cache
def impact(velocity: float = 800.0) -> ImpactResult:
    """The impact of the Wilkins case, with its history."""
    return simulate(scenario(velocity=velocity), history=True)


def design(ceramic: str, ceramic_mm: float, backing_mm: float, areal_density: float, cost: float = 0.0) -> Design:
    """A design on 6061-T6."""
    thickness = ceramic_mm + backing_mm
    return Design(
        ceramic,
        "6061-T6",
        ceramic_mm,
        backing_mm,
        areal_density,
        thickness,
        cost,
        None,
        untested=False,
        outside_tests={},
    )


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
        warnings=(),
    )


def uncertainty_result() -> UncertaintyResult:
    """A probability that rises from 640 to 810 m/s, from two inputs."""
    velocities = (600.0, 640.0, 680.0, 720.0, 770.0, 810.0, 900.0)
    probabilities = (0.0, 0.0, 0.05, 0.5, 0.95, 1.0, 1.0)
    return UncertaintyResult(
        samples=1024,
        seed=1,
        method="sobol",
        confidence=0.95,
        probability_of_perforation=Estimate(0.21, 0.2, 0.22),
        ballistic_limit_m_s={
            "V05": Estimate(680.0, 678.0, 682.0),
            "V50": Estimate(720.0, 719.0, 721.0),
            "V95": Estimate(770.0, 768.0, 772.0),
        },
        mean_m_s=721.0,
        mean_interval_m_s=(720.8, 721.2),
        standard_deviation_m_s=27.0,
        deterministic_m_s=723.8,
        curve=ProbabilityCurve(
            velocities,
            probabilities,
            tuple(max(p - 0.01, 0.0) for p in probabilities),
            tuple(min(p + 0.01, 1.0) for p in probabilities),
        ),
        inputs=(
            Influence("ceramic.flow_stress_GPa", None, None, (677.0, 769.0)),
            Influence("projectile.penetrator_mass_g", None, None, (729.0, 718.0)),
        ),
        warnings=(),
    )


def planned_tests() -> PlannedTests:
    """One planned test of two candidates."""
    values = {"ceramic.flow_stress_GPa": 5.2}
    known = {"ceramic.flow_stress_GPa": 0.3}
    before = PlannedTest(0, {CERAMIC: ""}, None, None, None, dict.fromkeys(values), (None,))
    first = PlannedTest(1, {CERAMIC: 8.0}, 800.0, None, None, {**known}, (20.0,))
    return PlannedTests(
        planned=(before, first),
        criterion="D",
        measure="limit",
        law="constant",
        values=values,
        tests="",
        scatter_percent=3.0,
        scatter_known=True,
        scatter_source="given",
        designs=("wilkins.toml",),
        design_limits_m_s=(720.0,),
        efficiency=1.0,
        not_identified=(),
        candidates={CERAMIC: (6.0, 8.0)},
        sensitivities=(0.8, 1.0),
        confidence=0.95,
        warnings=(),
    )


def headings(table: Table) -> list[str]:
    """Headings of the columns."""
    return [column.heading for column in table.columns]


def quantities(table: Table) -> dict[str, str]:
    """Texts of a record by heading."""
    [texts] = table.texts()
    return dict(zip(headings(table), texts, strict=True))
