"""Events that end a stage: how far each is away, where in a step the earliest happens, and what follows it."""

from enum import IntEnum
from math import inf
from typing import NamedTuple

from armour.core import equations as eq
from armour.core.rk4 import state_within, step
from armour.core.stages import drive_force, medium_ahead, rates, select_stage, shear_force
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
# Tolerance of the location of an event, and of its estimate on the cubic, as fractions of the step.
EVENT_TOLERANCE = 1e-11
CUBIC_TOLERANCE = 1e-4
# Greatest difference of velocities from their trapezoidal rule, as a part of V, with which the cubic is not confirmed.
GREATEST_BEND = 0.05
# Trials by secants, after which an event is located by bisection.
MAX_TRIALS = 8

# Event functions, one per `Event`.
Margins = tuple[float, float, float, float, float, float, float]


class Advance(NamedTuple):
    """Result of a step."""

    event: int  # the `Event` that ended it, or -1 for none
    taken: float  # s
    y: State  # state at its end
    k: State  # rates and event functions there, of use if no event ended it
    g: Margins


class Step(NamedTuple):
    """A whole step, in one stage, within which an event is located."""

    t: float  # time at its start, s
    dt: float  # its length, s
    y: State  # state and rates at its start
    k: State
    y_end: State  # and at its end
    k_end: State
    s: Stage
    p: Parameters
    V_arrest: float


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


def step_to_event(
    t: float, y: State, k: State, g: Margins, s: Stage, p: Parameters, dt: float, V_arrest: float, rough: bool
) -> Advance:
    """Take a step of dt, s, from time t, s, or the part of it up to its earliest event.

    The rates at y are k and the event functions g.  If ``rough``, events are those of the cubic through the step.
    """
    y_end = step(y, k, s, p, dt)
    k_end = rates(y_end, s, p)
    g_end = event_functions(t + dt, y_end, s, p, V_arrest)
    fraction, y_after, g_after = 1.0, y_end, g_end
    j = first_negative(g_after, -1)
    if j < 0 and s.moving:
        # An event that comes and goes within the step does so about where a velocity turns.
        turn = turning_point(k, k_end)
        if turn < 1.0:
            fraction = turn
            y_after = step(y, k, s, p, turn * dt)
            g_after = event_functions(t + turn * dt, y_after, s, p, V_arrest)
            j = first_negative(g_after, -1)
    if j < 0:
        return Advance(-1, dt, y_end, k_end, g_end)
    whole = Step(t, dt, y, k, y_end, k_end, s, p, V_arrest)
    # Each event found shortens the interval, and may reveal another that had come and gone within it.
    for _ in range(2 * EVENTS):
        event = j
        if g[j] < 0.0:
            fraction, y_after = 0.0, y
        elif not g_after[j] >= EVENT_TOLERANCE * (g_after[j] - g[j]) / fraction:
            x, after, slope = root_on_cubic(j, whole, g[j], g_after[j], fraction)
            if not rough or is_bent(y, k, y_end, k_end, dt):
                fraction, y_after = confirm_event(j, whole, x, slope, fraction, y_after)
            elif after < fraction:
                fraction, y_after = after, state_within(y, k, y_end, k_end, dt, after)
        g_after = event_functions(t + fraction * dt, y_after, s, p, V_arrest)
        j = first_negative(g_after, event)
        if j < 0:
            break
    return Advance(event, fraction * dt, y_after, k_end, g_end)


def first_negative(g: Margins, other_than: int) -> int:
    """Return the first event whose function is negative or not a number, other than one; -1 if there is none."""
    for j in range(EVENTS):
        if j != other_than and not g[j] >= 0.0:
            return j
    return -1


def is_bent(y: State, k: State, y_end: State, k_end: State, dt: float) -> bool:
    """Return whether the rates at the ends of a step do not fit the change of the velocities, as far past an event."""
    V = y_end.V - y.V - 0.5 * dt * (k.V + k_end.V)
    W = y_end.W - y.W - 0.5 * dt * (k.W + k_end.W)
    return not abs(V) + abs(W) <= GREATEST_BEND * y.V


def turning_point(k: State, k_end: State) -> float:
    """Return the fraction of a step at which W stops falling or V - W turns, by the rates at its ends; 1 for none."""
    turn = 1.0
    if k.W < 0.0 < k_end.W:
        turn = k.W / (k.W - k_end.W)
    before, after = k.V - k.W, k_end.V - k_end.W
    if before * after < 0.0:
        turn = min(turn, before / (before - after))
    return turn


def root_on_cubic(j: int, whole: Step, g_low: float, g_high: float, high: float) -> tuple[float, float, float]:
    """Return the fractions of a step at and after which event j happens on its cubic, and the slope of g there.

    The event function g is ``g_low`` >= 0 at the start of the step and ``g_high`` < 0 at the fraction ``high``.  The
    secant method is used, towards just after the event, and bisection where it leaves the interval.
    """
    t, dt, y, k, y_end, k_end, s, p, V_arrest = whole
    low = 0.0
    x1, g1, x2, g2 = 0.0, g_low, high, g_high
    slope = 0.0
    for _ in range(MAX_TRIALS):
        slope = (g2 - g1) / (x2 - x1)
        x = x2 - g2 / slope if slope < 0.0 else low
        if low < x < high and abs(x - x2) <= CUBIC_TOLERANCE and g2 < 0.0:
            return x, x2, slope
        x += 0.5 * CUBIC_TOLERANCE
        if not low < x < high:
            x = 0.5 * (low + high)
        x1, g1, x2 = x2, g2, x
        g2 = event_functions(t + x * dt, state_within(y, k, y_end, k_end, dt, x), s, p, V_arrest)[j]
        if g2 >= 0.0:
            low = x
        else:
            high = x
    return x2, high, slope


def confirm_event(j: int, whole: Step, x: float, slope: float, high: float, y_high: State) -> tuple[float, State]:
    """Return the fraction of a step just after event j, within `EVENT_TOLERANCE`, and the state there.

    The event has happened at the fraction ``high``, in state ``y_high``.  Steps confirm it, the first up to its
    estimate x, where the event function has the slope given, and the next where that slope leads.
    """
    t, dt, y, k, _, _, s, p, V_arrest = whole
    low = 0.0
    x1, g1 = -1.0, 0.0  # the point before
    trials = 0
    while high - low > EVENT_TOLERANCE:
        if trials >= MAX_TRIALS or not low < x < high:
            x = 0.5 * (low + high)
        y_x = step(y, k, s, p, x * dt)
        g = event_functions(t + x * dt, y_x, s, p, V_arrest)[j]
        if g >= 0.0:
            low = x
        else:
            high, y_high = x, y_x
            if g >= slope * EVENT_TOLERANCE:
                break
        if trials > 0:
            slope = (g - g1) / (x - x1)
        x1, g1 = x, g
        x = x - g / slope + 0.5 * EVENT_TOLERANCE if slope < 0.0 else low
        trials += 1
    return high, y_high


def after_event(event: int, y: State, s: Stage, p: Parameters) -> tuple[State, Stage, Outcome]:
    """Return the state, stage and outcome after an event, from the state at the event."""
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
        # Removes rounding: W is 0 here, and so is the bulge of a motion that ends as it begins.
        y = State(y.Z, y.L, y.V, 0.0, max(y.h, 0.0))
    return y, select_stage(s.medium, y, p, s.Vs1, s.h_s), Outcome.RUNNING
