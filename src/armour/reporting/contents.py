"""All that a report on a scenario says: the answer, how it comes about and how sure it is."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit
from armour.analysis.impact import ImpactResult, simulate
from armour.core.equations import cross_section
from armour.design.catalogue import StudyResult, asks_for_study, study
from armour.design.optimisation import OptimumResult, optimise, with_thicknesses
from armour.errors import NoLimitError
from armour.scenario.library import LibraryEntry
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, ROLES, entry_of, inputs_of, with_inputs
from armour.statistics.sensitivity import SensitivityResult, sensitivity
from armour.statistics.uncertainty import UncertaintyResult, uncertainty
from armour.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class StageEnergy:
    """What a stage took of the projectile's kinetic energy, J.

    Attributes
    ----------
    stage : str
    eroded : float
        With the material that eroded, at the velocity that it had.
    braked : float
        From what was left of the rod, by the force on its front.
    """

    stage: str
    eroded: float
    braked: float

    @property
    def total(self) -> float:
        """All that the stage took."""
        return self.eroded + self.braked


@dataclass(frozen=True)
class EnergyBalance:
    """Where the projectile's kinetic energy went, J."""

    before: float
    rows: tuple[StageEnergy, ...]
    left: float

    @property
    def difference(self) -> float:
        """What the rows and the rest do not account for; rounding."""
        return self.before - self.left - sum(row.total for row in self.rows)


@dataclass(frozen=True)
class Contents:
    """A scenario's question, answered.

    Attributes
    ----------
    scenario : Scenario
        As it was read.
    answer : Scenario
        With the design that answers it and the threat that governs it.
    optimum : OptimumResult or StudyResult or None
        None where the scenario asks for no design.
    impact : ImpactResult
        Of the answer, with its history.
    limit : LimitResult or None
        Of the answer; None outside the range of its search.
    ledger : Ledger
    sensitivity : SensitivityResult
    uncertainty : UncertaintyResult or None
        None where the scenario has no distributions.
    entries : tuple of LibraryEntry
        What the answer is made of.
    warnings : tuple of str
    """

    scenario: Scenario
    answer: Scenario
    optimum: OptimumResult | StudyResult | None
    impact: ImpactResult
    limit: LimitResult | None
    energy: EnergyBalance
    sensitivity: SensitivityResult
    uncertainty: UncertaintyResult | None
    entries: tuple[LibraryEntry, ...]
    warnings: tuple[str, ...]

    @property
    def margin_m_s(self) -> float | None:
        """Ballistic limit less the threat's velocity."""
        return None if self.limit is None else self.limit.ballistic_limit_m_s - self.answer.impact.velocity_m_s


def contents_of(scenario: Scenario) -> Contents:
    """Answer a scenario and gather what there is to say of the answer.

    Raises
    ------
    InputError
        If something in the scenario is wrong.
    NoAnswerError
        If no design defeats its threats.
    """
    optimum: OptimumResult | StudyResult | None = None
    answer = scenario
    if asks_for_study(scenario):
        optimum = study(scenario)
        answer = _studied(scenario, optimum)
    elif scenario.optimise is not None:
        optimum = optimise(scenario)
        answer = with_thicknesses(scenario, optimum.best)
    impact = simulate(answer, history=True)
    sampled = scenario.uncertainty is not None and scenario.uncertainty.inputs()
    elsewhere = _elsewhere(scenario, answer)
    return Contents(
        scenario=scenario,
        answer=answer,
        optimum=optimum,
        impact=impact,
        limit=_limit(answer),
        energy=energy_balance(answer, impact),
        sensitivity=sensitivity(answer),
        uncertainty=uncertainty(answer) if sampled and not elsewhere else None,
        entries=tuple(entry for role in ROLES if (entry := entry_of(answer, role)) is not None),
        warnings=(*impact.warnings, *elsewhere),
    )


def _elsewhere(scenario: Scenario, answer: Scenario) -> tuple[str, ...]:
    """Which distributions have a place of their own that is not the answer's."""
    if scenario.uncertainty is None:
        return ()
    own, found = inputs_of(scenario), inputs_of(answer)
    return tuple(
        f"uncertainty.{name}: is about a value of its own, not the design's {found[name]:g}; no probability is told"
        for name, distribution in scenario.uncertainty.inputs().items()
        if distribution.placed and name in found and own.get(name) != found[name]
    )


def _studied(scenario: Scenario, result: StudyResult) -> Scenario:
    """The scenario with the best design of a study and the threat that governs it."""
    threats = {threat.title: threat for threat in scenario.threat}
    threat = threats.get(result.best.governing)
    changes: dict[str, object] = {
        "armour.backing": result.best.backing,
        CERAMIC: result.best.ceramic_thickness_mm,
        BACKING: result.best.backing_thickness_mm,
    }
    if result.best.ceramic:
        changes["armour.ceramic"] = result.best.ceramic
    if threat is not None:
        changes |= {"impact.projectile": threat.projectile, "impact.velocity_m_s": threat.velocity_m_s}
    made = scenario.replaced(changes)
    densities = {"backing.density_kg_m3": result.best.backing_density_kg_m3}
    if result.best.ceramic:
        densities["ceramic.density_kg_m3"] = result.best.ceramic_density_kg_m3
    own = inputs_of(made)
    other = {name: value for name, value in densities.items() if value != own[name]}
    return with_inputs(made, other) if other else made


def _limit(scenario: Scenario) -> LimitResult | None:
    try:
        return ballistic_limit(scenario)
    except NoLimitError:
        return None


def energy_balance(scenario: Scenario, impact: ImpactResult) -> EnergyBalance:
    """Where the projectile's kinetic energy went, stage by stage.

    What eroded took the energy of its velocity along, which is summed over the history as if the velocity fell evenly
    with the length between two instants; the rest of a stage's loss braked the rod.
    """
    history = impact.history
    assert history is not None
    a = scenario.core_armour()
    per_length = a.rho_p * cross_section(a.D0)
    length, velocity, time = history.length_mm * MM, history.velocity_m_s, history.time_us
    squares = (velocity[:-1] ** 2 + velocity[:-1] * velocity[1:] + velocity[1:] ** 2) / 3.0
    eroded = 0.5 * per_length * squares * (length[:-1] - length[1:])
    rows = []
    for record in impact.stages:
        inside = (time[:-1] >= record.start_us) & (time[1:] <= record.end_us) & (time[1:] > time[:-1])
        with_material = float(eroded[inside].sum())
        rows.append(StageEnergy(record.stage, with_material, record.energy_lost_J - with_material))
    before = 0.5 * per_length * a.L0 * impact.impact_velocity_m_s**2
    left = 0.5 * per_length * float(length[-1]) * float(velocity[-1]) ** 2
    return EnergyBalance(before, tuple(rows), left)


def rod_mm(scenario: Scenario) -> tuple[float, float]:
    """Length and diameter of the penetrator, mm."""
    a = scenario.core_armour()
    return a.L0 / MM, a.D0 / MM
