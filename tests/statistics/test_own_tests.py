"""Own tests of a lot: what a calibrated entry keeps of them, and what follows for other armours."""

import tomllib
from datetime import date
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ConfidenceResult, confidence
from armour.analysis.evaluate import evaluate
from armour.design.check import check
from armour.design.optimise import optimise
from armour.errors import InputError
from armour.evidence.tests import armours_of
from armour.reporting.views import design as view
from armour.reporting.words import model_error_words
from armour.scenario.inputs import BACKING, CERAMIC, FLOW_STRESS, OBLIQUITY, VELOCITY
from armour.scenario.scenario import Scenario, parse_scenario
from armour.statistics.calibration import CalibrationResult, Law, calibrate
from armour.statistics.fitted_library import scenario_text
from armour.statistics.measured import Measurement, read_tests
from armour.statistics.measured import Tests as Measured
from armour.statistics.own_tests import repeated
from tests.design.results import best_of
from tests.helpers.cases import TESTS, scenario, shipped_scenario
from tests.helpers.fits import table_of, wilkins_fit
from tests.helpers.known import known
from tools.campaigns import own_tests as campaign

WILKINS = shipped_scenario("wilkins")
STRENGTH = "backing.flow_stress_GPa"
FILE = Path("made.toml")


def written(result: CalibrationResult, tests: Measured, case: Scenario, lot: str = "lot 7") -> Scenario:
    """The scenario that armour calibrate writes."""
    return parse_scenario(tomllib.loads(scenario_text(result, tests, case, lot, FILE)), file="made.toml")


def scenario_of(tests: Measured, case: Scenario, fit: str, lot: str = "lot 7") -> Scenario:
    """The scenario that armour calibrate writes of tests."""
    return written(calibrate(tests, case, fit), tests, case, lot)


@cache
def of_wilkins(law: Law = "constant") -> Scenario:
    """The scenario of Wilkins' tests with AD85 calibrated to them."""
    return written(wilkins_fit(law), read_tests(TESTS, WILKINS), WILKINS).replaced({VELOCITY: 700.0})


def plate(projectile: str, strength_MPa: float, thickness: float) -> Scenario:
    metal: dict[str, Any] = {"density_kg_m3": 2720.0, "dynamic_yield_strength_MPa": strength_MPa}
    armour = {"ceramic_thickness_mm": 0.0, "backing": "M", "backing_thickness_mm": thickness}
    impact = {"projectile": projectile, "velocity_m_s": 600.0}
    return parse_scenario({"impact": impact, "armour": armour, "library": {"metal": {"M": metal}}})


def probability(result: ConfidenceResult) -> float:
    assert result.probability_of_stopping is not None, result.reason
    return result.probability_of_stopping


VERY = parse_scenario(
    {
        "impact": {"projectile": "7.62 mm B32", "velocity_m_s": 905.0},
        "armour": {
            "ceramic": "Alumina 98",
            "ceramic_thickness_mm": 8.0,
            "backing": "ARMOX500",
            "backing_thickness_mm": 6.5,
        },
        "library": {
            "ceramic": {"Alumina 98": {"density_kg_m3": 3820.0, "youngs_modulus_GPa": 350.0, "flow_stress_GPa": 5.7}},
            "projectile": {
                "dense": {
                    "penetrator_diameter_mm": 5.6,
                    "penetrator_mass_g": 5.9,
                    "density_kg_m3": 14900.0,
                    "flow_stress_GPa": 4.5,
                },
                "large": {"based_on": "12.7 mm APM2", "penetrator_mass_g": 30.0},
            },
        },
    }
)
VERY_TESTS = ("8,7.62 mm B32,905,12", "8,dense,745,15", "12,large,790,10")


@cache
def very(*rows: str) -> Scenario:
    """The armour with own tests, the first of which is of this very armour."""
    columns = f"{CERAMIC},impact.projectile,ballistic_limit_m_s,ballistic_limit_uncertainty_m_s"
    return scenario_of(table_of(VERY, columns, *rows), VERY, FLOW_STRESS)


