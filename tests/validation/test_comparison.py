import json
from functools import cache
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.core.equations import fragmented_strength
from armour.engine.changes import equations
from armour.errors import InputError
from armour.reporting.views.validation import comparison_table, rule_note
from armour.validation.comparison import Comparison, compare
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
    assert penetrator.ballistic_limit_m_s == pytest.approx(602.5, abs=0.1)
    assert whole.ballistic_limit_m_s == pytest.approx(436.72, abs=0.01)


def test_each_formula_has_its_limit_and_its_mean_and_largest_error_and_a_fitted_one_that_of_tests_left_out():
    """The fitted exponent, 0.9376, is one of the details."""
    details = [
        ["724", "5.1 %", "11.3 %", ""],
        ["690", "4.2 %", "8.0 %", "4.5 %"],
        ["694", "4.0 %", "8.4 %", "4.6 %"],
        ["603", "13.6 %", "27.4 %", ""],
        ["437", "28.9 %", "46.0 %", ""],
    ]
    assert [row[1:] for row in comparison_table(compare(scenario()).of(every_row=True)).texts()] == details
    answer = [row[:3] for row in details if row[0] != "694"]
    assert [row[1:] for row in comparison_table(wilkins()).texts()] == answer


def test_tested_armours_are_those_with_the_nearest_limits():
    measured = [tested.ballistic_limit_m_s for tested in wilkins().measured]
    assert measured == pytest.approx([735.0, 724.0, 721.0])


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
    assert "without tests of this round and these materials; there are 13 tests" in rule_note(result)


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


def test_errors_are_those_of_changed_equations():
    with equations(fragmented_strength=lambda *args: 0.8 * fragmented_strength(*args)):
        weaker, *formulas = compare(scenario()).errors
    model, *others = wilkins().errors
    assert formulas == others
    assert weaker.mean_percent > model.mean_percent
