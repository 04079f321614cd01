"""Stepping, landing on events, changing the stage and recording."""

import sys
from itertools import pairwise
from typing import Any

import pytest

from armour.core.equations import crack_velocity
from armour.core.rk4 import step
from armour.core.run import Instant, interpolated, locate_event, run, step_to_event
from armour.core.stages import Event, default_time_step, event_functions, first_stage, rates
from armour.core.state import Medium, Outcome, Stage, State
from tests.cases import armour, path, traced


def test_events_of_the_wilkins_case_land_where_they_happen():
    a = armour()
    end, trace = traced(a, 800.0)
    assert path(trace) == ["Ieph", "Fepm", "Feph", "Prpm", "Prcm"]
    changes = [(b, c) for b, c in pairwise(trace) if b.s != c.s]
    assert all(before.t == after.t for before, after in changes)
    cracked, stopped, entered, together = (after for _, after in changes)
    assert cracked.y.Z + crack_velocity(a.Ec, a.rho_c) * cracked.t == pytest.approx(a.Hc0, rel=1e-13)
    assert stopped.y.W == 0.0
    assert pytest.approx(a.Hc0, rel=1e-13) == entered.y.Z
    assert together.y.W == together.y.V
    assert end.outcome == Outcome.PERFORATED
    assert pytest.approx(a.Hc0 + a.Hb, rel=1e-13) == end.y.Z


def test_time_never_runs_back_and_the_state_is_continuous_but_for_what_snaps():
    _, trace = traced(armour(), 800.0)
    for before, after in pairwise(trace):
        assert after.t >= before.t
        if after.t == before.t:
            assert after.y == pytest.approx(before.y, rel=1e-12, abs=1e-9)


def test_a_trace_does_not_change_the_run():
    a = armour()
    end, _ = traced(a, 800.0)
    assert end == run(a, 800.0, default_time_step(a, 800.0), 1.0, 200_000)


def test_the_earliest_of_several_events_counts():
    """In one step of 6 us the crack passes, the plate would move and stop, and the velocity would fall."""
    a = armour()
    y = State(Z=0.0, L=a.L0, V=800.0, W=0.0, h=0.0)
    event, taken, _ = step_to_event(0.0, y, rates(y, first_stage(y, a), a), first_stage(y, a), a, 6e-6, 799.0)
    assert event == Event.ARREST
    event, taken, after = step_to_event(0.0, y, rates(y, first_stage(y, a), a), first_stage(y, a), a, 6e-6, 1.0)
    assert event == Event.MEDIUM
    assert after.Z + crack_velocity(a.Ec, a.rho_c) * taken == pytest.approx(a.Hc0, rel=1e-12)


def test_an_event_that_comes_and_goes_before_a_later_one_is_found():
    """The front passes the back face and, as the carried plate turns, comes back within the step."""
    a = armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, Yp=1e8, tau=3e9, Hb=2e-3)
    s = Stage(Medium.PLATE, True, False, True, 500.0, 0.0)
    y = State(Z=2e-3 - 1e-12, L=0.02, V=100.0, W=0.5, h=2e-3 - 1e-12)
    k1 = rates(y, s, a)
    dt = 4.0 * y.W / -k1.W
    assert step(y, k1, s, a, dt).Z < y.Z
    event, taken, after = step_to_event(0.0, y, k1, s, a, dt, 1.0)
    assert event == Event.MEDIUM
    assert pytest.approx(2e-3, rel=1e-12) == after.Z
    assert after.W > 0.0
    assert taken < y.W / -k1.W


def test_an_event_that_has_happened_at_the_start_is_landed_on_there():
    a = armour()
    y = State(Z=0.0, L=a.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, a)
    assert locate_event(Event.MEDIUM, 0.0, y, rates(y, s, a), s, a, 1e-7, 1.0, -1.0, -2.0, 1.0, y) == (0.0, y)


def test_an_event_is_located_with_few_evaluations(monkeypatch: pytest.MonkeyPatch):
    a = armour()
    y = State(Z=0.0, L=a.L0, V=800.0, W=0.0, h=0.0)
    s = first_stage(y, a)
    k1 = rates(y, s, a)
    dt = 4e-6
    g_lo = event_functions(0.0, y, s, a, 1.0)[Event.MEDIUM]
    calls = []

    def counted(*args: Any) -> State:
        calls.append(args)
        return step(*args)

    monkeypatch.setattr(sys.modules["armour.core.run"], "step", counted)
    y_end = step(y, k1, s, a, dt)
    g_hi = event_functions(dt, y_end, s, a, 1.0)[Event.MEDIUM]
    fraction, there = locate_event(Event.MEDIUM, 0.0, y, k1, s, a, dt, 1.0, g_lo, g_hi, 1.0, y_end)
    assert len(calls) <= 7
    assert there == step(y, k1, s, a, fraction * dt)
    before = step(y, k1, s, a, (fraction - 1.1e-12) * dt)
    assert event_functions(fraction * dt, there, s, a, 1.0)[Event.MEDIUM] < 0.0
    assert event_functions((fraction - 1.1e-12) * dt, before, s, a, 1.0)[Event.MEDIUM] >= 0.0


