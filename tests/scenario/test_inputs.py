import numpy as np
import pytest

from armour.errors import InputError
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS
from armour.scenario.library import FLOW_STRESS_LAW
from tests.helpers.cases import scenario


def test_the_inputs_have_the_values_of_the_scenario():
    found = scenario().inputs()
    assert found.keys() == set(INPUTS) - {f"ceramic.{key}" for key in FLOW_STRESS_LAW}
    assert found["ceramic.flow_stress_GPa"] == 5.2


def test_the_coefficients_of_a_law_are_inputs_where_the_entry_has_them():
    entry = {"based_on": "AD85", "flow_stress_backing_exponent": -0.5, "flow_stress_ceramic_slope": 0.0}
    own = {"ceramic": {"Mine": entry, "Other": {"based_on": "Mine", "flow_stress_backing_exponent": 0.25}}}
    case = scenario(ceramic="Other", library=own)
    found = case.inputs()
    assert set(INPUTS) - found.keys() == {"ceramic.flow_stress_product_exponent", "ceramic.flow_stress_backing_slope"}
    assert found["ceramic.flow_stress_backing_exponent"] == 0.25
    changed = case.with_inputs({"ceramic.flow_stress_ceramic_slope": -0.1}).core_armour()
    assert (changed.n_B, changed.n_cB, changed.a_c, changed.a_B) == (0.25, 0.0, -0.1, 0.0)
    with pytest.raises(InputError, match="must be at most 3, found"):
        case.check_rows({"ceramic.flow_stress_backing_exponent": np.array([0.0, 3.5])})


def test_a_given_strength_is_not_derived():
    case = scenario()
    both = case.with_inputs({"backing.dynamic_yield_strength_MPa": 400.0, "backing.shear_strength_MPa": 250.0})
    assert both.core_armour().tau == 250e6
    assert case.with_inputs({"backing.dynamic_yield_strength_MPa": 400.0}).core_armour().tau == pytest.approx(280e6)


def test_unknown_names_are_reported():
    with pytest.raises(InputError) as error:
        scenario().check_names(["ceramic.flow_stress", "backing.shear_strenght_MPa", "hardness"], "t.csv", "--fit")
    first, second, third = (str(problem) for problem in error.value.problems)
    assert first == (
        't.csv: --fit: must name an input of the scenario, found "ceramic.flow_stress"; '
        "its unit is missing: ceramic.flow_stress_GPa"
    )
    assert second.endswith('did you mean "backing.shear_strength_MPa"?')
    assert "; choose from impact.velocity_m_s, " in third
    with pytest.raises(InputError, match=r'found "ceramic\.flow_stress_GPa"'):
        scenario(ceramic=None, ceramic_mm=0.0, backing="AA6082-T651").with_inputs({"ceramic.flow_stress_GPa": 5.0})


def test_values_that_are_not_allowed():
    with pytest.raises(InputError, match="found -1"):
        scenario().check_rows({"ceramic.flow_stress_GPa": np.array([5.0, -1.0])})
    for value in (np.nan, np.inf, -np.inf):
        with pytest.raises(InputError, match="finite"):
            scenario().check_rows({"impact.velocity_m_s": np.array([500.0, value])})
    with pytest.raises(InputError) as error:
        scenario().check_rows({CERAMIC: np.array([-1.0, 5.0]), BACKING: np.array([1e9, 0.0])})
    assert [problem.key for problem in error.value.problems] == [f"row 1: {CERAMIC}", f"row 1: {BACKING}"]
