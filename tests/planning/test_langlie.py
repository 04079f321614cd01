"""Langlie's procedure, worked out by hand from its rules and against an independent implementation."""

from itertools import product

from armour.planning.procedures import ShotSettings, stopped
from armour.planning.procedures import next_by_langlie as next_velocity
from armour.statistics.v50 import Shots

SETTINGS = ShotSettings(750.0, 15.0, (600.0, 900.0))


def test_a_sequence_by_hand():
    results = (True, False, False, True, True, True, False)
    # Shot, and the shot or limit that it is midway to.
    expected = (
        750.0,  # midway between the limits
        675.0,  # complete: midway to the lower limit
        712.5,  # 1 and 2 are one of each: midway between 2 and 1
        806.25,  # 1 to 3 are one complete and two partial, 2 and 3 partial: midway to the upper limit
        759.375,  # 3 and 4 are one of each
        717.1875,  # 2 to 5 are two of each: midway between 5 and 2
        658.59375,  # 6, 5, 4 complete, 3 and 2 partial, 1 complete: midway to the lower limit
        687.890625,  # 6 and 7 are one of each
    )
    fired = Shots((), ())
    for number, velocity in enumerate(expected):
        assert next_velocity(fired, SETTINGS).velocity_m_s == velocity
        if number < len(results):
            fired = Shots((*fired.velocities_m_s, velocity), (*fired.complete, results[number]))


def independent(velocities: list[float], results: list[bool], low: float, high: float) -> float:
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
            found = next_velocity(Shots(tuple(velocities), results[:count]), SETTINGS).velocity_m_s
            assert found == independent(velocities, list(results[:count]), 600.0, 900.0)
            velocities.append(found)


def test_the_end_is_that_of_the_interval_of_v50():
    velocities = (700.0, 740.0, 710.0, 730.0, 715.0, 722.0, 725.0, 720.0, 705.0, 735.0, 712.0, 728.0)
    complete = (False, True, False, True, True, False, True, False, False, True, False, True)
    wide, narrow = (SETTINGS._replace(half_width_m_s=half) for half in (50.0, 5.0))
    assert stopped(Shots(velocities, complete), wide) == "the interval of V50 is within ± 50 m/s"
    assert stopped(Shots(velocities, complete), narrow) == ""
    assert stopped(Shots((700.0,), (False,)), wide) == ""
