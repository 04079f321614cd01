"""Curves of penalised likelihood against closed forms, likelihoods evaluated point by point, and simulated firings."""

from math import log

import numpy as np
import pytest
from scipy.special import log_expit, log_ndtr
from scipy.stats import chi2

from armour.statistics.penalised_curve import fit_penalised, penalised_band
from armour.statistics.response_curve import LINKS, Z95, FittedCurve, Link, fit_curve
from tools.campaigns.coverage import simulate

CASES = {
    "mixed": ((700, 710, 720, 722), (715, 725, 730, 735)),
    "apart": ((700, 708, 715), (731, 740, 748)),
    "touching": ((700, 705, 710), (710, 715, 720)),
    "two": ((700.0,), (710.0,)),
    # The penalised likelihood has several maxima along some lines, and the last has two of all.
    "steep and flat": ((715.0,), (755.0, 720.0)),
    "pair": ((680.5, 720.0, 714.0), (719.8, 720.9, 737.4, 719.9, 726.3, 730.4, 741.0)),
    "near": (
        (688.83, 704.43, 709.88, 718.67, 691.16, 706.1, 719.65, 691.8, 709.24, 709.22, 711.44, 718.49, 719.02),
        (720.05, 739.08, 720.75, 720.82, 733.91, 725.27, 721.04),
    ),
}


def fitted(case: str, link: Link) -> FittedCurve:
    fit = fit_penalised(*CASES[case], link)
    assert fit is not None
    return fit


def likelihood(case: str, link: Link, slopes: np.ndarray, intercepts: np.ndarray) -> np.ndarray:
    """Logarithm of the penalised likelihood, with the Fisher information by its definition."""
    partial, complete = CASES[case]
    v, sign = np.array([*partial, *complete]) - 720.0, np.repeat([-1.0, 1.0], [len(partial), len(complete)])
    log_f = log_ndtr if link == "probit" else log_expit
    z = intercepts[..., None] + slopes[..., None] * v
    log_density = -0.5 * z**2 - 0.5 * log(2.0 * np.pi) if link == "probit" else log_f(z) + log_f(-z)
    weights = np.exp(2.0 * log_density - log_f(z) - log_f(-z))
    information = np.einsum("...n,in,jn->...ij", weights, *[np.stack([np.ones_like(v), v])] * 2)
    found: np.ndarray = log_f(sign * z).sum(-1) + 0.5 * np.linalg.slogdet(information)[1]
    return found


@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("case", CASES)
def test_the_maximum_and_the_ends_of_the_intervals(case: str, link: Link):
    """The greatest likelihood of curves with the value of an end is that much below the maximum."""
    fit = fitted(case, link)
    slopes = np.geomspace(1e-4, 20.0, 4000)
    top = likelihood(case, link, np.array(1.0 / fit.scale_m_s), np.array((720.0 - fit.v50_m_s) / fit.scale_m_s))
    everywhere = np.meshgrid(slopes[::40], np.linspace(640.0, 800.0, 300) - 720.0)
    assert likelihood(case, link, everywhere[0], -everywhere[0] * everywhere[1]).max() <= top + 1e-9
    depth = 0.5 * chi2.ppf(0.95, 1)
    quantiles = {-Z95[link]: fit.v05_interval_m_s, 0.0: fit.v50_interval_m_s, Z95[link]: fit.v95_interval_m_s}
    for z, ends in quantiles.items():
        for end in ends or ():
            if end is not None:
                profile = likelihood(case, link, slopes, z - slopes * (end - 720.0)).max()
                assert top - profile == pytest.approx(depth, abs=2e-3)
    for end in fit.scale_interval_m_s:
        if end is not None:
            places = np.linspace(550.0, 890.0, 20_000) - 720.0
            profile = likelihood(case, link, np.full(len(places), 1.0 / end), -places / end).max()
            assert top - profile == pytest.approx(depth, abs=2e-3)


