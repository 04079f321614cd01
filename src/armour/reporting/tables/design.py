"""Tables of a design search."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from armour.design.optimise import SUPERLATIVES
from armour.reporting.table import Column, Source, Table, column_of, listing, record
from armour.reporting.tables.confidence import DEFEAT, chance, error_note
from armour.reporting.tables.impact import AREAL_DENSITY, BALLISTIC_LIMIT
from armour.reporting.text import interval, number, percent

if TYPE_CHECKING:
    from armour.design.optimise import BestDesign, DesignResult
    from armour.scenario.scenario import Scenario

# Probability of defeat below which the notes say how to ask for more.
LOW = 0.75
ASK = "--confidence 0.95 designs for a probability of 95 %"
CERAMIC, BACKING = column_of("ceramic"), column_of("backing")
# Thicknesses are shown with at most 3 decimals, and with no more than those of a table need.
CERAMIC_THICKNESS = column_of("ceramic_thickness_mm", ".3f")
BACKING_THICKNESS = column_of("backing_thickness_mm", ".3f")
THICKNESS = column_of("thickness_mm", ".3f", "total thickness")
COST = column_of("cost_per_m2", ".2f")
GOVERNED_BY = Column("governed by", prose=True)
MARGIN, REQUIRED = column_of("margin_m_s", "+.1f"), Column("required margin", "m/s", "+.1f")


def required_margins(scenario: "Scenario") -> dict[str, float]:
    """Return the margins that the threats of a scenario require, m/s, by threat."""
    return {threat.title: threat.margin_m_s for threat in scenario.threat if threat.margin_m_s}


def best_table(result: "DesignResult", required: Mapping[str, float]) -> Table:
    """Return the best design, quantity by quantity."""
    return _design_record(result.best, f"{SUPERLATIVES[result.minimised]} design", required)


def _design_record(design: "BestDesign", title: str, required: Mapping[str, float]) -> Table:
    limit: Source = BALLISTIC_LIMIT
    if design.ballistic_limit_m_s is None:
        limit = Column("ballistic limit"), "outside the range"
    table = record(
        design,
        *((CERAMIC, CERAMIC_THICKNESS) if design.ceramic else ()),
        BACKING,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        THICKNESS,
        *((COST,) if design.cost_per_m2 else ()),
        *([(GOVERNED_BY, design.governing)] if len(design.margins_m_s) > 1 else []),
        limit,
        MARGIN,
        (REQUIRED, required.get(design.governing)),
        (DEFEAT, chance(design.probabilities_of_defeat[design.governing])),
        title=title,
    )
    return _aligned(table)


def _aligned(table: Table) -> Table:
    """Show the thicknesses of a table with the decimals that they need."""
    shown = {CERAMIC_THICKNESS, BACKING_THICKNESS, THICKNESS}
    texts = [
        column.text(cell)
        for row in table.rows
        for column, cell in zip(table.columns, row, strict=True)
        if column in shown
    ]
    decimals = max((len(text.rstrip("0").partition(".")[2]) for text in texts), default=0)
    columns = (replace(column, spec=f".{decimals}f") if column in shown else column for column in table.columns)
    return replace(table, columns=tuple(columns))


def frontier_table(result: "DesignResult") -> Table:
    """Return, for each back plate of the best pair, the least ceramic that passes, with notes on some."""
    backings = (design.backing_thickness_mm for design in result.frontier)
    governing = dict(zip(backings, result.frontier_governed_by, strict=True))
    best = _thicknesses(result.best)

    def note(design: Any) -> str:
        marks = (
            (_thicknesses(design) == best, SUPERLATIVES[result.minimised]),
            (design.ceramic_thickness_mm == result.ceramic_min_mm, "least of the range"),
        )
        return ", ".join(words for holds, words in marks if holds)

    table = listing(
        result.frontier,
        CERAMIC_THICKNESS,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        *_margin(result.frontier),
        *_governed(result, lambda design: governing[design.backing_thickness_mm]),
        (Column("note"), note),
    )
    return _aligned(table)


def left_out(result: "DesignResult") -> str:
    """Return the back plates without a row in the frontier, on which no ceramic passes."""
    first, last = result.without_mm[0], result.without_mm[-1]
    plates = f"{first:g} to {last:g}" if len(result.without_mm) > 2 else ", ".join(f"{t:g}" for t in result.without_mm)
    return f"{len(result.without_mm)} back plate thicknesses without a row, {plates} mm: no ceramic on them passes"


def _thicknesses(design: Any) -> tuple[float, float]:
    return design.ceramic_thickness_mm, design.backing_thickness_mm


def _margin(designs: Any) -> tuple[Source, ...]:
    """Return the column of margins where they are computed."""
    return (MARGIN,) if any(design.margin_m_s is not None for design in designs) else ()


def _governed(result: "DesignResult", threat: Any) -> tuple[Source, ...]:
    """Return the column of governing threats where there are several."""
    return ((GOVERNED_BY, threat),) if len(result.threats) > 1 else ()


def margin_table(result: "DesignResult", required: Mapping[str, float]) -> Table:
    """Return the best design's margin against each threat, and the probabilities of defeat and of perforation."""
    # Imported here because commands without tables do not need scipy.
    from armour.analysis.estimates import CONFIDENCE

    best = result.best
    defeat = best.probabilities_of_defeat
    sampled: list[Source] = [(REQUIRED, required.get)] if required else []
    if best.probabilities:
        values = {threat: estimate.value for threat, estimate in best.probabilities.items()}
        ends = {threat: (estimate.low, estimate.high) for threat, estimate in best.probabilities.items()}
        sampled.append((Column("probability of perforation", spec=".4f"), values.get))
        sampled.append(
            (Column(f"{percent(CONFIDENCE)} interval, by sampling"), lambda threat: interval(ends.get(threat), ".4f"))
        )
    return listing(
        best.margins_m_s,
        (Column("threat", prose=True), str),
        (MARGIN, best.margins_m_s.__getitem__),
        (DEFEAT, lambda threat: chance(defeat[threat])),
        *sampled,
        (Column("note"), lambda threat: "governs" if threat == best.governing else ""),
    )


