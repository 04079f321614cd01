"""The campaign counts what the program does."""

import pytest

from tools.experiments.firings import simulate

pytestmark = pytest.mark.slow


def test_simulated_firings_end_with_intervals_that_hold():
    found = simulate("bayesian", 1.0, 15.0, 10, 1)
    assert 8 < found.shots.mean() < 40
    assert found.held.mean() > 0.6
