import json
from pathlib import Path

from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"


def test_numbers_and_a_plot(cli, folder: Path):
    result = cli("sensitivity", WILKINS, "--plot", "s.svg")
    assert result.exit_code == 0
    assert "penetrator diameter, mm" in result.stdout
    assert result.stderr == "wrote s.svg\n"
    assert "change per % of the input, %" in (folder / "s.svg").read_text()


def test_json(cli):
    data = json.loads(cli("sensitivity", WILKINS, "--json").stdout)
    assert set(data["answers"]) == {"ballistic_limit_m_s", "residual_velocity_m_s", "least_areal_density_kg_m2"}
    assert data["inputs"][0]["input"] == "projectile.penetrator_diameter_mm"


def test_wrong_input(cli):
    assert cli.fails(2, "sensitivity", "missing.toml")[0].startswith("missing.toml: cannot be read")


def test_nothing_to_compare(cli):
    case = SCENARIOS / "uncertain.toml"
    told = cli.fails(1, "sensitivity", case, "--set", "ballistic_limit.velocity_max_m_s=500")
    assert told[0].startswith("nothing to compare")
