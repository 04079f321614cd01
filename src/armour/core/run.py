"""An impact from its start to its end: step, land on the earliest event, change the stage, record."""

from math import isfinite
from typing import NamedTuple

from armour.core.rk4 import step
from armour.core.stages import EVENTS, after_event, event_functions, first_stage, rates, step_length
from armour.core.state import Outcome, Parameters, Stage, State

# An event is located to this fraction of a step.
EVENT_TOLERANCE = 1e-12


class Instant(NamedTuple):
    """What is known at one time; a change of stage leaves two instants at the same time."""

    t: float  # time since impact, s
    y: State
    s: Stage


class Run(NamedTuple):
    """How a run ended."""

    outcome: Outcome
    t: float  # duration, s
    y: State  # state at the end
    steps: int


def run(
    p: Parameters,
    Vi: float,
    dt: float,
    V_arrest: float,
    max_steps: int,
    trace: list[Instant] | None = None,
) -> Run:
    """Integrate one impact.

    Parameters
    ----------
    a : Armour
        The projectile and the armour.
    Vi : float
        Impact velocity, m/s.
    dt : float
        Time step, s.  A step that holds an event is shortened to land on it, and the rest of it is taken in the new
        stage; see also `armour.core.stages.step_length`.
    V_arrest : float
        Velocity below which the projectile counts as stopped, m/s.
    max_steps : int
        Number of steps, events included, after which the run is given up as `Outcome.UNRESOLVED`.
    trace : list of Instant, optional
        Receives every instant, from impact to end.

    Returns
    -------
    Run
    """
    t = 0.0
    y = State(Z=0.0, L=p.L0, V=Vi, W=0.0, h=0.0)
    s = first_stage(y, p)
    steps = 0
    rest = 0.0  # what an event has left of a step
    outcome = Outcome.RUNNING if Vi >= V_arrest else Outcome.DEFEATED
    if trace is not None:
        trace.append(Instant(t, y, s))
    while outcome == Outcome.RUNNING:
        if steps == max_steps:
            return Run(Outcome.UNRESOLVED, t, y, steps)
        k = rates(y, s, p)
        longest = step_length(y, k, s, p, dt)
        whole = min(rest, longest) if rest > 0.0 else longest
        event, taken, y = step_to_event(t, y, k, s, p, whole, V_arrest)
        t += taken
        rest = whole - taken
        steps += 1
        ended = s
        if event >= 0:
            y, s, outcome = after_event(event, y, s, p)
        if trace is not None:
            trace.append(Instant(t, y, ended))
            if s != ended:
                trace.append(Instant(t, y, s))
    return Run(outcome, t, y, steps)


def step_to_event(
    t: float, y: State, k1: State, s: Stage, p: Parameters, dt: float, V_arrest: float
) -> tuple[int, float, State]:
    """Take a step, or the part of it up to the earliest event in it; k1 are the rates now.

    Returns the event (-1 for none), the time taken and the state there.
    """
    start = event_functions(t, y, s, p, V_arrest)
    y_end = step(y, k1, s, p, dt)
    end = event_functions(t + dt, y_end, s, p, V_arrest)
    event, fraction = -1, 1.0
    # Each event found shortens what the others are looked for in, and can lay bare one that came and went before it.
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
    """Fraction of the step at which event k has just happened, and the state there.

    Chandrupatla's method: inverse quadratic interpolation where that is safe, else bisection.  ``x`` is the newest
    fraction, ``other`` the end of the bracket on the other side of the event.
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
    """Where between x and the other end of a bracket the root is: by inverse quadratic interpolation, or the middle."""
    xi = (x - other) / (last - other)
    phi = (g - g_other) / (g_last - g_other)
    if not (phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi):
        return 0.5
    return g / (g_other - g) * g_last / (g_other - g_last) + (last - x) / (other - x) * g / (g_last - g) * g_other / (
        g_last - g_other
    )
