"""Tables and reports of suites, of the paper's figures, and of comparisons with simpler formulas."""

from collections.abc import Iterable, Mapping, Sequence

from armour import __version__
from armour.errors import counted
from armour.reporting.by_result import drawing_of, headline, in_a_line, line_of, tables_of
from armour.reporting.junit import TestCase, junit_suite, junit_xml
from armour.reporting.report import Report, ReportSection, origin_section
from armour.reporting.table import Cell, Column, Table, VerdictLine, grouped, sentence
from armour.reporting.views.analysis import armour_words, crossings, limits_in_words, measured_here
from armour.reporting.words import said_of
from armour.validation.comparison import Comparison
from armour.validation.figures import Figure
from armour.validation.suite_sections import CASES
from armour.validation.tested import wilkins_tests
from armour.validation.validate import FAILED, Check, SuiteResult, TableSummary


def check_groups(result: SuiteResult) -> dict[str, list[Check]]:
    """Return the checks of a suite by the name of their table; those of no table are under `CASES`."""
    return grouped(result.checks, lambda check: check.case.group or CASES)


def check_table(checks: Sequence[Check], title: str = "") -> Table:
    """Tabulate checks: expected and computed values, their deviations, and the bands in which these must lie."""
    units = {check.case.unit for check in checks}
    shared = units.pop() if len(units) == 1 else ""
    return Table.of(
        checks,
        (Column("case", prose=True), lambda check: check.case.name),
        (Column("unit"), lambda check: "" if shared else check.case.unit),
        (Column("expected", shared, ".10g"), lambda check: check.case.expected),
        (Column("computed", shared, ".6g"), lambda check: check.computed),
        (Column("deviation", shared, "+.4g"), lambda check: check.deviation),
        Column.of("deviation_percent", "+.2f", "relative deviation"),
        (Column("band ±", shared, ".4g"), lambda check: check.case.band),
        Column.of("status"),
        title=title,
    )


def in_numbers(check: Check) -> str:
    """Return expected and computed value, deviation and band of a check in a line."""
    table = check_table([check])
    cells = zip(table.columns[1:-1], table.texts()[0][1:-1], strict=True)
    return ", ".join(f"{column.label} {text} {column.unit}".rstrip() for column, text in cells if text)


def summary_table(summaries: Iterable[TableSummary], title: str) -> Table:
    """Tabulate the mean, RMS and largest deviation of tables of a suite, or of the groups of the rows of one table."""
    return Table.of(
        summaries,
        (Column("tests", prose=True), lambda summary: summary.group or summary.name),
        Column.of("count", "d", "number"),
        Column.of("unit"),
        Column.of("mean", "+.2f"),
        Column.of("mean_magnitude", ".2f", "magnitude"),
        Column.of("rms", ".2f", "RMS"),
        Column.of("largest", ".2f"),
        Column.of("rms_band", "g", "RMS band"),
        Column.of("status"),
        title=title,
    )


def held_to(summary: TableSummary) -> str:
    """Return the mean and RMS deviation of a table or group in a line, each beside its band; omit those without one."""
    unit, parts = summary.unit, []
    if summary.rms_band is not None:
        parts.append(f"RMS {summary.rms:.2f} {unit}, RMS band {summary.rms_band:g} {unit}")
    if summary.mean_band is not None:
        band = f"{summary.mean_expected:+g} ± {summary.mean_band:g} {unit}"
        parts.append(f"mean {summary.mean:+.2f} {unit}, mean band {band}")
    return ", ".join(parts)


def note_rows(checks: Sequence[Check]) -> list[tuple[str, str]]:
    """Return names and notes of cases: why they have no answer, are not scored, or have their band.

    A note that several rows of a table share appears once, under the name of the table.
    """
    notes = []
    for check in checks:
        case = check.case
        if check.message:
            notes.append((case.full_name, check.message))
        elif case.not_scored or case.reason:
            notes.append((case.group or case.name, case.not_scored or case.reason))
    return list(dict.fromkeys(notes))


@line_of.register
def suite_in_a_line(result: SuiteResult) -> str:
    """Return the outcome of a suite in a line, such as "9 of 10 within their bands, 1 outside"."""
    if not result.is_scored:
        return "no case is scored"
    failed = [f"{count} {status}" for status in FAILED if (count := result.count(status))]
    return ", ".join([f"{result.count('within')} of {result.count('within', *FAILED)} within their bands", *failed])


def suite_tables(result: SuiteResult) -> list[Table]:
    """Return all tables of a suite: its cases, and its tables as a whole.

    A table whose rows are in a file shows its groups instead, and those rows that are outside their bands or have no
    answer.
    """
    groups, tables = check_groups(result), []
    in_file = [name for name, checks in groups.items() if checks[0].case.cells]
    for name, checks in groups.items():
        if name in in_file:
            tables.append(summary_table((each for each in result.summaries if each.name == name), name))
            tables += failed_table(name, checks)
        else:
            tables.append(check_table(checks, name))
    of_tables = [each for each in result.summaries if each.name not in in_file]
    return [*tables, *[summary_table(of_tables, "tables as a whole")] * bool(of_tables)]


