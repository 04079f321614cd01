"""One step of the classical fourth-order Runge-Kutta method."""

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
