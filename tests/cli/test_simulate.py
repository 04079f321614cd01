import csv
import json
from pathlib import Path

import pytest

from armour import confidence, load_scenario, simulate
from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"
THREAT = "[[threat]]\nprojectile = '7.62 mm AP'\nvelocity_m_s = 700.0\n"


def test_the_table(cli):
    result = cli("simulate", WILKINS)
    assert result.exit_code == 0
    [residual] = [line for line in result.stdout.splitlines() if line.startswith("residual velocity")]
    assert residual.split()[2:] == ["277.38", "m/s"]
    assert [line.split()[0] for line in result.stdout.splitlines()[-8:-4]] == ["i", "ii.1", "iii.3", "iii.4"]
    assert result.stdout.splitlines()[-2] == "probability of defeating the threat  8 %"
    assert result.stdout.splitlines()[-1].startswith("error of the model: ± 7.0 %, from 13 tests of AD85 on 6061-T6")
    assert result.stderr == ""


def test_json_is_one_object_and_the_same_as_from_python(cli):
    result = cli("simulate", WILKINS, "--json")
    data = json.loads(result.stdout)
    assert data.pop("confidence") == json.loads(json.dumps(confidence(load_scenario(WILKINS)).to_dict()))
    assert data == json.loads(json.dumps(simulate(load_scenario(WILKINS)).to_dict()))
    keys = {
        "outcome",
        "residual_velocity_m_s",
        "residual_mass_g",
        "residual_length_mm",
        "penetration_depth_mm",
        "bulge_height_mm",
        "plug_velocity_m_s",
        "duration_us",
        "areal_density_kg_m2",
        "stages",
    }
    assert keys <= set(data)
    assert {"stage", "start_us", "end_us"} <= set(data["stages"][0])


def test_another_velocity(cli):
    data = json.loads(cli("simulate", WILKINS, "--velocity", 600, "--json").stdout)
    assert (data["outcome"], data["residual_velocity_m_s"]) == ("defeated", 0.0)


def test_a_velocity_stands_in_for_one_that_is_missing(cli, folder: Path):
    path = folder / "a.toml"
    path.write_text(WILKINS.read_text().replace("velocity_m_s = 800.0", ""))
    assert cli.fails(2, "simulate", path) == [f"{path}: impact.velocity_m_s: is missing and must be given (line 5)"]
    assert cli("simulate", path, "--velocity", 800).exit_code == 0


def test_history_and_plot(cli, folder: Path):
    result = cli("simulate", WILKINS, "--history", "h.csv", "--plot", "p.svg", "--json")
    json.loads(result.stdout)
    assert result.stderr.splitlines() == ["wrote h.csv", "wrote p.svg"]
    with open("h.csv") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["depth_mm"]) == pytest.approx(12.7)
    assert "time since impact" in (folder / "p.svg").read_text()


@pytest.mark.parametrize("velocity", ["nan", "inf", "-5", "0", "1e9"])
def test_velocities_that_are_none(cli, velocity: str):
    [line] = cli.fails(2, "simulate", WILKINS, "--velocity", velocity)
    assert line.startswith("command line: --velocity: must be")


def test_outputs_that_cannot_be_written_are_told_before_the_work(cli, folder: Path):
    lines = cli.fails(2, "simulate", WILKINS, "--history", "no/h.csv", "--plot", "p.gif")
    assert lines == [
        "p.gif: must end in .png, .svg or .pdf, found .gif",
        "no/h.csv: cannot be written: there is no folder no",
    ]
    assert cli.fails(2, "simulate", WILKINS, "--history", folder) == [f"{folder}: cannot be written: is a folder"]
    assert list(folder.iterdir()) == []


def test_a_scenario_is_not_written_over(cli, folder: Path):
    path = folder / "a.csv"
    path.write_text(WILKINS.read_text())
    [line] = cli.fails(2, "simulate", path, "--history", "a.csv", "--force")
    assert line == "a.csv: must not be the file that is read; choose another name"


