"""The campaign counts what the program does."""

import numpy as np
import pytest

from armour.statistics.curves import fit_curve
from armour.statistics.v50 import Shots
from tools.experiments.firings import Intervals, simulate

pytestmark = pytest.mark.slow


def test_intervals_on_a_grid_are_those_of_the_program():
    dice, errors = np.random.default_rng(2), []
    velocities = 800.0 + dice.normal(0.0, 18.0, (16, 10))
    complete = dice.normal(800.0, 15.0, (16, 10)) < velocities
    intervals = Intervals(10, 800.0)
    for each, results in zip(velocities, complete, strict=True):
        intervals.add(each, results)
    for firing, ends in enumerate(intervals.ends()):
        shots = Shots(tuple(velocities[:, firing].tolist()), tuple(complete[:, firing].tolist()))
        fit = fit_curve(shots.of(complete=False), shots.of(complete=True), "probit", penalised=True)
        assert fit is not None
        low, high = fit.v50_interval_m_s
        if low is not None and high is not None and high - low < 40.0:
            errors.append(abs(ends - (low, high)))
    # The grids have steps of 3 m/s, and are interpolated.
    assert len(errors) > 2
    assert np.max(errors) < 1.0
    assert np.mean(errors) < 0.3


def test_simulated_firings_end_with_intervals_that_hold():
    for procedure in ("bayesian", "langlie"):
        found = simulate(procedure, 1.0, 15.0, 10, 1)
        assert 8 < found.shots.mean() < 40
        assert found.held.mean() > 0.6
