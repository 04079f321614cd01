"""A design search."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from armour.design.optimise import OBJECTIVES, BestDesign, Design, DesignResult, Pair
from armour.reporting import charts
from armour.reporting.table import Column, Source, Table, column_of, csv_text, listing, record
from armour.reporting.text import Verdict, interval, number, percent
from armour.reporting.views.confidence import STOPPING, chance, error_note, flow_stress_notes, risk, with_error
from armour.scenario.scenario import Scenario

if TYPE_CHECKING:
    from armour.design.catalogue import Catalogue
    from armour.design.map import DesignMap

# Probability of stopping the projectile below which the notes say how to ask for more, and how.
LOW, ASK = 0.75, "--confidence 0.95 designs for 95 %"
# Rows of the frontier that are shown unless all are asked for.
FRONTIER_ROWS = 5
AREAL_DENSITY, BALLISTIC_LIMIT = column_of("areal_density_kg_m2"), column_of("ballistic_limit_m_s")
CERAMIC, BACKING = column_of("ceramic"), column_of("backing")
# Thicknesses are shown with at most 3 decimals, and with no more than those of a table need.
CERAMIC_THICKNESS, BACKING_THICKNESS = (column_of(f"{layer}_thickness_mm", ".3f") for layer in ("ceramic", "backing"))
THICKNESS = column_of("thickness_mm", ".4g", "total thickness")
COST = column_of("cost_per_m2", ".0f")
GOVERNED_BY = Column("governed by", prose=True)
# The margin of the armour itself depends on the model error.
MARGIN = column_of("margin_m_s", "+.0f", "margin by the model")
REQUIRED = Column("required margin", "m/s", "+.0f")
TESTS = Column("tests", key="untested")


def required_margins(scenario: Scenario | None) -> dict[str, float]:
    """Return the margins that the threats of a scenario require, m/s, by threat."""
    threats = () if scenario is None else scenario.threat
    return {threat.title: threat.margin_m_s for threat in threats if threat.margin_m_s}


def best_table(design: BestDesign, required: Mapping[str, float], title: str = "") -> Table:
    """Return a design quantity by quantity, with the margins that the threats require."""
    limit: list[Source] = [BALLISTIC_LIMIT]
    if design.ballistic_limit_m_s is None:
        limit = [(Column("ballistic limit"), "outside the range")]
    elif (error := design.model_error) is not None:
        of = design.ballistic_limit_m_s
        limit.append(with_error(error.median(of), error.interval(of)))
    sure = chance(design.probabilities_of_stopping[design.governing], design.model_error)
    against: list[Source] = [(STOPPING, sure), MARGIN, (REQUIRED, required.get(design.governing))]
    if len(design.margins_m_s) > 1:  # the table of the threats has these of each
        limit, against = [(GOVERNED_BY, design.governing), *limit], []
    return record(
        design,
        (Column("armour", prose=True), armour_in_words(design)),
        AREAL_DENSITY,
        *limit,
        *against,
        THICKNESS,
        (COST, design.cost_per_m2 or None),
        title=title,
    )


def armour_in_words(design: Design) -> str:
    """Return the layers of a design, such as "11 mm AD85 on 6 mm 5083-H3"."""
    ceramic = f"{design.ceramic} (untested)" if design.untested else design.ceramic
    names = (design.ceramic_thickness_mm, ceramic), (design.backing_thickness_mm, design.backing)
    return " on ".join(f"{round(thickness, 3):g} mm {name}" for thickness, name in names if name)


def verdict(result: DesignResult) -> list[Table | str]:
    """Return, without a best design, what is nearest to one, and why it is no more than that."""
    objective, nearest, beyond = OBJECTIVES[result.minimised], result.nearest, result.without_limits
    if not result.reason:
        return []
    if nearest is None:
        return [Verdict.of(f"not known: {result.explanation}", good=False)]
    armour, notes = armour_in_words(nearest), _flow_stress_notes(nearest)
    if result.reason == "not known":
        reaches = f"{armour} is the {objective.least} that stops {_every(result)} by the computed limit"
        return [Verdict.of(f"not known: {reaches}", good=False), *notes, result.explanation]
    short = ", ".join(f"{lacking:.0f} m/s against {threat}" for threat, lacking in nearest.short_m_s.items() if lacking)
    over = "; ".join(_beyond(nearest))
    found: list[Table | str] = [
        Verdict.of(f"none passes: the nearest, {armour}, lacks {'; '.join(filter(None, (short, over)))}", good=False)
    ]
    if beyond is not None and beyond.exceeds:
        words = f"{armour_in_words(beyond)} would stop {_every(result)}, but has {'; '.join(_beyond(beyond))}"
        return [*found, words, *notes]
    return [*found, result.explanation, *notes]


def _every(result: DesignResult) -> str:
    return "every threat" if len(result.threats) > 1 else result.threats[0]


def _beyond(design: BestDesign) -> list[str]:
    """Return by how much a design exceeds limits."""
    units = {objective.bound: objective.unit for objective in OBJECTIVES.values()}
    return [f"{excess:.3g}{units[key]} more than design.{key} allows" for key, excess in design.exceeds.items()]


def _flow_stress_notes(design: BestDesign) -> list[str]:
    """Return what flow stress the ceramic of a design needs, if it has no tests, against the threat that needs most."""
    most = max(design.flow_stress.items(), key=lambda item: item[1].needed_GPa or inf, default=None)
    return [] if most is None else flow_stress_notes(most[1], most[0])


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
    several = len(result.threats) > 1
    governing = dict(zip(map(_thicknesses, result.frontier), result.frontier_governed_by, strict=True))

    def note(design: Design) -> str:
        marks = [OBJECTIVES[result.minimised].least] if _thicknesses(design) == _thicknesses(_shown(result)) else []
        return ", ".join([*marks, *["least of the range"] * (design.ceramic_thickness_mm == result.ceramic_min_mm)])

    table = listing(
        result.frontier,
        CERAMIC_THICKNESS,
        BACKING_THICKNESS,
        AREAL_DENSITY,
        MARGIN,
        (GOVERNED_BY, lambda design: governing[_thicknesses(design)] if several else None),
        (Column("note"), note),
        title=f"{_pair(_shown(result))}: thinnest ceramic for each back plate" if len(result.pairs) > 1 else "",
    )
    return _aligned(table)


def _around_best(result: DesignResult) -> DesignResult:
    """Return a result with the part of its frontier that is around the best design."""
    places = [_thicknesses(design) for design in result.frontier]
    best = _thicknesses(_shown(result))
    middle = places.index(best) if best in places else 0
    first = max(min(middle - FRONTIER_ROWS // 2, len(places) - FRONTIER_ROWS), 0)
    rows = slice(first, first + FRONTIER_ROWS)
    return replace(result, frontier=result.frontier[rows], frontier_governed_by=result.frontier_governed_by[rows])


def left_out(result: DesignResult) -> str:
    """Return the back plates without a row in the frontier, on which no ceramic passes."""
    first, last = result.without_mm[0], result.without_mm[-1]
    plates = f"{first:g} to {last:g}" if len(result.without_mm) > 2 else ", ".join(f"{t:g}" for t in result.without_mm)
    if len(result.without_mm) == 1:
        return f"no row for the {plates} mm back plate: no ceramic on it passes"
    return f"no rows for {len(result.without_mm)} back plates, {plates} mm: no ceramic on them passes"


def _thicknesses(design: Design) -> tuple[float, float]:
    return design.ceramic_thickness_mm, design.backing_thickness_mm


def margin_table(result: DesignResult, required: Mapping[str, float]) -> Table:
    """Return the best design's margin against each threat, and the probabilities of stop and of perforation."""
    # Imported here because commands without tables do not need scipy.
    from armour.analysis.estimates import CONFIDENCE

    best = _shown(result)
    stop, sampled = best.probabilities_of_stopping, best.probabilities
    return listing(
        best.margins_m_s,
        (Column("threat", prose=True), str),
        (MARGIN, best.margins_m_s.__getitem__),
        (Column("short by", "m/s", ".0f"), lambda threat: best.short_m_s[threat] or None),
        (STOPPING, lambda threat: chance(stop[threat])),
        (REQUIRED, required.get),
        (Column("probability of perforation", spec=".3f"), lambda threat: getattr(sampled.get(threat), "value", None)),
        (Column(f"{percent(CONFIDENCE)} interval, by sampling"), lambda threat: interval(sampled.get(threat), ".3f")),
        (Column("note"), lambda threat: "governs" if threat == best.governing else ""),
    )


