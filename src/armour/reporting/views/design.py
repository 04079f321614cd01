"""A design search."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from armour.design.optimise import OBJECTIVES, BestDesign, Design, DesignResult
from armour.reporting import charts
from armour.reporting.table import Column, Source, Table, column_of, csv_text, listing, record
from armour.reporting.text import interval, number, percent
from armour.reporting.views.confidence import DEFEAT, chance, error_note
from armour.scenario.scenario import Scenario

# Probability of defeat below which the notes say how to ask for more.
LOW = 0.75


ASK = "--confidence 0.95 designs for a probability of 95 %"


AREAL_DENSITY, BALLISTIC_LIMIT = column_of("areal_density_kg_m2"), column_of("ballistic_limit_m_s")


CERAMIC, BACKING = column_of("ceramic"), column_of("backing")


# Thicknesses are shown with at most 3 decimals, and with no more than those of a table need.
CERAMIC_THICKNESS = column_of("ceramic_thickness_mm", ".3f")


BACKING_THICKNESS = column_of("backing_thickness_mm", ".3f")


THICKNESS = column_of("thickness_mm", ".3f", "total thickness")


COST = column_of("cost_per_m2", ".2f")


GOVERNED_BY = Column("governed by", prose=True)


MARGIN, REQUIRED = column_of("margin_m_s", "+.1f"), Column("required margin", "m/s", "+.1f")


def required_margins(scenario: Scenario | None) -> dict[str, float]:
    """Return the margins that the threats of a scenario require, m/s, by threat."""
    threats = () if scenario is None else scenario.threat
    return {threat.title: threat.margin_m_s for threat in threats if threat.margin_m_s}


def best_table(result: DesignResult, required: Mapping[str, float]) -> Table:
    """Return the best design, quantity by quantity."""
    return _design_record(result.best, f"{OBJECTIVES[result.minimised].least} design", required)


def _design_record(design: BestDesign, title: str, required: Mapping[str, float]) -> Table:
    limit: Source = BALLISTIC_LIMIT
    if design.ballistic_limit_m_s is None:
        limit = Column("ballistic limit"), "outside the range"
    table = record(
        design,
        CERAMIC,
        (CERAMIC_THICKNESS, design.ceramic_thickness_mm or None),
        BACKING,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        THICKNESS,
        (COST, design.cost_per_m2 or None),
        (GOVERNED_BY, design.governing if len(design.margins_m_s) > 1 else None),
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


def frontier_table(result: DesignResult) -> Table:
    """Return, for each back plate of the best pair, the least ceramic that passes, with notes on some."""
    backings = (design.backing_thickness_mm for design in result.frontier)
    several = len(result.threats) > 1
    governing = dict(zip(backings, result.frontier_governed_by, strict=True)) if several else {}
    best = _thicknesses(result.best)

    def note(design: Any) -> str:
        marks = (
            (_thicknesses(design) == best, OBJECTIVES[result.minimised].least),
            (design.ceramic_thickness_mm == result.ceramic_min_mm, "least of the range"),
        )
        return ", ".join(words for holds, words in marks if holds)

    table = listing(
        result.frontier,
        CERAMIC_THICKNESS,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        MARGIN,
        (GOVERNED_BY, lambda design: governing.get(design.backing_thickness_mm)),
        (Column("note"), note),
    )
    return _aligned(table)


def left_out(result: DesignResult) -> str:
    """Return the back plates without a row in the frontier, on which no ceramic passes."""
    first, last = result.without_mm[0], result.without_mm[-1]
    plates = f"{first:g} to {last:g}" if len(result.without_mm) > 2 else ", ".join(f"{t:g}" for t in result.without_mm)
    return f"{len(result.without_mm)} back plate thicknesses without a row, {plates} mm: no ceramic on them passes"


def _thicknesses(design: Any) -> tuple[float, float]:
    return design.ceramic_thickness_mm, design.backing_thickness_mm


def margin_table(result: DesignResult, required: Mapping[str, float]) -> Table:
    """Return the best design's margin against each threat, and the probabilities of defeat and of perforation."""
    # Imported here because commands without tables do not need scipy.
    from armour.analysis.estimates import CONFIDENCE

    best = result.best
    defeat, sampled = best.probabilities_of_defeat, best.probabilities
    return listing(
        best.margins_m_s,
        (Column("threat", prose=True), str),
        (MARGIN, best.margins_m_s.__getitem__),
        (DEFEAT, lambda threat: chance(defeat[threat])),
        (REQUIRED, required.get),
        (Column("probability of perforation", spec=".4f"), lambda threat: getattr(sampled.get(threat), "value", None)),
        (Column(f"{percent(CONFIDENCE)} interval, by sampling"), lambda threat: interval(sampled.get(threat), ".4f")),
        (Column("note"), lambda threat: "governs" if threat == best.governing else ""),
    )


