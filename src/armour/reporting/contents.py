"""Contents of a report on a scenario: its answer, with the results that explain it and say how reliable it is."""

from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, not_monotonic
from armour.analysis.confidence import ConfidenceResult, of_limit, without_limit
from armour.analysis.energy import EnergyBalance, energy_balance
from armour.analysis.impact import ImpactResult, simulate
from armour.analysis.progress import OnProgress, ignore_progress
from armour.design.optimise import DesignResult, optimise
from armour.errors import NoLimitError, Note
from armour.scenario.inputs import BACKING, CERAMIC, ROLES, VELOCITY
from armour.scenario.library import LibraryEntry
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Threat
from armour.statistics.sensitivity import SensitivityResult, sensitivity
from armour.statistics.uncertainty import UncertaintyResult, probability_of_perforation, uncertainty


class AgainstThreat(NamedTuple):
    """The armour of a report against one threat."""

    threat: str  # projectile and velocity, or its name
    defeated: bool
    margin_m_s: float | None  # None where the ballistic limit is outside the range searched
    required_margin_m_s: float
    probability_of_defeat: float | None  # None where it is not known
    sampled: bool = False  # whether it is that of the scenario's distributions


@dataclass(frozen=True)
class Contents:
    """Results of a scenario as it was read, and of its answer: the armour against the threat that governs it."""

    scenario: Scenario
    answer: Scenario
    design: DesignResult | None  # None for the scenario's own armour
    threats: tuple[AgainstThreat, ...]
    governing: str  # threat that the margin exceeds the least
    impact: ImpactResult  # with its history
    limit: LimitResult | None  # None where it is outside the range searched
    confidence: ConfidenceResult
    energy: EnergyBalance
    sensitivity: SensitivityResult
    uncertainty: UncertaintyResult | None  # None without distributions that apply to the answer
    entries: tuple[LibraryEntry, ...]  # projectile and materials
    warnings: tuple[str, ...]


def asks_for_design(scenario: Scenario) -> bool:
    """Return whether a scenario asks for the best design."""
    return scenario.optimise is not None or scenario.design is not None or bool(scenario.threat)


def contents_of(scenario: Scenario, on_progress: OnProgress = ignore_progress, *, as_is: bool = False) -> Contents:
    """Answer a scenario and gather the results that a report shows.

    The armour is the best design where the scenario asks for one, unless it is to be reported as it is.
    """

    def on_part(done: int, _total: int | None) -> None:
        on_progress(done, None)

    design = optimise(scenario, on_progress=on_part) if asks_for_design(scenario) and not as_is else None
    faced = _faced(scenario if design is None else _with_best(scenario, design))
    threats = (
        [_against(*each) for each in faced] if design is None else [_passed(design, threat) for _, threat in faced]
    )
    sampled = scenario.uncertainty is not None and bool(scenario.uncertainty.inputs())
    misplaced = [_misplaced(scenario, against) for against, _ in faced]
    if sampled:
        threats = [
            found if wrong else _sampled(found, against, on_part)
            for found, (against, _), wrong in zip(threats, faced, misplaced, strict=True)
        ]
    if design is None:
        place = min(range(len(threats)), key=lambda index: _excess(threats[index]))
    else:
        place = [found.threat for found in threats].index(design.best.governing)
        probabilities = {found.threat: found.probability_of_defeat for found in threats}
        best = replace(design.best, probabilities_of_defeat=probabilities)
        design = replace(design, best=best)._of(**design._question)
    answer = faced[place][0]
    impact = simulate(answer, history=True)
    limit, sure = _limit(answer)
    return Contents(
        scenario=scenario,
        answer=answer,
        design=design,
        threats=tuple(threats),
        governing=threats[place].threat,
        impact=impact,
        limit=limit,
        confidence=sure,
        energy=energy_balance(answer, impact),
        sensitivity=sensitivity(answer, on_progress=on_part),
        uncertainty=uncertainty(answer, on_progress=on_part) if sampled and not misplaced[place] else None,
        entries=tuple(entry for role in ROLES if (entry := answer.entry_of(role)) is not None),
        warnings=(
            *(impact.warnings if design is None else design.warnings),
            *(() if limit is None else not_monotonic(limit)),
            *dict.fromkeys(warning for found in misplaced for warning in found),
        ),
    )


def _limit(scenario: Scenario) -> tuple[LimitResult | None, ConfidenceResult]:
    """Return the ballistic limit, None outside the range searched, and the confidence in the armour."""
    try:
        limit = ballistic_limit(scenario)
    except NoLimitError as error:
        reason = "there is no ballistic limit in the range searched"
        return None, without_limit(scenario, reason, above=error.above)
    return limit, of_limit(scenario, limit.ballistic_limit_m_s, scenario.impact.velocity_m_s)


def _faced(scenario: Scenario) -> list[tuple[Scenario, Threat]]:
    """Return every threat, with the scenario of its impact."""
    impact = scenario.impact
    if not scenario.threat:
        return [(scenario, Threat(projectile=impact.projectile, velocity_m_s=impact.velocity_m_s))]
    return [
        (scenario.replaced({"impact.projectile": threat.projectile, VELOCITY: threat.velocity_m_s}), threat)
        for threat in scenario.threat
    ]


def _against(scenario: Scenario, threat: Threat) -> AgainstThreat:
    limit, sure = _limit(scenario)
    margin = None if limit is None else limit.ballistic_limit_m_s - threat.velocity_m_s
    defeated = simulate(scenario).outcome == "defeated"
    return AgainstThreat(threat.title, defeated, margin, threat.margin_m_s, sure.probability_of_defeat)


def _excess(found: AgainstThreat) -> float:
    """Return by how much the margin against a threat exceeds the one required, m/s."""
    if found.margin_m_s is None:
        return inf if found.defeated else -inf
    return found.margin_m_s - found.required_margin_m_s


def _passed(design: DesignResult, threat: Threat) -> AgainstThreat:
    """Return the best design against a threat."""
    best, name = design.best, threat.title
    return AgainstThreat(name, True, best.margins_m_s[name], threat.margin_m_s, best.probabilities_of_defeat[name])


def _sampled(found: AgainstThreat, scenario: Scenario, on_part: OnProgress) -> AgainstThreat:
    """Return an armour against a threat with the probability of the distributions, if the model's error is in them."""
    if scenario.model_error() is None and not scenario.excludes_error():
        return found
    perforation = probability_of_perforation(scenario, on_progress=on_part)
    return found._replace(probability_of_defeat=1.0 - perforation.value, sampled=True)


def _with_best(scenario: Scenario, result: DesignResult) -> Scenario:
    """Return the scenario with the best design."""
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
    answer = scenario.replaced(changes)
    own = answer.inputs()
    different = {name: value for name, value in densities.items() if value != own[name]}
    return answer.with_inputs(different) if different else answer


def _misplaced(scenario: Scenario, answer: Scenario) -> tuple[Note, ...]:
    """Return a warning for each distribution that is about another value than the answer's."""
    if scenario.uncertainty is None:
        return ()
    own, found = scenario.inputs(), answer.inputs()
    return tuple(
        Note(
            f"is given for another value than {found[name]:g}, that of the armour and threat reported; "
            "the report has no sampled probability of perforation",
            f"uncertainty.{name}",
        )
        for name, distribution in scenario.uncertainty.inputs().items()
        if name in found
        and ((distribution.placed and own.get(name) != found[name]) or not distribution.contains(found[name]))
    )
