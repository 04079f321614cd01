"""The up-and-down rule of MIL-STD-662F, by hand."""

import pytest

from armour.planning.procedures import ShotSettings
from armour.planning.procedures import next_up_and_down as next_velocity
from armour.planning.procedures import stopped_up_and_down as stopped
from armour.statistics.v50 import Shots

SETTINGS = ShotSettings(720.0, 15.0)


def test_the_first_shot_is_at_the_estimate_or_above_the_requirement():
    assert next_velocity(Shots((), ()), SETTINGS).velocity_m_s == 720.0
    required = SETTINGS._replace(requirement_m_s=700.0)
    assert next_velocity(Shots((), ()), required).velocity_m_s == pytest.approx(700.0 + 75 * 0.3048)


@pytest.mark.parametrize(
    ("results", "feet"), [((False,), 100), ((True, True), -100), ((True, False), 50), ((False, False, True), -50)]
)
def test_the_steps(results: tuple[bool, ...], feet: float):
    shots = Shots(tuple(700.0 + 10 * number for number in range(len(results))), results)
    step = next_velocity(shots, SETTINGS).velocity_m_s - shots.velocities_m_s[-1]
    assert step == pytest.approx(feet * 0.3048)


def test_it_ends_with_three_of_each_kind_within_the_usual_span():
    velocities, results = [700.0, 716.0, 701.0, 717.0, 702.0, 718.0], [False, True] * 3
    assert stopped(Shots(tuple(velocities), tuple(results)), SETTINGS).startswith("3 partial and 3 complete")
    assert stopped(Shots(tuple(velocities[:5]), tuple(results[:5])), SETTINGS) == ""
    assert stopped(Shots((700.0, 750.0, 701.0, 751.0, 702.0, 752.0), tuple(results)), SETTINGS) == ""
    assert stopped(Shots((), ()), SETTINGS) == ""
