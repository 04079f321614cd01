"""Contents of a report on a scenario: its answer, with the results that explain it and say how reliable it is."""

from contextlib import suppress
from dataclasses import dataclass

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, not_monotonic
from armour.analysis.energy import EnergyBalance, energy_balance
from armour.analysis.impact import ImpactResult, simulate
from armour.analysis.variants import OnProgress, ignore_progress
from armour.design.optimise import DesignResult, optimise
from armour.errors import NoLimitError
from armour.scenario.library import LibraryEntry
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, ROLES, VELOCITY, entry_of, inputs_of, with_inputs
from armour.statistics.sensitivity import SensitivityResult, sensitivity
from armour.statistics.uncertainty import UncertaintyResult, uncertainty


@dataclass(frozen=True)
class Contents:
    """Results of a scenario as it was read, and of its answer: the best design against the threat that governs it."""

    scenario: Scenario
    answer: Scenario
    design: DesignResult | None  # None where the scenario asks for no design
    impact: ImpactResult  # with its history
    limit: LimitResult | None  # None where it is outside the range searched
    energy: EnergyBalance
    sensitivity: SensitivityResult
    uncertainty: UncertaintyResult | None  # None without distributions that apply to the answer
    entries: tuple[LibraryEntry, ...]  # projectile and materials
    warnings: tuple[str, ...]


def contents_of(scenario: Scenario, on_progress: OnProgress = ignore_progress) -> Contents:
    """Answer a scenario and gather the results that a report shows."""

    def on_part(done: int, _total: int | None) -> None:
        on_progress(done, None)

    asked = scenario.optimise is not None or scenario.design is not None or bool(scenario.threat)
    design = optimise(scenario, on_progress=on_part) if asked else None
    answer = scenario if design is None else _with_best(scenario, design)
    impact, limit = simulate(answer, history=True), None
    with suppress(NoLimitError):
        limit = ballistic_limit(answer)
    sampled = scenario.uncertainty is not None and scenario.uncertainty.inputs()
    misplaced = _misplaced(scenario, answer)
    return Contents(
        scenario=scenario,
        answer=answer,
        design=design,
        impact=impact,
        limit=limit,
        energy=energy_balance(answer, impact),
        sensitivity=sensitivity(answer, on_progress=on_part),
        uncertainty=uncertainty(answer, on_progress=on_part) if sampled and not misplaced else None,
        entries=tuple(entry for role in ROLES if (entry := entry_of(answer, role)) is not None),
        warnings=(
            *(impact.warnings if design is None else design.warnings),
            *(() if limit is None else not_monotonic(limit)),
            *misplaced,
        ),
    )


def _with_best(scenario: Scenario, result: DesignResult) -> Scenario:
    """Return the scenario with the best design and the threat that governs it."""
    best = result.best
    changes: dict[str, object] = {
        "armour.backing": best.backing,
        CERAMIC: best.ceramic_thickness_mm,
        BACKING: best.backing_thickness_mm,
    }
    densities = {"backing.density_kg_m3": best.backing_density_kg_m3}
    if best.ceramic:
        changes["armour.ceramic"] = best.ceramic
        densities["ceramic.density_kg_m3"] = best.ceramic_density_kg_m3
    for threat in scenario.threat:
        if threat.title == best.governing:
            changes |= {"impact.projectile": threat.projectile, VELOCITY: threat.velocity_m_s}
    answer = scenario.replaced(changes)
    own = inputs_of(answer)
    different = {name: value for name, value in densities.items() if value != own[name]}
    return with_inputs(answer, different) if different else answer


def _misplaced(scenario: Scenario, answer: Scenario) -> tuple[str, ...]:
    """Return a warning for each distribution that is about another value than the answer's."""
    if scenario.uncertainty is None:
        return ()
    own, found = inputs_of(scenario), inputs_of(answer)
    return tuple(
        f"uncertainty.{name}: is about a value of its own, not the design's {found[name]:g}; "
        "no probability of perforation is given"
        for name, distribution in scenario.uncertainty.inputs().items()
        if name in found
        and ((distribution.placed and own.get(name) != found[name]) or not distribution.contains(found[name]))
    )
