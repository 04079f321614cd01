"""The model error is that of limits computed as those of the tests were."""

import pytest

import armour
from tests.helpers.cases import TESTS, scenario

STEP, TOLERANCE = "solver.time_step_us", "ballistic_limit.tolerance_m_s"


@pytest.mark.parametrize(("key", "value"), [(STEP, 0.1), (TOLERANCE, 5.0)])
def test_the_error_is_not_known_with_other_settings(key: str, value: float):
    case = scenario().replaced({key: value})
    found = armour.confidence(case)
    assert (found.probability_of_stopping, found.reason) == (None, f"the tests were not computed with {key} = {value}")
    assert armour.calibrate(armour.read_tests(TESTS, case), case).evidence is None
    given = {"mean_percent": 0.0, "scale_percent": 5.0, "degrees_of_freedom": 1e6, "source": "tests"}
    assert armour.ballistic_limit(case.replaced({"uncertainty.model": given})).interval_m_s is not None


def test_a_tolerance_of_a_metre_per_second_has_the_usual_error():
    usual, changed = armour.confidence(scenario()), armour.confidence(scenario().replaced({TOLERANCE: 0.9}))
    assert changed.probability_of_stopping == pytest.approx(usual.probability_of_stopping, abs=0.005)
