import json
from pathlib import Path

from tests.helpers.cases import SCENARIOS

UNCERTAIN = SCENARIOS / "uncertain.toml"


def test_numbers_and_a_plot(cli, folder: Path):
    result = cli("uncertainty", UNCERTAIN, "--samples", "256", "--plot", "u.svg")
    assert result.exit_code == 0
    assert "probability of perforation" in result.stdout
    assert "95 % interval, by sampling" in result.stdout
    assert result.stderr == "wrote u.svg\n"
    assert "probability of perforation" in (folder / "u.svg").read_text()


def test_json(cli):
    data = json.loads(cli("uncertainty", UNCERTAIN, "--samples", "256", "--json").stdout)
    assert data["samples"] == 256
    assert set(data["ballistic_limit_m_s"]) == {"V05", "V50", "V95"}
    assert [index["input"] for index in data["inputs"][:2]] == ["model.limit_error_percent", "ceramic.flow_stress_GPa"]
    assert data["model_error"]["degrees_of_freedom"] == 12.0


def test_wrong_input(cli):
    told = cli.fails(2, "uncertainty", SCENARIOS / "wilkins.toml")
    assert "uncertainty: is missing and must be given: distributions of inputs, such as" in told[0]
    assert "must be a power of 2" in cli.fails(2, "uncertainty", UNCERTAIN, "--samples", "1000")[0]


def test_a_whole_range_without_a_limit_is_no_answer(cli, folder: Path):
    (folder / "u.toml").write_text(UNCERTAIN.read_text() + "\n[ballistic_limit]\nvelocity_max_m_s = 100.0\n")
    assert cli.fails(1, "uncertainty", "u.toml", "--samples", "128")[0].startswith("no ballistic limit of 128 of 128")