@pytest.mark.parametrize(("count", "most"), [(1, 0.32), (3, 0.45)])
def test_the_limit_of_the_very_armour_is_what_was_measured(count: int, most: float):
    """905 ± 12 m/s were measured; two tests of other rounds say more (A1)."""
    case = very(*VERY_TESTS[:count])
    assert 0.4 <= probability(confidence(case)) <= 0.7
    assert probability(confidence(case.replaced({VELOCITY: 1.03 * 905.0}))) <= most


def test_against_a_round_that_was_not_fired_the_interval_is_wider():
    case = very(VERY_TESTS[0])
    larger = {"impact.projectile": "14.5 mm B32", CERAMIC: 16.3, BACKING: 13.2}
    widths = [high / low for low, high in (interval_of(case), interval_of(case.replaced(larger)))]
    assert widths[1] > 1.1 * widths[0]
    far, farther = (check(each).threats[0].far_from_tests for each in (case, case.replaced(larger)))
    assert "B32" not in str(far)
    assert "14.5 mm B32 (own tests with another round)" in farther


def greatest_probability(
    case: Scenario, ceramic_mm: float, backing_mm: float, projectile: str = "7.62 mm B32"
) -> float:
    changes = {CERAMIC: ceramic_mm, BACKING: backing_mm, "impact.projectile": projectile}
    return known(confidence(case.replaced(changes)).model_error).greatest_probability


def test_own_tests_lift_the_bound_on_the_probability_as_far_as_they_reach():
    """Of a ceramic without shipped tests, one test made an armour twice as thick stop with above 99 % (A15)."""
    case = very(VERY_TESTS[0])
    assert greatest_probability(case, 8.0, 6.5) == 1.0
    for ceramic_mm, backing_mm in ((15.9, 6.5), (8.0, 12.9), (15.9, 12.9)):
        assert greatest_probability(case, ceramic_mm, backing_mm) == pytest.approx(0.83, abs=2e-3)
    assert greatest_probability(case, 8.8, 6.5) == pytest.approx(0.976, abs=1e-3)


def test_own_tests_against_another_round_do_not_lift_the_bound():
    diameter_mm = WILKINS.core_armour().D0 * 1e3
    rows = (f"{thickness},{diameter_mm},{limit}" for thickness, limit in ((12.0, 1060), (13.0, 1110)))
    of_ad85 = WILKINS.replaced({BACKING: 7.0})
    case = scenario_of(
        table_of(of_ad85, f"{CERAMIC},projectile.penetrator_diameter_mm,ballistic_limit_m_s", *rows),
        of_ad85,
        FLOW_STRESS,
    )
    own = known(of_ad85.impact.projectile)
    far = greatest_probability(of_ad85, 12.5, 7.0, own)
    assert far == pytest.approx(1.0 - 0.1 * np.log(12.5 / diameter_mm / 1.21) / np.log(1.5))
    assert greatest_probability(case, 12.5, 7.0, own) == 1.0
    assert greatest_probability(case, 13.65, 7.0, own) == pytest.approx(1.0 - 0.1 * np.log(1.05) / np.log(1.5), 1e-6)
    assert greatest_probability(case, 7.0, 7.0, own) == 1.0
    other = case.replaced({"projectile.penetrator_mass_g": 5.0})
    assert greatest_probability(other, 12.5, 7.0, own) == pytest.approx(far)


def test_answers_show_what_was_measured_here_and_what_the_other_tests_say():
    case = very(*VERY_TESTS)
    answers = [confidence(case).model_error, check(case).threats[0].model_error]
    only = {"ceramic_thickness_mm": {"min": 8.0, "max": 8.0, "step": 1.0}}
    only |= {"backing_thickness_mm": {"min": 6.5, "max": 6.5, "step": 1.0}}
    answers.append(best_of(optimise(case.replaced({"optimise": only, VELOCITY: 800.0}))).check.threats[0].model_error)
    for error in answers:
        assert error is not None
        here = known(error.tests_here)
        assert (here.limits_m_s, here.uncertainties_m_s, here.others) == ((905.0,), (12.0,), 2)
        # As the two others alone are calibrated to, but for their own fitted flow stress.
        alone = confidence(very(*VERY_TESTS[1:]))
        assert here.median_m_s == pytest.approx(alone.expected_limit_m_s, rel=0.02)
        words = model_error_words(error)
        assert "measured 905 ± 12 m/s here (1 own test); the 2 others alone: about 10" in words
        assert words.endswith("rests on one test of this armour: a second V50 would settle it")
    elsewhere = known(confidence(case.replaced({CERAMIC: 8.5})).model_error)
    assert elsewhere.tests_here is None


