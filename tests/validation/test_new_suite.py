"""Suites that watch scenarios: which cases are written for each, and that an update makes them pass."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES
from armour.validation.new_suite import new_suite
from armour.validation.suite import load_suite
from armour.validation.validate import FAILED, updated_file, updates_of, validate
from tests.helpers.cases import catalogue, scenario, shipped_scenario

AP = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0}
FAST = {"name": "fast", **AP, "velocity_m_s": 850.0}
OTHER = {"projectile": "7.62 mm APM2", "velocity_m_s": 830.0, "obliquity_deg": 30.0}


def cases(watched: Scenario) -> list[dict[str, Any]]:
    """The cases of a scenario."""
    text = new_suite({"doors/a.toml": watched})
    assert "expected =" not in text
    return list(tomllib.loads(text)["case"])


def test_the_limit_and_the_probability_of_an_armour():
    limit, probability = cases(scenario())
    assert limit == {
        "name": "doors/a: ballistic limit against 7.62 mm AP",
        "scenario": "doors/a.toml",
        "quantity": "ballistic_limit_m_s",
        "band": 0.5,
    }
    assert probability["name"] == "doors/a: probability of stopping 7.62 mm AP at 800 m/s"
    assert (probability["quantity"], probability["band"]) == ("probability_of_stopping", 0.005)


def test_each_threat_sets_the_impact_and_each_round_has_one_limit():
    found = cases(scenario(threat=[AP, FAST, OTHER]))
    assert [(case["quantity"], case["set"]["impact"]) for case in found] == [
        ("ballistic_limit_m_s", {"projectile": "7.62 mm AP", "obliquity_deg": 0.0}),
        ("ballistic_limit_m_s", {"projectile": "7.62 mm APM2", "obliquity_deg": 30.0}),
        *(
            ("probability_of_stopping", {"obliquity_deg": 0.0, **threat})
            for threat in (AP, {**AP, "velocity_m_s": 850})
        ),
        ("probability_of_stopping", OTHER),
    ]
    assert [case["name"].removeprefix("doors/a: probability of stopping ") for case in found[2:]] == [
        "7.62 mm AP at 800 m/s",
        "fast",
        "7.62 mm APM2 at 830 m/s, 30° obliquity",
    ]


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_best_design_has_least_of_its_objective(objective: str):
    *_, best = cases(catalogue(minimise=objective))
    assert best["quantity"] == f"optimum_{objective}"


def test_what_has_no_answer_is_not_scored_for_the_reason():
    found = cases(shipped_scenario("unknown_ceramic"))
    assert [case.get("not_scored", "").partition(";")[0] for case in found] == [
        "",
        "not known: no test of My alumina on metal is known",
        "no design is known to pass",
    ]
    assert cases(scenario(ballistic_limit={"velocity_max_m_s": 100.0}))[0]["not_scored"].startswith(
        "no ballistic limit"
    )


def test_an_update_fills_in_what_is_computed(folder: Path):
    """Also where a case sets the impact, with named threats, and small probabilities, whose band is wide."""
    suite = folder / "suite.toml"
    named = scenario(threat=[{"threat": "STANAG 4569 level 4, B32"}, AP])
    (folder / "a.toml").write_text(named.to_toml())
    suite.write_text(new_suite({"a.toml": named}))
    first = validate(load_suite(suite))
    assert {check.status for check in first.checks} == {"no expected value"}
    suite.write_bytes(updated_file(suite.read_bytes(), updates_of(first)))
    assert validate(load_suite(suite)).count(*FAILED) == 0
    heavier = named.replaced({"armour.backing_thickness_mm": 6.5})
    (folder / "a.toml").write_text(heavier.to_toml())
    moved = [check.case.full_name for check in validate(load_suite(suite)).checks if check.status == "outside"]
    assert "a: ballistic limit against 7.62 mm AP" in moved
