"""Calibration against Wilkins' tests and against tests made by the model itself.

How often its intervals hold the truth, `tools.campaigns.coverage` counts.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.impact import simulate
from armour.scenario.inputs import FLOW_STRESS
from armour.scenario.scenario import Scenario
from armour.statistics import likelihood
from armour.statistics.calibration import (
    LAWS,
    Law,
    Residual,
    calibrate,
    out_of_line,
    with_ceramic,
    with_law,
)
from armour.statistics.likelihood import Coefficient
from armour.statistics.measured import LIMIT, read_tests
from tests.helpers.cases import TESTS, csv_file, scenario, shipped_scenario
from tests.helpers.fits import fitted, table_of
from tests.helpers.known import known
from tools.campaigns.calibrations import Table

pytestmark = pytest.mark.slow

C, B, V = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm", "impact.velocity_m_s"
TAU = "backing.shear_strength_MPa"


def interval(coefficient: Coefficient) -> tuple[float, float]:
    """Interval of a coefficient that is bounded on both sides."""
    low, high = coefficient.interval or (None, None)
    return known(low), known(high)


@pytest.fixture(scope="module")
def wilkins() -> Scenario:
    return shipped_scenario("wilkins")


def limit(case: Scenario, **inputs: float) -> float:
    names = {"c": C, "b": B, "y": FLOW_STRESS, "tau": TAU}
    changed = case.with_inputs({names[name]: value for name, value in inputs.items()})
    return ballistic_limit(changed.replaced({"ballistic_limit.tolerance_m_s": 1e-6})).ballistic_limit_m_s


@pytest.fixture(scope="module")
def table() -> Table:
    return Table(likelihood.MODELS[LIMIT])


@pytest.fixture
def quick(table: Table, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interpolate the limits of Wilkins' armours, to 0.001 m/s about 5 GPa."""
    monkeypatch.setitem(likelihood.MODELS, LIMIT, table)


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("law", "errors"),
    [("constant", (5.05, 5.47)), ("backing", (3.22, 3.72)), ("product", (3.40, 3.95)), ("linear", (3.46, 4.48))],
)
def test_laws_of_wilkins_tests(law: Law, errors: tuple[float, float], wilkins: Scenario):
    """Against a fit that shares only the engine with this one, to the digits given."""
    result = calibrate(read_tests(TESTS, wilkins), wilkins, law=law)
    assert (result.mean_error_percent, result.left_out_error_percent) == pytest.approx(errors, abs=0.006)
    assert (result.law, len(result.coefficients)) == (law, 1 + len(LAWS[law]))
    assert result.starts == result.starts_agreeing
    if law == "backing":
        assert [c.estimate for c in result.coefficients] == pytest.approx([5.136, 0.3232], abs=6e-4)


def test_known_coefficients_come_back(wilkins: Scenario):
    values = dict(zip(("flow_stress_GPa", *LAWS["linear"]), (4.4, 0.4, 0.2), strict=True))
    truth = with_ceramic(with_law(wilkins, "linear"), values)
    columns = {C: np.repeat([5.0, 7.0, 9.0], 3), B: np.tile([4.0, 6.0, 9.0], 3)}
    limits = evaluate(truth.replaced({"ballistic_limit.tolerance_m_s": 1e-6}), columns, ["ballistic_limit_m_s"])
    rows = [f"{c},{b},{v:.6f}" for c, b, v in zip(*columns.values(), limits["ballistic_limit_m_s"], strict=True)]
    result = fitted(wilkins, f"{C},{B},ballistic_limit_m_s", *rows, law="linear")
    assert {c.name: c.estimate for c in result.coefficients} == {
        f"ceramic.{key}": pytest.approx(value, rel=2e-4) for key, value in values.items()
    }
    assert result.left_out_error_percent == pytest.approx(0.0, abs=0.01)


@pytest.mark.usefixtures("quick")
def test_the_law_of_the_scenario_is_kept_or_replaced(wilkins: Scenario):
    """Without a law the flow stress is fitted at the scenario's exponent; a law fits its own coefficients alone."""
    scenario_with_law = with_ceramic(wilkins, {"flow_stress_backing_exponent": 0.32})
    tests = read_tests(TESTS, scenario_with_law)
    with_law, replaced = calibrate(tests, scenario_with_law), calibrate(tests, scenario_with_law, law="constant")
    assert (with_law.law, len(with_law.coefficients)) == ("backing", 1)
    assert with_law.mean_error_percent == pytest.approx(3.22, abs=0.02)
    assert replaced.law == "constant"
    assert replaced.mean_error_percent == pytest.approx(5.05, abs=0.006)


