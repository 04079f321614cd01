"""Geometrically similar cases: equal velocities and mass ratios, times in proportion."""

from collections.abc import Mapping

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.scenario.scenario import Scenario, parse_scenario
from tests.helpers.cases import data

LAWS: list[dict[str, float]] = [
    {"flow_stress_backing_exponent": 0.5},
    {"flow_stress_product_exponent": -0.4},
    {"flow_stress_ceramic_slope": 0.3},
    {"flow_stress_backing_slope": -0.2},
]
CASES = [
    {},
    {"velocity": 740.0},
    {"ceramic": "Al-N", "velocity": 560.0},
    {"ceramic": None, "ceramic_mm": 0.0, "velocity": 500.0},
]


def scaled(case: dict[str, object], k: float, law: Mapping[str, float] | None = None) -> Scenario:
    """The case with every length multiplied by k, the mass by its cube, and a law of the flow stress."""
    content = data(**case)  # type: ignore[arg-type]
    content["armour"]["ceramic_thickness_mm"] *= k
    content["armour"]["backing_thickness_mm"] *= k
    content["impact"]["projectile"] = "similar"
    content["library"] = {
        "projectile": {
            "similar": {"based_on": "7.62 mm AP", "penetrator_mass_g": 5.46 * k**3, "penetrator_diameter_mm": 6.5 * k}
        },
        "ceramic": {"AD85": {"based_on": "AD85", **(law or {})}},
    }
    return parse_scenario(content)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("k", [0.1, 2.0, 3.7, 20.0])
def test_similar_impacts_are_equal(case: dict[str, object], k: float):
    one, other = simulate(scaled(case, 1.0)), simulate(scaled(case, k))
    assert other.outcome == one.outcome
    assert other.residual_velocity_m_s == pytest.approx(one.residual_velocity_m_s, rel=1e-9)
    assert other.plug_velocity_m_s == pytest.approx(one.plug_velocity_m_s, rel=1e-9)
    assert other.residual_length_mm == pytest.approx(k * one.residual_length_mm, rel=1e-9)
    assert other.residual_mass_g == pytest.approx(k**3 * one.residual_mass_g, rel=1e-9)
    assert other.duration_us == pytest.approx(k * one.duration_us, rel=1e-9)
    assert other.penetration_depth_mm == pytest.approx(k * one.penetration_depth_mm, rel=1e-9)
    assert [s.stage for s in other.stages] == [s.stage for s in one.stages]


def test_similar_armours_have_the_same_ballistic_limit():
    limits = [ballistic_limit(scaled({}, k)).ballistic_limit_m_s for k in (0.1, 1.0, 3.7)]
    assert limits == pytest.approx([limits[1]] * 3, rel=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: next(iter(law)))
def test_laws_of_the_flow_stress_keep_the_similarity(law: dict[str, float]):
    case: dict[str, object] = {"ceramic_mm": 9.0, "backing_mm": 5.0}
    one, other = (ballistic_limit(scaled(case, k, law)).ballistic_limit_m_s for k in (1.0, 2.0))
    assert other == pytest.approx(one, rel=1e-9)
    assert abs(one - ballistic_limit(scaled(case, 1.0)).ballistic_limit_m_s) > 5.0
