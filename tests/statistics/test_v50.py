"""V50 against examples worked out by hand and likelihoods looked through point by point."""

from math import log
from pathlib import Path

import numpy as np
import pytest
from scipy.special import log_expit, log_ndtr
from scipy.stats import chi2

from armour.errors import InputError, NoAnswerError
from armour.statistics.v50 import LINKS, FittedCurve, Link, Shots, fit_curve, mean_v50, read_shots, v50
from tests.helpers.cases import scenario

MIXED = Shots((700, 710, 715, 720, 725, 730, 722, 735), (False, False, True, False, True, True, False, True))
APART = Shots((700, 708, 715, 731, 740, 748), (False, False, False, True, True, True))


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
    fit = fit_curve(shots, link)
    locations, scales = np.linspace(640.0, 810.0, 1701), np.geomspace(1e-2, 1e4, 700)
    all_of_them = brute(shots, link, locations, scales)
    top = all_of_them.max()
    assert fit.log_likelihood == pytest.approx(top, abs=2e-3)
    inside = all_of_them >= fit.log_likelihood - 0.5 * chi2.ppf(0.95, 1)
    found = locations[inside.any(axis=1)]
    assert fit.v50_interval_m_s == pytest.approx((found[0], found[-1]), abs=0.11)
    widths = scales[inside.any(axis=0)]
    low, high = fit.scale_interval_m_s
    assert high == pytest.approx(widths[-1], rel=0.021)
    assert low == pytest.approx(widths[0], rel=0.021) if low else widths[0] == scales[0]


def interval(fit: FittedCurve) -> tuple[float, float]:
    """Interval of a V50 that the shots bound."""
    low, high = fit.v50_interval_m_s
    assert low is not None
    assert high is not None
    return low, high


def test_symmetrical_shots_have_their_centre_as_v50():
    shots = Shots((690, 700, 705, 715, 720, 730), (False, True, False, True, False, True))
    for fit in v50(shots).fits:
        assert fit.v50_m_s == pytest.approx(710.0, abs=1e-6)
        low, high = fit.v50_interval_m_s
        assert low is None or high is None or low + high == pytest.approx(1420.0, abs=1e-4)


def test_shots_apart_have_a_finite_interval_beyond_the_gap():
    result = v50(APART)
    assert result.separated
    for fit in result.fits:
        assert (fit.v50_m_s, fit.scale_m_s, fit.log_likelihood) == (723.0, 0.0, 0.0)
        low, high = interval(fit)
        assert 690.0 < low < 715.0 < 731.0 < high < 760.0
        assert fit.scale_interval_m_s[0] == 0.0
        assert 5.0 < (fit.scale_interval_m_s[1] or 0.0) < 100.0
        assert [fit.probability(v) for v in (722.9, 723.0, 723.1)] == [0.0, 0.5, 1.0]


def test_shots_that_touch():
    fit = fit_curve(Shots((700, 705, 710, 710, 715, 720), (False, False, False, True, True, True)), "probit")
    assert (fit.v50_m_s, fit.scale_m_s) == (710.0, 0.0)
    assert fit.log_likelihood == pytest.approx(2 * log(0.5))


def test_shots_that_touch_unevenly():
    """Two partial and one complete at one velocity: a step with a third there is likelier than one with a half."""
    shots = Shots((800, 820, 820, 820, 840, 850), (False, False, False, True, True, True))
    fit = fit_curve(shots, "logit")
    assert fit.log_likelihood == pytest.approx(log(4.0 / 27.0))
    locations, scales = np.linspace(740.0, 900.0, 3201), np.geomspace(1e-2, 1e3, 400)
    all_of_them = brute(shots, "logit", locations, scales)
    assert all_of_them.max() == pytest.approx(fit.log_likelihood, abs=1e-3)
    inside = locations[(all_of_them >= fit.log_likelihood - 0.5 * chi2.ppf(0.95, 1)).any(axis=1)]
    assert interval(fit) == pytest.approx((inside[0], inside[-1]), abs=0.06)


def test_few_shots_do_not_bound():
    fit = fit_curve(Shots((700.0, 710.0), (False, True)), "logit")
    assert fit.v50_interval_m_s == (None, None)
    assert fit.scale_interval_m_s == (0.0, None)


def test_scale_and_shift():
    """Velocities times two and shifted: so are V50, scale and their intervals."""
    there = fit_curve(Shots(tuple(2.0 * v + 100.0 for v in MIXED.velocities_m_s), MIXED.complete), "probit")
    here = fit_curve(MIXED, "probit")
    assert there.v50_m_s == pytest.approx(2.0 * here.v50_m_s + 100.0, rel=1e-6)
    assert there.v50_interval_m_s == pytest.approx([2.0 * v + 100.0 for v in interval(here)], rel=1e-6)
    assert there.scale_interval_m_s == pytest.approx([2.0 * (v or 0.0) for v in here.scale_interval_m_s], rel=1e-5)


def test_intervals_hold_what_they_say():
    """Coverage of 95 %, within the scatter of 200 firings of 60 shots."""
    rng, inside = np.random.default_rng(11), 0
    for _ in range(200):
        velocities = rng.uniform(690.0, 750.0, 60)
        shots = Shots(tuple(velocities.tolist()), tuple((rng.normal(720.0, 10.0, 60) < velocities).tolist()))
        low, high = fit_curve(shots, "probit").v50_interval_m_s
        inside += (low or 0.0) <= 720.0 <= (high or 9e9)
    assert 181 <= inside <= 198


def test_the_mean_of_mil_std_662f_by_hand():
    mean = mean_v50(MIXED)
    assert mean is not None
    # Highest partial 722, 720, 710; lowest complete 715, 725, 730.
    assert mean.v50_m_s == pytest.approx((722 + 720 + 710 + 715 + 725 + 730) / 6)
    assert (mean.pairs, mean.span_m_s, mean.span_allowed_m_s) == (3, 20.0, 27.4)
    two = mean_v50(MIXED, pairs=2)
    assert two is not None
    assert (two.v50_m_s, two.span_m_s) == ((722 + 720 + 715 + 725) / 4, 10.0)
    assert mean_v50(MIXED, pairs=4) is not None
    assert mean_v50(MIXED, pairs=4, span_m_s=30.0) is None
    assert mean_v50(MIXED, pairs=5) is None
    assert mean_v50(APART) is None


def test_the_models_limit_beside_it():
    assert v50(MIXED, scenario()).model_ballistic_limit_m_s == pytest.approx(723.77, abs=0.02)
    assert v50(MIXED).model_ballistic_limit_m_s is None


def test_faster_shots_that_perforate_less_often():
    with pytest.raises(NoAnswerError, match="no V50: the complete penetrations were no faster"):
        v50(Shots((700.0, 710.0), (True, False)))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("700,partial", "result: must have at least one partial and one complete penetration, found only partial ones"),
        ("700,complete\n710,complete", "found only complete ones"),
        ("700,part\n710,complete", 'line 2: result: must be "partial" or "complete", found "part"'),
        (",partial\n710,complete", "line 2: velocity_m_s: must be at least 1 and at most 10000"),
        ("-700,partial\n710,complete", "line 2: velocity_m_s: must be at least 1 and at most 10000"),
    ],
)
def test_wrong_shots(tmp_path: Path, rows: str, message: str):
    path = tmp_path / "shots.csv"
    path.write_text(f"velocity_m_s,result\n{rows}\n")
    with pytest.raises(InputError) as error:
        read_shots(path)
    assert message in str(error.value)
