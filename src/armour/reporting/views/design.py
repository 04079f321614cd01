"""Tables of design searches, and of checks of one armour against each of its threats."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import compress, zip_longest
from math import inf
from operator import attrgetter, itemgetter
from typing import Any
from xml.etree.ElementTree import Element

from armour.analysis.ballistic_limit import NeededFlowStress
from armour.analysis.variants import outside_words
from armour.design.against import Moved
from armour.design.check import CheckedThreat, CheckResult
from armour.design.optimise import (
    BY_LIMIT,
    BestDesign,
    Design,
    DesignResult,
    Pair,
    armour_in_words,
    excesses,
    short_words,
)
from armour.design.requirements import Requirement
from armour.errors import counted, joined
from armour.evidence.tests import THIN, TOO_THIN, armours_of, limits_of_model, threat_warnings
from armour.reporting import words as phrases
from armour.reporting.by_result import tables_of
from armour.reporting.junit import TestCase, junit_suite
from armour.reporting.report import Report, ReportSection
from armour.reporting.table import Column, Source, Table, VerdictLine, csv_text, interval, of_part, percent
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES, InertLayer

# Below this probability of stopping, a note says how likely perforation is, and how to ask for a safer design.
LOW, ASK = 0.75, "--confidence 0.95 designs for 95 %"
# Rows of the frontier that are shown by default.
FRONTIER_ROWS = 5
AREAL_DENSITY = Column.of("areal_density_kg_m2")
# At most 3 decimals; `_aligned` drops those that no thickness of a table needs.
CERAMIC_THICKNESS, BACKING_THICKNESS = (Column.of(f"{layer}_thickness_mm", ".3f") for layer in ("ceramic", "backing"))
THICKNESS = Column.of("thickness_mm", ".4g", "total thickness")
COST = Column.of("cost_per_m2", ".0f")
LIMIT_COLUMN = Column.of("ballistic_limit_m_s", label="limit")
GOVERNED_BY = Column("governed by", prose=True)
# Called so because the actual margin also depends on the model error.
MARGIN_BY_MODEL = Column.of("margin_m_s", "+.0f", "margin by the model")
REQUIRED = Column("required margin", "m/s", "+.0f")
OUTSIDE = Column("outside the tests in", prose=True, key="outside_tests")
NEEDED = Column("flow stress needed", "GPa", ".1f")
SOURCES, METAL = "flow_stress_sources", "backing_density_kg_m3"
METALS = (
    "the model gives the strength of the back plate more effect than the paper has: do not rely on this comparison of "
    "metals of different strength"
)
# Words for the places of layers without ballistic effect, and for those without a name.
PLACES = {"front": "in front", "between": "between tile and back plate", "behind": "behind"}
UNNAMED = "added for adhesive or cover"
EXISTS = "areal density, thickness and cost without the back plate, which exists"


def required_margins(scenario: Scenario | None) -> dict[str, float]:
    """Return the required margins of a scenario by threat, m/s, where they are not 0."""
    threats = () if scenario is None else scenario.threat
    return {threat.title: threat.margin_m_s for threat in threats if threat.margin_m_s}


def best_table(design: BestDesign, required: Mapping[str, float], title: str = "") -> Table:
    """Tabulate a design in a line for each quantity; `required` has the required margins by threat, m/s."""
    limit: list[Source] = [phrases.BALLISTIC_LIMIT]
    if (limit_m_s := design.ballistic_limit_m_s) is None:
        limit = [(Column("ballistic limit"), "outside the range")]
    elif (error := design.model_error) is not None:
        limit.append(phrases.with_error(error.median(limit_m_s), error.interval(limit_m_s)))
    stops = phrases.chance(design.probabilities_of_stopping[design.governing], design.model_error)
    threat: list[Source] = [(phrases.STOPPING, stops), MARGIN_BY_MODEL, (REQUIRED, required.get(design.governing))]
    if len(design.margins_m_s) > 1:  # the table of the threats has these of each
        limit, threat = [(GOVERNED_BY, design.governing), *limit], []
    return Table.of_one(
        design,
        (Column("armour", prose=True), armour_in_words(design)),
        AREAL_DENSITY,
        phrases.WHOLE,
        *limit,
        *threat,
        THICKNESS,
        (COST, design.cost_per_m2 or None),
        (OUTSIDE, outside_words(design.outside_tests) if design.model_error is None else ""),
        title=title,
    )


def design_verdict(result: DesignResult) -> list[Table | str]:
    """Return lines on a search without a best design: the nearest design, what it lacks, and why; else none."""
    nearest, unlimited = result.nearest, result.without_limits
    if not result.reason:
        return []
    if nearest is None:
        return [VerdictLine(f"{result.reason}: {result.explanation}", good=False)]
    armour, notes = armour_in_words(nearest), _flow_stress_notes(nearest)
    threats = "every threat" if len(result.threats) > 1 else result.threats[0]
    short = ", ".join(f"{short_words(short)} against {threat}" for threat, short in nearest.short_m_s.items() if short)
    if result.reason == "not known" and not short:
        least = OBJECTIVES[result.minimised].least
        words = f"not known: {armour} is the {least} that stops {threats} by the computed limit"
        return [VerdictLine(words, good=False), *notes, result.explanation]
    unmet = [row for row in nearest.requirements if row.interval and row.verdict != "passes"]
    lacks = "; ".join(filter(None, (short, *map(phrases.requirement_words, unmet))))
    misses = [f"lacks {lacks}"] * bool(lacks) + [f"has {'; '.join(excesses(nearest))}"] * bool(nearest.exceeds)
    explanation = result.explanation
    if unlimited is not None and unlimited.exceeds and (lacks or unlimited.exceeds != nearest.exceeds):
        stops = f"would stop {threats}{BY_LIMIT * (unlimited.model_error is None)}"
        explanation = f"{armour_in_words(unlimited)} {stops}, but has {'; '.join(excesses(unlimited))}"
    known = result.reason if result.reason == "none passes" else "not known, as the limit is too low"
    return [VerdictLine(f"{known}: the nearest, {armour}, {', and '.join(misses)}", good=False), explanation, *notes]


def _greatest(design: BestDesign, field: str) -> str:
    """Return the threat against which a field of `NeededFlowStress` is the greatest; None in it is infinite."""
    return max(design.flow_stress, key=lambda threat: getattr(design.flow_stress[threat], field) or inf, default="")


def _needed(design: BestDesign) -> NeededFlowStress | None:
    """Return what flow stress the untested ceramic of a design needs against the threat that needs the greatest."""
    return design.flow_stress.get(_greatest(design, "needed_GPa"))


def _flow_stress_notes(design: BestDesign) -> list[str]:
    """Return notes on the flow stress that the untested ceramic of a design needs, against the threats that decide.

    They are those for which it is the greatest to stop them, and to stop them with the probability required.
    """
    threats = dict.fromkeys(_greatest(design, field) for field in ("needed_GPa", "needed_for_probability_GPa"))
    shown = []
    for threat in threats:
        stops, *limits = phrases.flow_stress_notes(design.flow_stress.get(threat), threat) or [""]
        shown += [stops, *(f"against {threat}: {note}" if len(threats) > 1 else note for note in limits)]
    return list(filter(None, shown))


def _aligned(table: Table) -> Table:
    """Return a table with the same number of decimals for all thicknesses, no more than needed."""
    aligned = [column in (CERAMIC_THICKNESS, BACKING_THICKNESS, THICKNESS) for column in table.columns]
    texts = [text for row in table.texts() for text in compress(row, aligned)]
    decimals = max((len(text.rstrip("0").partition(".")[2]) for text in texts), default=0)
    columns = zip(table.columns, aligned, strict=True)
    return replace(table, columns=tuple(replace(c, spec=f".{decimals}f") if chosen else c for c, chosen in columns))


def frontier_table(result: DesignResult) -> Table:
    """Tabulate, for each back plate of the best pair, the thinnest ceramic that passes.

    Notes mark the best design and ceramics at the least thickness on offer.
    """
    several = len(result.threats) > 1
    governing = dict(zip(map(_thicknesses, result.frontier), result.frontier_governed_by, strict=True))

    def note(design: Design) -> str:
        marks = [OBJECTIVES[result.minimised].least] if _thicknesses(design) == _thicknesses(_shown(result)) else []
        return ", ".join([*marks, *["least of the range"] * (design.ceramic_thickness_mm == result.ceramic_min_mm)])

    numbers = CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, phrases.WHOLE, _least_margin(result)
    table = Table.of(
        result.frontier,
        *numbers,
        outside_tests(result.frontier),
        (GOVERNED_BY, lambda design: governing[_thicknesses(design)] if several else None),
        (Column("note"), note),
        title=f"{pair_words(_shown(result))}: thinnest ceramic for each back plate" if len(result.pairs) > 1 else "",
    )
    return _aligned(table)


def _least_margin(result: DesignResult) -> Column:
    """Return the column of the least margin over the threats, which need not be that of the governing threat."""
    return (
        replace(MARGIN_BY_MODEL, label=f"least {MARGIN_BY_MODEL.label}") if len(result.threats) > 1 else MARGIN_BY_MODEL
    )


def _around_best(result: DesignResult) -> DesignResult:
    """Return a result whose frontier is cut down to `FRONTIER_ROWS` rows around the best design."""
    places = [_thicknesses(design) for design in result.frontier]
    best = _thicknesses(_shown(result))
    middle = places.index(best) if best in places else 0
    first = max(min(middle - FRONTIER_ROWS // 2, len(places) - FRONTIER_ROWS), 0)
    rows = slice(first, first + FRONTIER_ROWS)
    return replace(result, frontier=result.frontier[rows], frontier_governed_by=result.frontier_governed_by[rows])


def left_out(result: DesignResult) -> str:
    """Return a note on the back plates without a row in the frontier, because no ceramic on them passes."""
    plates = result.without_mm
    ends = dict.fromkeys((f"{plates[0]:g}", f"{plates[-1]:g}"))
    return f"no ceramic passes on {counted(len(plates), 'back plate')}, {' to '.join(ends)} mm"


# The thicknesses, which distinguish a design from others of the same materials.
_thicknesses = attrgetter("ceramic_thickness_mm", "backing_thickness_mm")


def margin_table(result: DesignResult, required: Mapping[str, float]) -> Table:
    """Tabulate, for each threat, the best design's margin and its probabilities of stopping and of perforation.

    `required` has the required margins by threat, m/s.
    """
    best, sampled = _shown(result), Column("probability of perforation by sampling, 95 % interval")
    return Table.of(
        best.margins_m_s,
        (Column("threat", prose=True), str),
        (MARGIN_BY_MODEL, best.margins_m_s.__getitem__),
        (Column("short by", "m/s", ".0f"), lambda threat: best.short_m_s[threat] or None),
        (phrases.STOPPING, lambda threat: phrases.chance(best.probabilities_of_stopping[threat])),
        (REQUIRED, required.get),
        (sampled, lambda threat: phrases.estimated(best.probabilities.get(threat), ".3f")),
        (Column("note"), lambda threat: "governs" if threat == best.governing else ""),
    )


def pair_table(result: DesignResult) -> Table:
    """Tabulate every pair of materials with its best design, or the reason why it has none."""
    numbers = AREAL_DENSITY, THICKNESS, COST, LIMIT_COLUMN, _least_margin(result)
    needed: Source = NEEDED, lambda best: phrases.needed_words(_needed(best))
    outside = outside_tests(best_of_pairs(result))
    table = Table.of(
        result.pairs,
        (Column("armour", prose=True), lambda pair: armour_in_words(pair.best) if pair.best else pair_words(pair)),
        *of_part(attrgetter("best"), *numbers, phrases.WHOLE, needed, outside),
        (Column("result", prose=True), lambda pair: _result(result, pair)),
        title="pairs of materials",
        rest="--json",
    )
    return _aligned(table)


def design_table(designs: Sequence[Design], title: str, margins_m_s: Sequence[Mapping[str, float]] = ()) -> Table:
    """Tabulate designs, such as those of the Pareto front, in a row each.

    `margins_m_s` has, for each design, its margins by threat; they are shown if there are several threats.
    """
    design, margins = itemgetter(0), itemgetter(1)
    threats = [*margins_m_s[0]] if margins_m_s else []
    against = ((Column(f"margin against {threat}", "m/s", "+.0f"), itemgetter(threat)) for threat in threats)
    armour = Column("armour", prose=True), armour_in_words
    table = Table.of(
        zip_longest(designs, margins_m_s),
        *of_part(design, armour, AREAL_DENSITY, THICKNESS, COST, phrases.WHOLE),
        *(of_part(margins, *against) if len(threats) > 1 else of_part(design, MARGIN_BY_MODEL)),
        *of_part(design, outside_tests(designs)),
        title=title,
        rest="--csv FILE",
    )
    return _aligned(table)


def outside_tests(items: Sequence[Any]) -> tuple[Column, Callable[[Any], str]]:
    """Return the column with the quantities in which each item, a design or a threat, lies outside the tests.

    Quantities in which all items lie outside alike are left to `outside_notes`.
    """
    common, is_any = in_common([item.outside_tests for item in items]), any(item.outside_tests for item in items)

    def words(item: Any) -> str:
        own = {key: factor for key, factor in item.outside_tests.items() if key not in common}
        return outside_words(own, most=2) if item.outside_tests or not is_any else "inside"

    return OUTSIDE, words


def best_of_pairs(result: DesignResult) -> list[BestDesign]:
    """Return the best design of each pair of materials that has one."""
    return [pair.best for pair in result.pairs if pair.best is not None]


def pair_notes(result: DesignResult) -> list[str]:
    """Return notes below the table of pairs.

    They give the flow stress that ceramics of a single source need, the quantities in which all pairs lie outside the
    tests, and the caveats of `pair_caveats`.
    """
    best, notes = best_of_pairs(result), []
    for each in best:
        if any(row.quantity == SOURCES for row in each.requirements):
            notes += [f"{armour_in_words(each)} {note}" for note in _flow_stress_notes(each)[:1]]
    notes += outside_notes(best) if len(best) > 1 else []
    return notes + pair_caveats(result)


def pair_caveats(result: DesignResult) -> list[str]:
    """Return the caveats of the model on pairs other than the best, and on comparing metals of different strength."""
    metals = {each.backing for each in best_of_pairs(result) if each.ceramic}
    return phrases.said_of(result.notes, "pairs") + [METALS] * (len(metals) > 1)


def offer_table(result: DesignResult) -> Table:
    """Tabulate all designs on offer or, if the result does not keep them, the best of each pair."""
    if result.every:
        return design_table(result.every, "designs on offer", result.margins_of_every_m_s)
    best = best_of_pairs(result)
    return design_table(best, "best of each pair", [each.margins_m_s for each in best])


def in_common(every: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the quantities in which all of several designs lie outside the tests by the same factor."""
    first, *others = every or [{}]
    return {key: factor for key, factor in first.items() if all(each.get(key) == factor for each in others)}


