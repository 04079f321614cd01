import json
import re
from pathlib import Path

from armour import compare, load_scenario
from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"
STEEL = "density_kg_m3 = 7850.0\ndynamic_yield_strength_MPa = 900.0\n"


def test_the_tables(cli):
    result = cli("compare", WILKINS)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    [model] = [line for line in lines if line.startswith("this model")]
    [whole] = [line for line in lines if line.startswith("Florence, whole projectile (8.32 g, 7.62 mm)")]
    assert model.split()[-1] == "723.8"
    assert whole.split()[7] == "436.7"
    assert [line.split()[0] for line in lines if line.startswith(("Lambert", "Recht"))] == [
        "Lambert-Jonas",
        "Recht-Ipson",
    ]


def test_the_rule_of_areal_density_and_the_errors(cli):
    lines = cli("compare", WILKINS).stdout.splitlines()
    found = {words[0]: words[1:] for line in lines if len(words := re.split(r"  +", line)) > 1}
    assert found["areal density rule, p = 1"] == ["690.5", "-4.6"]
    rows = [re.split(r"  +", line)[1:] for line in lines if line.startswith("table 3, Wilkins' measurements  ")]
    assert len(rows) == 7
    assert rows[5] == ["areal density rule, p = 1", "13", "4.2", "4.5", "8.0", "k = 17.60 to these tests"]


def test_other_materials_have_no_rule(cli):
    text = cli("compare", WILKINS, "--set", "armour.backing=7075-T6").stdout
    assert "areal density rule: none, without tests of this round and these materials; there are 13 tests of" in text
    assert "areal density rule, p" not in text


def test_json_is_the_same_as_from_python(cli):
    data = json.loads(cli("compare", WILKINS, "--json").stdout)
    assert data == json.loads(json.dumps(compare(load_scenario(WILKINS)).to_dict()))


def test_a_plot(cli, folder: Path):
    assert cli("compare", WILKINS, "--plot", "c.svg").stderr == "wrote c.svg\n"
    text = (folder / "c.svg").read_text()
    assert "Florence, penetrator: ballistic limit 602.5 m/s" in text
    assert "Recht-Ipson: ratio" in text


def test_a_bare_plate_has_no_florence_limit(cli):
    [line] = cli.fails(2, "compare", SCENARIOS / "bare_plate.toml")
    assert "armour.ceramic_thickness_mm: must be greater than 0 for Florence's limit, found 0" in line


def test_a_metal_without_values_for_florence_has_the_rest(cli, folder: Path):
    text = WILKINS.read_text().replace("6061-T6", "Steel")
    (folder / "steel.toml").write_text(f"{text}[library.metal.Steel]\n{STEEL}")
    result = cli("compare", "steel.toml")
    assert result.exit_code == 0, result.output
    assert "Florence's limit: none, without library.metal.Steel.ultimate_tensile_strength_MPa" in result.stdout
    assert "Recht-Ipson" in result.stdout
    assert json.loads(cli("compare", "steel.toml", "--json").stdout)["florence"] == []
