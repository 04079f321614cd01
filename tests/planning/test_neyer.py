"""Neyer's procedure, against published levels and an independent implementation of its rules."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

from armour.planning.procedures import ShotSettings
from armour.planning.procedures import next_by_neyer as next_velocity
from armour.statistics.v50 import Shots

# The example of [Wu2014], as the documentation of the R package gonogo
# (Roediger, AFIT) lists it: levels, responses and, from the tenth on, the D-optimal levels that are recommended.
LEVELS = (5.5, 16.5, 11.0, 13.8, 10.1, 14.7, 10.4, 11.7, 9.7, 7.3, 7.8, 8.1, 12.2, 8.5, 11.8)
RESPONSES = tuple(map(bool, (0, 1, 0, 1, 0, 1, 1, 1, 1, 0, 0, 0, 1, 0, 1)))
RECOMMENDED = {9: 7.26438, 10: 7.75467, 11: 8.08350, 12: 12.16394, 13: 8.51676, 14: 11.82596}
SETTINGS = ShotSettings(11.0, 3.0, (0.0, 22.0))


@pytest.mark.parametrize("count", RECOMMENDED)
def test_the_published_d_optimal_levels(count: int):
    # The levels are searched in steps of a thousandth of the scatter.
    found = next_velocity(Shots(LEVELS[:count], RESPONSES[:count]), SETTINGS)
    assert found.velocity_m_s == pytest.approx(RECOMMENDED[count], abs=2e-3)


def shots(*fired: tuple[float, int]) -> Shots:
    return Shots(tuple(level for level, _ in fired), tuple(bool(result) for _, result in fired))


@pytest.mark.parametrize(
    ("fired", "expected"),
    [
        ([], 11.0),
        # All of one kind: the farthest of midway to the limit, two guesses of the scatter, and twice the range.
        ([(11, 0)], 17.0),
        ([(11, 0), (17, 0)], 23.0),
        ([(11, 0), (17, 0), (23, 0)], 35.0),
        ([(11, 1)], 5.0),
        ([(11, 1), (5, 1)], -1.0),
        # Apart by more than the guess: midway.
        ([(11, 0), (17, 1)], 14.0),
        ([(11, 0), (17, 1), (14, 1)], None),
    ],
)
def test_the_binary_search(fired: list[tuple[float, int]], expected: float | None):
    found = next_velocity(shots(*fired), SETTINGS)
    if expected is None:
        assert not found.why.startswith("binary search")
    else:
        assert found.velocity_m_s == expected


def test_separated_shots_reduce_the_guess_of_the_scatter():
    apart = [(11, 0), (17, 1), (13, 1)]
    assert "guessed scatter of 3.0" in next_velocity(shots(*apart), SETTINGS).why
    assert "guessed scatter of 2.4" in next_velocity(shots(*apart, (9, 0)), SETTINGS).why
    # 2 m/s apart is more than the guess after two reductions: the binary search again.
    assert next_velocity(shots(*apart, (9, 0), (18, 1)), SETTINGS).velocity_m_s == 12.0


def independent(levels: list[float], responses: list[bool], low: float, high: float, guess: float) -> float:
    """Neyer's rules, step by step with a running guess, by plain sums and searches."""
    x, y = np.array(levels), np.array(responses)
    for count in range(len(x) + 1):
        a, b = x[:count], y[:count]
        if count == 0:
            level = (low + high) / 2
        elif not b.any():
            level = max((high + a.max()) / 2, a.max() + 2 * guess, 2 * a.max() - a.min())
        elif b.all():
            level = min((low + a.min()) / 2, a.min() - 2 * guess, 2 * a.min() - a.max())
        else:
            gap = round(a[b].min() - a[~b].max(), 9)
            middle = (a[b].min() + a[~b].max()) / 2
            if gap > guess:
                level = middle
            elif gap >= 0:
                level, guess = _d_optimal(a, middle, min(guess, np.ptp(a))), 0.8 * guess
            else:
                level = np.nan if count < len(x) else _by_likelihood(a, b)
    return float(level)


def _by_likelihood(x: np.ndarray, y: np.ndarray) -> float:
    def lost(p: np.ndarray) -> float:
        z = p[0] + p[1] * x
        return -float(np.where(y, norm.logcdf(z), norm.logsf(z)).sum())

    b = 1.0 / np.std(x)
    intercept, slope = minimize(
        lost, [-b * x.mean(), b], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12}
    ).x
    mu, sigma = float(np.clip(-intercept / slope, x.min(), x.max())), min(1 / slope, np.ptp(x))
    return _d_optimal(x, mu, sigma)


def _d_optimal(x: np.ndarray, mu: float, sigma: float) -> float:
    """The level that makes the determinant of the information greatest, by determinants of 2 by 2 matrices."""

    def information(levels: np.ndarray) -> np.ndarray:
        z = (levels - mu) / sigma
        weight = norm.pdf(z) ** 2 / (norm.cdf(z) * norm.sf(z))
        rows = np.stack([np.ones_like(z), z])
        found: np.ndarray = np.einsum("in,jn,n->nij", rows, rows, weight)
        return found

    candidates = mu + sigma * np.linspace(-4, 4, 4001)
    totals = information(x).sum(axis=0) + information(candidates)
    return float(candidates[np.argmax(np.linalg.det(totals))])


def test_sequences_agree_with_an_independent_implementation():
    dice = np.random.default_rng(5)
    for _ in range(6):
        truth, scatter = dice.uniform(600, 900), dice.uniform(5, 40)
        fired = Shots((), ())
        for _ in range(12):
            settings = ShotSettings(750.0, 20.0, (600.0, 900.0))
            found = next_velocity(fired, settings).velocity_m_s
            levels, responses = list(fired.velocities_m_s), list(fired.complete)
            x, y = np.array(levels), np.array(responses)
            overlap = len(x) > 0 and 0 < sum(y) < len(y) and x[y].min() < x[~y].max()
            if not overlap or x[y].mean() > x[~y].mean():
                expected = independent(levels, responses, 600.0, 900.0, 20.0)
                assert found == pytest.approx(expected, abs=0.1)
            result = bool(dice.normal(truth, scatter) < found)
            fired = Shots((*fired.velocities_m_s, found), (*fired.complete, result))


def test_shots_without_a_rising_curve():
    flat = shots((10, 1), (14, 0), (9, 1), (15, 0))
    found = next_velocity(flat, SETTINGS)
    # After a partial penetration faster, by the best argument times the range.
    assert found.velocity_m_s == pytest.approx(12.0 + 1.31525757633905 * 6.0)


def test_a_shot_of_each_kind_at_one_velocity():
    assert np.isfinite(next_velocity(shots((11, 0), (11, 1)), SETTINGS).velocity_m_s)