def test_a_second_test_of_the_armour_settles_it():
    once, twice = (very(VERY_TESTS[0], *VERY_TESTS[1:], *more) for more in ((), ("8,7.62 mm B32,915,12",)))
    errors = [confidence(case).model_error for case in (once, twice)]
    assert "settle" not in model_error_words(known(errors[1]))
    assert interval_of(twice)[0] > interval_of(once)[0] + 15.0
    [torn] = check(very(*VERY_TESTS, "8,7.62 mm B32,1105,12")).threats
    for words in (model_error_words(known(torn.model_error)), view.tests_words(torn)):
        assert "these tests do not agree" in words


def interval_of(case: Scenario) -> tuple[float, float]:
    result = confidence(case)
    assert result.interval_m_s is not None, result.reason
    return result.interval_m_s


FRAGMENT = plate("20 mm FSP", 402.0, 30.0)
THICK = table_of(FRAGMENT, f"{BACKING},ballistic_limit_m_s", "36.6,865", "37,848", "37,881")


@cache
def of_thick() -> Scenario:
    return scenario_of(THICK, FRAGMENT, STRENGTH)


def test_three_tests_of_thick_plates_do_not_make_a_thin_one_safe():
    """Measured: 447 m/s at 24.2 mm, which 1.1.0 stated to stop 520 m/s with 90 %, and 599 m/s at 30 mm (A0)."""
    case = of_thick()
    thin = confidence(case.replaced({BACKING: 24.2, VELOCITY: 520.0}))
    middle = confidence(case.replaced({BACKING: 30.0, VELOCITY: 620.0}))
    assert probability(thin) <= 0.15
    assert probability(middle) == pytest.approx(0.6, abs=0.05)
    for result, measured in ((thin, 447.0), (middle, 599.0)):
        low, high = result.interval_m_s or (0.0, 0.0)
        assert low < measured < high
    title = "147 tests of fragment simulators on 14 aluminium alloys and 3 own tests of this lot"
    assert known(thin.model_error).source == title


def test_shipped_tests_given_as_own_tests_are_warned_of():
    tests = read_tests(TESTS, WILKINS)
    assert "13 of 13 tests are among those that the model error comes from" in "".join(repeated(tests))
    other_limits = [
        {**cells, "ballistic_limit_m_s": float(cells["ballistic_limit_m_s"]) + 0.5} for cells in tests.cells
    ]
    assert "2 of 13 tests" in "".join(repeated(read_tests([*other_limits[2:], *tests.cells[:2]], WILKINS)))
    assert not [*repeated(read_tests(other_limits, WILKINS))]
    oblique = read_tests([{**cells, OBLIQUITY: 0.0} for cells in tests.cells], WILKINS.replaced({OBLIQUITY: 30.0}))
    assert "13 of 13 tests" in "".join(repeated(oblique))


