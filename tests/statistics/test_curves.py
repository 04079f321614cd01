"""Curves of plain and penalised likelihood against closed forms and likelihoods point by point.

How often their intervals hold the truth, `tools.campaigns.coverage` counts.
"""

from math import log

import numpy as np
import pytest
from scipy.special import log_expit, log_ndtr
from scipy.stats import chi2

from armour.errors import NoAnswerError
from armour.statistics.curves import CDFS, Z95, FittedCurve, Link, ShotLikelihood, fit_curve, penalised_band
from tests.helpers.known import known

pytestmark = pytest.mark.slow

Shots = tuple[tuple[float, ...], tuple[float, ...]]
MIXED: Shots = ((700, 710, 720, 722), (715, 725, 730, 735))
APART: Shots = ((700, 708, 715), (731, 740, 748))
CASES: dict[str, Shots] = {
    "mixed": MIXED,
    "apart": APART,
    "touching": ((700, 705, 710), (710, 715, 720)),
    "two": ((700.0,), (710.0,)),
    # The penalised likelihood has several maxima along some lines, and the last has two of all.
    "steep and flat": ((715.0,), (755.0, 720.0)),
    "pair": ((680.5, 720.0, 714.0), (719.8, 720.9, 737.4, 719.9, 726.3, 730.4, 741.0)),
}
links = pytest.mark.parametrize("link", CDFS)


def fitted(shots: Shots, link: Link, *, penalised: bool = False) -> FittedCurve:
    return known(fit_curve(*shots, link, penalised=penalised))


def likelihood(
    shots: Shots,
    link: Link,
    slopes: np.ndarray,
    intercepts: np.ndarray,
    *,
    penalised: bool,
    nearby: tuple[float, float] = (-np.inf, np.inf),
) -> np.ndarray:
    """Logarithm of the likelihood, with the Fisher information of the penalty by its definition.

    In the penalty, velocities are clipped to the range `nearby`.
    """
    partial, complete = shots
    v, sign = np.array([*partial, *complete]) - 720.0, np.repeat([-1.0, 1.0], [len(partial), len(complete)])
    log_f = log_ndtr if link == "probit" else log_expit
    z = intercepts[..., None] + slopes[..., None] * v
    log_likelihoods: np.ndarray = log_f(sign * z).sum(-1)
    if penalised:
        v = (v + 720.0).clip(*nearby) - 720.0
        z = intercepts[..., None] + slopes[..., None] * v
        log_density = -0.5 * z**2 - 0.5 * log(2.0 * np.pi) if link == "probit" else log_f(z) + log_f(-z)
        weights = np.exp(2.0 * log_density - log_f(z) - log_f(-z))
        information = np.einsum("...n,in,jn->...ij", weights, *[np.stack([np.ones_like(v), v])] * 2)
        log_likelihoods = log_likelihoods + 0.5 * np.linalg.slogdet(information)[1]
    return log_likelihoods


@links
@pytest.mark.parametrize("case", CASES)
def test_the_maximum_and_the_ends_of_penalised_intervals(case: str, link: Link):
    """The greatest likelihood of curves with the value of an end is that much below the maximum."""
    shots = CASES[case]
    fit = fitted(shots, link, penalised=True)

    def log_likelihood(slopes: np.ndarray, intercepts: np.ndarray) -> np.ndarray:
        return likelihood(shots, link, slopes, intercepts, penalised=True)

    slopes = np.geomspace(1e-4, 20.0, 1600)
    top = log_likelihood(np.array(1.0 / fit.scale_m_s), np.array((720.0 - fit.v50_m_s) / fit.scale_m_s))
    everywhere = np.meshgrid(slopes[::16], np.linspace(640.0, 800.0, 150) - 720.0)
    assert log_likelihood(everywhere[0], -everywhere[0] * everywhere[1]).max() <= top + 1e-9
    depth = 0.5 * chi2.ppf(0.95, 1)
    quantiles = {-Z95[link]: fit.v05_interval_m_s, 0.0: fit.v50_interval_m_s, Z95[link]: fit.v95_interval_m_s}
    profiles = [
        log_likelihood(slopes, z - slopes * (end - 720.0)) for z, ends in quantiles.items() for end in ends or () if end
    ]
    places = np.linspace(550.0, 890.0, 8_000) - 720.0
    profiles += [
        log_likelihood(np.full(len(places), 1.0 / end), -places / end) for end in fit.scale_interval_m_s if end
    ]
    assert [top - profile.max() for profile in profiles] == pytest.approx([depth] * len(profiles), abs=2e-3)


