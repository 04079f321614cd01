"""Event functions, the location of events and what follows them."""

from typing import Any

import pytest

from armour.core import events
from armour.core.equations import crack_velocity
from armour.core.events import Event, after_event, event_functions, interpolated, locate_event, step_to_event
from armour.core.rk4 import step
from armour.core.stages import first_stage, rates, stage_name
from armour.core.state import Medium, Outcome, Stage, State
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
    assert after_event(Event.ARREST, y, plate, p)[2] == Outcome.DEFEATED
    assert after_event(Event.ERODED, y, plate, p)[2] == Outcome.DEFEATED


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


def test_the_earliest_of_several_events_is_located():
    """Within a step of 6 us the crack arrives, the plate moves and stops, and the velocity falls."""
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    event, taken, _ = step_to_event(0.0, y, rates(y, first_stage(y, p), p), first_stage(y, p), p, 6e-6, 799.0)
    assert event == Event.ARREST
    event, taken, after = step_to_event(0.0, y, rates(y, first_stage(y, p), p), first_stage(y, p), p, 6e-6, 1.0)
    assert event == Event.MEDIUM
    assert after.Z + crack_velocity(p.Ec, p.rho_c) * taken == pytest.approx(p.Hc0, rel=1e-12)


def test_an_event_that_comes_and_goes_before_a_later_one_is_found():
    """The front passes the back face and returns within the step, as the carried plate reverses."""
    p = armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, Yp=1e8, tau=3e9, Hb=2e-3)
    s = Stage(Medium.PLATE, True, False, True, 500.0, 0.0)
    y = State(Z=2e-3 - 1e-12, L=0.02, V=100.0, W=0.5, h=2e-3 - 1e-12)
    k1 = rates(y, s, p)
    dt = 4.0 * y.W / -k1.W
    assert step(y, k1, s, p, dt).Z < y.Z
    event, taken, after = step_to_event(0.0, y, k1, s, p, dt, 1.0)
    assert event == Event.MEDIUM
    assert pytest.approx(2e-3, rel=1e-12) == after.Z
    assert after.W > 0.0
    assert taken < y.W / -k1.W


def test_an_event_that_has_happened_at_the_start_of_a_step_is_located_there():
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    assert locate_event(Event.MEDIUM, 0.0, y, rates(y, s, p), s, p, 1e-7, 1.0, -1.0, -2.0, 1.0, y) == (0.0, y)


def test_an_event_is_located_with_few_evaluations(monkeypatch: pytest.MonkeyPatch):
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    k1 = rates(y, s, p)
    dt = 4e-6
    g_lo = event_functions(0.0, y, s, p, 1.0)[Event.MEDIUM]
    calls = []

    def counted(*args: Any) -> State:
        calls.append(args)
        return step(*args)

    monkeypatch.setattr(events, "step", counted)
    y_end = step(y, k1, s, p, dt)
    g_hi = event_functions(dt, y_end, s, p, 1.0)[Event.MEDIUM]
    fraction, there = locate_event(Event.MEDIUM, 0.0, y, k1, s, p, dt, 1.0, g_lo, g_hi, 1.0, y_end)
    assert len(calls) <= 7
    assert there == step(y, k1, s, p, fraction * dt)
    before = step(y, k1, s, p, (fraction - 1.1e-12) * dt)
    assert event_functions(fraction * dt, there, s, p, 1.0)[Event.MEDIUM] < 0.0
    assert event_functions((fraction - 1.1e-12) * dt, before, s, p, 1.0)[Event.MEDIUM] >= 0.0


@pytest.mark.parametrize("root", [1e-9, 0.02, 0.3, 0.77, 1.0 - 1e-9])
@pytest.mark.parametrize("bend", [-50.0, -1.0, 0.0, 1.0, 50.0])
def test_interpolation_stays_in_the_bracket_and_finds_a_parabola_at_once(root: float, bend: float):
    """Three points determine x as a parabola of g."""

    def x_of(g: float) -> float:
        return root - g + bend * 1e-3 * g * g

    x, other, last = x_of(0.1), x_of(-0.2), x_of(0.3)
    part = interpolated(x, 0.1, other, -0.2, last, 0.3)
    assert 0.0 < part < 1.0
    if part != 0.5:
        assert x + part * (other - x) == pytest.approx(root, abs=1e-12)
    else:
        assert bend in (-50.0, 50.0)


def test_the_earlier_of_two_events_in_intact_ceramic_is_located():
    """Dwell begins early in a step by whose end the crack has arrived too."""
    p = armour()
    limit = ((p.Yc0 - p.Yp) / p.rho_p) ** 0.5
    y = State(Z=0.0, L=p.L0, V=limit + 0.5, W=0.0, h=0.0)
    s = first_stage(y, p)
    dt = 1.5 * p.Hc0 / crack_velocity(p.Ec, p.rho_c)
    k1 = rates(y, s, p)
    after = event_functions(dt, step(y, k1, s, p, dt), s, p, 1.0)
    assert after[Event.MEDIUM] < 0.0 > after[Event.TARGET]
    event, taken, there = step_to_event(0.0, y, k1, s, p, dt, 1.0)
    assert event == Event.TARGET
    assert 0.0 < taken < 0.1 * dt
    assert pytest.approx(limit, rel=1e-9) == there.V