@pytest.mark.parametrize("root", [1e-9, 0.02, 0.3, 0.77, 1.0 - 1e-9])
@pytest.mark.parametrize("bend", [-50.0, -1.0, 0.0, 1.0, 50.0])
def test_interpolation_stays_in_the_bracket_and_finds_a_parabola_at_once(root: float, bend: float):
    """As a function of g, x is a parabola; three points give it away."""

    def x_of(g: float) -> float:
        return root - g + bend * 1e-3 * g * g

    x, other, last = x_of(0.1), x_of(-0.2), x_of(0.3)
    part = interpolated(x, 0.1, other, -0.2, last, 0.3)
    assert 0.0 < part < 1.0
    if part != 0.5:
        assert x + part * (other - x) == pytest.approx(root, abs=1e-12)
    else:
        assert bend in (-50.0, 50.0)


def test_a_stop_shortly_after_the_start_of_motion_is_found():
    """The plate's velocity is 0 at both ends of the bracket's first part; the later zero is the event."""
    a = armour(ceramic_mm=6.9)
    _, trace = traced(a, 740.0, 1e-6)
    fine = traced(a, 740.0, 1e-8)[1]
    assert path(trace) == path(fine)


def test_a_velocity_below_the_arrest_velocity_is_defeated_at_once():
    end = run(armour(), 0.5, 1e-7, 1.0, 1000)
    assert (end.outcome, end.t, end.steps) == (Outcome.DEFEATED, 0.0, 0)


def test_a_step_that_is_rounding_to_the_motion_is_lengthened():
    a = armour()
    shortest = run(a, 800.0, 1e-30, 1.0, 100_000)
    usual = run(a, 800.0, default_time_step(a, 800.0) / 8.0, 1.0, 1000)
    assert shortest.y == pytest.approx(usual.y, rel=1e-7)


def test_a_run_that_takes_too_many_steps_is_given_up():
    assert run(armour(), 800.0, 1e-9, 1.0, 100).outcome == Outcome.UNRESOLVED


def test_a_projectile_can_erode_away():
    """A soft rod dwells on a hard plate."""
    a = armour(ceramic=None, ceramic_mm=0.0)._replace(Yp=1e7, YB=50e9, tau=1e12)
    end, trace = traced(a, 1500.0)
    assert end.outcome == Outcome.DEFEATED
    assert pytest.approx(1e-3 * a.L0, rel=1e-6) == end.y.L
    assert path(trace) == ["Pech"]


def test_a_hard_plate_is_carried_by_an_eroding_projectile():
    """(iii) 2: the plate does not yield and is sheared out whole."""
    a = armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, tau=300e6, Hb=3e-3)
    end, trace = traced(a, 900.0)
    assert path(trace) == ["Pecm", "Prcm"]
    assert end.outcome == Outcome.PERFORATED
    assert trace[0].s.medium == Medium.PLATE


def test_a_run_that_is_given_up_says_how_far_it_came():
    a = armour()
    dt = default_time_step(a, 800.0)
    trace: list[Instant] = []
    end = run(a, 800.0, dt, 1.0, 3, trace)
    assert (end.outcome, end.steps) == (Outcome.UNRESOLVED, 3)
    assert (end.t, end.y) == (trace[-1].t, trace[-1].y)
    assert end.t == pytest.approx(3 * dt)


def test_steps_are_counted():
    trace: list[Instant] = []
    end = run(armour(), 800.0, default_time_step(armour(), 800.0), 1.0, 10_000, trace)
    assert end.steps == sum(after.t > before.t for before, after in pairwise(trace))


def test_of_two_events_in_intact_ceramic_the_earlier_counts():
    """Slowing, the projectile comes to dwell on the ceramic within the step at whose end the crack has arrived too."""
    a = armour()
    limit = ((a.Yc0 - a.Yp) / a.rho_p) ** 0.5
    y = State(Z=0.0, L=a.L0, V=limit + 0.5, W=0.0, h=0.0)
    s = first_stage(y, a)
    dt = 1.5 * a.Hc0 / crack_velocity(a.Ec, a.rho_c)
    k1 = rates(y, s, a)
    after = event_functions(dt, step(y, k1, s, a, dt), s, a, 1.0)
    assert after[Event.MEDIUM] < 0.0 > after[Event.TARGET]
    event, taken, there = step_to_event(0.0, y, k1, s, a, dt, 1.0)
    assert event == Event.TARGET
    assert 0.0 < taken < 0.1 * dt
    assert pytest.approx(limit, rel=1e-9) == there.V
