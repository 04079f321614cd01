"""The longest time step and its adaptation."""

from math import sqrt
from typing import Any

import pytest

from armour.core.equations import CONOID, PROJECTILE
from armour.core.rk4 import advance
from armour.core.search import find_ballistic_limit, scan
from armour.core.stages import front_velocity, medium_ahead, rates
from armour.core.state import Medium, Stage, State
from armour.core.stepping import (
    BEND_FALLING,
    BEND_RISING,
    LONGEST_RESPONSE,
    ROUGH_RESPONSE,
    ROUGH_SLOWING,
    SETTLED,
    default_time_step,
    front_rate,
    response_rate,
    step_length,
    strength_by_velocity,
    time_step,
    time_to_end,
)
from tests.helpers.cases import armour
from tests.helpers.runs import perforates

STATE = State(Z=4e-3, L=0.018, V=600.0, W=100.0, h=0.5e-3)
RATES = State(Z=400.0, L=-200.0, V=-2e7, W=3e6, h=100.0)


def in_stage(medium: Medium, eroding: bool, penetrated: bool, moving: bool) -> Stage:
    return Stage(medium, eroding, penetrated, moving, 750.0, 0.2e-3)


JOINED = in_stage(Medium.PLATE, False, False, True)


def test_a_given_time_step_is_limited():
    p = armour()
    default = default_time_step(p, 800.0)
    assert time_step(p, 800.0, 0.0) == default
    assert time_step(p, 800.0, 0.1 * default) == 0.1 * default
    assert time_step(p, 800.0, 100.0 * default) == default


def test_the_default_step_scales_with_size():
    p = armour()
    b = p._replace(L0=2 * p.L0, D0=2 * p.D0, Hc0=2 * p.Hc0, Hb=2 * p.Hb)
    assert default_time_step(b, 800.0) == pytest.approx(2 * default_time_step(p, 800.0), rel=1e-14)


def test_the_response_in_fragmented_ceramic():
    """Terms of inertia, erosion, the projectile's bar wave and the derivative of (9)."""
    p = armour()
    damping = 2.0 * p.Yc0 * 500.0 / 750.0**2
    rod = (600.0 + 2.0 * 200.0 + sqrt(p.Yp / p.rho_p) + damping / p.rho_p) / 0.018
    held = in_stage(Medium.FRAGMENTED, True, True, False)
    assert response_rate(STATE, RATES, held, p) == pytest.approx(rod)
    areal = p.rho_B * p.Hb + p.rho_c * (p.Hc0 - STATE.Z + STATE.h)
    moving = in_stage(Medium.FRAGMENTED, True, True, True)
    expected = rod + (p.rho_c * 500.0 + damping) / areal
    assert response_rate(STATE, RATES, moving, p) == pytest.approx(expected)
    Yc = p.Yc0 * (500.0 / 750.0) ** 2
    inertia = 2.0 * p.rho_c * 600.0 + 2.5 * sqrt(Yc * p.rho_c)
    rigid = in_stage(Medium.FRAGMENTED, False, True, False)
    assert response_rate(STATE, RATES, rigid, p) == pytest.approx((inertia + damping) / (p.rho_p * 0.018))
    settling = damping * (1.0 / (p.rho_p * 0.018) + 1.0 / areal)
    # 2.3e7 m/s^2 is the rate of V - W, 500 m/s.
    expected = inertia / (p.rho_p * 0.018) + p.rho_c * 500.0 / areal + SETTLED * settling + 2.3e7 / 500.0
    assert response_rate(STATE, RATES, rigid._replace(moving=True), p) == pytest.approx(expected)


def test_the_response_in_the_plate():
    p = armour()
    deep = STATE._replace(Z=8e-3)
    rod = (600.0 + 2.0 * 200.0 + sqrt(p.Yp / p.rho_p)) / 0.018
    areal = p.rho_B * (p.Hb + p.Hc0 - 8e-3 + 0.5e-3 - 0.2e-3)
    penetrated = in_stage(Medium.PLATE, True, True, True)
    carried = in_stage(Medium.PLATE, True, False, True)
    spring = sqrt(4.0 * p.tau / (p.D0 * areal))
    assert response_rate(deep, RATES, penetrated, p) == pytest.approx(rod + p.rho_B * 500.0 / areal + spring)
    assert response_rate(deep, RATES, carried, p) == pytest.approx(rod + p.rho_p * 600.0 / areal)
    rigid = in_stage(Medium.PLATE, False, True, False)
    expected = (2.0 * p.rho_B * 600.0 + 2.5 * sqrt(p.YB * p.rho_B)) / (p.rho_p * 0.018)
    assert response_rate(deep, RATES, rigid, p) == pytest.approx(expected)


