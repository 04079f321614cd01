"""The rule of yielding, what ends a stage, and the names of stages."""

import pytest

from armour.core.stages import (
    Event,
    default_time_step,
    drive_force,
    first_stage,
    follow,
    margins,
    rates,
    settle,
    shear_force,
    stage_name,
    step_length,
)
from armour.core.state import Armour, Medium, Outcome, Stage, State
from tests.cases import armour

NAMES = {
    (Medium.INTACT, True, True): "i",
    (Medium.INTACT, True, False): "ii.2",
    (Medium.INTACT, False, True): "ii.3",
    (Medium.FRAGMENTED, True, True): "ii.1",
    (Medium.FRAGMENTED, True, False): "ii.2",
    (Medium.FRAGMENTED, False, True): "ii.3",
    (Medium.FRAGMENTED, False, False): "iii.5",
    (Medium.PLATE, True, True): "iii.1",
    (Medium.PLATE, True, False): "iii.2",
    (Medium.PLATE, False, True): "iii.3",
    (Medium.PLATE, False, False): "iii.4",
}


@pytest.mark.parametrize(("answers", "name"), NAMES.items())
def test_names_are_those_of_the_papers_table(answers: tuple[int, bool, bool], name: str):
    medium, eroding, penetrated = answers
    assert stage_name(Stage(medium, eroding, penetrated, False, 800.0, 0.0)) == name


def struck(V: float, W: float = 0.0) -> State:
    return State(Z=0.0, L=0.02, V=V, W=W, h=0.0)


def test_a_fast_projectile_erodes_and_penetrates_intact_ceramic():
    s = first_stage(struck(800.0), armour())
    assert (s.medium, s.eroding, s.penetrated, s.moving) == (Medium.INTACT, True, True, False)


def test_a_slow_projectile_dwells_on_intact_ceramic():
    """It yields, the ceramic does not, where Yp + rho_p V^2 is below the ceramic's strength."""
    limit = ((5.2e9 - 2.35e9) / 7850.0) ** 0.5
    assert not first_stage(struck(limit - 0.01), armour()).penetrated
    assert first_stage(struck(limit + 0.01), armour()).penetrated


def test_a_projectile_stronger_than_the_ceramic_stays_rigid():
    a = armour()._replace(Yp=10e9)
    s = first_stage(struck(800.0), a)
    assert (s.eroding, s.penetrated) == (False, True)


def test_a_bare_plate_is_struck_at_once():
    s = first_stage(struck(300.0), armour(ceramic=None, ceramic_mm=0.0))
    assert (s.medium, s.eroding, s.penetrated) == (Medium.PLATE, False, True)


def test_a_plate_that_keeps_pace_is_carried():
    s = settle(Medium.PLATE, struck(300.0, 300.0), armour(), 700.0, 0.0)
    assert s == Stage(Medium.PLATE, False, False, True, 700.0, 0.0)


def test_a_plate_moves_where_the_drive_exceeds_the_shear_force():
    a = armour()
    s = settle(Medium.PLATE, struck(300.0), a, 700.0, 0.0)
    assert not s.moving
    assert drive_force(struck(300.0), s, a) < shear_force(struck(300.0), s, a)
    thin = a._replace(Hb=1e-3, Hc0=0.0)
    assert settle(Medium.PLATE, struck(300.0), thin, 700.0, 0.0).moving


def test_the_two_shear_perimeters():
    s = Stage(Medium.FRAGMENTED, True, True, False, 700.0, 0.0)
    conoid = shear_force(struck(700.0), s, armour())
    projectile = shear_force(struck(700.0), s, armour(perimeter="projectile"))
    assert conoid / projectile == pytest.approx((6.5 + 4 * 6.35) / 6.5)


def test_no_margin_is_negative_when_a_stage_begins():
    a = armour()
    for V in (30.0, 300.0, 602.0, 603.0, 900.0, 3000.0):
        assert min(margins(0.0, struck(V), first_stage(struck(V), a), a, 1.0)) >= 0.0


def test_the_crack_ends_intact_ceramic_and_keeps_the_velocity():
    y = struck(750.0)
    s = first_stage(y, armour())
    _, after, outcome = follow(Event.MEDIUM, y, s, armour())
    assert (after.medium, after.Vs1, outcome) == (Medium.FRAGMENTED, 750.0, Outcome.RUNNING)


def test_entering_the_plate_keeps_the_bulge():
    y = State(Z=6.35e-3, L=0.02, V=500.0, W=20.0, h=1e-4)
    s = Stage(Medium.FRAGMENTED, True, True, True, 700.0, 0.0)
    _, after, _ = follow(Event.MEDIUM, y, s, armour())
    assert (after.medium, after.Vs1, after.h_s) == (Medium.PLATE, 700.0, 1e-4)


def test_ends_of_a_run():
    y, a = struck(1.0), armour()
    plate = Stage(Medium.PLATE, False, True, False, 700.0, 0.0)
    assert follow(Event.MEDIUM, y, plate, a)[2] == Outcome.PERFORATED
    assert follow(Event.ARREST, y, plate, a)[2] == Outcome.DEFEATED
    assert follow(Event.ERODED, y, plate, a)[2] == Outcome.DEFEATED


def test_material_that_comes_to_rest_is_held():
    s = Stage(Medium.FRAGMENTED, False, True, True, 700.0, 0.0)
    y, after, _ = follow(Event.MOTION, struck(200.0, -1e-12), s, armour())
    assert y.W == 0.0
    assert not after.moving


def test_a_plate_that_catches_up_moves_as_one():
    s = Stage(Medium.PLATE, False, True, True, 700.0, 0.0)
    y, after, _ = follow(Event.TOGETHER, struck(200.0, 200.0 - 1e-13), s, armour())
    assert y.W == y.V
    assert stage_name(after) == "iii.4"


def length(y: State, s: Stage, a: Armour, dt: float) -> float:
    return step_length(y, rates(y, s, a), s, a, dt)


def test_the_step_is_the_one_given_where_nothing_runs_away():
    a = armour()
    assert length(struck(800.0), first_stage(struck(800.0), a), a, 1e-7) == 1e-7


def test_the_step_grows_as_the_projectile_slows_in_held_rubble():
    s = Stage(Medium.FRAGMENTED, False, True, False, 700.0, 0.0)
    assert length(struck(7.0), s, armour(), 1e-7) == pytest.approx(1e-5)


def test_the_step_shrinks_with_the_rod():
    a = armour()
    short = struck(800.0)._replace(L=1e-5)
    assert length(short, first_stage(short, a), a, 1e-7) < 1e-8


def test_the_default_step_scales_with_size():
    a = armour()
    b = a._replace(L0=2 * a.L0, D0=2 * a.D0, Hc0=2 * a.Hc0, Hb=2 * a.Hb)
    assert default_time_step(b, 800.0) == pytest.approx(2 * default_time_step(a, 800.0), rel=1e-14)
