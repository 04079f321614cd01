from dataclasses import replace

import pytest

from armour.reporting.by_result import in_a_line
from armour.reporting.views import statistics as view
from armour.reporting.views.statistics import correlation_table, residual_table
from armour.reporting.words import chance
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.likelihood import Coefficient
from armour.statistics.v50 import Shots, v50
from tests.reporting.tables import facts
from tests.statistics.results import uncertainty_result


@pytest.fixture
def calibration() -> CalibrationResult:
    return CalibrationResult(
        tests="t.csv",
        law="linear",
        weights="uncertainties",
        coefficients=(
            Coefficient("ceramic.flow_stress_GPa", 5.2094, (4.87, 5.548)),
            Coefficient("ceramic.flow_stress_ceramic_slope", None, None, "the tests do not change with it"),
        ),
        correlation=((1.0, -0.5), (-0.5, 1.0)),
        residuals=(
            Residual("1", "ballistic_limit_m_s", 700.0, 714.0, 721.0, ""),
            Residual("2", "ballistic_limit_m_s", 800.0, 790.0, None, "at least"),
        ),
        mean_error_percent=2.0,
        left_out_error_percent=None,
        degrees_of_freedom=1,
        chi_squared=3.25,
        starts=3,
        starts_agreeing=2,
        confidence=0.95,
        p_value=0.03,
        widened_by=1.8,
    )


def test_a_fit_is_its_coefficients_and_tests(calibration: CalibrationResult):
    assert in_a_line(calibration) == (
        "ceramic flow stress 5.209 GPa (95 % between 4.87 and 5.548); "
        "ceramic flow stress ceramic slope not identified: the tests do not change with it"
    )
    assert facts(view.tables_of_calibration(calibration)) == {"tests": "2: 1 700 m/s, 2 at least 800 m/s"}
    assert correlation_table(calibration).texts()[0] == ["1 ceramic flow stress, GPa", "+1.000", "-0.500"]


def test_many_tests_are_their_errors_and_the_farthest(calibration: CalibrationResult):
    limits = (
        Residual(name, "ballistic_limit_m_s", 700.0, 700.0 + off, None, "")
        for name, off in zip("abcd", range(4), strict=True)
    )
    shown = facts(view.tables_of_calibration(replace(calibration, residuals=(*calibration.residuals, *limits))))
    assert shown["tests"] == "6, mean error 2.0 %, 1 outcome contradicts the fit"
    assert shown["farthest"] == "1 +2.0 %, d +0.4 %, c +0.3 %"


def test_residuals(calibration: CalibrationResult):
    assert residual_table(calibration).texts() == [
        ["1", "ballistic limit, m/s", "", "700", "714", "+2.0", "+3.0", ""],
        ["2", "ballistic limit, m/s", "at least", "800", "790", "", "", "no"],
    ]


def test_a_mean_of_no_usual_rule_and_shots_without_a_rising_curve():
    shots = Shots((700.0, 740.0, 770.0, 780.0, 750.0), (False, False, False, False, True))
    found = v50(shots, pairs=1, span_m_s=30.0)
    assert in_a_line(found) == "V50 not known: no curve rises with the velocity"
    mean = facts(view.tables_of_firing(found))["mean"]
    assert mean == "765 m/s of 1 + 1 shots within 30 m/s, 30 allowed (no usual rule)"


def test_the_answer_has_an_interval_that_is_bounded_or_what_would_bound_it():
    velocities = (812.0, 835.0, 851.0, 840.0, 858.0, 846.0, 838.0, 829.0, 848.0)
    complete = (False, False, True, False, True, True, True, False, False)
    shots = Shots(velocities, complete)
    found = v50(shots)
    assert in_a_line(found) == "V50 843 m/s (90 % between 819 and 905; 95 % is not bounded)"
    shown = facts(view.tables_of_firing(found))
    assert shown["more"] == "a shot perforating at 866 m/s would bound V50: 799 to 885 m/s"
    assert shown["mean"] == "843 m/s of 3 + 3 shots within 16 m/s, 27.4 allowed (MIL-STD-662F)"
    assert shown["shots"] == "9, 4 perforated; highest stopped 848 m/s, lowest perforated 838 m/s"
    wider = v50(Shots((*velocities, 900.0, 780.0), (*complete, True, False)))
    assert in_a_line(wider).startswith("V50 844 m/s (95 % between 777 and 1069), at least ")
    assert "more" not in facts(view.tables_of_firing(wider))


def test_a_v50_that_the_shots_do_not_bound_is_no_answer():
    found = v50(Shots((735.3, 761.4, 720.0, 748.0, 744.0), (False, True, True, False, True)), fraction=0.01)
    assert in_a_line(found) == "V50 not bounded by these shots"
    shown = facts(view.tables_of_firing(found))
    assert shown["more"].startswith("a shot stopped at ")
    assert " would bound V50: 50 % " in shown["more"]
    assert shown["V01"].startswith("no positive estimate")


def test_a_requirement_is_met_at_the_one_sided_bound():
    partial, complete = (780.0, 812.0, 829.0, 835.0, 840.0, 848.0), (838.0, 846.0, 851.0, 858.0, 900.0)
    shots = Shots((*partial, *complete), (False,) * 6 + (True,) * 5)
    without = v50(shots)
    fit = without.recommended
    assert fit is not None
    bound = fit.v50_lower_m_s or 0.0
    found = [v50(shots, requirement_m_s=bound + away) for away in (-0.5, 0.5, 400.0)]
    assert [each.decision for each in found] == ["met", "not decided", "not met"]
    assert found[0].consumers_risk == pytest.approx(0.05, abs=0.002)
    assert [(each.consumers_risk or 0.0) + (each.producers_risk or 0.0) for each in found] == pytest.approx([1.0] * 3)
    verdict, estimate, *_ = view.tables_of_firing(found[1])
    assert str(verdict).startswith(f"not decided: V50 of at least {bound + 0.5:g} m/s; risk of accepting now 5")
    assert estimate == in_a_line(without).partition(", at least")[0]
    assert ["risk of accepting " in in_a_line(each) for each in found] == [True, True, False]
    assert in_a_line(found[2]).startswith(f"not met: V50 of at least {bound + 400.0:g} m/s; risk of rejecting ")
    assert without.decision == ""


@pytest.mark.parametrize("confidence", [0.5, 0.89, 0.9, 0.95, 0.955, 0.99, 0.995])
def test_no_probability_is_shown_that_is_not_reached(confidence: float):
    for probability in (confidence - 1e-6, confidence - 0.004, confidence - 0.006):
        shown = chance(probability).removeprefix("above ")
        assert float(shown.removesuffix(" %")) <= 100.0 * probability
    assert chance(0.29) == "29 %"
    assert [chance(p) for p in (0.004, 0.999, None)] == ["below 1 %", "above 99 %", "not known"]


def test_where_a_probability_is_not_known_what_is_given_is_called_so():
    unknown, known_result = (uncertainty_result(known=is_known) for is_known in (False, True))
    taken = "with the model taken as exact"
    assert in_a_line(unknown) == f"not known: no test of such an armour is known; {taken} 79.0 %"
    assert in_a_line(known_result) == "stops a shot with 79.0 % (± 1 by sampling)"
    between = "90 % between 680 and 770 m/s"
    assert (
        facts(view.tables_of_uncertainty(known_result))["limit"] == f"720 m/s expected; {between}; 724 m/s by the model"
    )
    assert facts(view.tables_of_uncertainty(unknown))["limit"] == f"{between}; 724 m/s by the model"