def test_the_rate_of_the_penetration_velocity_counts_only_where_both_sides_yield():
    p = armour()
    deep, sudden = STATE._replace(Z=8e-3), RATES._replace(W=1e10)
    for eroding, penetrated in ((True, True), (True, False), (False, True)):
        s = in_stage(Medium.PLATE, eroding, penetrated, True)
        raised = response_rate(deep, sudden, s, p) > 1.1 * response_rate(deep, RATES, s, p)
        assert raised == (eroding and penetrated)


def test_only_the_strength_of_fragments_that_are_penetrated_depends_on_the_velocity():
    for medium in Medium:
        for penetrated in (True, False):
            found = strength_by_velocity(STATE, in_stage(medium, True, penetrated, True), armour())
            assert (found == 0.0) == (medium != Medium.FRAGMENTED or not penetrated)


def test_the_default_step_is_the_characteristic_time():
    p = armour()
    slowing = p.Yp / (p.rho_p * p.L0 * 800.0)
    drive = min(p.Yc0, p.Yp + p.rho_p * 800.0**2)
    picking_up = drive / ((p.rho_c * p.Hc0 + p.rho_B * p.Hb) * 800.0)
    expected = 1.0 / (800.0 / p.D0 + slowing + picking_up)
    assert default_time_step(p, 800.0) == pytest.approx(expected)


def test_the_default_step_of_a_slow_impact_on_a_thin_bare_plate():
    """The plate is thinner than the projectile, and the strength of the absent ceramic is not used."""
    p = armour()._replace(Hc0=0.0, Hb=3e-3, YB=4e9)
    slowing = p.Yp / (p.rho_p * p.L0 * 300.0)
    drive = p.Yp + p.rho_p * 300.0**2
    expected = 1.0 / (300.0 / 3e-3 + slowing + drive / (p.rho_B * 3e-3 * 300.0))
    assert default_time_step(p, 300.0) == pytest.approx(expected)
    soft = p._replace(YB=1.05e9)
    slowing = 1.05e9 / (p.rho_p * p.L0 * 300.0)
    expected = 1.0 / (300.0 / 3e-3 + slowing + 1.05e9 / (p.rho_B * 3e-3 * 300.0))
    assert default_time_step(soft, 300.0) == pytest.approx(expected)


def test_the_limits_of_the_step():
    p = armour()
    s = in_stage(Medium.FRAGMENTED, False, True, False)
    assert step_length(STATE, RATES, s, p, 1e-8, False) == pytest.approx(1e-8 * 750.0 / 600.0)
    change = (2e7 + 3e6) / 600.0 + 400.0 / p.D0
    eroding = in_stage(Medium.FRAGMENTED, True, True, False)
    assert step_length(STATE, RATES, eroding, p, 1e-12, False) == pytest.approx(1e-3 / change)
    rate = response_rate(STATE, RATES, eroding, p)
    assert step_length(STATE, RATES, eroding, p, 1.0, False) == pytest.approx(LONGEST_RESPONSE / rate)
    assert step_length(STATE, RATES, eroding, p, 1.0, True) == pytest.approx(ROUGH_RESPONSE / rate)
    thin = p._replace(Hc0=1e-3, Hb=2e-3)
    change = (2e7 + 3e6) / 600.0 + 400.0 / 3e-3
    assert step_length(STATE, RATES, eroding, thin, 1e-12, False) == pytest.approx(1e-3 / change)


def test_the_steps_of_a_rough_run_are_longer_where_the_velocity_falls_as_the_inverse_of_time():
    p = armour()
    held = in_stage(Medium.FRAGMENTED, False, True, False)
    rate = response_rate(STATE, RATES, held, p)
    assert step_length(STATE, RATES, held, p, 1.0, True) == pytest.approx(ROUGH_SLOWING * ROUGH_RESPONSE / rate)
    assert step_length(STATE, RATES, held, p, 1.0, False) == pytest.approx(LONGEST_RESPONSE / rate)