def pair_table(result: DesignResult) -> Table:
    """Return every pair of materials with its best design, or the reason why it has none."""
    shown = [CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST]
    table = listing(
        result.pairs,
        CERAMIC,
        (TESTS, _tests),
        BACKING,
        *((column, lambda pair, key=column.key: getattr(pair.best, key, None)) for column in shown),
        (Column("result", prose=True), lambda pair: pair.reason or _named(result, pair)),
        title="pairs of materials",
        rest="--json",
    )
    return _aligned(table)


def pareto_table(result: DesignResult) -> Table:
    """Return the designs of the Pareto front."""
    columns = (BACKING, CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST, MARGIN)
    return _aligned(listing(result.pareto, CERAMIC, (TESTS, _tests), *columns, title="Pareto front", rest="--csv FILE"))


def every_table(result: DesignResult) -> Table:
    """Return all designs of a small catalogue, with the margin by the model against each threat."""
    rows = list(zip(result.every, result.margins_of_every_m_s, strict=True))
    columns = (CERAMIC_THICKNESS, BACKING, BACKING_THICKNESS, AREAL_DENSITY, COST)
    several = len(result.threats) > 1
    return _aligned(
        listing(
            rows,
            (CERAMIC, lambda row: row[0].ceramic),
            (TESTS, lambda row: _tests(row[0])),
            *((column, lambda row, key=column.key: getattr(row[0], key)) for column in columns),
            *(
                (
                    Column(f"margin against {threat}" if several else MARGIN.label, "m/s", "+.0f"),
                    lambda row, threat=threat: row[1][threat],
                )
                for threat in result.threats
            ),
            title="designs, with margins by the model" if several else "designs",
            rest="--csv FILE",
        )
    )


