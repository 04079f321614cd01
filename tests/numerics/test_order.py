"""The order of convergence across changes of stage."""

from itertools import pairwise

import pytest

from armour.core.run import run
from armour.core.state import Parameters
from tests.helpers.runs import STAGE_PATHS, path, traced

pytestmark = pytest.mark.slow

LONGEST = 0.5e-6
# Longer steps of this case are shortened by the response of the motion.
LONGEST_OF = {"plate moves, stops and moves": 0.25e-6}
HALVINGS = 6
# Below this the error is rounding: a few hundred steps, each with an error of about 1e-13 m/s.
ROUNDING = 2e-10


def residual(p: Parameters, velocity: float, dt: float) -> float:
    return run(p, velocity, dt, 1.0, 1_000_000).y.V


@pytest.mark.parametrize("name", STAGE_PATHS)
def test_the_error_falls_by_sixteen_with_every_halving_of_the_step(name: str):
    parameters, velocity, stages = STAGE_PATHS[name]
    p = parameters()
    assert path(traced(p, velocity)[1]) == stages
    longest = LONGEST_OF.get(name, LONGEST)
    exact = residual(p, velocity, longest / 256)
    errors = [abs(residual(p, velocity, longest / 2**k) - exact) for k in range(HALVINGS)]
    seen = [(coarse, fine) for coarse, fine in pairwise(errors) if fine > ROUNDING]
    assert len(seen) >= 3
    for coarse, fine in seen:
        assert 12.0 < coarse / fine < 20.0
    assert errors[-1] < 1e-8
