"""Keys that vary from row to row, and whether they count."""

from typing import Any

import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.quantities import DESIGNS
from armour.errors import InputError
from armour.scenario.reach import check_reach, check_read, check_used, read_of
from armour.sweeps.sweep import sweep
from tests.helpers.cases import catalogue, scenario, shipped_scenario

OWN = {
    "ceramic": {
        "mine": {"based_on": "base", "flow_stress_GPa": 5.0},
        "base": {"based_on": "AD85", "density_kg_m3": 1e4},
    },
    "metal": {"6061-T6": {"based_on": "6061-T6", "shear_strength_MPa": 240.0}},
}


def refused(keys: list[str], *sections: str, closed_forms: bool = False, **changes: Any) -> list[str]:
    case = scenario(**{"ceramic": "mine", "library": OWN} | changes)
    try:
        check_reach(case, keys, sections, "f", closed_forms=closed_forms)
    except InputError as error:
        return [problem.key for problem in error.problems]
    return []


def test_a_law_of_the_flow_stress_counts_where_the_entry_has_it():
    law = {"mine": {"based_on": "AD85", "flow_stress_backing_slope": 0.1}, "other": {"based_on": "AD85"}}
    keys = [f"library.ceramic.{name}.flow_stress_backing_slope" for name in law]
    for closed_forms in (False, True):
        assert refused(keys, library={"ceramic": law}, closed_forms=closed_forms) == keys[1:]
    assert refused(["ceramic.flow_stress_backing_slope"], library={"ceramic": law}) == []


@pytest.mark.parametrize(
    ("key", "counts"),
    [
        ("impact.velocity_m_s", False),
        ("impact.projectile", True),
        ("armour.ceramic_thickness_mm", True),
        ("solver.arrest_velocity_m_s", True),
        ("optimise.ceramic_thickness_mm.min", False),
        ("uncertainty.samples", False),
        ("library.ceramic.mine.flow_stress_GPa", True),
        ("library.ceramic.mine.flow_stress_GPa.value", True),
        ("library.ceramic.base.density_kg_m3", True),
        ("library.ceramic.base.flow_stress_GPa", False),
        ("library.ceramic.AD99.5.flow_stress_GPa", False),
        ("library.metal.6061-T6.shear_strength_MPa", True),
        ("library.metal.6061-T6.strain_to_fracture", False),
        ("library.projectile.7.density_kg_m3", False),
        ("ceramic.flow_stress_GPa", True),
    ],
)
def test_a_key_counts_or_is_refused(key: str, counts: bool):
    assert refused([key]) == ([] if counts else [key])


def test_what_the_question_reads():
    assert refused(["optimise.ceramic_thickness_mm.min"], "optimise") == []
    assert refused(["impact.velocity_m_s"], "impact") == []
    strain = "library.metal.6061-T6.strain_to_fracture"
    assert refused([strain], closed_forms=True) == []


def test_a_ceramic_that_is_not_there():
    key = "ceramic.flow_stress_GPa"
    assert refused([key], ceramic_mm=0.0) == [key]
    assert refused([key, "armour.ceramic_thickness_mm"], ceramic_mm=0.0) == []
    assert refused([key], "optimise", ceramic_mm=0.0) == []


def test_an_input_and_the_key_that_sets_it():
    both = ["ceramic.flow_stress_GPa", "library.ceramic.mine.flow_stress_GPa"]
    assert refused(both) == both[1:]
    assert refused(["backing.dynamic_yield_strength_MPa", "backing.flow_stress_GPa"]) == []


def test_entries_that_no_scenario_uses():
    case = catalogue()
    used = {"library.ceramic": {name: {"based_on": name} for name in ("AD85", "AD99.5")}, "impact.velocity_m_s": 3.0}
    check_used(used, case)
    unused = {"library": {"ceramic": {"AD86": {"based_on": "AD85"}}}}
    words = 'command line: --set library.ceramic.AD86: must be an entry .* uses; did you mean "AD85"?'
    with pytest.raises(InputError, match=words):
        check_used(unused, case)
    check_used(unused, scenario(ceramic="AD86", library=unused["library"]))


@pytest.mark.parametrize(
    ("file", "reads", "key", "counts"),
    [
        ("wilkins", ("impact", "armour"), "impact.velocity_m_s", True),
        ("wilkins", ("impact.projectile", "armour"), "impact.velocity_m_s", False),
        ("wilkins", ("armour",), "title", True),
        ("wilkins", ("impact.projectile",), "projectile.density_kg_m3", True),
        ("catalogue", ("threat", "impact"), "projectile.density_kg_m3", False),
        ("catalogue", ("design", "armour.ceramic"), "ceramic.flow_stress_GPa", False),
        ("wilkins", ("armour",), "solver.time_step_us", True),
        ("wilkins", DESIGNS, "uncertainty.samples", False),
        ("wilkins", DESIGNS, "uncertainty.model.included", True),
        ("wilkins", ("threat", "impact", "armour.ceramic"), "armour.ceramic_thickness_mm", False),
        ("catalogue", ("design", "armour.ceramic"), "armour.ceramic", False),
    ],
)
def test_a_change_is_read_or_refused(file: str, reads: tuple[str, ...], key: str, counts: bool):
    found = shipped_scenario(file)
    if counts:
        check_read({key: 1}, read_of(found, reads))
    else:
        with pytest.raises(InputError, match=f"--set {key}: must have an effect: "):
            check_read({key: 1}, read_of(found, reads))


def test_a_static_strength_counts_where_there_is_no_dynamic_one():
    key = "library.metal.{}.static_yield_strength_MPa"
    static = sweep(scenario(backing="AA5083-H116"), {key.format("AA5083-H116"): [240.0, 333.0]})["ballistic_limit_m_s"]
    assert static[1] > static[0] + 10.0
    assert static[0] == ballistic_limit(scenario(backing="AA5083-H116")).ballistic_limit_m_s
    with pytest.raises(InputError, match="must have an effect"):
        sweep(scenario(backing="5083-H3"), {key.format("5083-H3"): [240.0, 333.0]})
