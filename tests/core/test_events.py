"""Event functions, the location of events and what follows them."""

from collections.abc import Callable
from typing import Any

import pytest

from armour.core import events
from armour.core.equations import crack_velocity
from armour.core.events import (
    EVENT_TOLERANCE,
    Advance,
    Event,
    Step,
    after_event,
    confirm_event,
    event_functions,
    is_bent,
    step_to_event,
    turning_point,
)
from armour.core.rk4 import step
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


def advance(t: float, y: State, s: Stage, p: Parameters, dt: float, V_arrest: float, rough: bool = False) -> Advance:
    """A step from a state, of which rates and event functions are those there."""
    return step_to_event(t, y, rates(y, s, p), event_functions(t, y, s, p, V_arrest), s, p, dt, V_arrest, rough)


def test_the_earliest_of_several_events_is_located():
    """Within a step of 6 us the crack arrives, the plate moves and stops, and the velocity falls."""
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    assert advance(0.0, y, first_stage(y, p), p, 6e-6, 799.0).event == Event.ARREST
    found = advance(0.0, y, first_stage(y, p), p, 6e-6, 1.0)
    assert found.event == Event.MEDIUM
    assert found.y.Z + crack_velocity(p.Ec, p.rho_c) * found.taken == pytest.approx(p.Hc0, rel=1e-11)


def test_a_step_without_an_event_ends_with_its_rates_and_event_functions():
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    found = advance(1e-7, y, s, p, 1e-7, 1.0)
    y_end = step(y, rates(y, s, p), s, p, 1e-7)
    assert found == (-1, 1e-7, y_end, rates(y_end, s, p), event_functions(2e-7, y_end, s, p, 1.0))


def test_an_event_that_comes_and_goes_within_a_step_is_found():
    """The front passes the back face and returns within the step, as the carried plate reverses."""
    p = armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, Yp=1e8, tau=3e9, Hb=2e-3)
    s = Stage(Medium.PLATE, True, False, True, 500.0, 0.0)
    y = State(Z=2e-3 - 1e-12, L=0.02, V=100.0, W=0.5, h=2e-3 - 1e-12)
    k1 = rates(y, s, p)
    dt = 4.0 * y.W / -k1.W
    assert step(y, k1, s, p, dt).Z < y.Z
    found = advance(0.0, y, s, p, dt, 1.0)
    assert found.event == Event.MEDIUM
    assert pytest.approx(2e-3, rel=1e-11) == found.y.Z
    assert found.y.W > 0.0
    assert found.taken < y.W / -k1.W


def test_where_velocities_turn():
    def turn(W: float, W_end: float, V: float = -1.0, V_end: float = -1.0) -> float:
        return turning_point(State(1.0, 0.0, V, W, 0.0), State(1.0, 0.0, V_end, W_end, 0.0))

    assert turn(-3.0, 1.0) == 0.5  # V - W turns first
    assert turn(-3.0, 1.0, -4.0, -4.0) == 0.75
    assert turn(3.0, 1.0) == 1.0
    assert turn(0.0, 1.0) == 1.0
    assert turn(-3.0, -2.0) == 1.0
    assert turn(1.0, -3.0) == 0.5


def test_an_event_that_has_happened_at_the_start_of_a_step_is_located_there():
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    past = (-1.0, *event_functions(0.0, y, s, p, 1.0)[1:])
    found = step_to_event(0.0, y, rates(y, s, p), past, s, p, 4e-6, 1.0, False)
    assert (found.event, found.taken, found.y) == (Event.MEDIUM, 0.0, y)


def test_an_event_just_before_the_end_of_a_step_is_at_its_end():
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    taken = advance(0.0, y, s, p, 4e-6, 1.0).taken
    whole = taken * (1.0 + 0.1 * EVENT_TOLERANCE)
    found = advance(0.0, y, s, p, whole, 1.0)
    assert (found.event, found.taken) == (Event.MEDIUM, whole)


MOVING = Stage(Medium.FRAGMENTED, True, True, True, 750.0, 0.0)


def step_with_events(
    monkeypatch: pytest.MonkeyPatch, margins: dict[int, Callable[[float], float]], turn: float, rough: bool = False
) -> tuple[Advance, float, int]:
    """A step with given event functions of its fraction, 1 if not given: its result, length and number of trials."""
    t0, dt, p = 5e-9, 1e-9, armour()
    y = State(Z=1e-3, L=0.02, V=700.0, W=10.0, h=1e-5)
    calls = []

    def given(t: float, *_: Any) -> tuple[float, ...]:
        x = (t - t0) / dt
        return tuple(margins[j](x) if j in margins else 1.0 for j in range(7))

    def counted(*args: Any) -> State:
        calls.append(args)
        return step(*args)

    monkeypatch.setattr(events, "event_functions", given)
    monkeypatch.setattr(events, "turning_point", lambda *_: turn)
    monkeypatch.setattr(events, "step", counted)
    found = step_to_event(t0, y, rates(y, MOVING, p), given(t0), MOVING, p, dt, 1.0, rough)  # type: ignore[arg-type]
    return found, dt, len(calls)


