"""Every answer: its JSON is what Python gives, its chart and its files are written, and it is short.

What is printed is in golden/.
"""

import json
from pathlib import Path
from typing import Any

import pytest

import armour
from armour import load_scenario
from tests.cli.test_golden import TERMINAL
from tests.helpers.cases import SCENARIOS, TESTS
from tests.helpers.commands import invoke

pytestmark = pytest.mark.slow

WILKINS, CATALOGUE = SCENARIOS / "wilkins.toml", SCENARIOS / "catalogue.toml"
SHOTS = SCENARIOS / "tests" / "shots.csv"


def plain(data: object) -> Any:
    """Data as it is read from JSON."""
    return json.loads(json.dumps(data))


@pytest.mark.parametrize(
    ("name", "scenario"),
    [("ballistic_limit", "wilkins"), ("compare", "wilkins"), ("optimise", "wilkins"), ("sensitivity", "bare_plate")],
)
def test_json_is_the_same_as_from_python(cli, name: str, scenario: str):
    data = json.loads(cli(name.replace("_", "-"), scenario, "--json").stdout)
    made_by = {"version": armour.__version__, "model_version": armour.MODEL_VERSION}
    made_by |= {"command": f"armour {name.replace('_', '-')} {scenario} --json"}
    assert data.pop("made_by") == made_by | {"scenario_sha256": load_scenario(scenario).digest()}
    assert data == plain(getattr(armour, name)(load_scenario(scenario)).to_dict())


def test_the_json_of_an_impact_has_its_confidence(cli):
    data = json.loads(cli("simulate", WILKINS, "--json").stdout)
    del data["made_by"]
    assert data.pop("confidence") == plain(armour.confidence(load_scenario(WILKINS)).to_dict())
    assert data == plain(armour.simulate(load_scenario(WILKINS)).to_dict())


def test_warnings_in_json_are_those_printed(cli):
    """With -v; without, only the first that the answer does not contain."""
    result = cli("simulate", WILKINS, "--set", "armour.ceramic=SiC", "--set", "armour.backing=Ti-6Al-4V", "--json")
    data = json.loads(result.stdout)
    assert result.stderr == ""
    assert len(data["warnings"]) == 1
    whole = cli("simulate", WILKINS, "--set", "armour.ceramic=SiC", "--set", "armour.backing=Ti-6Al-4V", "-v").stderr
    assert whole.splitlines() == [f"warning: {WILKINS}: {warning}" for warning in data["warnings"]]
    caveat = cli("check", WILKINS, "--set", "projectile.penetrator_mass_g=40", "-v")
    assert (caveat.stdout + caveat.stderr).count("a long rod, ") == 1


def test_a_saved_design_is_checked_as_it_was_found(cli, folder: Path):
    """Materials and thicknesses of the design are saved; changes, such as costs, stay."""
    plate = "design.backing=[{ material = '7075-T6', thickness_mm = [8, 9], cost_per_kg = 9 }]"
    threat = "threat=[{ name = 'slow', projectile = '7.62 mm AP', velocity_m_s = 800 }]"
    changes = ["--set", plate, "--set", threat, "--set", "design.minimise=thickness_mm"]
    result = cli("optimise", CATALOGUE, "--probability", 0.8, *changes, "--save", "best.toml", "--json")
    best = json.loads(result.stdout)["best"]
    assert (folder / "best.toml").exists()
    checked = json.loads(cli("check", "best.toml", "--json").stdout)
    assert [each["probability_of_stopping"] for each in checked["threats"]] == [
        pytest.approx(best["check"]["threats"][0]["probability_of_stopping"], abs=1e-6)
    ]
    assert checked["verdict"] == "passes"
    assert checked["cost_per_m2"] == pytest.approx(best["cost_per_m2"])


def test_a_page_tells_of_own_tests_of_the_design(cli, folder: Path):
    cli("calibrate", TESTS, WILKINS, "--write-scenario", "own.toml", "--lot", "7")
    ceramic = 'design.ceramic=[{material="AD85, 7",thickness_mm=[6.35]}]'
    changes = (ceramic, 'design.backing=[{material="6061-T6",thickness_mm=[6.35]}]', "impact.velocity_m_s=600")
    options = [word for change in changes for word in ("--set", change)]
    assert cli("optimise", "own.toml", *options, "--map", "map.html").exit_code == 0
    assert "measured 703 m/s here (1 own test)" in (folder / "map.html").read_text()


def test_a_written_scenario_says_which_material_it_replaces(cli, folder: Path):
    lines = "armour.ceramic,armour.ceramic_thickness_mm,ballistic_limit_m_s", "AD99.5,6.35,790", "AD99.5,8,890"
    (folder / "t.csv").write_text("\n".join(lines))
    found = cli("calibrate", "t.csv", WILKINS, "--write-scenario", "own.toml", "--lot", "A")
    assert "own.toml: armour.ceramic: is AD99.5, A, as tested, in place of AD85" in " ".join(found.stderr.split())
    assert "in place of" not in cli("calibrate", TESTS, WILKINS, "--write-scenario", "b.toml", "--lot", "A").stderr


