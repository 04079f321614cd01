"""Integration of one impact from start to end, with an optional record of every instant."""

from math import inf, sqrt
from typing import NamedTuple

from armour.core.events import after_event, event_functions, first_event
from armour.core.rk4 import state_within, step
from armour.core.stages import first_stage, rates, with_intact_strength
from armour.core.state import Outcome, Parameters, Stage, State

# Greatest error of a step by its third-order method: of depth over the armour, of the length over that of the rod, and
# of the velocity over that of impact, together.
TOLERANCE = 4e-7
# Part of the step that this error allows which is taken, and limits of the change from one step to the next, as usual.
SAFETY, LEAST_CHANGE, GREATEST_CHANGE = 0.9, 0.2, 5.0
# First step as a part of the time in which the projectile crosses its diameter.
FIRST_STEP = 0.1


class Instant(NamedTuple):
    """State and stage at one time; a change of stage leaves two instants at the same time."""

    t: float  # time since impact, s
    y: State
    s: Stage


class Run(NamedTuple):
    """Result of a run."""

    outcome: Outcome
    t: float  # duration, s
    y: State  # state at the end
    steps: int
    # dV/dt at the end if it is constant up to the end of the armour (31), (33), m/s^2; else 0
    constant_dV: float


def run(
    p: Parameters,
    Vi: float,
    dt: float,
    V_arrest: float,
    max_steps: int,
    trace: list[Instant] | None = None,
    tolerance: float = TOLERANCE,
) -> Run:
    """Integrate one impact at Vi, m/s, by steps of dt, s, or for 0 by steps of the error that a tolerance allows.

    A step is divided at an event; the rest of a given one follows it.  The projectile counts as stopped below
    ``V_arrest``, m/s.  A run of ``max_steps`` steps ends as `Outcome.UNRESOLVED`.  ``trace`` receives every instant,
    from impact to end.
    """
    p = with_intact_strength(p)
    t = 0.0
    y = State(Z=0.0, L=p.L0, V=Vi, W=0.0, h=0.0)
    s = first_stage(y, p)
    k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
    steps, length, fixed = 0, FIRST_STEP * p.D0 / Vi, dt > 0.0
    if fixed:
        length = dt
    outcome = Outcome.RUNNING if Vi >= V_arrest else Outcome.STOPPED
    if trace is not None:
        trace.append(Instant(t, y, s))
    while outcome == Outcome.RUNNING:
        if steps == max_steps:
            return Run(Outcome.UNRESOLVED, t, y, steps, 0.0)
        steps += 1
        tried = step(t, y, k, s, p, length)
        if not fixed:
            change = allowed_change(tried.error, p, Vi, tolerance)
            length = tried.dt * change
            if change < SAFETY:
                continue
        g_end = event_functions(t + tried.dt, tried.y_end, s, p, V_arrest)
        event, x = first_event(tried, g, g_end, s, p, V_arrest)
        t += x * tried.dt
        if fixed:
            length = (1.0 - x) * tried.dt if event >= 0 and x < 1.0 else dt
        ended = s
        if event < 0:
            y, k, g = tried.y_end, tried.k_end, g_end
        else:
            y = state_within(y, k, tried.y_end, tried.k_end, tried.dt, x)
            y, s, outcome = after_event(event, y, s, p)
            k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
        if trace is not None:
            trace.append(Instant(t, y, ended))
            if s != ended:
                trace.append(Instant(t, y, s))
    return Run(outcome, t, y, steps, 0.0 if s.eroding or s.penetrated else k.V)


def allowed_change(error: State, p: Parameters, Vi: float, tolerance: float) -> float:
    """Return the factor for the length of the next step; the error is too great if it is below `SAFETY`."""
    worst = abs(error.Z) / (p.Hc0 + p.Hb) + abs(error.L) / p.L0 + (abs(error.V) + abs(error.W)) / Vi
    worst /= tolerance
    if worst == 0.0:
        return GREATEST_CHANGE
    if not worst < inf:  # a trial state far past an event may have no rates
        return LEAST_CHANGE
    return min(max(SAFETY / sqrt(sqrt(worst)), LEAST_CHANGE), GREATEST_CHANGE)
