"""Event functions, the location of events and what follows them."""

import pytest

from armour.core.equations import crack_velocity
from armour.core.events import Event, event_functions, first_event
from armour.core.rk4 import state_within, step
from armour.core.stages import drive_force, first_stage, rates, shear_force
from armour.core.state import Medium, Parameters, Stage, State
from tests.helpers.cases import armour


def struck(V: float, W: float = 0.0) -> State:
    return State(Z=0.0, L=0.02, V=V, W=W, h=0.0)


def test_no_event_function_is_negative_at_impact():
    p = armour()
    for V in (30.0, 300.0, 602.0, 603.0, 900.0, 3000.0):
        assert min(event_functions(0.0, struck(V), first_stage(struck(V), p), p, 1.0)) >= 0.0


def located(y: State, s: Stage, p: Parameters, dt: float, V_arrest: float = 1.0) -> tuple[int, float, State]:
    """The earliest event of a step, the fraction at which it happens, and the state there."""
    whole = step(0.0, y, rates(y, s, p), s, p, dt)
    g, g_end = event_functions(0.0, y, s, p, V_arrest), event_functions(dt, whole.y_end, s, p, V_arrest)
    event, x = first_event(whole, g, g_end, s, p, V_arrest)
    return event, x, state_within(y, whole.k, whole.y_end, whole.k_end, dt, x)


def test_the_earliest_of_several_events_is_located():
    """Within a step of 6 us the crack arrives, the plate moves and stops, and the velocity falls."""
    p = armour()
    y = struck(800.0)._replace(L=p.L0)
    s = first_stage(y, p)
    assert located(y, s, p, 6e-6, 799.0)[0] == Event.ARREST
    event, x, there = located(y, s, p, 6e-6)
    assert event == Event.MEDIUM
    assert there.Z + crack_velocity(p.Ec, p.rho_c) * x * 6e-6 == pytest.approx(p.Hc0, rel=1e-8)
    # Just after the event, never before it.
    assert event_functions(x * 6e-6, there, s, p, 1.0)[event] < 0.0


def test_the_earlier_of_two_events_in_intact_ceramic_is_located():
    """Dwell begins early in a step by whose end the crack has arrived too."""
    p = armour()
    limit = ((p.Yc0 - p.Yp) / p.rho_p) ** 0.5
    y = struck(limit + 0.5)._replace(L=p.L0)
    dt = 1.5 * p.Hc0 / crack_velocity(p.Ec, p.rho_c)
    event, x, there = located(y, first_stage(y, p), p, dt)
    assert event == Event.TARGET
    assert 0.0 < x < 0.1
    assert pytest.approx(limit, rel=1e-6) == there.V


MOVING = Stage(Medium.FRAGMENTED, True, True, True, 750.0, 0.0)


def test_material_that_is_held_moves_where_the_drive_force_exceeds_the_shear_force():
    p = armour()
    y = State(Z=1e-3, L=0.02, V=400.0, W=0.0, h=0.0)
    held = MOVING._replace(moving=False)
    margin = event_functions(0.0, y, held, p, 1.0)[Event.MOTION]
    assert margin == shear_force(y, held, p) - drive_force(y, held, p) > 0.0
    assert event_functions(0.0, y._replace(V=740.0), held, armour(perimeter="projectile"), 1.0)[Event.MOTION] < 0.0
