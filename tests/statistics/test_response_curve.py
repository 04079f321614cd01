"""Curves of probability against likelihoods evaluated point by point."""

from math import log

import numpy as np
import pytest
from scipy.special import log_expit, log_ndtr
from scipy.stats import chi2

from armour.errors import NoAnswerError
from armour.statistics.response_curve import LINKS, FittedCurve, Link, fit_curve
from armour.statistics.v50 import Shots

MIXED = Shots((700, 710, 715, 720, 725, 730, 722, 735), (False, False, True, False, True, True, False, True))
APART = Shots((700, 708, 715, 731, 740, 748), (False, False, False, True, True, True))


def curve(shots: Shots, link: Link) -> FittedCurve:
    return fit_curve(shots.of(complete=False), shots.of(complete=True), link)


def many_shots() -> Shots:
    """Forty shots of a logistic curve of V50 720 m/s and scale 12 m/s."""
    velocities = np.linspace(650, 800, 40)
    complete = np.random.default_rng(5).random(40) < 1 / (1 + np.exp(-(velocities - 720) / 12))
    return Shots(tuple(velocities.tolist()), tuple(complete.tolist()))


def brute(shots: Shots, link: Link, locations: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Logarithm of the likelihood, (locations, scales)."""
    v, sign = np.array(shots.velocities_m_s), np.where(shots.complete, 1.0, -1.0)
    log_cdf = log_ndtr if link == "probit" else log_expit
    z = sign * (v - locations[:, None, None]) / scales[:, None]
    found: np.ndarray = log_cdf(z).sum(axis=2)
    return found


@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("kind", ["mixed", "apart", "many"])
def test_a_fit_agrees_with_a_search_point_by_point(kind: str, link: Link):
    shots = {"mixed": MIXED, "apart": APART}.get(kind) or many_shots()
    fit = curve(shots, link)
    low, high = (690.0, 750.0) if kind == "many" else (640.0, 810.0)
    locations, scales = np.arange(low, high, 0.1), np.geomspace(1e-2, 1e4, 700)
    all_of_them = brute(shots, link, locations, scales)
    top = all_of_them.max()
    assert fit.log_likelihood == pytest.approx(top, abs=2e-3)
    inside = all_of_them >= fit.log_likelihood - 0.5 * chi2.ppf(0.95, 1)
    found = locations[inside.any(axis=1)]
    assert fit.v50_interval_m_s == pytest.approx((found[0], found[-1]), abs=0.11)
    widths = scales[inside.any(axis=0)]
    narrowest, widest = fit.scale_interval_m_s
    assert widest == pytest.approx(widths[-1], rel=0.021)
    assert narrowest == pytest.approx(widths[0], rel=0.021) if narrowest else widths[0] == scales[0]


def interval(fit: FittedCurve) -> tuple[float, float]:
    """Interval of a V50 that the shots bound."""
    low, high = fit.v50_interval_m_s
    assert low is not None
    assert high is not None
    return low, high


@pytest.mark.parametrize("link", LINKS)
def test_symmetrical_shots_have_their_centre_as_v50(link: Link):
    fit = curve(Shots((690, 700, 705, 715, 720, 730), (False, True, False, True, False, True)), link)
    assert fit.v50_m_s == pytest.approx(710.0, abs=1e-6)
    low, high = fit.v50_interval_m_s
    assert low is None or high is None or low + high == pytest.approx(1420.0, abs=1e-4)


@pytest.mark.parametrize("link", LINKS)
def test_shots_apart_have_a_finite_interval_beyond_the_gap(link: Link):
    fit = curve(APART, link)
    assert (fit.v50_m_s, fit.scale_m_s, fit.log_likelihood) == (723.0, 0.0, 0.0)
    low, high = interval(fit)
    assert 690.0 < low < 715.0 < 731.0 < high < 760.0
    assert fit.scale_interval_m_s[0] == 0.0
    assert 5.0 < (fit.scale_interval_m_s[1] or 0.0) < 100.0
    assert [fit.probability(v) for v in (722.9, 723.0, 723.1)] == [0.0, 0.5, 1.0]


def test_shots_that_touch():
    fit = curve(Shots((700, 705, 710, 710, 715, 720), (False, False, False, True, True, True)), "probit")
    assert (fit.v50_m_s, fit.scale_m_s) == (710.0, 0.0)
    assert fit.log_likelihood == pytest.approx(2 * log(0.5))


def test_shots_that_touch_unevenly():
    """Two partial and one complete at one velocity: a step with a third there is likelier than one with a half."""
    shots = Shots((800, 820, 820, 820, 840, 850), (False, False, False, True, True, True))
    fit = curve(shots, "logit")
    assert fit.log_likelihood == pytest.approx(log(4.0 / 27.0))
    locations, scales = np.linspace(740.0, 900.0, 3201), np.geomspace(1e-2, 1e3, 400)
    all_of_them = brute(shots, "logit", locations, scales)
    assert all_of_them.max() == pytest.approx(fit.log_likelihood, abs=1e-3)
    inside = locations[(all_of_them >= fit.log_likelihood - 0.5 * chi2.ppf(0.95, 1)).any(axis=1)]
    assert interval(fit) == pytest.approx((inside[0], inside[-1]), abs=0.06)


def test_few_shots_do_not_bound():
    fit = curve(Shots((700.0, 710.0), (False, True)), "logit")
    assert fit.v50_interval_m_s == (None, None)
    assert fit.scale_interval_m_s == (0.0, None)


def test_scale_and_shift():
    """Velocities times two and shifted: so are V50, scale and their intervals."""
    there = curve(Shots(tuple(2.0 * v + 100.0 for v in MIXED.velocities_m_s), MIXED.complete), "probit")
    here = curve(MIXED, "probit")
    assert there.v50_m_s == pytest.approx(2.0 * here.v50_m_s + 100.0, rel=1e-6)
    assert there.v50_interval_m_s == pytest.approx([2.0 * v + 100.0 for v in interval(here)], rel=1e-6)
    assert there.scale_interval_m_s == pytest.approx([2.0 * (v or 0.0) for v in here.scale_interval_m_s], rel=1e-5)


def test_intervals_hold_what_they_say():
    """Coverage of 95 %, within the scatter of 100 firings of 60 shots."""
    rng, inside = np.random.default_rng(11), 0
    for _ in range(100):
        velocities = rng.uniform(690.0, 750.0, 60)
        shots = Shots(tuple(velocities.tolist()), tuple((rng.normal(720.0, 10.0, 60) < velocities).tolist()))
        low, high = curve(shots, "probit").v50_interval_m_s
        inside += (low or 0.0) <= 720.0 <= (high or 9e9)
    assert 88 <= inside <= 99


@pytest.mark.parametrize("link", LINKS)
def test_the_velocities_of_5_and_95_percent(link: Link):
    fit = curve(MIXED, link)
    assert [fit.probability(v or 0.0) for v in (fit.v05_m_s, fit.v95_m_s)] == pytest.approx([0.05, 0.95])
    step = curve(APART, link)
    assert (step.v05_m_s, step.v95_m_s) == (None, None)


def test_no_end_is_below_zero():
    """The likelihood falls below the level at a negative velocity only: the shots bound no velocity."""
    fit = fit_curve((60.0,), (160.0, 230.0, 270.0, 280.0, 290.0, 330.0, 350.0), "probit")
    low, high = fit.v50_interval_m_s
    assert low is None
    assert high == pytest.approx(196.8, abs=0.1)


def test_faster_shots_that_perforate_less_often():
    with pytest.raises(NoAnswerError, match="no V50: the complete penetrations were no faster"):
        curve(Shots((700.0, 710.0), (True, False)), "probit")