def _tests(of: Design | Pair) -> str:
    return "untested" if of.untested else ""


def _named(result: DesignResult, pair: Pair) -> str:
    """Return what the best design of a pair is that has no reason not to be best."""
    least, best = OBJECTIVES[result.minimised].least, pair.best
    if best is None:
        return ""
    return least if result.best is not None and best.model_error is not None else f"{least} by the computed limit"


def csv(result: DesignResult) -> str:
    """Return the Pareto front as CSV or, where none is asked for, the frontier; without one, every design."""
    designs = result.pareto or result.frontier or result.every
    return csv_text(pareto_table(replace(result, pareto=designs)))


def _shown(result: DesignResult) -> BestDesign:
    """Return the best design or, without one, the nearest; that there is one is checked before."""
    assert result.shown is not None
    return result.shown


def tables(result: DesignResult) -> list[Table | str]:
    """Return all tables of a design search: the frontier of a single pair of materials, or a row for each pair."""
    scenario: Scenario | None = result.question.get("scenario")
    required, best = required_margins(scenario), result.shown
    found: list[Table | str] = [*verdict(result)]
    if best is not None:
        answer = None if scenario is None or best.model_error is not None else _answer(scenario, best)
        error = [] if result.reason == "not known" else [error_note(result, best.model_error, answer)]
        needed = [] if result.reason else _flow_stress_notes(best)
        found += [best_table(best, required), *error, *needed, *margin_notes(best)]
    if result.refined is not None:
        objective = OBJECTIVES[result.minimised]
        if result.refined == best:
            found.append(f"no {objective.less} design was found between the values of the grid")
        else:
            found.append(
                best_table(result.refined, required, f"{objective.least} design between the values of the grid")
            )
    if best is not None and (len(result.threats) > 1 or best.probabilities):
        found.append(margin_table(result, required))
    verbose = result.question.get("every_row")
    if len(result.pairs) > 1 or not all(pair.ranked for pair in result.pairs):
        found.append(pair_table(result))
        found += [note for pair in result.pairs if not pair.ranked for note in _of_one_source(pair)]
    if result.every and (verbose or result.reason):
        found.append(every_table(result))
    if result.frontier and (len(result.pairs) == 1 or verbose):
        shown = result if verbose else _around_best(result)
        found.append(frontier_table(shown))
        if len(shown.frontier) < len(result.frontier):
            found.append(f"{len(result.frontier) - len(shown.frontier)} more back plates with -v")
        if result.without_mm:
            found.append(left_out(result))
    if result.pareto:
        found.append(pareto_table(result))
    return [*found, f"{number(result.examined, 'd')} designs computed"]


