"""Report on a scenario: its answer, and the results that explain it and say how reliable it is."""

from collections.abc import Iterator
from dataclasses import replace

from armour.reporting import charts
from armour.reporting.chart import Chart
from armour.reporting.contents import Contents
from armour.reporting.report import Card, CrossSection, Report, Section, origin_section
from armour.reporting.table import Table
from armour.reporting.tables.confidence import DEFEAT, chance, extrapolation, from_tests
from armour.reporting.tables.design import (
    COST,
    MARGIN,
    SUPERLATIVES,
    best_table,
    frontier_table,
    margin_table,
    pair_table,
    pareto_table,
    required_margins,
)
from armour.reporting.tables.impact import AREAL_DENSITY, BALLISTIC_LIMIT, energy_table, stage_table
from armour.reporting.tables.library import entry_table
from armour.reporting.tables.statistics import elasticity_table, estimate_table
from armour.scenario.applicability import is_excluded
from armour.units import MM


def scenario_report(contents: Contents, command: str) -> Report:
    """Report the results of a scenario; the command is the one that makes the report."""
    scenario = contents.scenario
    return Report(
        title=scenario.title or scenario.file,
        lead=_question(contents),
        sections=(
            _energy(contents),
            *(Section(heading, tables=(table,)) for heading, table in _tables(contents)),
            Section("Scenario", code=scenario.to_toml(), language="toml"),
            origin_section(command),
        ),
        charts=tuple(_charts(contents)),
        cards=(*_armour(contents), _outcome(contents), _reliability(contents)),
        warnings=(*contents.warnings, *_extrapolated(contents)),
        cross_section=_cross_section(contents),
    )


def _question(contents: Contents) -> str:
    """Return the question that the scenario asks."""
    design, impact = contents.design, contents.scenario.impact
    if design is None:
        return f"Does this armour defeat the {impact.projectile} at {impact.velocity_m_s:g} m/s?"
    armour, best = "available armour", design.best
    if len(design.pairs) == 1:
        armour = f"{best.ceramic} on {best.backing}" if best.ceramic else best.backing
    threats = " and ".join(f"the {threat}" for threat in design.threats)
    return f"Which {armour} is the {SUPERLATIVES[design.minimised]} that defeats {threats}?"


def _armour(contents: Contents) -> tuple[Card, Card]:
    """Return the armour and its areal density, with the digits of their tables."""
    armour, design = contents.answer.armour, contents.design
    layers = f"{round(armour.backing_thickness_mm, 3):g} mm {armour.backing}"
    if armour.ceramic is not None and armour.ceramic_thickness_mm > 0.0:
        layers = f"{round(armour.ceramic_thickness_mm, 3):g} mm {armour.ceramic} on {layers}"
    subject, cost = "Armour", ""
    areal_density = contents.impact.areal_density_kg_m2
    thickness = armour.ceramic_thickness_mm + armour.backing_thickness_mm
    if design is not None:
        subject = "Best design"
        areal_density, thickness = design.best.areal_density_kg_m2, design.best.thickness_mm
        cost = f"cost {COST.text(design.best.cost_per_m2)} per m²" if design.best.cost_per_m2 > 0.0 else ""
    card = Card(subject, layers, f"{round(thickness, 3):g} mm thick")
    return card, Card("Areal density", f"{AREAL_DENSITY.text(areal_density)} kg/m²", cost)


def _outcome(contents: Contents) -> Card:
    impact, design = contents.answer.impact, contents.design
    against = f"{impact.projectile} at {impact.velocity_m_s:g} m/s"
    limit = "ballistic limit outside the range searched"
    if contents.limit is not None:
        found = contents.limit.ballistic_limit_m_s
        margin = MARGIN.text(found - impact.velocity_m_s)
        limit = f"ballistic limit {BALLISTIC_LIMIT.text(found)} m/s, margin {margin} m/s"
    if design is None:
        outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[contents.impact.outcome]
        return Card("Outcome", outcome, f"{against}; {limit}")
    if len(design.threats) > 1:
        return Card("Defeats", " and ".join(design.threats), f"governed by {design.best.governing}: {limit}")
    return Card("Defeats", against, limit)


def _reliability(contents: Contents) -> Card:
    """Return the probability of defeating the threat, and what it rests on; none without the error of the model.

    If a scenario says not to include that, the probability is that of its distributions.
    """
    subject, sure, sampled = DEFEAT.label.capitalize(), contents.confidence, contents.uncertainty
    if sampled is None or (sampled.model_error is None and not is_excluded(contents.scenario)):
        note = sure.reason or (from_tests(sure.model_error) if sure.model_error else "")
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
    yield "Stages of the impact", stage_table(contents.impact)
    if contents.uncertainty is not None:
        yield "Results under uncertain inputs", estimate_table(contents.uncertainty)
    yield "Sensitivity to the inputs", elasticity_table(contents.sensitivity)
    for entry in contents.entries:
        yield f"{entry.kind.capitalize()}: {entry.name}", entry_table(entry)


def _charts(contents: Contents) -> Iterator[Chart]:
    if contents.design is not None:
        yield charts.frontier_chart(contents.design, "Required ceramic for each back plate")
        if contents.design.pareto:
            yield charts.pareto_chart(contents.design, "Pareto front")
    if contents.uncertainty is not None:
        chart = charts.uncertainty_chart(contents.uncertainty, contents.answer)
        yield replace(chart, title="Probability of perforation")
    yield charts.sensitivity_chart(contents.sensitivity, "Sensitivity to the inputs")
    yield charts.impact_chart(contents.impact, f"Impact of the {contents.answer.impact.projectile}")
    yield charts.energy_chart(contents.energy)


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
