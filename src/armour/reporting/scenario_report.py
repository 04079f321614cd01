"""Report on a scenario: its answer, and the results that explain it and say how reliable it is."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from armour import __version__
from armour.analysis.ballistic_limit import (
    ConfidenceResult,
    ballistic_limit,
    not_monotonic,
    of_limit,
    without_limit,
)
from armour.analysis.impact import ImpactResult, energy_balance, simulate
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import own_errors
from armour.design.check import CheckedThreat, CheckResult, check, verdict_of
from armour.design.optimise import OBJECTIVES, DesignResult, optimise
from armour.errors import NoLimitError, Note
from armour.evidence.model_error import given_error
from armour.evidence.tests import armour_of
from armour.reporting.lookup import drawing_of
from armour.reporting.report import Card, Report, ReportSection, origin_section, reference_notes
from armour.reporting.table import Column, Table, column_of, in_words, listing
from armour.reporting.text import interval, percent
from armour.reporting.views import check as check_view
from armour.reporting.views import design as design_view
from armour.reporting.views import impact as impact_view
from armour.reporting.views import sensitivity as sensitivity_view
from armour.reporting.views import uncertainty as uncertainty_view
from armour.reporting.views.design import AREAL_DENSITY, COST
from armour.reporting.views.library import entry_table
from armour.reporting.words import (
    SAMPLED_ALONE,
    STOPPING,
    chance,
    extrapolation,
    flow_stress_notes,
    from_tests,
)
from armour.scenario.inputs import INPUTS, NAMES, ROLES
from armour.scenario.scenario import Scenario, title_beside
from armour.scenario.schema import DesignSection
from armour.statistics.sensitivity import SensitivityResult, sensitivity
from armour.statistics.uncertainty import UncertaintyResult, probability_of_perforation, uncertainty

# Keys of [design] that ask something of any armour, not for a design.
OF_ANY_ARMOUR = {"confidence", "thickness_tolerance_mm", "angles_as_at_normal_incidence"}
# What the model leaves out, see docs/limits.md.
ASSUMPTIONS = (
    ("Penetrator", "a flat-ended cylinder of one material; jacket, tip, sabot and fracture of the core are left out"),
    ("Flight", "straight, without ricochet or yaw; an angle acts through the thickness along the line of fire"),
    ("Armour", "layers in contact; adhesive, covers and spall liners do not resist"),
    ("Hits", "a single one, far from the edges and joints of an unconfined tile or plate"),
    ("Back plate", "resists by its strength and fails by a plug; dishing, petalling, tearing and cracks are left out"),
    ("Stopped", "no perforation; deformation behind the armour and spall are not assessed"),
    ("Probability", "based on the errors of the model on tests; the materials have the values listed here"),
    ("Use", "does not replace firing tests: do not rely on this report alone for anyone's protection"),
)


@dataclass(frozen=True)
class Contents:
    """Results of a scenario as it was read, and of the armour that is reported: the best design, or its own."""

    scenario: Scenario
    design: DesignResult | None  # None for the scenario's own armour
    check: CheckResult  # of the armour, with exact inputs
    threats: tuple[CheckedThreat, ...]  # the same, with the scenario's distributions where these apply
    sampled: tuple[str, ...]  # threats that they apply to
    threat: CheckedThreat  # that most likely perforates the armour, as far as is known
    answer: Scenario  # the armour against it
    impact: ImpactResult  # with its history
    confidence: ConfidenceResult
    sensitivity: SensitivityResult
    uncertainty: UncertaintyResult | None  # None without distributions that apply to the answer
    warnings: tuple[str, ...]


def asks_for_design(scenario: Scenario) -> bool:
    """Return whether a scenario asks for the best design."""
    section = scenario.design
    return scenario.optimise is not None or (section is not None and not section.model_fields_set <= OF_ANY_ARMOUR)


def contents_of(scenario: Scenario, on_progress: OnProgress = ignore_progress, *, as_is: bool = False) -> Contents:
    """Answer a scenario and gather the results that a report shows.

    The armour is the best design where the scenario asks for one, unless it is to be reported as it is.
    """

    def on_part(done: int, _total: int | None) -> None:
        on_progress(done, None)

    design = optimise(scenario, on_progress=on_part) if asks_for_design(scenario) and not as_is else None
    # Where no design is named, the report is on the best one of a pair that is not ranked.
    shown = None if design is None else design.shown or next((pair.best for pair in design.pairs if pair.best), None)
    armour = scenario if shown is None else scenario.replaced(shown.changes_to(scenario))
    checked = check(armour, on_progress=on_part)
    faced = [armour.against(threat) for threat in armour.threats()]
    distributed = scenario.uncertainty is not None and bool(scenario.uncertainty.inputs())
    misplaced = [_misplaced(scenario, against) for against in faced]
    threats, sampled = list(checked.threats), []
    for place, (against, warnings) in enumerate(zip(faced, misplaced, strict=True)):
        if distributed and not warnings and (against.excludes_error() or own_errors(against).known.all()):
            threats[place] = _sampled(threats[place], against, on_part)
            sampled.append(threats[place].threat)
    worst = min(range(len(threats)), key=lambda place: check_view.standing(threats[place]))
    answer = faced[worst]
    if design is not None and shown is not None and design.shown is not None:
        probabilities = {found.threat: found.probability_of_stopping for found in threats}
        shown = replace(shown, probabilities_of_stopping=probabilities)
        named = replace(design, nearest=shown) if design.reason else replace(design, best=shown)
        design = named.of(**design.question)
    sure, not_alone = _confidence(answer)
    unused = scenario.unused_distributions() if distributed else ()
    return Contents(
        scenario=scenario,
        design=design,
        check=checked,
        threats=tuple(threats),
        sampled=tuple(sampled),
        threat=threats[worst],
        answer=answer,
        impact=simulate(answer, history=True),
        confidence=sure,
        sensitivity=sensitivity(answer, on_progress=on_part),
        uncertainty=uncertainty(answer, on_progress=on_part) if distributed and not misplaced[worst] else None,
        warnings=(
            *(warning for warning in (checked if design is None else design).warnings if warning not in unused),
            *not_alone,
            *dict.fromkeys(warning for found in misplaced for warning in found),
        ),
    )


def _confidence(scenario: Scenario) -> tuple[ConfidenceResult, Sequence[str]]:
    """Return the confidence in the armour, and a warning where the outcome changes more than once."""
    try:
        limit = ballistic_limit(scenario)
    except NoLimitError as error:
        reason = "there is no ballistic limit in the range searched"
        return without_limit(scenario, reason, above=error.above), ()
    return of_limit(scenario, limit.ballistic_limit_m_s, scenario.impact.velocity_m_s), not_monotonic(limit)


def _sampled(found: CheckedThreat, scenario: Scenario, on_part: OnProgress) -> CheckedThreat:
    """Return an armour against a threat with the probability that the distributions give."""
    probability = 1.0 - probability_of_perforation(scenario, on_progress=on_part).value
    required = found.required_probability
    verdict = found.verdict if required is None else verdict_of(required, probability, stops=True)
    return replace(found, probability_of_stopping=probability, verdict=verdict)


def _misplaced(scenario: Scenario, answer: Scenario) -> tuple[Note, ...]:
    """Return a warning for each distribution that is about another value than the answer's."""
    if scenario.uncertainty is None:
        return ()
    own, found = scenario.inputs(), answer.inputs()
    return tuple(
        Note(
            f"is given for a value other than {found[name]:g}, which the armour and threat reported have; "
            "the report has no sampled probability of perforation",
            f"uncertainty.{name}",
        )
        for name, distribution in scenario.uncertainty.inputs().items()
        if name in found
        and ((distribution.placed and own.get(name) != found[name]) or not distribution.contains(found[name]))
    )


