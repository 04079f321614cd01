import json
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"
TESTS = SCENARIOS / "tests" / "wilkins.csv"


def test_a_library_and_a_plot(cli, folder: Path):
    result = cli("calibrate", TESTS, WILKINS, "--write", "lib.toml", "--plot", "fit.svg")
    assert result.exit_code == 0
    assert "ceramic flow stress, GPa 5.209 4.868 to 5.557" in " ".join(result.stdout.split())
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
    data = json.loads(cli("calibrate", TESTS, WILKINS, "--law", "backing", "--json").stdout)
    assert len(data["coefficients"]) == 2
    assert (data["p_value"], data["laws"], data["warnings"]) == (None, [], [])
    assert len(data["residuals"]) == 13
    assert data["correlation"][0][0] == pytest.approx(1.0)


def test_wrong_input(cli, folder: Path):
    (folder / "t.csv").write_text("armour.ceramic_thickness_mm,ballistic_limit\n6,700\n")
    told = cli.fails(2, "calibrate", "t.csv", WILKINS)
    assert told == ["t.csv: ballistic_limit: unknown column; its unit is missing: ballistic_limit_m_s"]
    assert "did you mean" in cli.fails(2, "calibrate", TESTS, WILKINS, "--fit", "ceramic.flow_stres_GPa")[0]
    assert cli.fails(2, "calibrate", "missing.csv", WILKINS)[0].startswith("missing.csv: cannot be read")
    read = cli.fails(2, "calibrate", TESTS, WILKINS, "--write", TESTS, "--force")
    assert "must not be the file that is read" in read[0]


def test_an_existing_file_is_replaced_only_by_force(cli, folder: Path):
    (folder / "lib.toml").write_text("mine")
    (folder / "s.toml").write_text("mine")
    words = ("calibrate", TESTS, WILKINS, "--write", "lib.toml", "--write-scenario", "s.toml")
    assert cli.fails(2, *words) == [
        f"{name}: exists already; choose another name, or --force" for name in ("lib.toml", "s.toml")
    ]
    assert (folder / "lib.toml").read_text() == "mine"
    assert cli(*words, "--force").exit_code == 0
    assert "AD85, calibrated" in (folder / "lib.toml").read_text()
    found = cli("uncertainty", "s.toml", "--samples", "128")
    assert found.exit_code == 0, found.output


def test_a_bad_fit_is_a_warning(cli, folder: Path):
    header = "armour.ceramic_thickness_mm,armour.backing_thickness_mm"
    rows = "\n".join(f"{line},5" for line in TESTS.read_text().split()[1:7])
    (folder / "t.csv").write_text(f"{header},ballistic_limit_m_s,ballistic_limit_uncertainty_m_s\n{rows}\n")
    result = cli("calibrate", "t.csv", WILKINS)
    assert result.stderr.startswith("warning: t.csv: the deviations are larger than the uncertainties given explain")
    assert "intervals widened by" in result.stdout


def test_what_is_not_identified_is_not_written(cli, folder: Path):
    (folder / "t.csv").write_text(
        "impact.velocity_m_s,outcome,ballistic_limit_uncertainty_m_s\n700,defeated,9\n710,defeated,9\n"
    )
    result = cli("calibrate", "t.csv", WILKINS, "--write", "lib.toml")
    assert result.exit_code == 1
    assert "not identified" in result.stdout
    assert "nothing to write" in result.stderr
    assert not (folder / "lib.toml").exists()
