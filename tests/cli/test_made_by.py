"""What made an answer: the same object in JSON, JUnit XML, pictures and Parquet."""

import json
from xml.etree import ElementTree

import pytest
from PIL import Image
from pyarrow import parquet

from armour.scenario.scenario import load_scenario
from tests.helpers.cases import SCENARIOS, scenario
from tests.helpers.commands import invoke

pytestmark = pytest.mark.slow

SWEEP = ["sweep", "wilkins", "--over", "impact.velocity_m_s=700,800", "--quantities", "outcome", "-o", "a.parquet"]


@pytest.mark.usefixtures("folder", "drawn")
def test_every_kind_of_output_says_what_made_it():
    checked = invoke(["check", "wilkins", "--json", "--junit", "a.xml", "--plot", "a.png"])
    expected = json.loads(checked.stdout)["made_by"]
    assert expected["command"] == "armour check wilkins --json --junit a.xml --plot a.png"
    assert expected["scenario_sha256"] == load_scenario("wilkins").digest()
    properties = ElementTree.parse("a.xml").iter("property")
    assert {each.attrib["name"]: each.attrib["value"] for each in properties} == expected
    with Image.open("a.png") as picture:
        assert json.loads(picture.info["Description"]) == expected
    assert invoke(SWEEP).exit_code == 0
    table = json.loads(parquet.read_schema("a.parquet").metadata[b"armour"])
    assert table == {**expected, "command": f"armour {' '.join(SWEEP)}"}


def test_no_folder_of_an_absolute_path_is_told():
    made_by = json.loads(invoke(["simulate", str(SCENARIOS / "wilkins.toml"), "--json"]).stdout)["made_by"]
    assert made_by["command"] == "armour simulate wilkins.toml --json"


@pytest.mark.usefixtures("folder")
def test_another_value_of_the_library_is_another_scenario():
    plain, changed = (
        json.loads(invoke(["simulate", "wilkins", "--json", *words]).stdout)["made_by"]["scenario_sha256"]
        for words in ([], ["--set", "ceramic.flow_stress_GPa=4"])
    )
    assert plain != changed


def test_an_entry_that_a_scenario_does_not_use_is_no_part_of_it():
    offered = {"thickness_mm": [6.0]}
    designs = {"ceramic": [{"material": "tile", **offered}], "backing": [{"material": "6061-T6", **offered}]}
    plain = scenario(library={"ceramic": {"tile": {"based_on": "AD99.5"}}})
    stronger = {"library.ceramic.tile.flow_stress_GPa": 6.5}
    assert plain.digest() == scenario().digest() == plain.replaced(stronger).digest()
    assert plain != plain.replaced(stronger)
    for using in (plain.replaced({"armour.ceramic": "tile"}), plain.replaced({"design": designs})):
        assert using.digest() != using.replaced(stronger).digest()