def _of_one_source(pair: Pair) -> list[str]:
    """Return what flow stress the best design of a pair needs that is not ranked for it."""
    if pair.best is None:
        return []
    return [f"{armour_in_words(pair.best)} {note}" for note in _flow_stress_notes(pair.best)[:1]]


def _answer(scenario: Scenario, best: BestDesign) -> Scenario:
    """Return the scenario with the best design against its governing threat."""
    [governing] = [threat for threat in scenario.threats() if threat.title == best.governing]
    return scenario.replaced(best.changes_to(scenario)).against(governing)


def margin_notes(best: BestDesign) -> list[str]:
    """Return how likely the best design is perforated, and how to ask for less, where it is likely."""
    least = min((p for p in best.probabilities_of_stopping.values() if p is not None), default=1.0)
    return [f"perforated with a probability of {risk(least)}; {ASK}"] if least < LOW else []


# Looks of the best designs, on the grid and between its values.
BEST: dict[str, Any] = {"marker": "o", "size": 9.0}
REFINED: dict[str, Any] = {"marker": "D", "colour": "green"}
# Pairs of materials that are shown, by a point and by a line; nodes of the grid along an axis, and designs on offer up
# to which each is a dot.
MAX_PAIRS, MAX_LINES, NODES, MAX_DOTS = 12, 6, 25, 250
# Probability that a map shows where no confidence is asked for.
USUAL = 0.95
# Words of designs between the velocity and the limit of half of them.
EVEN = "perforated more often than not"
# Difference of two frontiers, m/s, below which one line is drawn.
SAME_M_S = 1.0
# What designs are compared by, named as in their tables.
CRITERIA = {
    column.key: charts.Axis(column.label, column.unit, spec=spec)
    for column, spec in ((AREAL_DENSITY, ".2f"), (THICKNESS, ".5g"), (COST, ".2f"), (MARGIN, "+.1f"))
}


def chart(result: DesignResult) -> charts.Chart:
    """Describe the designs of a search: limits over one thickness, or the map of the best pair with what is beside it.

    Beside the map are the best design of each pair, and the Pareto front.
    """
    first = map_chart(result)
    if len(first.panels) > 1 or first.panels[0].title:
        return first
    rest = [pair_chart(result)] if sum(pair.best is not None for pair in result.pairs) > 1 else []
    rest += [pareto_chart(result)] if result.pareto else []
    titled = [replace(panel, title=other.title) for other in rest for panel in other.panels]
    notes = " ".join(filter(None, (each.note for each in (first, *rest))))
    return replace(first, panels=(*first.panels, *titled), note=notes)


def map_chart(result: DesignResult) -> charts.Chart:
    """Describe the designs of the best pair over both thicknesses, or those of all pairs over the one that differs."""
    # Imported here because the tables of a search do not need it.
    from armour.design.catalogue import NO_BOUND, catalogue_of
    from armour.design.map import design_map, with_edges_of_known

    catalogue = catalogue_of(charts.needed(result, "scenario"))
    names = [(offer.ceramic.material, offer.backing.material) for offer in catalogue.offers]
    design = result.shown or next((pair.best for pair in result.pairs if pair.best is not None), None)
    best = 0 if design is None else names.index((design.ceramic, design.backing))
    asked = tuple(1.0 - bound if bound < NO_BOUND else None for bound in catalogue.bounds.tolist())
    probabilities = tuple({1.0 - USUAL, 0.5, USUAL, *(c for c in asked if c is not None)})

    def drawing(pair: int) -> _MapDrawing:
        layers = (np.array(layer.thicknesses()) for layer in catalogue.offers[pair][:2])
        grid = with_edges_of_known(catalogue, pair, *(_nodes(layer) for layer in layers))
        return _MapDrawing(result, catalogue, design_map(catalogue, pair, *grid, probabilities), asked)

    single = [tuple(len(layer.thicknesses()) == 1 for layer in offer[:2]) for offer in catalogue.offers]
    if any(single[best]):
        layer = "backing" if single[best][0] and not single[best][1] else "ceramic"
        alike = [pair for pair, of in enumerate(single) if of[layer == "ceramic"]]
        alike.sort(key=lambda pair: pair != best)
        return _line_chart(result, [drawing(pair) for pair in alike[:MAX_LINES]], layer)
    drawn = drawing(best)
    return charts.Chart(title(result), (drawn.panel(),), drawn.note())


