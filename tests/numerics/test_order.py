"""The order of convergence across changes of stage."""

import numpy as np
import pytest

from armour.core.state import Parameters
from armour.engine import batch
from tests.helpers.runs import STAGE_PATHS, path, traced

pytestmark = pytest.mark.slow

LONGEST = 0.5e-6
HALVINGS = 7
# Below this the error is that of the location of events, and rounding.
ROUNDING = 2e-9


def residual(p: Parameters, velocity: float, dt: float) -> float:
    """The residual velocity, m/s, by the engine."""
    return float(batch.impacts(batch.packed([p]), np.array([velocity]), batch.DEFAULT_SETTINGS._replace(dt=dt)).V[0])


@pytest.mark.parametrize("name", STAGE_PATHS)
def test_the_error_is_of_fourth_order_in_the_step(name: str):
    """Where in its step an event lies differs from step to step, so that the order is that over several halvings."""
    parameters, velocity, stages = STAGE_PATHS[name]
    p = parameters()
    assert path(traced(p, velocity)[1]) == stages
    exact = residual(p, velocity, LONGEST / 512)
    errors = [abs(residual(p, velocity, LONGEST / 2**k) - exact) for k in range(HALVINGS)]
    seen = [error for error in errors if error > ROUNDING]
    assert len(seen) >= 3
    slope, _ = np.polyfit(np.arange(len(seen)), np.log2(seen), 1)
    assert -4.7 < slope < -3.5
