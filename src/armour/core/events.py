"""Events that end a stage: how far each is away, where in a step the earliest happens, and what follows it."""

from enum import IntEnum
from math import inf, isfinite

from armour.core import equations as eq
from armour.core.rk4 import step
from armour.core.stages import drive_force, medium_ahead, select_stage, shear_force
from armour.core.state import Medium, Outcome, Parameters, Stage, State


class Event(IntEnum):
    """Events, numbered by their position in the result of `event_functions`."""

    MEDIUM = 0  # the projectile reaches the end of the medium (7), (13), (19), (32)
    PROJECTILE = 1  # the projectile starts or stops yielding (13), (16), (19), (24), (27), (30)
    TARGET = 2  # the target starts or stops yielding, likewise
    MOTION = 3  # the material ahead starts to move or comes to rest
    TOGETHER = 4  # the material ahead reaches the projectile's velocity
    ARREST = 5  # the projectile stops
    ERODED = 6  # the projectile is used up


EVENTS = len(Event)
# Fraction of the length at impact below which the projectile counts as used up.
ERODED_FRACTION = 1e-3
# Tolerance of the location of an event, as a fraction of the step.
EVENT_TOLERANCE = 1e-12


def event_functions(
    t: float, y: State, s: Stage, p: Parameters, V_arrest: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the event functions, one per `Event`: at least 0 while the stage lasts, negative after the event."""
    together = projectile = target = motion = inf
    if s.medium == Medium.INTACT:
        medium = p.Hc0 - y.Z - eq.crack_velocity(p.Ec, p.rho_c) * t
    elif s.medium == Medium.FRAGMENTED:
        medium = p.Hc0 - y.Z
    else:
        medium = p.Hc0 + p.Hb - y.Z
    if s.eroding or s.penetrated:
        Y, rho = medium_ahead(y, s, p)
        projectile = eq.projectile_excess(Y, rho, p.Yp, y.V, y.W)
        target = eq.target_excess(Y, p.Yp, p.rho_p, y.V, y.W)
        if not s.eroding:
            projectile = -projectile
        if not s.penetrated:
            target = -target
        if s.moving:
            motion = y.W
            together = y.V - y.W
        elif s.medium != Medium.INTACT:
            motion = shear_force(y, s, p) - drive_force(y, s, p)
    arrest = y.V - V_arrest
    eroded = y.L - ERODED_FRACTION * p.L0
    return medium, projectile, target, motion, together, arrest, eroded


def step_to_event(
    t: float, y: State, k1: State, s: Stage, p: Parameters, dt: float, V_arrest: float
) -> tuple[int, float, State]:
    """Take a step of dt, s, from time t, s, or the part of it up to its earliest event; k1 are the rates at y.

    Return the `Event`, or -1 for none, the time taken, s, and the state there.
    """
    start = event_functions(t, y, s, p, V_arrest)
    y_end = step(y, k1, s, p, dt)
    end = event_functions(t + dt, y_end, s, p, V_arrest)
    event, fraction = -1, 1.0
    # Each event found shortens the interval, and may reveal another that had come and gone within the step.
    for i in range(2 * EVENTS):
        k = i % EVENTS
        if k != event and not end[k] >= 0.0:
            event = k
            fraction, y_end = locate_event(k, t, y, k1, s, p, dt, V_arrest, start[k], end[k], fraction, y_end)
            end = event_functions(t + fraction * dt, y_end, s, p, V_arrest)
    return event, fraction * dt, y_end


def locate_event(
    k: int,
    t: float,
    y: State,
    k1: State,
    s: Stage,
    p: Parameters,
    dt: float,
    V_arrest: float,
    g_lo: float,
    g_hi: float,
    hi: float,
    y_hi: State,
) -> tuple[float, State]:
    """Return the fraction of a step just after event k, within `EVENT_TOLERANCE`, and the state there.

    The event function is ``g_lo`` at the start of the step and ``g_hi`` < 0 at the fraction ``hi``, in state ``y_hi``.
    Chandrupatla's method [Chandrupatla1997] interpolates inverse-quadratically where that is safe, else it bisects.
    In the bracket, ``x`` is the last fraction evaluated and ``other`` the end on the other side of the event.
    """
    if g_lo < 0.0:
        return 0.0, y
    x, g = hi, g_hi
    other, g_other = 0.0, g_lo
    after, y_after = hi, y_hi
    part = g / (g - g_other) if isfinite(g) else 0.5
    while abs(x - other) > EVENT_TOLERANCE:
        nearest = 0.5 * EVENT_TOLERANCE / abs(x - other)
        part = min(max(part, nearest), 1.0 - nearest)
        last, g_last = x, g
        x += part * (other - x)
        y_x = step(y, k1, s, p, x * dt)
        g = event_functions(t + x * dt, y_x, s, p, V_arrest)[k]
        if (g >= 0.0) != (g_last >= 0.0):
            last, g_last, other, g_other = other, g_other, last, g_last
        if not g >= 0.0:
            after, y_after = x, y_x
        part = interpolated(x, g, other, g_other, last, g_last)
    return after, y_after


def interpolated(x: float, g: float, other: float, g_other: float, last: float, g_last: float) -> float:
    """Return the estimated root as a fraction of the way from x to the other end of the bracket; 0.5 to bisect."""
    xi = (x - other) / (last - other)
    phi = (g - g_other) / (g_last - g_other)
    if not (phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi):
        return 0.5
    return g / (g_other - g) * g_last / (g_other - g_last) + (last - x) / (other - x) * g / (g_last - g) * g_other / (
        g_last - g_other
    )


def after_event(event: int, y: State, s: Stage, p: Parameters) -> tuple[State, Stage, Outcome]:
    """Return the state, stage and outcome after an event, from the state at the event."""
    if event == Event.ARREST or event == Event.ERODED:
        return y, s, Outcome.DEFEATED
    if event == Event.MEDIUM:
        if s.medium == Medium.PLATE:
            return y, s, Outcome.PERFORATED
        if s.medium == Medium.INTACT:
            return y, select_stage(Medium.FRAGMENTED, y, p, y.V, s.h_s), Outcome.RUNNING
        return y, select_stage(Medium.PLATE, y, p, s.Vs1, y.h), Outcome.RUNNING
    if event == Event.TOGETHER:
        y = State(y.Z, y.L, y.V, y.V, y.h)
    if event == Event.MOTION and s.moving:
        # Removes rounding: W is 0 here, and so is the bulge of a motion that ends as it begins.
        y = State(y.Z, y.L, y.V, 0.0, max(y.h, 0.0))
    return y, select_stage(s.medium, y, p, s.Vs1, s.h_s), Outcome.RUNNING
