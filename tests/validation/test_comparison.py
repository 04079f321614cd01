import json
from functools import cache
from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.core.equations import fragmented_strength
from armour.engine.changes import equations
from armour.errors import InputError
from armour.reporting.views.validation import rule_note
from armour.validation.comparison import Comparison, compare
from tests.helpers.cases import scenario
from tests.helpers.known import known

pytestmark = pytest.mark.slow


@cache
def wilkins() -> Comparison:
    """Comparison for the Wilkins case."""
    return compare(scenario())


def test_the_wilkins_case():
    """Each method has its limit and its mean and largest error, and a fitted one that of tests left out."""
    result = wilkins()
    assert result.limit == ballistic_limit(scenario())
    assert [
        (round(each.ballistic_limit_m_s), round(known(each.mean_percent), 1), round(known(each.largest_percent), 1))
        for each in result.predictions
    ] == [(724, 5.1, 11.3), (690, 4.2, 8.0), (603, 13.6, 27.4), (437, 28.9, 46.0)]
    assert [each.left_out_percent for each in result.predictions] == [None, pytest.approx(4.5, abs=0.05), None, None]
    assert result.tests.startswith("13 tests of 7.62 mm AP on AD85 and 6061-T6, 35.8 to 52.5 kg/m²")


def test_tested_armours_are_those_with_the_nearest_limits():
    measured = [tested.ballistic_limit_m_s for tested in wilkins().measured]
    assert measured == pytest.approx([735.0, 724.0, 721.0])


def test_plain_data():
    data = json.loads(json.dumps(wilkins().to_dict()))
    limit = data["limit"]["ballistic_limit_m_s"]
    assert limit == data["predictions"][0]["ballistic_limit_m_s"] == pytest.approx(723.778, abs=1e-3)
    assert data["predictions"][1]["method"] == "k times areal density, fitted"


def test_a_projectile_with_a_known_penetrator_only():
    thick = scenario(projectile="25 mm APDS", ceramic_mm=20.0, backing_mm=30.0)
    assert [each.method for each in compare(thick).predictions] == ["the model", "Florence, penetrator"]


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
    assert [each.mean_percent for each in result.predictions] == [None, None, None]
    assert "none of the tests is of this round and these materials; they are 13 tests" in rule_note(result)


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
        weaker, *formulas = compare(scenario()).predictions
    model, *others = wilkins().predictions
    assert formulas == others
    assert known(weaker.mean_percent) > known(model.mean_percent)
