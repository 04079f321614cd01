"""Integration of an impact and its record."""

from itertools import pairwise

import pytest

from armour.core.equations import crack_velocity, intact_strength
from armour.core.run import TOLERANCE, Instant, run
from armour.core.state import Medium, Outcome
from tests.helpers.cases import armour
from tests.helpers.runs import crossing_time, path, random_designs, traced


def test_the_events_of_the_wilkins_case():
    p = armour()
    end, trace = traced(p, 800.0)
    assert path(trace) == ["Ieph", "Fepm", "Feph", "Prpm", "Prcm"]
    changes = [(b, c) for b, c in pairwise(trace) if b.s != c.s]
    assert all(before.t == after.t for before, after in changes)
    cracked, stopped, entered, together = (after for _, after in changes)
    assert cracked.y.Z + crack_velocity(p.Ec, p.rho_c) * cracked.t == pytest.approx(p.Hc0, rel=1e-8)
    assert stopped.y.W == 0.0
    assert pytest.approx(p.Hc0, rel=1e-8) == entered.y.Z
    assert together.y.W == together.y.V
    assert end.outcome == Outcome.PERFORATED
    assert pytest.approx(p.Hc0 + p.Hb, rel=1e-8) == end.y.Z


def test_a_law_of_the_flow_stress_is_the_flow_stress_that_it_gives():
    p = armour(ceramic_mm=9.0)
    law = p._replace(n_B=0.3, n_cB=-0.2, a_c=0.1, a_B=-0.05)
    Yc0 = intact_strength(p.Yc0, p.D0, p.Hc0, p.Hb, law.n_B, law.n_cB, law.a_c, law.a_B)
    assert 0.1e9 < abs(Yc0 - p.Yc0) < 1e9
    assert traced(law, 800.0) == traced(p._replace(Yc0=Yc0), 800.0)


def test_a_bare_plate_has_no_law():
    bare = armour(ceramic=None, ceramic_mm=0.0)
    assert traced(bare._replace(n_B=-3.0, n_cB=-3.0, a_c=3.0), 500.0) == traced(bare, 500.0)


def test_time_never_decreases_and_the_state_is_continuous():
    _, trace = traced(armour(), 800.0)
    for before, after in pairwise(trace):
        assert after.t >= before.t
        if after.t == before.t:
            assert after.y == pytest.approx(before.y, rel=1e-12, abs=1e-9)


def test_a_stop_shortly_after_the_start_of_motion_is_found():
    """The plate's velocity is 0 at the start of the step too; the later zero is the event."""
    p = armour(ceramic_mm=6.9)
    _, trace = traced(p, 740.0, 1e-6)
    fine = traced(p, 740.0, 1e-8)[1]
    assert path(trace) == path(fine)


def test_a_velocity_below_the_arrest_velocity_is_stopped_at_once():
    end = run(armour(), 0.5, 1e-7, 1.0, 1000)
    assert (end.outcome, end.t, end.steps) == (Outcome.STOPPED, 0.0, 0)


def test_a_projectile_can_erode_away():
    """A soft projectile dwells on a hard plate."""
    p = armour(ceramic=None, ceramic_mm=0.0)._replace(Yp=1e7, YB=50e9, tau=1e12)
    end, trace = traced(p, 1500.0)
    assert end.outcome == Outcome.STOPPED
    assert pytest.approx(1e-3 * p.L0, rel=1e-6) == end.y.L
    assert path(trace) == ["Pech"]


def test_a_hard_plate_is_carried_by_an_eroding_projectile():
    """Stage iii.2: the plate does not yield and is sheared out whole."""
    p = armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, tau=300e6, Hb=3e-3)
    end, trace = traced(p, 900.0)
    assert path(trace) == ["Pecm", "Prcm"]
    assert end.outcome == Outcome.PERFORATED
    assert trace[0].s.medium == Medium.PLATE


def test_an_unresolved_run_returns_the_state_reached():
    p = armour()
    trace: list[Instant] = []
    end = run(p, 800.0, 1e-7, 1.0, 3, trace)
    assert (end.outcome, end.steps) == (Outcome.UNRESOLVED, 3)
    assert (end.t, end.y) == (trace[-1].t, trace[-1].y)
    assert end.t == pytest.approx(3e-7)


def test_given_steps_have_their_length_and_are_divided_at_events_only():
    p, dt = armour(), 0.1e-6
    _, trace = traced(p, 800.0, dt)
    changes = {after.t for before, after in pairwise(trace) if before.s != after.s}
    on_grid = [instant.t / dt for instant in trace if instant.t not in changes and instant is not trace[-1]]
    assert len(on_grid) > 100
    assert all(abs(t - round(t)) < 1e-6 for t in on_grid)


@pytest.mark.parametrize("part", [0.0, 0.02])
def test_the_bulge_and_the_velocity_of_the_plate_are_never_below_0(part: float):
    for p in random_designs(12):
        for velocity in (400.0, 900.0):
            _, trace = traced(p, velocity, part * crossing_time(p, velocity))
            assert min(min(instant.y.W, instant.y.h) for instant in trace) >= 0.0


def test_a_smaller_tolerance_moves_an_impact_little():
    for p in random_designs(30):
        usual, fine = (run(p, 1000.0, 0.0, 1.0, 10_000, None, of) for of in (TOLERANCE, 1e-3 * TOLERANCE))
        assert usual.outcome == fine.outcome
        assert pytest.approx(fine.y.V, abs=0.02) == usual.y.V
        assert pytest.approx(fine.y.Z, rel=1e-5) == usual.y.Z
        assert usual.steps < 150
