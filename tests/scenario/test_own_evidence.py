"""The model error by own tests, for armours like them and unlike them, in single answers and in rows."""

import tomllib
from functools import cache
from math import log
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import confidence
from armour.analysis.evaluate import evaluate
from armour.design.optimise import optimise
from armour.errors import NoDesignError
from armour.reporting.views.design import tables
from armour.scenario.scenario import Scenario, parse_scenario
from armour.statistics.calibration import Law, calibrate
from armour.statistics.fitted_library import scenario_text
from armour.statistics.measured import read_tests
from armour.statistics.own_tests import TESTED, TESTED_GPA, Measured, evidence_of
from tests.helpers.cases import TESTS, shipped_scenario
from tests.helpers.fits import table_of, wilkins_fit
from tools.campaigns import own_tests as campaign

pytestmark = pytest.mark.slow

LAYERS = ("ceramic", 9.0), ("backing", 6.0)
C, B, P = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm", "probability_of_defeat"


@cache
def calibrated(law: Law) -> Scenario:
    """The scenario of Wilkins' tests with AD85 calibrated to them."""
    wilkins = shipped_scenario("wilkins")
    text = scenario_text(wilkins_fit(law), read_tests(TESTS, wilkins), wilkins, Path("made.toml"))
    return parse_scenario(tomllib.loads(text), file="made.toml").replaced({"impact.velocity_m_s": 700.0})


def test_the_probability_is_the_same_whichever_law_was_fitted():
    found = [confidence(calibrated(law)).probability_of_defeat or 0.0 for law in ("constant", "backing", "product")]
    assert found == pytest.approx([found[0]] * 3, abs=0.001)
    assert 0.3 < found[0] < 0.7


def test_rows_are_single_answers():
    case = calibrated("backing")
    columns = {C: np.array([6.35, 8.0, 4.5, 25.0]), B: np.array([6.35, 6.0, 3.5, 6.0])}
    found = evaluate(case, columns, [P])[P]
    for i, value in enumerate(found):
        single = confidence(case.with_inputs({name: float(values[i]) for name, values in columns.items()}))
        expected = single.probability_of_defeat
        assert np.isnan(value) if expected is None else value == pytest.approx(expected, abs=1e-4)
    assert np.isnan(found).tolist() == [False, False, False, True]


@pytest.mark.parametrize("design", [(8.0, 6.0), (10.0, 8.0)])
def test_the_interval_is_that_of_the_tests(design: tuple[float, float]):
    """As `tools.campaigns.own_tests` predicts it, whose shares of intervals that hold the limit are published."""
    read = read_tests(TESTS, shipped_scenario("wilkins"))
    columns = read.groups[0].columns
    armours = tuple(zip(columns[C].tolist(), columns[B].tolist(), strict=True))
    values, nothing = np.log([m.value for m in read.measurements]), np.zeros(len(armours))
    measured = Measured(values, nothing, nothing, [campaign.curve(armour) for armour in armours])
    laws = evidence_of(measured, campaign.covariates(armours), log(TESTED_GPA), TESTED)
    expected = campaign.predicted(laws, design).quantile(np.array([0.025, 0.975]))
    case = calibrated("product").replaced({C: design[0], B: design[1]})
    assert confidence(case).interval_m_s == pytest.approx(expected.tolist(), rel=0.01)


def test_armour_unlike_the_tests_has_no_error_and_says_why():
    case = calibrated("constant")
    thick = confidence(case.replaced({C: 16.0}))
    assert thick.probability_of_defeat is None
    assert thick.reason.startswith(
        "the armour differs from the 13 own tests in wilkins.csv to which AD85, calibrated is"
    )
    assert "ceramics 0.8923 to 1.208 penetrator diameters thick" in thick.reason
    for changes in ({"impact.projectile": "25 mm APDS"}, {"armour.backing": "Ti-6Al-4V"}):
        assert confidence(case.replaced(changes)).probability_of_defeat is None
    wide = confidence(case.replaced({C: 10.0})).model_error
    assert wide is not None
    assert wide.source == "13 own tests in wilkins.csv, of armour of the tested lots"
    assert wide.extrapolated == ("ceramics 0.8923 to 1.208 penetrator diameters thick",)


def test_a_search_without_a_design_gives_the_same_reason():
    case = calibrated("constant").replaced({C: 40.0, B: 2.0})
    ranges = {"ceramic_thickness_mm": {"min": 40.0, "max": 50.0, "step": 10.0}}
    asked = case.replaced({"optimise": ranges, "design.confidence": 0.9})
    with pytest.raises(NoDesignError) as raised:
        optimise(asked)
    assert str(raised.value) == f"the model error is not known: {confidence(case).reason}"


def test_a_design_gives_the_same_reason():
    case = calibrated("constant").replaced({"impact.obliquity_deg": 30.0, C: 9.0, B: 6.0})
    ranges = {f"{layer}_thickness_mm": {"min": own, "max": own, "step": 1.0} for layer, own in LAYERS}
    found = optimise(case.replaced({"optimise": ranges}))
    assert f"model error: unknown, {confidence(case).reason}" in tables(found)


PLATE: dict[str, Any] = {
    "impact": {"projectile": "7.62 mm APM2", "velocity_m_s": 650.0},
    "armour": {"ceramic_thickness_mm": 0.0, "backing": "5083-H3", "backing_thickness_mm": 25.0},
}


def test_tests_of_a_plate_are_not_those_of_another_plate_or_round():
    """Six tests of a 7.62 mm round gave 98 % against a 14.5 mm tungsten-carbide core on another alloy (D7)."""
    rows = [f"{thickness},{limit}" for thickness, limit in ((20, 620), (22, 650), (25, 700), (27, 725), (30, 770))]
    plate = parse_scenario(PLATE)
    tests = table_of(plate, f"{B},ballistic_limit_m_s", *rows)
    result = calibrate(tests, plate, "backing.flow_stress_GPa")
    made = scenario_text(result, tests, plate, Path("made.toml"))
    case = parse_scenario(tomllib.loads(made), file="made.toml")
    own = confidence(case)
    assert own.model_error is not None
    assert own.model_error.source == "5 own tests in rows, of armour of the tested lots"
    other = confidence(case.replaced({"impact.projectile": "14.5 mm BS41", B: 50.0}))
    assert other.probability_of_defeat is None
    assert "differs from the 5 own tests in rows" in other.reason
    shipped = confidence(case.replaced({"armour.backing": "6061-T6"}))
    assert shipped.model_error is None or "own tests" not in shipped.model_error.source


def test_each_pair_of_a_catalogue_has_the_error_of_its_own_materials():
    case = calibrated("backing").replaced({"impact.velocity_m_s": 600.0})
    layers = {"thickness_mm": [6.0]}
    design = {
        "ceramic": [{"material": "AD85, calibrated", **layers}, {"material": "AD85", **layers}],
        "backing": [{"material": "6061-T6", **layers}],
    }
    pairs = optimise(case.replaced({"design": design})).pairs
    found = {pair.ceramic: pair.best for pair in pairs if pair.best is not None}
    assert found.keys() == {"AD85, calibrated", "AD85"}
    for ceramic, best in found.items():
        one = confidence(case.replaced({"armour.ceramic": ceramic, C: 6.0, B: 6.0}))
        [probability] = best.probabilities_of_defeat.values()
        assert probability == pytest.approx(one.probability_of_defeat, abs=1e-4)
        assert best.model_error is not None
        assert ("own tests" in best.model_error.source) is (ceramic == "AD85, calibrated")
