"""One step of the classical fourth-order Runge-Kutta method, and the states within it."""

from armour.core.stages import rates
from armour.core.state import Parameters, Stage, State


def advance(y: State, k: State, dt: float) -> State:
    """Return the state after a time dt, s, at constant rates k."""
    return State(y.Z + dt * k.Z, y.L + dt * k.L, y.V + dt * k.V, y.W + dt * k.W, y.h + dt * k.h)


def step(y: State, k1: State, s: Stage, p: Parameters, dt: float) -> State:
    """Return the state after a step of dt, s, in one stage; k1 are the rates at y."""
    k2 = rates(advance(y, k1, dt / 2.0), s, p)
    k3 = rates(advance(y, k2, dt / 2.0), s, p)
    k4 = rates(advance(y, k3, dt), s, p)
    c = dt / 6.0
    return State(
        y.Z + c * (k1.Z + 2.0 * (k2.Z + k3.Z) + k4.Z),
        y.L + c * (k1.L + 2.0 * (k2.L + k3.L) + k4.L),
        y.V + c * (k1.V + 2.0 * (k2.V + k3.V) + k4.V),
        y.W + c * (k1.W + 2.0 * (k2.W + k3.W) + k4.W),
        y.h + c * (k1.h + 2.0 * (k2.h + k3.h) + k4.h),
    )


def state_within(y0: State, k0: State, y1: State, k1: State, dt: float, x: float) -> State:
    """Return the state at a fraction x of a step of dt, s: the cubic through the states and rates at its ends."""
    b1 = x * x * (3.0 - 2.0 * x)
    b0 = 1.0 - b1
    c0 = dt * x * (1.0 - x) * (1.0 - x)
    c1 = -dt * x * x * (1.0 - x)
    return State(
        b0 * y0.Z + b1 * y1.Z + c0 * k0.Z + c1 * k1.Z,
        b0 * y0.L + b1 * y1.L + c0 * k0.L + c1 * k1.L,
        b0 * y0.V + b1 * y1.V + c0 * k0.V + c1 * k1.V,
        b0 * y0.W + b1 * y1.W + c0 * k0.W + c1 * k1.W,
        b0 * y0.h + b1 * y1.h + c0 * k0.h + c1 * k1.h,
    )
