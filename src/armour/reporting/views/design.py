"""Answers on armours: a verdict in a line, and the facts that it rests on; the details are for -v."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from operator import attrgetter
from typing import Any
from xml.etree.ElementTree import Element

from armour.design.against import Moved
from armour.design.catalogue import MARGIN_COLUMN, catalogue_of
from armour.design.check import USUAL_PROBABILITY, CheckedThreat, CheckResult, deciding, shown_limit, what_tells
from armour.design.optimise import Design, DesignResult, Pair, armour_in_words
from armour.design.requirements import GOOD, VERDICTS, Verdict
from armour.errors import InputError, counted
from armour.reporting import words as phrases
from armour.reporting.by_result import in_a_line, line_of, tables_of
from armour.reporting.junit import TestCase, junit_suite
from armour.reporting.report import Report, ReportSection, section_of
from armour.reporting.table import Column, Source, Table, VerdictLine, beside, csv_text, interval, of_part, percent
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES

AREAL_DENSITY, COST = Column.of("areal_density_kg_m2"), Column.of("cost_per_m2", ".0f")
THICKNESS = Column.of("thickness_mm", ".4g", "total thickness")
CERAMIC_THICKNESS, BACKING_THICKNESS = (Column.of(f"{layer}_thickness_mm", ".3f") for layer in ("ceramic", "backing"))
MARGIN = Column.of("margin_m_s", "+.0f", "least margin")
OBJECTIVE_WORDS = {column.key: column for column in (AREAL_DENSITY, THICKNESS, COST, MARGIN)}
FAR: Source = (
    Column("far from the tests", prose=True, key="far_from_tests"),
    lambda design: ", ".join(design.far_from_tests),
)
LIMIT, STOPS, VERDICT = Column("limit, m/s", prose=True), Column("stops", prose=True), Column("verdict", prose=True)
# Designs within 1 % of the best that a line names.
MOST_NAMED = 3
BY_MODEL = "* by the model, without tests"
METALS = "do not compare metals of different strength: the model exaggerates it"


def verdict_word(verdict: Verdict) -> str:
    """Return a verdict as it is shown: FAILS is in capitals so that nobody overlooks it."""
    return "FAILS" if verdict == "fails" else verdict


def verdict_cell(result: CheckResult) -> str:
    """Return the verdict on an armour, with the number of sources if it is not known as its flow stress has too few."""
    lacking = [each for each in deciding(result).requirements if each.quantity == "flow_stress_sources"]
    sources = f", {counted(int(lacking[0].found or 0), 'source')}" if lacking and result.verdict == "not known" else ""
    return verdict_word(result.verdict) + sources


def _names_its_speed(threat: CheckedThreat) -> bool:
    """Return whether a threat is called by its projectile and velocity, for want of another name."""
    return threat.name == threat.projectile != threat.threat


def at_speed(threat: CheckedThreat) -> str:
    """Return the name of a threat with its velocity."""
    return threat.threat if _names_its_speed(threat) else f"{threat.threat} at {threat.velocity_m_s:g} m/s"


def without_speed(threat: CheckedThreat) -> str:
    """Return the name of a threat without its velocity, but with its angle."""
    angle = f", {threat.obliquity_deg:g}° obliquity" if threat.obliquity_deg else ""
    return threat.name + angle if _names_its_speed(threat) else threat.threat


def limit_text(threat: CheckedThreat) -> str:
    """Format the expected limit or, where no tests tell, that by the model, m/s; see `beside` for the rounding."""
    shown = shown_limit(threat.ballistic_limit_m_s, threat.expected_limit_m_s)
    return "none found" if shown is None else beside(shown, threat.velocity_m_s + threat.required_margin_m_s, 0)


def chance_text(threat: CheckedThreat, *notes: str) -> str:
    """Format the probability of stopping a shot, as exact as the one required, with its interval if sampled.

    This and the `notes` stand in one bracket.
    """
    words = phrases.chance(threat.probability_of_stopping, threat.model_error, threat.required_probability)
    if threat.sampled is not None and threat.probability_of_stopping is not None:
        ends = 1.0 - threat.sampled.high, 1.0 - threat.sampled.low
        value, low, high = phrases.sampled_percents(threat.probability_of_stopping, ends)
        words, notes = f"{value:.1f} %", (f"sampled {low:.1f} to {high:.1f} %", *notes)
    return f"{words} ({', '.join(notes)})" if notes else words


def reasons(threat: CheckedThreat) -> str:
    """Return why an armour has its verdict against a threat: probability or limit, and what is required."""
    requirements = {each.quantity: each for each in threat.requirements}
    name, required = at_speed(threat), _required(threat)
    for unsound in ("backing_density_kg_m3", "interlayers", "flow_stress_sources"):
        if unsound in requirements:
            return phrases.requirement_words(requirements[unsound])
    margin = requirements.get("margin_m_s")
    if margin is not None and margin.verdict != "passes":
        kind = "by the model" if threat.expected_limit_m_s is None else "expected"
        return f"limit {limit_text(threat)} m/s {kind} against {name}; {margin.required:g} m/s above it required"
    if threat.probability_of_stopping is not None:
        if threat.verdict == "not known" and threat.sampled is None:
            return f"stops a shot of {name} with at most {chance_text(threat)} so far from the tests ({required})"
        likely = chance_text(threat, required)
        if threat.verdict == "expected to stop":
            return f"a shot of {name}, with {likely}"
        return f"stops a shot of {name} with {likely}"
    limit = "no limit found" if threat.ballistic_limit_m_s is None else f"limit {limit_text(threat)} m/s"
    if threat.verdict in ("stopped by the model", "perforated by the model"):
        return f"{name}, {limit}"
    is_stopped = threat.verdict != "fails" and (threat.margin_m_s is None or threat.margin_m_s >= 0.0)
    by_model = f"{name} {'is stopped' if is_stopped else 'perforates'} by the model, {limit}"
    return f"{threat.reason}; {by_model}" if threat.verdict == "not known" else by_model


def _required(threat: CheckedThreat) -> str:
    """Return the required probability of stopping a shot, as "95 % required" or "none required"."""
    asked = threat.required_probability
    return "none required" if asked is None else f"{percent(asked)} required"


@line_of.register
def check_in_a_line(result: CheckResult) -> str:
    """Return the verdict on an armour in a line, with what decides about it."""
    unmet = [each for each in result.requirements if each.verdict == result.verdict]
    if unmet and result.verdict in ("fails", "not known"):
        return f"{verdict_word(result.verdict)}: {'; '.join(map(phrases.requirement_words, unmet))}"
    alike = len({threat.verdict for threat in result.threats}) == 1 < len(result.threats)
    words = f"{verdict_word(result.verdict)}{' against every threat' * alike}: {reasons(deciding(result))}"
    kept = result.requirements or any(threat.required_margin_m_s for threat in result.threats)
    is_neutral = result.verdict in GOOD and result.verdict != "passes"
    return f"{words}; keeps all limits of [design]" if kept and is_neutral else words


def verdict_line(result: CheckResult) -> VerdictLine:
    """Return the verdict on an armour in a line, with the colour of its verdict; neutral ones have none."""
    good = {"passes": True, "fails": False, "perforated by the model": False}.get(result.verdict)
    return VerdictLine(in_a_line(result), good=good, unsure=result.verdict == "not known")


def amounts(result: CheckResult) -> str:
    """Return areal density, thickness and cost of an armour in a line, with the most that is allowed of each."""
    most, words = {each.quantity: each.required for each in result.requirements}, []
    for key, named in OBJECTIVES.items():
        if (value := getattr(result, key)) is not None:
            text = "cost " * (key == COST.key) + phrases.amount(key, value, most.get(key, inf))
            words.append(f"{text}{f' of at most {most[key]:g}' if key in most else ''}{named.unit}")
    return ", ".join(words)


def facts(result: CheckResult, *, armour: str = "", also: str = "") -> list[Table | str]:
    """Return what the verdict on an armour rests on: its limit and the tests, or a row for each of several threats.

    `armour`, given for a check, is the armour in words, which stand first; what small changes do is then added.
    `also`, given for a search, names the designs nearly as good.
    """
    threat, several, shown = deciding(result), len(result.threats) > 1, list[Table | str]()
    if several:
        alike = len({each.verdict for each in result.threats}) == 1
        shown.append(
            Table.of(
                result.threats,
                (Column("threat", prose=True), without_speed),
                Column.of("velocity_m_s", ".0f", "speed"),
                (LIMIT, lambda each: limit_text(each) + " by the model" * (each.expected_limit_m_s is None)),
                (STOPS, chance_text),
                *[(VERDICT, lambda each: verdict_word(each.verdict))] * (not alike),
            )
        )
    facts_by_label = {"armour": armour and f"{armour}, {amounts(result)}"}
    if _is_modelled(threat):
        changed = changes(threat) if armour else ""
        facts_by_label |= {
            "limit": "" if several else limit_words(threat),
            "tests": tests_words(threat),
            "changed": f"against {threat.threat}: " * several + changed if changed else "",
            "needs": needs(threat),
        }
    facts_by_label["within 1 %"] = also
    shown.append(Table.of_facts(facts_by_label))
    for each in filter(_is_modelled, result.threats):
        shown += phrases.far_line(each.far_from_tests, f" against {each.threat}" * several)
    return [*shown, *phrases.said_of(result.notes)]


def _is_modelled(threat: CheckedThreat) -> bool:
    """Return whether the model describes the armour: its back plate is a metal, directly behind the tile."""
    return all(each.quantity not in ("backing_density_kg_m3", "interlayers") for each in threat.requirements)


def limit_words(threat: CheckedThreat) -> str:
    """Return the limit in words, and the speed up to which a shot is stopped with the probability required."""
    if threat.expected_limit_m_s is None:
        return "none found" if threat.ballistic_limit_m_s is None else f"{limit_text(threat)} m/s by the model"
    words = f"{limit_text(threat)} m/s expected"
    if threat.safe_speed_m_s is None:
        return words
    safe = beside(threat.safe_speed_m_s, threat.velocity_m_s, 0)
    return f"{words}; {percent(threat.required_probability or USUAL_PROBABILITY)} up to {safe} m/s"


def tests_words(threat: CheckedThreat) -> str:
    """Return the tests that the expected limit rests on; own tests of this very armour come first."""
    if (error := threat.model_error) is None:
        return ""
    if (here := error.tests_here) is not None:
        measured, own = phrases.measured_here(here), phrases.own_tests(here)
        words = f"{measured} on this very armour ({own})" if measured else f"{own} at this very armour"
        return "; ".join([words, *phrases.tested_here(error)[2:]])  # the doubts
    return error.source.replace(" tests", "", 1)


def changes(threat: CheckedThreat) -> str:
    """Return in a line what each small change gives: the probability of stopping, or else the limit by the model."""
    known, words = threat.probability_of_stopping is not None, []
    for each in threat.what_ifs:
        if known:
            words.append(f"{each.change} {phrases.chance(each.probability_of_stopping)}")
        elif each.ballistic_limit_m_s is not None and each.velocity_m_s == threat.velocity_m_s:
            perforated = " (perforated)" * (each.ballistic_limit_m_s < threat.velocity_m_s)
            words.append(f"{each.change} {each.ballistic_limit_m_s:.0f} m/s{perforated}")
    return ", ".join(words)


def needs(threat: CheckedThreat) -> str:
    """Return in words the flow stress that a ceramic without tests needs to stop a threat; "" if it is not needed."""
    needed = threat.flow_stress
    if threat.verdict != "not known" or needed is None or needed.needed_GPa is None:
        return ""
    return phrases.needed_flow_stress(needed, likely=threat.required_probability is not None)


@tables_of.register
def tables_of_check(result: CheckResult) -> list[Table | str]:
    """Return the verdict on an armour and what it rests on; with `every_row` in the question, the details too."""
    armour = result.question["scenario"].armour_words()
    return [verdict_line(result), *facts(result, armour=armour), *details(result) * _every_row(result)]


def _every_row(result: Any) -> bool:
    """Return whether all rows and details of a result are asked for, as by -v."""
    return bool(result.question.get("every_row"))


def next_step(result: CheckResult) -> tuple[str, str]:
    """Return the command to go on with after a check, and the words that follow it.

    The command is "" if no command for the same scenario leads further; the words then say what does, if anything.
    """
    threat, scenario = deciding(result), result.question["scenario"]
    if result.verdict == "passes":
        return "report", ""
    if result.verdict == "expected to stop":
        return "check", f"--probability {USUAL_PROBABILITY:g}"
    if not _is_modelled(threat):
        return "", "see docs/howto/confidence.md"
    by_model, error = threat.verdict not in ("fails", "passes") and scenario.excludes_error(), threat.model_error
    if by_model or result.verdict in ("not known", "stopped by the model"):
        return "", what_tells(result, "only own tests can decide: fire a V50 of this armour, then run armour calibrate")
    if error is not None and error.tests_here is not None and len(error.tests_here.limits_m_s) == 1:
        return "", "a second V50 of this armour narrows the interval: fire it, then run armour calibrate"
    try:
        catalogue_of(scenario)
    except InputError:
        return "", ""
    return "optimise", ""


def details(result: CheckResult) -> list[Table | str]:
    """Return what -v and reports add to a check: the numbers of the model, and what they rest on, by threat.

    With a back plate that exists already, they begin with the areal density and thickness of both together.
    """
    shown = list[Table | str]()
    if result.whole_thickness_mm != result.thickness_mm:
        together = f"{AREAL_DENSITY.text(result.whole_areal_density_kg_m2)} kg/m², {result.whole_thickness_mm:.4g} mm"
        shown.append(f"{together} with the back plate, which exists")
    tables = [_detail_table(threat) for threat in result.threats if _is_modelled(threat)]
    remarks = []
    for threat in result.threats:
        against = f"against {threat.threat}: " * (len(result.threats) > 1)
        of_threat = *phrases.v50_notes(threat, threat.velocity_m_s), *phrases.basis_notes(threat)
        remarks += [against + remark for remark in of_threat]
    return [*shown, *tables, *remarks, *phrases.threat_sources(result.question["scenario"])]


def _detail_table(threat: CheckedThreat) -> Table:
    """Tabulate limits, interval and probability against a threat, of the armour as given and with each small change."""
    title = at_speed(threat) + ", with exact inputs" * (threat.sampled is not None)
    return Table.of(
        (threat.as_given(), *threat.what_ifs),
        (Column("if", prose=True), attrgetter("change")),
        (Column("by the model", "m/s", ".0f"), attrgetter("ballistic_limit_m_s")),
        (Column("expected", "m/s", ".0f"), attrgetter("expected_limit_m_s")),
        (Column("95 % between", "m/s", prose=True), lambda each: interval(each.interval_m_s, ".0f")),
        (STOPS, lambda each: phrases.chance(each.probability_of_stopping)),
        title=title,
    )


def name_of(result: CheckResult) -> str:
    """Return the name of an offer, or else the file of the armour."""
    return str(result.question.get("name") or result.question["scenario"].file)


def checks_table(results: Sequence[CheckResult]) -> list[Table | str]:
    """Tabulate several armours: what each is, weighs and costs, its limit and its verdict."""
    table = Table.of(
        results,
        (Column("name", prose=True), name_of),
        (Column("armour", prose=True), lambda result: result.question["scenario"].armour_words()),
        *_verdict_columns(results),
        (VERDICT, verdict_cell),
    )
    return [table, *_explained_mark(results)]


def _verdict_columns(results: Sequence[CheckResult]) -> Iterator[Source]:
    """Yield the columns of a table of armours, of which each row is a check; of several threats, it is of the worst."""
    yield Column("kg/m²", spec=".1f"), attrgetter(AREAL_DENSITY.key)
    yield Column("cost", spec=".0f"), attrgetter(COST.key)
    if any(len(result.threats) > 1 for result in results):
        yield Column("against", prose=True), lambda result: without_speed(deciding(result))
    yield LIMIT, lambda result: _marked_limit(deciding(result))
    yield STOPS, lambda result: chance_text(deciding(result))


def _marked_limit(threat: CheckedThreat) -> str:
    """Return the limit of an armour, m/s, with "*" if it is by the model; "none" where the model does not hold."""
    by_model = threat.ballistic_limit_m_s is not None and threat.expected_limit_m_s is None
    return limit_text(threat) + "*" * by_model if _is_modelled(threat) else "none"


def _explained_mark(results: Iterable[CheckResult]) -> list[str]:
    """Return a line on what "*" behind a limit means, or none if no limit of the results has this mark."""
    return [BY_MODEL] * any(_marked_limit(deciding(result)).endswith("*") for result in results)


def check_summary(results: Sequence[CheckResult]) -> VerdictLine:
    """Return a line with how many of several armours have each verdict and, of offers, what is required."""
    found = [result.verdict for result in results]
    counts = ", ".join(f"{found.count(each)} {verdict_word(each)}" for each in reversed(VERDICTS) if each in found)
    line = f"{counted(len(found), 'armour')}: {counts}"
    if "labels" in results[0].question:
        threats = results[0].threats
        against = at_speed(threats[0]) if len(threats) == 1 else counted(len(threats), "threat")
        line += f" ({_required(threats[0])}, {against})"
    return VerdictLine(line, good=(True if {*found} == {"passes"} else None) if {*found} <= {*GOOD} else False)


def check_report(results: Sequence[CheckResult], move_tables: Sequence[Table | str]) -> Report:
    """Return a short report on checked armours, as for the summary of a CI run.

    `move_tables` shows what differs from an earlier check; it is empty if there is none.
    """
    rows, caveats = [], list[tuple[str, str]]()
    labels = results[0].question.get("labels") or {"offer" if "labels" in results[0].question else "scenario": ""}
    for result in results:
        named = [*result.question.get("labels", {}).values()] or [name_of(result)]
        rows += [(*named, name, verdict_word(verdict), words) for name, verdict, words in _judged_parts(result)]
        caveats += [(name_of(result), text) for text in phrases.said_of(result.notes)]
    columns = [Column(label, prose=True) for label in (*labels, "threat", "verdict", "why")]
    sections = [ReportSection("Armours", tables=(Table.of_rows(columns, rows),), notes=tuple(caveats))]
    sections += [section_of("Since the earlier check", move_tables)] if move_tables else []
    good = {result.verdict for result in results} <= {*GOOD}
    return Report("Check of armour", check_summary(results), tuple(sections), passed=good)


def _judged_parts(result: CheckResult) -> Iterator[tuple[str, Verdict, str]]:
    """Yield name, verdict and reason of each threat, and of each limit of [design]."""
    yield from ((threat.name, threat.verdict, reasons(threat)) for threat in result.threats)
    for each in result.requirements:
        yield Column.of(each.quantity).label, each.verdict, phrases.requirement_words(each)


def tables_of_moved(moves: Sequence[Moved], base: str) -> list[Table | str]:
    """Tabulate what differs from an earlier check, in the file `base`, and count what of it is weaker."""
    if not moves:
        return [f"nothing has changed since {base}"]
    table = Table.of(
        moves,
        (Column("scenario", prose=True), lambda move: move.scenario),
        (Column("threat", prose=True), lambda move: move.threat),
        (Column("what", prose=True), lambda move: quantity_words(move.quantity)),
        (Column("before"), lambda move: _moved_value(move.quantity, move.before)),
        (Column("now"), lambda move: _moved_value(move.quantity, move.now)),
        (Column("so"), lambda move: "weaker" * move.weaker),
        title=f"changed since {base}",
    )
    weaker = sum(move.weaker for move in moves)
    verdict = VerdictLine(f"weaker than in {base}: {weaker} of {len(moves)} changes", good=False)
    return [table, *[verdict] * bool(weaker)]


def moved_junit(moves: Sequence[Moved], base: str, origin: Mapping[str, str]) -> Element:
    """Return the JUnit element of a comparison with an earlier check: a failure for each part that is weaker."""
    cases = []
    for move in filter(attrgetter("weaker"), moves):
        title = " ".join(filter(None, (move.threat, quantity_words(move.quantity))))
        before, now = (_moved_value(move.quantity, value) for value in (move.before, move.now))
        words = f"weaker: {before} before, {now} now"
        cases.append(TestCase(move.scenario, title, "failure", words, file=move.scenario))
    return junit_suite(f"against {base}", cases or [TestCase(base, "nothing is weaker", "", "")], 0.0, origin)


def quantity_words(quantity: str) -> str:
    """Return the label and unit of a quantity; the key of a section, or one in it or in the library, as it is."""
    return quantity if "." in quantity or quantity in Scenario.model_fields else Column.of(quantity).heading


def _moved_value(quantity: str, value: float | str | None) -> str:
    """Format the value of a quantity in an earlier check or now: a number, a text, or None if there is none."""
    if value is None:
        return "none" if quantity.startswith("required") else "not known"
    if isinstance(value, str):
        return "FAILS" if value == "fails" else value
    return phrases.chance(value) if "probability" in quantity else f"{value:.6g}"


def check_junit(result: CheckResult, scenario: Scenario, seconds: float, origin: Mapping[str, str]) -> Element:
    """Return the JUnit element of a check, with a test case for each threat and each limit of [design].

    A threat that holds is skipped unless its required probability is reached, as nothing else passes.  The output of a
    case has its numbers and the caveats about the armour.  Names of cases do not contain thicknesses, velocities or
    angles.  `seconds` is the time of the whole check.
    """
    file, caveats = scenario.file, phrases.said_of(result.notes)
    group = ": ".join(filter(None, (file, result.question.get("name"))))
    labels = [f"{name}: {label}" for name, label in result.question.get("labels", {}).items()]
    cases = []
    for name, verdict, why in _judged_parts(result):
        found = {"passes": ""}.get(verdict, "skipped" if verdict in GOOD else "failure")
        words = f"{verdict_word(verdict)}: {why}"
        cases.append(TestCase(group, name, found, words, file=file, output=[words, *labels, *caveats]))
    return junit_suite(group, [cases[0]._replace(seconds=seconds), *cases[1:]], seconds, origin)


# Materials and thicknesses of a design, which distinguish it from others.
layers_of = attrgetter("ceramic", "backing", "ceramic_thickness_mm", "backing_thickness_mm")


def pair_words(design: Design | Pair) -> str:
    """Return the materials of a design, such as "AD85 on 6061-T6"."""
    return f"{design.ceramic} on {design.backing}" if design.ceramic else design.backing


def sizes(design: Design) -> str:
    """Return the thicknesses of a design, such as "11 on 6 mm"."""
    layers = design.ceramic_thickness_mm, design.backing_thickness_mm
    return f"{' on '.join(f'{round(mm, 2):g}' for mm in layers if mm)} mm"


@line_of.register
def design_in_a_line(result: DesignResult) -> str:
    """Return the best design or, without one, the nearest in a line, with the verdict on it."""
    return f"{found_in_a_line(result)}; {in_a_line(result.shown.check)}"


def best_word(result: DesignResult) -> str:
    """Return in what the design shown is best, as "lightest"; "nearest" if none passes.

    Of designs that are not known to pass, it is the "lightest with tests" or, without any, the "lightest by the model".
    """
    if result.reason == "none passes":
        return "nearest"
    by_model = any(threat.expected_limit_m_s is None for threat in result.shown.check.threats)
    return OBJECTIVES[result.minimised].least + (" by the model" if by_model else " with tests" * bool(result.reason))


def found_in_a_line(result: DesignResult) -> str:
    """Return the best design or, without one, the nearest, with its areal density, thickness and cost."""
    return f"{best_word(result)}: {armour_in_words(result.shown)}, {amounts(result.shown.check)}"


@tables_of.register
def tables_of_design(result: DesignResult) -> list[Table | str]:
    """Return the best design, or the nearest, its verdict and what this rests on, and then the other designs found."""
    result.shown.check.of(every_row=_every_row(result))
    lines = VerdictLine(found_in_a_line(result)), verdict_line(result.shown.check)
    checked = facts(result.shown.check, also=nearly_as_good(result))
    return [*lines, *checked, *details(result.shown.check) * _every_row(result), *tables_of_search(result)]


def tables_of_search(result: DesignResult) -> list[Table | str]:
    """Return a row for each pair of materials and, with `every_row` in the question, frontier and Pareto front."""
    shown = pair_table(result) if len(result.pairs) > 1 else []
    if _every_row(result):
        if result.frontier:
            holds = "may hold" if result.reason else "holds"
            shown.append(designs_table(result.frontier, f"thinnest tile that {holds} on each plate"))
        margin = [MARGIN] * (MARGIN_COLUMN in result.criteria)
        shown += [designs_table(result.pareto, "Pareto front", *margin)] if result.pareto else []
        shown.append(f"{counted(result.designs, 'design')} computed")
    return shown


def nearly_as_good(result: DesignResult) -> str:
    """Return the thicknesses of designs on other plates whose objective is within 1 % of the best, the best first."""
    value, best = attrgetter(result.minimised), result.shown
    others = (each for each in result.frontier if each.backing_thickness_mm != best.backing_thickness_mm)
    near = [each for each in others if value(each) <= 1.01 * value(best)]
    words = [sizes(each).removesuffix(" mm") for each in sorted(near, key=value)]
    more = f" and {len(words) - MOST_NAMED} more" * (len(words) > MOST_NAMED)
    return f"{', '.join(words[:MOST_NAMED])} mm{more}" if words and len(result.pairs) == 1 else ""


def pair_table(result: DesignResult) -> list[Table | str]:
    """Tabulate every pair of materials with its best design or, without one, the nearest."""
    designs = [pair.best or pair.nearest for pair in result.pairs]
    checks = [each.check for each in designs if each is not None]
    alike = {check.verdict for check in checks} == {result.shown.check.verdict}
    columns = *_verdict_columns(checks), *[(VERDICT, verdict_cell)] * (not alike)
    table = Table.of(
        zip(result.pairs, designs, strict=True),
        (Column("materials", prose=True), lambda row: pair_words(row[0])),
        *of_part(lambda row: row[1], (Column("best", prose=True), sizes)),
        *of_part(lambda row: row[1] and row[1].check, *columns),
        rest="--json",
    )
    metals = {pair.best.backing for pair in result.pairs if pair.best is not None and pair.best.ceramic}
    of_others = phrases.said_of(result.notes, "pairs")
    return [table, *_explained_mark(checks), *[METALS] * (len(metals) > 1), *of_others]


def designs_table(designs: Sequence[Design], title: str, *margin: Column) -> Table:
    """Tabulate designs in a row each; `margin` is the column of the margin where it is a criterion."""
    columns = (Column("armour", prose=True), armour_in_words), AREAL_DENSITY, THICKNESS, COST, *margin, FAR
    return Table.of(designs, *columns, title=title, rest="--csv FILE")


def design_csv(result: DesignResult) -> str:
    """Format designs as CSV: the Pareto front; without one, the frontier."""
    untested: Source = Column("tests", key="untested"), lambda design: "untested" if design.untested else ""
    numbers = CERAMIC_THICKNESS, BACKING_THICKNESS, AREAL_DENSITY, THICKNESS, COST, *[MARGIN] * bool(result.pareto)
    designs = result.pareto or result.frontier
    return csv_text(Table.of(designs, Column.of("ceramic"), untested, Column.of("backing"), *numbers, FAR))
