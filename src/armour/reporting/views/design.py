"""A design search."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from armour.design.optimise import OBJECTIVES, BestDesign, Design, DesignResult, Pair
from armour.reporting.table import Column, Source, Table, column_of, csv_text, listing, record
from armour.reporting.text import Verdict, interval, number, percent
from armour.reporting.words import STOPPING, chance, error_note, flow_stress_notes, risk, with_error
from armour.scenario.scenario import Scenario

if TYPE_CHECKING:
    pass

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
        title=f"{pair_words(_shown(result))}: thinnest ceramic for each back plate" if len(result.pairs) > 1 else "",
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


# What designs are compared by, named as in their tables.
CRITERIA = {
    column.key: replace(column, spec=spec)
    for column, spec in ((AREAL_DENSITY, ".2f"), (THICKNESS, ".5g"), (COST, ".2f"), (MARGIN, "+.1f"))
}


def title(result: DesignResult) -> str:
    """Return the best design, and how surely it stops the threats; or what there is without one."""
    if result.reason:
        words = str(verdict(result)[0])
        return words[:1].upper() + words[1:]
    best, sure = _shown(result), least_sure(result)
    stops = "" if sure is None else f", stops with {chance(sure)}"
    column = CRITERIA[result.minimised]
    value = f"{column.text(getattr(best, result.minimised))} {column.unit}".rstrip()
    return f"{OBJECTIVES[result.minimised].least.capitalize()}: {armour_in_words(best)}, {value}{stops}"


def least_sure(result: DesignResult) -> float | None:
    """Return the least of the probabilities that the best design stops each threat; None where one is unknown."""
    if result.shown is None:
        return None
    found = [result.shown.probabilities_of_stopping[threat] for threat in result.threats]
    return None if None in found else min(p for p in found if p is not None)


def pair_words(design: Design) -> str:
    """Return the materials of a design."""
    return f"{design.ceramic} on {design.backing}" if design.ceramic else design.backing