def pair_table(result: DesignResult) -> Table:
    """Return every pair of materials with its best design, or the reason why it has none."""
    several = len(result.threats) > 1
    shown = [CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST]
    table = listing(
        result.pairs,
        CERAMIC,
        BACKING,
        *((column, lambda pair, key=column.key: getattr(pair.best, key, None)) for column in shown),
        (GOVERNED_BY, lambda pair: getattr(pair.best, "governing", None) if several else None),
        (Column("result", prose=True), lambda pair: pair.reason or "best"),
        title="pairs of materials",
        rest="--json",
    )
    return _aligned(table)


def pareto_table(result: DesignResult) -> Table:
    """Return the designs of the Pareto front."""
    columns = (CERAMIC, BACKING, CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST, MARGIN)
    return _aligned(listing(result.pareto, *columns, title="Pareto front", rest="--csv FILE"))


def csv(result: DesignResult) -> str:
    """Return the Pareto front or, where none is asked for, the frontier as CSV."""
    return csv_text(pareto_table(result) if result.pareto else frontier_table(result))


def tables(result: DesignResult) -> list[Table | str]:
    """Return all tables of a design search: the frontier of a single pair of materials, or a row for each pair."""
    required = required_margins(result.question.get("scenario"))
    found: list[Table | str] = [best_table(result, required)]
    if result.refined is not None:
        title = f"{OBJECTIVES[result.minimised].least} design between the values of the grid"
        found.append(_design_record(result.refined, title, required))
    if len(result.threats) > 1 or result.best.probabilities:
        found.append(margin_table(result, required))
    found.append(frontier_table(result) if len(result.pairs) == 1 else pair_table(result))
    if len(result.pairs) == 1 and result.without_mm:
        found.append(left_out(result))
    if result.pareto:
        found.append(pareto_table(result))
    note = error_note(result, result.best.model_error)
    return [*found, f"{number(result.examined, 'd')} designs computed", note, *margin_notes(result.best)]


def margin_notes(best: BestDesign, ask: str = ASK) -> list[str]:
    """Return how likely a design without a margin is perforated, and how to ask for more, where its margin is low."""
    error = best.model_error
    least = min((p for p in best.probabilities_of_defeat.values() if p is not None), default=1.0)
    if error is None or least >= LOW:
        return []
    perforated = chance(1.0 - error.probability_of_defeat(1.0, 1.0))
    return [f"a design without a margin is perforated with a probability of {perforated}; {ask}"]


# Looks of the best designs, on the grid and between its values.
BEST: dict[str, Any] = {"marker": "*", "size": 11.0, "colour": "vermilion"}


REFINED: dict[str, Any] = {"marker": "D", "colour": "orange"}


# Pairs of materials beside the best that are marked.
MAX_PAIRS = 11


# What designs are compared by, named as in their tables.
CRITERIA = {
    column.key: charts.Axis(column.label, column.unit, spec=spec)
    for column, spec in ((AREAL_DENSITY, ".2f"), (THICKNESS, ".5g"), (COST, ".2f"), (MARGIN, "+.1f"))
}


def chart(result: DesignResult) -> charts.Chart:
    """Describe the designs of a search: the frontier, the best of other pairs, and the Pareto front."""
    frontier = frontier_chart(result)
    if not result.pareto:
        return frontier
    named = {"best", _pair(result.best), *(name for name, *_ in _others(result))}
    pareto = pareto_chart(result)
    [front] = pareto.panels
    series = tuple(replace(item, label="") if item.label in named else item for item in front.series)
    money = "Costs are in the currency of the scenario." if COST.key in result.criteria[:2] else ""
    panels = *frontier.panels, replace(front, series=series, title=pareto.title)
    return replace(frontier, panels=panels, note=" ".join(filter(None, (frontier.note, pareto.note, money))))


def _others(result: DesignResult) -> Sequence[tuple[str, str, Design]]:
    """Return the pairs of materials beside the best that are marked: their names, why they lose and their designs."""
    found = [(_pair(pair), pair.reason, pair.best) for pair in result.pairs if pair.best is not None and pair.reason]
    return found[:MAX_PAIRS]


def _looks(result: DesignResult) -> dict[str, dict[str, Any]]:
    """Return colour and marker of every pair of materials."""
    names = [_pair(result.best), *(name for name, *_ in _others(result)), *map(_pair, result.pareto)]
    return {name: charts.look_of(index) for index, name in enumerate(dict.fromkeys(names))}


