"""Integration of one impact from start to end, with an optional record of every instant."""

from typing import NamedTuple

from armour.core.events import after_event, event_functions, step_to_event
from armour.core.stages import first_stage, rates, with_intact_strength
from armour.core.state import Outcome, Parameters, Stage, State
from armour.core.stepping import step_length


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
    rough: bool = False,
) -> Run:
    """Integrate one impact at Vi, m/s, with time steps of at most about dt, s (see `armour.core.stepping.step_length`).

    A step of dt with an event is divided at the event, and its remainder is taken in the new stage.  The projectile
    counts as stopped below ``V_arrest``, m/s.  A run of ``max_steps`` steps, events included, ends as
    `Outcome.UNRESOLVED`.  A ``rough`` run takes longer steps and does not confirm events.  ``trace`` receives every
    instant, from impact to end.
    """
    p = with_intact_strength(p)
    t = 0.0
    y = State(Z=0.0, L=p.L0, V=Vi, W=0.0, h=0.0)
    s = first_stage(y, p)
    k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
    steps = 0
    rest = 0.0  # remainder of a step of dt that an event has divided, s
    outcome = Outcome.RUNNING if Vi >= V_arrest else Outcome.STOPPED
    if trace is not None:
        trace.append(Instant(t, y, s))
    while outcome == Outcome.RUNNING:
        if steps == max_steps:
            return Run(Outcome.UNRESOLVED, t, y, steps, 0.0)
        longest = step_length(y, k, s, p, dt, rough)
        whole = min(rest, longest) if rest > 0.0 else longest
        event, taken, y, k, g = step_to_event(t, y, k, g, s, p, whole, V_arrest, rough)
        t += taken
        rest = whole - taken if longest >= dt else 0.0
        steps += 1
        ended = s
        if event >= 0:
            y, s, outcome = after_event(event, y, s, p)
            k, g = rates(y, s, p), event_functions(t, y, s, p, V_arrest)
        if trace is not None:
            trace.append(Instant(t, y, ended))
            if s != ended:
                trace.append(Instant(t, y, s))
    return Run(outcome, t, y, steps, 0.0 if s.eroding or s.penetrated else k.V)
