import json
from pathlib import Path

from armour import compare, load_scenario
from tests.helpers.cases import SCENARIOS

WILKINS = SCENARIOS / "wilkins.toml"


def test_the_tables(cli):
    result = cli("compare", WILKINS)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    [model] = [line for line in lines if line.startswith("this model")]
    [whole] = [line for line in lines if line.startswith("Florence, whole projectile (8.32 g, 7.62 mm)")]
    assert model.split()[-1] == "723.77"
    assert whole.split()[7] == "436.72"
    assert [line.split()[0] for line in lines if line.startswith(("Lambert", "Recht"))] == [
        "Lambert-Jonas",
        "Recht-Ipson",
    ]


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
