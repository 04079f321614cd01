"""Keys that are changed or vary from row to row, and whether they have an effect."""

from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.quantities import DESIGNS
from armour.errors import InputError
from armour.scenario.effect import check_columns, check_effect
from armour.scenario.inputs import ROUND_AND_ARMOUR
from armour.scenario.keys import parts_of, values_by_key
from armour.sweeps.sweep import sweep
from tests.helpers.cases import catalogue, scenario, shipped_scenario

LIBRARY = {
    "ceramic": {
        "mine": {"based_on": "base", "flow_stress_GPa": 5.0},
        "base": {"based_on": "AD85", "density_kg_m3": 1e4},
        "law": {"based_on": "AD85", "flow_stress_backing_slope": 0.1},
    },
    "metal": {"6061-T6": {"based_on": "6061-T6", "shear_strength_MPa": 240.0, "strain_to_fracture": 0.2}},
}
STRESS, THICKNESS = "ceramic.flow_stress_GPa", "armour.ceramic_thickness_mm"


def refused(keys: list[str], *sections: str, **changes: Any) -> list[str]:
    case, reads = scenario(**{"ceramic": "mine", "library": LIBRARY} | changes), {*ROUND_AND_ARMOUR, *sections}
    try:
        check_effect(map(parts_of, keys), [(case, reads)], "f")
        check_columns(case, keys, reads, "f", "the answer")
    except InputError as error:
        return [problem.message for problem in error.problems]
    return []


NONE = "must have an effect: the answer does not depend on it"
UNUSED = "must be an entry of the library that the scenario uses; choose from AD85, base, mine"


@pytest.mark.parametrize(
    ("key", "messages"),
    [
        ("impact.velocity_m_s", [NONE]),
        ("impact.projectile", []),
        (THICKNESS, []),
        ("solver.arrest_velocity_m_s", []),
        ("optimise.ceramic_thickness_mm.min", [NONE]),
        ("uncertainty.samples", [NONE]),
        ("library.ceramic.mine.flow_stress_GPa", []),
        ("library.ceramic.mine.flow_stress_GPa.value", []),
        ("library.ceramic.base.density_kg_m3", []),
        ("library.ceramic.base.flow_stress_GPa", [NONE]),
        ("library.ceramic.law.flow_stress_backing_slope", [UNUSED]),
        ("library.metal.6061-T6.shear_strength_MPa", []),
        ("library.metal.6061-T6.strain_to_fracture", [NONE]),
        (STRESS, []),
    ],
)
def test_a_column_that_has_an_effect_or_is_refused(key: str, messages: list[str]):
    assert refused([key]) == messages


def test_what_is_computed_may_read_more():
    assert refused(["optimise.ceramic_thickness_mm.min"], "optimise") == []
    assert refused(["impact.velocity_m_s"], "impact") == []


def test_a_law_of_the_flow_stress_has_an_effect_where_the_entry_has_it():
    for key in ("library.ceramic.law.flow_stress_backing_slope", "ceramic.flow_stress_backing_slope"):
        assert refused([key], ceramic="law") == []


def test_a_scatter_has_an_effect_where_a_probability_is_computed():
    own = {"metal": {"own": {"based_on": "6061-T6", "scatter_percent": 4.0, "scatter_source": "our tails"}}}
    keys = ["library.metal.own.scatter_percent"]
    assert refused(keys, "design.scatter_percent", backing="own", ceramic="AD85", library=own) == []
    assert refused(keys, backing="own", ceramic="AD85", library=own) == [NONE]


def test_a_ceramic_that_is_not_there():
    assert refused([STRESS], ceramic_mm=0.0) == [f"must not be given if {THICKNESS} is 0"]
    assert refused([STRESS, THICKNESS], ceramic_mm=0.0) == []
    assert refused([STRESS], "optimise", ceramic_mm=0.0) == []


def test_an_input_and_the_key_that_sets_it():
    [message] = refused([STRESS, "library.ceramic.mine.flow_stress_GPa"])
    assert message == f"must not be given with {STRESS}, which sets the same input"
    assert refused(["backing.dynamic_yield_strength_MPa", "backing.flow_stress_GPa"]) == []


def test_entries_of_the_library_that_no_scenario_uses():
    used = {"library.ceramic": {name: {"based_on": name} for name in ("AD85", "AD99.5")}}
    unused = {"library": {"ceramic": {"AD85x": {"based_on": "AD85"}}}}
    check_effect(values_by_key(used), [(catalogue(), ())], "f")
    with pytest.raises(InputError, match=r'f: --set library\.ceramic\.AD85x: must be .* uses; did you mean "AD85"'):
        check_effect(values_by_key(unused), [(catalogue(), ())], "f", option="--set ")
    check_effect(values_by_key(unused), [(scenario(ceramic="AD85x", library=unused["library"]), ())], "f")


@pytest.mark.parametrize(
    ("name", "reads", "key", "has_effect"),
    [
        ("wilkins", ("impact", "armour"), "impact.velocity_m_s", True),
        ("wilkins", ("impact.projectile", "armour"), "impact.velocity_m_s", False),
        ("wilkins", ("armour",), "title", True),
        ("wilkins", ("impact.projectile",), "projectile.density_kg_m3", True),
        ("catalogue", ("threat", "impact"), "projectile.density_kg_m3", False),
        ("catalogue", ("design", "armour.ceramic"), STRESS, False),
        ("wilkins", ("armour",), "solver.time_step_us", True),
        ("wilkins", DESIGNS, "uncertainty.samples", False),
        ("wilkins", DESIGNS, "uncertainty.model.included", True),
        ("wilkins", ("threat", "impact", "armour.ceramic"), THICKNESS, False),
        ("catalogue", ("design", "armour.ceramic"), "armour.ceramic", False),
        ("catalogue", ("design.probability_of_stopping",), "design", True),
        ("wilkins", ("threat", "uncertainty"), "uncertainty", True),
    ],
)
def test_a_change_that_has_an_effect_or_is_refused(name: str, reads: tuple[str, ...], key: str, has_effect: bool):
    scenarios = [(shipped_scenario(name), reads)]
    if has_effect:
        check_effect([parts_of(key)], scenarios, "f")
    else:
        with pytest.raises(InputError, match=f"f: {key}: {NONE}"):
            check_effect([parts_of(key)], scenarios, "f")


def test_a_static_strength_has_an_effect_where_there_is_no_dynamic_one():
    key = "library.metal.{}.static_yield_strength_MPa"
    static = sweep(scenario(backing="AA5083-H116"), {key.format("AA5083-H116"): [240.0, 333.0]})["ballistic_limit_m_s"]
    assert static[1] > static[0] + 10.0
    assert static[0] == ballistic_limit(scenario(backing="AA5083-H116")).ballistic_limit_m_s
    with pytest.raises(InputError, match="must have an effect"):
        sweep(scenario(backing="5083-H3"), {key.format("5083-H3"): [240.0, 333.0]})
