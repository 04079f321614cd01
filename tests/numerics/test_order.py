"""The order of convergence across changes of stage."""

import numpy as np
import pytest

from armour.core.run import run
from armour.core.state import Parameters
from tests.helpers.runs import STAGE_PATHS, path, traced

pytestmark = pytest.mark.slow

LONGEST = 0.5e-6
HALVINGS = 7
# Below this the error is that of the location of events, and rounding.
ROUNDING = 2e-9


def residual(p: Parameters, velocity: float, dt: float) -> float:
    return run(p, velocity, dt, 1.0, 1_000_000).y.V


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