# A far shot gives the penalised likelihood two maxima; of the second shots, the wider curve is the likelier one.
FAR: Shots = ((338.1, 638.3, 647.0, 648.2, 655.0, 656.3, 661.9), (638.5, 665.0, 668.3, 668.8, 680.7))
WIDE: Shots = ((514.0, 653.2, 700.9, 703.9, 705.3), (696.4, 710.7, 715.5, 719.4, 737.4))


@pytest.mark.parametrize(("shots", "low", "high"), [(FAR, 638.3, 668.8), (WIDE, 653.2, 719.4)])
def test_the_likelier_of_two_maxima_is_recommended(shots: Shots, low: float, high: float):
    """`low` and `high` are the second slowest and the second fastest shot; shots count as at most 2 spans from them."""
    fit = fitted(shots, "probit", penalised=True)
    nearby = low - 2.0 * (high - low), high + 2.0 * (high - low)

    def log_likelihood(v50s: np.ndarray, scales: np.ndarray) -> np.ndarray:
        return likelihood(shots, "probit", 1.0 / scales, (720.0 - v50s) / scales, penalised=True, nearby=nearby)

    top = float(log_likelihood(np.array(fit.v50_m_s), np.array(fit.scale_m_s)))
    everywhere = np.meshgrid(np.linspace(600.0, 760.0, 161), np.geomspace(0.5, 5000.0, 300))
    assert log_likelihood(*everywhere).max() == pytest.approx(top, abs=5e-3)
    assert log_likelihood(*everywhere).max() < top


@links
@pytest.mark.parametrize("case", ["mixed", "apart"])
def test_a_one_sided_bound_is_the_end_of_an_interval_with_twice_the_probability_beyond(case: str, link: Link):
    one_sided, two_sided = (fit_curve(*CASES[case], link, confidence, penalised=True) for confidence in (0.95, 0.9))
    assert one_sided is not None
    assert two_sided is not None
    assert (one_sided.v50_lower_m_s, one_sided.v05_lower_m_s) == (
        two_sided.v50_interval_m_s[0],
        known(two_sided.v05_interval_m_s)[0],
    )


@links
@pytest.mark.parametrize("case", ["mixed", "apart", "touching unevenly"])
def test_a_plain_fit_agrees_with_a_search_point_by_point(case: str, link: Link):
    # Of two partial and one complete at one velocity a step with a third there is likelier than one with a half.
    uneven: Shots = ((700, 720, 720), (720, 740, 750))
    shots = {"mixed": MIXED, "apart": APART, "touching unevenly": uneven}[case]
    fit = fitted(shots, link)
    locations, scales = np.arange(660.0, 780.0, 0.1), np.geomspace(1e-1, 1e4, 600)
    all_of_them = likelihood(shots, link, 1.0 / scales, -(locations[:, None] - 720.0) / scales, penalised=False)
    assert fit.log_likelihood == pytest.approx(all_of_them.max(), abs=2e-3)
    inside = all_of_them >= fit.log_likelihood - 0.5 * chi2.ppf(0.95, 1)
    within = locations[inside.any(axis=1)]
    assert fit.v50_interval_m_s == pytest.approx((within[0], within[-1]), abs=0.11)
    widths = scales[inside.any(axis=0)]
    narrowest, widest = fit.scale_interval_m_s
    assert widest == pytest.approx(widths[-1], rel=0.021)
    assert narrowest == pytest.approx(widths[0], rel=0.021) if narrowest else widths[0] == scales[0]


@links
def test_shots_apart(link: Link):
    """By the plain likelihood a step in the middle of the gap, and by the penalised one a curve."""
    fit = fitted(APART, link)
    assert (fit.v50_m_s, fit.scale_m_s, fit.log_likelihood) == (723.0, 0.0, 0.0)
    low, high = fit.v50_interval_m_s
    assert 690.0 < (low or 0.0) < 715.0 < 731.0 < (high or 0.0) < 760.0
    assert (fit.v05_m_s, fit.v95_m_s, fit.scale_interval_m_s[0]) == (None, None, 0.0)
    assert [fit.probability(v) for v in (722.9, 723.0, 723.1)] == [0.0, 0.5, 1.0]
    fit = fitted(APART, link, penalised=True)
    for value, interval in (
        (fit.v05_m_s, fit.v05_interval_m_s),
        (fit.v50_m_s, fit.v50_interval_m_s),
        (fit.v95_m_s, fit.v95_interval_m_s),
        (fit.scale_m_s, fit.scale_interval_m_s),
    ):
        assert None not in (value, *(interval or [None]))
        assert interval[0] < value < interval[1]  # type: ignore[index, operator]
    assert fit.probability(fit.v95_m_s or 0.0) == pytest.approx(0.95)


