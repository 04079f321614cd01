"""Kinetic energy of the projectile, and its loss in each stage of an impact."""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from armour.analysis.impact import ImpactResult, kinetic_energy, run_impact
from armour.core.equations import cross_section
from armour.core.rk4 import state_within
from armour.core.run import Instant
from armour.core.stages import rates, with_intact_strength
from armour.core.state import Parameters, State
from armour.scenario.scenario import Scenario
from armour.units import US


@dataclass(frozen=True)
class StageEnergy:
    """Loss of kinetic energy in a stage, J."""

    stage: str
    eroded: float  # carried off by eroded material at the velocity that it had
    braked: float  # work of the force that decelerates the rest of the rod

    @property
    def total(self) -> float:
        """Total loss in the stage."""
        return self.eroded + self.braked


@dataclass(frozen=True)
class EnergyBalance:
    """Kinetic energy of the projectile, J: at impact, lost in each stage, and left at the end of the run."""

    before: float
    rows: tuple[StageEnergy, ...]
    left: float

    @property
    def difference(self) -> float:
        """Error of the balance: the energy at impact less that left and the losses, which are integrated apart."""
        return self.before - self.left - sum(row.total for row in self.rows)


class _Loss(NamedTuple):
    """Energy, J, or power, W, lost with eroded material and by braking."""

    eroded: float
    braked: float


def energy_balance(scenario: Scenario, impact: ImpactResult) -> EnergyBalance:
    """Integrate the loss of kinetic energy in each stage of an impact along its run.

    The powers are integrated over each time step by Simpson's rule, the state in its middle being that of the cubic
    through the states and rates at its ends, so that the balance closes to the fourth order of the time step.
    """
    armour = with_intact_strength(scenario.core_armour())
    trace: list[Instant] = []
    run_impact(scenario, armour, impact.impact_velocity_m_s, trace)
    steps = [(start, end) for start, end in pairwise(trace) if end.t > start.t]
    losses = [(start.t / US, _lost(start, end, armour)) for start, end in steps]
    rows = []
    for record in impact.stages:
        inside = [loss for time, loss in losses if record.start_us <= time < record.end_us]
        rows.append(StageEnergy(record.stage, *(sum(part) for part in zip(*inside, strict=True))))
    return EnergyBalance(kinetic_energy(trace[0], armour), tuple(rows), kinetic_energy(trace[-1], armour))


def _lost(start: Instant, end: Instant, p: Parameters) -> _Loss:
    """Return the energies lost in a step, J."""
    dt, s = end.t - start.t, start.s
    k0, k1 = rates(start.y, s, p), rates(end.y, s, p)
    middle = state_within(start.y, k0, end.y, k1, dt, 0.5)
    powers = _power(start.y, k0, p), _power(middle, rates(middle, s, p), p), _power(end.y, k1, p)
    return _Loss(*(dt / 6.0 * (first + 4.0 * mid + last) for first, mid, last in zip(*powers, strict=True)))


def _power(y: State, k: State, p: Parameters) -> _Loss:
    """Return the powers, W, at a state with its rates."""
    per_length = p.rho_p * cross_section(p.D0)
    return _Loss(-0.5 * per_length * k.L * y.V**2, -per_length * y.L * k.V * y.V)
