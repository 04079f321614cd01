"""Variants as rows for the engine, against scenarios that are computed one by one."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.variants import grid_of, variants_of
from armour.engine import batch
from armour.errors import InputError
from armour.scenario.scenario import Scenario
from tests.helpers.cases import grid, scenario

WIDE = grid((1.0, 20.0, 0.5), (1.0, 20.0, 0.5))
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
CASES: dict[str, dict[str, Any]] = {
    "Wilkins": {},
    "25 mm": {
        "projectile": "25 mm APDS",
        "ceramic": "AD99.5",
        "backing": "AA6082-T651",
        "ceramic_mm": 20.0,
        "backing_mm": 10.0,
        "velocity": 1300.0,
        "perimeter": "projectile",
    },
    "own metal": {"backing": "Mine", "library": {"metal": {"Mine": {"based_on": "6061-T6", "density_kg_m3": 2800.0}}}},
    "bare plate": {"ceramic": None, "ceramic_mm": 0.0, "backing": "AA6082-T651"},
}


def case(velocity: float = 850.0, **thicknesses: float) -> Scenario:
    return scenario(backing="5083-H3", velocity=velocity, optimise=WIDE, **thicknesses)


def test_the_grid_must_be_there():
    with pytest.raises(InputError, match="optimise: is missing"):
        grid_of(scenario())


def test_a_grid_of_ceramic_without_a_ceramic():
    with pytest.raises(InputError, match=r"armour\.ceramic: must name a ceramic"):
        grid_of(scenario(ceramic=None, ceramic_mm=0.0, optimise=WIDE))


@pytest.mark.parametrize("name", CASES)
def test_a_row_is_the_scenario_with_its_values(name: str):
    case = scenario(**CASES[name])
    own = case.inputs()
    rng = np.random.default_rng(3)
    for names in (*([key] for key in own), list(own)):
        columns = {key: own[key] * rng.uniform(0.9, 1.1, 4) for key in names}
        found = variants_of(case, columns, 4)
        for i in range(4):
            made = case.with_inputs({key: float(values[i]) for key, values in columns.items()})
            assert found.parameters[i] == pytest.approx(batch.packed([made.core_armour()])[0], rel=1e-14)
            assert found.velocities[i] == made.impact.velocity_m_s


@pytest.mark.parametrize("name", CASES)
def test_every_input_changes_the_row(name: str):
    case = scenario(**CASES[name])
    for key, value in case.inputs().items():
        found = variants_of(case, {key: np.array([value, 1.01 * value or 1.0])}, 2)
        assert (found.parameters[0] != found.parameters[1]).any() or found.velocities[0] != found.velocities[1], key


def test_the_back_plates_strengths_follow_its_yield_strength_whatever_the_ceramics_flow_stress():
    case = scenario(**CASES["25 mm"])
    columns = {"backing.dynamic_yield_strength_MPa": np.array([312.0]), "ceramic.flow_stress_GPa": np.array([6.0])}
    [row] = variants_of(case, columns, 1).parameters
    made = case.with_inputs({key: float(values[0]) for key, values in columns.items()}).core_armour()
    assert row == pytest.approx(batch.packed([made])[0], rel=1e-14)
    assert pytest.approx(2.7 * 312e6) == made.YB
