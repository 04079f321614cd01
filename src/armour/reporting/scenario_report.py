"""Make the report on a scenario: its answer, and the results that explain it and show how reliable it is."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from armour import __version__
from armour.analysis.ballistic_limit import ballistic_limit, not_monotonic
from armour.analysis.impact import ImpactResult, energy_balance, simulate
from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.samples import is_sampled, misplaced, probability_of_perforation
from armour.design.catalogue import asks_for_design
from armour.design.check import CheckedThreat, CheckResult, check
from armour.design.optimise import DesignResult, optimise
from armour.errors import NoAnswerError, Note
from armour.evidence.model_error import given_error
from armour.evidence.tests import armours_of
from armour.reporting import words as phrases
from armour.reporting.by_result import drawing_of
from armour.reporting.report import Card, Report, ReportSection, origin_section, reference_notes
from armour.reporting.table import Column, Table, in_words, interval, percent
from armour.reporting.views import analysis as analysis_view
from armour.reporting.views import design as design_view
from armour.reporting.views import statistics as statistics_view
from armour.reporting.views import validation as validation_view
from armour.reporting.views.library import entry_table
from armour.scenario.inputs import INPUTS, NAMES, ROLES
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES
from armour.statistics.own_tests import predicted_tests
from armour.statistics.sensitivity import SensitivityResult, sensitivity
from armour.statistics.uncertainty import UncertaintyResult, uncertainty
from armour.validation.comparison import areal_density_rules
from armour.validation.tested import nearest_measured

# Note on the tested armours in the table of weights.
TESTED = (
    "Measured armours were tested at normal incidence with a core whose diameter, mass and density differ by at most "
    "10 %: with a ceramic, and of each metal, the one whose limit is nearest."
)
# Assumptions of the model; docs/limits.md has more.
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
    """All results that a report on a scenario shows.

    The armour reported is the best design found or, without a search, the scenario's own.
    """

    scenario: Scenario  # as it was read
    design: DesignResult | None  # None if the report is about the scenario's own armour
    check: CheckResult  # of the armour reported, with exact inputs
    threats: tuple[CheckedThreat, ...]  # those of the check, with distributions of the inputs where these apply
    answer: Scenario  # the armour reported against the threat most likely to perforate it
    impact: ImpactResult  # with its history
    sensitivity: SensitivityResult | None  # None without a ballistic limit in the range of the search
    uncertainty: UncertaintyResult | None  # also None if no distributions apply to the answer
    notes: tuple[Note, ...]

    @property
    def sampled(self) -> tuple[str, ...]:
        """Names of the threats to which the distributions of the inputs apply."""
        return tuple(threat.threat for threat in self.threats if threat.sampled is not None)

    @property
    def threat(self) -> CheckedThreat:
        """The threat most likely to perforate the armour, as far as is known."""
        return min(self.threats, key=design_view.standing)


def contents_of(scenario: Scenario, on_progress: OnProgress = ignore_progress, *, as_is: bool = False) -> Contents:
    """Compute a scenario and gather the results that a report shows.

    The armour reported is the best design if the scenario asks for one, unless `as_is` keeps its own armour.
    """

    def on_part(done: int, _total: int | None) -> None:
        on_progress(done, None)

    design = optimise(scenario, on_progress=on_part) if asks_for_design(scenario) and not as_is else None
    best = None if design is None else design.reported
    armour = scenario if best is None else scenario.replaced(best.changes_to(scenario))
    checked = check(armour, on_progress=on_part)
    impacts = [armour.against(threat) for threat in armour.threats()]
    distributions = scenario.distributions()
    wrongly_placed = [misplaced(distributions, scenario, impact) for impact in impacts]
    threats = list(checked.threats)
    for place, impact in enumerate(impacts):
        if threats[place].sampled is None and distributions and not wrongly_placed[place] and is_sampled(impact):
            estimate = probability_of_perforation(impact, on_progress=on_part)
            threats[place] = replace(threats[place], sampled=estimate, probability_of_stopping=1.0 - estimate.value)
    worst = min(range(len(threats)), key=lambda place: design_view.standing(threats[place]))
    answer = impacts[worst]
    if design is not None and design.shown is not None:
        probabilities = {threat.threat: threat.probability_of_stopping for threat in threats}
        shown = replace(design.shown, probabilities_of_stopping=probabilities)
        updated = replace(design, nearest=shown) if design.reason else replace(design, best=shown)
        design = updated.of(**design.question)
    unused = scenario.unused_distributions() if distributions else ()
    limit = _or_none(ballistic_limit, answer, ignore_progress)
    return Contents(
        scenario=scenario,
        design=design,
        check=checked,
        threats=tuple(threats),
        answer=answer,
        impact=simulate(answer, history=True),
        sensitivity=_or_none(sensitivity, answer, on_part),
        uncertainty=_or_none(uncertainty, answer, on_part) if distributions and not wrongly_placed[worst] else None,
        notes=(
            *(note for note in (checked if design is None else design).notes if note not in unused),
            *(() if limit is None else not_monotonic(limit)),
            *dict.fromkeys(note for each in wrongly_placed for note in each),
        ),
    )


def _or_none(question: Callable[..., Any], answer: Scenario, on_progress: OnProgress) -> Any:
    """Call a function such as `ballistic_limit` for a scenario; return None if it has no answer.

    An armour that no velocity perforates, for example, has no ballistic limit.
    """
    try:
        return question(answer, on_progress=on_progress)
    except NoAnswerError:
        return None


def scenario_report(contents: Contents, command: str, map_command: str = "") -> Report:
    """Make the report from its results.

    `command` makes the report, and `map_command`, if any, the interactive page of the designs; the report shows both.
    """
    passed, lead = _verdict(contents)
    caveats = [f"{words[:1].upper()}{words[1:]}." for words in phrases.said_of(contents.notes)]
    return Report(
        title=contents.answer.subject(threats=contents.scenario.threat),
        lead=" ".join(filter(None, [lead, *caveats])),
        passed=passed,
        byline=_byline(contents.scenario),
        sections=tuple(_sections(contents, command, map_command)),
        cards=(_probability(contents), _armour(contents), _requirements(contents)),
        warnings=tuple(_warnings(contents)),
        cross_section=contents.answer,
    )


def _byline(scenario: Scenario) -> tuple[tuple[str, str], ...]:
    """Return names and texts of title, project, author and date, if given, and of the program version."""
    texts = {"scenario": scenario.title, "project": scenario.project, "author": scenario.author, "date": scenario.date}
    return (*((name, text) for name, text in texts.items() if text), ("program version", f"armour {__version__}"))


def _has_requirements(contents: Contents) -> bool:
    """Return whether a scenario requires anything beyond a ballistic limit by the model that reaches the velocity."""
    rows = design_view.requirements_of(contents.check)
    return any(row.required or row.quantity == "interlayers" for row in rows if row.quantity != design_view.SOURCES)


def _verdict(contents: Contents) -> tuple[bool | None, str]:
    """Return whether the armour meets the requirements, and the same in words; None and "" without requirements."""
    if contents.design is not None and contents.design.reason:
        return False, f"{design_view.design_title(contents.design)}."
    if not _has_requirements(contents):
        return None, ""
    if contents.check.verdict == "passes":
        return True, f"Meets the requirements{' against every threat' if len(contents.threats) > 1 else ''}."
    words = "Does not meet" if contents.check.verdict == "fails" else "Not known to meet"
    rows = [row for row in design_view.requirements_of(contents.check) if row.verdict == contents.check.verdict]
    names = list(dict.fromkeys(row.threat for row in rows if row.threat))
    against = f" against {' and '.join(names)}" if names else ""
    unmet = "; ".join(dict.fromkeys(map(phrases.requirement_words, rows)))
    return False, f"{words} the requirements{against}: {unmet}."


def _probability(contents: Contents) -> Card:
    """Return the card with the probability of stopping the threat most likely to perforate, and what it rests on."""
    threat, count = contents.threat, len(contents.threats)
    statement = probability = phrases.chance(threat.probability_of_stopping, threat.model_error)
    unknown = [threat.threat for threat in contents.threats if threat.probability_of_stopping is None]
    against = f"against {threat.threat}; " if count > 1 else ""
    if threat.probability_of_stopping is not None and unknown:
        statement = f"{probability} or unknown"
        against = f"unknown against {' and '.join(unknown)}; {probability} {against}"
    elif threat.probability_of_stopping is not None and count > 1:
        against = f"against {threat.threat}, the most likely of {count} threats to perforate; "
    return Card(phrases.STOPPING.label.capitalize(), statement, against + _basis(contents))


def _basis(contents: Contents) -> str:
    """Return what the probability of stopping rests on or, if it is unknown, why."""
    threat, error = contents.threat, ""
    if threat.model_error:
        error = "; ".join([phrases.from_tests(threat.model_error), *phrases.tested_here(threat.model_error)])
    if threat.sampled is None:
        alone = f"; {phrases.SAMPLED_ALONE}" if contents.uncertainty and threat.probability_of_stopping is None else ""
        return f"{threat.reason or error}{alone}"
    sampled = threat.sampled
    _, low, high = phrases.sampled_percents(1.0 - sampled.value, (1.0 - sampled.high, 1.0 - sampled.low))
    with_error = f" and the {error}" if error else ", without the model error"
    return f"95 % interval {low:.1f} to {high:.1f} % by sampling, from the given distributions{with_error}"


def _armour(contents: Contents) -> Card:
    """Return the card with the armour, its areal density, thickness and cost, and a tested armour near its limit."""
    design, subject = contents.design, "Armour"
    if design is not None and design.shown is not None:
        subject = f"{OBJECTIVES[design.minimised].least.capitalize()} design"
        if design.reason:
            subject = "Nearest design" if any(design.shown.short_m_s.values()) else f"{subject} by the computed limit"
    details = [design_view.amounts(contents.check)]
    if (limit := contents.threat.ballistic_limit_m_s) is not None:
        near = [each for each in nearest_measured(contents.answer, limit) if each.is_near(limit)]
        details += [f"tested near this limit: {each.armour}, {each.areal_density_kg_m2:.1f} kg/m²" for each in near[:1]]
    return Card(subject, contents.answer.armour_words(), "; ".join(details))


def _requirements(contents: Contents) -> Card:
    """Return the card with the required probabilities and margins, the limits of [design], and inert layers."""
    threats = contents.threats
    probabilities = sorted({p for threat in threats if (p := threat.required_probability) is not None})
    margins = sorted({threat.required_margin_m_s for threat in threats} - {0.0})
    requirements = [f"at least {' or '.join(map(percent, probabilities))}"] if probabilities else []
    requirements += [f"margin of {' or '.join(f'{margin:g}' for margin in margins)} m/s"] if margins else []
    details = [] if probabilities else ["--confidence 0.95 asks for a probability of 95 %"]
    details += [" of ".join(phrases.requirement_parts(row)[:2]) for row in contents.check.requirements]
    details += design_view.layer_words(contents.scenario.inert_layers)
    return Card("Asked for", ", ".join(requirements) or "no probability", "; ".join(details))


def _warnings(contents: Contents) -> Iterator[str]:
    """Yield all warnings, with the names of inputs instead of their keys."""
    for warning in contents.notes:
        name = warning.key.removeprefix("uncertainty.")
        words = warning.key
        if warning.key.startswith("threat["):
            # With several threats, the text of the warning names those that it is about.
            words = contents.threats[0].threat if len(contents.threats) == 1 else ""
        elif name in INPUTS or name in NAMES.values():
            words = in_words(name) if name == warning.key else f"distribution of the {in_words(name)}"
        yield str(Note(warning.text, words))
    if error := contents.threat.model_error:
        yield from (f"the model error is {text}" for text in phrases.extrapolation(error))


def _sections(contents: Contents, command: str, map_command: str) -> Iterator[ReportSection]:
    """Yield the sections: first the answer, and then, folded, what explains it."""
    design, scenario, answer, threat = contents.design, contents.scenario, contents.answer, contents.threat
    ordered = sorted(contents.check.threats, key=lambda checked: checked.threat != threat.threat)
    what_ifs = [table for each in ordered for table in design_view.what_if_tables(each, f"against {each.threat}")]
    exact = ("With exact inputs.",) if contents.sampled else ()
    notes = phrases.flow_stress_notes(threat.flow_stress, threat.threat)
    notes[:1] = [f"{answer.armour_words()} {note}" for note in notes[:1]]
    notes += [*design_view.outside_notes(contents.check.threats), *(said := phrases.threat_notes(scenario))]
    tables: tuple[Table, ...] = (_threats(contents),)
    if len(design_view.requirements_of(contents.check)) > len(contents.threats):
        tables += (replace(design_view.requirement_table(contents.check), title="requirements"),)
    yield ReportSection("Threats", tuple(notes), tables=tables)
    yield from _own_tests(answer)
    yield ReportSection("What if", exact, tables=tuple(what_ifs))
    if design is not None:
        yield from _offer(design)
        hint = ("This command makes an interactive page of all designs:",) if map_command else ()
        yield ReportSection("Map of the designs", hint, map_command, "console", pictures=(partial(_map, design),))
    yield ReportSection("Assumptions and limits", notes=ASSUMPTIONS)
    entries = list(filter(None, map(answer.entry_of, ROLES)))
    [(evidence, _)] = armours_of(answer).by_evidence()
    tests = evidence.source if threat.model_error is not None and given_error(answer) is None else ""
    values = [value.source for entry in entries for value in entry.values.values()]
    yield ReportSection("References", notes=reference_notes(("[Paper]", tests, *values, *said)))
    if design is not None:
        yield _search(design)
    if (sampled := contents.uncertainty) is not None:
        pictures, tables = (drawing_of(sampled),), (statistics_view.estimate_table(sampled),)
        yield ReportSection("Results under uncertain inputs", pictures=pictures, tables=tables, folded=True)
    yield _impact(contents)
    if (swings := contents.sensitivity) is not None:
        pictures, tables = (drawing_of(swings, title=""),), (statistics_view.elasticity_table(swings),)
        yield ReportSection("Sensitivity to the inputs", pictures=pictures, tables=tables, folded=True, drawn=True)
    quantity = Column("quantity", prose=True)
    tables = tuple(
        replace(entry_table(entry, quantity, in_words), title=f"{entry.kind.capitalize()}: {entry.name}")
        for entry in entries
    )
    yield ReportSection("Values and their sources", tables=tables, folded=True)
    if (limit := threat.ballistic_limit_m_s) is not None and not threat.obliquity_deg:
        rules, measured = areal_density_rules(answer, limit), nearest_measured(answer, limit)
        tested = TESTED if measured else f"No test of a core like that of {answer.impact.projectile} is known."
        whole = answer.areal_density_kg_m2(whole=True)
        table = validation_view.weight_table(whole, limit, rules, measured, answer)
        yield ReportSection("Weight", (tested,), tables=(table,), folded=True)
    yield ReportSection("Scenario", code=scenario.to_toml(), language="toml", folded=True)
    yield origin_section(command, _which_armour(contents), contents.scenario)


def _own_tests(answer: Scenario) -> Iterator[ReportSection]:
    """Yield a section for each material of the armour with own tests, with their source."""
    for entry in filter(None, map(answer.entry_of, ("ceramic", "backing"))):
        if entry.evidence is not None and (tests := predicted_tests(entry, entry.evidence)):
            source = f"{entry.name}: {entry.evidence.source}, calibrated with armour."
            yield ReportSection("Own tests", (source,), tables=(statistics_view.own_test_table(tests),))


def _threats(contents: Contents) -> Table:
    """Tabulate the threats: what is required, the probability of stopping, the ballistic limit and the margin."""
    names = {threat.title: threat.name or threat.standard for threat in contents.scenario.threats()}
    is_mixed = 0 < len(contents.sampled) < len(contents.threats)
    kinds = {name: "distributions" if name in contents.sampled else "exact" for name in names}
    requires = _has_requirements(contents)
    return Table.of(
        contents.threats,
        (Column("threat", prose=True), lambda threat: names[threat.threat]),
        Column.of("projectile", prose=True),
        Column.of("velocity_m_s", "g"),
        Column.of("obliquity_deg", "g"),
        (design_view.PROBABILITY, lambda threat: phrases.chance(threat.probability_of_stopping)),
        (Column("inputs"), lambda threat: kinds[threat.threat] if is_mixed else ""),
        (Column("required", prose=True), lambda threat: design_view.required(threat) if requires else ""),
        (Column("result"), lambda threat: design_view.VERDICTS[threat.verdict] if requires else ""),
        Column.of("ballistic_limit_m_s"),
        (design_view.INTERVAL, lambda threat: interval(threat.interval_m_s, ".0f")),
        design_view.MARGIN,
        design_view.outside_tests(contents.threats),
    )


def _offer(design: DesignResult) -> Iterator[ReportSection]:
    """Yield the section with the designs on offer or, if they are many, the best of each pair of materials."""
    designs = design.every or design_view.best_of_pairs(design)
    if len(designs) > 1:
        table, notes = design_view.offer_table(design), design_view.outside_notes(designs)
        notes += design_view.thin_designs(designs, design.question.get("scenario"))
        heading = f"{table.title[:1].upper()}{table.title[1:]}"
        yield ReportSection(heading, tuple(notes), tables=(table,), folded=not design.every)


def _search(design: DesignResult) -> ReportSection:
    """Return the section that compares the best design with others: the frontier, or the pairs of materials."""
    heading, table = "Required ceramic for each back plate", design_view.frontier_table(design)
    notes = design_view.outside_notes(design.frontier)
    if len(design.pairs) > 1:
        heading, table = "Pairs of materials", replace(design_view.pair_table(design), title="")
        notes = design_view.pair_notes(design)
    pareto = [design_view.design_table(design.pareto, "Pareto front")] if design.pareto else []
    pictures = (partial(_front, design),) if design.pareto else ()
    return ReportSection(heading, tuple(notes), pictures=pictures, tables=(table, *pareto), folded=True)


def _map(design: DesignResult, sheet: Any) -> Any:
    """Draw the map of the designs on a sheet, without its title, which would repeat the answer of the report."""
    from armour.reporting.pictures.design import draw_map_of_design  # slow to import

    return replace(draw_map_of_design(design, sheet), title="")


def _front(design: DesignResult, sheet: Any) -> Any:
    """Draw the Pareto front on a sheet."""
    from armour.reporting.pictures.design import draw_front_of_design  # slow to import

    return draw_front_of_design(design, sheet)


def _impact(contents: Contents) -> ReportSection:
    """Return the section with the impact stage by stage, and the energy that the projectile loses."""
    energy = energy_balance(contents.answer, contents.impact)
    words = (
        f"Against {contents.threat.threat}, by the model. The projectile has {energy.before:.2f} J at impact and "
        f"{energy.left:.2f} J at the end; the losses, integrated along the run, account for the difference to within "
        f"{abs(energy.difference):.1g} J."
    )
    pictures, tables = (drawing_of(contents.impact),), (analysis_view.stage_table(contents.impact),)
    return ReportSection("The impact, stage by stage", (words,), pictures=pictures, tables=tables, folded=True)


def _which_armour(contents: Contents) -> str:
    """Return which armour is reported if the scenario asks for a design, and how to report on the other; else ""."""
    if contents.design is not None:
        armour = contents.scenario.armour_words()
        return f"This report is about the design found, not the scenario's own armour, {armour}; use --as-is for that."
    if asks_for_design(contents.scenario):
        return "This report is about the scenario's own armour; without --as-is it is about the design found."
    return ""
