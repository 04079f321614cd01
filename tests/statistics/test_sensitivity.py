"""Elasticities against what similarity demands and against runs of changed scenarios."""

from math import log

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.statistics.measured import LIMIT, RESIDUAL
from armour.statistics.sensitivity import CHANGE, sensitivity
from tests.helpers.cases import scenario, shipped_scenario

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "changes", [(), ("25 mm APDS", "AD99.5", "5083-H3", 30.0, 20.0, 1250.0)], ids=["7.62 mm", "25 mm"]
)
def test_similar_cases_have_the_same_limit(changes: tuple[object, ...]):
    """Lengths times k, stresses times k^2 with velocities times k, densities times k with velocities over k^(1/2)."""
    e = {item.input: item.elasticities[LIMIT] or 0.0 for item in sensitivity(scenario(*changes)).inputs}
    mass = e["projectile.penetrator_mass_g"]
    lengths = sum(e[name] for name in e if name.endswith(("thickness_mm", "diameter_mm")))
    assert lengths + 3.0 * mass == pytest.approx(0.0, abs=1e-3)
    stresses = sum(e[name] for name in e if name.endswith(("_GPa", "backing.shear_strength_MPa")))
    assert stresses == pytest.approx(0.5, abs=1e-3)
    assert sum(e[name] for name in e if "density" in name) + mass == pytest.approx(-0.5, abs=1e-3)


def test_elasticities_agree_with_changed_scenarios():
    case = shipped_scenario("wilkins")
    result = sensitivity(case)
    inputs = case.inputs()
    step = log((1.0 + CHANGE) / (1.0 - CHANGE))
    for item in result.inputs:
        up, down = (case.with_inputs({item.input: inputs[item.input] * (1.0 + s * CHANGE)}) for s in (1.0, -1.0))
        residual = log(simulate(up).residual_velocity_m_s / simulate(down).residual_velocity_m_s) / step
        assert item.elasticities[RESIDUAL] == pytest.approx(residual, abs=1e-9)
    strength = next(item for item in result.inputs if item.input == "ceramic.flow_stress_GPa")
    up, down = (case.with_inputs({strength.input: 5.2 * (1.0 + s * CHANGE)}) for s in (1.0, -1.0))
    limits = [ballistic_limit(c.replaced({"ballistic_limit.tolerance_m_s": 1e-7})) for c in (up, down)]
    assert strength.elasticities[LIMIT] == pytest.approx(
        log(limits[0].ballistic_limit_m_s / limits[1].ballistic_limit_m_s) / step, abs=1e-6
    )


def test_the_limit_is_that_of_the_scenario():
    """For some armours the limits of the finite differences round to another hundredth."""
    for ceramic_mm in (6.35, 8.0, 9.5, 11.0):
        case = scenario(ceramic_mm=ceramic_mm)
        assert sensitivity(case).answers[LIMIT] == ballistic_limit(case).ballistic_limit_m_s


def test_an_exponent_acts_through_the_flow_stress():
    """The elasticity of an exponent n, also of a negative one, is that of the flow stress times n ln(Hb/D)."""
    for exponent in (-0.4, 0.6):
        entry = {"based_on": "AD85", "flow_stress_backing_exponent": exponent}
        library = {"ceramic": {"AD85": entry}}
        case = scenario(backing_mm=9.0, library=library, ballistic_limit={"tolerance_m_s": 1e-6})
        e = {item.input: item.elasticities[LIMIT] or 0.0 for item in sensitivity(case).inputs}
        expected = e["ceramic.flow_stress_GPa"] * exponent * log(9.0 / 6.5)
        assert e["ceramic.flow_stress_backing_exponent"] == pytest.approx(expected, rel=1e-3)


def test_missing_answers():
    stopped = sensitivity(scenario(velocity=500.0))
    assert stopped.answers[RESIDUAL] is None
    assert all(item.elasticities[RESIDUAL] is None for item in stopped.inputs)
    order = [abs(item.elasticities[LIMIT] or 0.0) for item in stopped.inputs]
    assert order == sorted(order, reverse=True)
    velocity = next(item for item in stopped.inputs if item.input == "impact.velocity_m_s")
    assert velocity.elasticities[LIMIT] is None


def test_a_bare_plate():
    result = sensitivity(scenario(ceramic=None, ceramic_mm=0.0))
    assert not any(item.input.startswith("ceramic.") for item in result.inputs)
    assert sum(i.elasticities[LIMIT] or 0.0 for i in result.inputs if "flow" in i.input or "shear" in i.input) == (
        pytest.approx(0.5, abs=1e-3)
    )
