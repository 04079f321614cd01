"""An armour at an angle is the thickened armour at normal incidence, along the line of fire."""

from math import cos, radians

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.impact import simulate
from armour.scenario.inputs import BACKING, CERAMIC, OBLIQUITY
from armour.scenario.scenario import Scenario
from armour.validation.formulas import florence_limits
from tests.helpers.cases import scenario

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0)
CASES = {
    "constant": scenario(),
    "product law": scenario(ceramic="AD85 product law", ceramic_mm=9.0),
    "25 mm": scenario("25 mm APDS", "AD99.5", "7075-T6", 20.0, 12.0, 1100.0),
    "bare": scenario(ceramic=None, ceramic_mm=0.0, backing_mm=14.0),
}


def thickened(case: Scenario, angle: float) -> Scenario:
    cosine = cos(radians(angle))
    layers = {CERAMIC: case.armour.ceramic_thickness_mm / cosine, BACKING: case.armour.backing_thickness_mm / cosine}
    return case.replaced(layers)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_limits_at_an_angle_are_those_of_the_thickened_armour_to_the_last_bit(case: Scenario):
    compiled = evaluate(case, {OBLIQUITY: np.array(ANGLES)}, ["ballistic_limit_m_s", "residual_velocity_m_s"])
    for angle, limit, residual in zip(ANGLES, *compiled.values(), strict=True):
        oblique, normal = case.replaced({OBLIQUITY: angle}), thickened(case, angle)
        assert ballistic_limit(oblique).ballistic_limit_m_s == ballistic_limit(normal).ballistic_limit_m_s
        assert ballistic_limit(oblique).ballistic_limit_m_s == pytest.approx(limit, abs=1e-9)
        [alone] = evaluate(normal, {}, ["ballistic_limit_m_s"])["ballistic_limit_m_s"]
        assert alone == limit
        expected = simulate(normal).residual_velocity_m_s
        assert simulate(oblique).residual_velocity_m_s == expected
        assert residual == pytest.approx(expected, abs=1e-9)


def test_areal_density_is_that_of_the_panel():
    densities = evaluate(scenario(), {OBLIQUITY: np.array(ANGLES)}, ["areal_density_kg_m2"])["areal_density_kg_m2"]
    assert densities == pytest.approx([scenario().areal_density_kg_m2()] * 5, rel=1e-15)
    assert scenario().replaced({OBLIQUITY: 60.0}).areal_density_kg_m2() == scenario().areal_density_kg_m2()


def test_the_least_thickness_at_an_angle_is_that_along_the_line_of_fire():
    grid = {name: {"min": 1.0, "max": 30.0, "step": 0.5} for name in ("ceramic_thickness_mm", "backing_thickness_mm")}
    case = scenario(optimise=grid, velocity=900.0)
    names = ["required_ceramic_thickness_mm", "required_backing_thickness_mm", "required_total_thickness_mm"]
    found = evaluate(case, {OBLIQUITY: np.array(ANGLES)}, names)
    for i, angle in enumerate(ANGLES):
        oblique = case.replaced({OBLIQUITY: angle})
        for name, key in zip(names[:2], (CERAMIC, BACKING), strict=True):
            for excess, outcome in ((2e-6, "stopped"), (-2e-4, "perforated")):
                assert simulate(oblique.replaced({key: found[name][i] + excess})).outcome == outcome
    totals = found["required_total_thickness_mm"] / np.cos(np.radians(ANGLES))
    assert totals == pytest.approx(np.full(5, totals[0]), abs=2e-4)


def test_formulas_count_along_the_line_of_fire():
    oblique = scenario().replaced({OBLIQUITY: 30.0})
    assert florence_limits(oblique) == florence_limits(thickened(scenario(), 30.0))