def test_two_velocities_have_half_a_shot_more_of_each_kind():
    """With as many velocities as coefficients the logit's penalty adds half a shot to each count (Firth, 1993)."""
    fit = fit_penalised((700, 700, 710), (700, 710, 710, 710), "logit")
    assert fit is not None
    assert fit.probability(700.0) == pytest.approx(1.5 / 4.0, abs=1e-6)
    assert fit.probability(710.0) == pytest.approx(3.5 / 5.0, abs=1e-6)


@pytest.mark.parametrize("link", LINKS)
def test_shots_apart_have_a_curve(link: Link):
    fit = fitted("apart", link)
    for value, interval in (
        (fit.v05_m_s, fit.v05_interval_m_s),
        (fit.v50_m_s, fit.v50_interval_m_s),
        (fit.v95_m_s, fit.v95_interval_m_s),
        (fit.scale_m_s, fit.scale_interval_m_s),
    ):
        assert None not in (value, *(interval or [None]))
        assert interval[0] < value < interval[1]  # type: ignore[index, operator]
    assert fit.probability(fit.v95_m_s or 0.0) == pytest.approx(0.95)
    assert fit.log_likelihood < 0.0


def test_scale_and_shift():
    """Velocities times two and shifted: so is every velocity."""
    partial, complete = ([2.0 * v + 100.0 for v in kind] for kind in CASES["apart"])
    there = fit_penalised(partial, complete, "probit")
    here = fitted("apart", "probit")
    assert there is not None
    for key in ("v05_interval_m_s", "v50_interval_m_s", "v95_interval_m_s"):
        assert getattr(there, key) == pytest.approx([2.0 * v + 100.0 for v in getattr(here, key)], rel=1e-6)
    assert there.scale_interval_m_s == pytest.approx([2.0 * (v or 0.0) for v in here.scale_interval_m_s], rel=1e-5)


def test_no_end_is_below_zero():
    """The profile crosses the level at a negative velocity, which shots do not bound."""
    partial, complete = (8.0, 20.0, 31.0, 44.0, 55.0), (40.0, 62.0, 70.0, 85.0, 90.0)
    for found in (fit_curve(partial, complete, "probit"), fit_penalised(partial, complete, "probit")):
        assert found is not None
        ends = (*found.v50_interval_m_s, *(found.v05_interval_m_s or ()), *(found.v95_interval_m_s or ()))
        assert all(end is None or end > 0.0 for end in ends)
    shifted = fit_penalised([v + 700.0 for v in partial], [v + 700.0 for v in complete], "probit")
    assert shifted is not None
    assert shifted.v05_interval_m_s is not None
    assert 0.0 < (shifted.v05_interval_m_s[0] or 0.0) < 700.0


def test_a_curve_that_does_not_rise_is_none():
    assert fit_penalised((700.0, 740.0, 770.0, 780.0), (750.0,), "probit") is None


def test_a_v50_below_zero_is_none():
    assert fit_penalised((1.0,), (2.0, 3.0, 40.0, 60.0, 80.0), "probit") is None


@pytest.mark.parametrize("link", LINKS)
def test_the_band_at_one_half_is_the_interval_of_v50(link: Link):
    fit = fitted("apart", link)
    low, high = fit.v50_interval_m_s
    for end, edge in ((low, 1), (high, 0)):
        velocities = np.linspace((end or 0.0) - 5.0, (end or 0.0) + 5.0, 3).tolist()
        assert penalised_band(*CASES["apart"], link, velocities)[edge][1] == pytest.approx(0.5, abs=1e-5)


def test_intervals_of_few_shots_hold_what_they_say():
    """In 20 firings of 10 shots at least 90 %, which those of maximum likelihood do not reach."""
    found = simulate("up and down", 10, 20, seed=3)
    assert min(found[f"penalised likelihood: {name}"] for name in ("V50", "scale", "V05", "V95")) >= 18
    assert found["maximum likelihood: scale"] < 18
