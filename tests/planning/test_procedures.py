"""Rules for the next velocity: by hand, against published levels and against independent implementations."""

from itertools import product
from math import prod

import numpy as np
import pytest

from armour.evidence.model_error import ModelError
from armour.planning.procedures import (
    FUTURE_NODES,
    Firings,
    ShotSettings,
    expected_shots,
    gains,
    next_bayesian,
    next_by_langlie,
    next_by_neyer,
    next_up_and_down,
    posterior,
    stopped,
    stopped_bayesian,
    stopped_up_and_down,
)
from armour.statistics.posterior import GRID_NODES, FiringPrior, Posterior, posterior_of
from armour.statistics.v50 import Shots
from tests.helpers.known import known
from tools.campaigns.firings import simulate

pytestmark = pytest.mark.slow


def prior_of(v50_m_s: float, scatter_m_s: float) -> FiringPrior:
    return FiringPrior(v50_m_s, ModelError(0.0, 7.0, 12.0), scatter_percent=100.0 * scatter_m_s / v50_m_s)


UP_AND_DOWN = ShotSettings(prior_of(720.0, 15.0))


def test_gains_do_not_depend_on_the_number_of_threads():
    """Libraries of linear algebra divide sums over more than 10,000 numbers among threads."""
    assert max(prod(GRID_NODES), prod(FUTURE_NODES)) <= 10_000


def test_the_first_shot_is_at_the_estimate_or_above_the_requirement():
    assert next_up_and_down(Shots((), ()), UP_AND_DOWN).velocity_m_s == 720.0
    required = UP_AND_DOWN._replace(requirement_m_s=700.0)
    assert next_up_and_down(Shots((), ()), required).velocity_m_s == pytest.approx(700.0 + 75 * 0.3048)


@pytest.mark.parametrize(
    ("results", "feet"), [((False,), 100), ((True, True), -100), ((True, False), 50), ((False, False, True), -50)]
)
def test_the_steps_up_and_down(results: tuple[bool, ...], feet: float):
    shots = Shots(tuple(700.0 + 10 * number for number in range(len(results))), results)
    step = next_up_and_down(shots, UP_AND_DOWN).velocity_m_s - shots.velocities_m_s[-1]
    assert step == pytest.approx(feet * 0.3048)


def test_up_and_down_ends_with_three_of_each_kind_within_the_usual_span():
    velocities, results = [700.0, 716.0, 701.0, 717.0, 702.0, 718.0], [False, True] * 3
    ended = stopped_up_and_down(Shots(tuple(velocities), tuple(results)), UP_AND_DOWN)
    assert ended.startswith("3 partial and 3 complete")
    assert stopped_up_and_down(Shots(tuple(velocities[:5]), tuple(results[:5])), UP_AND_DOWN) == ""
    assert stopped_up_and_down(Shots((700.0, 750.0, 701.0, 751.0, 702.0, 752.0), tuple(results)), UP_AND_DOWN) == ""
    assert stopped_up_and_down(Shots((), ()), UP_AND_DOWN) == ""


LANGLIE = ShotSettings(prior_of(750.0, 15.0), (600.0, 900.0))


def langlie(velocities: list[float], results: list[bool], low: float, high: float) -> float:
    """The rule as it is stated: the latest p such that shots p to n hold as many of each kind."""
    if not results:
        return (low + high) / 2
    balanced = [p for p in range(len(results)) if 2 * sum(results[p:]) == len(results[p:])]
    other = velocities[max(balanced)] if balanced else low if results[-1] else high
    return (velocities[-1] + other) / 2


def test_all_sequences_of_eight_shots():
    for results in product((False, True), repeat=8):
        velocities: list[float] = []
        for count in range(9):
            found = next_by_langlie(Shots(tuple(velocities), results[:count]), LANGLIE).velocity_m_s
            assert found == langlie(velocities, list(results[:count]), 600.0, 900.0)
            velocities.append(found)


def test_the_end_is_that_of_the_interval_of_v50():
    velocities = (700.0, 740.0, 710.0, 730.0, 715.0, 722.0, 725.0, 720.0, 705.0, 735.0, 712.0, 728.0)
    complete = (False, True, False, True, True, False, True, False, False, True, False, True)
    wide, narrow = (LANGLIE._replace(half_width_m_s=half) for half in (50.0, 5.0))
    assert stopped(Shots(velocities, complete), wide) == "the interval of V50 is within ± 50 m/s"
    assert stopped(Shots(velocities, complete), narrow) == ""
    assert stopped(Shots((700.0,), (False,)), wide) == ""


# The example of [Wu2014], as the documentation of the R package gonogo
# (Roediger, AFIT) lists it: levels, responses and, from the tenth on, the D-optimal levels that are recommended.
LEVELS = (5.5, 16.5, 11.0, 13.8, 10.1, 14.7, 10.4, 11.7, 9.7, 7.3, 7.8, 8.1, 12.2, 8.5, 11.8)
RESPONSES = tuple(map(bool, (0, 1, 0, 1, 0, 1, 1, 1, 1, 0, 0, 0, 1, 0, 1)))
RECOMMENDED = {9: 7.26438, 10: 7.75467, 11: 8.08350, 12: 12.16394, 13: 8.51676, 14: 11.82596}
NEYER = ShotSettings(prior_of(11.0, 3.0), (0.0, 22.0))


@pytest.mark.parametrize("count", RECOMMENDED)
def test_the_published_d_optimal_levels(count: int):
    # The levels are searched in steps of a thousandth of the scatter.
    found = next_by_neyer(Shots(LEVELS[:count], RESPONSES[:count]), NEYER)
    assert found.velocity_m_s == pytest.approx(RECOMMENDED[count], abs=2e-3)