def _nodes(offered: Any) -> Any:
    """Return nodes of a map between the thicknesses on offer, which are among them where these are few."""
    even = np.linspace(offered[0], offered[-1], NODES) if len(offered) > 1 else offered
    return np.union1d(even, offered) if len(offered) <= NODES else even


def _line_chart(result: DesignResult, drawings: "Sequence[_MapDrawing]", layer: str) -> charts.Chart:
    """Describe the limits of pairs of materials over one thickness, a panel for each threat."""
    catalogue, threats = drawings[0].catalogue, result.threats
    names = [drawing.name(layer) for drawing in drawings]
    panels = []
    for place, threat in enumerate(catalogue.threats):
        series: list[charts.Series] = []
        for index, (drawing, name) in enumerate(zip(drawings, names, strict=True)):
            series += drawing.lines(layer, place, name, charts.COLOURS[index % len(charts.COLOURS)])
        words = f"{threat.required_m_s:g} m/s required"
        series.append(charts.Rule(threat.required_m_s, "--", vertical=False, label=words, colour="ink"))
        x = charts.quantity_axis(f"armour.{layer}_thickness_mm")
        shown = [threat.required_m_s, *(drawing.limits_m_s[..., place] for drawing in drawings)]
        y = charts.quantity_axis(
            "ballistic_limit_m_s", limits=charts.widened(np.concatenate([np.ravel(of) for of in shown]), 0.12)
        )
        panels.append(charts.Panel(x, y, tuple(series), threats[place]))
    beside = len(panels) in (2, 3)
    shared = [replace(panel, shares_x=bool(place) and not beside) for place, panel in enumerate(panels)]
    notes = ["Filled dots are designs on offer that stop the threat"]
    notes[0] += " as required." if any(drawings[0].asked) else " by the model."
    if any(drawing.over_sources is not None for drawing in drawings):
        notes = [
            "Filled dots are designs on offer that stop the threat, untested ones even with the least flow stress of"
        ]
        notes.append("their sources, which bands show.")
    return charts.Chart(
        title(result), tuple(shared), " ".join(notes), width=3.4 * len(panels) if beside else 5.2, beside=beside
    )


def title(result: DesignResult) -> str:
    """Return the best design, and how surely it stops the threats; or what there is without one."""
    if result.reason:
        words = str(verdict(result)[0])
        return words[:1].upper() + words[1:]
    best, sure = _shown(result), _least_sure(result)
    stops = "" if sure is None else f", stops with {chance(sure)}"
    value = CRITERIA[result.minimised].text(getattr(best, result.minimised))
    return f"{OBJECTIVES[result.minimised].least.capitalize()}: {armour_in_words(best)}, {value}{stops}"


def _least_sure(result: DesignResult) -> float | None:
    """Return the least of the probabilities that the best design stops each threat; None where one is unknown."""
    if result.shown is None:
        return None
    found = [result.shown.probabilities_of_stopping[threat] for threat in result.threats]
    return None if None in found else min(p for p in found if p is not None)


class _Frontier(NamedTuple):
    """A line on a map, where values are 0: its words, its look, and the region on one side of it, if that is tinted."""

    words: str
    values: Any
    look: dict[str, Any]
    region: dict[str, Any] | None = None


