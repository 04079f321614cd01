"""The yielding rule, the forces of a stage, and the names of stages."""

from math import pi

import pytest

from armour.core.equations import INTERFACE, intact_strength
from armour.core.stages import (
    drive_force,
    first_stage,
    joint_deceleration,
    shear_force,
    stage_name,
    with_intact_strength,
)
from armour.core.state import Medium, Stage, State
from tests.helpers.cases import armour

STATE = State(Z=4e-3, L=0.018, V=600.0, W=100.0, h=0.5e-3)
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
def test_stage_names_are_those_of_the_paper(answers: tuple[int, bool, bool], name: str):
    medium, eroding, penetrated = answers
    assert stage_name(Stage(medium, eroding, penetrated, False, 800.0, 0.0)) == name


def struck(V: float, W: float = 0.0) -> State:
    return State(Z=0.0, L=0.02, V=V, W=W, h=0.0)


def test_a_slow_projectile_dwells_on_intact_ceramic():
    """The projectile yields and the ceramic does not where Yp + rho_p V^2 is below Yc0."""
    limit = ((5.2e9 - 2.35e9) / 7850.0) ** 0.5
    assert not first_stage(struck(limit - 0.01), armour()).penetrated
    assert first_stage(struck(limit + 0.01), armour()).penetrated


def test_the_two_shear_perimeters():
    s = Stage(Medium.FRAGMENTED, True, True, False, 700.0, 0.0)
    conoid = shear_force(struck(700.0), s, armour())
    projectile = shear_force(struck(700.0), s, armour(perimeter="projectile"))
    assert conoid / projectile == pytest.approx((6.5 + 4 * 6.35) / 6.5)


def test_the_interface_drives_the_plate():
    """By (28) where a rigid projectile penetrates the plate; elsewhere the force is as printed."""
    printed = armour()
    p, A0 = printed._replace(drive_law=INTERFACE), pi * printed.D0**2 / 4

    def both(medium: Medium, eroding: bool, penetrated: bool) -> tuple[float, float]:
        s = in_stage(medium, eroding, penetrated, True)
        return drive_force(STATE, s, printed), drive_force(STATE, s, p)

    assert both(Medium.PLATE, False, True) == pytest.approx((1.05e9 * A0, 2.35e9 * A0))
    assert both(Medium.PLATE, True, True) == pytest.approx((1.05e9 * A0,) * 2)
    assert both(Medium.PLATE, True, False) == pytest.approx(((2.35e9 + 7850.0 * 600.0 * 500.0) * A0,) * 2)
    for eroding, penetrated in ((True, True), (True, False), (False, True)):
        printed_force, force = both(Medium.FRAGMENTED, eroding, penetrated)
        assert printed_force == force


def in_stage(medium: Medium, eroding: bool, penetrated: bool, moving: bool) -> Stage:
    return Stage(medium, eroding, penetrated, moving, 750.0, 0.2e-3)


def test_fragmented_ceramic_that_keeps_pace_is_carried_with_the_plate():
    p = armour()
    A0 = pi * p.D0**2 / 4
    F = pi * p.D0 * p.tau * (p.Hb + p.Hc0 + STATE.h - STATE.Z)
    mass = (p.rho_p * STATE.L + p.rho_c * (p.Hc0 - STATE.Z + STATE.h) + p.rho_B * p.Hb) * A0
    slowing = joint_deceleration(STATE, in_stage(Medium.FRAGMENTED, False, False, True), p)
    assert slowing == pytest.approx(-F / mass)


@pytest.mark.parametrize("name", ["n_B", "n_cB", "a_c", "a_B"])
def test_each_parameter_of_the_law_counts_by_itself(name: str):
    p = armour(ceramic_mm=9.0, backing_mm=8.0)
    law = p._replace(**{name: 1.0})  # type: ignore[arg-type]
    expected = intact_strength(p.Yc0, p.D0, p.Hc0, p.Hb, law.n_B, law.n_cB, law.a_c, law.a_B)
    assert abs(expected / p.Yc0 - 1.0) > 0.1
    assert with_intact_strength(law) == p._replace(Yc0=expected)
