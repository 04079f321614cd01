"""The rule of yielding, what ends a stage, and the names of stages."""

from math import pi, sqrt

import pytest

from armour.core.stages import (
    Event,
    after_event,
    default_time_step,
    drive_force,
    event_functions,
    fastest_rate,
    first_stage,
    joint_deceleration,
    rates,
    select_stage,
    shear_force,
    stage_name,
    step_length,
)
from armour.core.state import Medium, Outcome, Parameters, Stage, State
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
    s = select_stage(Medium.PLATE, struck(300.0, 300.0), armour(), 700.0, 0.0)
    assert s == Stage(Medium.PLATE, False, False, True, 700.0, 0.0)


def test_a_plate_moves_where_the_drive_exceeds_the_shear_force():
    a = armour()
    s = select_stage(Medium.PLATE, struck(300.0), a, 700.0, 0.0)
    assert not s.moving
    assert drive_force(struck(300.0), s, a) < shear_force(struck(300.0), s, a)
    thin = a._replace(Hb=1e-3, Hc0=0.0)
    assert select_stage(Medium.PLATE, struck(300.0), thin, 700.0, 0.0).moving


def test_the_two_shear_perimeters():
    s = Stage(Medium.FRAGMENTED, True, True, False, 700.0, 0.0)
    conoid = shear_force(struck(700.0), s, armour())
    projectile = shear_force(struck(700.0), s, armour(perimeter="projectile"))
    assert conoid / projectile == pytest.approx((6.5 + 4 * 6.35) / 6.5)


def test_no_margin_is_negative_when_a_stage_begins():
    a = armour()
    for V in (30.0, 300.0, 602.0, 603.0, 900.0, 3000.0):
        assert min(event_functions(0.0, struck(V), first_stage(struck(V), a), a, 1.0)) >= 0.0


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
    y, a = struck(1.0), armour()
    plate = Stage(Medium.PLATE, False, True, False, 700.0, 0.0)
    assert after_event(Event.MEDIUM, y, plate, a)[2] == Outcome.PERFORATED
    assert after_event(Event.ARREST, y, plate, a)[2] == Outcome.DEFEATED
    assert after_event(Event.ERODED, y, plate, a)[2] == Outcome.DEFEATED


def test_material_that_comes_to_rest_is_held():
    s = Stage(Medium.FRAGMENTED, False, True, True, 700.0, 0.0)
    y, after, _ = after_event(Event.MOTION, struck(200.0, -1e-12), s, armour())
    assert y.W == 0.0
    assert not after.moving


def test_a_plate_that_catches_up_moves_as_one():
    s = Stage(Medium.PLATE, False, True, True, 700.0, 0.0)
    y, after, _ = after_event(Event.TOGETHER, struck(200.0, 200.0 - 1e-13), s, armour())
    assert y.W == y.V
    assert stage_name(after) == "iii.4"


def length(y: State, s: Stage, a: Parameters, dt: float) -> float:
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


STATE = State(Z=4e-3, L=0.018, V=600.0, W=100.0, h=0.5e-3)
RATES = State(Z=400.0, L=-200.0, V=-2e7, W=3e6, h=100.0)


def in_stage(medium: Medium, eroding: bool, penetrated: bool, moving: bool) -> Stage:
    return Stage(medium, eroding, penetrated, moving, 750.0, 0.2e-3)


def test_nothing_shears_while_the_ceramic_is_intact():
    assert shear_force(STATE, in_stage(Medium.INTACT, True, True, False), armour()) == 0.0


def test_rubble_that_keeps_pace_is_carried_with_the_plate():
    a = armour()
    A0 = pi * a.D0**2 / 4
    F = pi * a.D0 * a.tau * (a.Hb + a.Hc0 + STATE.h - STATE.Z)
    mass = (a.rho_p * STATE.L + a.rho_c * (a.Hc0 - STATE.Z + STATE.h) + a.rho_B * a.Hb) * A0
    slowing = joint_deceleration(STATE, in_stage(Medium.FRAGMENTED, False, False, True), a)
    assert slowing == pytest.approx(-F / mass)


def test_response_in_rubble():
    """Inertia, the rod's bar wave and the dashpot of (9), on the rod; the latter two on what moves as well."""
    a = armour()
    dashpot = 2.0 * a.Yc0 * 500.0 / 750.0**2
    rod = (600.0 + sqrt(a.Yp / a.rho_p) + dashpot / a.rho_p) / 0.018
    held = in_stage(Medium.FRAGMENTED, True, True, False)
    assert fastest_rate(STATE, RATES, held, a) == pytest.approx(rod)
    areal = a.rho_B * a.Hb + a.rho_c * (a.Hc0 - STATE.Z + STATE.h)
    moving = in_stage(Medium.FRAGMENTED, True, True, True)
    expected = rod + 3e6 / 600.0 + (a.rho_c * 500.0 + dashpot) / areal
    assert fastest_rate(STATE, RATES, moving, a) == pytest.approx(expected)


