"""What moved since an earlier check, and what of it is weaker."""

from collections.abc import Callable
from typing import Any

import pytest

from armour import InputError, Scenario, check
from armour.design.against import moved
from tests.helpers.cases import CERAMICS, METALS, scenario

OWN = {"based_on": "AD85", "flow_stress_GPa": {"value": 5.2, "source": "a report"}}
THREATS = [
    {"projectile": "7.62 mm AP", "velocity_m_s": 500.0, "margin_m_s": 10.0},
    {"projectile": "7.62 mm AP", "velocity_m_s": 550.0},
    {"projectile": "7.62 mm APM2", "velocity_m_s": 500.0, "name": "M2", "obliquity_deg": 10.0},
]
BASE = scenario(
    ceramic="own",
    threat=THREATS,
    library={"ceramic": {"own": OWN}},
    design={"probability_of_stopping": 0.9, "areal_density_max_kg_m2": 50.0, "ceramic": CERAMICS, "backing": METALS},
)
UNPRICED = {"material": "SiC", "thickness_mm": 6.0}
LAYER = {"name": "glue", "place": "front", "thickness_mm": 1.0, "areal_density_kg_m2": 1.0}
NOT_KNOWN = ("7.62 mm AP", "probability_of_stopping")


def data(of: Scenario, file: str = "a.toml") -> dict[str, Any]:
    return {"scenario": file, **check(of).to_dict()}


def threats(*changes: dict[str, Any]) -> dict[str, Any]:
    return {"threat": [{**threat, **change} for threat, change in zip(THREATS, changes, strict=False)]}


@pytest.fixture(scope="module")
def base() -> dict[str, Any]:
    return data(BASE)


@pytest.mark.parametrize(
    ("changes", "weaker"),
    [
        (
            {"design.probability_of_stopping": 0.8},
            {("7.62 mm AP", "required_probability"), ("M2", "required_probability")},
        ),
        ({"design.areal_density_max_kg_m2": 51.0}, {("", "limit of areal_density_kg_m2")}),
        ({"design.areal_density_max_kg_m2": None}, {("", "limit of areal_density_kg_m2")}),
        (threats({"velocity_m_s": 499.0}, {}, {}), {("7.62 mm AP", "velocity_m_s")}),
        (threats({"margin_m_s": 9.0}, {}, {}), {("7.62 mm AP", "required_margin_m_s")}),
        (threats({}, {}, {"obliquity_deg": 11.0}), {("M2", "obliquity_deg")}),
        (threats({}, {}, {"projectile": "7.62 mm AP"}), {("M2", "projectile")}),
        (threats({}, {"probability_of_perforation": 0.2}, {}), {("7.62 mm AP", "required_probability")}),
        (threats({}, {}), {("M2", "threat")}),
        ({"threat": THREATS[1:]}, {("7.62 mm AP", "threat")}),
        ({"uncertainty.samples": 1024}, {("", "uncertainty")}),
        ({"library.ceramic.own.flow_stress_GPa.value": 5.3}, {("", "library.ceramic.own")}),
        ({"armour.ceramic": "AD85"}, {("", "library.ceramic.own")}),
        ({"design.angles_as_at_normal_incidence": True}, {("", "design.angles_as_at_normal_incidence")}),
        ({"model.shear_perimeter": "projectile"}, {("", "model"), NOT_KNOWN}),
        ({"solver.time_step_us": 0.2}, {("", "solver"), NOT_KNOWN}),
        ({"ballistic_limit.tolerance_m_s": 0.02}, {("", "ballistic_limit")}),
        ({"armour.ceramic_thickness_mm": 60.0}, {NOT_KNOWN}),
        ({"armour.layer": [LAYER]}, {("", "armour.layer")}),
        ({"design.existing": "backing"}, {("", "design.existing")}),
        ({"design.ceramic": [{**CERAMICS[0], "cost_per_kg": 11.0}, CERAMICS[1]]}, {("", "design.ceramic")}),
        ({"design.backing": [METALS[0]]}, {("", "design.backing")}),
        # What is not weaker.
        ({"design.probability_of_stopping": 0.95}, set()),
        ({"design.areal_density_max_kg_m2": 49.0}, set()),
        (threats({"velocity_m_s": 501.0}, {"margin_m_s": 5.0}, {"obliquity_deg": 0.0}), set()),
        ({"threat": [{"projectile": "7.62 mm AP", "velocity_m_s": 400.0}, *THREATS]}, set()),
        ({"armour.ceramic_thickness_mm": 6.0, "design.ceramic": [*CERAMICS, UNPRICED]}, set()),
    ],
)
def test_what_is_weaker(base: dict[str, Any], changes: dict[str, Any], weaker: set[tuple[str, str]]):
    moves = [*moved(base, [data(BASE.replaced(changes))], "base.json")]
    assert moves
    assert {(move.threat, move.quantity) for move in moves if move.weaker} == weaker
    assert [*moved([base], [data(BASE)], "base.json")] == []


def test_what_moved_has_both_values(base: dict[str, Any]):
    [velocity] = [
        move
        for move in moved(base, [data(BASE.replaced(threats({"velocity_m_s": 499.0}, {}, {})))], "base.json")
        if move.quantity == "velocity_m_s"
    ]
    assert (velocity.scenario, velocity.before, velocity.now) == ("a.toml", 500.0, 499.0)


def test_a_missing_scenario_is_weaker_and_a_new_one_where_it_rests_on_what_is_its_own(base: dict[str, Any]):
    other = {**base, "scenario": "b.toml"}
    own = [("design.backing", True), ("design.ceramic", True), ("library.ceramic.own", True)]
    for before, now, weaker, more in (([base, other], [base], True, []), ([base], [base, other], False, own)):
        found = [(move.quantity, move.weaker) for move in moved(before, now, "base.json") if move.scenario == "b.toml"]
        assert found == [("scenario", weaker), *more]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda _: {},
        lambda base: [[base]],
        lambda base: {**base, "scenario": 5},
        lambda base: {key: value for key, value in base.items() if key != "basis"},
        lambda base: {**base, "threats": [{**base["threats"][0], "velocity_m_s": float("nan")}]},
        lambda _: 5,
    ],
)
def test_a_file_that_is_no_check(base: dict[str, Any], spoil: Callable[[dict[str, Any]], Any]):
    with pytest.raises(InputError, match=r"b\.json: must be the output of armour check --json;"):
        [*moved(spoil(base), [base], "b.json")]
