"""An impact from its start to its end: step, land on the earliest event, change the stage, record."""

from math import isfinite
from typing import NamedTuple

from armour.core.rk4 import step
from armour.core.stages import Event, first_stage, follow, margins, rates, step_length
from armour.core.state import Armour, Outcome, Stage, State

# An event is located to this fraction of a step.
EVENT_TOLERANCE = 1e-14


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
    a: Armour,
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
    y = State(Z=0.0, L=a.L0, V=Vi, W=0.0, h=0.0)
    s = first_stage(y, a)
    steps = 0
    rest = 0.0  # what an event has left of a step
    outcome = Outcome.RUNNING if Vi >= V_arrest else Outcome.DEFEATED
    if trace is not None:
        trace.append(Instant(t, y, s))
    while outcome == Outcome.RUNNING:
        if steps == max_steps:
            return Run(Outcome.UNRESOLVED, t, y, steps)
        k = rates(y, s, a)
        longest = step_length(y, k, s, a, dt)
        whole = min(rest, longest) if rest > 0.0 else longest
        event, taken, y = land(t, y, k, s, a, whole, V_arrest)
        t += taken
        rest = whole - taken
        steps += 1
        ended = s
        if event >= 0:
            y, s, outcome = follow(event, y, s, a)
        if trace is not None:
            trace.append(Instant(t, y, ended))
            if s != ended:
                trace.append(Instant(t, y, s))
    return Run(outcome, t, y, steps)


def land(t: float, y: State, k1: State, s: Stage, a: Armour, dt: float, V_arrest: float) -> tuple[int, float, State]:
    """Take a step, or the part of it up to the earliest event in it; k1 are the rates now.

    Returns the event (-1 for none), the time taken and the state there.
    """
    start = margins(t, y, s, a, V_arrest)
    y_end = step(y, k1, s, a, dt)
    end = margins(t + dt, y_end, s, a, V_arrest)
    event, fraction = -1, 1.0
    # Each event found shortens what the others are looked for in, and can lay bare one that came and went before it.
    for i in range(2 * len(Event)):
        k = i % len(Event)
        if k != event and not end[k] >= 0.0:
            event = k
            fraction, y_end = crossing(k, t, y, k1, s, a, dt, V_arrest, start[k], end[k], fraction)
            end = margins(t + fraction * dt, y_end, s, a, V_arrest)
    return event, fraction * dt, y_end


def crossing(
    k: int,
    t: float,
    y: State,
    k1: State,
    s: Stage,
    a: Armour,
    dt: float,
    V_arrest: float,
    g_lo: float,
    g_hi: float,
    hi: float,
) -> tuple[float, State]:
    """Fraction of the step at which event k has just happened, and the state there.

    Regula falsi (Illinois), with a bisection wherever two estimates did not halve the bracket.
    """
    if g_lo < 0.0:
        return 0.0, y
    lo = 0.0
    side, tries, width = 0, 0, hi
    while hi - lo > EVENT_TOLERANCE:
        if tries < 2 and isfinite(g_hi):
            x = lo + (hi - lo) * g_lo / (g_lo - g_hi)
            x = min(max(x, lo + 0.5 * EVENT_TOLERANCE), hi - 0.5 * EVENT_TOLERANCE)
        else:
            x = 0.5 * (lo + hi)
        g = margins(t + x * dt, step(y, k1, s, a, x * dt), s, a, V_arrest)[k]
        if g >= 0.0:
            lo, g_lo = x, g
            g_hi *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            hi, g_hi = x, g
            g_lo *= 0.5 if side == -1 else 1.0
            side = -1
        tries += 1
        if hi - lo <= 0.5 * width:
            width, tries = hi - lo, 0
    return hi, step(y, k1, s, a, hi * dt)