@pytest.mark.parametrize("rough", [False, True])
@pytest.mark.parametrize("j", range(7))
def test_each_event_that_comes_and_goes_is_found_where_a_velocity_turns(
    monkeypatch: pytest.MonkeyPatch, j: int, rough: bool
):
    found, dt, _ = step_with_events(monkeypatch, {j: lambda x: (x - 0.25) * (x - 0.75)}, 0.5, rough)
    assert found.event == j
    assert found.taken == pytest.approx(0.25 * dt, rel=1e-3 if rough else 1e-10)


def test_an_event_reveals_another_before_it_that_has_gone_at_the_end(monkeypatch: pytest.MonkeyPatch):
    found, dt, _ = step_with_events(monkeypatch, {0: lambda x: 0.8 - x, 2: lambda x: (x - 0.3) * (x - 0.9)}, 1.0)
    assert found.event == 2
    assert found.taken == pytest.approx(0.3 * dt)


def test_material_that_is_held_moves_where_the_drive_force_exceeds_the_shear_force():
    p = armour()
    y = State(Z=1e-3, L=0.02, V=400.0, W=0.0, h=0.0)
    held = MOVING._replace(moving=False)
    margin = event_functions(0.0, y, held, p, 1.0)[Event.MOTION]
    assert margin == shear_force(y, held, p) - drive_force(y, held, p) > 0.0
    assert event_functions(0.0, y._replace(V=740.0), held, armour(perimeter="projectile"), 1.0)[Event.MOTION] < 0.0


def test_an_event_is_located_on_the_cubic_and_confirmed_by_few_steps(monkeypatch: pytest.MonkeyPatch):
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    k = rates(y, s, p)
    dt = 4e-6
    calls = []

    def counted(*args: Any) -> State:
        calls.append(args)
        return step(*args)

    evaluations = []

    def evaluated(*args: Any) -> Any:
        evaluations.append(args)
        return event_functions(*args)

    monkeypatch.setattr(events, "step", counted)
    monkeypatch.setattr(events, "event_functions", evaluated)
    found = advance(0.0, y, s, p, dt, 1.0)
    assert len(calls) <= 1 + 3
    assert len(evaluations) <= 8
    fraction = found.taken / dt
    assert found.y == step(y, k, s, p, fraction * dt)
    before = step(y, k, s, p, (fraction - 1.1 * EVENT_TOLERANCE) * dt)
    assert event_functions(found.taken, found.y, s, p, 1.0)[Event.MEDIUM] < 0.0
    assert event_functions((fraction - 1.1 * EVENT_TOLERANCE) * dt, before, s, p, 1.0)[Event.MEDIUM] >= 0.0


def test_a_rough_step_ends_on_the_cubic(monkeypatch: pytest.MonkeyPatch):
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    usual = advance(0.0, y, s, p, 4e-6, 1.0)
    calls = []

    def counted(*args: Any) -> State:
        calls.append(args)
        return step(*args)

    monkeypatch.setattr(events, "step", counted)
    rough = advance(0.0, y, s, p, 4e-6, 1.0, rough=True)
    assert len(calls) == 1
    assert rough.event == Event.MEDIUM
    assert rough.taken == pytest.approx(usual.taken, rel=1e-3)
    assert tuple(rough.y) == pytest.approx(tuple(usual.y), rel=1e-3, abs=1e-9)
    assert event_functions(rough.taken, rough.y, s, p, 1.0)[Event.MEDIUM] < 0.0


def test_the_cubic_is_not_trusted_where_rates_and_velocities_differ():
    y, dt = struck(600.0, 100.0), 1e-6
    k = State(600.0, 0.0, -1e7, 2e7, 100.0)
    end = State(6e-4, 0.02, 590.0, 120.0, 1e-4)
    assert not is_bent(y, k, end, k, dt)
    assert is_bent(y, k, end, k._replace(V=-1e8), dt)
    assert is_bent(y, k, end, k._replace(W=2e8), dt)
    assert is_bent(y, k, end, k._replace(W=float("nan")), dt)
    for V in (590.0 - 29.0, 590.0 + 29.0):
        assert not is_bent(y, k, end._replace(V=V), k, dt)
    for V in (590.0 - 31.0, 590.0 + 31.0):
        assert is_bent(y, k, end._replace(V=V), k, dt)


def test_a_confirmation_with_a_wrong_slope_ends_by_bisection():
    p = armour()
    y = State(Z=0.0, L=p.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, p)
    k, dt = rates(y, s, p), 4e-6
    right = advance(0.0, y, s, p, dt, 1.0).taken / dt
    end = step(y, k, s, p, dt)
    whole = Step(0.0, dt, y, k, end, rates(end, s, p), s, p, 1.0)
    for slope in (0.0, 1.0, -1e-9, -1e9):
        fraction, there = confirm_event(0, whole, 0.5, slope, 1.0, end)
        assert fraction == pytest.approx(right, abs=2.0 * EVENT_TOLERANCE)
        assert event_functions(fraction * dt, there, s, p, 1.0)[0] < 0.0


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
    found = advance(0.0, y, s, p, dt, 1.0)
    assert found.event == Event.TARGET
    assert 0.0 < found.taken < 0.1 * dt
    assert pytest.approx(limit, rel=1e-9) == found.y.V