def test_own_tests_hold_for_the_named_entry_with_its_calibrated_value():
    case = of_thick()
    shipped = confidence(case.replaced({"armour.backing": "M"}))
    assert "own tests" not in known(shipped.model_error).source
    changed = confidence(case.replaced({STRENGTH: 1.2}))
    assert changed.probability_of_stopping is None
    assert "differs from the own tests of lot 7: back plates with a flow stress of 1.277 GPa" in changed.reason
    # Another entry of the same values has its own tests, whichever comes first (A14).
    tests = table_of(FRAGMENT, f"{BACKING},ballistic_limit_m_s", "30,600")
    data = case.to_dict()
    metals = data["library"]["metal"]
    evidence = scenario_of(tests, FRAGMENT, STRENGTH, "lot 8").to_dict()["library"]["metal"]["M, lot 8"]["evidence"]
    other_lot = {
        **metals["M, lot 7"],
        "evidence": evidence | {"calibrated": metals["M, lot 7"]["evidence"]["calibrated"]},
    }
    for order in ({"A": other_lot, **metals}, {**metals, "A": other_lot}):
        library = {**data, "library": {"metal": order}}
        of_a = confidence(parse_scenario(library).replaced({"armour.backing": "A"}))
        assert known(of_a.model_error).source.endswith("and 1 own test of this lot")


def test_one_lot_against_two_rounds_shares_the_effect_of_the_alloy():
    aluminium = plate("7.62 mm APM2", 280.0, 25.0)
    case = scenario_of(table_of(aluminium, f"{BACKING},ballistic_limit_m_s", "25,700", "30,790"), aluminium, STRENGTH)
    for projectile, thickness in (("7.62 mm APM2", 25.0), ("12.7 mm APM2", 40.0)):
        before, after = (
            confidence(armour.replaced({"impact.projectile": projectile, BACKING: thickness}))
            for armour in (aluminium, case)
        )
        low, high = ((result.interval_m_s or (0.0, 0.0)) for result in (before, after))
        assert high[0] + high[1] > low[0] + low[1]


def test_a_plate_of_which_no_test_is_known_has_none_by_own_tests():
    titanium = shipped_scenario("bare_plate").replaced({"armour.backing": "Ti-6Al-4V"})
    result = calibrate(table_of(titanium, f"{BACKING},ballistic_limit_m_s", "20,700"), titanium, STRENGTH)
    assert result.evidence is None


def test_the_probability_is_the_same_whichever_law_was_fitted():
    expected = probability(confidence(of_wilkins("constant")))
    assert 0.3 < expected < 0.7
    assert probability(confidence(of_wilkins("product"))) == pytest.approx(expected, abs=1e-4)


def test_rows_and_designs_are_single_answers():
    case = of_wilkins("product")
    [of_row] = evaluate(case, {}, ["probability_of_stopping"])["probability_of_stopping"]
    only = {"thickness_mm": [6.35]}
    catalogue = {
        "ceramic": [{"material": "AD85, lot 7", **only}, {"material": "AD85", **only}],
        "backing": [{"material": "6061-T6", **only}],
        "probability_of_stopping": 0.51,
    }
    pairs = {pair.ceramic: pair.best for pair in optimise(case.replaced({"design": catalogue, VELOCITY: 660.0})).pairs}
    best = known(pairs["AD85, lot 7"])
    [found] = best.check.threats
    assert known(found.model_error).source.endswith("and 13 own tests of this lot")
    single = probability(confidence(case.replaced({VELOCITY: 660.0})))
    assert found.probability_of_stopping == pytest.approx(single, abs=1e-9)
    assert of_row == pytest.approx(probability(confidence(case)), abs=1e-9)


def test_a_bound_on_the_probability_is_kept_where_the_own_law_has_no_weight():
    ranges = {f"{layer}_thickness_mm": {"min": 4.0, "max": 12.0, "step": 0.5} for layer in ("ceramic", "backing")}
    case = of_wilkins().replaced({"optimise": ranges, "design.probability_of_stopping": 0.9})
    best = best_of(optimise(case))
    design = {CERAMIC: best.ceramic_thickness_mm, BACKING: best.backing_thickness_mm}
    assert probability(confidence(case.replaced(design))) >= 0.9
    thinner = design | {CERAMIC: best.ceramic_thickness_mm - 0.5}
    assert probability(confidence(case.replaced(thinner))) < 0.9