def scenario_report(contents: Contents, command: str, map_command: str = "") -> Report:
    """Report the results of a scenario; the commands are those that make the report and a map of the designs."""
    passed, lead = _verdict(contents)
    title = contents.answer.subject(threats=contents.scenario.threat)
    return Report(
        title=title,
        lead=lead,
        passed=passed,
        byline=_byline(contents.scenario, title),
        sections=tuple(_sections(contents, command, map_command)),
        cards=tuple(_cards(contents)),
        warnings=tuple(_warnings(contents)),
        cross_section=contents.answer,
    )


def _byline(scenario: Scenario, subject: str) -> tuple[tuple[str, str], ...]:
    """Return title, project, author and date, where the scenario has them, and the version of the program."""
    given = (
        ("scenario", title_beside(subject, scenario.title)),
        ("project", scenario.project),
        ("author", scenario.author),
        ("date", scenario.date),
    )
    return (*((name, text) for name, text in given if text), ("program version", f"armour {__version__}"))


def _is_asked(contents: Contents) -> bool:
    """Return whether a probability or a margin is asked for."""
    return any(of.required_probability is not None or of.required_margin_m_s for of in contents.threats)


def _verdict(contents: Contents) -> tuple[bool | None, str]:
    """Return whether the armour does what was asked for, None where nothing was, and this in words."""
    threats = contents.threats
    if contents.design is not None and contents.design.reason:
        return False, f"{design_view.title(contents.design)}."
    if not _is_asked(contents):
        return None, ""
    if failed := [of.threat for of in threats if of.verdict == "fails"]:
        return False, f"Does not meet the requirements against {' and '.join(failed)}."
    if unknown := [of.threat for of in threats if of.verdict == "not known"]:
        return False, f"Not known to meet the requirements against {' and '.join(unknown)}."
    return True, f"Meets the requirements{' against every threat' if len(threats) > 1 else ''}."


