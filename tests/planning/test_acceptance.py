"""Decisions on a requirement: likelihood ratios by hand and by searches, and their risks in simulated firings."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import log_ndtr, ndtr, ndtri
from scipy.stats import norm

from armour.evidence.model_error import ModelError
from armour.planning.firing import aimed
from armour.planning.procedures import (
    RequirementCurves,
    ShotSettings,
    expected_shots,
    next_bayesian,
    requirement_curves,
    stopped_bayesian,
)
from armour.statistics.posterior import FiringPrior
from armour.statistics.v50 import Shots
from tools.campaigns.firings import requirement

pytestmark = pytest.mark.slow

REQUIRED, SCATTER = 700.0, 14.0


def added(shots: Shots, velocity_m_s: float, complete: bool) -> Shots:
    """The shots with one more."""
    return Shots((*shots.velocities_m_s, velocity_m_s), (*shots.complete, complete))


def prior_of(v50_m_s: float) -> FiringPrior:
    return FiringPrior(v50_m_s, ModelError(0.0, 2.0, 12.0), scatter_percent=100.0 * SCATTER / v50_m_s)


SETTINGS = ShotSettings(prior_of(760.0), requirement_m_s=REQUIRED)


def ratios(curves: RequirementCurves, shots: Shots) -> list[float]:
    known = curves.posterior(shots.velocities_m_s, shots.complete)
    return curves.ratios(known.weights[None])[0].tolist()


@pytest.mark.parametrize("count", [1, 3, 6])
def test_partial_penetrations_at_the_requirement(count: int):
    """A curve that just meets it gives each one half; others, a distance of sinh(1.6 u) away, the probability of it."""
    found = ratios(requirement_curves(REQUIRED, 0.5, SCATTER, 2.0), Shots((REQUIRED,) * count, (False,) * count))
    mean = 2.0 * norm.expect(lambda u: ndtr(np.sinh(1.6 * u)) ** count, lb=0.0, ub=6.0)
    assert found[0] == pytest.approx(mean / 0.5**count, rel=0.02)


@pytest.mark.parametrize("fraction", [0.5, 0.05])
def test_the_likeliest_curve_that_fails_just_meets_the_requirement(fraction: float):
    shots = Shots((690.0, 702.0, 707.0, 712.0, 718.0, 726.0, 735.0), (False, False, False, False, True, False, True))
    curves, argument = requirement_curves(REQUIRED, fraction, SCATTER, 2.0), float(ndtri(fraction))
    v, sign = np.array(shots.velocities_m_s), np.where(shots.complete, 1.0, -1.0)

    def lost(x: np.ndarray) -> float:
        """Less the log-likelihood of a curve at whose requirement the argument is above that of the fraction."""
        z = argument + np.exp(x[0]) + (v - REQUIRED) * np.exp(x[1])
        return -float(log_ndtr(sign * z).sum())

    best = min(minimize(lost, start, method="Nelder-Mead").fun for start in ((-3.0, -3.0), (0.0, -2.0), (-8.0, -4.0)))
    z = (v[:, None] - curves.grid.v50_m_s) / curves.grid.scatter_m_s
    likelihood = log_ndtr(sign[:, None] * z).sum(axis=0)
    assert likelihood[curves.met == 0.5].max() == pytest.approx(-best, abs=0.01)
    mean, _ = ratios(curves, shots)
    assert mean == pytest.approx(
        np.average(np.exp(likelihood), weights=np.exp(curves.log_weights) * (curves.met == 1.0)) / np.exp(-best),
        rel=0.01,
    )


def test_shots_as_planned_decide_as_soon_as_expected():
    """Planned on a finer grid than the continuations are, a velocity once just missed the decision for four shots."""
    shots = Shots((), ())
    while not stopped_bayesian(shots, SETTINGS):
        assert expected_shots(shots, SETTINGS) == 6 - len(shots.complete)
        shots = added(shots, aimed(next_bayesian(shots, SETTINGS).velocity_m_s), complete=False)


def test_the_gain_is_the_expected_increase_of_the_logarithm_of_the_ratio():
    shots = Shots((690.0, 702.0, 707.0), (False, True, False))
    curves = requirement_curves(REQUIRED, 0.5, SCATTER, 2.0)
    known, before = curves.posterior(shots.velocities_m_s, shots.complete), np.log(ratios(curves, shots))
    expected = []
    for velocity in (690.0, 705.0):
        [response] = curves.grid.response(np.array([velocity]))
        expected.append(0.0)
        for complete, chance in ((True, response), (False, 1.0 - response)):
            change = np.log(ratios(curves, added(shots, velocity, complete))) - before
            sides = [float((known.weights * chance)[curves.met == side].sum()) for side in (1.0, 0.0)]
            expected[-1] += float(sides @ change)
    gained = curves.gains(known.weights[None], curves.grid.response(np.array([690.0, 705.0])))[0]
    assert gained[1] - gained[0] == pytest.approx(expected[1] - expected[0])


def test_the_end_names_the_risk_of_the_decision():
    met, failed = (Shots((REQUIRED,) * 8, (complete,) * 8) for complete in (False, True))
    assert stopped_bayesian(met, SETTINGS) == "the requirement is met, at a consumer's risk of at most 5 %"
    assert stopped_bayesian(failed, SETTINGS) == "the requirement is not met, at a producer's risk of at most 5 %"
    assert stopped_bayesian(met, SETTINGS._replace(confidence=0.9999)) == ""
    assert next_bayesian(met, SETTINGS) == next_bayesian(met, SETTINGS._replace(prior=prior_of(900.0)))


def test_the_stated_risks_hold_at_the_requirement():
    """Where both risks are greatest, with 100 firings; `tools.campaigns.coverage requirements` has more cases."""
    met, not_met, _ = requirement(0.0, 15.0, 100, 1, 0.5)
    assert max(met, not_met) <= 0.05 + 2.0 * (0.05 * 0.95 / 100) ** 0.5