def test_shots_that_touch():
    fit = fitted(CASES["touching"], "probit")
    assert (fit.v50_m_s, fit.scale_m_s) == (710.0, 0.0)
    assert fit.log_likelihood == pytest.approx(2 * log(0.5))


def test_how_far_a_far_shot_is_does_not_matter():
    """The penalty does not grow with the distance of a shot that says nothing, until no interval is bounded."""
    partial, complete = (700.0, 720.0, 728.0, 735.0), (725.0, 752.0, 760.0, 771.0)
    far, farther = (ShotLikelihood((slow, *partial), complete, "probit", penalised=True) for slow in (500.0, 100.0))
    assert far.flat_deviance == pytest.approx(farther.flat_deviance, abs=1e-3)
    assert far.flat_deviance > 3.0


@links
def test_a_probability_at_the_end_of_the_interval_of_a_velocity_has_that_fraction_as_an_end(link: Link):
    shots = ShotLikelihood(*APART, link, penalised=True)
    for z in (-Z95[link], 0.0, 1.0):
        low, high = shots.velocity_interval(z, 0.95)
        for end, edge in ((low, 1), (high, 0)):
            assert shots.probability_interval(end or 0.0, 0.95)[edge] == pytest.approx(CDFS[link](z), abs=1e-5)


def test_few_shots_do_not_bound():
    fit = fitted(CASES["two"], "logit")
    assert (fit.v50_interval_m_s, fit.scale_interval_m_s) == ((None, None), (0.0, None))


def test_two_velocities_have_half_a_shot_more_of_each_kind():
    """With as many velocities as coefficients the logit's penalty adds half a shot to each count (Firth, 1993)."""
    fit = fitted(((700, 700, 710), (700, 710, 710, 710)), "logit", penalised=True)
    assert fit.probability(700.0) == pytest.approx(1.5 / 4.0, abs=1e-6)
    assert fit.probability(710.0) == pytest.approx(3.5 / 5.0, abs=1e-6)


@pytest.mark.parametrize("penalised", [False, True])
def test_scale_and_shift(penalised: bool):
    """Velocities times two and shifted: so is every velocity."""
    shots = APART if penalised else MIXED
    partial, complete = (tuple(2.0 * v + 100.0 for v in kind) for kind in shots)
    here, there = (fitted(each, "probit", penalised=penalised) for each in (shots, (partial, complete)))
    assert there.v50_m_s == pytest.approx(2.0 * here.v50_m_s + 100.0, rel=1e-6)
    assert there.v50_interval_m_s == pytest.approx([2.0 * (v or 0.0) + 100.0 for v in here.v50_interval_m_s], rel=1e-6)
    assert there.scale_interval_m_s == pytest.approx([2.0 * (v or 0.0) for v in here.scale_interval_m_s], rel=1e-5)


def test_no_end_is_below_zero():
    """Where the profile crosses the level at a negative velocity only, the shots bound none."""
    fit = fitted(((60.0,), (160.0, 230.0, 270.0, 280.0, 290.0, 330.0, 350.0)), "probit")
    low, high = fit.v50_interval_m_s
    assert low is None
    assert high == pytest.approx(196.8, abs=0.1)
    shots: Shots = ((8.0, 20.0, 31.0, 44.0, 55.0), (40.0, 62.0, 70.0, 85.0, 90.0))
    fit = fitted(shots, "probit", penalised=True)
    ends = (*fit.v50_interval_m_s, *(fit.v05_interval_m_s or ()), *(fit.v95_interval_m_s or ()))
    assert all(end is None or end > 0.0 for end in ends)
    partial, complete = (tuple(v + 700.0 for v in kind) for kind in shots)
    [low, _] = fitted((partial, complete), "probit", penalised=True).v05_interval_m_s or (None, None)
    assert 0.0 < (low or 0.0) < 700.0


def test_a_penalised_curve_that_does_not_rise_or_whose_v50_is_negative_is_none():
    assert fit_curve((700.0, 740.0, 770.0, 780.0), (750.0,), "probit", penalised=True) is None
    assert fit_curve((1.0,), (2.0, 3.0, 40.0, 60.0, 80.0), "probit", penalised=True) is None


def test_faster_shots_that_perforate_less_often():
    with pytest.raises(NoAnswerError, match="no V50: the complete penetrations were no faster"):
        fit_curve((710.0,), (700.0,), "probit")


@links
def test_the_band_at_one_half_is_the_interval_of_v50(link: Link):
    low, high = fitted(APART, link, penalised=True).v50_interval_m_s
    for end, edge in ((low, 1), (high, 0)):
        velocities = np.linspace((end or 0.0) - 5.0, (end or 0.0) + 5.0, 3).tolist()
        assert penalised_band(*APART, link, velocities)[edge][1] == pytest.approx(0.5, abs=1e-5)
