"""Up-and-down rule of MIL-STD-662F [DoD1997].

The first shot is at the estimated V50 or, where a velocity is required, 75 ft/s above it.  After a complete penetration
the next shot is slower than this one was, after a partial penetration faster: by 100 ft/s until there is a shot of each
kind, then by 50 ft/s.  It ends with as many shots of each kind as the mean needs, within its usual span.
"""

from armour.planning.procedures import stopping
from armour.planning.procedures.settings import Aim, ShotSettings
from armour.statistics.v50 import SPANS_M_S, MeanV50, Shots, mean_v50

FEET_M = 0.3048
ABOVE_M_S, FIRST_STEP_M_S, STEP_M_S = 75.0 * FEET_M, 100.0 * FEET_M, 50.0 * FEET_M
# Shots of each kind in the mean that ends the firing.
PAIRS = 3


def next_velocity(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot."""
    if not shots.complete:
        if settings.requirement_m_s is None:
            return Aim(settings.estimate_m_s, "the first shot is at the estimated V50")
        return Aim(settings.requirement_m_s + ABOVE_M_S, f"the first shot is {ABOVE_M_S:.1f} m/s above the requirement")
    step = STEP_M_S if len(set(shots.complete)) == 2 else FIRST_STEP_M_S
    last, complete = shots.velocities_m_s[-1], shots.complete[-1]
    way, kind = ("below", "complete") if complete else ("above", "partial")
    reason = f"{step:.1f} m/s {way} the last shot, a {kind} penetration"
    return Aim(last - step if complete else last + step, reason)


def stopped(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    if settings.half_width_m_s is not None:
        return stopping.stopped(shots, settings)
    if mean(shots) is None:
        return ""
    return f"{PAIRS} partial and {PAIRS} complete penetrations lie within {SPANS_M_S[PAIRS]:g} m/s"


def mean(shots: Shots) -> MeanV50 | None:
    """Return the mean of MIL-STD-662F that ends the firing; None where the shots do not meet its span."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    return mean_v50(partial, complete, PAIRS) if partial and complete else None
