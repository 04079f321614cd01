"""The error of ballistic limits by the usual tolerance, and of given time steps."""

from pathlib import Path

import numpy as np
import pytest

from armour.analysis.impact import simulate
from armour.core.search import RunSettings
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from armour.scenario.scenario import load_scenario
from armour.units import US
from tests.helpers.bisection import bisect
from tests.helpers.cases import COMPLETE, scenario
from tests.helpers.runs import crossing_time, random_designs


def perforates(p: Parameters, velocity: float, part: float = 0.0) -> bool:
    """Whether an impact perforates, by the engine; unless the part is 0, with steps of a part of `crossing_time`."""
    settings = RunSettings(1.0, part * crossing_time(p, velocity), max_steps=5_000_000)
    return bool(batch.impacts(batch.packed([p]), np.array([velocity]), settings).outcome[0] == Outcome.PERFORATED)


def is_near(p: Parameters, part: float, distance: float) -> bool:
    """Whether the limit by given short steps is within a distance, m/s, of that by the usual ones."""
    found = bisect(lambda velocity: perforates(p, velocity), 50.0, 4000.0, 1e-5)[1]
    return perforates(p, found + distance, part) and not perforates(p, found - distance, part)


@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_the_limit_of_every_shipped_scenario_is_within_three_thousandths(path: Path):
    assert is_near(load_scenario(path).core_armour(), 1 / 1000, 0.003)


@pytest.mark.parametrize("index", range(40))
def test_the_limit_of_random_designs_is_within_three_thousandths(index: int):
    assert is_near(random_designs(40)[index], 1 / 1000, 0.003)


def test_given_steps_converge_to_the_usual_result():
    usual = simulate(scenario()).residual_velocity_m_s
    errors = [abs(simulate(scenario(solver={"time_step_us": us})).residual_velocity_m_s - usual) for us in (1.0, 0.1)]
    assert errors[0] < 0.1
    assert errors[1] < 1e-3


@pytest.mark.parametrize("dt_us", [1.0, 0.1])
def test_given_steps_end_every_impact_near_the_usual_result(dt_us: float):
    """At the back face the plate ahead vanishes and its rates grow without limit, whatever the step."""
    rows = np.repeat(batch.packed(random_designs(40)), 40, axis=0)
    velocities = np.tile(np.geomspace(300.0, 4000.0, 40), 40)
    usual = batch.impacts(rows, velocities)
    given = batch.impacts(rows, velocities, batch.DEFAULT_SETTINGS._replace(dt=dt_us * US))
    np.testing.assert_array_equal(given.outcome == Outcome.UNRESOLVED, False)
    same = given.outcome == usual.outcome
    assert np.mean(same) > 0.99
    np.testing.assert_allclose(given.V[same], usual.V[same], atol=dt_us)