def outside_notes(items: Sequence[Any]) -> list[str]:
    """Return a note on the quantities in which all items, designs or threats, lie outside the tests, if any."""
    common = outside_words(in_common([item.outside_tests for item in items]))
    return [f"{'all lie ' * (len(items) > 1)}outside the tests in {common}"] if common else []


def thin_designs(designs: Iterable[Design], scenario: Scenario | None) -> list[str]:
    """Return notes on the least ceramic thickness tested, if any design is thinner: of the one that lacks the most."""
    thin = [design for design in designs if design.outside_tests.get(THIN, 1.0) < 1.0]
    if not thin or scenario is None:
        return []
    most = max(thin, key=lambda design: design.ceramic_thickness_mm / design.outside_tests[THIN])
    layers = {"ceramic": most.ceramic, "backing": most.backing}
    layers |= {f"{role}_thickness_mm": getattr(most, f"{role}_thickness_mm") for role in layers}
    armour = scenario.replaced({f"armour.{key}": value for key, value in layers.items()})
    notes = threat_warnings(armour, armours_of(*map(armour.against, armour.threats())))
    return [note.text for note in notes if note.about[:1] == (TOO_THIN,)]


def _result(result: DesignResult, pair: Pair) -> str:
    """Return why the best design of a pair is not the best of all or, if it is, in which sense."""
    if pair.reason or pair.best is None:
        return pair.reason
    least = OBJECTIVES[result.minimised].least
    return least if result.best is not None and pair.best.model_error is not None else f"{least} by the computed limit"


