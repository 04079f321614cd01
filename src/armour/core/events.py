"""Events that end a stage: how far away each is, where in a step the earliest happens, and what follows it."""

from enum import IntEnum
from math import inf

from armour.core import equations as eq
from armour.core.rk4 import Step, state_within
from armour.core.roots import MOST_TRIALS, bracket, narrowed, next_point
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


# Fraction of the length at impact below which the projectile counts as used up.
ERODED_FRACTION = 1e-3
# Width to which an event is located, as a fraction of the step.
EVENT_WIDTH = 1e-12

# Event functions, one per `Event`.
Margins = tuple[float, float, float, float, float, float, float]


def event_functions(t: float, y: State, s: Stage, p: Parameters, V_arrest: float) -> Margins:
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


def first_event(whole: Step, g: Margins, g_end: Margins, s: Stage, p: Parameters, V_arrest: float) -> tuple[int, float]:
    """Return the earliest event on the cubic through a step, or -1, and the fraction of the step just after it.

    The event functions are g at its start and g_end at its end.
    """
    event, x, g_x = -1, 1.0, g_end
    # Of several events, an earlier one may show at the one that has been located.
    for _ in range(len(g)):
        j = negative(g_x, event)
        if j < 0:
            break
        event = j
        if g[j] < 0.0:
            return j, 0.0
        b = bracket(x, g_x[j], 0.0, g[j])
        for _ in range(MOST_TRIALS):
            if abs(b.x2 - b.x1) <= EVENT_WIDTH:
                break
            x = next_point(b, 0.95 * EVENT_WIDTH)
            b = narrowed(b, x, functions_within(whole, x, s, p, V_arrest)[j])
        x = max(b.x1, b.x2)
        g_x = functions_within(whole, x, s, p, V_arrest)
    return event, x


def functions_within(whole: Step, x: float, s: Stage, p: Parameters, V_arrest: float) -> Margins:
    """Return the event functions at a fraction x of a step."""
    t, dt, y, k, y_end, k_end, _ = whole
    return event_functions(t + x * dt, state_within(y, k, y_end, k_end, dt, x), s, p, V_arrest)


def negative(g: Margins, other_than: int) -> int:
    """Return the first event whose function is negative or not a number, other than one; -1 if there is none."""
    for j in range(len(g)):
        if j != other_than and not g[j] >= 0.0:
            return j
    return -1


def after_event(event: int, y: State, s: Stage, p: Parameters) -> tuple[State, Stage, Outcome]:
    """Return the state, stage and outcome after an event, from the state at the event."""
    # Just past an event W, and the bulge that it makes, may be below 0 by rounding.
    y = State(y.Z, y.L, y.V, max(y.W, 0.0), max(y.h, 0.0))
    if event == Event.ARREST or event == Event.ERODED:
        return y, s, Outcome.STOPPED
    if event == Event.MEDIUM:
        if s.medium == Medium.PLATE:
            return y, s, Outcome.PERFORATED
        if s.medium == Medium.INTACT:
            return y, select_stage(Medium.FRAGMENTED, y, p, y.V, s.h_s), Outcome.RUNNING
        return y, select_stage(Medium.PLATE, y, p, s.Vs1, y.h), Outcome.RUNNING
    if event == Event.TOGETHER:
        y = State(y.Z, y.L, y.V, y.V, y.h)
    if event == Event.MOTION and s.moving:
        y = State(y.Z, y.L, y.V, 0.0, y.h)
    return y, select_stage(s.medium, y, p, s.Vs1, s.h_s), Outcome.RUNNING
