"""Langlie's one-shot test [Langlie1962].

The first shot is midway between the limits.  Each further one is midway between the last shot and the latest shot from
which on as many penetrations were complete as partial; where there is none, midway between the last shot and the lower
limit after a complete, the upper limit after a partial penetration.
"""

from collections.abc import Iterator

from armour.planning.procedures import stopping
from armour.planning.procedures.settings import Aim, ShotSettings
from armour.statistics.v50 import Shots

# This many last shots of one kind, the next within this part of the limits of one of them, leave it in doubt.
ALIKE, NEAR = 5, 0.02

stopped = stopping.stopped


def next_velocity(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot; the settings must have limits."""
    assert settings.limits_m_s is not None
    lower, upper = settings.limits_m_s
    if not shots.complete:
        return Aim(0.5 * (lower + upper), "the first shot is midway between the limits")
    velocities, last = shots.velocities_m_s, shots.velocities_m_s[-1]
    excess = 0  # of complete over partial penetrations
    for number in range(len(velocities), 0, -1):
        excess += 1 if shots.complete[number - 1] else -1
        if excess == 0:
            reason = (
                f"midway between the last shot and shot {number}, from which on half of the penetrations are complete"
            )
            return Aim(0.5 * (last + velocities[number - 1]), reason)
    end, name = (lower, "lower") if shots.complete[-1] else (upper, "upper")
    return Aim(0.5 * (last + end), f"midway between the last shot and the {name} limit, {end:.1f} m/s")


def doubts(shots: Shots, settings: ShotSettings) -> Iterator[str]:
    """Give a warning where the shots leave the limits or stick at one; the settings must have limits."""
    assert settings.limits_m_s is not None
    lower, upper = settings.limits_m_s
    velocity, last = next_velocity(shots, settings).velocity_m_s, shots.complete[-ALIKE:]
    if not lower <= velocity <= upper:
        yield f"the next velocity, {velocity:.1f} m/s, is outside the limits, {lower:.1f} to {upper:.1f} m/s"
    end, name = (lower, "lower") if shots.complete and last[-1] else (upper, "upper")
    if len(last) == ALIKE and len({*last}) == 1 and abs(velocity - end) < NEAR * (upper - lower):
        kind = "complete" if last[-1] else "partial"
        yield (
            f"the last {ALIKE} shots, all {kind}, have reached the {name} limit, {end:.1f} m/s: V50 may lie beyond it; "
            "give other limits"
        )