def _cards(contents: Contents) -> Iterator[Card]:
    """Give the probability, the armour and what was asked for."""
    found = chance(contents.threat.probability_of_stopping, contents.threat.model_error)
    value, against = found, ""
    others = [of for of in contents.threats if of is not contents.threat]
    unknown = [of.threat for of in others if of.probability_of_stopping is None]
    if others:
        against = f"against {contents.threat.threat}; "
    if contents.threat.probability_of_stopping is not None and unknown:
        value = f"{found} or unknown"
        against = f"unknown against {' and '.join(unknown)}; {found} {against}"
    elif contents.threat.probability_of_stopping is not None and others:
        against = f"against {contents.threat.threat}, the most likely of {len(contents.threats)} threats to perforate; "
    yield Card(STOPPING.label.capitalize(), value, against + _basis(contents))
    yield _armour(contents)
    yield _asked(contents)


def _basis(contents: Contents) -> str:
    """Return what the probability rests on, or why it is not known."""
    sure, sampled = contents.confidence, contents.uncertainty
    error = from_tests(sure.model_error) if sure.model_error else ""
    if sampled is None or contents.threat.threat not in contents.sampled:
        alone = f"; {SAMPLED_ALONE}" if sampled is not None and sure.probability_of_stopping is None else ""
        return f"{sure.reason or error}{alone}"
    p = sampled.probability_of_perforation
    given = f" and the {error}" if sampled.model_error is not None else ", without the model error"
    interval = f"95 % interval {100.0 * (1.0 - p.high):.1f} to {100.0 * (1.0 - p.low):.1f} %"
    return f"{interval} by sampling, from the given distributions{given}"


def _armour(contents: Contents) -> Card:
    """Return the armour with thickness, areal density and cost, with the digits of their tables."""
    armour, design = contents.answer.armour, contents.design
    subject, cost = "Armour", ""
    areal_density = contents.impact.areal_density_kg_m2
    thickness = armour.ceramic_thickness_mm + armour.backing_thickness_mm
    if design is not None and (shown := design.shown) is not None:
        subject = f"{OBJECTIVES[design.minimised].least.capitalize()} design"
        if design.reason:
            subject = "Nearest design" if design.reason == "none passes" else f"{subject} by the computed limit"
        areal_density, thickness = shown.areal_density_kg_m2, shown.thickness_mm
        cost = f", cost {COST.text(shown.cost_per_m2)} per m²" if shown.cost_per_m2 else ""
    words = f"{AREAL_DENSITY.text(areal_density)} kg/m², {round(thickness, 3):g} mm thick{cost}"
    return Card(subject, contents.answer.armour_words(), words)


