import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from armour.errors import InputError
from armour.scenario.library import (
    IN_COMMON,
    KINDS,
    NOT_MODELLED,
    PAGE,
    TEST_RESULTS,
    VARIED,
    Library,
    named_threats,
    shipped_library,
)
from armour.scenario.scenario import load_scenario, parse_scenario, scenario_schema
from tests.helpers.cases import data


def extended(tables: dict[str, Any]) -> Library:
    return shipped_library().extended(tables, "f.toml")


def messages(tables: dict[str, Any]) -> list[str]:
    with pytest.raises(InputError) as caught:
        extended(tables)
    return [str(problem) for problem in caught.value.problems]


def test_the_papers_table_2_is_there():
    library = shipped_library()
    assert {"7.62 mm AP", "25 mm APDS", "7.62 mm APM2"} <= set(library.names("projectile"))
    assert {"AD85", "AD99.5", "Al-N"} <= set(library.names("ceramic"))
    assert {"6061-T6", "7075-T6", "5083-H3", "AA6082-T651"} <= set(library.names("metal"))
    ceramic = library.entry("ceramic", "AD99.5")
    assert (ceramic["density_kg_m3"], ceramic["youngs_modulus_GPa"], ceramic["flow_stress_GPa"]) == (3840, 350, 6.2)
    metal = library.entry("metal", "7075-T6")
    assert (metal["dynamic_yield_strength_MPa"], metal["flow_stress_GPa"]) == (588, 1.587)
    core = library.entry("projectile", "7.62 mm APM2")
    assert (core["penetrator_mass_g"], core["penetrator_diameter_mm"]) == (5.3, 6.25)


def test_every_shipped_value_says_where_it_comes_from():
    for kind in KINDS:
        for entry in shipped_library().entries[kind].values():
            assert entry.description
            for key, value in entry.values.items():
                assert value.source, (entry.name, key)
                assert value.status in ("nominal", "fitted", "assumed")


def test_a_metal_without_them_has_the_default_strengths():
    tables = {"metal": {"m": {"density_kg_m3": 7850, "dynamic_yield_strength_MPa": 1000}}}
    metal = extended(tables).entry("metal", "m")
    assert metal["flow_stress_GPa"] == pytest.approx(2.7)
    assert metal["shear_strength_MPa"] == pytest.approx(700)
    assert metal.derived == {"flow_stress_GPa", "shear_strength_MPa"}


def test_a_static_yield_strength_is_taken_for_a_dynamic_one_that_is_not_given():
    static = {"density_kg_m3": 7850, "static_yield_strength_MPa": 1000}
    tables = {"m": static, "n": {"based_on": "m", "dynamic_yield_strength_MPa": 1200}}
    known = extended({"metal": tables}).entries["metal"]
    assert [known[name]["dynamic_yield_strength_MPa"] for name in "mn"] == [1000, 1200]
    assert [known[name]["shear_strength_MPa"] for name in "mn"] == pytest.approx([700, 840])
    assert [known[name].is_static for name in "mn"] == [True, False]
    assert known["n"]["static_yield_strength_MPa"] == 1000


def test_derived_strengths_follow_a_yield_strength_that_is_changed():
    tables = {"metal": {"m": {"based_on": "6061-T6", "dynamic_yield_strength_MPa": 500}}}
    metal = extended(tables).entry("metal", "m")
    assert metal["shear_strength_MPa"] == pytest.approx(350)
    assert metal["flow_stress_GPa"] == 1.05


def test_an_entry_takes_what_it_does_not_give_from_its_base():
    tables = {"ceramic": {"b": {"based_on": "a"}, "a": {"based_on": "AD85", "flow_stress_GPa": 3.8}}}
    entry = extended(tables).entry("ceramic", "b")
    assert (entry["flow_stress_GPa"], entry["density_kg_m3"]) == (3.8, 3430)
    assert entry.values["flow_stress_GPa"].source == "f.toml"
    assert entry.values["density_kg_m3"].source == "[Paper], table 2"
    assert entry.description == "alumina, 85 %"


