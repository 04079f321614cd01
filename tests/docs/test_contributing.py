"""Steps of the recipes in CONTRIBUTING.md of which no other test fails if they are left out."""

from pathlib import Path
from typing import get_args

import pytest

from armour.analysis.quantities import QUANTITIES
from armour.files import read_toml, shipped_suites
from armour.scenario.inputs import INPUTS, ROLES
from armour.scenario.library import KINDS, SCATTER_KEYS, SOURCES_KEY, STATIC, UNUSED, Entry
from armour.scenario.schema import DRIVE_LAWS, SHEAR_LAWS, Model
from armour.units import words_and_unit
from armour.validation.suite import load_suite
from tests.helpers.cases import SCENARIOS
from tests.validation.test_regression import SUITE as REGRESSION

ROOT = Path(__file__).parents[2]
LAWS = [("shear_perimeter", law) for law in SHEAR_LAWS] + [("plate_drive", law) for law in DRIVE_LAWS]


@pytest.mark.parametrize("name", QUANTITIES)
def test_the_name_of_an_output_ends_in_its_unit(name: str):
    assert words_and_unit(name)[1] == QUANTITIES[name].unit, f"{name}: ENDINGS of src/armour/units.py"


@pytest.mark.parametrize(("role", "kind"), ROLES.items())
def test_a_number_of_a_material_is_an_input(role: str, kind: str):
    keys = KINDS[kind].model_fields.keys() - Entry.model_fields.keys()  # type: ignore[index]
    missing = {key for key in keys if f"{role}.{key}" not in INPUTS} - {*UNUSED, STATIC, SOURCES_KEY, *SCATTER_KEYS}
    assert missing == set(), f"keys of a {kind} that are neither in INPUTS of scenario/inputs.py nor UNUSED"


@pytest.mark.parametrize(("key", "law"), LAWS)
def test_a_law_is_everywhere(key: str, law: str):
    assert law in get_args(Model.model_fields[key].annotation)
    [line] = [line for line in (SCENARIOS / "template.toml").read_text().splitlines() if line.startswith(f"# {key} = ")]
    assert f'"{law}"' in line, f"{law}: the comment of scenarios/template.toml"
    default = Model.model_fields[key].default
    asked = [case.get("set", {}).get("model", {}).get(key, default) for case in read_toml(REGRESSION)["case"]]
    assert law in asked, f"{law}: a case of tests/validation/regression.toml"
    pages = [(ROOT / "docs" / f"{page}.md").read_text() for page in ("model", "readings")]
    assert law == default or any(f'{key} = "{law}"' in page for page in pages), f"{law}: docs/readings.md"


@pytest.mark.parametrize("name", shipped_suites())
def test_a_suite_has_a_title_and_each_case_a_source_and_a_reason_for_its_band(name: str):
    suite = load_suite(name)
    assert suite.title
    cases = [case for case in suite.cases if not case.regression]
    assert [case.full_name for case in cases if not case.source] == [], "cases without source"
    bands = [case for case in cases if case.band is not None]
    assert sorted({case.full_name for case in bands if not case.reason}) == [], "cases with a band without reason"


def test_a_table_of_tests_has_its_line_on_origin():
    page = (SCENARIOS / "tests" / "README.md").read_text()
    files = [path.name for path in (SCENARIOS / "tests").glob("*.csv")]
    assert [name for name in files if f"`{name}`" not in page] == [], "tables that are not in scenarios/tests/README.md"
