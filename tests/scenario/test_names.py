"""Names that look the same are one name."""

import unicodedata
from pathlib import Path

import pytest

from armour import load_scenario, parse_scenario, sweep
from armour.errors import InputError
from armour.scenario.inputs import Kind
from armour.scenario.library import shipped_library
from armour.scenario.scenario import Scenario
from tests.helpers.cases import data

COMPOSED, DECOMPOSED = (unicodedata.normalize(form, "Céramique") for form in ("NFC", "NFD"))


def with_ceramic(entry: str, named: str, changes: dict[str, object] | None = None) -> Scenario:
    """The Wilkins case with a ceramic of its own library, and what names it."""
    content = data() | {"library": {"ceramic": {entry: {"based_on": "AD85"}}}}
    content["armour"] = content["armour"] | {"ceramic": named}
    return parse_scenario(content).replaced(changes or {})


@pytest.mark.parametrize("named", [COMPOSED, DECOMPOSED])
@pytest.mark.parametrize("entry", [COMPOSED, DECOMPOSED])
def test_a_name_is_the_same_in_every_unicode_form(entry: str, named: str):
    scenario = with_ceramic(entry, named)
    assert scenario == with_ceramic(COMPOSED, COMPOSED)
    assert scenario.entry("ceramic", named).name == COMPOSED
    for key in (f'library.ceramic."{named}".flow_stress_GPa', f'library.ceramic."{entry}".flow_stress_GPa.value'):
        assert scenario.replaced({key: 4.0}).inputs()["ceramic.flow_stress_GPa"] == 4.0
    table = {"library": {"ceramic": {named: {"flow_stress_GPa": 4.0}}}}
    assert scenario.replaced(table).inputs()["ceramic.flow_stress_GPa"] == 4.0
    swept = sweep(scenario, {"armour.ceramic": [named], "armour.ceramic_thickness_mm": [6.35]}, "areal_density_kg_m2")
    assert swept["areal_density_kg_m2"].tolist() == [scenario.areal_density_kg_m2()]
    aliases = [unicodedata.normalize("NFD", "à la carte")]
    added = {"Mine": {"based_on": named, "aliases": aliases}, entry: {"based_on": "AD85"}}
    found = shipped_library().extended({"ceramic": added}, "f.toml").entry("ceramic", "à la carte")
    assert (found.name, found.origin) == ("Mine", "AD85")


def test_the_name_of_a_library_file_stays_as_it_is(tmp_path: Path):
    (tmp_path / f"{DECOMPOSED}.toml").write_text('[ceramic.Mine]\nbased_on = "AD85"\n', encoding="utf-8")
    content = data() | {"library": {"files": [f"{DECOMPOSED}.toml"]}}
    assert "Mine" in parse_scenario(content, folder=tmp_path).entries.names("ceramic")


def test_an_entry_is_given_once(tmp_path: Path):
    entries = "".join(f'[library.ceramic."{name}"]\nbased_on = "AD85"\n' for name in (COMPOSED, DECOMPOSED))
    (tmp_path / "a.toml").write_text(entries, encoding="utf-8")
    with pytest.raises(
        InputError, match=r'ceramic\."Céramique": must be given once, found it in two forms that look alike'
    ):
        load_scenario(tmp_path / "a.toml")


@pytest.mark.parametrize("other", ["AD85 ", "\N{NO-BREAK SPACE}AD85", "AD8\N{FULLWIDTH DIGIT FIVE}", "7.62  mm AP"])
def test_a_name_is_the_same_whatever_its_spaces_and_forms(other: str):
    kind: Kind = "projectile" if "7.62" in other else "ceramic"
    name = "7.62 mm AP" if kind == "projectile" else "AD85"
    assert shipped_library().entry(kind, other).name == name
    own = shipped_library().extended({kind: {other: {"based_on": other}, "Mine": {"based_on": name}}}, "f.toml")
    assert own.entry(kind, name).file == own.entry(kind, "Mine ").file == "f.toml"
    assert own.names(kind).count(name) == 1


def test_names_of_threats_do_not_look_alike():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0}
    with pytest.raises(InputError, match=r"threat\[1\].name: must be different for each threat"):
        parse_scenario(data() | {"threat": [threat | {"name": "A"}, threat | {"name": "A "}]})