@dataclass(frozen=True)
class _MapDrawing:
    """A map of designs as it is drawn, with the confidences asked for against each threat, None where none is."""

    result: DesignResult
    catalogue: "Catalogue"
    grid: "DesignMap"
    asked: tuple[float | None, ...]

    @cached_property
    def governing(self) -> int:
        """The governing threat of the design that is named."""
        return self.result.threats.index(self.result.shown.governing) if self.result.shown else 0

    @cached_property
    def shown(self) -> float:
        """Confidence of the line of a probability: the greatest that is asked for."""
        return max((c for c in self.asked if c is not None), default=USUAL)

    @cached_property
    def above_m_s(self) -> Any:
        """How far the limits exceed the velocities required, m/s, (ceramics, back plates): the least of the threats."""
        required = np.array([threat.required_m_s for threat in self.catalogue.threats])
        return (self.grid.limits_m_s - required).min(axis=-1)

    def surely_m_s(self, confidences: Sequence[float]) -> Any:
        """How far velocities stopped with confidences exceed those of the threats, m/s, (ceramics, back plates)."""
        stopped = [self.grid.stopped_with(c)[..., i] for i, c in enumerate(confidences)]
        return (np.stack(stopped, axis=-1) - self.catalogue.velocities_m_s).min(axis=-1)

    @cached_property
    def frontiers(self) -> list[_Frontier]:
        """Where as many are stopped as not, where the probability is that shown, and the limit is that required."""
        even = self.surely_m_s([0.5] * len(self.asked))
        wanted = self.surely_m_s([self.shown if of is None else of for of in self.asked])
        words, label = percent(self.shown), f"stopped in {percent(self.shown)} of cases or more"
        if any(self.asked):
            wanted = np.minimum(wanted, self.above_m_s)
            if len(set(self.asked)) > 1 or required_margins(self.catalogue.scenario):
                words, label = "required", "meets the requirements"
        found = [
            _Frontier("50 %", even, {"colour": "vermilion", "style": "dashed"}, {"high": 0.0, "label": EVEN}),
            _Frontier(words, wanted, {"colour": "blue"}, {"low": 0.0, "label": label}),
        ]
        if not any(self.asked):
            with np.errstate(invalid="ignore"):
                if not np.nanmax(abs(self.above_m_s - even), initial=0.0) < SAME_M_S or np.isnan(wanted).all():
                    found.append(_Frontier("", self.above_m_s, {"colour": "ink"}))
        return [frontier for frontier in found if not np.isnan(frontier.values).all()]

    def regions(self) -> Iterator[charts.Region]:
        """Give designs that stop surely enough, that are perforated more often than not, and of unknown probability."""
        for frontier in self.frontiers:
            if frontier.region is not None:
                yield charts.Region(*self.at(frontier.values), colour=frontier.look["colour"], **frontier.region)
        unknown = np.isnan(self.grid.stopped_m_s).any(axis=(-2, -1))
        if not unknown.all():
            label = "probability unknown: too unlike tests"
            yield charts.Region(*self.at(unknown), low=1e-3, colour="soft", label=label)

    def at(self, values: Any) -> tuple[Any, Any, Any]:
        """Return values with their thicknesses of back plate and ceramic, as a chart has them."""
        return self.grid.backing_mm, self.grid.ceramic_mm, values

    def panel(self) -> charts.Panel:
        """Return the map."""
        objective = self.grid.on_grid(self.catalogue.objective(self.grid.candidates))
        limits = self.grid.limits_m_s[..., self.governing]
        axis = CRITERIA[self.result.minimised]
        of = f" against {self.result.threats[self.governing]}" if len(self.result.threats) > 1 else ""
        dotted: dict[str, Any] = {"style": "dotted", "colour": "soft"}
        series: list[charts.Series] = [
            *self.regions(),
            charts.Contours(*self.at(objective), levels=5, label=f"equal {axis.heading}", **dotted),
            charts.Contours(*self.at(limits), levels=9, label=f"equal ballistic limit{of}, m/s", colour="soft"),
            *self.tested(),
            *self.dots(),
        ]
        for words, values, look, _ in self.frontiers:
            margin = " + margin" if required_margins(self.catalogue.scenario) else ""
            label = "" if words else f"ballistic limit by the model = velocity{margin}"
            series.append(charts.Contours(*self.at(values), at=(0.0,), words=words, label=label, width=1.9, **look))
        for design, look in self.marked():
            if "names" in look:
                value = getattr(design, self.result.minimised)
                line: dict[str, Any] = {"at": (value,), "words": number(value, axis.spec), "colour": look["colour"]}
                series.append(charts.Contours(*self.at(objective), "dotted", **line))
            series.append(charts.Points([design.backing_thickness_mm], [design.ceramic_thickness_mm], **look))
        x = charts.quantity_axis("armour.backing_thickness_mm")
        y = charts.quantity_axis("armour.ceramic_thickness_mm")
        return charts.Panel(x, y, tuple(series), height=1.6)

    @cached_property
    def over_sources(self) -> Any:
        """Limits with the flow stresses of sources, (sources, ceramics, back plates, threats); None without them."""
        from armour.design.map import limits_over_sources

        return limits_over_sources(self.catalogue, self.grid)

    @property
    def limits_m_s(self) -> Any:
        """Limits by the model and with the flow stresses of sources, (..., ceramics, back plates, threats)."""
        over = () if self.over_sources is None else self.over_sources
        return np.stack([self.grid.limits_m_s, *over])

    def name(self, layer: str) -> str:
        """Return what tells the pair from others: the material of the layer, and of the other one if they differ."""
        ceramic, backing = (of.material for of in self.catalogue.offers[self.grid.pair][:2])
        ceramic += " (untested)" * self.catalogue.untested[self.grid.pair]
        one_metal = len(self.catalogue.section.backing) == 1
        return (
            ceramic
            if ceramic and one_metal and layer == "ceramic"
            else f"{ceramic} on {backing}"
            if ceramic
            else backing
        )

    def lines(self, layer: str, threat: int, name: str, colour: str) -> Iterator[charts.Series]:
        """Give the limits against a threat over a thickness, what is known of them, and the designs on offer."""
        x = getattr(self.grid, f"{layer}_mm")
        limits = self.grid.limits_m_s[..., threat].ravel()
        ends = None if self.over_sources is None else self.over_sources[..., threat].reshape(-1, len(x))
        if ends is not None and len(ends) > 1:
            yield charts.Band(x.tolist(), ends[0].tolist(), ends[-1].tolist(), colour=colour)
        if not np.isnan(self.grid.stopped_m_s[..., threat, :]).all():
            low, high = (self.grid.stopped_with(p)[..., threat].ravel().tolist() for p in (USUAL, 1.0 - USUAL))
            yield charts.Band(x.tolist(), low, high, colour=colour)
        yield charts.Line(x.tolist(), limits.tolist(), label=name, colour=colour)
        layers = dict(zip(("ceramic", "backing"), self.catalogue.offers[self.grid.pair][:2], strict=True))
        if layers[layer].free_range():
            return
        offered = np.searchsorted(x, layers[layer].thicknesses())
        least = limits if ends is None else ends[0]
        stops = least >= self.catalogue.threats[threat].required_m_s
        if (asked := self.asked[threat]) is not None:
            sure = self.grid.stopped_with(asked)[..., threat].ravel()
            stops &= np.isnan(sure) | (sure >= self.catalogue.threats[threat].velocity_m_s)
        for filled in (True, False):
            some = [place for place in offered.tolist() if stops[place] == filled]
            words = tuple(f"{x[place]:g} mm: limit by the model {limits[place]:.0f} m/s" for place in some)
            yield charts.Points(x[some].tolist(), limits[some].tolist(), filled=filled, colour=colour, text=words)

    def marked(self) -> Iterator[tuple[Design, dict[str, Any]]]:
        """Give the lightest designs: as asked for, as likely perforated as not, and between the values of the grid."""
        from armour.design.map import lightest

        best, sure = self.result.shown, _least_sure(self.result)
        if any(self.asked) and not np.isnan(self.grid.stopped_m_s).all():
            even = lightest(self.catalogue, self.grid, 0.5)
            if even is not None:
                yield even, {**BEST, **self.named(even, "50 % or more"), "filled": False, "colour": "vermilion"}
        if (refined := self.result.refined) is not None:
            label = f"refined: {_design_text(refined, self.result.minimised)}"
            yield refined, {**REFINED, "label": label, "text": (label,)}
        if best is not None:
            named = self.named(best, "probability unknown" if sure is None else f"{chance(sure)} stopped")
            colour = "vermilion" if self.result.reason else "blue" if any(self.asked) else "ink"
            yield best, {**BEST, **named, "colour": colour}

    def named(self, design: Design, sure: str) -> dict[str, Any]:
        """Return the name of a design, which is also its text: thicknesses, objective, and how surely it stops."""
        thicknesses = f"{design.ceramic_thickness_mm:.4g} on " if design.ceramic else ""
        objective = CRITERIA[self.result.minimised].text(getattr(design, self.result.minimised))
        words = (f"{thicknesses}{design.backing_thickness_mm:.4g} mm\n{objective}, {sure}",)
        return {"names": words, "text": words}

    def dots(self) -> Iterator[charts.Points]:
        """Give the thicknesses on offer, where there are few."""
        layers = self.catalogue.offers[self.grid.pair][:2]
        offered = list(product(*(layer.thicknesses() for layer in layers)))
        if len(offered) <= MAX_DOTS and not any(layer.free_range() for layer in layers):
            words = tuple(f"{ceramic:g} on {backing:g} mm" for ceramic, backing in offered)
            y, x = zip(*offered, strict=True)
            yield charts.Points(x, y, size=2.5, filled=False, colour="soft", label="thicknesses on offer", text=words)

    def tested(self) -> Iterator[charts.Line]:
        """Give the outline of the thicknesses that were tested, as far as it is within the map."""
        from armour.design.map import thicknesses_tested

        found = thicknesses_tested(self.catalogue, self.grid.pair, self.governing)
        if len(found) == 2:
            of = {"ceramic": self.grid.ceramic_mm, "backing": self.grid.backing_mm}
            ends = {name: np.clip(found[name], values[0], values[-1]).tolist() for name, values in of.items()}
            (left, right), (low, high) = ends["backing"], ends["ceramic"]
            if left < right and low < high:
                x, y = [left, right, right, left, left], [low, low, high, high, low]
                look: dict[str, Any] = {"colour": "green", "label": "thicknesses tested", "text": ("",) * 5}
                yield charts.Line(x, y, "-.", 1.0, **look)

    def note(self) -> str:
        """Return what the map does not show."""
        if np.isnan(self.grid.stopped_m_s).all():
            return "No probability is known for these designs."
        notes = []
        if len(self.result.threats) > 1:
            notes.append("Probabilities are those of the threat that is most likely to perforate.")
        if self.catalogue.sampled:
            notes.append("Lines and regions include the model error only, not the distributions of the inputs.")
        return " ".join(notes)


