from typing import Any

from armour.scenario.library import shipped_library
from armour.scenario.scenario import load_scenario, parse_scenario, scenario_schema
from armour.scenario.threats import named_threats
from tests.helpers.cases import data

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


def test_a_value_beside_it_takes_precedence_and_is_named():
    found = parse_scenario(impact(threat=LEVEL_3, velocity_m_s=900.0))
    assert found.impact.velocity_m_s == 900.0
    assert found.notes == (f"scenario: impact.velocity_m_s: 900.0 takes precedence over 854.0 of {LEVEL_3}",)


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
        assert shipped_library().find(other)[0].name == name
        assert parse_scenario(impact(projectile=other, velocity_m_s=800.0)).name_of("projectile") == name


def test_an_angle_is_told_what_it_leaves_out():
    [note] = load_scenario("wilkins", {"impact.obliquity_deg": 30.0}).notes
    assert "ricochet, yaw and bending of the core are not in the model" in note
