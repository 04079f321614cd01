"""Plans of tests of Wilkins' armour."""

from math import isfinite
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from armour.analysis.ballistic_limit import ballistic_limit
from armour.errors import InputError
from armour.planning.plan_tests import PlannedTests, plan_tests
from armour.scenario.inputs import BACKING, CERAMIC, FLOW_STRESS, VELOCITY
from armour.scenario.scenario import Scenario
from armour.statistics.calibration import Law, calibrate
from armour.statistics.measured import read_tests
from tests.helpers.cases import TESTS, csv_file, shipped_scenario

pytestmark = pytest.mark.slow

LIMITS = ((6.0, 700.0), (7.0, 760.0), (8.0, 810.0))
GRID = {CERAMIC: [5.0, 8.0, 11.0], BACKING: [4.0, 6.0, 8.0]}


@pytest.fixture(scope="module")
def wilkins() -> Scenario:
    return shipped_scenario("wilkins")


def chosen(result: PlannedTests) -> list[tuple[float | str, ...]]:
    return [tuple(step.inputs.values()) for step in result.planned[1:]]


def limit(scenario: Scenario, **inputs: float) -> float:
    names = {"c": CERAMIC, "b": BACKING, "y": FLOW_STRESS}
    changed = scenario.with_inputs({names[name]: value for name, value in inputs.items()})
    return ballistic_limit(changed.replaced({"ballistic_limit.tolerance_m_s": 1e-7})).ballistic_limit_m_s


def test_the_flow_stress_is_determined_by_the_greatest_relative_gradient(wilkins: Scenario):
    result = plan_tests(wilkins, GRID, number=3, scatter_percent=3.0)
    slopes = {
        (c, b): (limit(wilkins, c=c, b=b, y=5.2 * (1 + 1e-4)) / limit(wilkins, c=c, b=b) - 1.0) / 1e-4
        for c in GRID[CERAMIC]
        for b in GRID[BACKING]
    }
    best = max(slopes, key=lambda armour: slopes[armour])
    assert chosen(result) == [best] * 3
    assert result.efficiency == pytest.approx(1.0, abs=1e-3)
    halves = [step.half_widths[FLOW_STRESS] for step in result.planned]
    first = 1.959964 * 0.03 * 5.2 / slopes[best]
    assert halves == [None, *(pytest.approx(first / np.sqrt(n), rel=1e-4) for n in (1, 2, 3))]
    own = (limit(wilkins, y=5.2 * (1 + 1e-4)) - limit(wilkins)) / 5.2e-4
    assert result.planned[1].limit_half_widths_m_s[0] == pytest.approx(own * first, rel=1e-3)
    assert any("no tests support" in warning for warning in result.warnings)


def test_a_program_is_told_that_the_function_leaves(wilkins: Scenario):
    with pytest.warns(DeprecationWarning, match="leaves with version 3") as told:
        plan_tests(wilkins, GRID, number=1, scatter_percent=3.0)
    assert [warning.filename for warning in told] == [__file__]


def test_a_law_needs_different_armours(wilkins: Scenario):
    result = plan_tests(wilkins, GRID, law="linear", number=4, scatter_percent=3.0)
    assert len(set(chosen(result))) >= 3
    assert list(result.values.values()) == pytest.approx([5.2, 0.0, 0.0])
    assert [all(step.half_widths.values()) for step in result.planned] == [False, False, False, True, True]
    few = plan_tests(wilkins, GRID, law="linear", number=2, scatter_percent=3.0)
    assert (few.efficiency, few.sensitivities) == (None, ())
    assert few.warnings[-1] == "2 tests do not determine the inputs; at least 3 are needed"


