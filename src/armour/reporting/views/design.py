"""Tables of design searches, and of checks of one armour against each of its threats."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import compress
from math import inf
from operator import attrgetter, itemgetter
from typing import Any
from xml.etree.ElementTree import Element

from armour.analysis.ballistic_limit import NeededFlowStress
from armour.analysis.variants import outside_words
from armour.design.against import Moved
from armour.design.check import CheckedThreat, CheckResult
from armour.design.optimise import BestDesign, Design, DesignOfFront, DesignResult, Pair, armour_in_words
from armour.errors import counted, joined
from armour.evidence.tests import THIN, TOO_THIN, armours_of, threat_warnings
from armour.reporting import words as phrases
from armour.reporting.by_result import in_a_line, line_of, tables_of
from armour.reporting.junit import TestCase, junit_suite
from armour.reporting.report import Report, ReportSection, section_of
from armour.reporting.table import Column, Source, Table, VerdictLine, csv_text, interval, of_part, percent
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES, DesignSection, InertLayer

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
# Words of the reasons why there is no best design.
NONE = {"none passes": "none passes; the nearest", "not known": "none is known to pass; the nearest"}


def _needed(design: BestDesign) -> NeededFlowStress | None:
    """Return what flow stress the untested ceramic of a design needs against the threat that needs the greatest."""
    return max(design.flow_stress.values(), key=lambda needed: needed.needed_GPa or inf, default=None)


def _aligned(table: Table) -> Table:
    """Return a table with the same number of decimals for all thicknesses, no more than needed."""
    aligned = [column in (CERAMIC_THICKNESS, BACKING_THICKNESS, THICKNESS) for column in table.columns]
    texts = [text for row in table.texts() for text in compress(row, aligned)]
    decimals = max((len(text.rstrip("0").partition(".")[2]) for text in texts), default=0)
    columns = zip(table.columns, aligned, strict=True)
    return replace(table, columns=tuple(replace(c, spec=f".{decimals}f") if chosen else c for c, chosen in columns))


def frontier_table(result: DesignResult, rows: slice) -> Table:
    """Tabulate, for some back plates of the best pair, the thinnest ceramic that passes.

    Notes mark the best design and ceramics at the least thickness on offer.
    """
    designs, governing = result.frontier[rows], result.frontier_governed_by[rows]

    def note(design: Design) -> str:
        marks = [OBJECTIVES[result.minimised].least] if layers_of(design) == layers_of(result.shown) else []
        return ", ".join([*marks, *["least of the range"] * (design.ceramic_thickness_mm == result.ceramic_min_mm)])

    numbers = CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, phrases.WHOLE
    table = Table.of(
        zip(designs, governing, strict=True),
        *of_part(itemgetter(0), *numbers, outside_tests(designs)),
        *[(GOVERNED_BY, itemgetter(1))] * (len(result.threats) > 1),
        *of_part(itemgetter(0), (Column("note"), note)),
        title=f"{pair_words(result.shown)}: thinnest ceramic for each back plate" if len(result.pairs) > 1 else "",
    )
    return _aligned(table)


def _around_best(result: DesignResult) -> slice:
    """Return the `FRONTIER_ROWS` rows of the frontier around the best design."""
    places, best = [*map(layers_of, result.frontier)], layers_of(result.shown)
    middle = places.index(best) if best in places else 0
    first = max(min(middle - FRONTIER_ROWS // 2, len(places) - FRONTIER_ROWS), 0)
    return slice(first, first + FRONTIER_ROWS)


def left_out(result: DesignResult) -> str:
    """Return a note on the back plates without a row in the frontier, because no ceramic on them passes."""
    plates = result.without_mm
    ends = dict.fromkeys((f"{plates[0]:g}", f"{plates[-1]:g}"))
    return f"no ceramic passes on {counted(len(plates), 'back plate')}, {' to '.join(ends)} mm"


# The layers, which distinguish a design from others.
layers_of = attrgetter("ceramic", "backing", "ceramic_thickness_mm", "backing_thickness_mm")


def pair_table(result: DesignResult) -> Table:
    """Tabulate every pair of materials with its best design or, without one, the nearest."""
    designs = [pair.best or pair.nearest for pair in result.pairs]
    numbers = AREAL_DENSITY, THICKNESS, COST, LIMIT_COLUMN, phrases.WHOLE
    needed: Source = NEEDED, lambda design: phrases.needed_words(_needed(design))
    table = Table.of(
        zip(result.pairs, designs, strict=True),
        (Column("armour", prose=True), lambda row: armour_in_words(row[1]) if row[1] else pair_words(row[0])),
        *of_part(itemgetter(1), *numbers, needed, outside_tests([*filter(None, designs)])),
        (Column("result", prose=True), lambda row: _result(result, row[0])),
        title="pairs of materials",
        rest="--json",
    )
    return _aligned(table)


def front_table(designs: Sequence[DesignOfFront]) -> Table:
    """Tabulate the designs of a Pareto front."""
    armour = Column("armour", prose=True), armour_in_words
    columns = armour, AREAL_DENSITY, THICKNESS, COST, phrases.WHOLE, MARGIN_BY_MODEL, outside_tests(designs)
    return _aligned(Table.of(designs, *columns, title="Pareto front", rest="--csv FILE"))


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


def pair_caveats(result: DesignResult) -> list[str]:
    """Return the caveats of the model on pairs other than the best, and on comparing metals of different strength."""
    metals = {each.backing for each in best_of_pairs(result) if each.ceramic}
    return phrases.said_of(result.notes, "pairs") + [METALS] * (len(metals) > 1)


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
    """Return how the best design of a pair compares with the best of all or, without one, what the nearest lacks."""
    objective, scenario = OBJECTIVES[result.minimised], result.question.get("scenario")
    section = (scenario and scenario.design) or DesignSection()
    if pair.best is None:
        within = f"none within {section.runners_up_percent:g} % of the best passes"
        return within if pair.nearest is None else _outcome(pair.nearest.check)
    excess, words = pair.excess_percent, objective.least
    if excess is None:
        words = objective.more
    elif excess:
        is_close = pair.ranked and excess <= section.runners_up_percent
        words = "runner-up: " * is_close + f"{abs(excess):.1f} % {objective.more if excess > 0.0 else objective.less}"
    elif result.reason or pair.best.model_error is None:
        words += " by the computed limit"
    lacks = any(row.quantity == SOURCES for row in pair.best.requirements)
    reason = "" if pair.ranked else "fewer than two sources of its flow stress: " if lacks else "no test: "
    return reason + words


def design_csv(result: DesignResult) -> str:
    """Format designs as CSV: the Pareto front; without one, the frontier."""
    untested: Source = Column("tests", key="untested"), lambda design: "untested" if design.untested else ""
    numbers = CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST
    margin = [MARGIN_BY_MODEL] * bool(result.pareto)
    outside: Source = OUTSIDE, lambda design: outside_words(design.outside_tests)
    designs = result.pareto or result.frontier
    return csv_text(Table.of(designs, Column.of("ceramic"), untested, Column.of("backing"), *numbers, *margin, outside))


@tables_of.register
def tables_of_design(result: DesignResult) -> list[Table | str]:
    """Return the lines of the check of the best design, and then what only a search knows, see `tables_of_search`."""
    result.shown.check.of(every_row=result.question.get("every_row"))
    _, *checked = tables_of_check(result.shown.check)
    return [VerdictLine(in_a_line(result), good=not result.reason), *checked, *tables_of_search(result)]


def tables_of_search(result: DesignResult) -> list[Table | str]:
    """Return the frontier or a row for each pair of materials, and the Pareto front."""
    shown, verbose = list[Table | str](), result.question.get("every_row")
    named: list[Design] = [*best_of_pairs(result), *result.pareto]
    if len(result.pairs) > 1 or not all(pair.ranked for pair in result.pairs):
        best = best_of_pairs(result)
        shown += [pair_table(result), *(outside_notes(best) if len(best) > 1 else ()), *pair_caveats(result)]
    if result.frontier and (len(result.pairs) == 1 or verbose):
        rows = slice(None) if verbose else _around_best(result)
        part = result.frontier[rows]
        shown += [frontier_table(result, rows), *outside_notes(part)]
        named += part
        more = len(result.frontier) - len(part)
        shown += [f"{more} more back plates with -v"] if more else []
        shown += [left_out(result)] if result.without_mm else []
    if result.pareto:
        shown += [front_table(result.pareto), *(note for note in outside_notes(result.pareto) if note not in shown)]
    is_said = result.shown.outside_tests.get(THIN, 1.0) < 1.0
    thin = [] if is_said else thin_designs(named, result.question.get("scenario"))
    return [*shown, *thin, f"{counted(result.designs, 'design')} computed"]


# Columns of the objectives by key, with more digits than in the tables above, so that close designs differ.
OBJECTIVE_SPECS = {AREAL_DENSITY: ".2f", THICKNESS: ".5g", COST: ".2f", MARGIN_BY_MODEL: "+.1f"}
OBJECTIVE_WORDS = {column.key: replace(column, spec=spec) for column, spec in OBJECTIVE_SPECS.items()}


@line_of.register
def design_in_a_line(result: DesignResult) -> str:
    """Return the best design or, without one, the nearest in a line, with the verdict on it."""
    shown, objective = result.shown, OBJECTIVES[result.minimised]
    value = OBJECTIVE_WORDS[result.minimised].with_unit(getattr(shown, result.minimised))
    value = f"cost {value} per m²" if result.minimised == COST.key else value
    name = NONE[result.reason] if result.reason else objective.least
    return f"{name}: {armour_in_words(shown)}, {value}; {in_a_line(shown.check)}"


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
    """Return what an armour achieves against a threat, its probability of stopping or ballistic limit, and the aim.

    Where the verdict is "not known", end with the reason.
    """
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
    return "; ".join([*words, *[threat.reason] * says_reason(threat)])


def says_reason(threat: CheckedThreat) -> bool:
    """Return whether the verdict on an armour against a threat is "not known" as its probability is unknown."""
    unknown = (row.found is None and row.verdict == "not known" for row in threat.requirements)
    return threat.verdict == "not known" and any(unknown)


def requirement_table(result: CheckResult) -> Table:
    """Tabulate all requirements on an armour, with what it has and the verdict on each."""
    rows = []
    for row in result.all_requirements():
        name, asked, found = phrases.requirement_parts(row)
        by_limit = row.quantity == "probability_of_stopping" and row.found is None and row.verdict == "fails"
        found += ", and the limit does not suffice" * by_limit
        rows.append((name, row.threat if len(result.threats) > 1 else "", asked, found, VERDICTS[row.verdict]))
    words = (Column(label, prose=True) for label in ("required", "against"))
    return Table.of_rows([*words, *map(Column, ("asked for", "found", "verdict"))], rows)


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


@line_of.register
def check_in_a_line(result: CheckResult) -> str:
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
    missed = {}
    for verdict in ("fails", "not known"):
        if threats := [threat for threat in result.threats if threat.verdict == verdict]:
            reasons = "; ".join(dict.fromkeys(threat.reason for threat in threats if says_reason(threat)))
            against = f"{VERDICTS[verdict]} against {joined([threat.threat for threat in threats])}"
            missed[verdict] = ": ".join(filter(None, (against, reasons)))
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
    shown: list[Table | str] = [VerdictLine(in_a_line(result), good=result.verdict == "passes"), amounts(result)]
    shown += [*layer_words(scenario.armour.layer), threat_table(result)]
    shown += [*outside_notes(result.threats), *phrases.threat_notes(scenario)]
    if len(result.all_requirements()) > len(result.threats):
        shown.append(requirement_table(result))
    explained = result.threats if result.question.get("every_row") else (min(result.threats, key=standing),)
    for threat in explained:
        against = f"against {threat.threat}"
        notes = phrases.basis_notes(threat)[says_reason(threat) :]
        shown += [f"{against}: {note}" if several else note for note in notes]
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
    sections += [section_of("Since the earlier check", moved)] if moved else []
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
    output of a case has its numbers and the caveats about the armour.  Names of cases do not contain thicknesses,
    velocities or angles.  `seconds` is the time of the whole check.
    """
    file, cases, caveats = scenario.file, list[TestCase](), phrases.said_of(result.notes)
    for threat in result.threats:
        holds = "" if threat.required_probability is not None else "skipped"
        found = holds if threat.verdict == "passes" else "failure"
        words = f"{VERDICTS[threat.verdict]}: {finding(threat)}" + f"; {NONE_REQUIRED}" * (found == "skipped")
        cases.append(TestCase(file, threat.name, found, words, file=file, output=[words, *caveats]))
    for row in result.requirements:
        words, title = f"{VERDICTS[row.verdict]}: {phrases.requirement_words(row)}", Column.of(row.quantity).label
        found = "" if row.verdict == "passes" else "failure"
        cases.append(TestCase(file, title, found, words, file=file, output=[words]))
    return junit_suite(file, [cases[0]._replace(seconds=seconds), *cases[1:]], seconds, origin)
