"""Kinetic energy of the projectile: what each stage of an impact takes from it."""

from dataclasses import dataclass

from armour.analysis.impact import ImpactResult
from armour.core.equations import cross_section
from armour.scenario.loading import Scenario
from armour.units import MM


@dataclass(frozen=True)
class StageEnergy:
    """Kinetic energy that a stage takes from the projectile, J.

    Attributes
    ----------
    stage : str
    eroded : float
        Carried off by eroded material at the velocity that it had.
    braked : float
        Lost by the rest of the rod, by the force on its front.
    """

    stage: str
    eroded: float
    braked: float

    @property
    def total(self) -> float:
        """Return all that the stage takes."""
        return self.eroded + self.braked


@dataclass(frozen=True)
class EnergyBalance:
    """Kinetic energy of the projectile, J.

    Attributes
    ----------
    before : float
        At impact.
    rows : tuple of StageEnergy
        What each stage takes.
    left : float
        At the end of the run.
    """

    before: float
    rows: tuple[StageEnergy, ...]
    left: float

    @property
    def difference(self) -> float:
        """Return what stages and remainder do not account for, which is rounding."""
        return self.before - self.left - sum(row.total for row in self.rows)


def energy_balance(scenario: Scenario, impact: ImpactResult) -> EnergyBalance:
    """Compute what each stage of an impact takes from the projectile's kinetic energy.

    Eroded material carries off the energy of its velocity, summed over the history as if velocity fell linearly with
    length between two instants; the rest of a stage's loss brakes the rod.
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