def test_candidates_that_do_not_tell_a_law(wilkins: Scenario):
    result = plan_tests(wilkins, {BACKING: [6.35], CERAMIC: [5.0, 7.0]}, law="backing", number=2, scatter_percent=3.0)
    assert result.not_identified == (FLOW_STRESS, "ceramic.flow_stress_backing_exponent")
    assert result.efficiency is None
    assert any("do not determine" in warning for warning in result.warnings)
    assert result.planned[-1].half_widths == dict.fromkeys(result.values)
    # The design has the same back plate, so that its limit is determined.
    assert isfinite(result.planned[1].limit_half_widths_m_s[0] or np.nan)


def test_tests_made_before(wilkins: Scenario):
    """What is expected without further tests is what the calibration finds, its scatter and its estimate."""
    read = read_tests(TESTS, wilkins)
    fitted = calibrate(read, wilkins)
    [coefficient] = fitted.coefficients
    result = plan_tests(wilkins, GRID, tests=read, number=2)
    assert result.values[FLOW_STRESS] == pytest.approx(coefficient.estimate)
    assert not result.scatter_known
    assert result.scatter_source == "residuals"
    assert result.planned[0].half_widths[FLOW_STRESS] == pytest.approx(
        2.178813 * (coefficient.standard_error or 0.0), rel=1e-4
    )
    halves = [step.half_widths[FLOW_STRESS] or 0.0 for step in result.planned]
    assert halves == sorted(halves, reverse=True)


@pytest.mark.parametrize(
    ("rows", "law"),
    [
        ([{CERAMIC: c, "ballistic_limit_m_s": v} for c, v in LIMITS], None),
        ([{CERAMIC: 6.0, "ballistic_limit_m_s": 700.0, "ballistic_limit_uncertainty_m_s": 20.0}], "backing"),
    ],
)
def test_a_plan_does_not_depend_on_the_present_value_of_a_fitted_input_in_the_tests_scenario(
    wilkins: Scenario, rows: list[dict[str, float]], law: Law | None
):
    """Whether the tests suffice for a fit or not."""
    scenarios = (wilkins, wilkins.with_inputs({FLOW_STRESS: 4.0}))
    one, other = (
        plan_tests(wilkins, GRID, law=law, tests=read_tests(rows, scenario), number=2) for scenario in scenarios
    )
    assert one.values == pytest.approx(other.values)
    assert chosen(one) == chosen(other)
    for ours, theirs in zip(one.planned[1:], other.planned[1:], strict=True):
        assert ours.half_widths == pytest.approx(theirs.half_widths, rel=1e-3)
    assert one.design_limits_m_s == pytest.approx(other.design_limits_m_s)


def test_a_given_scatter_is_that_of_the_tests_made_before(wilkins: Scenario):
    """It counts as the uncertainty of each of them."""
    limits = [{CERAMIC: c, "ballistic_limit_m_s": v} for c, v in LIMITS]
    given = [{**row, "ballistic_limit_uncertainty_m_s": 0.03 * v} for row, (_, v) in zip(limits, LIMITS, strict=True)]
    one, other = (
        plan_tests(wilkins, GRID, tests=read_tests(rows, wilkins), number=1, scatter_percent=3.0)
        for rows in (limits, given)
    )
    assert one.planned == other.planned
    assert one.scatter_percent == pytest.approx(3.0)
    known = plan_tests(wilkins, GRID, tests=read_tests(given, wilkins), number=1)
    assert (known.scatter_known, known.scatter_source, one.scatter_source) == (True, "uncertainties", "given")


def test_residual_velocities_do_not_tell_how_limits_scatter(wilkins: Scenario):
    shots = [
        {CERAMIC: c, VELOCITY: 900.0, "residual_velocity_m_s": v, "residual_velocity_uncertainty_m_s": 20.0}
        for c, v in ((6.0, 500.0), (7.0, 440.0))
    ]
    with pytest.raises(InputError, match="scatter_percent: must be given: there are too few tests"):
        plan_tests(wilkins, GRID, tests=read_tests(shots, wilkins), number=1)


