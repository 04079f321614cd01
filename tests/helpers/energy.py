"""Balance of the kinetic energy of a projectile, whose losses are integrated apart from its motion."""

from dataclasses import dataclass
from itertools import pairwise

from armour.analysis.impact import ImpactResult, kinetic_energy, run_impact
from armour.core import equations
from armour.core.rk4 import state_within
from armour.core.run import Instant
from armour.core.stages import rates
from armour.core.state import Parameters, State
from armour.scenario.scenario import Scenario


@dataclass(frozen=True)
class EnergyBalance:
    """Kinetic energy of the projectile, J: at impact, lost, and left at the end of the run."""

    before: float
    eroded: float  # carried off by eroded material at the velocity that it had
    braked: float  # work of the force that decelerates the rest of the rod
    left: float

    @property
    def difference(self) -> float:
        """Energy at impact minus the energies lost and left, J: the error of the integrated losses."""
        return self.before - self.eroded - self.braked - self.left


def energy_balance(scenario: Scenario, impact: ImpactResult) -> EnergyBalance:
    """Integrate the loss of kinetic energy along the run of an impact.

    Simpson's rule integrates the powers over each time step.  The state in the middle of a step is that of the cubic
    through the states and rates at its ends, so the balance closes to the fourth order of the time step.
    """
    _, trace, armour = run_impact(scenario, impact.impact_velocity_m_s)
    losses = [_lost(start, end, armour) for start, end in pairwise(trace) if end.t > start.t]
    eroded, braked = map(sum, zip(*losses, strict=True))
    return EnergyBalance(kinetic_energy(trace[0], armour), eroded, braked, kinetic_energy(trace[-1], armour))


def _lost(start: Instant, end: Instant, p: Parameters) -> list[float]:
    """Return the energies lost in a step with eroded material and by braking, J."""
    dt, s = end.t - start.t, start.s
    k0, k1 = rates(start.y, s, p), rates(end.y, s, p)
    middle = state_within(start.y, k0, end.y, k1, dt, 0.5)
    powers = _power(start.y, k0, p), _power(middle, rates(middle, s, p), p), _power(end.y, k1, p)
    return [dt / 6.0 * (first + 4.0 * mid + last) for first, mid, last in zip(*powers, strict=True)]


def _power(y: State, k: State, p: Parameters) -> tuple[float, float]:
    """Return the powers lost with eroded material and by braking, W, at state `y` with rates `k`."""
    per_length = p.rho_p * equations.cross_section(p.D0)
    return -0.5 * per_length * k.L * y.V**2, -per_length * y.L * k.V * y.V
