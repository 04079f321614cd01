"""One Runge-Kutta step."""

from itertools import pairwise

import pytest

from armour.core.rk4 import state_within, step
from armour.core.stages import rates
from armour.core.state import Medium, Stage, State
from tests.helpers.cases import armour

START = State(Z=0.001, L=0.02, V=700.0, W=10.0, h=0.0001)


def test_a_step_is_exact_to_fifth_order():
    """For a rigid projectile in held fragmented ceramic, dV/dt = -k V^2, halving the step divides the error by 32."""
    a = armour()
    s = Stage(Medium.FRAGMENTED, False, True, False, 700.0, 0.0)
    y = State(Z=0.0, L=0.02, V=400.0, W=0.0, h=0.0)
    k = (a.Yc0 / s.Vs1**2 + a.rho_c) / (a.rho_p * y.L)
    errors = []
    for dt in (2e-6, 1e-6, 0.5e-6):
        exact = y.V / (1.0 + k * y.V * dt)
        errors.append(abs(step(0.0, y, rates(y, s, a), s, a, dt).y_end.V - exact))
    assert errors[0] / errors[1] == pytest.approx(32, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(32, rel=0.15)


def test_the_error_estimate_is_that_of_a_method_of_third_order():
    """It falls by 16 with every halving of the step, and is more than the error."""
    a = armour()
    s = Stage(Medium.FRAGMENTED, True, True, True, 750.0, 0.0)
    y = START._replace(L=a.L0)
    steps = [step(0.0, y, rates(y, s, a), s, a, dt) for dt in (4e-7, 2e-7, 1e-7)]
    for coarse, fine in pairwise(steps):
        for name in ("Z", "L", "V", "W"):
            assert getattr(coarse.error, name) / getattr(fine.error, name) == pytest.approx(16.0, rel=0.1)
    state = y
    for _ in range(40):
        state = step(0.0, state, rates(state, s, a), s, a, 1e-8).y_end
    assert abs(steps[0].y_end.V - state.V) < abs(steps[0].error.V)


def test_the_state_within_a_step_is_that_of_the_cubic_through_its_ends():
    def at(x: float) -> State:
        return State(*(c * x**3 - x**2 + 2.0 * x + c for c in (1.0, -2.0, 0.5, 3.0, -1.0)))

    def slope(x: float) -> State:
        return State(*((3.0 * c * x**2 - 2.0 * x + 2.0) / 0.1 for c in (1.0, -2.0, 0.5, 3.0, -1.0)))

    for x in (0.0, 0.25, 0.6, 1.0):
        found = state_within(at(0.0), slope(0.0), at(1.0), slope(1.0), 0.1, x)
        assert tuple(found) == pytest.approx(tuple(at(x)), rel=1e-12)


def test_what_does_not_change_in_a_step_stays_to_the_last_bit():
    y, still = State(0.0011711989959665348, 0.099609375, 0.99999999994636, 0.7, 0.1), State(0.0, 0.0, 0.0, 0.0, 0.0)
    assert all(state_within(y, still, y, still, 1e-6, i / 97) == y for i in range(98))
