import json
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"
TESTS = SCENARIOS / "tests" / "wilkins.csv"


def test_a_library_and_a_plot(cli, folder: Path):
    result = cli("calibrate", TESTS, WILKINS, "--write", "lib.toml", "--plot", "fit.svg")
    assert result.exit_code == 0
    assert "ceramic.flow_stress_GPa 5.209 4.87 to 5.548" in " ".join(result.stdout.split())
    assert result.stderr.splitlines() == ["wrote lib.toml", "wrote fit.svg"]
    assert "measured ballistic limit, m/s" in (folder / "fit.svg").read_text()


def test_calibrated_tests_are_shown_and_not_scored(cli, folder: Path):
    """A suite of the tests that an entry was calibrated to, and one that it was not."""
    cli("calibrate", TESTS, WILKINS, "--write", "lib.toml")
    (folder / "case.toml").write_text(
        WILKINS.read_text().replace('"AD85"', '"AD85, calibrated"') + '\n[library]\nfiles = ["lib.toml"]\n'
    )
    (folder / "suite.toml").write_text(
        """
[[table]]
name = "tests"
scenario = "case.toml"
quantity = "ballistic_limit_m_s"
columns = ["armour.ceramic_thickness_mm", "armour.backing_thickness_mm", "expected"]
rows = [[5.8, 7.24, 735], [5.8, 7.24, 736], [7.0, 7.0, 760]]
band = 50.0
"""
    )
    result = cli("validate", "suite.toml", "--json")
    assert result.exit_code == 0, result.output
    found = [(case["status"], case["message"]) for case in json.loads(result.stdout)["cases"]]
    assert found[0] == ("not scored", "not scored: flow_stress_GPa of AD85, calibrated was calibrated to this test")
    assert [status for status, _ in found[1:]] == ["within", "within"]


def test_json(cli):
    data = json.loads(cli("calibrate", TESTS, WILKINS, "--law", "thicknesses", "--json").stdout)
    assert len(data["coefficients"]) == 3
    assert len(data["residuals"]) == 13
    assert data["correlation"][0][0] == pytest.approx(1.0)


def test_wrong_input(cli, folder: Path):
    (folder / "t.csv").write_text("armour.ceramic_thickness_mm,ballistic_limit\n6,700\n")
    told = cli.fails(2, "calibrate", "t.csv", WILKINS)
    assert told == ["t.csv: ballistic_limit: unknown column; its unit is missing: ballistic_limit_m_s"]
    assert "did you mean" in cli.fails(2, "calibrate", TESTS, WILKINS, "--fit", "ceramic.flow_stres_GPa")[0]
    assert cli.fails(2, "calibrate", "missing.csv", WILKINS)[0].startswith("missing.csv: cannot be read")
    assert "must not be the file that is read" in cli.fails(2, "calibrate", TESTS, WILKINS, "--write", TESTS)[0]


def test_what_is_not_identified_is_not_written(cli, folder: Path):
    result = cli("calibrate", TESTS, WILKINS, "--fit", "ceramic.youngs_modulus_GPa", "--write", "lib.toml")
    assert result.exit_code == 1
    assert "not identified" in result.stdout
    assert "nothing to write" in result.stderr
    assert not (folder / "lib.toml").exists()