def test_few_tests_made_before_count_by_what_they_tell(wilkins: Scenario):
    """One test and one planned one of the same armour tell what two planned ones do."""
    uncertainty = 0.03 * limit(wilkins, c=8.0, b=8.0)
    made = {CERAMIC: 8.0, BACKING: 8.0, "ballistic_limit_m_s": uncertainty / 0.03}
    grid = {CERAMIC: [8.0], BACKING: [8.0, 5.0]}
    read = read_tests([{**made, "ballistic_limit_uncertainty_m_s": uncertainty}], wilkins)
    found = plan_tests(wilkins, grid, law="backing", number=1, tests=read)
    assert found.scatter_percent == pytest.approx(3.0)
    assert found.scatter_known
    assert any("too few for a fit" in warning for warning in found.warnings)
    assert chosen(found) == [(8.0, 5.0)]
    both = plan_tests(wilkins, grid, law="backing", number=2, scatter_percent=3.0)
    assert list(found.planned[1].half_widths.values()) == [
        pytest.approx(half, rel=1e-3) for half in both.planned[2].half_widths.values()
    ]


def test_tests_that_their_scatter_does_not_explain_tell_less(wilkins: Scenario):
    limits = [{CERAMIC: c, "ballistic_limit_m_s": v, "ballistic_limit_uncertainty_m_s": 2.0} for c, v in LIMITS]
    found = plan_tests(wilkins, GRID, tests=read_tests(limits, wilkins), number=1)
    [told] = [warning for warning in found.warnings if "deviate more than their scatter explains" in warning]
    factor = float(told.rpartition(" ")[2])
    assert factor > 1.0
    fitted = calibrate(read_tests(limits, wilkins), wilkins)
    assert found.planned[0].half_widths[FLOW_STRESS] == pytest.approx(
        1.959964 * (fitted.coefficients[0].standard_error or 0.0), rel=0.01
    )


def test_a_fit_at_the_end_of_its_range_is_told(wilkins: Scenario):
    limits = [{CERAMIC: c, "ballistic_limit_m_s": 3.0 * v} for c, v in LIMITS]
    found = plan_tests(wilkins, GRID, tests=read_tests(limits, wilkins), number=1, scatter_percent=50.0)
    assert "the fit to the tests ends at the end of the range of its search" in found.warnings


def test_shots_are_at_the_impact_velocity_by_default(wilkins: Scenario):
    one, other = (
        plan_tests(wilkins, candidates, number=1, scatter_percent=3.0, measure="outcome")
        for candidates in ({CERAMIC: [6.0, 8.0]}, {CERAMIC: [6.0, 8.0], VELOCITY: [wilkins.impact.velocity_m_s]})
    )
    assert one.planned[1].half_widths == other.planned[1].half_widths
    assert one.planned[1].inputs[VELOCITY] == wilkins.impact.velocity_m_s


def test_a_prior_counts(wilkins: Scenario):
    prior = {"distribution": "normal", "standard_deviation_percent": 5.0}
    known = wilkins.replaced({"uncertainty": {"ceramic": {"flow_stress_GPa": prior}}})
    result = plan_tests(known, GRID, number=1, scatter_percent=3.0, prior=True)
    before, after = (step.half_widths[FLOW_STRESS] or 0.0 for step in result.planned)
    assert before == pytest.approx(1.959964 * 0.26)
    alone = plan_tests(wilkins, GRID, number=1, scatter_percent=3.0).planned[1].half_widths[FLOW_STRESS] or 0.0
    assert after**-2 == pytest.approx(before**-2 + alone**-2)


def test_an_outcome_tells_most_near_the_limit(wilkins: Scenario):
    shots = {VELOCITY: np.arange(600.0, 900.0, 5.0)}
    result = plan_tests(wilkins, shots, number=1, scatter_percent=3.0, measure="outcome")
    assert abs(chosen(result)[0][0] - limit(wilkins)) <= 5.0  # type: ignore[operator]
    exact = plan_tests(wilkins, {CERAMIC: [6.35]}, number=1, scatter_percent=3.0)
    halves = [found.planned[1].half_widths[FLOW_STRESS] or 0.0 for found in (result, exact)]
    # At the limit an outcome tells 2/pi of what the limit tells.
    assert halves[0] / halves[1] == pytest.approx(np.sqrt(np.pi / 2.0), rel=2e-3)


