import numpy as np
import pytest

from armour.engine import batch
from armour.errors import InputError
from armour.scenario.parameters import INPUTS, check_names, check_ranges, inputs_of, rows_of, with_inputs
from tests.cases import scenario

OWN = {"metal": {"Mine": {"based_on": "6061-T6", "density_kg_m3": 2800.0}}}
CASES = [
    scenario(),
    scenario("25 mm APDS", "AD99.5", "AA6082-T651", 20.0, 10.0, 1300.0, "projectile"),
    scenario(backing="Mine", library=OWN),
    scenario(ceramic=None, ceramic_mm=0.0, backing="AA6082-T651"),
]


@pytest.mark.parametrize("case", CASES, ids=range(len(CASES)))
def test_a_row_is_the_scenario_with_its_values(case):
    rng = np.random.default_rng(3)
    for names in (*([name] for name in inputs_of(case)), list(inputs_of(case))):
        columns = {name: inputs_of(case)[name] * rng.uniform(0.9, 1.1, 4) for name in names}
        rows, velocities = rows_of(case, columns, 4)
        for i in range(4):
            changed = with_inputs(case, {name: float(values[i]) for name, values in columns.items()})
            assert rows[i] == pytest.approx(batch.packed([changed.core_armour()])[0], rel=1e-14)
            assert velocities[i] == changed.impact.velocity_m_s


@pytest.mark.parametrize("case", CASES, ids=range(len(CASES)))
def test_every_input_counts(case):
    """Each changes the row or the velocity: none is listed in vain."""
    own = inputs_of(case)
    for name, value in own.items():
        if name == "ceramic.youngs_modulus_GPa" and case.armour.ceramic is None:
            continue
        rows, velocities = rows_of(case, {name: np.array([value, 1.01 * value])}, 2)
        assert (rows[0] != rows[1]).any() or velocities[0] != velocities[1], name


def test_the_values_are_those_of_the_scenario():
    assert inputs_of(CASES[0]).keys() == set(INPUTS)
    assert inputs_of(CASES[0])["ceramic.flow_stress_GPa"] == 5.2
    assert inputs_of(CASES[2])["backing.density_kg_m3"] == 2800.0
    assert not any(name.startswith("ceramic.") for name in inputs_of(CASES[3]))


def test_a_flow_stress_of_another_role_does_not_stop_the_backings_from_following():
    case = CASES[1]
    columns = {"backing.dynamic_yield_strength_MPa": np.array([312.0]), "ceramic.flow_stress_GPa": np.array([6.0])}
    rows, _ = rows_of(case, columns, 1)
    changed = with_inputs(case, {name: float(values[0]) for name, values in columns.items()})
    assert rows[0] == pytest.approx(batch.packed([changed.core_armour()])[0], rel=1e-14)
    assert pytest.approx(2.7 * 312e6) == changed.core_armour().YB


def test_a_strength_given_is_no_longer_derived():
    case = scenario()
    both = with_inputs(case, {"backing.dynamic_yield_strength_MPa": 400.0, "backing.shear_strength_MPa": 250.0})
    assert both.core_armour().tau == 250e6
    assert with_inputs(case, {"backing.dynamic_yield_strength_MPa": 400.0}).core_armour().tau == pytest.approx(280e6)


def test_names_that_are_none():
    with pytest.raises(InputError) as error:
        check_names(["ceramic.flow_stress", "backing.shear_strenght_MPa", "hardness"], scenario(), "t.csv", "--fit")
    first, second, third = (str(problem) for problem in error.value.problems)
    assert first == (
        't.csv: --fit: must name an input of the scenario, found "ceramic.flow_stress"; '
        "its unit is missing: ceramic.flow_stress_GPa"
    )
    assert second.endswith("did you mean 'backing.shear_strength_MPa'?")
    assert "; there are impact.velocity_m_s, " in third
    with pytest.raises(InputError, match=r'found "ceramic\.flow_stress_GPa"'):
        with_inputs(CASES[3], {"ceramic.flow_stress_GPa": 5.0})


def test_values_that_are_not_allowed():
    with pytest.raises(InputError, match="found -1"):
        check_ranges(scenario(), {"ceramic.flow_stress_GPa": np.array([5.0, -1.0])})
    with pytest.raises(InputError, match="finite"):
        check_ranges(scenario(), {"impact.velocity_m_s": np.array([500.0, np.nan])})