def shots(*fired: tuple[float, int]) -> Shots:
    return Shots(tuple(level for level, _ in fired), tuple(bool(result) for _, result in fired))


def test_a_binary_search_finds_shots_of_both_kinds():
    found = [next_by_neyer(shots(*fired), NEYER).velocity_m_s for fired in ((), ((11, 0),), ((11, 0), (16.5, 0)))]
    # Half way to the upper limit, two guessed scatters or the range of the shots faster, whichever is fastest.
    assert found == [11.0, 17.0, 22.5]
    assert next_by_neyer(shots((11, 1), (4, 1)), NEYER).velocity_m_s == -3.0
    assert next_by_neyer(shots((11, 0), (19, 1)), NEYER).velocity_m_s == 15.0


def test_separated_shots_reduce_the_guess_of_the_scatter():
    apart = [(11, 0), (17, 1), (13, 1)]
    assert "guessed scatter of 3.0" in next_by_neyer(shots(*apart), NEYER).why
    assert "guessed scatter of 2.4" in next_by_neyer(shots(*apart, (9, 0)), NEYER).why
    # 2 m/s apart is more than the guess after two reductions: the binary search again.
    assert next_by_neyer(shots(*apart, (9, 0), (18, 1)), NEYER).velocity_m_s == 12.0


def test_shots_without_a_rising_curve():
    flat = shots((10, 1), (14, 0), (9, 1), (15, 0))
    found = next_by_neyer(flat, NEYER)
    # After a partial penetration faster, by the best argument times the range.
    assert found.velocity_m_s == pytest.approx(12.0 + 1.31525757633905 * 6.0)


def test_a_shot_of_each_kind_at_one_velocity():
    assert np.isfinite(next_by_neyer(shots((11, 0), (11, 1)), NEYER).velocity_m_s)


PRIOR = prior_of(720.0, 14.4)
BAYESIAN = ShotSettings(PRIOR, half_width_m_s=15.0)
SHOTS = Shots((720.0, 770.0, 745.0), (False, True, False))


def test_the_gain_is_the_expected_reduction_of_the_variance():
    known = posterior(SHOTS, BAYESIAN)
    velocity = 752.0
    response = known.grid.response(np.array([velocity]))
    expected = 0.0
    for weights in (known.weights * response[0], known.weights * (1.0 - response[0])):
        after = Posterior(known.grid, weights / weights.sum())
        expected += weights.sum() * after.variance(known.grid.v50_m_s)
    [[gain]] = gains(known.weights[None], known.grid, BAYESIAN, response)
    assert known.variance(known.grid.v50_m_s) - gain == pytest.approx(expected)


def test_the_velocity_has_the_greatest_gain():
    known = posterior(SHOTS, BAYESIAN)
    aim = next_bayesian(SHOTS, BAYESIAN)
    others = np.linspace(650.0, 850.0, 401)
    gained = gains(known.weights[None], known.grid, BAYESIAN, known.grid.response(others))[0]
    assert aim.velocity_m_s == pytest.approx(others[np.argmax(gained)], abs=1.0)


def test_the_end_by_the_interval():
    low, high = posterior(SHOTS, BAYESIAN).estimate(0.95).v50_interval_m_s
    half = 0.5 * (high - low)
    assert stopped_bayesian(SHOTS, BAYESIAN._replace(half_width_m_s=half + 0.1)).startswith("the interval of V50 is")
    assert stopped_bayesian(SHOTS, BAYESIAN._replace(half_width_m_s=half - 0.1)) == ""


def test_many_firings_at_once_choose_as_one_does():
    known = posterior_of(PRIOR, (), (), (201, 31))
    firings = Firings(known, BAYESIAN, 2, 401)
    fired = [Shots((), ()), Shots((), ())]
    for results in ((True, False), (True, True), (False, True)):
        aims = firings.aims()
        singles = [next_bayesian(each, BAYESIAN).velocity_m_s for each in fired]
        assert aims == pytest.approx(singles, abs=2.0)
        firings.add(aims, np.array(results))
        fired = [
            Shots((*each.velocities_m_s, float(aim)), (*each.complete, result))
            for each, aim, result in zip(fired, aims, results, strict=True)
        ]
    for ends, each in zip(firings.intervals(0.95), fired, strict=True):
        assert ends == pytest.approx(posterior(each, BAYESIAN).estimate(0.95).v50_interval_m_s, abs=1.0)


def test_fewer_shots_are_expected_for_a_wider_interval_and_as_shots_are_fired(monkeypatch: pytest.MonkeyPatch):
    narrow = known(expected_shots(SHOTS, BAYESIAN))
    wide = known(expected_shots(SHOTS, BAYESIAN._replace(half_width_m_s=30.0)))
    later = known(expected_shots(Shots((*SHOTS.velocities_m_s,) * 2, (*SHOTS.complete,) * 2), BAYESIAN))
    sooner = known(expected_shots(SHOTS, BAYESIAN._replace(confidence=0.9)))
    assert 0 < max(wide, later, sooner) < narrow
    monkeypatch.setattr("armour.planning.procedures.MOST_SHOTS", 5)
    assert expected_shots(SHOTS, BAYESIAN._replace(half_width_m_s=0.5)) is None


def test_firings_of_the_campaign_end_with_intervals_that_hold():
    firings = simulate("bayesian", 1.0, 15.0, 10, 1)
    assert 8 < firings.shots.mean() < 40
    assert firings.held.mean() > 0.6