def test_unlike_the_tests_the_probability_is_unknown_and_says_why():
    case = of_wilkins()
    for changes, words in (
        ({CERAMIC: 17.0}, "the armour is too far from the tests"),
        ({"armour.backing": "Ti-6Al-4V"}, "differs from the own tests of lot 7: back plates of 2600 to 2900 kg/m³"),
        ({OBLIQUITY: 10.0}, "no test of an armour with a ceramic at an angle"),
    ):
        answer = confidence(case.replaced(changes))
        assert answer.probability_of_stopping is None
        assert words in answer.reason
    far = case.replaced({CERAMIC: 40.0, BACKING: 2.0})
    ranges = {"ceramic_thickness_mm": {"min": 40.0, "max": 50.0, "step": 10.0}}
    result = optimise(far.replaced({"optimise": ranges, "design.probability_of_stopping": 0.9}))
    assert result.reason == "not known"
    assert result.shown.check.threats[0].reason == confidence(far).reason


CARBIDE = WILKINS.replaced({"armour.ceramic": "SiC"})


def test_own_tests_of_a_ceramic_without_shipped_tests():
    assert confidence(CARBIDE).probability_of_stopping is None
    tests = table_of(CARBIDE, f"{CERAMIC},{BACKING},ballistic_limit_m_s", "6,6,900", "7,6,970")
    result = confidence(
        scenario_of(tests, CARBIDE, FLOW_STRESS).replaced({CERAMIC: 6.5, BACKING: 6.0, VELOCITY: 900.0})
    )
    low, high = result.interval_m_s or (0.0, 0.0)
    assert 780.0 < low < 935.0 < high < 1100.0
    assert result.warnings == ()


@pytest.mark.parametrize("limits", [(640, 850, 970), (850, 850, 970), (640, 1050, 970), (640, 850, 580)])
def test_a_mistyped_own_test_is_warned_of_and_the_answer_says_so(limits: tuple[int, ...]):
    """Which of three is wrong, the others do not always tell; a limit that no lot can have is no evidence."""
    rows = [f"{layers},{limit}" for layers, limit in zip(("4,4", "6,5", "8,6"), limits, strict=True)]
    tests = table_of(CARBIDE, f"{CERAMIC},{BACKING},ballistic_limit_m_s", *rows)
    result = calibrate(tests, CARBIDE)
    named = [warning for warning in result.warnings if warning.startswith("row ")]
    assert len(named) == (limits != (640, 850, 970))
    if result.evidence is not None:
        error = confidence(written(result, tests, CARBIDE).replaced({CERAMIC: 6.0, BACKING: 5.0})).model_error
        assert error is not None
        assert ("3 own tests of this lot (1 out of line)" in error.source) == len(named)


@pytest.mark.parametrize(("stopped", "perforated", "contradict"), [(740, 780, False), (790, 650, True)])
def test_outcomes_that_contradict_each_other_are_warned_of(stopped: int, perforated: int, contradict: bool):
    header = f"{CERAMIC},{BACKING},{VELOCITY},outcome"
    tests = table_of(CARBIDE, header, f"6,5,{stopped},partial", f"6,5,{perforated},complete", "8,6,860,partial")
    warnings = calibrate(tests, CARBIDE).warnings
    assert any("out of line with the other tests: measured at" in warning for warning in warnings) == contradict


def test_shots_that_were_all_stopped_tell_something_and_are_warned_of():
    header = f"{CERAMIC},{BACKING},{VELOCITY},outcome,ballistic_limit_uncertainty_m_s"
    tests = table_of(CARBIDE, header, "7,6,950,partial,20", "7,6,960,partial,20")
    result = calibrate(tests, CARBIDE)
    assert result.coefficients[0].estimate is None
    assert any("all shots have the same outcome" in warning for warning in result.warnings)
    assert "ceramic.flow_stress_GPa stays at 9: the tests do not identify it" in result.warnings
    case = written(result, tests, CARBIDE).replaced({CERAMIC: 7.0, BACKING: 6.0})
    assert probability(confidence(case.replaced({VELOCITY: 900.0}))) > 0.8
    assert case.inputs()[FLOW_STRESS] == 9.0


def test_a_calibrated_material_is_not_calibrated_again():
    case = of_wilkins()
    with pytest.raises(InputError, match="must not be of a material with own tests, found AD85, lot 7"):
        calibrate(read_tests(TESTS, case), case)


