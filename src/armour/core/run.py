"""Integration of one impact from start to end, with an optional record of every instant."""

from math import inf, sqrt
from typing import NamedTuple

from armour.core.events import after_event, event_functions, first_event
from armour.core.rk4 import state_within, step
from armour.core.stages import first_stage, rates, with_intact_strength
from armour.core.state import Outcome, Parameters, Stage, State

# Greatest error of a step, estimated by its third-order method: the sum of the errors of the depth over the armour's
# thickness, of the length over that at impact, and of the velocities over the impact velocity.
TOLERANCE = 4e-7
# The same for a fixed step, which is shortened where its error exceeds this: at the back face, where the plate ahead
# vanishes.
LARGEST_ERROR = 1e-2
# Usual step control: the part of the allowed step that is taken, and the limits of the change from step to step.
SAFETY, LEAST_CHANGE, GREATEST_CHANGE = 0.9, 0.2, 5.0
# First step, as a part of the time in which the projectile moves by its diameter.
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
    """Integrate one impact at Vi, m/s, with fixed steps of dt, s, or, if dt is 0, with steps whose error is controlled.

    An event ends a step early; the rest of a fixed step follows it.  A fixed step is shortened where it would fail.
    The projectile counts as stopped below ``V_arrest``, m/s.  A run that takes ``max_steps`` steps ends as
    `Outcome.UNRESOLVED`.  ``trace`` receives every instant from impact to end.
    """
    p = with_intact_strength(p)
    t = 0.0
    y = State(Z=0.0, L=p.L0, V=Vi, W=0.0, h=0.0)
    s = first_stage(y, p)
    k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
    steps, fixed = 0, dt > 0.0
    length = dt if fixed else FIRST_STEP * p.D0 / Vi
    outcome = Outcome.RUNNING if Vi >= V_arrest else Outcome.STOPPED
    if trace is not None:
        trace.append(Instant(t, y, s))
    while outcome == Outcome.RUNNING:
        if steps == max_steps:
            return Run(Outcome.UNRESOLVED, t, y, steps, 0.0)
        steps += 1
        trial = step(t, y, k, s, p, length)
        change = allowed_change(trial.error, p, Vi, LARGEST_ERROR if fixed else tolerance)
        length = dt if fixed and change >= SAFETY else trial.dt * change
        if change < SAFETY:
            continue
        g_end = event_functions(t + trial.dt, trial.y_end, s, p, V_arrest)
        event, x = first_event(trial, g, g_end, s, p, V_arrest)
        t += x * trial.dt
        if fixed and event >= 0 and x < 1.0:
            length = (1.0 - x) * trial.dt
        ended = s
        if event < 0:
            y, k, g = trial.y_end, trial.k_end, g_end
        else:
            y = state_within(y, k, trial.y_end, trial.k_end, trial.dt, x)
            y, s, outcome = after_event(event, y, s, p)
            k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
        if trace is not None:
            trace.append(Instant(t, y, ended))
            if s != ended:
                trace.append(Instant(t, y, s))
    return Run(outcome, t, y, steps, 0.0 if s.eroding or s.penetrated else k.V)


def allowed_change(error: State, p: Parameters, Vi: float, tolerance: float) -> float:
    """Return the factor from a step's length to the next one's; the step is repeated if it is below `SAFETY`."""
    worst = abs(error.Z) / (p.Hc0 + p.Hb) + abs(error.L) / p.L0 + (abs(error.V) + abs(error.W)) / Vi
    worst /= tolerance
    if worst == 0.0:
        return GREATEST_CHANGE
    if not worst < inf:  # a trial state far past an event may have no rates
        return LEAST_CHANGE
    return min(max(SAFETY / sqrt(sqrt(worst)), LEAST_CHANGE), GREATEST_CHANGE)
