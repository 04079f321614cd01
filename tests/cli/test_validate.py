import json
import tomllib
from pathlib import Path

import pytest

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


@pytest.mark.parametrize(
    ("assignment", "limit"),
    [
        ("model.shear_perimeter=projectile", 538.8),
        ('model={shear_perimeter="projectile"}', 538.8),
        ('library.projectile."7.62 mm AP"={based_on="7.62 mm AP", penetrator_diameter_mm=6.2}', 697.2),
        ("projectile.penetrator_diameter_mm=6.2", 697.2),
    ],
)
def test_values_are_toml_or_plain_words_and_entries_go_by_name_or_role(cli, suite: Path, assignment: str, limit: float):
    data = json.loads(cli("validate", suite, "--only", "limit", "--set", assignment, "--json").stdout)
    [found] = data["cases"]
    assert found["computed"] == pytest.approx(limit, abs=0.1)
    assert found["deviation"] == pytest.approx(found["computed"] - 723.77)
    assert (data["passed"], found["status"], found["band"]) == (False, "outside", 0.02)


def test_an_update_keeps_measurements(cli, suite: Path):
    """They stay within their band or outside, which then fails as without an update."""
    suite.write_text(SUITE + "regression = true\n")
    result = cli("validate", suite, "--update")
    assert result.exit_code == 0
    assert result.stderr.startswith("kept 1 of 2 expected values, which are not regression values\n")
    assert suite.read_text() == SUITE.replace("277.4", "277.37752") + "regression = true\n"
    suite.write_text(SUITE.replace("723.77", "800.0") + "regression = true\n")
    assert cli("validate", suite, "--update").exit_code == 3
    assert "expected = 800.0" in suite.read_text()


def test_an_update_fills_in_a_regression_value(cli, folder: Path):
    """Until then the suite fails; without the word, a value must be given."""
    text = SUITE.replace("expected = 723.77\n", "regression = true\n")
    (folder / "suite.toml").write_text(text)
    for options in ((), ("-v",)):
        before = cli("validate", "suite.toml", *options)
        assert "1 case without an expected value, which --update fills in" in before.stdout
        assert "--verbose shows them" not in before.stdout
        verdict = "1 of 2 within their bands, 1 no expected value"
        assert (before.exit_code, before.stdout.splitlines()[0]) == (3, verdict)
    assert cli("validate", "suite.toml", "--update").exit_code == 0
    assert cli("validate", "suite.toml").stdout.splitlines()[0] == "2 of 2 within their bands"
    assert tomllib.loads((folder / "suite.toml").read_text())["case"][0]["expected"] == pytest.approx(723.778)
    (folder / "suite.toml").write_text(text.replace("regression = true\n", ""))
    message = "is missing and must be given; --update fills in only a regression value without a source"
    assert cli.fails(2, "validate", "suite.toml") == [f"suite.toml: case[0].expected: {message} (line 4)"]
    (folder / "suite.toml").write_text(text.replace("regression = true", 'regression = true\nsource = "report 17"'))
    [line] = cli.fails(2, "validate", "suite.toml")
    assert message in line