def design_csv(result: DesignResult) -> str:
    """Format designs as CSV: the Pareto front; without one, the frontier; without either, every design kept."""
    untested: Source = Column("tests", key="untested"), lambda design: "untested" if design.untested else ""
    numbers = CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST, MARGIN_BY_MODEL
    outside: Source = OUTSIDE, lambda design: outside_words(design.outside_tests)
    designs = result.pareto or result.frontier or result.every
    return csv_text(Table.of(designs, Column.of("ceramic"), untested, Column.of("backing"), *numbers, outside))


def _shown(result: DesignResult) -> BestDesign:
    """Return the best design or, without one, the nearest; the result must have either."""
    assert result.shown is not None
    return result.shown


@tables_of.register
def tables_of_design(result: DesignResult) -> list[Table | str]:
    """Return the best design of a search, its frontier or a row for each pair of materials, and the Pareto front."""
    scenario: Scenario | None = result.question.get("scenario")
    required, best, named = required_margins(scenario), result.shown, list[Design](best_of_pairs(result))
    shown: list[Table | str] = [*design_verdict(result), *phrases.said_of(result.notes)]
    if best is not None:
        answer = None if scenario is None or best.model_error is not None else _answer(scenario, best)
        error = [] if result.reason == "not known" else [phrases.error_note(best.model_error, answer)]
        notes = [] if result.reason else _flow_stress_notes(best)
        exists = [EXISTS] if best.whole_thickness_mm != best.thickness_mm else []
        shown += [best_table(best, required), *exists, *error, *notes, *margin_notes(best)]
    if result.refined is not None:
        objective = OBJECTIVES[result.minimised]
        none = f"no {objective.less} design was found between the values of the grid"
        title = f"{objective.least} design between the values of the grid"
        shown.append(none if result.refined == best else best_table(result.refined, required, title))
    if best is not None and (len(result.threats) > 1 or best.probabilities):
        shown.append(margin_table(result, required))
    verbose = result.question.get("every_row")
    if len(result.pairs) > 1 or not all(pair.ranked for pair in result.pairs):
        shown.append(pair_table(result))
        shown += pair_notes(result)
    if result.every and (verbose or result.reason):
        shown += [offer_table(result), *outside_notes(result.every)]
        named += result.every
    if result.frontier and (len(result.pairs) == 1 or verbose):
        part = result if verbose else _around_best(result)
        shown += [frontier_table(part), *outside_notes(part.frontier)]
        named += part.frontier
        more = len(result.frontier) - len(part.frontier)
        shown += [f"{more} more back plates with -v"] if more else []
        shown += [left_out(result)] if result.without_mm else []
    if result.pareto:
        shown += [design_table(result.pareto, "Pareto front"), *outside_notes(result.pareto)]
    is_said = best is not None and best.outside_tests.get(THIN, 1.0) < 1.0
    thin = [] if is_said else thin_designs([*named, *result.pareto], scenario)
    return [*shown, *thin, *phrases.threat_notes(scenario), f"{counted(result.designs, 'design')} computed"]


