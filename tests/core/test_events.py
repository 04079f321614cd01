"""Event functions, the location of events and what follows them."""

import pytest

from armour.core.equations import crack_velocity
from armour.core.events import Event, after_event, event_functions, first_event
from armour.core.rk4 import state_within, step
from armour.core.stages import drive_force, first_stage, rates, shear_force, stage_name
from armour.core.state import Medium, Outcome, Parameters, Stage, State
from tests.helpers.cases import armour


def struck(V: float, W: float = 0.0) -> State:
    return State(Z=0.0, L=0.02, V=V, W=W, h=0.0)


def test_no_event_function_is_negative_at_impact():
    p = armour()
    for V in (30.0, 300.0, 602.0, 603.0, 900.0, 3000.0):
        assert min(event_functions(0.0, struck(V), first_stage(struck(V), p), p, 1.0)) >= 0.0


def test_the_crack_ends_intact_ceramic_and_keeps_the_velocity():
    y = struck(750.0)
    s = first_stage(y, armour())
    _, after, outcome = after_event(Event.MEDIUM, y, s, armour())
    assert (after.medium, after.Vs1, outcome) == (Medium.FRAGMENTED, 750.0, Outcome.RUNNING)


def test_entering_the_plate_keeps_the_bulge():
    y = State(Z=6.35e-3, L=0.02, V=500.0, W=20.0, h=1e-4)
    s = Stage(Medium.FRAGMENTED, True, True, True, 700.0, 0.0)
    _, after, _ = after_event(Event.MEDIUM, y, s, armour())
    assert (after.medium, after.Vs1, after.h_s) == (Medium.PLATE, 700.0, 1e-4)


def test_ends_of_a_run():
    y, p = struck(1.0), armour()
    plate = Stage(Medium.PLATE, False, True, False, 700.0, 0.0)
    assert after_event(Event.MEDIUM, y, plate, p)[2] == Outcome.PERFORATED
    assert after_event(Event.ARREST, y, plate, p)[2] == Outcome.STOPPED
    assert after_event(Event.ERODED, y, plate, p)[2] == Outcome.STOPPED


def test_material_that_comes_to_rest_is_held():
    s = Stage(Medium.FRAGMENTED, False, True, True, 700.0, 0.0)
    y, after, _ = after_event(Event.MOTION, struck(200.0, -1e-12), s, armour())
    assert y.W == 0.0
    assert not after.moving


def test_a_plate_that_reaches_the_projectiles_velocity_is_carried():
    s = Stage(Medium.PLATE, False, True, True, 700.0, 0.0)
    y, after, _ = after_event(Event.TOGETHER, struck(200.0, 200.0 - 1e-13), s, armour())
    assert y.W == y.V
    assert stage_name(after) == "iii.4"


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


def test_a_step_without_an_event_is_whole():
    p = armour()
    y = struck(800.0)._replace(L=p.L0)
    assert located(y, first_stage(y, p), p, 1e-7)[:2] == (-1, 1.0)


def test_an_event_that_has_happened_is_at_the_start():
    p = armour()
    y = State(p.Hc0, 0.02, 700.0, 10.0, 1e-5)
    assert located(y._replace(Z=p.Hc0 + 1e-9), MOVING, p, 1e-7)[:2] == (Event.MEDIUM, 0.0)


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
