import csv
import json
from pathlib import Path

import pytest

from armour.statistics.measured import read_tests
from tests.helpers.cases import SCENARIOS, shipped_scenario

WILKINS = SCENARIOS / "wilkins.toml"
TESTS = SCENARIOS / "tests" / "wilkins.csv"
GRID = ("--candidates", "armour.ceramic_thickness_mm=6:10:2", "--candidates", "armour.backing_thickness_mm=4,8")
PLAN = ("plan", "tests", WILKINS, *GRID, "--number", "2")


def test_a_plan_a_form_and_a_plot(cli, folder: Path):
    result = cli(*PLAN, "--scatter-percent", "3", "--csv", "next.csv", "--plot", "next.svg")
    assert result.exit_code == 0, result.output
    assert "± limit of the design, m/s" in result.stdout
    assert "no tests determine" in result.stderr
    form = (folder / "next.csv").read_text()
    assert form.splitlines()[0].endswith("ballistic_limit_m_s,ballistic_limit_uncertainty_m_s")
    assert "relative gain of one more test" in (folder / "next.svg").read_text()
    (folder / "next.csv").write_text(form.replace(",,", ",760,"))
    assert len(read_tests("next.csv", shipped_scenario("wilkins")).measurements) == 2
    fitted = cli("calibrate", "next.csv", WILKINS)
    assert fitted.exit_code == 0, fitted.output


def test_the_form_has_the_tests_made_before(cli, folder: Path):
    result = cli(*PLAN, "--tests", TESTS, "--csv", "next.csv", "--json")
    data = json.loads(result.stdout)
    assert (data["tests"], data["scatter_known"], len(data["planned"])) == (str(TESTS), False, 3)
    lines = (folder / "next.csv").read_text().splitlines()
    assert (lines[1], len(lines)) == ("line 2,5.8,7.24,735.0", 16)
    assert lines[-1].startswith("planned 2,")


def test_the_form_has_the_given_scatter_of_the_tests_made_before(cli, folder: Path):
    result = cli(*PLAN, "--tests", TESTS, "--csv", "next.csv", "--scatter-percent", "4")
    assert result.exit_code == 0, result.output
    with (folder / "next.csv").open() as file:
        made, *_ = csv.DictReader(file)
    assert float(made["ballistic_limit_uncertainty_m_s"]) == pytest.approx(0.04 * float(made["ballistic_limit_m_s"]))


def test_the_form_reads_names_as_they_were(cli, folder: Path):
    """Each form is the table of the next: a name that a spreadsheet takes for a formula stays what it is."""
    (folder / "t.csv").write_text(
        "test,armour.ceramic_thickness_mm,ballistic_limit_m_s\n=1+1,6,700\n-1,8,760\n@x,9,800\n"
    )
    for source, form in (("t.csv", "first.csv"), ("first.csv", "second.csv")):
        result = cli(*PLAN, "--tests", source, "--csv", form)
        assert result.exit_code == 0, result.output
        lines = (folder / form).read_text().splitlines()
        assert [line.split(",")[0] for line in lines[1:4]] == ["'=1+1", "'-1", "'@x"]
        (folder / form).write_text("\n".join(line for line in lines if "planned" not in line))
        assert read_tests(form, shipped_scenario("wilkins")).names == ("=1+1", "-1", "@x")


def test_candidates_of_a_file_and_designs(cli, folder: Path):
    (folder / "c.csv").write_text("armour.ceramic_thickness_mm,cost\n8,100\n10,120\n")
    optimum = "paper/optimum_7.62mm_AP"
    words = ("plan", "tests", WILKINS, "--candidates", "c.csv", "--design", WILKINS, "--design", optimum)
    result = cli(*words, "--scatter-percent", "3", "--criterion", "I", "--plot", "gain.svg")
    assert result.exit_code == 0, result.output
    assert "± limit of" in result.stdout
    assert "total cost" in result.stdout


def test_outcomes(cli, folder: Path):
    words = ("plan", "tests", WILKINS, "--candidates", "impact.velocity_m_s=600:800:50", "--measure", "outcome")
    result = cli(*words, "--scatter-percent", "3", "--csv", "next.csv")
    assert result.exit_code == 0, result.output
    assert (folder / "next.csv").read_text().startswith("test,impact.velocity_m_s,outcome,ballistic_limit_unc")


@pytest.mark.usefixtures("folder")
def test_wrong_input(cli):
    base = ("plan", "tests", WILKINS, "--scatter-percent", "3")
    assert cli.fails(2, *base) == ["command line: --candidates: is missing and must be given"]
    message = cli.fails(2, *base, "--candidates", "armour.ceramic_thickness_mm=a")[0]
    assert message.startswith("command line: --candidates armour.ceramic_thickness_mm: must be a finite number")
    assert "must be one CSV file" in cli.fails(2, *base, *GRID, "--candidates", "c.csv")[0]
    assert cli.fails(2, *base, "--candidates", "c.csv")[0].startswith("c.csv: cannot be read")
    [message] = cli.fails(2, *base, "--candidates", "armour.ceramic_thickness_mm")
    assert (
        message == 'command line: --candidates: must be KEY=VALUES or a CSV file, found "armour.ceramic_thickness_mm"'
    )
    wrong = cli.fails(2, *base, "--candidates", "armour.ceramic_thickness_mm=400")[0]
    assert "candidates: armour.ceramic_thickness_mm=400: must have a ballistic limit between" in wrong


def test_a_calibration_with_a_prior(cli):
    result = cli("calibrate", "unknown_ceramic.csv", "unknown_ceramic", "--prior", "--json")
    [found] = json.loads(result.stdout)["coefficients"]
    assert 0.0 < found["prior_share"] < 0.1