def _answer(scenario: Scenario, best: BestDesign) -> Scenario:
    """Return the scenario with the best design as its armour and the governing threat as its impact."""
    [governing] = [threat for threat in scenario.threats() if threat.title == best.governing]
    return scenario.replaced(best.changes_to(scenario)).against(governing)


def margin_notes(best: BestDesign) -> list[str]:
    """Return a note on how likely perforation of the best design is, if its probability of stopping is low."""
    least = min((p for p in best.probabilities_of_stopping.values() if p is not None), default=1.0)
    ask = "" if any(row.quantity == "probability_of_stopping" for row in best.requirements) else f"; {ASK}"
    return [f"perforated with a probability of {phrases.risk(least)}{ask}"] if least < LOW else []


# Columns of the objectives by key, with more digits than in the tables above, so that close designs differ.
OBJECTIVE_SPECS = {AREAL_DENSITY: ".2f", THICKNESS: ".5g", COST: ".2f", MARGIN_BY_MODEL: "+.1f"}
OBJECTIVE_WORDS = {column.key: replace(column, spec=spec) for column, spec in OBJECTIVE_SPECS.items()}


def design_title(result: DesignResult) -> str:
    """Return the best design in a line, with its probability of stopping; without one, the verdict of the search."""
    if result.reason:
        words = str(design_verdict(result)[0])
        return words[:1].upper() + words[1:]
    best = _shown(result)
    probability = least_probability(best)
    stops = "" if probability is None else f", stops with {phrases.chance(probability)}"
    value = OBJECTIVE_WORDS[result.minimised].with_unit(getattr(best, result.minimised))
    value = f"cost {value} per m²" if result.minimised == COST.key else value
    return f"{OBJECTIVES[result.minimised].least.capitalize()}: {armour_in_words(best)}, {value}{stops}"