def _asked(contents: Contents) -> Card:
    """Return the probabilities that were asked for, and the bounds of a design."""
    bounds = sorted({of.required_probability for of in contents.threats if of.required_probability is not None})
    margins = sorted({of.required_margin_m_s for of in contents.threats} - {0.0})
    asked = [f"at least {' or '.join(map(percent, bounds))}"] if bounds else []
    asked += [f"margin of {' or '.join(f'{margin:g}' for margin in margins)} m/s"] if margins else []
    details = [] if bounds else ["--confidence 0.95 asks for a probability of 95 %"]
    if contents.design is not None:
        section = contents.scenario.design or DesignSection()
        for objective, name in zip(OBJECTIVES.values(), ("areal density", "thickness", "cost"), strict=True):
            most = getattr(section, objective.bound)
            details += [f"{name} of at most {most:g}{objective.unit}"] if most is not None else []
        added = ((section.added_thickness_mm, "mm"), (section.added_areal_density_kg_m2, "kg/m²"))
        if given := [f"{value:g} {unit}" for value, unit in added if value]:
            details.append(f"{' and '.join(given)} added for adhesive or cover")
    return Card("Asked for", ", ".join(asked) or "no probability", "; ".join(details))


def _warnings(contents: Contents) -> Iterator[str]:
    """Give all warnings, with words in place of the keys that they are about."""
    for warning in contents.warnings:
        if not isinstance(warning, Note):
            yield warning
            continue
        name = warning.key.removeprefix("uncertainty.")
        words = warning.key
        if of_threat := re.match(r"threat\[(\d+)\]", warning.key):
            words = contents.threats[int(of_threat[1])].threat
        elif name in INPUTS or name in NAMES.values():
            words = in_words(name) if name == warning.key else f"distribution of the {in_words(name)}"
        yield Note(warning.text, words, warning.brief)
    if error := contents.confidence.model_error:
        yield from (f"the model error is {text}" for text in extrapolation(error))


def _sections(contents: Contents, command: str, map_command: str) -> Iterator[ReportSection]:
    """Give the sections: first the answer, then, folded, what explains it."""
    design, scenario, answer = contents.design, contents.scenario, contents.answer
    what_ifs = [check_view.what_if_table(of, of.threat) for of in contents.check.threats]
    first = what_ifs.pop([of.threat for of in contents.threats].index(contents.threat.threat))
    exact = "With exact inputs." if contents.sampled else ""
    several = f"Against {contents.threat.threat}." if what_ifs else ""
    needed = flow_stress_notes(contents.threat.flow_stress, contents.threat.threat)
    yield ReportSection(
        "Threats",
        tuple(f"{answer.armour_words()} {note}" if not place else note for place, note in enumerate(needed)),
        tables=(_threats(contents),),
    )
    yield ReportSection("What if", tuple(filter(None, (several, exact))), tables=(first,))
    if design is not None:
        hint = ("This command makes an interactive page of all designs:",) if map_command else ()
        # The title of the map is the answer, which the report begins with.
        drawing = drawing_of(design, "draw_map", title="")
        yield ReportSection("Map of the designs", hint, map_command, "console", pictures=(drawing,))
    yield ReportSection("Assumptions and limits", notes=ASSUMPTIONS)
    entries = list(filter(None, map(answer.entry_of, ROLES)))
    [(evidence, _)] = armour_of(answer).by_evidence()
    error = contents.confidence.model_error
    used = evidence.source if error is not None and given_error(answer) is None else ""
    cited = [value.source for entry in entries for value in entry.values.values()]
    yield ReportSection("References", notes=reference_notes(("[Paper]", used, *cited)))
    if what_ifs:
        others = what_ifs[0].title if len(what_ifs) == 1 else "the other threats"
        yield ReportSection(f"What if, against {others}", tables=tuple(what_ifs), folded=True)
    if design is not None:
        yield _search(design)
    if (sampled := contents.uncertainty) is not None:
        table = uncertainty_view.estimate_table(sampled)
        yield ReportSection(
            "Results under uncertain inputs", pictures=(drawing_of(sampled),), tables=(table,), folded=True
        )
    yield _impact(contents)
    elasticities = sensitivity_view.elasticity_table(contents.sensitivity)
    drawing = drawing_of(contents.sensitivity, title="")
    yield ReportSection(
        "Sensitivity to the inputs", pictures=(drawing,), tables=(elasticities,), folded=True, drawn=True
    )
    values = Column("quantity", prose=True)
    tables = (
        replace(entry_table(entry, values, in_words), title=f"{entry.kind.capitalize()}: {entry.name}")
        for entry in entries
    )
    yield ReportSection("Values and their sources", tables=tuple(tables), folded=True)
    yield ReportSection("Scenario", code=scenario.to_toml(), language="toml", folded=True)
    yield origin_section(command, _which_armour(contents), contents.scenario)