def test_a_bare_plate(cli):
    path = SCENARIOS / "bare_plate.toml"
    result = cli("simulate", path, "--json")
    data = json.loads(result.stdout)
    assert data["stages"][0]["stage"].startswith("iii.")
    assert (data["warnings"], result.stderr) == ([], "")
    assert data["confidence"]["model_error"]["source"].startswith("528 tests of armour-piercing cores")


def test_what_is_unlike_the_tests_is_warned_of(cli):
    result = cli("simulate", WILKINS, "--set", "armour.ceramic=SiC", "--set", "armour.backing=Ti-6Al-4V", "--json")
    data = json.loads(result.stdout)
    assert result.stderr.splitlines() == [f"warning: {WILKINS}: {warning}" for warning in data["warnings"]]
    assert len(data["warnings"]) == 4
    assert data["confidence"]["probability_of_defeat"] is None
    assert "no test of such an armour" in data["confidence"]["reason"]


def test_threats_that_are_not_used_are_told(cli, folder: Path):
    (folder / "own.toml").write_text(WILKINS.read_text() + THREAT)
    for command in ("simulate", "ballistic-limit"):
        assert cli(command, "own.toml").stderr.count("threat: is not used") == 1


def test_an_entry_that_replaces_a_shipped_one_is_told(cli, folder: Path):
    entry = "[library.metal.6061-T6]\ndensity_kg_m3 = 2750.0\ndynamic_yield_strength_MPa = 372.0\n"
    (folder / "own.toml").write_text(WILKINS.read_text() + entry)
    note = "note: own.toml: library.metal.6061-T6: replaces the 6061-T6 of the shipped library"
    assert note in cli("simulate", "own.toml").stderr.splitlines()
    assert "replaces" not in cli("simulate", WILKINS, "--set", "backing.density_kg_m3=2740").stderr


def test_an_entry_that_a_library_file_replaces_is_told(cli, folder: Path):
    (folder / "lib.toml").write_text("[ceramic.AD85]\nbased_on = 'AD99.5'\n[ceramic.X]\nbased_on = 'AD85'\n")
    own = "[library]\nfiles = ['lib.toml']\n"
    (folder / "own.toml").write_text(WILKINS.read_text() + own)
    told = cli("simulate", "own.toml").stderr.splitlines()
    assert "note: lib.toml: ceramic.AD85: replaces the AD85 of the shipped library" in told
    (folder / "own.toml").write_text(WILKINS.read_text() + own + "[library.ceramic.X]\nbased_on = 'AD85'\n")
    told = cli("simulate", "own.toml").stderr.splitlines()
    assert "note: own.toml: library.ceramic.X: replaces the X of lib.toml" in told


@pytest.mark.parametrize(("name", "kind"), [("paper", "suite"), ("shots.csv", "table of tests")])
@pytest.mark.usefixtures("folder")
def test_the_name_of_a_suite_or_of_a_table_is_told(cli, name: str, kind: str):
    [line] = cli.fails(2, "simulate", name)
    assert line.startswith(f"{name}: must be a scenario, is the name of a shipped {kind}; ")


def test_what_no_velocity_perforates_is_defeated(cli):
    lines = cli("simulate", WILKINS, "--set", "armour.ceramic_thickness_mm=500").stdout.splitlines()
    assert "probability of defeating the threat  above 99.5 %" in lines


def test_the_probability_of_distributions_is_reconciled_with_an_unknown_one(cli):
    lines = cli("simulate", SCENARIOS / "uncertain.toml", "--set", "armour.ceramic=SiC").stdout.splitlines()
    assert lines[-1] == "a probability from the given distributions alone takes the model as exact: armour uncertainty"


def test_a_limit_outside_the_data_is_warned_of_too(cli):
    changes = ["--set", "armour.ceramic=SiC", "--set", "armour.ceramic_thickness_mm=12"]
    shown = cli("simulate", WILKINS, *changes).stderr
    limit = [line for line in shown.splitlines() if "ballistic_limit: " in line]
    assert len(limit) == 1
    assert limit[0].split("ballistic_limit: ")[1] in cli("ballistic-limit", WILKINS, *changes).stderr
