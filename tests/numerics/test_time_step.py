"""The error of ballistic limits by the default time step."""

from pathlib import Path

import numpy as np
import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.state import Outcome, Parameters
from armour.core.stepping import default_time_step
from armour.engine import batch
from armour.scenario.scenario import load_scenario
from tests.helpers.cases import SCENARIOS
from tests.helpers.runs import random_designs


def perforates(p: Parameters, velocity: float, part: float = 1.0) -> bool:
    """Whether an impact perforates, by the engine with a part of the default time step."""
    options = batch.SolverOptions(time_step=part * default_time_step(p, velocity), max_steps=5_000_000)
    return bool(batch.impacts(batch.packed([p]), np.array([velocity]), options).outcome[0] == Outcome.PERFORATED)


def is_near(p: Parameters, part: float, distance: float) -> bool:
    """Whether the limit by a part of the default time step is within a distance, m/s, of that by the default."""
    found = bisect(lambda velocity: perforates(p, velocity), 50.0, 4000.0, 1e-5)[1]
    return perforates(p, found + distance, part) and not perforates(p, found - distance, part)


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_the_limit_of_every_shipped_scenario_is_within_a_thousandth(path: Path):
    assert is_near(load_scenario(path).core_armour(), 1 / 64, 0.001)


@pytest.mark.parametrize("index", range(40))
def test_the_limit_of_random_designs_is_within_a_thousandth(index: int):
    """Of 1,000 random designs the largest error is 0.0006 m/s."""
    assert is_near(random_designs(40)[index], 1 / 20, 0.001)
