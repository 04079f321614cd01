"""What own tests tell of the ballistic limits of other armours: by hand, and by simulated tests."""

from math import log

import numpy as np
import pytest
from scipy.stats import norm

from armour.statistics.own_tests import MEDIAN, TESTED, Measured, evidence_of
from tools.campaigns.own_tests import CASES, simulate, wilkins

pytestmark = pytest.mark.slow


def linear(slope: float) -> "np.ufunc":
    """A limit in proportion to a power of the flow stress."""
    return lambda log_stress: log(700.0) + slope * (log_stress - log(5.0))  # type: ignore[return-value]


def test_one_limit_that_is_linear_by_hand():
    """Given the error, the posterior of two normal distributions."""
    measured = Measured(np.array([log(770.0)]), np.zeros(1), np.zeros(1), [linear(0.6)])
    [found] = evidence_of(measured, [None], log(5.0), TESTED)
    precision = 1.0 / TESTED**2 + (0.6 / found.scales) ** 2
    mean = log(5.0) + 0.6 * log(1.1) / found.scales**2 / precision
    # The last nodes of the error have nearly no weight, and the grid is made for the others.
    assert found.means[:6, 0] == pytest.approx(mean[:6], abs=1e-3)
    assert found.covariances[:6, 0, 0] == pytest.approx(1.0 / precision[:6], rel=0.02)
    width = np.sqrt(found.scales**2 + (0.6 * TESTED) ** 2)
    weights = norm.pdf(log(1.1) / width) / width * norm.pdf(np.linspace(-2.1, 2.1, 8))
    assert found.weights == pytest.approx(weights / weights.sum(), rel=0.01)
    assert found.slope == pytest.approx(0.6)


def test_an_exponent_that_no_test_determines_has_its_prior():
    measured = Measured(np.full(2, log(700.0)), np.zeros(2), np.zeros(2), [linear(0.6)] * 2)
    _, found = evidence_of(measured, [None, np.zeros(2)], log(5.0), TESTED)
    assert found.means[2:5, 1] == pytest.approx([0.33] * 3, abs=1e-3)
    assert found.covariances[2:5, 1, 1] == pytest.approx([0.15**2] * 3, rel=0.02)
    assert found.weights.sum() == pytest.approx(0.5, abs=0.01)


def test_a_shot_bounds_the_flow_stress_on_its_side():
    sides = np.array([1.0, 1.0])
    measured = Measured(np.log([760.0, 800.0]), sides, np.full(2, 0.01), [linear(0.6)] * 2)
    [above] = evidence_of(measured, [None], log(5.0), 0.4)
    [below] = evidence_of(measured._replace(sides=-sides), [None], log(5.0), 0.4)
    assert above.mean[0] > log(5.0) + log(800.0 / 700.0) / 0.6 > log(5.0) > below.mean[0]


def test_repeats_do_not_make_the_error_of_other_armours_small():
    """Two armours tested twice, without scatter: a law is not known to hold better than it is expected to (D6)."""
    curves = [linear(0.6)] * 4
    values = np.log([700.0, 700.0, 720.0, 720.0])
    found = evidence_of(Measured(values, np.zeros(4), np.zeros(4), curves), [None], log(5.0), TESTED)
    spread = sum(float(one.weights @ one.scales) for one in found)
    assert spread > 0.25 * MEDIAN


@pytest.mark.parametrize(("own", "rms"), [(1, 0.06), (2, 0.045), (3, 0.03)])
def test_tests_of_a_series_of_wilkins_predict_the_others_of_it(own: int, rms: float):
    found = wilkins(own)
    assert found.held.mean() >= 0.95
    assert np.mean(found.errors**2) ** 0.5 < rms


NAMES = ("1 tests", "6 tests", "two armours twice", "one back plate", "6 tests, other exponents")


@pytest.mark.parametrize("name", NAMES)
def test_intervals_hold_the_limits_of_armours_inside_the_tests_thinner_and_thicker(name: str):
    """At least 90 % of them, with 40 simulations of each case; `tools.campaigns.own_tests` makes 400 of more cases."""
    case = next(case for case in CASES if case.name == name)
    for found in simulate(case, 40, seed=2).values():
        assert found.held.mean() >= 0.9
        assert found.above.mean() >= 0.85
