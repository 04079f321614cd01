"""The model error on tests, for the armours that it holds for."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence, model_error, no_error
from armour.analysis.evaluate import evaluate
from armour.analysis.variants import row_of, variants_of
from armour.design.check import check
from armour.design.optimise import optimise
from armour.errors import InputError
from armour.evidence.fit import fits
from armour.evidence.model_error import ModelError
from armour.evidence.tests import FARTHEST_CERAMIC, shipped_evidence
from armour.reporting.views.analysis import tables_of_confidence
from armour.reporting.words import chance
from armour.scenario.inputs import OBLIQUITY
from armour.scenario.scenario import Scenario
from armour.statistics.uncertainty import uncertainty
from tests.design.results import best_of
from tests.helpers.cases import scenario
from tests.helpers.known import known

EVIDENCE = {evidence.fits[0].name: evidence for evidence in shipped_evidence() if evidence.fits}
TILES = EVIDENCE["constant"]
LAWS = ("AD85", "AD85 backing law", "AD85 product law")
BARE: dict[str, Any] = {"ceramic": None, "ceramic_mm": 0.0, "projectile": "7.62 mm APM2"}
STRONG = {"metal": {"strong": {"based_on": "AA6082-T651", "dynamic_yield_strength_MPa": 500.0}}}
HEAVY = {"projectile": {"heavy": {"based_on": "7.62 mm AP", "density_kg_m3": 10000.0, "penetrator_mass_g": 8.0}}}
SAME = {"based_on": "6061-T6"}
LAW = {"ceramic": {"law": {"based_on": "AD85", "flow_stress_backing_exponent": 0.8}}}
STEEL = {"metal": {"steel": {"density_kg_m3": 7850.0, "dynamic_yield_strength_MPa": 1300.0}}}


def error_of(case: Scenario, limit_m_s: float = 700.0) -> ModelError:
    return known(model_error(row_of(case), limit_m_s))


def test_the_error_is_that_of_tests_of_such_armours():
    assert (error_of(scenario()).source, error_of(scenario()).extrapolated) == (TILES.title, ())
    assert error_of(scenario(ceramic_mm=12.0, backing="5083-H3")).extrapolated == (
        "ceramics 0.89 to 1.21 penetrator diameters thick",
        "back plates with a flow stress of 1 to 1.1 GPa",
    )
    for projectile, metal, millimetres, evidence in (
        ("7.62 mm APM2", "6061-T6", 20.0, "cores_aluminium"),
        ("7.62 mm APM2", "steel", 9.0, "cores_steel"),
        ("20 mm FSP", "6061-T6", 20.0, "fragments_aluminium"),
        ("20 mm FSP", "steel", 17.0, "fragments_steel"),
    ):
        case = scenario(projectile, None, metal, 0.0, millimetres, library=STEEL)
        assert error_of(case).source == EVIDENCE[evidence].title


@pytest.mark.parametrize(
    "changes",
    [
        {"ceramic": "SiC"},
        {"ceramic": "AD99.5"},
        {"ceramic": "AD85 initial"},
        {"ceramic": "law", "library": LAW},
        {"backing": "Ti-6Al-4V"},
        {"projectile": "20 mm FSP"},
        {"projectile": "25 mm APDS", "ceramic_mm": 30.0, "backing_mm": 20.0},
        {"projectile": "heavy", "library": HEAVY},
        {"backing": "hard", "library": {"metal": {"hard": {**SAME, "shear_strength_MPa": 2600.0}}}},
        {"backing": "hard", "library": {"metal": {"hard": {**SAME, "dynamic_yield_strength_MPa": 3000.0}}}},
        {"projectile": "soft", "library": {"projectile": {"soft": {"based_on": "7.62 mm AP", "flow_stress_GPa": 0.2}}}},
    ],
)
def test_no_error_where_nothing_was_tested(changes: dict[str, Any]):
    case = scenario(**changes)
    assert model_error(row_of(case), 700.0) is None
    result = confidence(case)
    assert result.probability_of_stopping is None
    assert result.reason


def test_the_scenario_gives_the_error_or_excludes_it():
    with_error = scenario(
        ceramic="SiC", uncertainty={"model": {"scale_percent": 9.0, "degrees_of_freedom": 1e6, "source": "our tests"}}
    )
    error = error_of(with_error)
    assert error.source == "our tests"
    assert (error.mean_percent, error.scale_percent) == pytest.approx((0.0, 9.0))
    assert error.quantile(0.975) == pytest.approx(0.09 * 1.959964, rel=1e-4)
    assert model_error(row_of(scenario(uncertainty={"model": {"included": False}})), 700.0) is None


def test_the_scatter_of_shots_is_in_the_probability_and_not_in_the_limit():
    wider = {"design.scatter_percent": 6.0, "design.scatter_source": "tails of our firings"}
    case = scenario(velocity=650.0)
    usual, other = confidence(case), confidence(case.replaced(wider))
    assert other.interval_m_s == usual.interval_m_s
    # The limit at which half of all shots are stopped moves a little, as the laws of the flow stress differ.
    assert known(other.expected_limit_m_s) == pytest.approx(known(usual.expected_limit_m_s), abs=1.0)
    assert other.probability_v50_exceeds_velocity == usual.probability_v50_exceeds_velocity
    assert known(other.probability_of_stopping) < known(usual.probability_of_stopping)
    assert known(usual.probability_of_stopping) < known(usual.probability_v50_exceeds_velocity)
    error = known(other.model_error)
    assert (error.scatter_percent, error.scatter_source) == tuple(wider.values())


def test_the_scatter_of_the_entry_comes_before_that_of_the_design():
    own = {"metal": {"own": {"based_on": "6061-T6", "scatter_percent": 5.0, "scatter_source": "our tails"}}}
    bare = {**BARE, "backing": "own", "backing_mm": 20.0}
    for tiles, expected in ((bare, 5.0), ({"backing": "own"}, 3.0)):
        case = scenario(**tiles, library=own, design={"scatter_percent": 3.0, "scatter_source": "a guess"})
        assert error_of(case).scatter_percent == expected
        assert row_of(case).errors.scatters == pytest.approx(expected / 100.0)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("percent", [None, 5.0])
def test_one_probability_in_every_command(law: str, percent: float | None):
    only = {"thickness_mm": [6.35]}
    case = scenario(ceramic=law, velocity=700.0)
    if percent is not None:
        own = {"based_on": law, "scatter_percent": percent, "scatter_source": "our tails"}
        case = case.replaced({"library.ceramic.own": own, "armour.ceramic": "own"})
        law = "own"
    expected = confidence(case)
    assert expected.probability_of_stopping is not None
    catalogue = {"ceramic": [{"material": law, **only}], "backing": [{"material": "6061-T6", **only}]}
    [of_design] = best_of(optimise(case.replaced({"design": catalogue}))).check.threats
    [of_row] = evaluate(case, {}, ["probability_of_stopping"])["probability_of_stopping"]
    of_best = of_design.probability_of_stopping
    probabilities = [check(case).threats[0].probability_of_stopping, of_best, of_row]
    assert probabilities == pytest.approx([expected.probability_of_stopping] * 3, abs=1e-9)
    sampled = known(uncertainty(case.replaced({"uncertainty": {"samples": 4096}})).probability_of_perforation)
    assert 1.0 - sampled.value == pytest.approx(expected.probability_of_stopping, abs=0.005)
    limit = ballistic_limit(case)
    assert (limit.interval_m_s, limit.expected_limit_m_s) == (expected.interval_m_s, expected.expected_limit_m_s)


def test_the_error_of_a_plate_is_the_linear_model():
    """By hand: the terms of docs/howto/confidence.md for 20 mm of a plate with a strength of 260 and 310 MPa."""
    x, strength = np.log(20.0 / 6.25 / 5.0), np.log(260.0 / 300.0)
    core = np.log(5.3 / 6.25**3 / 0.0215)
    z = np.array([1.0, x, x * x, strength, np.log(310.0 / 260.0), core])
    fit = fits()["cores_aluminium_tensile"]
    error = error_of(scenario(backing="AA6082-T651", backing_mm=20.0, **BARE))
    assert error.mean_percent == pytest.approx(100.0 * np.expm1(z @ fit.coefficients))
    assert error.scale_percent == pytest.approx(100.0 * np.sqrt(fit.variance + z @ fit.covariance @ z))
    assert error.degrees_of_freedom == 18.0


def test_the_error_widens_beyond_the_tests_and_is_then_unknown():
    def scale(millimetres: float) -> float:
        error = error_of(scenario(backing="AA6082-T651", backing_mm=millimetres, **BARE))
        assert bool(error.extrapolated) == (millimetres > 9.7 * 6.25)
        return known(error.scale_percent)

    inside, beyond = scale(50.0), scale(9.7 * 6.25 * 1.3)
    assert beyond > 1.1 * inside
    far = scenario(backing="AA6082-T651", backing_mm=9.7 * 6.25 * 1.7, **BARE)
    assert model_error(row_of(far), 700.0) is None
    assert no_error(far).endswith(", which are of back plates 1.6 to 9.7 penetrator diameters thick")


@pytest.mark.parametrize("layer", ["ceramic", "backing"])
def test_with_a_ceramic_it_is_unknown_beyond_a_factor_of_two(layer: str):
    [high] = [limits.high for limits in TILES.measured if limits.name == f"{layer}_thickness_ratio"]
    for factor in (0.99, 1.01):
        case = scenario(**{f"{layer}_mm": factor * FARTHEST_CERAMIC * high * 6.5})
        assert (model_error(row_of(case), 700.0) is None) == (factor > 1.0)


def test_rows_have_the_errors_of_scenarios():
    thicknesses = np.array([4.0, 6.35, 30.0])
    errors = variants_of(scenario(), {"armour.ceramic_thickness_mm": thicknesses}, 3).errors
    assert errors.known.tolist() == [True, True, False]
    assert errors.ratio.weights[:, 0].sum() == pytest.approx(1.0)
    single_errors = variants_of(scenario(ceramic_mm=4.0), {}, 1).errors
    for many, single in zip(
        (*errors.ratio[:4], errors.parameters), (*single_errors.ratio[:4], single_errors.parameters), strict=True
    ):
        assert many[..., 0].tolist() == single[..., 0].tolist()


def test_quantiles_are_given():
    error = error_of(scenario(), 723.77)
    assert (error.mean_percent, error.scale_percent, error.degrees_of_freedom) == (None, None, None)
    for probability, percent in error.quantiles_percent.items():
        assert error.probability_v50_exceeds(1.0, 1.0 + percent / 100.0) == pytest.approx(1.0 - float(probability))
    with pytest.raises(InputError, match=r"quantile: probability: must be 0 to 1, found 1\.5"):
        error.quantile(1.5)


@pytest.mark.parametrize(
    "settings",
    [
        {"model.shear_perimeter": "projectile"},
        {"model.plate_drive": "interface"},
        {"solver.arrest_velocity_m_s": 300.0},
    ],
)
def test_the_error_is_that_of_the_settings_of_the_tests(settings: dict[str, Any]):
    """With others, 13 and 3 of Wilkins' 13 limits were outside the intervals stated (A2)."""
    result = confidence(scenario(velocity=700.0).replaced(settings))
    [(key, value)] = settings.items()
    assert result.probability_of_stopping is None
    assert f"the tests were not computed with {key} = {value}" in result.reason
    # With which flow stress a ceramic without tests stops a threat, rests on the error of AD85.
    untested = scenario(ceramic="AD99.5", velocity=700.0)
    assert confidence(untested).flow_stress is not None
    assert confidence(untested.replaced(settings)).flow_stress is None
    with_error = scenario(
        uncertainty={"model": {"scale_percent": 9.0, "degrees_of_freedom": 1e6, "source": "tests"}}
    ).replaced(settings)
    # An error that the scenario gives may be that of another model.
    assert (model_error(row_of(with_error), 700.0) is None) == key.startswith("solver")


