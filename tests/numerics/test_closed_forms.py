"""What can be solved by hand, against runs: the closed forms hold from instant to instant within a stage."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import exp, log

import pytest

from armour.core.equations import cross_section, projectile_pressure, target_pressure
from armour.core.run import Instant
from armour.core.stages import (
    STEPS_PER_CHANGE,
    front_velocity,
    interface_force,
    medium_ahead,
    rates,
    shear_force,
)
from armour.core.state import Medium, Parameters, Stage
from tests.cases import armour, traced
from tests.numerics.test_order import PATHS

# The method's order: a default step is this part of the time in which the motion changes.
METHOD = STEPS_PER_CHANGE**-4
RUNS = [(a, velocity) for a, velocity, _ in PATHS.values()]


def instants(a: Parameters, velocity: float, holds: Callable[[Stage], bool], dt: float | None = None) -> list[Instant]:
    """Instants of the first unbroken stretch of a run in which a stage holds."""
    found: list[Instant] = []
    for instant in traced(a, velocity, dt)[1]:
        if holds(instant.s) and (not found or found[0].s == instant.s):
            found.append(instant)
    assert len(found) > 3
    return found


def drift(values: list[float]) -> float:
    """Largest relative departure of what should be constant."""
    return max(abs(value / values[0] - 1.0) for value in values)


def dwell(a: Parameters, stretch: list[Instant]) -> list[float]:
    return [i.y.V**2 / 2 - a.Yp / a.rho_p * log(i.y.L / a.L0) for i in stretch]


def held_plate(a: Parameters, stretch: list[Instant]) -> list[float]:
    rate = 2 * a.rho_B / (a.rho_p * stretch[0].y.L)
    return [(i.y.V**2 + a.YB / a.rho_B) * exp(rate * i.y.Z) for i in stretch]


def held_rubble(a: Parameters, stretch: list[Instant]) -> list[float]:
    rate = (a.Yc0 / stretch[0].s.Vs1 ** 2 + a.rho_c) / (a.rho_p * stretch[0].y.L)
    return [i.y.V * exp(rate * i.y.Z) for i in stretch]


CASES = {
    "dwell on intact ceramic": (
        armour("7.62 mm AP", "Al-N", "7075-T6", 16.0, 20.0),
        700.0,
        lambda s: s.medium == Medium.INTACT and not s.penetrated,
        dwell,
    ),
    "dwell on a plate": (
        armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, tau=1e12),
        900.0,
        lambda s: s.medium == Medium.PLATE and not s.penetrated,
        dwell,
    ),
    "rigid in a held plate": (
        armour(ceramic=None, ceramic_mm=0.0, backing_mm=40.0),
        500.0,
        lambda s: s.medium == Medium.PLATE and not s.eroding and not s.moving,
        held_plate,
    ),
    "rigid in held rubble": (
        armour("7.62 mm AP", "AD85", "5083-H3", 25.0, 10.0),
        620.0,
        lambda s: s.medium == Medium.FRAGMENTED and not s.eroding and not s.moving,
        held_rubble,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_constant_stays_so(name: str):
    a, velocity, holds, constant = CASES[name]
    assert drift(constant(a, instants(a, velocity, holds))) < METHOD


@pytest.mark.parametrize("name", CASES)
def test_the_drift_of_what_is_constant_is_of_fourth_order(name: str):
    a, velocity, holds, constant = CASES[name]
    steps = (0.4e-6, 0.2e-6, 0.1e-6)
    coarse, middle, fine = (drift(constant(a, instants(a, velocity, holds, dt))) for dt in steps)
    assert coarse / middle == pytest.approx(16, rel=0.3)
    assert middle / fine == pytest.approx(16, rel=0.3)


def test_a_carried_plate_slows_evenly_to_rounding():
    """F is constant because Z and h grow together, so V^2 falls linearly with depth."""
    a = armour()
    stretch = instants(a, 730.0, lambda s: s.medium == Medium.PLATE and not (s.eroding or s.penetrated))
    forces = [shear_force(i.y, i.s, a) for i in stretch]
    assert drift(forces) < 1e-12
    first = stretch[0].y
    mass = (a.rho_p * first.L + a.rho_B * (a.Hb + a.Hc0 - first.Z + first.h - stretch[0].s.h_s)) * cross_section(a.D0)
    for i in stretch:
        assert pytest.approx(first.V**2 - 2 * forces[0] / mass * (i.y.Z - first.Z), rel=1e-10) == i.y.V**2


def every_instant() -> Iterator[tuple[Parameters, Instant]]:
    for a, velocity in RUNS:
        for instant in traced(a, velocity)[1]:
            yield a, instant


def test_erosion_per_loss_of_velocity_whatever_the_target_does():
    """dL/dV = rho_p L (V - U)/Yp."""
    seen = 0
    for a, (_, y, s) in every_instant():
        if s.eroding:
            k = rates(y, s, a)
            U = front_velocity(y, s, a)
            assert pytest.approx(a.rho_p * y.L * (y.V - U) / a.Yp, rel=1e-12) == k.L / k.V
            seen += 1
    assert seen > 200


def test_both_sides_of_the_interface_carry_the_same_force():
    """(5), (8), (20) where both yield; elsewhere the stronger side carries what the weaker one bears."""
    kinds = set()
    for a, (_, y, s) in every_instant():
        A0 = cross_section(a.D0)
        U = front_velocity(y, s, a)
        Y, rho = medium_ahead(y, s, a)
        force = interface_force(y, s, a)
        if s.eroding:
            assert force == pytest.approx(projectile_pressure(a.Yp, a.rho_p, y.V, U) * A0, rel=1e-12)
        if s.penetrated:
            assert force == pytest.approx(target_pressure(Y, rho, U, y.W) * A0, rel=1e-12)
        if not (s.eroding or s.penetrated):
            plate = a.rho_B * (a.Hb + a.Hc0 - y.Z + y.h - s.h_s) * A0
            driven = plate * rates(y, s, a).W + shear_force(y, s, a)
            assert force == pytest.approx(driven, rel=1e-12)
        kinds.add((s.eroding, s.penetrated))
    assert len(kinds) == 4


def test_neither_side_carries_more_than_its_strength():
    for a, (_, y, s) in every_instant():
        Y, _ = medium_ahead(y, s, a)
        if s.eroding and not s.penetrated:
            assert projectile_pressure(a.Yp, a.rho_p, y.V, y.W) <= Y * (1 + 1e-9)


def test_the_penetration_velocity_lies_between_the_velocities_of_the_two_sides():
    for a, (_, y, s) in every_instant():
        U = front_velocity(y, s, a)
        assert y.W - 1e-9 <= U <= y.V + 1e-9


def test_the_velocity_never_rises():
    for a, velocity in RUNS:
        for before, after in pairwise(traced(a, velocity)[1]):
            assert after.y.V <= before.y.V
