"""Names: of one Unicode form, and of different looks."""

import unicodedata
from pathlib import Path
from typing import Any

import pytest

from armour import load_scenario, parse_scenario, sweep
from armour.errors import InputError, suggestion
from armour.scenario.library import shipped_library
from armour.scenario.scenario import Scenario
from tests.helpers.cases import data

COMPOSED, DECOMPOSED = (unicodedata.normalize(form, "Céramique") for form in ("NFC", "NFD"))


def with_ceramic(entry: str, named: str, changes: dict[str, object] | None = None) -> Scenario:
    """The Wilkins case with a ceramic of its own library, and what names it."""
    content = data() | {"library": {"ceramic": {entry: {"based_on": "AD85"}}}}
    content["armour"] = content["armour"] | {"ceramic": named}
    return parse_scenario(content).replaced(changes or {})


def messages(tables: dict[str, Any]) -> list[str]:
    with pytest.raises(InputError) as caught:
        shipped_library().extended(tables, "f.toml")
    return [str(problem) for problem in caught.value.problems]


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
    with pytest.raises(InputError, match=r'ceramic\."Céramique": must be given once, found it in two Unicode forms'):
        load_scenario(tmp_path / "a.toml")


@pytest.mark.parametrize("other", ["AD85 ", "\N{NO-BREAK SPACE}AD85", "AD8\N{FULLWIDTH DIGIT FIVE}", "7.62  mm AP"])
def test_names_of_a_kind_do_not_look_alike(other: str):
    kind, name = ("projectile", "7.62 mm AP") if "7.62" in other else ("ceramic", "AD85")
    message = f'must not look like another name, found "{other}" and "{name}"'
    assert messages({kind: {other: {"based_on": name}}}) == [f'f.toml: {kind}."{other}": {message}']
    aliased = {kind: {"Mine": {"based_on": name, "aliases": [other]}}}
    assert messages(aliased) == [f"f.toml: {kind}.Mine.aliases: {message}"]
    both = {"Mine": {"based_on": name}, "Mine ": {"based_on": name}}
    found = 'found "Mine " and "Mine"'
    assert messages({kind: both}) == [f'f.toml: {kind}."Mine ": must not look like another name, {found}']


@pytest.mark.parametrize("name", ["", " ", "\N{NO-BREAK SPACE}"])
def test_a_name_is_not_blank(name: str):
    assert messages({"ceramic": {name: {"based_on": "AD85"}}}) == [f'f.toml: ceramic."{name}": must not be blank']
    aliased = {"ceramic": {"Mine": {"based_on": "AD85", "aliases": [name]}}}
    assert messages(aliased) == ["f.toml: ceramic.Mine.aliases: must not be blank"]


def test_names_of_threats_do_not_look_alike():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0}
    with pytest.raises(InputError, match=r"threat\[1\].name: must be different for each threat"):
        parse_scenario(data() | {"threat": [threat | {"name": "A"}, threat | {"name": "A "}]})


@pytest.mark.parametrize(
    ("word", "name", "difference"),
    [
        ("AD85", "AD85", ""),
        ("AD\N{FULLWIDTH DIGIT EIGHT}5", "AD85", ", without U+FF18"),
        ("Mine\N{NO-BREAK SPACE}", "Mine", ", without U+00A0"),
        ("Min\N{CYRILLIC SMALL LETTER IE}", "Mine", ", without U+0435"),
        ("Mine", "Min\N{CYRILLIC SMALL LETTER IE}", ", with U+0435"),
    ],
)
def test_the_difference_of_names_that_look_alike_is_told(word: str, name: str, difference: str):
    assert suggestion(word, [name]) == f'; did you mean "{name}"{difference}?'


@pytest.mark.parametrize("key", ["library.ceramic.AD85.flow_stress_GPa", "library.ceramic.AD85.flow_stress_GPa.value"])
def test_a_value_is_not_given_twice_by_role_and_by_name(key: str):
    scenario = parse_scenario(data())
    changes = {"ceramic.flow_stress_GPa": 7.0, key: 4.0}
    for ordered in (changes, dict(reversed(changes.items()))):
        with pytest.raises(InputError) as caught:
            scenario.replaced(ordered)
        message = "must not be given with library.ceramic.AD85.flow_stress_GPa, which sets the same input, to 4.0"
        assert str(caught.value) == f"replaced: ceramic.flow_stress_GPa: {message}"
    same = scenario.replaced({"ceramic.flow_stress_GPa": 4.0, key: 4.0})
    assert same.inputs()["ceramic.flow_stress_GPa"] == 4.0
