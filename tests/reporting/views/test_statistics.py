from dataclasses import replace

import pytest

from armour.analysis.estimates import Estimate
from armour.reporting.table import Table
from armour.reporting.views import calibration as calibration_view
from armour.reporting.views import firing as v50_view
from armour.reporting.views import uncertainty as uncertainty_view
from armour.reporting.views.calibration import coefficient_table, correlation_table, residual_table
from armour.reporting.views.confidence import SAMPLED_ALONE
from armour.reporting.views.firing import v50_table
from armour.reporting.views.uncertainty import INDEX_NOTE, SAMPLING_NOTE, index_table
from armour.statistics.calibration import CalibrationResult, LawFit, Residual
from armour.statistics.likelihood import Coefficient
from armour.statistics.uncertainty import Influence, ProbabilityCurve, UncertaintyResult
from armour.statistics.v50 import Shots, v50


def test_a_velocity_below_zero_is_said_not_to_be_given():
    low = v50(Shots((60.0, 160.0, 230.0, 270.0, 280.0), (False, True, True, True, True)), pairs=1, span_m_s=100.0)
    assert low.recommended is not None
    assert low.recommended.v05_m_s is None
    assert any(isinstance(item, str) and item.startswith("V05 has no estimate") for item in v50_view.tables(low))


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


def test_laws(calibration: CalibrationResult):
    laws = (LawFit("constant", 1, 5.05, 5.47, 142.82), LawFit("linear", 3, 3.46, None, None))
    tables = calibration_view.tables(replace(calibration, laws=laws))
    assert isinstance(tables[0], Table)
    assert tables[0].texts() == [
        ["constant", "1", "5.05", "5.47", "142.8"],
        ["linear", "3", "3.46", "too few tests", "too few tests"],
    ]


def test_coefficients(calibration: CalibrationResult):
    table = coefficient_table(calibration)
    assert table.headings()[-1] == "95 % interval"
    assert table.texts() == [
        ["ceramic flow stress, GPa", "5.209", "4.87 to 5.548"],
        ["ceramic flow stress ceramic slope", "not identified", "the tests do not change with it"],
    ]
    assert correlation_table(calibration).texts()[0] == ["1 ceramic flow stress, GPa", "+1.000", "-0.500"]


def test_residuals(calibration: CalibrationResult):
    assert residual_table(calibration).texts() == [
        ["1", "ballistic limit", "", "m/s", "700", "714.00", "+2.00", "+3.00", ""],
        ["2", "ballistic limit", "at least", "m/s", "800", "790.00", "", "", "no"],
    ]


def test_a_mean_of_no_usual_rule_and_shots_without_a_rising_curve():
    shots = Shots((700.0, 740.0, 770.0, 780.0, 750.0), (False, False, False, False, True))
    found = v50(shots, pairs=1, span_m_s=30.0)
    assert "V50, mean, m/s" in {column.heading for column in v50_table(found).columns}
    notes = [item for item in v50_view.tables(found) if isinstance(item, str)]
    assert "none that is usual with MIL-STD-662F" in notes[0]
    assert notes[1].startswith("no curve is recommended")


@pytest.fixture
def uncertainty() -> UncertaintyResult:
    limits = {"V05": Estimate(677.7, 675.5, 679.4), "V50": Estimate(722.34, 722.33, 722.35)}
    inputs = (
        Influence(
            "ceramic.flow_stress_GPa", Estimate(0.972, 0.89, 1.054), Estimate(0.974, 0.914, 1.037), (678.0, 769.1)
        ),
        Influence("projectile.penetrator_mass_g", Estimate(0.02, 0.01, 0.03), None, (700.0, 740.0)),
    )
    curve = ProbabilityCurve((), (), (), ())
    chance = Estimate(0.214, 0.201, 0.226)
    mean = 722.8, (722.79, 722.82)
    return UncertaintyResult(4096, 1, "sobol", 0.95, chance, limits, *mean, 28.0, 723.8, curve, inputs, ())


def test_indices(uncertainty: UncertaintyResult):
    assert index_table(uncertainty).texts() == [
        ["ceramic flow stress, GPa", "0.972", "0.890 to 1.054", "0.974", "0.914 to 1.037", "678.0", "769.1"],
        ["penetrator mass, g", "0.020", "0.010 to 0.030", "", "", "700.0", "740.0"],
    ]
    *_, error, alone, note = uncertainty_view.tables(uncertainty)
    assert alone == SAMPLED_ALONE
    assert SAMPLING_NOTE in uncertainty_view.tables(uncertainty)
    assert INDEX_NOTE in uncertainty_view.tables(uncertainty)
    assert error == "the error of the model is not known for such an armour, or not included"
    assert isinstance(note, str)
    assert "their sum may exceed 1; total indices are not given" in note
