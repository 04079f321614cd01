import json
from pathlib import Path

import pytest

from armour.errors import ArmourError
from armour.validation import validate
from tests.helpers.cases import SCENARIOS

SUITE = f"""# mine
title = "My suite"

[[case]]
name = "limit"
scenario = "{SCENARIOS}/wilkins.toml"
quantity = "ballistic_limit_m_s"
expected = 723.77
band = 0.02
reason = "the search's bracket"

[[case]]
name = "speed"
scenario = "{SCENARIOS}/wilkins.toml"
quantity = "residual_velocity_m_s"
expected = 277.4
band = 0.1
"""


@pytest.fixture
def suite(folder: Path) -> Path:
    path = folder / "suite.toml"
    path.write_text(SUITE)
    return path


def test_json(cli, suite: Path):
    data = json.loads(cli("validate", suite, "--json").stdout)
    assert data["passed"] is True
    limit, speed = data["cases"]
    assert limit["computed"] == pytest.approx(723.7716, abs=1e-3)
    assert limit["deviation"] == pytest.approx(limit["computed"] - 723.77)
    assert (speed["quantity"], speed["status"], speed["band"]) == ("residual_velocity_m_s", "within", 0.1)


@pytest.mark.parametrize(
    "assignment",
    [
        "model.shear_perimeter=projectile",
        'model.shear_perimeter = "projectile"',
        'model={shear_perimeter="projectile"}',
    ],
)
def test_values_are_toml_or_plain_words(cli, suite: Path, assignment: str):
    data = json.loads(cli("validate", suite, "--only", "limit", "--set", assignment, "--json").stdout)
    assert data["cases"][0]["computed"] == pytest.approx(538.8, abs=0.1)


@pytest.mark.parametrize(
    "assignment",
    [
        'library.projectile."7.62 mm AP"={based_on="7.62 mm AP", penetrator_diameter_mm=6.2}',
        'library.projectile."7.62 mm AP".penetrator_diameter_mm=6.2',
        "projectile.penetrator_diameter_mm=6.2",
    ],
)
def test_an_entry_of_the_library_is_changed_by_its_name_or_its_role(cli, suite: Path, assignment: str):
    data = json.loads(cli("validate", suite, "--only", "limit", "--set", assignment, "--json").stdout)
    assert data["cases"][0]["computed"] < 710.0


def test_an_update_keeps_measurements(cli, suite: Path):
    """They stay within their band or outside, which then fails as without an update."""
    suite.write_text(SUITE + "regression = true\n")
    result = cli("validate", suite, "--update")
    assert result.exit_code == 0
    assert result.stderr.startswith("kept, as no regression values: 1 of 2 expected values\n")
    assert suite.read_text() == SUITE.replace("277.4", "277.37739") + "regression = true\n"
    suite.write_text(SUITE.replace("723.77", "800.0") + "regression = true\n")
    assert cli("validate", suite, "--update").exit_code == 3
    assert "expected = 800.0" in suite.read_text()
    suite.write_text(SUITE)
    [line] = cli.fails(2, "validate", suite, "--update")
    assert line.startswith(f"{suite}: regression: must be true for the suite")
    assert suite.read_text() == SUITE


def test_interrupted_it_shows_what_it_has(cli, suite: Path, monkeypatch: pytest.MonkeyPatch):
    check = validate.check

    def interrupted(case, known):
        if case.name == "speed":
            raise KeyboardInterrupt
        return check(case, known)

    monkeypatch.setattr(validate, "check", interrupted)
    result = cli("validate", suite)
    assert result.exit_code == 130
    assert "1 of 1 within their bands" in result.stdout
    assert result.stderr == "interrupted\n"
    assert not issubclass(KeyboardInterrupt, ArmourError)
    assert cli("validate", suite, "--json").stdout == ""


def test_a_shipped_suite_goes_by_its_name(cli, folder: Path):
    result = cli("validate", "plates", "--only", "on 10 mm AA6082-T6", "--json")
    data = json.loads(result.stdout)
    assert result.exit_code == 0
    assert {case["name"].partition(": ")[2] for case in data["cases"]} == {".30 APM2 on 10 mm AA6082-T6"}
    assert [table["status"] for table in data["tables"]] == ["not scored"]
    [line] = cli.fails(2, "validate", "plates", "--update")
    assert line.endswith("what is published stays")
    assert list(folder.iterdir()) == []