def test_every_mistake_in_the_tables_is_reported():
    found = messages(
        {
            "ceramic": {"X": {"densty_kg_m3": 3, "flow_stress_GPa": "x"}},
            "metal": {
                "Y": {"density_kg_m3": 7.85},
                "Z": {"colour_mm": 3, "flow_stress_GPa": 1},
                "N": {"based_on": "Qq"},
            },
            "metall": {},
        }
    )
    assert found == [
        'f.toml: ceramic.X.flow_stress_GPa: must be a number, found the text "x"',
        'f.toml: ceramic.X.densty_kg_m3: unknown key; did you mean "density_kg_m3"?',
        "f.toml: metal.Y.density_kg_m3: must be at least 100, found 7.85",
        "f.toml: metal.Z.colour_mm: unknown key; choose from description, based_on, aliases, doubtful, evidence, "
        "scatter_percent, scatter_source, density_kg_m3, static_yield_strength_MPa, dynamic_yield_strength_MPa, "
        "flow_stress_GPa, shear_strength_MPa, ultimate_tensile_strength_MPa, strain_to_fracture",
        'f.toml: metall: unknown key; did you mean "metal"?',
        # Not what X and Y lack, which have a wrong value.
        *(
            f"f.toml: metal.Z.{key}: is missing and must be given, or based_on an entry that has it"
            for key in ("density_kg_m3", "dynamic_yield_strength_MPa", "shear_strength_MPa")
        ),
        'f.toml: metal.N.based_on: must name a metal of the library, found "Qq"; armour library lists them',
    ]


def firing(stopped: int, perforated: int, thicknesses: int = 1) -> dict[str, object]:
    """Return own tests of a bare plate: shots, at plates of one or several thicknesses in turn."""
    sides = [1.0] * stopped + [-1.0] * perforated
    columns = {key: [1.0] * len(sides) for key in (*VARIED, *IN_COMMON, *TEST_RESULTS)}
    ratios = [1.0 + place % thicknesses for place in range(len(sides))]
    return {"tests": {**columns, "backing_thickness_ratio": ratios, "side": sides}}


def test_a_small_scatter_needs_an_own_firing():
    def tables(evidence: dict[str, object] | None, percent: float = 1.2) -> dict[str, object]:
        scatter = {"scatter_percent": percent, "scatter_source": "our firing"}
        given = {} if evidence is None else {"evidence": evidence}
        return {"metal": {"m": {"based_on": "6061-T6", **scatter, **given}}}

    words = (
        "f.toml: metal.m.scatter_percent: must be at least 2.5, or be given in an entry of the library with an own "
        "firing of 36 shots or more with both results, found 1.2"
    )
    for allowed in (tables(firing(18, 18)), tables(None, 2.5)):
        assert extended(allowed).entry("metal", "m").scatter_percent in (1.2, 2.5)
    for evidence in (None, firing(36, 0), firing(18, 17), firing(20, 20, 2)):
        assert messages(tables(evidence)) == [words]


def test_an_entry_inherits_a_scatter_with_its_source():
    scatter = {"scatter_percent": 4.0, "scatter_source": "our tails"}
    own = extended({"metal": {"a": {"based_on": "6061-T6", **scatter}, "b": {"based_on": "a"}}}).entry("metal", "b")
    assert (own.scatter_percent, own.scatter_source) == (4.0, "our tails")
    [message] = messages({"metal": {"a": {"based_on": "6061-T6", "scatter_percent": 4.0}}})
    assert message == "f.toml: metal.a: must have scatter_percent and scatter_source, or neither"


def test_what_an_entry_of_a_scenario_lacks_is_reported_beside_unknown_keys():
    with pytest.raises(InputError) as error:
        parse_scenario(data(colour=1, library={"ceramic": {"X": {"density_kg_m3": 3000, "flow_stress_MPa": 4000}}}))
    assert [problem.key for problem in error.value.problems] == [
        "library.ceramic.X.flow_stress_MPa",
        "colour",
        "library.ceramic.X.youngs_modulus_GPa",
        "library.ceramic.X.flow_stress_GPa",
    ]