def test_limits_velocities_masses_and_bounds_together(wilkins: Scenario):
    """Two parameters from every kind of measurement at once; the bounds are met and change nothing."""
    truth = wilkins.with_inputs({FLOW_STRESS: 4.6, TAU: 300.0})
    shot = simulate(truth.replaced({V: 850.0}))
    rows = [
        f"a,5,8,,{limit(truth, c=5.0, b=8.0):.5f},,,,2,,",
        f"b,9,4,,{limit(truth, c=9.0, b=4.0):.5f},,,,2,,",
        f"c,6.35,6.35,850,,{shot.residual_velocity_m_s:.6f},{shot.residual_mass_g:.7f},,,2,0.01",
        f"d,6.35,6.35,{limit(truth) + 20.0:.2f},,,,perforated,2,,",
        f"e,6.35,6.35,{limit(truth) - 20.0:.2f},,,,stopped,2,,",
    ]
    header = f"test,{C},{B},{V},ballistic_limit_m_s,residual_velocity_m_s,residual_mass_g,outcome"
    header += ",ballistic_limit_uncertainty_m_s,residual_velocity_uncertainty_m_s,residual_mass_uncertainty_g"
    result = fitted(wilkins, header, *rows, fit=[FLOW_STRESS, TAU])
    assert [c.estimate for c in result.coefficients] == pytest.approx([4.6, 300.0], rel=1e-3)
    assert [(r.test, r.bound, r.met) for r in result.residuals if r.bound] == [
        ("d", "at most", True),
        ("e", "at least", True),
    ]
    assert result.degrees_of_freedom == pytest.approx(2.0)


def test_uncertainties_weigh(wilkins: Scenario):
    """Of two contradicting tests the one with a tenth of the uncertainty has a hundred times the weight."""
    header = f"{C},{B},ballistic_limit_m_s,ballistic_limit_uncertainty_m_s"
    low, high = (limit(wilkins, y=y) for y in (4.8, 5.2))
    rows = [f"6.35,6.35,{low:.3f},2", f"6.35,6.35,{high:.3f},20"]
    result = fitted(wilkins, header, *rows)
    assert result.weights == "uncertainties"
    assert [residual.uncertainty for residual in result.residuals] == [2.0, 20.0]
    assert result.coefficients[0].estimate == pytest.approx(4.804, abs=0.005)
    low_end, high_end = interval(result.coefficients[0])
    slope = (limit(wilkins, y=4.85) - limit(wilkins, y=4.75)) / 0.1
    assert high_end - low_end == pytest.approx(2.0 * 1.96 * 2.0 / slope / np.sqrt(1.01), rel=0.02)


def test_outcomes_count_by_their_likelihood(wilkins: Scenario):
    """A limit and an outcome with uncertainties: the estimate solves r + hazard = 0, on the side of the outcome."""
    header = f"{V},outcome,ballistic_limit_m_s,ballistic_limit_uncertainty_m_s"
    rows = [",,720,10", "715,stopped,,10"]
    result = fitted(wilkins, header, *rows)
    limit, z = result.residuals[0].computed, (result.residuals[0].computed - 715.0) / 10.0
    assert (limit - 720.0) / 10.0 == pytest.approx(stats.norm.pdf(z) / stats.norm.cdf(z), abs=1e-4)
    low, high = interval(result.coefficients[0])
    ends = [ballistic_limit(wilkins.with_inputs({FLOW_STRESS: y})).ballistic_limit_m_s for y in (low, high)]

    def lost(v: float) -> float:
        return ((v - 720.0) / 10.0) ** 2 - 2.0 * stats.norm.logcdf((v - 715.0) / 10.0)

    assert [lost(v) - lost(limit) for v in ends] == pytest.approx([3.841, 3.841], abs=0.03)


def test_outcomes_alone_bound_where_their_uncertainty_is_given(wilkins: Scenario):
    header = f"{V},outcome,ballistic_limit_uncertainty_m_s"
    rows = ["700,stopped,10", "725,stopped,10", "715,perforated,10", "740,perforated,10"]
    both = fitted(wilkins, header, *rows)
    assert both.residuals[0].computed == pytest.approx(720.0, abs=0.1)
    assert (both.p_value, both.mean_error_percent) == (None, None)
    assert both.degrees_of_freedom == 0.0
    assert interval(both.coefficients[0])[0] < 5.2 < interval(both.coefficients[0])[1]
    two_tests = fitted(wilkins, header, *rows[:2])
    coefficient = two_tests.coefficients[0]
    assert coefficient.estimate is None
    assert coefficient.interval is not None
    assert coefficient.interval[0] == pytest.approx(5.1, abs=0.01)
    assert coefficient.interval[1] is None
    assert "the fit is as good at" in coefficient.reason


def test_a_bad_fit_widens_the_intervals_and_says_so(wilkins: Scenario):
    """By the Birge ratio with quantiles of Student's t: of a linear model, the intervals of an unknown scatter."""
    header = f"{C},{B},ballistic_limit_m_s,ballistic_limit_uncertainty_m_s"
    rows = [f"{line},5.0" for line in TESTS.read_text().split()[1:7]]
    bad = fitted(wilkins, header, *rows)
    assert bad.p_value is not None
    assert bad.p_value == pytest.approx(stats.chi2.sf(bad.chi_squared, 5))
    assert bad.p_value < 0.05
    assert bad.widened_by == pytest.approx(np.sqrt(bad.chi_squared / 5))
    assert "the intervals are widened" in bad.warnings[0]
    low, high = interval(bad.coefficients[0])
    error = known(bad.coefficients[0].standard_error)
    assert high - low == pytest.approx(2.0 * stats.t.ppf(0.975, 5) * error, rel=0.05)
    good = fitted(wilkins, header, *(f"{row[:-3]}50" for row in rows))
    assert (known(good.p_value) > 0.05, good.widened_by) == (True, 1.0)
    assert not [warning for warning in good.warnings if "widened" in warning]