def test_the_file_keeps_the_tests_readably():
    text = scenario_text(calibrate(THICK, FRAGMENT, STRENGTH), THICK, FRAGMENT, "lot 7", FILE)
    assert "velocity_m_s = [865.0, 848.0, 881.0]\n" in text
    assert 'lot = "lot 7"\n' in text
    again = known(parse_scenario(tomllib.loads(text)).entry("metal", "M, lot 7").evidence)
    q = armours_of(FRAGMENT.replaced({BACKING: 36.6})).quantities()
    assert again.tests["backing_thickness_ratio"][0] == pytest.approx(q["backing_thickness_ratio"][0])


@pytest.mark.slow
def test_tests_of_a_real_lot_predict_the_others_of_it():
    """As on docs/evidence/own-tests.md, of fewer draws."""
    before, after = (
        [lot.get("all") for lot in campaign.lots_of("fragments_aluminium", own, draws=6)] for own in (0, 1)
    )
    pairs = [
        (alone, known) for alone, known in zip(before, after, strict=True) if alone is not None and known is not None
    ]
    squares, _, above, *_ = np.mean(pairs, axis=0).T
    assert 100.0 * above.min() >= 95.0
    assert squares[1] < squares[0]


@pytest.mark.slow
@pytest.mark.parametrize("case", campaign.CASES[::3], ids=lambda case: case.name)
def test_intervals_hold_the_limits_of_simulated_lots(case: campaign.Case):
    dice = np.random.default_rng(3)
    for outcome in campaign.simulated(case, 0.035, dice, samples=24).values():
        assert outcome.within.mean() >= 0.92
        assert outcome.above.mean() >= 0.92


def test_own_tests_at_an_angle_tell_of_that_angle_alone():
    """Of ceramics no test at an angle is known, so that what is seen there may be an effect of the angle."""
    steep = scenario_of(table_of(WILKINS, f"{OBLIQUITY},ballistic_limit_m_s", "45,900"), WILKINS, FLOW_STRESS)
    assert confidence(steep.replaced({OBLIQUITY: 45.0})).probability_of_stopping is not None
    for angle in (0.0, 30.0):
        result = confidence(steep.replaced({OBLIQUITY: angle}))
        assert result.probability_of_stopping is None
        assert "paths of 1.4" in result.reason
    mixed = scenario_of(table_of(WILKINS, f"{OBLIQUITY},ballistic_limit_m_s", "0,720", "45,900"), WILKINS, FLOW_STRESS)
    assert confidence(mixed).probability_of_stopping is not None
    assert confidence(mixed.replaced({OBLIQUITY: 45.0})).probability_of_stopping is None


@pytest.mark.parametrize(
    ("column", "rows", "unused"),
    [
        (CERAMIC, ("6.35,720", "8,780", ",240"), "row 3: it is of a bare plate"),
        (OBLIQUITY, ("0,720", "45,900", "0,725"), "row 2: it is at another angle than most"),
        (OBLIQUITY, ("45,890", "45,900", "0,725"), "row 3: it is at another angle than most"),
        ("projectile.penetrator_mass_g", ("8.3,720", "8.5,740", "60,800"), "row 3: it is of a long rod"),
    ],
)
def test_a_test_that_is_not_used_is_named_and_does_not_switch_the_others_off(
    column: str, rows: tuple[str, ...], unused: str
):
    tests = table_of(WILKINS, f"{column},ballistic_limit_m_s", *rows)
    result = calibrate(tests, WILKINS)
    assert result.warnings[0].startswith(f"not used for the probability of stopping: {unused}")
    place = int(unused[4]) - 1
    others = table_of(WILKINS, f"{column},ballistic_limit_m_s", *rows[:place], *rows[place + 1 :])
    alone, kept = known(calibrate(others, WILKINS).evidence), known(result.evidence)
    assert [law["computed_m_s"] for law in kept["law"]] == [law["computed_m_s"] for law in alone["law"]]
    assert kept["tests"] == alone["tests"]
    assert kept["source"] == "2 tests of rows"