def test_calibrated_tests_are_shown_and_not_scored(cli, folder: Path):
    """A suite of the tests that an entry was calibrated to, and one that it was not."""
    data = json.loads(cli("calibrate", TESTS, WILKINS, "--write", "lib.toml", "--lot", "7", "--json").stdout)
    assert (len(data["coefficients"]), len(data["residuals"])) == (1, 13)
    assert data["p_value"] is None
    (folder / "case.toml").write_text(
        WILKINS.read_text().replace('"AD85"', '"AD85, 7"') + '\n[library]\nfiles = ["lib.toml"]\n'
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
    assert found[0] == ("not scored", "not scored: flow_stress_GPa of AD85, 7 was calibrated to this test")
    assert [status for status, _ in found[1:]] == ["within", "within"]


# A title that the change makes wrong.
OTHER = "6.35 mm AD85"
SIC = ("--set", "armour.ceramic=SiC", "--set", f"title={OTHER}")
ARMOUR = "6.35 mm SiC on 6.35 mm 6061-T6 against 7.62 mm AP"
GRID = ("--set", "optimise.backing_thickness_mm={min = 5, max = 6, step = 1}")
QUESTIONS = {
    ("simulate", "wilkins", "--velocity", "700"): f"{ARMOUR} at 700 m/s",
    ("ballistic-limit", "wilkins"): ARMOUR,
    ("optimise", "wilkins", *GRID): "Lightest SiC on 6061-T6 against 7.62 mm AP at 800 m/s",
    ("sensitivity", "wilkins"): f"{ARMOUR} at 800 m/s",
    ("uncertainty", "uncertain", "--samples", "128"): f"{ARMOUR} at 700 m/s",
    ("calibrate", "few.csv", "wilkins"): "Tests of SiC on 6061-T6 against 7.62 mm AP",
    ("v50", "tests/shots", "wilkins"): f"V50 of the shots in shots (shipped): {ARMOUR}",
    ("plan", "shots", "wilkins", "--procedure", "up-and-down"): ARMOUR,
}


@pytest.mark.parametrize("question", QUESTIONS, ids=" ".join)
def test_answers_and_charts_name_what_was_computed(cli, folder: Path, question: tuple[str, ...]):
    (folder / "few.csv").write_text("\n".join(TESTS.read_text().splitlines()[:4]))
    done = cli(*question, *SIC, "--plot", "chart.svg")
    assert done.exit_code == 0, done.stderr
    chart = (folder / "chart.svg").read_text()
    assert QUESTIONS[question] in chart
    assert OTHER not in done.stdout + chart


# Questions whose first answer is short.
SHORT = [*(words for words in QUESTIONS if words[0] != "optimise"), ("compare", "wilkins")]
SHORT += [("validate", "paper", "--only", "table 3")]


@pytest.mark.parametrize("question", SHORT, ids=" ".join)
def test_an_answer_has_at_most_ten_lines_and_more_when_asked(folder: Path, question: tuple[str, ...]):
    (folder / "few.csv").write_text("\n".join(TESTS.read_text().splitlines()[:4]))
    shown = []
    for options in ((), ("-v",)):
        done = invoke([*question, *options], env=TERMINAL)
        printed = [*done.stdout.splitlines(), *(line for line in done.stderr.splitlines() if line.startswith("next: "))]
        assert max(map(len, printed)) <= 80
        shown.append([line for line in printed if line.strip("─ ")])
    short, long = shown
    assert len(short) <= 10
    assert len(set(short)) == len(short) < len(long)
    assert "scenario: " not in " ".join(long)


def test_the_chart_of_a_sweep_names_what_was_computed(cli, folder: Path):
    done = cli("sweep", "wilkins", "--over", "armour.ceramic_thickness_mm=6,8", *SIC, "-o", "s.csv", "--plot", "s.svg")
    assert done.exit_code == 0
    chart = (folder / "s.svg").read_text()
    assert "SiC on 6.35 mm 6061-T6 against 7.62 mm AP" in chart
    assert OTHER not in done.stdout + chart


@pytest.mark.parametrize("words", ["calibrate tests/wilkins wilkins", "validate regression", "v50 tests/shots"])
def test_json_names_shipped_files_wherever_they_lie(cli, words: str):
    assert str(SCENARIOS.parent) not in cli(*words.split(), "--json").stdout


def test_threats_that_tests_do_not_use_are_warned_of(cli):
    said = cli("calibrate", "tests/wilkins", "catalogue", "--verbose").stderr
    assert "threat: is not used: the results are against" in said