@pytest.mark.parametrize(("Z", "V", "rest"), [(8e-3, 600.0, False), (8e-3, 300.0, False), (8e-3, 20.0, True)])
def test_a_step_of_constant_deceleration_leads_just_beyond_the_end(Z: float, V: float, rest: bool):
    """The way in a time at constant deceleration is a parabola of the time."""
    p = armour()
    y = State(Z=Z, L=0.018, V=V, W=V, h=0.5e-3)
    k = rates(y, JOINED, p)
    dt = time_to_end(y, k, JOINED, p)
    assert step_length(y, k, JOINED, p, 1e-9, False) == dt
    way, left = V * dt + 0.5 * k.V * dt * dt, p.Hc0 + p.Hb - Z
    if rest:
        assert dt == V / -k.V
        assert way < left
    else:
        assert way == pytest.approx(left, rel=1e-9)
        assert way > left


def test_without_deceleration_the_end_is_reached_at_the_velocity():
    p = armour()
    y = State(Z=8e-3, L=0.018, V=300.0, W=300.0, h=0.5e-3)
    k = State(300.0, 0.0, 0.0, 0.0, 300.0)
    assert time_to_end(y, k, JOINED, p) == pytest.approx((p.Hc0 + p.Hb - 8e-3) / 300.0)
    in_ceramic = JOINED._replace(medium=Medium.FRAGMENTED)
    assert time_to_end(y._replace(Z=4e-3), k, in_ceramic, p) == pytest.approx((p.Hc0 - 4e-3) / 300.0)


@pytest.mark.parametrize("medium", Medium)
@pytest.mark.parametrize("rising", [True, False])
def test_the_response_of_the_penetration_velocity(medium: Medium, rising: bool):
    """The derivative of U with time is that of the root (6), (10), (21) itself."""
    p = armour()
    s = in_stage(medium, True, True, medium != Medium.INTACT)
    W = 0.0 if medium == Medium.INTACT else STATE.W
    y = STATE._replace(V=900.0, W=W)
    k = rates(y, s, p)
    # The strength of fragments falls with V.
    k = k._replace(V=-1e8 if rising == (medium == Medium.FRAGMENTED) else 1e8, W=2e7 if s.moving else 0.0)
    dt = 1e-12
    change = (front_velocity(advance(y, k, dt), s, p) - front_velocity(advance(y, k, -dt), s, p)) / (2.0 * dt)
    _, rho = medium_ahead(y, s, p)
    bend = 2.0 * rho * change / (p.rho_p * y.V + rho * (2.0 * k.Z - y.W))
    assert (bend > 0.0) == rising
    expected = (BEND_RISING if rising else -BEND_FALLING) * bend
    assert front_rate(y, k, p, rho, strength_by_velocity(y, s, p)) == pytest.approx(expected, rel=1e-4)


UNUSUAL = [
    {"L0": 0.0916, "rho_p": 2580.0, "Yp": 2.39e9, "Hc0": 6.05e-3, "rho_c": 14700.0, "Ec": 379e9, "Yc0": 5.69e9,
     "Hb": 4.07e-3, "rho_B": 14200.0, "YB": 2.11e9, "tau": 406e6, "shear_law": CONOID},
    {"L0": 0.061, "rho_p": 3710.0, "Yp": 3.22e9, "Hc0": 3.16e-3, "rho_c": 9980.0, "Ec": 569e9, "Yc0": 3.85e9,
     "Hb": 7.22e-3, "rho_B": 13400.0, "YB": 1.21e9, "tau": 151e6, "shear_law": PROJECTILE},
    {"L0": 0.0806, "rho_p": 3400.0, "Yp": 1.53e9, "Hc0": 2.97e-3, "rho_c": 7020.0, "Ec": 184e9, "Yc0": 2.08e9,
     "Hb": 5.92e-3, "rho_B": 10500.0, "YB": 2.54e9, "tau": 62e6, "shear_law": CONOID},
]  # fmt: skip


@pytest.mark.parametrize("unusual", UNUSUAL)
def test_soft_rods_that_dwell_on_hard_ceramics_have_the_limits_of_shorter_steps(unusual: dict[str, Any]):
    """U rises from 0 to V just after dwell; these were 0.1, 0.03 and 0.02 m/s off."""
    p = armour()._replace(D0=7e-3, **unusual)
    limit = find_ballistic_limit(p, scan(20.0, 4000.0), 1e-5, 1.0, 0.0, 20_000).high
    assert perforates(p, limit + 1e-3, 0.02)
    assert not perforates(p, limit - 1e-3, 0.02)
