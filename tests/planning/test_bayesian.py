"""The Bayesian procedure, against direct expectations."""

import numpy as np
import pytest

from armour.planning import bayesian
from armour.planning.procedures import ShotSettings
from armour.scenario.evidence import ModelError
from armour.statistics.posterior import FiringPrior, Posterior, posterior_of
from armour.statistics.v50 import Shots

PRIOR = FiringPrior(720.0, ModelError(0.0, 7.0, 12.0))
SETTINGS = ShotSettings(720.0, 14.4, None, 15.0, prior=PRIOR)
SHOTS = Shots((720.0, 770.0, 745.0), (False, True, False))


def test_the_gain_is_the_expected_reduction_of_the_variance():
    known = bayesian.posterior(SHOTS, SETTINGS)
    velocity = 752.0
    response = known.grid.response(np.array([velocity]))
    expected = 0.0
    for weights in (known.weights * response[0], known.weights * (1.0 - response[0])):
        after = Posterior(known.grid, weights / weights.sum())
        expected += weights.sum() * after.variance(known.grid.v50_m_s)
    [[gain]] = bayesian.gains(known.weights[None], known.grid.v50_m_s, response)
    assert known.variance(known.grid.v50_m_s) - gain == pytest.approx(expected)


def test_the_velocity_has_the_greatest_gain():
    known = bayesian.posterior(SHOTS, SETTINGS)
    aim = bayesian.next_velocity(SHOTS, SETTINGS)
    others = np.linspace(650.0, 850.0, 401)
    gains = bayesian.gains(known.weights[None], known.grid.v50_m_s, known.grid.response(others))[0]
    assert aim.velocity_m_s == pytest.approx(others[np.argmax(gains)], abs=1.0)


def test_the_first_shot_is_at_the_models_limit():
    assert bayesian.next_velocity(Shots((), ()), SETTINGS).velocity_m_s == pytest.approx(720.0, abs=2.0)


def test_the_end_by_the_interval():
    low, high = bayesian.posterior(SHOTS, SETTINGS).estimate(0.95).v50_interval_m_s
    half = 0.5 * (high - low)
    assert bayesian.stopped(SHOTS, SETTINGS._replace(half_width_m_s=half + 0.1)).startswith("the interval of V50 is")
    assert bayesian.stopped(SHOTS, SETTINGS._replace(half_width_m_s=half - 0.1)) == ""


@pytest.mark.parametrize(("required", "answer"), [(600.0, "is met"), (900.0, "is not met"), (745.0, "")])
def test_the_end_by_a_requirement(required: float, answer: str):
    settings = SETTINGS._replace(half_width_m_s=None, requirement_m_s=required)
    assert answer in bayesian.stopped(SHOTS, settings)
    assert bool(bayesian.stopped(SHOTS, settings)) == bool(answer)


def test_many_firings_at_once_choose_as_one_does():
    known = posterior_of(PRIOR, (), (), (201, 31))
    firings = bayesian.Firings(known, SETTINGS, 2, 401)
    fired = [Shots((), ()), Shots((), ())]
    for results in ((True, False), (True, True), (False, True)):
        aims = firings.aims()
        singles = [bayesian.next_velocity(each, SETTINGS).velocity_m_s for each in fired]
        assert aims == pytest.approx(singles, abs=2.0)
        firings.add(aims, np.array(results))
        fired = [
            Shots((*each.velocities_m_s, float(aim)), (*each.complete, result))
            for each, aim, result in zip(fired, aims, results, strict=True)
        ]
    for ends, each in zip(firings.intervals(), fired, strict=True):
        assert ends == pytest.approx(bayesian.posterior(each, SETTINGS).estimate(0.95).v50_interval_m_s, abs=1.0)


def test_fewer_shots_are_expected_for_a_wider_interval_and_as_shots_are_fired():
    assert bayesian.expected_shots(SHOTS, SETTINGS) == bayesian.expected_shots(SHOTS, SETTINGS)
    wide = bayesian.expected_shots(SHOTS, SETTINGS._replace(half_width_m_s=30.0))
    narrow = bayesian.expected_shots(SHOTS, SETTINGS)
    start = bayesian.expected_shots(Shots((), ()), SETTINGS)
    assert wide is not None
    assert narrow is not None
    assert start is not None
    assert 0 < wide < narrow < start
    assert bayesian.expected_shots(SHOTS, SETTINGS._replace(half_width_m_s=0.5)) is None