def test_a_test_of_an_armour_with_a_ceramic_is_not_used_for_its_back_plate():
    case = plate("7.62 mm APM2", 300.0, 20.0).replaced({"armour.ceramic": "AD85", "armour.backing": "AA6082-T651"})
    rows = ("0,20,600", "0,25,700", "6,20,800")
    tests = table_of(case, f"{CERAMIC},{BACKING},ballistic_limit_m_s", *rows)
    result = calibrate(tests, case, "backing.flow_stress_GPa")
    expected = "not used for the probability of stopping: row 3: it is of an armour with a ceramic"
    assert result.warnings[0] == expected
    assert len(known(result.evidence)["tests"]["side"]) == 2


@pytest.mark.parametrize(
    ("rows", "settings"),
    [
        (("ballistic_limit_m_s", "750", "760"), {"solver.time_step_us": 20.0}),
        (("impact.velocity_m_s,residual_velocity_m_s", "1000,300"), {}),
    ],
)
def test_an_entry_whose_tests_say_nothing_of_the_error_has_none(rows: tuple[str, ...], settings: dict[str, Any]):
    case = shipped_scenario("wilkins").replaced(settings)
    calibrated = scenario_of(table_of(case, *rows), case, FLOW_STRESS).replaced(dict.fromkeys(settings))
    result = confidence(calibrated)
    assert result.probability_of_stopping is None
    assert "do not determine the model error" in result.reason


def test_a_limit_far_from_what_any_lot_can_have_is_no_evidence():
    for rows, plausible in ((["6.35,880"], 1), (["6.35,1900"], 0), (["6.35,200"], 0), (["8,785", "1e-9,640"], 1)):
        own = table_of(WILKINS, f"{BACKING},ballistic_limit_m_s", *rows)
        assert (calibrate(own, WILKINS, FLOW_STRESS).evidence is not None) == plausible


def test_evidence_that_cannot_be_is_refused():
    data = scenario_of(table_of(WILKINS, "ballistic_limit_m_s", "720"), WILKINS, FLOW_STRESS).to_dict()
    [entry] = data["library"]["ceramic"].values()
    good = entry["evidence"]
    for key, value in (("path_ratio", 0.5), ("side", 5.0), ("uncertainty_m_s", -50.0), ("velocity_m_s", 0.0)):
        changed = {**good, "tests": {**good["tests"], key: [value]}}
        with pytest.raises(InputError, match=f"{key} has an impossible number"):
            parse_scenario({**data, "library": {"ceramic": {"AD85, lot 7": {**entry, "evidence": changed}}}})


LABORATORIES = [(6, 734, 801), (7, 878, 963), (8, 925, 1018), (9, 926, 1010), (10, 1033, 1137)]


@pytest.mark.parametrize(("column", "apart"), [("laboratory", True), ("date", True), ("laboratory", False)])
def test_residuals_that_split_by_a_column_that_is_no_input_are_warned_of(column: str, apart: bool):
    """Two laboratories that differ by 10 % (A6), or of the same limits."""
    rows = [f"{name},{c},{b if name == 'B' and apart else a}" for name in "AB" for c, a, b in LABORATORIES]
    rows = [f"{i},{row}" for i, row in enumerate(rows)]
    tests = table_of(WILKINS, f"test,{column},{CERAMIC},ballistic_limit_m_s", *rows)
    result = calibrate(tests, WILKINS)
    named = [warning for warning in result.warnings if f"the deviations differ by {column}: A -4." in warning]
    assert len(named) == apart
    assert ("series" in known(result.evidence)["tests"]) == (column == "laboratory")


