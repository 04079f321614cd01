"""Words and tables of a report on a scenario, which its HTML and Markdown versions share."""

import sys
from dataclasses import dataclass
from importlib.metadata import version

from armour import MODEL_VERSION, __version__
from armour.reporting.contents import Contents
from armour.reporting.table import Column, Table
from armour.reporting.tables.design import (
    SUPERLATIVES,
    best_table,
    frontier_table,
    margin_table,
    pair_table,
    pareto_table,
)
from armour.reporting.tables.impact import energy_table, stage_table
from armour.reporting.tables.library import entry_table
from armour.reporting.tables.statistics import elasticity_table, estimate_table
from armour.scenario.applicability import MODEL_ERROR_PERCENT

PAPER = "Modeling penetration of ceramic/metal lightweight armours by small and medium caliber projectiles"
ORIGIN = (
    f"The model is that of the published paper “{PAPER}”. Do not rely on this report alone for anyone's protection."
)
# Packages whose versions the results can depend on.
PACKAGES = ("numpy", "scipy", "numba", "llvmlite")


@dataclass(frozen=True)
class Card:
    """A statement of the answer: its subject, the statement and what goes with it."""

    subject: str
    statement: str
    detail: str


@dataclass(frozen=True)
class Section:
    """A heading with its paragraphs and tables."""

    heading: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()


def title_of(contents: Contents) -> str:
    """Return the title of a report."""
    return contents.scenario.title or contents.scenario.file


def question_of(contents: Contents) -> str:
    """Return the question that the scenario asks."""
    design, impact = contents.design, contents.scenario.impact
    if design is None:
        return f"Does this armour defeat the {impact.projectile} at {impact.velocity_m_s:g} m/s?"
    armour = "armour on offer"
    if len(design.pairs) == 1:
        best = design.best
        armour = f"{best.ceramic} on {best.backing}" if best.ceramic else best.backing
    return f"Which is the {SUPERLATIVES[design.minimised]} {armour} that defeats {_listed(design.threats)}?"


def _listed(names: tuple[str, ...]) -> str:
    """Return threats as a list in words."""
    return " and ".join(f"the {name}" for name in names)


def cards_of(contents: Contents) -> tuple[Card, ...]:
    """Return the answer in four statements."""
    armour, design = contents.answer.armour, contents.design
    layers = [f"{armour.backing_thickness_mm:.4g} mm {armour.backing}"]
    if armour.ceramic is not None and armour.ceramic_thickness_mm > 0.0:
        layers.insert(0, f"{armour.ceramic_thickness_mm:.4g} mm {armour.ceramic}")
    areal_density = contents.impact.areal_density_kg_m2
    thickness = armour.ceramic_thickness_mm + armour.backing_thickness_mm
    cost = ""
    if design is not None:
        areal_density, thickness = design.best.areal_density_kg_m2, design.best.thickness_mm
        cost = f"cost {design.best.cost_per_m2:,.0f} per m²" if design.best.cost_per_m2 > 0.0 else ""
    return (
        Card("Armour" if design is None else "Best design", " on ".join(layers), f"{thickness:.4g} mm thick"),
        Card("Areal density", f"{areal_density:.1f} kg/m²", cost),
        _outcome(contents),
        _reliability(contents),
    )


def _outcome(contents: Contents) -> Card:
    impact, design = contents.answer.impact, contents.design
    against = f"{impact.projectile} at {impact.velocity_m_s:g} m/s"
    limit = "ballistic limit outside the range searched"
    if contents.limit is not None and contents.margin_m_s is not None:
        limit = f"ballistic limit {contents.limit.ballistic_limit_m_s:.1f} m/s, margin {contents.margin_m_s:+.1f} m/s"
    if design is None:
        outcome = {"defeated": "projectile defeated", "perforated": "armour perforated"}[contents.impact.outcome]
        return Card("Outcome", outcome, f"{against}; {limit}")
    if len(design.threats) > 1:
        return Card("Defeats", " and ".join(design.threats), f"governed by {design.best.governing}: {limit}")
    return Card("Defeats", against, limit)


def _reliability(contents: Contents) -> Card:
    """Return how reliable the answer is, by the given distributions and by the model's error on tests."""
    mean, largest = MODEL_ERROR_PERCENT
    error = f"error of the model on Wilkins' 13 tests: {mean:g} % on average, {largest:g} % at most"
    if contents.uncertainty is not None:
        p = contents.uncertainty.probability_of_perforation
        detail = f"95 % interval {100.0 * p.low:.1f} to {100.0 * p.high:.1f} %, from the given distributions; {error}"
        return Card("Probability of perforation", f"{100.0 * p.value:.1f} %", detail)
    subject = "Mean error of the ballistic limit"
    if contents.limit is None or contents.margin_m_s is None:
        return Card(subject, f"{mean:g} %", error)
    usual = mean / 100.0 * contents.limit.ballistic_limit_m_s
    within = "the margin is within the mean error: test before use"
    if abs(contents.margin_m_s) >= usual:
        within = "the margin is beyond the mean error"
    return Card(subject, f"± {usual:.0f} m/s", f"{error}; {within}")


def energy_section(contents: Contents) -> Section:
    """Return the section on the projectile's energy."""
    energy = contents.energy
    words = (
        f"The projectile has {energy.before:.2f} J at impact and {energy.left:.2f} J at the end; "
        f"the stages account for the rest to {abs(energy.difference):.1g} J.".replace("e-", "e\N{MINUS SIGN}")
    )
    return Section("Energy balance of the projectile", (words,), (energy_table(energy),))


def sections_of(contents: Contents) -> tuple[Section, ...]:
    """Return the sections with tables: designs, stages, uncertainty, sensitivity, and materials with their sources."""
    found = []
    design = contents.design
    if design is not None:
        found.append(Section("Best design", tables=(best_table(design),)))
        if len(design.threats) > 1 or design.best.probabilities:
            found.append(Section("Margins against the threats", tables=(margin_table(design),)))
        if len(design.pairs) > 1:
            found.append(Section("Pairs of materials", tables=(pair_table(design),)))
        else:
            found.append(Section("Required ceramic for each back plate", tables=(frontier_table(design),)))
        if design.pareto:
            found.append(Section("Pareto front", tables=(pareto_table(design),)))
    found.append(Section("Stages of the impact", tables=(stage_table(contents.impact),)))
    if contents.uncertainty is not None:
        found.append(Section("Results under uncertain inputs", tables=(estimate_table(contents.uncertainty),)))
    found.append(Section("Sensitivity to the inputs", tables=(elasticity_table(contents.sensitivity),)))
    found += (
        Section(f"{entry.kind.capitalize()}: {entry.name}", tables=(entry_table(entry),)) for entry in contents.entries
    )
    return tuple(found)


def version_table() -> Table:
    """Return the versions of the programs that the results depend on."""
    versions = [("armour", __version__), ("model", MODEL_VERSION), ("Python", sys.version.split()[0])]
    versions += [(name, version(name)) for name in PACKAGES]
    return Table((Column("program"), Column("version")), tuple(versions))