def least_probability(design: BestDesign) -> float | None:
    """Return the least probability of stopping of a design over its threats; None if any is unknown."""
    probabilities = design.probabilities_of_stopping.values()
    return None if None in probabilities else min(p for p in probabilities if p is not None)


def pair_words(design: Design | Pair) -> str:
    """Return the materials of a design, such as "AD85 on 6061-T6"."""
    return f"{design.ceramic} on {design.backing}" if design.ceramic else design.backing


PROBABILITY = Column("probability", prose=True)
INTERVAL = Column("95 % interval", "m/s", prose=True)
MARGIN = Column.of("margin_m_s", "+.0f")
# Verdicts as shown; "fails" is in capitals so that nobody overlooks it.
NONE_REQUIRED = "no probability is required"
VERDICTS = {"passes": "passes", "fails": "FAILS", "not known": "not known"}


def required(threat: CheckedThreat) -> str:
    """Return what is required of an armour against a threat, such as "at least 95 % and a margin of 20 m/s"."""
    margin = f" and a margin of {threat.required_margin_m_s:g} m/s" if threat.required_margin_m_s else ""
    if threat.required_probability is not None:
        return f"at least {percent(threat.required_probability)}{margin}"
    return f"{threat.velocity_m_s:g} m/s{margin}"


