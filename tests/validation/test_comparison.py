import json
from functools import cache
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.core.equations import fragmented_strength
from armour.engine.changes import equations
from armour.errors import InputError, NoAnswerError
from armour.reporting.views.validation import rule_note
from armour.validation.comparison import Comparison, compare
from armour.validation.formulas import florence_ballistic_limit, residual_velocity
from tests.helpers.cases import scenario

pytestmark = pytest.mark.slow


@cache
def wilkins() -> Comparison:
    """Comparison for the Wilkins case."""
    return compare(scenario())


def test_the_wilkins_case():
    result = wilkins()
    assert result.limit == ballistic_limit(scenario())
    penetrator, whole = result.florence
    assert (penetrator.mass_g, penetrator.diameter_mm) == (5.46, 6.5)
    assert (whole.mass_g, whole.diameter_mm) == (8.32, 7.62)
    assert penetrator.ballistic_limit_m_s == florence_ballistic_limit(scenario())
    assert whole.ballistic_limit_m_s == pytest.approx(436.72, abs=0.01)


def test_the_best_split_keeps_the_areal_density_and_is_better():
    for florence in wilkins().florence:
        mass = 3.43 * florence.best_ceramic_thickness_mm + 2.75 * florence.best_backing_thickness_mm
        assert mass == pytest.approx(scenario().areal_density_kg_m2())
        assert florence.best_ballistic_limit_m_s > florence.ballistic_limit_m_s
        ratio = florence.best_ceramic_thickness_mm / florence.best_backing_thickness_mm
        assert florence.best_thickness_ratio == pytest.approx(ratio)
        there = scenario(ceramic_mm=florence.best_ceramic_thickness_mm, backing_mm=florence.best_backing_thickness_mm)
        assert florence.model_ballistic_limit_m_s == ballistic_limit(there).ballistic_limit_m_s


def test_the_fits_have_the_residuals_that_they_report():
    result = wilkins()
    limit = result.limit.ballistic_limit_m_s
    above = [impact for impact in result.curve if impact.impact_velocity_m_s > limit]
    assert result.fitted_m_s == (above[0].impact_velocity_m_s, above[-1].impact_velocity_m_s)
    assert [fit.name for fit in result.fits] == ["Lambert-Jonas", "Recht-Ipson"]
    for fit in result.fits:
        left = [
            impact.residual_velocity_m_s - residual_velocity(impact.impact_velocity_m_s, limit, fit.ratio, fit.exponent)
            for impact in above
        ]
        assert fit.rms_m_s == pytest.approx((sum(d * d for d in left) / len(left)) ** 0.5)
    assert result.fits[0].rms_m_s <= result.fits[1].rms_m_s


def test_plain_data():
    data = json.loads(json.dumps(wilkins().to_dict()))
    assert data["ballistic_limit_m_s"] == pytest.approx(723.778, abs=1e-3)
    assert data["florence"][0]["projectile"] == "penetrator"
    assert [rule["p_fitted"] for rule in data["areal_density_rules"]] == [False, True]
    assert data["errors"][-1]["left_out_percent"] == pytest.approx(4.6157, abs=1e-3)


def test_a_projectile_with_a_known_penetrator_only():
    thick = scenario(projectile="25 mm APDS", ceramic_mm=20.0, backing_mm=30.0)
    assert [florence.projectile for florence in compare(thick).florence] == ["penetrator"]


def test_the_rule_of_areal_density():
    result = wilkins()
    one, fitted = result.rules
    assert (one.p, one.p_fitted, fitted.p_fitted) == (1.0, False, True)
    assert one.ballistic_limit_m_s == pytest.approx(17.5953 * 39.243, abs=0.01)
    assert fitted.ballistic_limit_m_s == pytest.approx(fitted.k * 39.243**fitted.p)
    assert {error.predictor for error in result.errors} >= {"the paper's program", "this model"}
    assert result.tests.startswith("13 tests of 7.62 mm AP on AD85 and 6061-T6, 35.8 to 52.5 kg/m²")


@pytest.mark.parametrize(
    "change",
    [
        {"ceramic": "AD99.5"},
        {"backing": "5083-H3"},
        {"library": {"metal": {"6061-T6": {"based_on": "6061-T6", "density_kg_m3": 2700.0}}}},
    ],
)
def test_no_rule_for_other_materials(change: dict[str, Any]):
    result = compare(scenario(**change))
    assert (result.rules, result.errors) == ((), ())
    assert "none, without tests of this round and these materials; there are 13 tests" in rule_note(result)


def test_all_missing_quantities_are_named():
    own = {"metal": {"m": {"density_kg_m3": 2700.0, "dynamic_yield_strength_MPa": 300.0}}}
    case = scenario(backing="m", ceramic=None, ceramic_mm=0.0, library=own)
    with pytest.raises(InputError) as error:
        compare(case)
    assert [problem.key for problem in error.value.problems] == [
        "armour.ceramic_thickness_mm",
        "library.metal.m.ultimate_tensile_strength_MPa",
        "library.metal.m.strain_to_fracture",
    ]


def test_a_range_that_ends_at_the_limit_has_nothing_to_fit():
    limit = wilkins().limit.ballistic_limit_m_s
    with pytest.raises(NoAnswerError, match="no fit: the range of velocities ends at the ballistic limit"):
        compare(scenario(ballistic_limit={"velocity_max_m_s": limit}))


def test_the_best_split_may_have_its_limit_outside_the_range():
    own = wilkins()
    best, *_ = [found.model_ballistic_limit_m_s for found in own.florence]
    assert best is not None
    assert best < own.limit.ballistic_limit_m_s - 10.0
    between = compare(scenario(ballistic_limit={"velocity_min_m_s": best + 5.0}))
    assert between.florence[0].model_ballistic_limit_m_s is None


def test_no_errors_of_other_equations_are_shown():
    case = scenario()
    with equations(fragmented_strength=lambda *args: 0.8 * fragmented_strength(*args)):
        assert compare(case).errors == ()
    assert compare(case).errors
