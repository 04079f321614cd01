"""Report on a scenario: its answer, and the results that explain it and say how reliable it is."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

from armour import __version__
from armour.analysis.ballistic_limit import (
    ConfidenceResult,
    LimitResult,
    ballistic_limit,
    not_monotonic,
    of_limit,
    without_limit,
)
from armour.analysis.impact import EnergyBalance, ImpactResult, energy_balance, simulate
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import own_errors
from armour.design.optimise import OBJECTIVES, DesignResult, optimise
from armour.errors import NoLimitError, Note
from armour.reporting.charts import Chart
from armour.reporting.report import Card, Report, Section, origin_section
from armour.reporting.table import Column, Table, in_words, listing
from armour.reporting.views import design as design_view
from armour.reporting.views import impact as impact_view
from armour.reporting.views import sensitivity as sensitivity_view
from armour.reporting.views import uncertainty as uncertainty_view
from armour.reporting.views.confidence import DEFEAT, SAMPLED_ALONE, chance, extrapolation, from_tests
from armour.reporting.views.design import AREAL_DENSITY, BALLISTIC_LIMIT, COST, MARGIN, REQUIRED, required_margins
from armour.reporting.views.library import entry_table
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, ROLES
from armour.scenario.scenario import Scenario, title_beside
from armour.scenario.schema import Threat, shot
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
    threats = [_against(*each, design) for each in faced]
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
        design = replace(design, best=best).of(**design.question)
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
    return [(scenario.against(threat), threat) for threat in scenario.threats()]


def _against(scenario: Scenario, threat: Threat, design: DesignResult | None) -> AgainstThreat:
    """Return the scenario's own armour, or else the best design, against a threat."""
    name, required = threat.title, threat.margin_m_s
    if design is not None:
        best = design.best
        return AgainstThreat(name, True, best.margins_m_s[name], required, best.probabilities_of_defeat[name])
    limit, sure = _limit(scenario)
    margin = None if limit is None else limit.ballistic_limit_m_s - threat.velocity_m_s
    defeated = simulate(scenario).outcome == "defeated"
    return AgainstThreat(name, defeated, margin, required, sure.probability_of_defeat)


def _excess(found: AgainstThreat) -> float:
    """Return by how much the margin against a threat exceeds the one required, m/s."""
    if found.margin_m_s is None:
        return inf if found.defeated else -inf
    return found.margin_m_s - found.required_margin_m_s


def _sampled(found: AgainstThreat, scenario: Scenario, on_part: OnProgress) -> AgainstThreat:
    """Return an armour against a threat with the probability of the distributions, if the model's error is in them."""
    if not (scenario.excludes_error() or own_errors(scenario).known.all()):
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


def scenario_report(contents: Contents, command: str) -> Report:
    """Report the results of a scenario; the command is the one that makes the report."""
    scenario = contents.scenario
    return Report(
        title=_subject(contents),
        lead=_question(contents),
        byline=_byline(contents),
        remarks=_remarks(contents),
        sections=(
            _energy(contents),
            *(Section(heading, tables=(table,)) for heading, table in _tables(contents)),
            Section("Scenario", code=scenario.to_toml(), language="toml"),
            origin_section(command),
        ),
        charts=tuple(_charts(contents)),
        cards=(*_armour(contents), _outcome(contents), _reliability(contents)),
        warnings=tuple(_warnings(contents)),
        cross_section=contents.answer,
    )


def _subject(contents: Contents) -> str:
    """Return the armour that is reported, with its threats."""
    return contents.answer.subject(threats=contents.scenario.threat)


def _question(contents: Contents) -> str:
    """Return the question that the scenario asks."""
    design = contents.design
    threats = " and ".join(f"the {found.threat.removeprefix('the ')}" for found in contents.threats)
    if design is None:
        return f"Does this armour defeat {threats}?"
    armour, best = "available armour", design.best
    if len(design.pairs) == 1:
        armour = f"{best.ceramic} on {best.backing}" if best.ceramic else best.backing
    return f"Which {armour} is the {OBJECTIVES[design.minimised].least} that defeats {threats}?"