def finding(threat: CheckedThreat) -> str:
    """Return what an armour achieves against a threat, its probability of stopping or ballistic limit, and the aim."""
    limit, needed = threat.ballistic_limit_m_s, threat.velocity_m_s + threat.required_margin_m_s
    by_model = "no ballistic limit found" if limit is None else f"ballistic limit by the model {limit:.0f} m/s"
    rows = threat.requirements
    if rows and rows[0].quantity == METAL:
        return phrases.requirement_words(rows[0])
    words = [phrases.requirement_words(row) for row in rows if row.verdict == threat.verdict]
    if threat.required_probability is None:
        probability = phrases.chance(threat.probability_of_stopping, threat.model_error)
        words = [phrases.requirement_words(row) for row in rows if row.quantity != "margin_m_s"]
        words.insert(0, f"{by_model}, {required(threat)} required; probability {probability}")
    elif threat.probability_of_stopping is None:
        words.append(f"{by_model}, {needed:g} m/s required")
    failing = [row.quantity for row in rows if row.verdict == "fails"]
    if limit is not None and limit >= needed and "margin_m_s" in failing:
        words.append(f"perforated at {needed:g} m/s, within the tolerance of the limit")
    return "; ".join(words)


def requirement_table(result: CheckResult) -> Table:
    """Tabulate all requirements on an armour, with what it has and the verdict on each."""
    rows = []
    for row in requirements_of(result):
        name, asked, found = phrases.requirement_parts(row)
        by_limit = row.quantity == "probability_of_stopping" and row.found is None and row.verdict == "fails"
        found += ", and the limit does not suffice" * by_limit
        rows.append((name, row.threat if len(result.threats) > 1 else "", asked, found, VERDICTS[row.verdict]))
    words = (Column(label, prose=True) for label in ("required", "against"))
    return Table.of_rows([*words, *map(Column, ("asked for", "found", "verdict"))], rows)


def requirements_of(result: CheckResult) -> list[Requirement]:
    """Return the requirements on an armour against each threat, and then those against none."""
    return [row for threat in result.threats for row in threat.requirements] + list(result.requirements)


def threat_table(result: CheckResult) -> Table:
    """Tabulate the threats: ballistic limit with its interval, margin, probability of stopping and verdict."""
    return Table.of(
        result.threats,
        Column.of("threat", prose=True),
        LIMIT_COLUMN,
        (replace(INTERVAL, label="interval"), lambda threat: interval(threat.interval_m_s, ".0f")),
        MARGIN,
        (PROBABILITY, lambda threat: phrases.chance(threat.probability_of_stopping, threat.model_error)),
        (Column("verdict"), lambda threat: VERDICTS[threat.verdict]),
        outside_tests(result.threats),
    )


def what_if_tables(threat: CheckedThreat, title: str) -> list[Table]:
    """Return a table of what changes to the armour do: probabilities of stopping or, if unknown, margins.

    The first row is the armour as given.  If no velocity perforates the armour, changed or not, there is no table.
    """
    as_given = threat.as_given()
    is_known, rows = as_given.probability_of_stopping is not None, []
    for each in (as_given, *threat.what_ifs):
        limit, ends = each.ballistic_limit_m_s, interval(each.interval_m_s, ".0f")
        margin = None if is_known or limit is None else limit - each.velocity_m_s
        rows.append((each.change, limit, ends, margin, phrases.chance(each.probability_of_stopping) * is_known))
    table = Table.of_rows((Column("if", prose=True), LIMIT_COLUMN, INTERVAL, MARGIN, PROBABILITY), rows, title)
    return [table] if len(table.columns) > 1 else []


def outcome(result: CheckResult) -> str:
    """Return the verdict on an armour in a line, with the requirements not met and the caveats of the model."""
    unknown = phrases.said_of(result.notes, "not known") * (len(result.threats) > 1)
    return "; ".join([_outcome(result), *unknown, *phrases.said_of(result.notes)])


def _outcome(result: CheckResult) -> str:
    """Return the verdict on an armour with the requirements not met, without caveats."""
    unmet = [row for row in result.requirements if row.verdict != "passes"]
    words = [*map(phrases.requirement_words, sorted(unmet, key=lambda row: row.verdict != "fails"))]
    if len(result.threats) == 1:
        [threat] = result.threats
        words += [] if words and threat.verdict == "passes" else [finding(threat)]
        return f"{VERDICTS[result.verdict]}: {'; '.join(words)}"
    if result.verdict == "passes":
        by_model = all(threat.required_probability is None for threat in result.threats)
        return f"passes against every threat{' by the computed limit' if by_model else ''}"
    missed = {
        verdict: f"{VERDICTS[verdict]} against {joined(names)}"
        for verdict in ("fails", "not known")
        if (names := [threat.threat for threat in result.threats if threat.verdict == verdict])
    }
    if result.verdict in missed:
        return "; ".join([*missed.values(), *words])
    return f"{VERDICTS[result.verdict]}: {'; '.join([*words, *missed.values()])}"


