"""Kinetic energy of the projectile, and its loss in each stage of an impact."""

from dataclasses import dataclass

from armour.analysis.impact import ImpactResult
from armour.core.equations import cross_section
from armour.scenario.loading import Scenario
from armour.units import MM


@dataclass(frozen=True)
class StageEnergy:
    """Loss of kinetic energy in a stage, J."""

    stage: str
    eroded: float  # carried off by eroded material at the velocity that it had
    braked: float  # lost by the rest of the rod, by the force on its front

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
        """Rounding error of the balance."""
        return self.before - self.left - sum(row.total for row in self.rows)


def energy_balance(scenario: Scenario, impact: ImpactResult) -> EnergyBalance:
    """Compute the loss of kinetic energy in each stage of an impact.

    The energy of the eroded material is integrated over the history, with a velocity linear in length between two
    instants; the rest of a stage's loss brakes the rod.
    """
    history = impact.history
    if history is None:
        raise ValueError("the result has no history; simulate(..., history=True) keeps it")
    a = scenario.core_armour()
    per_length = a.rho_p * cross_section(a.D0)
    length, velocity, time = history.length_mm * MM, history.velocity_m_s, history.time_us
    squares = (velocity[:-1] ** 2 + velocity[:-1] * velocity[1:] + velocity[1:] ** 2) / 3.0
    eroded = 0.5 * per_length * squares * (length[:-1] - length[1:])
    rows = []
    for record in impact.stages:
        inside = (time[:-1] >= record.start_us) & (time[1:] <= record.end_us) & (time[1:] > time[:-1])
        carried_off = float(eroded[inside].sum())
        rows.append(StageEnergy(record.stage, carried_off, record.energy_lost_J - carried_off))
    before = 0.5 * per_length * a.L0 * impact.impact_velocity_m_s**2
    left = 0.5 * per_length * float(length[-1]) * float(velocity[-1]) ** 2
    return EnergyBalance(before, tuple(rows), left)
