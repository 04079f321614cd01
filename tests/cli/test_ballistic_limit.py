import json
from pathlib import Path

import pytest

from armour import ballistic_limit, load_scenario
from tests.helpers.cases import SCENARIOS
from tests.helpers.exotic import changing_designs

WILKINS = SCENARIOS / "wilkins.toml"


def with_search(folder: Path, search: str) -> Path:
    path = folder / "a.toml"
    path.write_text(WILKINS.read_text() + f"\n[ballistic_limit]\n{search}\n")
    return path


def test_the_table(cli):
    result = cli("ballistic-limit", WILKINS)
    assert result.exit_code == 0
    assert "723.77 m/s" in result.stdout


def test_json_is_the_same_as_from_python(cli):
    data = json.loads(cli("ballistic-limit", WILKINS, "--json").stdout)
    assert data == json.loads(json.dumps(ballistic_limit(load_scenario(WILKINS)).to_dict()))
    assert data["ballistic_limit_m_s"] == pytest.approx(723.77, abs=0.05)
    low, high = data["bracket_m_s"]
    assert 0 < high - low <= 0.01
    assert data["runs"] > 10
    assert data["areal_density_kg_m2"] == pytest.approx(39.243)


@pytest.mark.parametrize("command", ["ballistic-limit", "compare", "v50 shots.csv"])
def test_an_impact_velocity_is_noted_to_have_no_effect(cli, command: str):
    result = cli(*command.split(), WILKINS, "--set", "impact.velocity_m_s=900")
    assert result.stdout == cli(*command.split(), WILKINS).stdout
    note = "note: --set impact.velocity_m_s: has no effect: the ballistic limit does not depend on it"
    assert note in result.stderr.splitlines()
    [line] = cli.fails(2, *command.split(), WILKINS, "--set", "optimise.ceramic_thickness_mm.max=30")
    assert line.endswith("must have an effect: the ballistic limit does not depend on it")


def test_a_plot(cli, folder: Path):
    assert cli("ballistic-limit", WILKINS, "--plot", "limit.png").exit_code == 0
    assert (folder / "limit.png").read_bytes().startswith(b"\x89PNG")


def test_no_limit_in_the_range_is_exit_code_1(cli, folder: Path):
    [line] = cli.fails(1, "ballistic-limit", with_search(folder, "velocity_max_m_s = 500"), "--json")
    assert "none of 33 velocities from 20 to 500 m/s perforates" in line
    [line] = cli.fails(1, "ballistic-limit", with_search(folder, "velocity_min_m_s = 900"))
    assert "all of 33 velocities from 900 to 4000 m/s perforate" in line


def test_all_crossings_are_shown(cli, folder: Path):
    path = folder / "changing.toml"
    path.write_text(changing_designs()["defeated in between"].to_toml())
    result = cli("ballistic-limit", path)
    assert result.exit_code == 0
    assert "not monotonic" in result.stderr
    assert [line.split()[-1] for line in result.stdout.splitlines()[-4:-1]] == ["perforated", "defeated", "perforated"]
    data = json.loads(cli("ballistic-limit", path, "--json").stdout)
    assert not data["monotonic"]
    assert len(data["crossings"]) == 3
    assert (data["scanned_velocities"], data["scanned_range_m_s"]) == (1025, [1.0, 10000.0])


def test_a_limit_outside_the_data_is_warned_of(cli):
    path = SCENARIOS / "bare_plate.toml"
    result = cli("ballistic-limit", path, "--set", "armour.backing_thickness_mm=5")
    assert result.exit_code == 0
    words = "ballistic_limit: the model was compared with results at 340 to 1200 m/s, found 176"
    assert result.stderr.splitlines()[0] == f"warning: {path}: {words}"


def test_the_interval_is_that_of_the_models_error(cli):
    data = json.loads(cli("ballistic-limit", SCENARIOS / "wilkins.toml", "--json").stdout)
    half = 2.1788 * 0.07 * data["ballistic_limit_m_s"]
    assert data["interval_m_s"] == pytest.approx(
        [data["ballistic_limit_m_s"] - half, data["ballistic_limit_m_s"] + half], abs=0.1
    )
    assert data["model_error"]["source"].startswith("13 tests of AD85")
    text = cli("ballistic-limit", SCENARIOS / "wilkins.toml").stdout
    assert "95 % interval, with the error of the model  613 to 834 m/s" in text
    unknown = cli("ballistic-limit", SCENARIOS / "wilkins.toml", "--set", "armour.ceramic=SiC")
    assert "interval" not in unknown.stdout
    assert "armour.ceramic: the model was compared with results of AD85, AD99.5, Al-N only" in unknown.stderr