@pytest.mark.parametrize("ratio", [0.88, 1.12])
def test_an_outcome_away_from_the_limit_tells_what_a_calibration_assumes(wilkins: Scenario, ratio: float):
    velocity, own, step = round(ratio * limit(wilkins)), 5.2, 1e-3
    found = plan_tests(wilkins, {VELOCITY: [velocity]}, number=1, scatter_percent=10.0, measure="outcome")
    stops = [norm.cdf((limit(wilkins, y=y) / velocity - 1.0) / 0.1) for y in (own - step, own, own + step)]
    information = ((stops[2] - stops[0]) / (2.0 * step)) ** 2 / (stops[1] * (1.0 - stops[1]))
    assert found.planned[1].half_widths[FLOW_STRESS] == pytest.approx(norm.ppf(0.975) / np.sqrt(information), rel=2e-3)


def test_the_design_in_question(wilkins: Scenario):
    design = wilkins.replaced({CERAMIC: 10.0, BACKING: 4.0})
    one = plan_tests(wilkins, GRID, law="backing", number=3, scatter_percent=3.0, criterion="I", designs=[design])
    other = plan_tests(wilkins, GRID, law="backing", number=3, scatter_percent=3.0, designs=[design])
    halves = [found.planned[-1].limit_half_widths_m_s[0] or 0.0 for found in (one, other)]
    assert halves[0] < halves[1]


def test_costs_of_targets(wilkins: Scenario, tmp_path: Path):
    path = csv_file(tmp_path / "c.csv", f"{CERAMIC},{BACKING},cost", "11,4,900", "8,4,100")
    result = plan_tests(wilkins, path, number=2, scatter_percent=3.0, cost=50.0)
    assert chosen(result) == [(8.0, 4.0)] * 2
    assert [step.total_cost for step in result.planned] == [0.0, 150.0, 300.0]
    assert plan_tests(wilkins, {CERAMIC: [8.0]}, number=1, scatter_percent=3.0).planned[1].cost is None


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (("armour.ceramic_thickness_mm,cost", "8,0"), "line 2: cost: must be greater than 0"),
        (("armour.ceramic_thickness_mm,cost", "8,"), 'line 2: cost: must be a number, found ""'),
        (("armour.ceramic_thickness_mm,price", "8,5"), "projectile, armour.ceramic, armour.backing, cost"),
        (("armour.ceramic_thickness_mm,price", "8,"), "line 2: price: must be a number, found"),
        (("armour.ceramic_thickness_mm", "400"), "must have a ballistic limit between 20 and 4000 m/s"),
        (("armour.ceramic_thickness_mm", "-4"), "must be at least 0"),
        (("armour.thickness_mm", "4"), "must be an input or a name that a test has"),
        (("cost", "4"), "must have at least one key"),
        (("impact.velocity_m_s", "700"), "must not be given if the ballistic limit is measured"),
        (("ceramic.flow_stress_GPa", "4"), "must not be a column if it is fitted"),
        (("armour.ceramic", "AD85", "B4C"), "must be the same in all tests"),
    ],
)
def test_wrong_candidates(wilkins: Scenario, tmp_path: Path, rows: tuple[str, ...], words: str):
    with pytest.raises(InputError) as caught:
        plan_tests(wilkins, csv_file(tmp_path / "c.csv", *rows), scatter_percent=3.0)
    assert words in str(caught.value)