def test_several_mistakes_within_a_value():
    value = {"value": "a", "status": "good", "colour": "red"}
    with pytest.raises(InputError) as error:
        parse_scenario(data(colour=1, library={"ceramic": {"X": {"density_kg_m3": value}}}))
    density = "library.ceramic.X.density_kg_m3"
    assert {problem.key for problem in error.value.problems} == {
        *(density, f"{density}.status", f"{density}.colour", "colour")
    }


def test_a_law_of_the_flow_stress():
    """Coefficients may be 0, and are inherited; a ceramic need not have them."""
    law = {"flow_stress_backing_exponent": -3, "flow_stress_ceramic_slope": {"value": 0.1, "status": "fitted"}}
    tables = {"a": {"based_on": "AD85", **law}, "b": {"based_on": "a", "flow_stress_backing_exponent": 0}}
    entry = extended({"ceramic": tables}).entry("ceramic", "b")
    assert list(entry.values)[2:] == ["flow_stress_GPa", *law]
    assert (entry["flow_stress_backing_exponent"], entry["flow_stress_ceramic_slope"]) == (0.0, 0.1)


def test_bases_that_lead_back():
    loop = {"a": {"based_on": "b"}, "b": {"based_on": "a"}, "c": {"based_on": "a"}, "free": {"based_on": "6061-T6"}}
    found = messages({"metal": loop})
    assert len(found) == 3
    assert all("must not lead back" in message for message in found)


@pytest.mark.parametrize("name", ["5083", "5083-h32"])
def test_a_name_that_is_not_there_is_an_error_with_all_that_are_alike(name: str):
    """The strongest of them is not suggested alone."""
    with pytest.raises(InputError) as caught:
        shipped_library().entry("metal", name)
    alike = [each for each in shipped_library().names("metal") if "5083" in each]
    assert len(alike) == 4
    assert str(caught.value).endswith(f"; choose from {', '.join(alike)}")


def test_an_alias_names_one_entry_and_what_it_replaces_is_noted():
    mine = {"based_on": "7.62 mm APM2", "aliases": [".30 APM2"]}
    library = extended({"projectile": {"mine": mine}})
    assert library.notes == ("f.toml: projectile.mine: replaces the .30 APM2 of the shipped library",)
    assert library.entry("projectile", ".30 APM2").name == "mine"


LEVEL_3 = "STANAG 4569 level 3, B32"


def impact(**values: Any) -> dict[str, Any]:
    return {**data(), "impact": values}


def test_every_threat_is_of_a_round_of_the_library_and_says_where_it_comes_from():
    for threat in named_threats().values():
        assert threat.projectile in shipped_library().names("projectile")
        assert threat.source
        assert threat.status == "unconfirmed"


def test_a_threat_gives_round_and_velocity():
    found = parse_scenario(impact(threat=LEVEL_3))
    assert (found.impact.projectile, found.impact.velocity_m_s, found.impact.obliquity_deg) == ("7.62 mm B32", 854, 0)
    assert found.notes == ()
    assert found.to_dict()["impact"] == {"threat": LEVEL_3}
    listed = parse_scenario({**data(), "threat": [{"threat": LEVEL_3}, {"threat": LEVEL_3, "obliquity_deg": 30.0}]})
    assert [threat.title for threat in listed.threat] == [LEVEL_3, f"{LEVEL_3}, 30° obliquity"]


def test_a_value_beside_it_takes_precedence():
    assert parse_scenario(impact(threat=LEVEL_3, velocity_m_s=900.0)).impact.velocity_m_s == 900.0


