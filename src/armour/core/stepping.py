"""Length of the time steps: the default of an impact, and how a step adapts to the motion."""

from math import sqrt

from armour.core import equations as eq
from armour.core.stages import mass_ahead, medium_ahead, with_intact_strength
from armour.core.state import Medium, Parameters, Stage, State

# Default steps per characteristic time of the motion.
STEPS_PER_CHANGE = 4.0
# Longest time step that can be given, in default steps; longer ones would not resolve the events.
COARSEST_STEP = 1.6
# Longest step as a fraction of the response time.
LONGEST_RESPONSE = 0.3
# Shortest step as a fraction of the characteristic time; its error is of the size of rounding.
SHORTEST_CHANGE = 1e-3
# Length of a step at constant deceleration, in usual steps; any length is exact there.
STEADY_STEPS = 8.0


def time_step(p: Parameters, Vi: float, given: float) -> float:
    """Return the time step of an impact, s: the given one, at most `COARSEST_STEP` defaults, or the default for 0."""
    default = default_time_step(p, Vi)
    return min(given, COARSEST_STEP * default) if given > 0.0 else default


def default_time_step(p: Parameters, Vi: float) -> float:
    """Return the default time step of an impact at Vi, s: a fixed fraction of its characteristic time.

    The characteristic rate is the sum of three: the front crossing a diameter (or the armour, if thinner), the
    projectile decelerating, and the target accelerating.  All scale as 1/size, so similar impacts take equal numbers
    of steps.
    """
    p = with_intact_strength(p)
    Y = max(p.YB, p.Yc0) if p.Hc0 > 0.0 else p.YB
    crossing = Vi / min(p.D0, p.Hc0 + p.Hb)
    slowing = min(Y, p.Yp) / (p.rho_p * p.L0 * Vi)
    picking_up = min(Y, p.Yp + p.rho_p * Vi * Vi) / ((p.rho_c * p.Hc0 + p.rho_B * p.Hb) * Vi)
    return 1.0 / (STEPS_PER_CHANGE * (crossing + slowing + picking_up))


def step_length(y: State, k: State, s: Stage, p: Parameters, dt: float) -> float:
    """Return the length of the next step, s: dt adapted to the time scales of the motion.

    The step is shortened where little of the projectile or the plate is left.  It is lengthened where dt would only
    add rounding; for a rigid projectile in held fragmented ceramic, whose velocity falls as 1/t, in proportion to
    Vs1/V; and for a rigid projectile that carries all material ahead, whose deceleration is constant.  ``k`` are the
    rates at ``y``.
    """
    if not (s.eroding or s.penetrated):
        dt *= STEADY_STEPS
    if s.medium == Medium.FRAGMENTED and not (s.eroding or s.moving):
        dt *= s.Vs1 / y.V
    change = (abs(k.V) + abs(k.W)) / y.V + k.Z / min(p.D0, p.Hc0 + p.Hb)
    return min(max(dt, SHORTEST_CHANGE / change), LONGEST_RESPONSE / fastest_rate(y, k, s, p))


def fastest_rate(y: State, k: State, s: Stage, p: Parameters) -> float:
    """Return the rate of the fastest response of the motion, 1/s; a step must be short against its inverse."""
    if not (s.eroding or s.penetrated):
        return y.V / y.L
    _, rho = medium_ahead(y, s, p)
    inertia = max(1.0, rho / p.rho_p) * y.V
    # Derivative of the strength of fragmented ceramic (9) by velocity, Pa s/m.
    damping = 0.0
    if s.medium == Medium.FRAGMENTED and s.penetrated:
        damping = 2.0 * p.Yc0 * (y.V - y.W) / (s.Vs1 * s.Vs1)
    projectile = (inertia + sqrt(p.Yp / p.rho_p) + damping / p.rho_p) / y.L
    if not s.moving:
        return projectile
    picking_up = abs(k.W) / y.V
    areal_mass = mass_ahead(y, s, p) / eq.cross_section(p.D0)
    if not s.penetrated:
        return projectile + picking_up + p.rho_p * y.V / areal_mass
    return projectile + picking_up + (rho * (y.V - y.W) + damping) / areal_mass
