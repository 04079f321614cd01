"""Prior and posterior of V50, against an independent quadrature."""

from csv import DictReader
from math import log

import numpy as np
import pytest
from scipy.stats import lognorm, norm, t

from armour.evidence.model_error import SCATTER_FACTOR, SCATTER_PERCENT, ModelError
from armour.statistics.posterior import FiringPrior, learned, posterior_of
from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow

PRIOR = FiringPrior(720.0, ModelError(-1.0, 7.0, 12.0))
VELOCITIES, COMPLETE = (722.0, 774.0, 745.0, 760.0, 745.0), (False, True, False, True, True)


def quadrature(velocities: tuple[float, ...], complete: tuple[bool, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A fixed, fine grid of V50 and of the scatter, and the weights on it from the densities of scipy.stats."""
    v50, ratio = np.linspace(300.0, 1200.0, 901)[:, None], np.geomspace(0.0002, 2.0, 601)
    density = t(12.0, loc=720.0 * 0.99, scale=720.0 * 0.07).pdf(v50) * lognorm(log(2.0), scale=0.02).pdf(ratio) * ratio
    for velocity, result in zip(velocities, complete, strict=True):
        curve = norm(v50, ratio * v50)
        density = density * (curve.cdf(velocity) if result else curve.sf(velocity))
    return v50[:, 0], v50 * ratio, density / density.sum()


@pytest.mark.parametrize("count", [0, 1, 5])
def test_mean_and_deviation_agree_with_a_quadrature(count: int):
    posterior = posterior_of(PRIOR, VELOCITIES[:count], COMPLETE[:count])
    v50, _, weights = quadrature(VELOCITIES[:count], COMPLETE[:count])
    mean = weights.sum(axis=1) @ v50
    deviation = (weights.sum(axis=1) @ (v50 - mean) ** 2) ** 0.5
    assert posterior.weights @ posterior.grid.v50_m_s == pytest.approx(mean, abs=0.2)
    assert posterior.estimate(0.95).standard_deviation_m_s == pytest.approx(deviation, rel=0.005)


def test_the_prior_is_the_models_limit_with_its_error():
    estimate = posterior_of(PRIOR, (), ()).estimate(0.95)
    assert estimate.v50_interval_m_s == pytest.approx(PRIOR.error.interval(720.0), abs=0.5)
    assert estimate.v50_m_s == pytest.approx(720.0 * 0.99, abs=0.1)
    assert estimate.scatter_m_s == pytest.approx(0.02 * estimate.v50_m_s, rel=0.02)


def test_a_prior_of_one_degree_of_freedom_ends_at_ten_times_the_limit():
    grid = posterior_of(FiringPrior(720.0, ModelError(0.0, 100.0, 1.0)), (), ()).grid
    assert grid.v50_m_s.max() == pytest.approx(7200.0)


def test_the_scatter_agrees_with_a_quadrature():
    _, scatter, weights = quadrature(VELOCITIES, COMPLETE)
    order = np.argsort(scatter.ravel())
    wanted = np.interp((0.025, 0.5, 0.975), np.cumsum(weights.ravel()[order]), scatter.ravel()[order])
    estimate = posterior_of(PRIOR, VELOCITIES, COMPLETE).estimate(0.95)
    low, high = estimate.scatter_interval_m_s
    assert (low, estimate.scatter_m_s, high) == pytest.approx(wanted, rel=0.02)


def test_many_shots_far_from_a_wide_prior_tell_the_scatter():
    dice = np.random.default_rng(1)
    velocities = dice.normal(1100.0, 5.0, 200)
    complete = dice.normal(1100.0, 3.0, 200) < velocities
    shots = (tuple(velocities.tolist()), tuple(complete.tolist()))
    estimate = posterior_of(FiringPrior(720.0, ModelError(0.0, 100.0, 1.0)), *shots).estimate(0.95)
    # Velocities of a tenth of the scatter apart.
    v50, scatter = np.linspace(1090.0, 1110.0, 201)[:, None], np.linspace(1.0, 8.0, 141)
    density = sum(
        norm.logcdf(sign * (velocity - v50) / scatter)
        for velocity, sign in zip(velocities, np.where(complete, 1, -1), strict=True)
    )
    likeliest = np.unravel_index(density.argmax(), density.shape)
    assert estimate.v50_m_s == pytest.approx(v50[likeliest[0], 0], abs=0.3)
    assert estimate.scatter_m_s == pytest.approx(scatter[likeliest[1]], rel=0.15)


def test_partial_penetrations_alone_leave_v50_open_above():
    velocities = (700.0, 730.0, 760.0, 800.0, 850.0, 900.0)
    estimate = posterior_of(PRIOR, velocities, (False,) * 6).estimate(0.999)
    # By a quadrature; the tails of Student's t reach far beyond the shots.
    assert estimate.v50_interval_m_s == pytest.approx((753.7, 1143.5), abs=1.5)


def test_many_shots_leave_the_prior_no_part():
    alone = posterior_of(PRIOR, (), ())
    dice = np.random.default_rng(1)
    velocities = dice.uniform(770.0, 830.0, 400)
    shots = posterior_of(PRIOR, tuple(velocities), tuple((dice.normal(800.0, 15.0, 400) < velocities).tolist()))
    _, estimate, share, _ = learned(alone, shots, 0.95)
    assert estimate.v50_m_s == pytest.approx(800.0, abs=4.0)
    assert estimate.scatter_m_s == pytest.approx(15.0, abs=4.0)
    assert share < 0.002
    assert learned(alone, alone, 0.95)[2] == 1.0


def test_the_probability_of_a_requirement():
    posterior = posterior_of(PRIOR, VELOCITIES, COMPLETE)
    low, high = posterior.estimate(0.9).v50_interval_m_s
    assert posterior.probability_above(low, 0.5) == pytest.approx(0.95, abs=0.005)
    assert posterior.probability_above(high, 0.5) == pytest.approx(0.05, abs=0.005)
    # Fewer shots may perforate at V05 than at V50.
    assert posterior.probability_above(low, 0.05) < 0.9


def test_the_prior_of_the_scatter_is_wider_than_the_published_scatter_of_plates():
    with (SCENARIOS / "tests" / "plates.csv").open() as file:
        rows = [(row["standard_deviation_m_s"], row["ballistic_limit_m_s"]) for row in DictReader(file)]
    percent = np.array([100.0 * float(sd) / float(v50) for sd, v50 in rows if sd and float(sd) > 0.0])
    assert len(percent) == 525
    assert np.median(percent) == pytest.approx(1.06, abs=0.01)
    assert np.exp(np.log(percent).std()) == pytest.approx(1.72, abs=0.01)
    assert np.quantile(percent, (0.05, 0.95)) == pytest.approx((0.50, 2.67), abs=0.02)
    assert np.exp(np.log(percent).std()) < SCATTER_FACTOR
    assert np.median(percent) < SCATTER_PERCENT


def test_heavy_tails_and_tiny_errors_have_a_posterior():
    for error in (ModelError(0.0, 100.0, 1.0), ModelError(0.0, 1e-3, 1e6), ModelError(1000.0, 5.0, 2.0)):
        estimate = posterior_of(FiringPrior(720.0, error), (700.0, 710.0), (True, False)).estimate(0.95)
        low, high = estimate.v50_interval_m_s
        assert 0.0 < low <= estimate.v50_m_s <= high < np.inf