def pair_chart(result: DesignResult) -> charts.Chart:
    """Describe the best design of each pair of materials."""
    found = [pair.best for pair in result.pairs if pair.best is not None]
    shown = found[:MAX_PAIRS]
    series = []
    for known, label in ((True, ""), (False, "no test of such an armour")):
        places = [float(place) for place, design in enumerate(shown) if (design.model_error is not None) == known]
        some = [shown[int(place)] for place in places]
        values = [getattr(design, result.minimised) for design in some]
        words = tuple(f"{_pair(design)}\n{_design_text(design, result.minimised)}" for design in some)
        series.append(charts.Points(values, places, text=words, label=label, filled=known, size=6.0))
    axis = charts.Axis(categories=tuple(map(_pair, shown)))
    note = f"The best {MAX_PAIRS} of {len(found)} pairs of materials are shown." if len(found) > MAX_PAIRS else ""
    title = f"{OBJECTIVES[result.minimised].least.capitalize()} design of each pair of materials"
    return charts.Chart(title, (charts.Panel(CRITERIA[result.minimised], axis, tuple(series)),), note)


def pareto_chart(result: DesignResult) -> charts.Chart:
    """Describe the Pareto front over its first two criteria, a series for each pair of materials."""
    x, y = result.criteria[:2]
    series: list[charts.Series] = []
    for index, (name, designs) in enumerate(charts.grouped(result.pareto, _pair).items()):
        text = tuple(f"{name}\n{_design_text(design, *result.criteria)}" for design in designs)
        series.append(charts.Points(*_at(designs, x, y), filled=False, label=name, text=text, **charts.look_of(index)))
    if result.shown is not None:
        label = "nearest" if result.reason else "best"
        words = (f"{label}\n{_design_text(result.shown, *result.criteria)}",)
        series.append(charts.Points(*_at([result.shown], x, y), size=3.0, label=label, text=words, colour="ink"))
    notes = []
    if len(result.criteria) > 2:
        hidden = " and ".join(CRITERIA[key].label for key in result.criteria[2:])
        notes.append(f"Designs that others beat in both criteria drawn are better in {hidden}.")
    if COST.key in result.criteria[:2]:
        notes.append("Costs are in the currency of the scenario.")
    return charts.Chart("Pareto front", (charts.Panel(CRITERIA[x], CRITERIA[y], tuple(series)),), " ".join(notes))


def _at(designs: Sequence[Design], x: str, y: str) -> tuple[list[float], list[float]]:
    """Return two quantities of designs."""
    return [getattr(design, x) for design in designs], [getattr(design, y) for design in designs]


def _pair(design: Design) -> str:
    return f"{design.ceramic} on {design.backing}" if design.ceramic else design.backing


def _design_text(design: Design, *criteria: str) -> str:
    """Return the thicknesses of a design and its values of criteria."""
    values = (f"{CRITERIA[key].label} {CRITERIA[key].text(getattr(design, key))}" for key in criteria)
    return ", ".join([f"{design.ceramic_thickness_mm:.4g} on {design.backing_thickness_mm:.4g} mm", *values])