def test_an_answer_is_for_a_laboratory_that_did_not_test():
    rows = [
        f"{i},{name},{c},{limit}" for i, (name, c, limit) in enumerate([("A", 6, 690), ("A", 7, 740), ("B", 8, 800)])
    ]
    header = f"test,laboratory,{CERAMIC},ballistic_limit_m_s"
    one = [row.replace("B", "A") for row in rows]
    of_one, of_two = (scenario_of(table_of(WILKINS, header, *table), WILKINS, FLOW_STRESS) for table in (one, rows))
    (low, high), (lowest, highest) = interval_of(of_one), interval_of(of_two)
    assert highest / lowest > high / low
    for calibrated, several in ((of_one, False), (of_two, True)):
        error = known(confidence(calibrated).model_error)
        assert error.source.endswith(", for another laboratory or series") == several


def test_a_limit_that_is_only_known_to_be_above_or_below_is_an_outcome():
    bounds = table_of(WILKINS, f"{CERAMIC},ballistic_limit_m_s", "6,700", "8,above 900", "5,<= 800", "7,> 650")
    columns = f"{CERAMIC},ballistic_limit_m_s,{VELOCITY},outcome"
    outcomes = table_of(WILKINS, columns, "6,700,,", "8,,900,stopped", "5,,800,perforated", "7,,650,stopped")
    assert bounds.measurements == outcomes.measurements
    feet = table_of(WILKINS, f"{CERAMIC},V50 (ft/s)", "8,above 2500")
    assert feet.measurements == (Measurement(0, "ballistic_limit_m_s", 762.0, None, 1),)
    with pytest.raises(InputError, match="must be a number"):
        table_of(WILKINS, "ballistic_limit_m_s", "above all")


def test_what_other_tests_contradict_is_not_said_of_armours_like_the_own_tests():
    """The limits on bare steel are corrected by own tests with cores, those against fragments are not."""
    case = scenario("7.62 mm APM2", None, "RHA Class 1", 0.0, 12.0, velocity=600.0)
    own = scenario_of(table_of(case, f"{BACKING},ballistic_limit_m_s", "12,690", "14,760"), case, STRENGTH)

    def said(of: Scenario) -> list[tuple[str | float, ...]]:
        return [note.about for note in check(of).notes if note.said not in ("", "far", "detail")]

    assert said(case) == [("contradicted", "normal_steel"), ("contradicted", "lots_of_steel")]
    assert said(own) == []
    assert said(own.replaced({"impact.projectile": "12.7 mm FSP"})) == [("contradicted", "fragments")]


LIMIT_AT_8 = 878.0
DATES = {
    "%Y-%m-%d": ("2025-11-03", "2025-12-20", "2026-01-09", "2026-02-14", "2026-03-02", "2026-04-11"),
    "%d.%m.%Y": ("03.11.2025", "20.12.2025", "09.01.2026", "14.02.2026", "02.03.2026", "11.04.2026"),
    "%m/%d/%Y": ("11/03/2025", "12/20/2025", "01/09/2026", "02/14/2026", "03/02/2026", "04/11/2026"),
}


@pytest.mark.parametrize("dates", DATES.values(), ids=DATES)
@pytest.mark.parametrize("steady", [True, False])
def test_a_steady_drift_over_dates_is_named(dates: tuple[str, ...], steady: bool):
    """Limits that rise by 2 % with each date, in or out of the order of the dates, in a table of any order."""
    rises = (0, 1, 2, 3, 4, 5) if steady else (3, 0, 5, 1, 4, 2)
    rows = [
        f"{i},{day},8,{LIMIT_AT_8 * 1.02**rise:.1f}" for i, (day, rise) in enumerate(zip(dates, rises, strict=True))
    ]
    tests = table_of(WILKINS, f"test,date,{CERAMIC},ballistic_limit_m_s", *rows[3:], *rows[:3])
    named = [
        warning for warning in calibrate(tests, WILKINS).warnings if "the deviations drift with the date" in warning
    ]
    assert len(named) == steady
    days = [(date.fromisoformat(day) - date(2025, 11, 3)).days for day in DATES["%Y-%m-%d"]]
    drift = 100.0 * (1.02 ** (np.polyfit(days, rises, 1)[0] * days[-1]) - 1.0)
    assert not steady or f"{drift:+.1f} % from {dates[0]} to {dates[-1]}; chance alone" in named[0]