def failed_table(name: str, checks: Sequence[Check]) -> list[Table]:
    """Return a table of the checks that are outside their bands or have no answer, if there are any."""
    failed = [check for check in checks if check.status in FAILED]
    return [check_table(failed, f"{name}: not within their bands")] if failed else []


def overview_table(result: SuiteResult) -> Table:
    """Tabulate how many cases of each table of a suite are within their bands, and the RMS deviation with its band."""
    of_tables = {summary.name: summary for summary in result.summaries if not summary.group}

    def row_of(name: str, checks: Sequence[Check]) -> tuple[Cell, ...]:
        scored = [check for check in checks if check.status != "not scored"]
        within = f"{sum(check.status == 'within' for check in scored)} of {len(scored)}" if scored else ""
        title = counted(len(checks), "other case" if of_tables else "case") if name == CASES else name
        if (summary := of_tables.get(name)) is None:
            return title, within or "not scored", "", ""
        band = "" if summary.rms_band is None else f"{summary.rms_band:.3g} {summary.unit}"
        within = within or summary.status.replace("within", "as a whole")
        return title, within, f"{summary.rms:.3g} {summary.unit}", band

    rows = [row_of(name, checks) for name, checks in check_groups(result).items()]
    return Table.of_rows((Column("table", prose=True), *map(Column, ("within", "RMS", "at most"))), rows)


@tables_of.register
def tables_of_suite(result: SuiteResult) -> list[Table | str]:
    """Return the verdict on a suite, an overview and its failures; with `every_row` in the question, all tables.

    Cases whose expected value is not filled in yet are always counted.
    """
    every_row, checks = result.question.get("every_row"), [check for check in result.checks if not check.in_group]
    unscored = [] if every_row else [c for c in checks if c.status == "not scored" and c.case.expected is not None]
    line = in_a_line(result) + (f"; {len(unscored)} not scored (-v)" if unscored else "")
    shown: list[Table | str] = [VerdictLine(line, good=result.passed)]
    shown += suite_tables(result) if every_row else [overview_table(result)]
    if not every_row:
        shown += (table for name, checks in check_groups(result).items() for table in failed_table(name, checks))
    plain = ("within", "no expected value")
    rows = note_rows([check for check in checks if check.status not in plain and check not in unscored])
    rows += [(summary.full_name, held_to(summary)) for summary in result.summaries if summary.status == "outside"]
    notes = [f"{name}: {note}" for name, note in rows]
    if unfilled := result.count("no expected value"):
        notes.append(f"{counted(unfilled, 'case')} without an expected value, which --update fills in")
    return [*shown, *([""] if notes else []), *notes]


def update_table(updates: Sequence[Check]) -> Table:
    """Tabulate the expected values that an update replaces, and the computed values that replace them."""
    columns = Column("case", prose=True), Column("expected", spec=".10g"), Column("computed", spec=".10g")
    return Table.of_rows(columns, [(check.case.full_name, check.case.expected, check.computed) for check in updates])


def parity_table(result: SuiteResult) -> Table:
    """Tabulate the expected and computed values of all cases of a suite."""
    columns = [*map(Column.of, ("table", "row", "quantity")), Column.of("expected", "g"), Column.of("computed", "g")]
    cases = ((check.case, check.computed) for check in result.checks)
    rows = [(case.group, case.name, case.quantity, case.expected, computed) for case, computed in cases]
    return Table.of_rows(columns, rows)


def drawn_checks(result: SuiteResult) -> list[Check]:
    """Return the checks that a picture of a suite shows.

    They are the numbers in its tables or, if there are none, all its numbers; relative differences are left out.
    """
    checks = [check for check in result.checks if check.deviation is not None and check.case.measured is None]
    return [check for check in checks if check.case.group] or checks


def suite_report(result: SuiteResult, command: str = "") -> Report:
    """Make the report on a suite: verdict, overview, picture, tables, and reasons for the bands.

    If `command` is given, the last section shows it, with the versions of the programs.
    """
    sources = {name: _source_and_reason(checks) for name, checks in check_groups(result).items()}
    sections = []
    if drawn_checks(result):
        sections.append(ReportSection("Computed and expected values", pictures=(drawing_of(result),)))
    for table in suite_tables(result):
        heading, source = sentence(table.title).removesuffix("."), sources.get(table.title, ())
        sections.append(ReportSection(heading, source, tables=(table,), folded=True))
    single = [check for check in result.checks if check.status != "not scored" and not check.case.group]
    unscored = [check for check in result.checks if check.status == "not scored" and not check.in_group]
    for heading, checks in (("Reasons for the bands", single), ("Shown but not scored", unscored)):
        if notes := note_rows(checks):
            sections.append(ReportSection(heading, notes=tuple(notes), folded=True))
    if command:
        sections.append(origin_section(command))
    return Report(
        title=result.title or result.file,
        lead=f"{headline(result)}.",
        facts=(overview_table(result),),
        text=result.description,
        byline=(("program version", f"armour {__version__}"),),
        sections=tuple(sections),
        passed=result.passed,
    )