@pytest.mark.parametrize("law", [None, "product"])
def test_a_flow_stress_without_a_ceramic_is_refused(law: Law | None):
    with pytest.raises(InputError, match=f'plan_tests: fit: must name an input of the scenario, found "{FLOW_STRESS}"'):
        plan_tests(shipped_scenario("bare_plate"), {BACKING: [4.0, 6.0]}, law=law, scatter_percent=5.0)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"number": 0}, "number: must be at least 1"),
        ({"scatter_percent": None}, "there are too few tests to estimate it from"),
        ({"fit": ()}, "fit: must name at least one input"),
        ({"fit": VELOCITY}, f'plan_tests: fit: must be a property of a material or projectile, found "{VELOCITY}"'),
        ({"law": "backin"}, 'did you mean "backing"'),
        ({"law": "backing", "fit": "backing.shear_strength_MPa"}, f"law: must not be given unless {FLOW_STRESS} is"),
        (
            {"criterion": "I", "law": "backing", "candidates": {BACKING: [5.0], CERAMIC: [5.0, 7.0]}},
            'must not be "I": the candidates do not determine the limit of a design',
        ),
        ({"candidates": [5.0]}, "candidates: must be a mapping or a path"),
        ({"designs": "wilkins"}, 'designs: must be a Scenario, found the text "wilkins"'),
        ({"prior": True}, "must be given for a prior"),
        ({"measure": "outcome", "candidates": {VELOCITY: [20.0]}}, "must depend on"),
    ],
)
def test_wrong_settings(wilkins: Scenario, settings: dict[str, object], words: str):
    with pytest.raises(InputError) as caught:
        plan_tests(wilkins, **{"candidates": GRID, "scatter_percent": 3.0, **settings})  # type: ignore[arg-type]
    assert words in str(caught.value)


def test_too_many_candidates_and_a_design_of_another_ceramic(wilkins: Scenario, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(InputError, match="as it is fitted: AD85, found B4C"):
        plan_tests(wilkins, GRID, scatter_percent=3.0, designs=[wilkins.replaced({"armour.ceramic": "B4C"})])
    monkeypatch.setattr("armour.planning.plan_tests.MAX_CANDIDATES", 8)
    with pytest.raises(InputError, match="candidates: must be at most 8 candidates, found 9"):
        plan_tests(wilkins, GRID, scatter_percent=3.0)


def test_a_ceramic_of_the_same_name_with_other_values_is_another_one(wilkins: Scenario):
    denser = wilkins.replaced({"library.ceramic.AD85": {"based_on": "AD85", "density_kg_m3": 3900.0}})
    tests = read_tests([{CERAMIC: 6.0, "ballistic_limit_m_s": 700.0}], denser)
    for settings in ({"designs": [denser]}, {"tests": tests}):
        with pytest.raises(InputError, match="must be the same as for the candidates, with the same values"):
            plan_tests(wilkins, GRID, scatter_percent=3.0, **settings)


def test_the_prior_is_that_of_the_scenario(wilkins: Scenario):
    flow_stress = {"distribution": "normal", "standard_deviation_percent": 10.0}
    known = wilkins.replaced({f"uncertainty.{FLOW_STRESS}": flow_stress})
    limits = [{CERAMIC: c, "ballistic_limit_m_s": v} for c, v in LIMITS]
    for scenario in (wilkins, known.with_inputs({FLOW_STRESS: 4.0})):
        read = read_tests(limits, scenario)
        with pytest.raises(InputError, match="must have the distributions of the scenario that the tests were read"):
            plan_tests(known, GRID, scatter_percent=3.0, tests=read, prior=True)


def test_a_result_is_plain_data(wilkins: Scenario):
    result = plan_tests(wilkins, GRID, number=2, scatter_percent=3.0)
    tests = "Tests of AD85 on 6061-T6 against 7.62 mm AP"
    assert repr(result) == f"<PlannedTests: {tests}: 2 tests of 9 candidates, D-efficiency 1.000>"
    assert result._columns()["number"] == [1, 2]
    assert result.to_dict()["planned"][1]["inputs"][BACKING] == 4.0
