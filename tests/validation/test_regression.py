"""The computed numbers have not moved, and a change of any physical constant moves them."""

from functools import cache
from pathlib import Path

import pytest

from armour.files import read_toml, shipped
from armour.scenario.inputs import Kind
from armour.scenario.library import KINDS, UNUSED, shipped_library
from armour.validation.suite import Case, load_suite
from armour.validation.validate import validate
from tests.helpers.cases import perforates

SUITE = Path(__file__).parent / "regression.toml"
# Entries whose numbers test_plates.py compares with the data that they are taken from.
TESTED = read_toml(shipped("configs") / "tested_plates.toml")
VALUES = [
    (kind, name, key)
    for kind in KINDS
    for name in shipped_library().names(kind)
    if name not in TESTED.get(kind, {})
    for key in shipped_library().entries[kind][name].values
    if key not in UNUSED
]


@cache
def cases() -> tuple[Case, ...]:
    """Cases of the suite."""
    return load_suite(SUITE).cases


def uses(case: Case, kind: Kind, name: str) -> bool:
    scenario = case.scenario
    named = {
        "projectile": scenario.impact.projectile,
        "ceramic": scenario.armour.ceramic,
        "metal": scenario.armour.backing,
    }
    return named[kind] == name


def test_nothing_has_moved():
    result = validate(load_suite(SUITE))
    assert [item.case.full_name for item in result.checks if item.status != "within"] == []


@pytest.mark.parametrize(("kind", "name", "key"), VALUES)
@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_two_per_cent_of_any_constant_is_noticed(kind: Kind, name: str, key: str, factor: float):
    value = shipped_library().entries[kind][name][key]
    change = {"library": {kind: {name: {"based_on": name, key: factor * value}}}}
    concerned = [case for case in cases() if uses(case, kind, name) and case.quantity == "ballistic_limit_m_s"]
    assert concerned, f"no case of the suite uses {name}"
    case = concerned[0]
    changed = case.scenario.replaced(change)
    lowest, highest = (float(case.expected or 0.0) + sign * float(case.band or 0.0) for sign in (-1, 1))
    # Within the band the limit would be above the lowest and below the highest.
    outcomes = [perforates(changed, velocity) for velocity in (lowest, highest)]
    assert outcomes != [False, True]
