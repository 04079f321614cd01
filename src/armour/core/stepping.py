"""Length of the time steps: the longest of an impact, and how a step adapts to the motion."""

from math import inf, sqrt

from armour.core import equations as eq
from armour.core.stages import mass_ahead, medium_ahead, with_intact_strength
from armour.core.state import Medium, Parameters, Stage, State

# Longest step as a fraction of the response time of the motion, and that of a rough run.
LONGEST_RESPONSE = 0.23
ROUGH_RESPONSE = 0.6
# The latter grows by this where the velocity falls as 1/t.
ROUGH_SLOWING = 4.0
# Rates of response of a penetration velocity that rises and of one that falls, over the rate of D, see `front_rate`.
BEND_RISING, BEND_FALLING = 1.15, 3.45
# Part of the rate at which V - W settles that counts once it has.
SETTLED = 0.35
# Least V - W, as a part of V, the change of which counts.
LEAST_SLIP = 0.01
# Shortest step as a fraction of the characteristic time; its error is of the size of rounding.
SHORTEST_CHANGE = 1e-3
# Distance beyond the end of a medium to which a step of constant deceleration leads, as a fraction of its depth.
PAST_THE_END = 1e-12


def time_step(p: Parameters, Vi: float, given: float) -> float:
    """Return the longest time step of an impact, s: the given one, at most the default, or the default for 0."""
    default = default_time_step(p, Vi)
    return min(given, default) if given > 0.0 else default


def default_time_step(p: Parameters, Vi: float) -> float:
    """Return the default of the longest time step of an impact at Vi, s: its characteristic time.

    The characteristic rate is the sum of three: the front crossing a diameter (or the armour, if thinner), the
    projectile decelerating, and the target accelerating.  All scale as 1/size, so similar impacts take equal numbers
    of steps.
    """
    p = with_intact_strength(p)
    Y = max(p.YB, p.Yc0) if p.Hc0 > 0.0 else p.YB
    crossing = Vi / min(p.D0, p.Hc0 + p.Hb)
    slowing = min(Y, p.Yp) / (p.rho_p * p.L0 * Vi)
    picking_up = min(Y, p.Yp + p.rho_p * Vi * Vi) / ((p.rho_c * p.Hc0 + p.rho_B * p.Hb) * Vi)
    return 1.0 / (crossing + slowing + picking_up)


def step_length(y: State, k: State, s: Stage, p: Parameters, dt: float, rough: bool) -> float:
    """Return the length of the next step, s: dt, or the longest by the response time if that is shorter.

    For a rigid projectile in held fragmented ceramic, whose velocity falls as 1/t, dt grows in proportion to Vs1/V.
    It is lengthened where it would only add rounding.  Where a rigid projectile carries all material ahead, whose
    deceleration is constant, a step of any length is exact: it goes beyond the end.  ``k`` are the rates at ``y``.
    """
    if not (s.eroding or s.penetrated):
        return time_to_end(y, k, s, p)
    response = ROUGH_RESPONSE if rough else LONGEST_RESPONSE
    if s.medium == Medium.FRAGMENTED and not (s.eroding or s.moving):
        dt *= s.Vs1 / y.V
        response *= ROUGH_SLOWING if rough else 1.0
    size = min(p.D0, p.Hc0 + p.Hb)
    # The step over the characteristic time, the inverse of (|dV| + |dW|)/V + U/size, is change/(V size).
    change = dt * ((abs(k.V) + abs(k.W)) * size + k.Z * y.V)
    if change < SHORTEST_CHANGE * y.V * size:
        dt *= SHORTEST_CHANGE * y.V * size / change
    rate = response_rate(y, k, s, p)
    return dt if dt * rate < response else response / rate


def time_to_end(y: State, k: State, s: Stage, p: Parameters) -> float:
    """Return the time until a projectile at constant deceleration is through the medium or at rest, s."""
    end = p.Hc0 + (p.Hb if s.medium == Medium.PLATE else 0.0)
    left = max(end - y.Z, 0.0) + PAST_THE_END * end
    through = 2.0 * left / (y.V + sqrt(max(y.V * y.V + 2.0 * k.V * left, 0.0)))
    return min(through, y.V / -k.V if k.V < 0.0 else inf)


def response_rate(y: State, k: State, s: Stage, p: Parameters) -> float:
    """Return a bound on the rates of response of the motion, 1/s; a step must be short against its inverse.

    It is the sum of the rates of the projectile and of a moving target: by inertia, by erosion (the rod vanishes after
    L/(V - U)), by strength, and by the shear force on the plate, which is that of a spring.  Where both sides yield, it
    is at least the rate of the penetration velocity.
    """
    Y, rho = medium_ahead(y, s, p)
    damping = strength_by_velocity(y, s, p)
    per_mass = eq.cross_section(p.D0) / mass_ahead(y, s, p) if s.moving else 0.0
    if s.eroding:
        rate = (y.V - 2.0 * k.L + sqrt(p.Yp / p.rho_p) + damping / p.rho_p) / y.L + per_mass * damping
    else:
        strength = damping * (1.0 / (p.rho_p * y.L) + per_mass)
        if s.moving and s.medium == Medium.FRAGMENTED:
            # V - W settles at the rate `strength`: errors decay, and little changes once it has settled.
            strength = SETTLED * strength + abs(k.V - k.W) / max(y.V - y.W, LEAST_SLIP * y.V)
        rate = (2.0 * rho * y.V + 2.5 * sqrt(Y * rho)) / (p.rho_p * y.L) + strength
    if s.moving:
        rate += per_mass * (rho * (y.V - y.W) if s.penetrated else p.rho_p * y.V)
    if s.moving and s.penetrated and s.medium == Medium.PLATE:
        rate += sqrt(per_mass * (4.0 * p.tau / p.D0))
    return max(rate, front_rate(y, k, p, rho, damping)) if s.eroding and s.penetrated else rate


def front_rate(y: State, k: State, p: Parameters, rho: float, damping: float) -> float:
    """Return the rate of response of the penetration velocity U where both sides yield, 1/s.

    By the equal pressures (5), (8), (20), D U' = rho_p (2 V - U) V' + rho U W' - Y' with D = rho_p V + rho (2 U - W).
    U is nearly linear in time while D is nearly constant: the rate is in proportion to that of D by U, 2 rho U'/D.
    """
    D = p.rho_p * y.V + rho * (2.0 * k.Z - y.W)
    rising = p.rho_p * (2.0 * y.V - k.Z) * k.V + rho * k.Z * k.W - damping * (k.V - k.W)
    bend = 2.0 * rho * rising / (D * D)
    return BEND_RISING * bend if bend > 0.0 else -BEND_FALLING * bend


def strength_by_velocity(y: State, s: Stage, p: Parameters) -> float:
    """Return the derivative of the strength of fragmented ceramic by velocity, Pa s/m (9); 0 in other media."""
    if s.medium != Medium.FRAGMENTED or not s.penetrated:
        return 0.0
    return 2.0 * p.Yc0 * (y.V - y.W) / (s.Vs1 * s.Vs1)
