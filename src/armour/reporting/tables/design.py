"""Tables of a design search."""

from typing import TYPE_CHECKING, TypeVar

from armour.reporting.table import Cell, Column, Table, record
from armour.reporting.tables.impact import AREAL_DENSITY
from armour.reporting.text import interval

if TYPE_CHECKING:
    from armour.design.optimise import BestDesign, Design, DesignResult

Item = TypeVar("Item", Column, Cell)

SUPERLATIVES = {"areal_density_kg_m2": "lightest", "thickness_mm": "thinnest", "cost_per_m2": "cheapest"}
CERAMIC = Column("ceramic", key="ceramic")
BACKING = Column("back plate", key="backing")
CERAMIC_THICKNESS = Column("ceramic thickness", "mm", "g", key="ceramic_thickness_mm")
BACKING_THICKNESS = Column("back plate thickness", "mm", "g", key="backing_thickness_mm")
THICKNESS = Column("total thickness", "mm", "g", key="thickness_mm")
COST = Column("cost per m²", spec=",.2f", key="cost_per_m2")
MARGIN = Column("margin", "m/s", "+.1f", key="margin_m_s")


def best_table(result: "DesignResult") -> Table:
    """Return the best design, quantity by quantity."""
    return _design_record(result.best, f"{SUPERLATIVES[result.minimised]} design")


def refined_table(result: "DesignResult", refined: "BestDesign") -> Table:
    """Return the best design of continuous thicknesses, quantity by quantity."""
    return _design_record(refined, f"{SUPERLATIVES[result.minimised]} design between the values of the grid")


def _design_record(design: "BestDesign", title: str) -> Table:
    ceramic = bool(design.ceramic)
    limit: tuple[Column, Cell] = (Column("ballistic limit"), "outside the range")
    if design.ballistic_limit_m_s is not None:
        limit = (Column("ballistic limit", "m/s", ".2f"), design.ballistic_limit_m_s)
    return record(
        (CERAMIC, design.ceramic if ceramic else None),
        (CERAMIC_THICKNESS, design.ceramic_thickness_mm if ceramic else None),
        (BACKING, design.backing),
        (BACKING_THICKNESS, design.backing_thickness_mm),
        (AREAL_DENSITY, design.areal_density_kg_m2),
        (THICKNESS, design.thickness_mm),
        (COST, design.cost_per_m2 or None),
        limit,
        (MARGIN, design.margin_m_s),
        title=title,
    )


def frontier_table(result: "DesignResult") -> Table:
    """Return, for each back plate of the best pair, the least ceramic that defeats every threat; the best is marked."""
    margins = any(design.margin_m_s is not None for design in result.frontier)
    governed = len(result.threats) > 1
    threats = result.frontier_governed_by if governed else ("",) * len(result.frontier)
    columns = (
        CERAMIC_THICKNESS,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        *_if(margins, MARGIN),
        *_if(governed, Column("governed by", prose=True)),
        Column(""),
    )
    rows = tuple(
        (
            *_thicknesses(design),
            design.areal_density_kg_m2,
            *_if(margins, design.margin_m_s),
            *_if(governed, threat),
            SUPERLATIVES[result.minimised] if _thicknesses(design) == _thicknesses(result.best) else "",
        )
        for design, threat in zip(result.frontier, threats, strict=True)
    )
    return Table(columns, rows)


def _thicknesses(design: "Design") -> tuple[float, float]:
    return design.ceramic_thickness_mm, design.backing_thickness_mm


def _if(wanted: bool, item: Item) -> tuple[Item, ...]:
    return (item,) if wanted else ()


def margin_table(result: "DesignResult") -> Table:
    """Return the best design's margin against each threat, and the probability of perforation where it is bounded."""
    best = result.best
    sampled_columns = (Column("probability of perforation", spec=".4f"), Column("interval"))
    columns = (Column("threat", prose=True), MARGIN, *(sampled_columns if best.probabilities else ()))
    rows: list[tuple[Cell, ...]] = []
    for threat, margin in best.margins_m_s.items():
        estimate = best.probabilities.get(threat)
        sampled: tuple[Cell, ...] = (None, None) if best.probabilities else ()
        if estimate is not None:
            sampled = (estimate.value, interval(estimate.low, estimate.high, ".4f"))
        rows.append((threat, margin, *sampled, "governs" if threat == best.governing else ""))
    return Table((*columns, Column("")), tuple(rows))


def pair_table(result: "DesignResult") -> Table:
    """Return every pair of materials with its best design, or the reason why it has none."""
    costs = any(pair.best is not None and pair.best.cost_per_m2 > 0.0 for pair in result.pairs)
    governed = len(result.threats) > 1
    columns = (
        CERAMIC,
        BACKING,
        CERAMIC_THICKNESS,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        THICKNESS,
        *_if(costs, COST),
        *_if(governed, Column("governed by", prose=True)),
        Column("result", prose=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for pair in result.pairs:
        best = pair.best
        values: tuple[Cell, ...] = (None,) * (len(columns) - 3)
        if best is not None:
            values = (
                best.ceramic_thickness_mm,
                best.backing_thickness_mm,
                best.areal_density_kg_m2,
                best.thickness_mm,
                *_if(costs, best.cost_per_m2),
                *_if(governed, best.governing),
            )
        rows.append((pair.ceramic, pair.backing, *values, pair.reason or "best"))
    return Table(columns, tuple(rows))


def pareto_table(result: "DesignResult") -> Table:
    """Return the designs of the Pareto front."""
    margins = any(design.margin_m_s is not None for design in result.pareto)
    columns = (CERAMIC, BACKING, CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST)
    rows = tuple(
        (
            design.ceramic,
            design.backing,
            design.ceramic_thickness_mm,
            design.backing_thickness_mm,
            design.areal_density_kg_m2,
            design.thickness_mm,
            design.cost_per_m2,
            *_if(margins, design.margin_m_s),
        )
        for design in result.pareto
    )
    return Table((*columns, *_if(margins, MARGIN)), rows, "Pareto front")


def design_tables(result: "DesignResult") -> list[Table | str]:
    """Return all tables of a design search.

    A single pair of materials has its frontier, several have a row each; margins are listed where there are several
    threats or a bound on the probability of perforation.
    """
    tables: list[Table | str] = [best_table(result)]
    if result.refined is not None:
        tables.append(refined_table(result, result.refined))
    if len(result.threats) > 1 or result.best.probabilities:
        tables.append(margin_table(result))
    tables.append(frontier_table(result) if len(result.pairs) == 1 else pair_table(result))
    if result.pareto:
        tables.append(pareto_table(result))
    return [*tables, f"examined {result.examined:,} of {result.designs:,} designs on offer"]