def test_coefficients_that_are_not_identified(wilkins: Scenario):
    rows = [f"6.35,6.35,{v}" for v in (700, 710, 720)]
    result = fitted(wilkins, f"{C},{B},ballistic_limit_m_s", *rows, law="ceramic")
    assert result.coefficients[1].estimate is None
    assert result.coefficients[1].reason == "the tests bound it neither above nor below"
    one_test = fitted(wilkins, f"{C},ballistic_limit_m_s,ballistic_limit_uncertainty_m_s", "6.35,720,5")
    assert ([r.left_out for r in one_test.residuals], one_test.left_out_error_percent) == ([None], None)
    assert one_test.mean_error_percent == pytest.approx(0.0, abs=1e-3)


def test_tests_of_other_materials():
    """A parameter of the projectile from tests with two ceramics."""
    truth = scenario().with_inputs({"projectile.penetrator_diameter_mm": 6.2})
    rows = []
    for ceramic, thickness in (("AD85", 6.0), ("AD85", 8.0), ("AD99.5", 6.0)):
        rows.append(f"{ceramic},{thickness},{limit(truth.replaced({'armour.ceramic': ceramic}), c=thickness):.5f}")
    header = f"armour.ceramic,{C},ballistic_limit_m_s"
    result = fitted(scenario(), header, *rows, fit=["projectile.penetrator_diameter_mm"])
    assert result.coefficients[0].estimate == pytest.approx(6.2, rel=1e-4)


def test_limits_beyond_the_range_count_as_its_ends(wilkins: Scenario):
    rows = [f"{c},{v}" for c, v in ((6.35, 700), (20.0, 705), (0.5, 695))]
    narrow = wilkins.replaced({"ballistic_limit.velocity_min_m_s": 690.0, "ballistic_limit.velocity_max_m_s": 710.0})
    result = fitted(narrow, f"{C},ballistic_limit_m_s", *rows)
    assert [r.computed for r in result.residuals[1:]] == [710.0, 690.0]


def test_linearised_fits_without_a_test_agree_with_searches(wilkins: Scenario, monkeypatch: pytest.MonkeyPatch):
    columns = {C: np.repeat([5.0, 9.0], 4), B: np.tile([4.0, 5.0, 7.0, 9.0], 2)}
    limits = evaluate(wilkins, columns, ["ballistic_limit_m_s"])["ballistic_limit_m_s"] + np.tile([2.0, -2.0], 4)
    rows = [f"{c},{b},{value:.3f}" for c, b, value in zip(*columns.values(), limits, strict=True)]
    tests = table_of(wilkins, f"{C},{B},ballistic_limit_m_s", *rows)
    quick = calibrate(tests, wilkins)
    monkeypatch.setattr(likelihood, "SMALL_CHANGE", 0.0)
    exact = calibrate(tests, wilkins)
    assert [r.left_out for r in quick.residuals] == pytest.approx([r.left_out for r in exact.residuals], rel=2e-6)
    assert quick.residuals[0].left_out != quick.residuals[0].computed


def test_a_mistyped_limit_is_out_of_line(wilkins: Scenario, tmp_path: Path):
    lines = TESTS.read_text().split()
    lines[3] += "0"
    implausible, warning, of_error = calibrate(
        read_tests(csv_file(tmp_path / "t.csv", *lines), wilkins), wilkins
    ).warnings
    assert (
        implausible
        == "line 4: a measured limit is impossible for any lot of such armour; check it, its unit and the armour"
    )
    assert "one is implausible for any lot" in of_error
    assert warning.startswith("line 4: ballistic_limit_m_s is out of line with the other tests: measured 7010, but")


def test_few_tables_of_sound_tests_have_one_out_of_line():
    rng = np.random.default_rng(1)
    has_outlier = []
    for _ in range(2000):
        values = rng.normal(size=12)
        deviations = values.mean() - values
        has_outlier.append(out_of_line(deviations, deviations * 12 / 11, 1).any())
    assert 0.03 < np.mean(has_outlier) < 0.065


@pytest.mark.parametrize(("bound", "sign"), [("at least", 1.0), ("at most", -1.0)])
def test_a_bound_is_met_at_equality_within_rounding(bound: str, sign: float):
    met = [Residual("1", LIMIT, 750.0, 750.0 + sign * more, None, bound).met for more in (1.0, -1e-4, -0.01)]
    assert met == [True, True, False]
