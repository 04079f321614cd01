"""The default time step: how far from the limit of vanishing step its results are."""

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.run import run
from armour.core.stages import default_time_step
from armour.core.state import Outcome, Parameters
from armour.scenario.loading import load_scenario
from tests.cases import SCENARIOS
from tests.numerics.test_independent import random_designs


def perforates(a: Parameters, velocity: float, part: float) -> bool:
    """Whether the velocity perforates, with a part of the default step."""
    dt = part * default_time_step(a, velocity)
    return run(a, velocity, dt, 1.0, 1_000_000).outcome == Outcome.PERFORATED


def is_near(a: Parameters, part: float, distance: float) -> bool:
    """Whether the ballistic limit of a part of the default step is within a distance, m/s, of that of the default."""
    found = bisect(lambda velocity: perforates(a, velocity, 1.0), 50.0, 4000.0, 1e-5)[1]
    return perforates(a, found + distance, part) and not perforates(a, found - distance, part)


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_the_limit_of_every_shipped_scenario_is_within_a_thousandth(path):
    assert is_near(load_scenario(path).core_armour(), 1 / 64, 0.001)


@pytest.mark.parametrize("index", range(40))
def test_the_limit_of_random_designs_is_within_a_thousandth(index: int):
    """Measured on 1,000 of them: 0.0006 m/s at most."""
    assert is_near(random_designs(40)[index], 1 / 20, 0.001)
