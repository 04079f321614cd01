"""Closed forms and balances of the model, from instant to instant of runs."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import exp, log

import pytest

from armour.core.equations import cross_section, projectile_pressure, target_pressure
from armour.core.run import Instant
from armour.core.stages import front_velocity, interface_force, medium_ahead, rates, shear_force
from armour.core.state import Medium, Parameters, Stage
from tests.helpers.cases import armour
from tests.helpers.runs import STAGE_PATHS, traced

# Error of some tens of steps with the usual tolerance.
METHOD = 1e-5


def instants(
    p: Parameters, velocity: float, holds: Callable[[Stage], bool], dt: float = 0.0, least: int = 4
) -> list[Instant]:
    """The instants, at least some, of the first stage of a run for which a condition holds."""
    found: list[Instant] = []
    for instant in traced(p, velocity, dt)[1]:
        if holds(instant.s) and (not found or found[0].s == instant.s):
            found.append(instant)
    assert len(found) >= least
    return found


def drift(values: list[float]) -> float:
    """The largest relative change of values that should be constant."""
    return max(abs(value / values[0] - 1.0) for value in values)


def dwell(p: Parameters, stretch: list[Instant]) -> list[float]:
    return [i.y.V**2 / 2 - p.Yp / p.rho_p * log(i.y.L / p.L0) for i in stretch]


def held_plate(p: Parameters, stretch: list[Instant]) -> list[float]:
    rate = 2 * p.rho_B / (p.rho_p * stretch[0].y.L)
    return [(i.y.V**2 + p.YB / p.rho_B) * exp(rate * i.y.Z) for i in stretch]


def held_rubble(p: Parameters, stretch: list[Instant]) -> list[float]:
    rate = (p.Yc0 / stretch[0].s.Vs1 ** 2 + p.rho_c) / (p.rho_p * stretch[0].y.L)
    return [i.y.V * exp(rate * i.y.Z) for i in stretch]


Case = tuple[Callable[[], Parameters], float, Callable[[Stage], bool], Callable[..., list[float]]]

CASES: dict[str, Case] = {
    "dwell on intact ceramic": (
        lambda: armour("7.62 mm AP", "Al-N", "7075-T6", 16.0, 20.0),
        700.0,
        lambda s: s.medium == Medium.INTACT and not s.penetrated,
        dwell,
    ),
    "dwell on a plate": (
        lambda: armour(ceramic=None, ceramic_mm=0.0)._replace(YB=50e9, tau=1e12),
        900.0,
        lambda s: s.medium == Medium.PLATE and not s.penetrated,
        dwell,
    ),
    "rigid in a held plate": (
        lambda: armour(ceramic=None, ceramic_mm=0.0, backing_mm=40.0),
        500.0,
        lambda s: s.medium == Medium.PLATE and not s.eroding and not s.moving,
        held_plate,
    ),
    "rigid in held rubble": (
        lambda: armour("7.62 mm AP", "AD85", "5083-H3", 25.0, 10.0),
        620.0,
        lambda s: s.medium == Medium.FRAGMENTED and not s.eroding and not s.moving,
        held_rubble,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_constants_of_the_motion(name: str):
    parameters, velocity, holds, constant = CASES[name]
    p = parameters()
    assert drift(constant(p, instants(p, velocity, holds))) < METHOD


@pytest.mark.parametrize("name", CASES)
def test_the_drift_of_constants_is_of_fourth_order(name: str):
    parameters, velocity, holds, constant = CASES[name]
    p = parameters()
    steps = (0.4e-6, 0.1e-6)
    coarse, fine = (drift(constant(p, instants(p, velocity, holds, dt))) for dt in steps)
    assert coarse / fine == pytest.approx(256, rel=0.5)


def test_a_carried_plate_slows_evenly_to_rounding():
    """F is constant, since Z and h grow together, so V^2 falls linearly with depth."""
    p = armour()
    stretch = instants(p, 730.0, lambda s: s.medium == Medium.PLATE and not (s.eroding or s.penetrated), least=2)
    forces = [shear_force(i.y, i.s, p) for i in stretch]
    assert drift(forces) < 1e-12
    first = stretch[0].y
    mass = (p.rho_p * first.L + p.rho_B * (p.Hb + p.Hc0 - first.Z + first.h - stretch[0].s.h_s)) * cross_section(p.D0)
    for i in stretch:
        assert pytest.approx(first.V**2 - 2 * forces[0] / mass * (i.y.Z - first.Z), rel=1e-10) == i.y.V**2


def every_instant() -> Iterator[tuple[Parameters, Instant]]:
    for case in STAGE_PATHS.values():
        p = case.parameters()
        for instant in traced(p, case.velocity)[1]:
            yield p, instant


def test_erosion_per_loss_of_velocity():
    """dL/dV = rho_p L (V - U)/Yp, independent of the target."""
    seen = 0
    for p, (_, y, s) in every_instant():
        if s.eroding:
            k = rates(y, s, p)
            U = front_velocity(y, s, p)
            assert pytest.approx(p.rho_p * y.L * (y.V - U) / p.Yp, rel=1e-12) == k.L / k.V
            seen += 1
    assert seen > 200


def test_both_sides_of_the_interface_carry_the_same_force():
    """(5), (8), (20) where both sides yield; the force of the yielding side elsewhere."""
    kinds = set()
    for p, (_, y, s) in every_instant():
        A0 = cross_section(p.D0)
        U = front_velocity(y, s, p)
        Y, rho = medium_ahead(y, s, p)
        force = interface_force(y, s, p)
        if s.eroding:
            assert force == pytest.approx(projectile_pressure(p.Yp, p.rho_p, y.V, U) * A0, rel=1e-12)
        if s.penetrated:
            assert force == pytest.approx(target_pressure(Y, rho, U, y.W) * A0, rel=1e-12)
        if not (s.eroding or s.penetrated):
            plate = p.rho_B * (p.Hb + p.Hc0 - y.Z + y.h - s.h_s) * A0
            driven = plate * rates(y, s, p).W + shear_force(y, s, p)
            assert force == pytest.approx(driven, rel=1e-12)
        kinds.add((s.eroding, s.penetrated))
    assert len(kinds) == 4


def test_neither_side_carries_more_than_its_strength():
    for p, (_, y, s) in every_instant():
        Y, _ = medium_ahead(y, s, p)
        if s.eroding and not s.penetrated:
            assert projectile_pressure(p.Yp, p.rho_p, y.V, y.W) <= Y * (1 + 1e-9)


def test_the_penetration_velocity_lies_between_the_velocities_of_the_two_sides():
    for p, (_, y, s) in every_instant():
        U = front_velocity(y, s, p)
        assert y.W - 1e-9 <= U <= y.V + 1e-9


def test_the_velocity_never_rises():
    for case in STAGE_PATHS.values():
        for before, after in pairwise(traced(case.parameters(), case.velocity)[1]):
            assert after.y.V <= before.y.V