def _source_and_reason(checks: list[Check]) -> tuple[str, ...]:
    """Return the source of a table and the reason for its band in a sentence, from its first row; () if none."""
    case = checks[0].case
    text = "; ".join(filter(None, (case.source, case.reason and f"band: {case.reason}")))
    return (sentence(text),) if case.group and text else ()


def suite_junit(result: SuiteResult, seconds: Sequence[float], origin: Mapping[str, str]) -> bytes:
    """Format the outcome of a suite as JUnit XML, with a test case for each case and each table that has a band.

    `seconds` has the time of each check; where cases are computed together, the first has the time of all of them.
    """
    kinds = {**dict.fromkeys(FAILED, "failure"), "not scored": "skipped"}
    cases = []
    for check, took in zip(result.checks, seconds, strict=True):
        words = in_numbers(check)
        message = words if check.status == "outside" else check.message or check.case.not_scored
        if not check.in_group:
            group, kind = check.case.group or CASES, kinds.get(check.status, "")
            cases.append(TestCase(group, check.case.name, kind, message, took, result.file, output=[words]))
    for summary in result.summaries:
        if summary.status != "not scored":
            kind = kinds.get(summary.status, "")
            words = held_to(summary)
            cases.append(TestCase(summary.name, summary.group or "RMS", kind, words, None, result.file, output=[words]))
    if not result.is_scored:
        cases.append(TestCase(CASES, "scored", "failure", in_a_line(result), None, result.file))
    return junit_xml([junit_suite(result.title or result.file, cases, sum(seconds), origin)])


def figure_table(panels: Sequence[Figure]) -> Table:
    """Tabulate the curves of a figure of the paper, a column each.

    Panels stand side by side; they must have equally many points.
    """
    columns: dict[str, Sequence[float | None]] = {}
    for panel in panels:
        columns[panel.section.x_label] = panel.x
        for label, values in panel.curves.items():
            columns[f"{label}: {panel.section.y_label}"] = values
    headings = tuple(Column(label, spec="g", key=label) for label in columns)
    return Table(headings, tuple(zip(*columns.values(), strict=True)))


def comparison_table(result: Comparison) -> Table:
    """Tabulate the ballistic limits by the model and by formulas, with their errors on tests.

    Only with `every_row` in the question are there errors of tests that are left out of the fit.
    """
    model, count = result.predictions[0], len(wilkins_tests().limits)
    labels = [f"mean error on {counted(count, 'test')}" if model.mean_percent is not None else "", "largest"]
    labels += ["each predicted from the others"] * bool(result.question.get("every_row"))
    keys = ("mean_percent", "largest_percent", "left_out_percent")
    errors = [
        (Column(label), lambda each, key=key: None if (part := getattr(each, key)) is None else f"{part:.1f} %")
        for label, key in zip(labels, keys, strict=False)
    ]
    limit = Column("limit", "m/s", ".0f"), lambda each: each.ballistic_limit_m_s
    return Table.of(result.predictions, (Column("by", prose=True), lambda each: each.method), limit, *errors)


def rule_note(result: Comparison) -> str:
    """Return a note on the areal density rule: its factor and tests, or why there is none."""
    if rule := next((each for each in result.predictions[1:] if each.fitted), None):
        return f"{rule.fitted}: {result.tests}, as was the model's flow stress"
    return f"no errors are known: none of the tests is of this round and these materials; they are {result.tests}"


@line_of.register
def comparison_in_a_line(result: Comparison) -> str:
    """Return the ballistic limit by the model, and what tests of this very armour measured or else is expected."""
    if here := measured_here(result.limit):
        limit = f"{result.limit.ballistic_limit_m_s:.0f} m/s by the model"
        return f"{limit}, {limits_in_words(here)} measured on this very armour"
    return in_a_line(result.limit)


@tables_of.register
def tables_of_comparison(result: Comparison) -> list[Table | str]:
    """Return the limits by the model and by formulas; with `every_row`, also the rules and tested armours."""
    missing, every_row = ", ".join(result.florence_missing), result.question.get("every_row")
    unknown = said_of(result.limit.notes, "not known")
    shown: list[Table | str] = [VerdictLine(in_a_line(result), good=False if unknown else None)]
    shown += [comparison_table(result), *said_of(result.limit.notes), *crossings(result.limit)]
    shown += [f"Florence's limit: none, without {missing}"] if missing else []
    shown += [rule_note(result)] if every_row or result.predictions[0].mean_percent is None else []
    if every_row:
        shown.append(Table.of_facts({"armour": armour_words(result.limit)}))
        columns = Column.of("armour", prose=True), Column.of("projectile", label="round")
        numbers = Column.of("areal_density_kg_m2"), Column.of("ballistic_limit_m_s", ".0f", "measured limit")
        shown += [Table.of(result.measured, *columns, *numbers)] if result.measured else []
    return shown