def standing(threat: CheckedThreat) -> tuple[int, float, float]:
    """Return a sort key that puts the threats most likely to perforate first, and among equals the least margin.

    A threat of unknown probability comes first if its margin is less than required, and last otherwise.
    """
    unlimited = -inf if threat.verdict == "fails" else inf
    margin = unlimited if threat.margin_m_s is None else threat.margin_m_s - threat.required_margin_m_s
    if threat.probability_of_stopping is not None:
        return 1, threat.probability_of_stopping, margin
    return (0 if margin < 0.0 else 2), margin, 0.0


def amounts(result: CheckResult) -> str:
    """Return areal density, thickness and cost of an armour in a line.

    If the back plate exists already, give the first two also with it.
    """
    cost = f", cost {COST.text(result.cost_per_m2)} per m²" if result.cost_per_m2 else ""
    words = f"{AREAL_DENSITY.text(result.areal_density_kg_m2)} kg/m², {round(result.thickness_mm, 3):g} mm thick{cost}"
    if result.whole_thickness_mm == result.thickness_mm:
        return words
    whole = f"{AREAL_DENSITY.text(result.whole_areal_density_kg_m2)} kg/m², {round(result.whole_thickness_mm, 3):g} mm"
    return f"{words}, without the back plate, which exists; {whole} with it"


def layer_words(layers: Sequence[InertLayer]) -> list[str]:
    """Return a phrase for each layer without ballistic effect: its name, place, thickness and areal density."""
    words = []
    for layer in layers:
        amounts = ((layer.thickness_mm, "mm"), (layer.areal_density_kg_m2, "kg/m²"))
        if said := " and ".join(f"{value:g} {unit}" for value, unit in amounts if value):
            words.append(f"{layer.name}, {PLACES[layer.place]}: {said}" if layer.name else f"{said} {UNNAMED}")
    return words


@tables_of.register
def tables_of_check(result: CheckResult) -> list[Table | str]:
    """Return the verdict, the threats and the requirements, and what changes to the armour do.

    The changes are for the threat most likely to perforate or, with `every_row` in the question, for each.
    """
    several = len(result.threats) > 1
    scenario = result.question["scenario"]
    shown: list[Table | str] = [VerdictLine(outcome(result), good=result.verdict == "passes"), amounts(result)]
    shown += [*layer_words(scenario.armour.layer), threat_table(result)]
    shown += [*outside_notes(result.threats), *phrases.threat_notes(scenario)]
    if len(requirements_of(result)) > len(result.threats):
        shown.append(requirement_table(result))
    explained = result.threats if result.question.get("every_row") else (min(result.threats, key=standing),)
    for threat in explained:
        against = f"against {threat.threat}"
        shown += [f"{against}: {note}" if several else note for note in phrases.basis_notes(threat)]
        exact = ", with exact inputs" if threat.sampled else ""
        shown += what_if_tables(threat, f"with a change{exact}{f', {against}' if several else ''}")
    if len(explained) < len(result.threats):
        shown.append("changes against the other threats with -v")
    return shown


def check_report(answers: Sequence[tuple[Scenario, CheckResult]], moved: Sequence[Table | str]) -> Report:
    """Return a short report on checked armours, as for the summary of a CI run.

    `moved` has the tables of what moved since an earlier check.
    """
    rows, caveats = [], list[tuple[str, str]]()
    for scenario, result in answers:
        parts = [(threat.threat, threat.verdict, finding(threat)) for threat in result.threats]
        parts += [("", row.verdict, phrases.requirement_words(row)) for row in result.requirements]
        rows += [(scenario.file, threat, VERDICTS[verdict], words) for threat, verdict, words in parts]
        caveats += [(scenario.file, text) for text in phrases.said_of(result.notes)]
    columns = [Column(label, prose=True) for label in ("scenario", "threat", "verdict", "why")]
    sections = [ReportSection("Armours", tables=(Table.of_rows(columns, rows),), notes=tuple(caveats))]
    texts, tables = (
        [text for text in moved if isinstance(text, str)],
        [each for each in moved if isinstance(each, Table)],
    )
    sections += [ReportSection("Since the earlier check", tuple(texts), tables=tuple(tables))] if moved else []
    summary = check_summary({scenario.file: result for scenario, result in answers})
    return Report("Check of armour", summary, tuple(sections), passed=summary.good)


