"""Report on the outcome of a suite."""

from dataclasses import replace
from typing import TYPE_CHECKING

from armour import __version__
from armour.reporting.charts import parity_chart
from armour.reporting.report import Report, Section, filled, origin_section
from armour.reporting.tables.validation import check_groups, note_rows, suite_tables, verdict

if TYPE_CHECKING:
    from armour.validation.validate import Check, SuiteResult


def suite_report(result: "SuiteResult", command: str = "") -> Report:
    """Report the outcome of a suite: verdict, tables, and the reasons for the bands; with a command, its origin."""
    sources = {name: _source(checks) for name, checks in check_groups(result).items()}
    sections = [
        Section(table.title[:1].upper() + table.title[1:], sources.get(table.title, ()), tables=(filled(table),))
        for table in suite_tables(result)
    ]
    own = [check for check in result.checks if check.status != "not scored" and not check.case.group]
    unscored = [check for check in result.checks if check.status == "not scored" and not check.in_group]
    for heading, checks in (("Reasons for the bands", own), ("Shown but not scored", unscored)):
        if notes := note_rows(checks):
            sections.append(Section(heading, notes=tuple(notes)))
    if command:
        sections.append(origin_section(command))
    return Report(
        title=result.title or result.file,
        lead=f"armour {__version__}: {verdict(result)}. {result.description}".strip(),
        sections=tuple(sections),
        charts=(replace(parity_chart(result), title="Computed and expected values"),),
        passed=result.passed,
    )


def _source(checks: "list[Check]") -> tuple[str, ...]:
    """Return source and reason of a table, which all its rows share."""
    case = checks[0].case
    parts = [text for text in (case.source, f"band: {case.reason}" if case.reason else "") if text]
    text = "; ".join(parts) + "."
    return (text[:1].upper() + text[1:],) if case.group and parts else ()
