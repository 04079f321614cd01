"""The default time step: how far from the limit of vanishing step its results are."""

import pytest

from armour.core.run import run
from armour.core.stages import default_time_step
from armour.core.state import Armour, Outcome
from armour.limit import bisect
from armour.scenario import load_scenario
from tests.cases import SCENARIOS


def limit(a: Armour, part: float, low: float, high: float) -> float:
    """Ballistic limit with a part of the default step, to 1e-5 m/s."""

    def perforates(velocity: float) -> bool:
        dt = part * default_time_step(a, velocity)
        return run(a, velocity, dt, 1.0, 1_000_000).outcome == Outcome.PERFORATED

    assert not perforates(low)
    assert perforates(high)
    return bisect(perforates, low, high, 1e-5)[1]


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_the_limit_of_every_shipped_scenario_is_within_a_hundredth(path):
    a = load_scenario(path).core_armour()
    found = limit(a, 1.0, 100.0, 2500.0)
    fine = limit(a, 1 / 16, found - 0.1, found + 0.1)
    assert found == pytest.approx(fine, abs=0.01)
    # What is claimed is far less than what is reached.
    assert found == pytest.approx(fine, abs=0.001)