def _byline(contents: Contents) -> tuple[tuple[str, str], ...]:
    """Return title, project, author and date, where the scenario has them, and the version of the program."""
    scenario = contents.scenario
    given = (
        ("scenario", title_beside(_subject(contents), scenario.title)),
        ("project", scenario.project),
        ("author", scenario.author),
        ("date", scenario.date),
    )
    return (*((name, text) for name, text in given if text), ("revision", f"armour {__version__}"))


def _remarks(contents: Contents) -> tuple[str, ...]:
    """Return which armour is reported where the scenario asks for a design, and how to get the other."""
    if contents.design is not None:
        own = contents.scenario.armour_words()
        return (f"The armour is the best design found. With --as-is, the report is on the scenario's own, {own}.",)
    if asks_for_design(contents.scenario):
        return ("The armour is the scenario's own. Without --as-is, the report is on the best design.",)
    return ()


def _armour(contents: Contents) -> tuple[Card, Card]:
    """Return the armour and its areal density, with the digits of their tables."""
    armour, design = contents.answer.armour, contents.design
    subject, cost = "Armour", ""
    areal_density = contents.impact.areal_density_kg_m2
    thickness = armour.ceramic_thickness_mm + armour.backing_thickness_mm
    if design is not None:
        subject = "Best design"
        areal_density, thickness = design.best.areal_density_kg_m2, design.best.thickness_mm
        cost = f"cost {COST.text(design.best.cost_per_m2)} per m²" if design.best.cost_per_m2 else ""
    card = Card(subject, contents.answer.armour_words(), f"{round(thickness, 3):g} mm thick")
    return card, Card("Areal density", f"{AREAL_DENSITY.text(areal_density)} kg/m²", cost)


def _outcome(contents: Contents) -> Card:
    impact, design = contents.answer.impact, contents.design
    if len(contents.threats) > 1:
        perforating = [found for found in contents.threats if not found.defeated]
        subject = "Perforated by" if perforating else "Defeats"
        named = (found.threat for found in perforating or contents.threats)
        distributed = any(found.sampled for found in contents.threats)
        details = (_against_words(found, exact=distributed and not found.sampled) for found in contents.threats)
        return Card(subject, " and ".join(named), "; ".join(details))
    against = shot(impact)
    limit = "ballistic limit outside the range searched"
    if contents.limit is not None:
        found = contents.limit.ballistic_limit_m_s
        margin = MARGIN.text(found - impact.velocity_m_s)
        limit = f"ballistic limit {BALLISTIC_LIMIT.text(found)} m/s, margin {margin} m/s"
    if design is None:
        outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[contents.impact.outcome]
        return Card("Outcome", outcome, f"{against}; {limit}")
    return Card("Defeats", against, limit)


def _against_words(found: AgainstThreat, *, exact: bool) -> str:
    """Return the outcome against one of several threats, with its margin and probability."""
    outcome = "" if found.defeated else "perforates; "
    margin = "limit outside the range searched"
    if found.margin_m_s is not None:
        margin = f"margin {MARGIN.text(found.margin_m_s)} m/s"
    if found.required_margin_m_s:
        margin = f"{margin} ({MARGIN.text(found.required_margin_m_s)} m/s required, {_requirement(found)})"
    probability = f"probability of defeat {chance(found.probability_of_defeat)}"
    if exact and found.probability_of_defeat is not None:
        probability += " with exact inputs"
    return f"{found.threat}: {outcome}{margin}, {probability}"


def _reliability(contents: Contents) -> Card:
    """Return the probability of defeating the threat, and what it rests on; none without the error of the model.

    If a scenario says not to include that, the probability is that of its distributions.
    """
    subject, sure, sampled = DEFEAT.label.capitalize(), contents.confidence, contents.uncertainty
    if len(contents.threats) > 1:
        subject = f"{subject} that governs, {contents.governing}"
    if sampled is None or (sampled.model_error is None and not contents.scenario.excludes_error()):
        note = sure.reason or (from_tests(sure.model_error) if sure.model_error else "")
        if sampled is not None and sure.probability_of_defeat is None:
            note = f"{note}; {SAMPLED_ALONE}"
        return Card(subject, chance(sure.probability_of_defeat), note)
    p = sampled.probability_of_perforation
    given = ", without the error of the model"
    if sampled.model_error is not None:
        given = f" and the error of the model; {from_tests(sampled.model_error)}"
    interval = f"95 % interval {100.0 * (1.0 - p.high):.1f} to {100.0 * (1.0 - p.low):.1f} %"
    return Card(subject, chance(1.0 - p.value), f"{interval}, from the given distributions{given}")


