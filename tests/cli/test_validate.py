import json
from pathlib import Path
from xml.etree import ElementTree

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


def test_a_suite_that_holds(cli, suite: Path):
    result = cli("validate", suite)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "723.772" in result.stdout
    assert result.stdout.endswith("2 of 2 within their bands\n")


def test_a_suite_that_does_not(cli, suite: Path):
    suite.write_text(SUITE.replace("723.77", "800.0"))
    result = cli("validate", suite)
    assert result.exit_code == 3
    assert result.stdout.endswith("limit: the search's bracket\n1 of 2 within their bands, 1 outside\n")


def test_json(cli, suite: Path):
    data = json.loads(cli("validate", suite, "--json").stdout)
    assert data["passed"] is True
    limit, speed = data["cases"]
    assert limit["computed"] == pytest.approx(723.7716, abs=1e-3)
    assert limit["deviation"] == pytest.approx(limit["computed"] - 723.77)
    assert (speed["quantity"], speed["status"], speed["band"]) == ("residual_velocity_m_s", "within", 0.1)


def test_reports(cli, suite: Path, folder: Path):
    suite.write_text(SUITE.replace("723.77", "800.0"))
    result = cli("validate", suite, "--markdown", "out.md", "--junit", "out.xml")
    assert (result.exit_code, result.stderr) == (3, "wrote out.md\nwrote out.xml\n")
    assert (folder / "out.md").read_text().startswith("# My suite\n")
    assert ElementTree.parse(folder / "out.xml").getroot().get("failures") == "1"


def test_only_and_set(cli, suite: Path):
    result = cli("validate", suite, "--only", "SPEED", "--set", "impact.velocity_m_s=900", "--json")
    [case] = json.loads(result.stdout)["cases"]
    assert result.exit_code == 3
    assert case["computed"] > 400.0


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


@pytest.mark.parametrize("assignment", ["model.shear_perimeter", "=1", "a b=1"])
def test_what_is_no_assignment(cli, suite: Path, assignment: str):
    [line] = cli.fails(2, "validate", suite, "--set", assignment)
    assert line.startswith("command line: --set: must be KEY=VALUE")


def test_a_change_that_no_scenario_knows(cli, suite: Path):
    lines = cli.fails(2, "validate", suite, "--set", "armour.colour=1")
    assert "armour.colour: unknown key" in lines[0]


def test_update_shows_and_writes(cli, suite: Path):
    own = SUITE.replace('"My suite"', '"My suite"\nregression = true')
    suite.write_text(own.replace("723.77", "800.0"))
    result = cli("validate", suite, "--update")
    assert result.exit_code == 0
    shown = [line.split() for line in result.stderr.splitlines()]
    assert ["limit", "800", "723.77159"] in shown
    assert result.stdout.startswith("values before the update\n")
    assert ["wrote", str(suite)] in shown
    assert suite.read_text() == own.replace("723.77", "723.77159").replace("277.4", "277.37739")
    again = cli("validate", suite, "--update")
    assert again.stderr == "every regression value is the computed one\n"


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


def test_what_is_published_is_not_updated(cli):
    assert cli.fails(2, "validate", "--update", "--set", "a=1") == [
        "validate: --update: must be given a suite; what is published stays",
        "validate: --update: must not be given with --set: the suite would not hold without",
    ]


def test_outputs_that_cannot_be_written_are_told_before_the_work(cli, suite: Path):
    lines = cli.fails(2, "validate", suite, "--markdown", "no/a.md", "--junit", "no/a.xml")
    assert len(lines) == 2


def test_a_suite_is_not_written_over(cli, suite: Path):
    for option, path in (("--markdown", suite), ("--junit", suite.resolve())):
        lines = cli.fails(2, "validate", suite, option, path, "--force")
        assert lines == [f"{path}: must not be the file that is read; choose another name"]
    assert len(cli.fails(2, "validate", suite, "--markdown", suite, "--junit", suite.resolve(), "--force")) == 1
    assert suite.read_text() == SUITE


def test_every_mistake_of_a_suite(cli, suite: Path):
    suite.write_text(SUITE.replace("band = 0.1", "bend = 0.1").replace("ballistic_limit_m_s", "limit"))
    lines = cli.fails(2, "validate", suite)
    assert [line.split(": ")[1] for line in lines] == ["case[0].quantity", "case[1].bend"]


@pytest.mark.usefixtures("folder")
def test_a_suite_that_is_not_there(cli):
    assert cli.fails(2, "validate", "missing.toml") == [
        "missing.toml: cannot be read: no such file or directory; shipped are paper, plates"
    ]


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


def test_a_group_that_leaves_its_bands_is_named(cli, folder: Path):
    (folder / "t.csv").write_text("armour.backing_thickness_mm,ballistic_limit_m_s\n6.35,800\n")
    table = f'[[table]]\nname = "t"\nscenario = "{SCENARIOS}/wilkins.toml"\nquantity = "ballistic_limit_m_s"\n'
    (folder / "s.toml").write_text(f'{table}file = "t.csv"\nrms_band_percent = 5.0\n')
    result = cli("validate", "s.toml")
    assert result.exit_code == 3
    assert result.stdout.endswith("t: RMS 9.53 %, RMS band 5 %\n0 of 1 within their bands, 1 outside\n")


@pytest.mark.parametrize("change", ["uncertainty.seed=4", "author=me"])
def test_a_change_that_no_case_depends_on_is_refused(cli, change: str):
    [line] = cli.fails(2, "validate", "paper", "--set", change)
    assert line.startswith(f"command line: --set {change.partition('=')[0]}: must have an effect")