def pair_table(result: "DesignResult") -> Table:
    """Return every pair of materials with its best design, or the reason why it has none."""
    costs = any(pair.best is not None and pair.best.cost_per_m2 for pair in result.pairs)
    shown = [CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, *((COST,) if costs else ())]
    table = listing(
        result.pairs,
        CERAMIC,
        BACKING,
        *((column, lambda pair, key=column.key: getattr(pair.best, key, None)) for column in shown),
        *_governed(result, lambda pair: getattr(pair.best, "governing", None)),
        (Column("result", prose=True), lambda pair: pair.reason or "best"),
        title="pairs of materials",
    )
    return replace(_aligned(table), rest="--json")


def pareto_table(result: "DesignResult") -> Table:
    """Return the designs of the Pareto front."""
    costs = (COST,) if any(design.cost_per_m2 is not None for design in result.pareto) else ()
    columns = (CERAMIC, BACKING, CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, *costs)
    table = listing(result.pareto, *columns, *_margin(result.pareto), title="Pareto front")
    return replace(_aligned(table), rest="--csv FILE")


def design_tables(
    result: "DesignResult", required: Mapping[str, float], *, excluded: bool | None = None
) -> list[Table | str]:
    """Return all tables of a design search: the frontier of a single pair of materials, or a row for each pair."""
    tables: list[Table | str] = [best_table(result, required)]
    if result.refined is not None:
        title = f"{SUPERLATIVES[result.minimised]} design between the values of the grid"
        tables.append(_design_record(result.refined, title, required))
    if len(result.threats) > 1 or result.best.probabilities:
        tables.append(margin_table(result, required))
    tables.append(frontier_table(result) if len(result.pairs) == 1 else pair_table(result))
    if len(result.pairs) == 1 and result.without_mm:
        tables.append(left_out(result))
    if result.pareto:
        tables.append(pareto_table(result))
    error = error_note(result.best.model_error, excluded=excluded)
    return [*tables, f"{number(result.examined, 'd')} designs computed", error, *margin_notes(result.best)]


def margin_notes(best: "BestDesign", ask: str = ASK) -> list[str]:
    """Return how likely a design without a margin is perforated, and how to ask for more, where its margin is low."""
    error = best.model_error
    least = min((p for p in best.probabilities_of_defeat.values() if p is not None), default=1.0)
    if error is None or least >= LOW:
        return []
    perforated = chance(1.0 - error.probability_of_defeat(1.0, 1.0))
    return [f"a design without a margin is perforated with a probability of {perforated}; {ask}"]