def test_response_in_the_plate():
    a = armour()
    deep = STATE._replace(Z=8e-3)
    rod = (600.0 + sqrt(a.Yp / a.rho_p)) / 0.018
    areal = a.rho_B * (a.Hb + a.Hc0 - 8e-3 + 0.5e-3 - 0.2e-3)
    penetrated = in_stage(Medium.PLATE, True, True, True)
    carried = in_stage(Medium.PLATE, True, False, True)
    joined = in_stage(Medium.PLATE, False, False, True)
    picking_up = 3e6 / 600.0
    assert fastest_rate(deep, RATES, penetrated, a) == pytest.approx(rod + picking_up + a.rho_B * 500.0 / areal)
    assert fastest_rate(deep, RATES, carried, a) == pytest.approx(rod + picking_up + a.rho_p * 600.0 / areal)
    assert fastest_rate(deep, RATES, joined, a) == pytest.approx(600.0 / 0.018)
    heavy = a._replace(rho_B=2 * a.rho_p)
    rod = (2 * 600.0 + sqrt(a.Yp / a.rho_p)) / 0.018
    assert fastest_rate(deep, RATES, penetrated._replace(moving=False), heavy) == pytest.approx(rod)


def test_the_default_step_is_a_part_of_the_time_in_which_the_motion_changes():
    a = armour()
    slowing = a.Yp / (a.rho_p * a.L0 * 800.0)
    drive = min(a.Yc0, a.Yp + a.rho_p * 800.0**2)
    picking_up = drive / ((a.rho_c * a.Hc0 + a.rho_B * a.Hb) * 800.0)
    expected = 1.0 / (4.0 * (800.0 / a.D0 + slowing + picking_up))
    assert default_time_step(a, 800.0) == pytest.approx(expected)


def test_the_default_step_of_a_slow_impact_on_a_thin_bare_plate():
    """The plate is thinner than the rod; what drives it is less than the strength of a ceramic that is not there."""
    a = armour()._replace(Hc0=0.0, Hb=3e-3, YB=4e9)
    slowing = a.Yp / (a.rho_p * a.L0 * 300.0)
    drive = a.Yp + a.rho_p * 300.0**2
    expected = 1.0 / (4.0 * (300.0 / 3e-3 + slowing + drive / (a.rho_B * 3e-3 * 300.0)))
    assert default_time_step(a, 300.0) == pytest.approx(expected)
    soft = a._replace(YB=1.05e9)
    slowing = 1.05e9 / (a.rho_p * a.L0 * 300.0)
    expected = 1.0 / (4.0 * (300.0 / 3e-3 + slowing + 1.05e9 / (a.rho_B * 3e-3 * 300.0)))
    assert default_time_step(soft, 300.0) == pytest.approx(expected)


def test_the_step_grows_in_held_rubble_and_where_the_motion_is_slow():
    a = armour()
    s = in_stage(Medium.FRAGMENTED, False, True, False)
    assert step_length(STATE, RATES, s, a, 1e-8) == pytest.approx(1e-8 * 750.0 / 600.0)
    change = (2e7 + 3e6) / 600.0 + 400.0 / a.D0
    eroding = in_stage(Medium.FRAGMENTED, True, True, False)
    assert step_length(STATE, RATES, eroding, a, 1e-12) == pytest.approx(1e-3 / change)
    longest = 0.3 / fastest_rate(STATE, RATES, eroding, a)
    assert step_length(STATE, RATES, eroding, a, 1.0) == pytest.approx(longest)
    thin = a._replace(Hc0=1e-3, Hb=2e-3)
    change = (2e7 + 3e6) / 600.0 + 400.0 / 3e-3
    assert step_length(STATE, RATES, eroding, thin, 1e-12) == pytest.approx(1e-3 / change)


def test_a_plate_that_moves_at_all_is_moving():
    """However slowly, and though the drive alone would not start it."""
    a = armour()
    y = State(Z=1e-3, L=0.02, V=400.0, W=0.5, h=1e-4)
    assert drive_force(y, in_stage(Medium.FRAGMENTED, True, True, True), a) < shear_force(
        y, in_stage(Medium.FRAGMENTED, True, True, True), a
    )
    assert select_stage(Medium.FRAGMENTED, y, a, 750.0, 0.0).moving
    assert not select_stage(Medium.FRAGMENTED, State(y.Z, y.L, y.V, 0.0, y.h), a, 750.0, 0.0).moving


def test_the_step_grows_where_the_deceleration_is_constant():
    a = armour()
    deep = STATE._replace(Z=8e-3)
    joined = in_stage(Medium.PLATE, False, False, True)
    assert step_length(deep, RATES, joined, a, 1e-8) == pytest.approx(8e-8)