def _warnings(contents: Contents) -> Iterator[str]:
    """Give all warnings, with the words of the inputs that they are about in place of their keys."""
    for warning in contents.warnings:
        name = warning.key.removeprefix("uncertainty.") if isinstance(warning, Note) else ""
        if isinstance(warning, Note) and name in INPUTS:
            words = in_words(name)
            yield Note(warning.text, words if name == warning.key else f"distribution of the {words}")
        else:
            yield warning
    if error := contents.confidence.model_error:
        yield from (f"the error of the model is {text}" for text in extrapolation(error))
    if contents.design is not None:
        ask = "design.confidence = 0.95 in the scenario designs for a probability of 95 %"
        yield from design_view.margin_notes(contents.design.best, ask)


def _energy(contents: Contents) -> Section:
    energy = contents.energy
    words = (
        f"The projectile has {energy.before:.2f} J at impact and {energy.left:.2f} J at the end.",
        "The losses are the powers integrated along the run, apart from the motion: "
        f"the balance closes to {abs(energy.difference):.1g} J.",
    )
    return Section("Energy balance of the projectile", words, tables=(impact_view.energy_table(energy),))


def _tables(contents: Contents) -> Iterator[tuple[str, Table]]:
    """Give tables with their headings: designs, stages, uncertainty, sensitivity, and materials with their sources."""
    design = contents.design
    if design is not None:
        required = required_margins(contents.scenario)
        yield "Best design", design_view.best_table(design, required)
        if len(design.threats) > 1 or design.best.probabilities:
            yield "Margins against the threats", design_view.margin_table(design, required)
        if len(design.pairs) > 1:
            yield "Pairs of materials", design_view.pair_table(design)
        else:
            yield "Required ceramic for each back plate", design_view.frontier_table(design)
        if design.pareto:
            yield "Pareto front", design_view.pareto_table(design)
    elif len(contents.threats) > 1:
        yield "Margins against the threats", _margins(contents)
    yield "Stages of the impact", impact_view.stage_table(contents.impact)
    if contents.uncertainty is not None:
        yield "Results under uncertain inputs", uncertainty_view.estimate_table(contents.uncertainty)
    yield "Sensitivity to the inputs", sensitivity_view.elasticity_table(contents.sensitivity)
    for entry in filter(None, map(contents.answer.entry_of, ROLES)):
        yield f"{entry.kind.capitalize()}: {entry.name}", entry_table(entry, Column("quantity", prose=True), in_words)


def _margins(contents: Contents) -> Table:
    """Return the margins of the scenario's own armour."""
    return listing(
        contents.threats,
        (Column("threat", prose=True), lambda found: found.threat),
        (Column("outcome"), lambda found: "defeated" if found.defeated else "perforates"),
        MARGIN,
        (REQUIRED, lambda found: found.required_margin_m_s or None),
        (Column("requirement"), _requirement),
        (DEFEAT, lambda found: chance(found.probability_of_defeat)),
        (Column("note"), lambda found: "governs" if found.threat == contents.governing else ""),
    )


def _requirement(found: AgainstThreat) -> str:
    """Return whether an armour has the margin that a threat requires; "" where none is required."""
    if not found.required_margin_m_s:
        return ""
    has = found.defeated if found.margin_m_s is None else found.margin_m_s >= found.required_margin_m_s
    return "met" if has else "not met"


def _charts(contents: Contents) -> Iterator[Chart]:
    if contents.design is not None:
        yield design_view.map_chart(contents.design)
        if contents.design.pareto:
            yield design_view.pareto_chart(contents.design)
    if contents.uncertainty is not None:
        yield uncertainty_view.chart(contents.uncertainty)
    yield sensitivity_view.chart(contents.sensitivity)
    # The low chart before the high one, so that the first printed page has room for it.
    yield impact_view.energy_chart(contents.energy)
    yield impact_view.chart(contents.impact)
