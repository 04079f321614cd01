"""Report on a scenario: its answer, and the results that explain it and say how reliable it is."""

from collections.abc import Iterator
from dataclasses import replace

from armour import __version__
from armour.design.optimise import OBJECTIVES
from armour.errors import Note
from armour.reporting.chart import Chart
from armour.reporting.contents import AgainstThreat, Contents, asks_for_design
from armour.reporting.report import Card, CrossSection, Report, Section, origin_section
from armour.reporting.table import Column, Table, filled, in_words, listing
from armour.reporting.views import design as designs
from armour.reporting.views import impact as impacts
from armour.reporting.views import sensitivity, uncertainty
from armour.reporting.views.confidence import DEFEAT, SAMPLED_ALONE, chance, extrapolation, from_tests
from armour.reporting.views.design import (
    AREAL_DENSITY,
    BALLISTIC_LIMIT,
    COST,
    MARGIN,
    REQUIRED,
    best_table,
    frontier_table,
    margin_notes,
    margin_table,
    pair_table,
    pareto_table,
    required_margins,
)
from armour.reporting.views.impact import energy_table, stage_table
from armour.reporting.views.library import entry_table
from armour.scenario.inputs import INPUTS
from armour.scenario.scenario import title_beside
from armour.units import MM


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
            *(Section(heading, tables=(filled(table),)) for heading, table in _tables(contents)),
            Section("Scenario", code=scenario.to_toml(), language="toml"),
            origin_section(command),
        ),
        charts=tuple(_charts(contents)),
        cards=(*_armour(contents), _outcome(contents), _reliability(contents)),
        warnings=(*map(_told, contents.warnings), *_extrapolated(contents), *_without_margin(contents)),
        cross_section=_cross_section(contents),
    )


def _subject(contents: Contents) -> str:
    """Return the armour that is reported, with its threats."""
    return contents.answer.subject(threats=contents.scenario.threat)


def _question(contents: Contents) -> str:
    """Return the question that the scenario asks."""
    design, threats = contents.design, " and ".join(map(_the, contents.threats))
    if design is None:
        return f"Does this armour defeat {threats}?"
    armour, best = "available armour", design.best
    if len(design.pairs) == 1:
        armour = f"{best.ceramic} on {best.backing}" if best.ceramic else best.backing
    return f"Which {armour} is the {OBJECTIVES[design.minimised].least} that defeats {threats}?"


def _the(found: AgainstThreat) -> str:
    return found.threat if found.threat.startswith("the ") else f"the {found.threat}"


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
        details = (_against(found, exact=distributed and not found.sampled) for found in contents.threats)
        return Card(subject, " and ".join(named), "; ".join(details))
    against = f"{impact.projectile} at {impact.velocity_m_s:g} m/s"
    limit = "ballistic limit outside the range searched"
    if contents.limit is not None:
        found = contents.limit.ballistic_limit_m_s
        margin = MARGIN.text(found - impact.velocity_m_s)
        limit = f"ballistic limit {BALLISTIC_LIMIT.text(found)} m/s, margin {margin} m/s"
    if design is None:
        outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[contents.impact.outcome]
        return Card("Outcome", outcome, f"{against}; {limit}")
    return Card("Defeats", against, limit)


def _against(found: AgainstThreat, *, exact: bool) -> str:
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


def _extrapolated(contents: Contents) -> list[str]:
    """Return a warning where the error of the model is extrapolated."""
    error = contents.confidence.model_error
    return [] if error is None else [f"the error of the model is {text}" for text in extrapolation(error)]


def _told(warning: str) -> str:
    """Return a warning with the words of the input that it is about, in place of its key."""
    if not isinstance(warning, Note) or (name := warning.key.removeprefix("uncertainty.")) not in INPUTS:
        return warning
    words = in_words(name)
    return Note(warning.text, words if name == warning.key else f"distribution of the {words}")


def _without_margin(contents: Contents) -> list[str]:
    ask = "design.confidence = 0.95 in the scenario designs for a probability of 95 %"
    return [] if contents.design is None else margin_notes(contents.design.best, ask)


def _energy(contents: Contents) -> Section:
    energy = contents.energy
    words = (
        f"The projectile has {energy.before:.2f} J at impact and {energy.left:.2f} J at the end.",
        "The losses are the powers integrated along the run, apart from the motion: "
        f"the balance closes to {abs(energy.difference):.1g} J.",
    )
    return Section("Energy balance of the projectile", words, tables=(energy_table(energy),))


def _tables(contents: Contents) -> Iterator[tuple[str, Table]]:
    """Give tables with their headings: designs, stages, uncertainty, sensitivity, and materials with their sources."""
    design = contents.design
    if design is not None:
        required = required_margins(contents.scenario)
        yield "Best design", best_table(design, required)
        if len(design.threats) > 1 or design.best.probabilities:
            yield "Margins against the threats", margin_table(design, required)
        if len(design.pairs) > 1:
            yield "Pairs of materials", pair_table(design)
        else:
            yield "Required ceramic for each back plate", frontier_table(design)
        if design.pareto:
            yield "Pareto front", pareto_table(design)
    elif len(contents.threats) > 1:
        yield "Margins against the threats", _margins(contents)
    yield "Stages of the impact", stage_table(contents.impact)
    if contents.uncertainty is not None:
        yield "Results under uncertain inputs", uncertainty.estimate_table(contents.uncertainty)
    yield "Sensitivity to the inputs", sensitivity.elasticity_table(contents.sensitivity)
    for entry in contents.entries:
        yield f"{entry.kind.capitalize()}: {entry.name}", _in_words(entry_table(entry))


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


def _in_words(table: Table) -> Table:
    """Return a table of keys, the first column, with their words and units in place of them."""
    columns = (Column("quantity", prose=True), *table.columns[1:])
    return replace(table, columns=columns, rows=tuple((in_words(str(name)), *rest) for name, *rest in table.rows))


def _charts(contents: Contents) -> Iterator[Chart]:
    if contents.design is not None:
        yield designs.frontier_chart(contents.design)
        if contents.design.pareto:
            yield designs.pareto_chart(contents.design)
    if contents.uncertainty is not None:
        yield uncertainty.chart(contents.uncertainty)
    yield sensitivity.chart(contents.sensitivity)
    # The low chart before the high one, so that the first printed page has room for it.
    yield impacts.energy_chart(contents.energy)
    yield impacts.chart(contents.impact)


def _cross_section(contents: Contents) -> CrossSection:
    armour, parameters = contents.answer.armour, contents.answer.core_armour()
    return CrossSection(
        rod=contents.answer.impact.projectile,
        rod_length=parameters.L0 / MM,
        rod_diameter=parameters.D0 / MM,
        ceramic=armour.ceramic or "",
        ceramic_thickness=armour.ceramic_thickness_mm,
        backing=armour.backing,
        backing_thickness=armour.backing_thickness_mm,
    )
