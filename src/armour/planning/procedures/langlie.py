"""Langlie's one-shot test (A reliability test method for "one-shot" items, Aeronutronic U-1792, 1962).

The first shot is midway between the limits.  Each further one is midway between the last shot and the latest shot from
which on as many penetrations were complete as partial; where there is none, midway between the last shot and the lower
limit after a complete, the upper limit after a partial penetration.
"""

from armour.planning.procedures import stopping
from armour.planning.procedures.settings import Aim, ShotSettings
from armour.statistics.v50 import Shots

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