@pytest.mark.parametrize("values", [{"velocity_m_s": 900.0}, {"projectile": "7.62 mm AP"}])
def test_a_threat_with_values_beside_its_name_is_called_changed(values: dict[str, Any]):
    """Or a table would say that an armour passes against a standard."""
    [given] = parse_scenario(impact(threat=LEVEL_3, **values)).threats()
    [listed] = parse_scenario({**data(), "threat": [{"threat": LEVEL_3, **values}]}).threats()
    assert given.title == listed.title == f"{LEVEL_3}, changed"
    [named] = parse_scenario({**data(), "threat": [{"threat": LEVEL_3, "name": "door", **values}]}).threats()
    assert named.title == "door"


def test_a_threat_that_is_set_replaces_the_values_of_the_file():
    found = load_scenario("wilkins", {"impact.threat": LEVEL_3})
    assert (found.impact.projectile, found.impact.velocity_m_s) == ("7.62 mm B32", 854.0)
    nested = load_scenario("wilkins", {"impact": {"threat": LEVEL_3}})
    assert nested.impact == found.impact
    assert load_scenario("wilkins", {"impact.threat": LEVEL_3, "impact.velocity_m_s": 50.0}).impact.velocity_m_s == 50.0


def test_editors_accept_a_threat_in_place_of_round_and_velocity():
    section = scenario_schema()["$defs"]["Impact"]
    assert section["anyOf"] == [{"required": ["threat"]}, {"required": ["projectile", "velocity_m_s"]}]
    assert "required" not in section or not section["required"]


def test_rounds_are_found_under_the_names_of_their_users():
    names = {".30 APM2": "7.62 mm APM2", ".50 APM2": "12.7 mm APM2", ".50 FSP": "12.7 mm FSP"}
    for other, name in names.items():
        assert shipped_library().entry("projectile", other).name == name
        assert parse_scenario(impact(projectile=other, velocity_m_s=800.0)).name_of("projectile") == name


def test_an_angle_is_told_what_it_leaves_out():
    [note] = load_scenario("wilkins", {"impact.obliquity_deg": 30.0}).notes
    assert "ricochet, yaw and bending of the core are not in the model" in note


@pytest.mark.parametrize(("others", "least"), [("C", 1500), ("missing ", 100)])
def test_the_work_grows_with_the_number_of_entries_not_with_its_square(
    others: str, least: int, monkeypatch: pytest.MonkeyPatch
):
    """Each is based on the one before; the work is the number of lines that Python runs."""
    for module in ("errors", "scenario.library"):
        monkeypatch.setattr(f"armour.{module}.MAX_WORDS", 20)
    work = [0, 0]
    for place, count in enumerate((least, 2 * least)):

        def traced(*_: Any, place: int = place) -> Any:
            work[place] += 1
            return traced

        entries = {f"C{i}": {"based_on": f"{others}{i - 1}" if i else "AD85"} for i in range(count)}
        before = sys.gettrace()
        sys.settrace(traced)
        with suppress(InputError):
            extended({"ceramic": entries})
        sys.settrace(before)
    assert work[1] < 2.5 * work[0]


@pytest.mark.parametrize(
    "name", ["aramid", "Kevlar 29", "UHMWPE", "Dyneema HB26", "S2-glass", "Rubber", "polycarbonate"]
)
def test_what_is_neither_metal_nor_ceramic_leads_to_the_page_on_it(name: str):
    with pytest.raises(InputError) as caught:
        shipped_library().entry("metal", name)
    [problem] = caught.value.problems
    assert problem.message.endswith(f"; it is neither metal nor ceramic: {NOT_MODELLED}, see {PAGE}")
    assert (Path(__file__).parents[2] / PAGE).is_file()


@pytest.mark.parametrize("name", ["M993", "7.62 x 51 M993"])
def test_a_round_of_a_template_has_that_template(name: str):
    with pytest.raises(InputError, match="armour init --from templates/m993"):
        shipped_library().entry("projectile", name)


def test_rounds_with_a_part_of_a_wrong_name_are_listed():
    for name, like in (("12.7 mm B32", "12.7 mm APM2, 12.7 mm FSP"), ("B32 7.62", "7.62 mm B32, 14.5 mm B32")):
        with pytest.raises(InputError, match=f"; choose from {like}$"):
            shipped_library().entry("projectile", name)
