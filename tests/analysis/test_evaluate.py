"""Evaluation of many rows at once, against scenarios that are made one by one."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.evaluate import evaluate, groups_of
from armour.errors import InputError
from tests.helpers.cases import scenario

NAMES = ["outcome", "residual_velocity_m_s", "ballistic_limit_m_s"]


def test_rows_of_inputs_are_scenarios_made_one_by_one():
    columns = {
        "armour.ceramic_thickness_mm": np.array([4.0, 8.0, 12.0]),
        "ceramic.flow_stress_GPa": np.array([4.0, 5.0, 6.0]),
        "backing.dynamic_yield_strength_MPa": np.array([300.0, 400.0, 500.0]),
        "projectile.penetrator_mass_g": np.array([5.0, 6.0, 7.0]),
        "impact.velocity_m_s": np.array([700.0, 800.0, 900.0]),
    }
    found = evaluate(scenario(), columns, NAMES)
    for row in range(3):
        made = scenario().with_inputs({name: float(values[row]) for name, values in columns.items()})
        for name in NAMES:
            assert found[name][row] == evaluate(made, {}, [name])[name][0]


def test_other_keys_make_scenarios_and_keep_the_order_of_the_rows():
    columns = {
        "ballistic_limit.velocity_min_m_s": np.array([500.0, 900.0, 500.0, 900.0]),
        "armour.ceramic_thickness_mm": np.array([6.0, 6.0, 8.0, 8.0]),
    }
    assert len(groups_of(scenario(), columns)) == 2
    found = evaluate(scenario(), columns, ["ballistic_limit_m_s", "areal_density_kg_m2"])
    limits = found["ballistic_limit_m_s"]
    assert np.isnan(limits[[1, 3]]).all()
    assert limits[0] < limits[2]
    assert found["areal_density_kg_m2"].tolist() == pytest.approx([38.0425, 38.0425, 44.9025, 44.9025])


C = "armour.ceramic_thickness_mm"
ROD = ("projectile.penetrator_diameter_mm", "projectile.penetrator_mass_g")


def test_rows_are_checked_whole():
    rows = [[6.5, 5.46], [65.0, 5460.0], [0.65, 0.00546]]
    columns = dict(zip(ROD, np.array(rows).T, strict=True))
    assert np.isfinite(evaluate(scenario(), columns, ["ballistic_limit_m_s"])["ballistic_limit_m_s"][0])
    columns[ROD[1]] = np.array([5.46, 5460.0, 5.46])
    with pytest.raises(InputError, match=r"row 3: projectile.*must make a rod .* found 3\.22e\+03 diameters"):
        evaluate(scenario(), columns, ["ballistic_limit_m_s"])


def test_rows_of_other_keys_are_checked_with_their_inputs():
    own = {"projectile": {"mine": {"based_on": "7.62 mm AP", "density_kg_m3": 8000.0}}}
    columns = {"library.projectile.mine.density_kg_m3": np.array([8e3, 8e3, 100.0]), ROD[0]: np.array([6.5, 5.0, 2.0])}
    with pytest.raises(InputError, match=r"row 3: library\.projectile\.mine\.penetrator_mass_g: must make a rod"):
        evaluate(scenario("mine", library=own), columns, ["areal_density_kg_m2"])
    columns["ballistic_limit.tolerance_m_s"] = np.array([1.0, -1.0, 1.0])
    with pytest.raises(InputError, match=r"row 2: ballistic_limit\.tolerance_m_s: must be at least"):
        evaluate(scenario("mine", library=own), columns, ["ballistic_limit_m_s"])


@pytest.mark.parametrize(
    ("columns", "quantities", "message"),
    [
        ({}, ["speed"], 'evaluate: quantities: unknown quantity "speed"'),
        ({}, ["required_ceramic_thickness_mm"], "optimise: is missing"),
        ({"a b": [1.0]}, ["outcome"], "must be a key of the scenario"),
        ({C: [1.0, -1.0]}, ["outcome"], f"{C}: must be at least 0"),
        ({C: [np.nan]}, ["outcome"], f"row 1: {C}: must be a finite number"),
        ({"solver.time_step_us": [np.inf]}, ["outcome"], r"row 1: solver\.time_step_us: must be a finite number"),
        ({C: [5.0], 'armour."ceramic_thickness_mm"': [6.0]}, ["outcome"], f"{C}: must be given once"),
        ({"armour.ceramic.density_kg_m3": [1.0]}, ["outcome"], "must not go below armour.ceramic"),
        ({"optimise.ceramic_thickness_mm.min": [1.0]}, ["outcome"], "optimise.ceramic_thickness_mm.max: is missing"),
        ({"ballistic_limit.tolerance_m_s": [1.0]}, ["outcome"], "must have an effect: "),
        ({"library.ceramic.B4C.flow_stress_GPa": [5.0]}, ["outcome"], "must be an entry .* uses; choose from AD85"),
    ],
)
def test_what_is_refused(columns: dict[str, Any], quantities: list[str], message: str):
    with pytest.raises(InputError, match=message):
        evaluate(scenario(), {key: np.array(values) for key, values in columns.items()}, quantities)


def test_another_spelling_of_an_input():
    found = evaluate(scenario(), {' armour."ceramic_thickness_mm"': np.array([6, 8])}, ["areal_density_kg_m2"])
    assert found["areal_density_kg_m2"].tolist() == pytest.approx([38.0425, 44.9025])
