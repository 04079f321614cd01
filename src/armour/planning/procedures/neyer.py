"""Neyer's D-optimal test [Neyer1994].

1. A binary search finds shots of both kinds, and brings their velocities within the guess of the scatter.
2. Until shots of the two kinds overlap, so that V50 and scatter have unique estimates of maximum likelihood, V50 is
   taken midway between the kinds; the guess of the scatter is reduced by a factor of 0.8 with each shot.
3. The estimates are those of maximum likelihood, V50 within and the scatter no more than the range of the shots.

In parts 2 and 3 the next velocity is the one that makes the determinant of the Fisher information greatest.
"""

from collections.abc import Sequence
from math import copysign

import numpy as np
from scipy.special import log_ndtr

from armour.analysis.variants import Floats
from armour.planning.procedures import stopping
from armour.planning.procedures.settings import Aim, ShotSettings
from armour.statistics.response_curve import maximum_likelihood, standardised
from armour.statistics.v50 import Shots

REDUCTION = 0.8
# Arguments of the normal distribution function at which the gain in information is examined.
ARGUMENTS = np.arange(-4000, 4001) / 1000.0
# The best argument where the shots are best described by a constant probability, an infinite scatter.
FLAT = 1.31525757633905

stopped = stopping.stopped


def _weights(z: Floats) -> Floats:
    """Return the Fisher information of shots on the argument of the normal distribution function."""
    weights: Floats = np.exp(-z * z - np.log(2.0 * np.pi) - log_ndtr(z) - log_ndtr(-z))
    return weights


INFORMATION = _weights(ARGUMENTS)


def next_velocity(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot; the settings must have limits."""
    assert settings.limits_m_s is not None
    lower, upper = settings.limits_m_s
    velocities, complete = shots.velocities_m_s, shots.complete
    if not complete:
        return Aim(0.5 * (lower + upper), "binary search: the first shot is midway between the limits")
    guess = settings.scatter_m_s
    slowest, fastest = min(velocities), max(velocities)
    if len(set(complete)) == 1:
        reason = "binary search: no shot of the other kind yet"
        if complete[0]:
            return Aim(min(0.5 * (lower + slowest), slowest - 2.0 * guess, 2.0 * slowest - fastest), reason)
        return Aim(max(0.5 * (upper + fastest), fastest + 2.0 * guess, 2.0 * fastest - slowest), reason)
    gaps = _gaps(shots)
    # Each earlier shot of part 2 has reduced the guess.
    for gap in gaps[:-1]:
        if 0.0 <= gap <= guess:
            guess *= REDUCTION
    highest, lowest = shots.of(complete=False)[-1], shots.of(complete=True)[0]
    middle, span = 0.5 * (highest + lowest), fastest - slowest
    if gaps[-1] > guess:
        return Aim(middle, "binary search: midway between the highest partial and the lowest complete penetration")
    if gaps[-1] >= 0.0:
        scatter = min(guess, span) or guess  # a shot of each kind at one velocity has no span
        return Aim(_best(velocities, middle, scatter), f"D-optimal for a guessed scatter of {scatter:.1f} m/s")
    partial, completes = shots.of(complete=False), shots.of(complete=True)
    if np.mean(completes) <= np.mean(partial):
        v50 = min(max(middle, slowest), fastest)
        return Aim(v50 + copysign(FLAT * span, -1.0 if complete[-1] else 1.0), "the shots have no rising curve")
    mean, deviation, x, signs = standardised(partial, completes)
    location, scale, _ = maximum_likelihood("probit", signs, x)
    v50, scatter = min(max(mean + deviation * location, slowest), fastest), min(deviation * scale, span)
    reason = f"D-optimal for the estimates of maximum likelihood, V50 {v50:.1f} and scatter {scatter:.1f} m/s"
    return Aim(_best(velocities, v50, scatter), reason)


def _gaps(shots: Shots) -> list[float]:
    """Return lowest complete less highest partial after each shot from the first of the second kind on, m/s."""
    lowest, highest, gaps = np.inf, -np.inf, []
    for velocity, complete in zip(shots.velocities_m_s, shots.complete, strict=True):
        lowest, highest = (min(lowest, velocity), highest) if complete else (lowest, max(highest, velocity))
        gaps.append(round(float(lowest - highest), 9))
    return [gap for gap in gaps if gap < np.inf]


def _best(velocities: Sequence[float], v50: float, scatter: float) -> float:
    """Return the velocity whose shot makes the determinant of the information on V50 and scatter greatest, m/s."""
    z = (np.array(velocities) - v50) / scatter
    weights = _weights(z)
    zero, one, two = weights.sum(), weights @ z, weights @ (z * z)
    gain = INFORMATION * (zero * ARGUMENTS**2 - 2.0 * one * ARGUMENTS + two)
    return v50 + scatter * float(ARGUMENTS[np.argmax(gain)])