def test_beyond_30_degrees_a_plate_stops_at_least_as_surely_as_at_0():
    plate = scenario(backing="AA6082-T651", backing_mm=20.0, velocity=480.0, **BARE)
    at_normal, oblique = confidence(plate), confidence(plate.replaced({OBLIQUITY: 45.0}))
    assert oblique.probability_of_stopping == pytest.approx(at_normal.probability_of_stopping)
    assert oblique.interval_m_s == pytest.approx(at_normal.interval_m_s)
    assert "2 tests at 45°" in known(oblique.model_error).at_least
    assert 0.2 < (oblique.probability_of_stopping or 0.0) < 0.95
    assert f"at least {chance(oblique.probability_of_stopping)}" in str(tables_of_confidence(oblique))
    for beyond in (plate.replaced({OBLIQUITY: 46.0}), scenario("20 mm FSP", None, "6061-T6", 0.0, 20.0)):
        assert model_error(row_of(beyond.replaced({OBLIQUITY: max(31.0, beyond.impact.obliquity_deg)})), 700.0) is None


def test_with_a_ceramic_the_probability_at_0_degrees_is_beside_and_used_if_the_design_says_so():
    case = scenario(velocity=700.0)
    at_normal, oblique = confidence(case), confidence(case.replaced({OBLIQUITY: 20.0}))
    assert oblique.probability_of_stopping is None
    assert oblique.probability_at_normal_incidence == at_normal.probability_of_stopping
    assert "at 0°: 61 %" in str(tables_of_confidence(oblique))
    as_at_normal = case.replaced({OBLIQUITY: 20.0, "design.angles_as_at_normal_incidence": True})
    assert confidence(as_at_normal).probability_of_stopping == pytest.approx(at_normal.probability_of_stopping)
    [of_row] = evaluate(as_at_normal, {}, ["probability_of_stopping"])["probability_of_stopping"]
    assert of_row == pytest.approx(at_normal.probability_of_stopping)
    sampled = known(uncertainty(as_at_normal.replaced({"uncertainty": {"samples": 4096}})).probability_of_perforation)
    assert 1.0 - sampled.value == pytest.approx(at_normal.probability_of_stopping, abs=0.005)
