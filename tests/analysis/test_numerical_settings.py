"""The model error depends on what is computed, not on how exactly."""

import numpy as np
import pytest

import armour
from armour.analysis.variants import MOST_MOVED_M_S, moved_m_s
from tests.helpers.cases import TESTS, scenario

THICKNESSES = {"armour.ceramic_thickness_mm": np.linspace(4.0, 9.0, 11).tolist()}
STEP, TOLERANCE = "solver.time_step_us", "ballistic_limit.tolerance_m_s"


@pytest.mark.parametrize("settings", [{STEP: 0.1}, {TOLERANCE: 0.9}, {STEP: 2.0, TOLERANCE: 1e-6}])
def test_settings_that_hardly_move_the_limit_have_the_usual_error(settings: dict[str, float]):
    usual, changed = armour.confidence(scenario()), armour.confidence(scenario().replaced(settings))
    assert changed.probability_of_stopping == pytest.approx(usual.probability_of_stopping, abs=0.005)
    assert changed.model_error is not None


@pytest.mark.parametrize("settings", [{STEP: 50.0}, {TOLERANCE: 60.0}])
def test_the_error_is_known_where_the_limit_moves_by_a_metre_per_second_at_most(settings: dict[str, float]):
    quantities = ["ballistic_limit_m_s", "probability_of_stopping"]
    usual, changed = (
        armour.sweep(case, THICKNESSES, quantities) for case in (scenario(), scenario().replaced(settings))
    )
    moved = changed["ballistic_limit_m_s"] - usual["ballistic_limit_m_s"]
    is_known = ~np.isnan(changed["probability_of_stopping"])
    assert is_known.tolist() == (np.abs(moved) <= 1.0).tolist()
    assert len(set(is_known.tolist())) == 2
    place = int(np.abs(moved).argmax())
    thickness = {"armour.ceramic_thickness_mm": THICKNESSES["armour.ceramic_thickness_mm"][place]}
    case = scenario().replaced(thickness | settings)
    reason = armour.confidence(case).reason
    assert f"moves the ballistic limit by {moved[place]:+.3g} m/s" in reason
    assert armour.ballistic_limit(case).interval_m_s is None
    given = case.replaced(
        {"uncertainty.model": {"mean_percent": 0.0, "scale_percent": 5.0, "degrees_of_freedom": 1e6, "source": "tests"}}
    )
    assert armour.ballistic_limit(given).interval_m_s is not None


@pytest.mark.parametrize(("step_us", "is_known"), [(0.5, True), (50.0, False)])
def test_designs_have_the_probability_of_their_armour(step_us: float, is_known: bool):
    layers = {"ceramic": [{"material": "AD85", "thickness_mm": [5.5]}]}
    layers["backing"] = [{"material": "6061-T6", "thickness_mm": [6.35]}]
    case = scenario(velocity=500.0, design={**layers, "probability_of_stopping": 0.9}, solver={"time_step_us": step_us})
    result = armour.optimise(case)
    assert (result.best is not None) == is_known
    assert ("moves the ballistic limit by" in result.shown.check.threats[0].reason) != is_known


@pytest.mark.parametrize(("step_us", "count"), [(0.5, 13), (50.0, 11)])
def test_own_tests_of_limits_that_hardly_move_are_evidence(step_us: float, count: int):
    case = armour.load_scenario("wilkins").replaced({STEP: step_us})
    tests = armour.read_tests(TESTS, case)
    moved = np.abs(np.concatenate([moved_m_s(group.variants()) for group in tests.groups])) > MOST_MOVED_M_S
    assert (~moved).sum() == count
    evidence = armour.calibrate(tests, case).evidence
    assert len((evidence or {})["tests"]["side"]) == count