def frontier_chart(result: DesignResult) -> charts.Chart:
    """Describe the criterion minimised and the required ceramic over the back plate, for the best pair and others."""
    x = charts.quantity_axis("armour.backing_thickness_mm")
    # The legend is that of the first panel.
    required = tuple(replace(item, label="") for item in _frontier(result, "ceramic_thickness_mm"))
    panels = (
        charts.Panel(x, CRITERIA[result.minimised], _frontier(result, result.minimised)),
        charts.Panel(x, charts.quantity_axis("required_ceramic_thickness_mm"), required, shares_x=True),
    )
    pairs = sum(pair.best is not None for pair in result.pairs)
    notes = []
    if pairs > 1:
        notes.append(f"The line is {_pair(result.best)}, the pair of the best design; a point is another pair's best.")
    if pairs > MAX_PAIRS + 1:
        notes.append(f"The best {MAX_PAIRS + 1} of {pairs} pairs of materials are shown.")
    if any(design.ceramic_thickness_mm == result.ceramic_min_mm for design in result.frontier):
        notes.append(
            f"Where the ceramic is {result.ceramic_min_mm:g} mm, the least of its range, less may be required."
        )
    return charts.Chart("Required ceramic for each back plate", panels, " ".join(notes))


def _frontier(result: DesignResult, key: str) -> tuple[charts.Series, ...]:
    """Describe a quantity of the frontier, of the best designs of other pairs and of the best of all."""
    looks, pair = _looks(result), _pair(result.best)
    text = [_design_text(design, result.minimised) for design in result.frontier]
    if len(result.threats) > 1:
        governed = zip(text, result.frontier_governed_by, strict=True)
        text = [f"{words}\ngoverned by {threat}" for words, threat in governed]
    marks = [(*other, {"filled": False, **looks[other[0]]}) for other in _others(result)]
    marks.append(("best", _design_text(result.best, result.minimised), result.best, BEST))
    if result.refined is not None:
        marks.append(("refined", _design_text(result.refined, result.minimised), result.refined, REFINED))
    backing = [design.backing_thickness_mm for design in result.frontier]
    values = [getattr(design, key) for design in result.frontier]
    series: list[charts.Series] = [charts.Line(backing, values, label=pair, text=tuple(text), **looks[pair])]
    for name, detail, design, look in marks:
        words = (f"{name}\n{_design_text(design, result.minimised)}",)
        place = [design.backing_thickness_mm], [getattr(design, key)]
        series.append(charts.Points(*place, label=f"{name}: {detail}", text=words, **look))
    return tuple(series)


def pareto_chart(result: DesignResult) -> charts.Chart:
    """Describe the Pareto front over its first two criteria, a series for each pair of materials."""
    looks = _looks(result)
    x, y = result.criteria[:2]
    series: list[charts.Series] = []
    if len(result.criteria) == 2:
        # The points on it have the words.
        front = sorted(result.pareto, key=lambda design: getattr(design, x))
        series.append(
            charts.Line(*_at(front, x, y), ":", 1.0, label="Pareto front", colour="ink", text=("",) * len(front))
        )
    for name, designs in charts.grouped(result.pareto, _pair).items():
        text = tuple(f"{name}\n{_design_text(design, *result.criteria)}" for design in designs)
        series.append(charts.Points(*_at(designs, x, y), filled=False, label=name, text=text, **looks[name]))
    words = (f"best\n{_design_text(result.best, *result.criteria)}",)
    series.append(charts.Points(*_at([result.best], x, y), label="best", text=words, **BEST))
    notes = ""
    if len(result.criteria) > 2:
        hidden = " and ".join(CRITERIA[key].label for key in result.criteria[2:])
        notes = f"A design of the front that another one beats in both criteria drawn is better in {hidden}."
    return charts.Chart("Pareto front", (charts.Panel(CRITERIA[x], CRITERIA[y], tuple(series)),), notes)


def _at(designs: Iterable[Design], x: str, y: str) -> tuple[list[float], list[float]]:
    """Return two quantities of designs."""
    places = [(getattr(design, x), getattr(design, y)) for design in designs]
    return [place[0] for place in places], [place[1] for place in places]


def _pair(item: Any) -> str:
    return f"{item.ceramic} on {item.backing}" if item.ceramic else str(item.backing)


def _design_text(design: Design, *criteria: str) -> str:
    """Return the thicknesses of a design and its values of criteria."""
    values = (f"{CRITERIA[key].label} {CRITERIA[key].text(getattr(design, key))}" for key in criteria)
    return ", ".join([f"{design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm", *values])