def tables_of_moved(moves: Sequence[Moved], base: str) -> list[Table | str]:
    """Return what has moved since an earlier check, in the file `base`, and which of it is weaker."""
    if not moves:
        return [f"nothing has moved since {base}"]
    table = Table.of(
        moves,
        (Column("scenario", prose=True), lambda move: move.scenario),
        (Column("threat", prose=True), lambda move: move.threat),
        (Column("what", prose=True), lambda move: quantity_words(move.quantity)),
        (Column("before"), lambda move: _moved_value(move.quantity, move.before)),
        (Column("now"), lambda move: _moved_value(move.quantity, move.now)),
        (Column("so"), lambda move: "weaker" * move.weaker),
        title=f"moved since {base}",
    )
    weaker = sum(move.weaker for move in moves)
    verdict = VerdictLine(f"weaker than in {base}: {weaker} of {len(moves)} that moved", good=False)
    return [table, *[verdict] * bool(weaker)]


def moved_junit(moves: Sequence[Moved], base: str, origin: Mapping[str, str]) -> Element:
    """Return the JUnit element of a comparison with an earlier check: a failure for each part that is weaker."""
    cases = [
        TestCase(
            move.scenario,
            " ".join(filter(None, (move.threat, quantity_words(move.quantity)))),
            "failure",
            f"weaker: {_moved_value(move.quantity, move.before)} before, {_moved_value(move.quantity, move.now)} now",
            file=move.scenario,
        )
        for move in moves
        if move.weaker
    ]
    return junit_suite(f"against {base}", cases or [TestCase(base, "nothing is weaker", "", "")], 0.0, origin)


def quantity_words(quantity: str) -> str:
    """Return a quantity that moved in words; the key of a section, or of an entry of the library, as it is."""
    return quantity if "." in quantity else Column.of(quantity).heading


def _moved_value(quantity: str, value: float | str | None) -> str:
    """Format a value that moved."""
    if value is None:
        return "none" if quantity.startswith("required") else "unknown"
    if isinstance(value, str):
        return VERDICTS.get(value, value)
    return phrases.chance(value) if "probability" in quantity else f"{value:.6g}"


def check_summary(results: Mapping[str, CheckResult]) -> VerdictLine:
    """Return a line with how many of several armours pass, and which do not; `results` has their checks by file."""
    words = [f"passes: {sum(result.verdict == 'passes' for result in results.values())} of {len(results)}"]
    for missed in ("fails", "not known"):
        if files := [file for file, result in results.items() if result.verdict == missed]:
            words.append(f"{VERDICTS[missed]}: {', '.join(files)}")
    return VerdictLine("; ".join(words), good=len(words) == 1)


def check_junit(result: CheckResult, scenario: Scenario, seconds: float, origin: Mapping[str, str]) -> Element:
    """Return the JUnit element of a check, with a test case for each threat and each limit of [design].

    A threat that holds is skipped if no probability is required, as the model's limit alone does not pass a test.  The
    output of a case has its numbers and the caveats about the armour against its threat.  Names of cases do not contain
    thicknesses, velocities or angles.  `seconds` is the time of the whole check.
    """
    file, parts = scenario.file, list[tuple[str, str, str, list[str]]]()
    for threat, given in zip(result.threats, scenario.threats(), strict=True):
        armours = armours_of(scenario.against(given))
        notes = [*scenario.floors, *(note for note, _ in limits_of_model(armours, [armours.materials[0].backing]))]
        holds = "passed" if threat.required_probability is not None else "skipped"
        found = holds if threat.verdict == "passes" else "failure"
        words = f"{VERDICTS[threat.verdict]}: {finding(threat)}" + f"; {NONE_REQUIRED}" * (found == "skipped")
        parts.append((threat.name, found, words, phrases.said_of(notes)))
    for row in result.requirements:
        words = f"{VERDICTS[row.verdict]}: {phrases.requirement_words(row)}"
        parts.append((Column.of(row.quantity).label, "passed" if row.verdict == "passes" else "failure", words, []))
    cases = [
        TestCase(file, title, found.removeprefix("passed"), words, file=file, output=[words, *caveats])
        for title, found, words, caveats in parts
    ]
    return junit_suite(file, [cases[0]._replace(seconds=seconds), *cases[1:]], seconds, origin)