def _threats(contents: Contents) -> Table:
    """Return every threat, with what was asked for and what was found."""
    named = {threat.title: threat.name or threat.threat for threat in contents.scenario.threats()}
    asked = _is_asked(contents)
    inputs = {of.threat: "distributions" if of.threat in contents.sampled else "exact" for of in contents.threats}
    mixed = len(set(inputs.values())) > 1
    return listing(
        contents.threats,
        (Column("threat", prose=True), lambda of: named[of.threat]),
        column_of("projectile", prose=True),
        column_of("velocity_m_s", "g", "velocity"),
        column_of("obliquity_deg", "g", "obliquity"),
        (check_view.PROBABILITY, lambda of: chance(of.probability_of_stopping)),
        (Column("inputs"), lambda of: inputs[of.threat] if mixed else ""),
        (Column("required", prose=True), lambda of: _required(of) if asked else ""),
        (Column("result"), lambda of: check_view.verdict(of) if asked else ""),
        column_of("ballistic_limit_m_s", ".0f", "ballistic limit"),
        (check_view.INTERVAL, lambda of: interval(of.interval_m_s, ".0f")),
        column_of("margin_m_s", "+.0f"),
    )


def _required(found: CheckedThreat) -> str:
    words = check_view.required(found)
    return words if found.required_probability is not None else f"limit above {words}"


def _search(design: DesignResult) -> ReportSection:
    """Return how the best design compares with others."""
    tables = [design_view.pair_table(design) if len(design.pairs) > 1 else design_view.frontier_table(design)]
    heading = "Pairs of materials" if len(design.pairs) > 1 else "Required ceramic for each back plate"
    if design.pareto:
        tables.append(design_view.pareto_table(design))
    pictures = (drawing_of(design, "draw_front"),) if design.pareto else ()
    return ReportSection(heading, pictures=pictures, tables=tuple(tables), folded=True)


def _impact(contents: Contents) -> ReportSection:
    """Return the impact stage by stage, with where the projectile's energy goes."""
    energy = energy_balance(contents.answer, contents.impact)
    words = (
        f"Against {contents.threat.threat}, by the model. The projectile has {energy.before:.2f} J at impact and "
        f"{energy.left:.2f} J at the end; the losses, integrated along the run, account for the difference to within "
        f"{abs(energy.difference):.1g} J."
    )
    table = listing(
        zip(contents.impact.stages, energy.rows, strict=True),
        (Column("stage", prose=True), lambda of: f"{of[0].stage}: {impact_view.STAGES[of[0].stage].words}"),
        (column_of("start_us", ".1f"), lambda of: of[0].start_us),
        (column_of("end_us", ".1f"), lambda of: of[0].end_us),
        (column_of("velocity_lost_m_s", ".1f"), lambda of: of[0].velocity_lost_m_s),
        (column_of("length_lost_mm", ".2f"), lambda of: of[0].length_lost_mm),
        (Column("energy carried by eroded material", "J", ".1f"), lambda of: of[1].eroded),
        (Column("energy lost in braking the penetrator", "J", ".1f"), lambda of: of[1].braked),
    )
    # The table has the stages in words.
    drawing = drawing_of(contents.impact, note="")
    return ReportSection("The impact, stage by stage", (words,), pictures=(drawing,), tables=(table,), folded=True)


def _which_armour(contents: Contents) -> str:
    """Return which armour is reported where the scenario asks for a design, and how to get the other."""
    if contents.design is not None:
        own = contents.scenario.armour_words()
        return f"This report is about the design found, not the scenario's own armour, {own}; use --as-is for that."
    if asks_for_design(contents.scenario):
        return "This report is about the scenario's own armour; without --as-is it is about the design found."
    return ""
