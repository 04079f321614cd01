"""A suite's outcome as a file: Markdown for people, JUnit's XML for CI."""

from collections.abc import Sequence
from xml.etree import ElementTree

from armour import __version__
from armour.reporting.tables import (
    CHECK_COLUMNS,
    ERROR_COLUMNS,
    SUMMARY_COLUMNS,
    check_groups,
    check_rows,
    error_rows,
    note_rows,
    summary_rows,
    verdict,
)
from armour.validation.validate import FAILED, Check, Status, SuiteResult


def suite_markdown(result: SuiteResult) -> str:
    """The outcome as Markdown: verdict, cases, tables, errors, and the reasons for the bands."""
    parts = [f"# {markdown_text(result.title or result.file)}", f"armour {__version__}: {verdict(result)}."]
    for name, checks in check_groups(result):
        parts += [f"## {markdown_text(name[:1].upper() + name[1:])}", *_about(checks)]
        parts.append(markdown_table(CHECK_COLUMNS, check_rows(checks), numbers=range(2, 7)))
    if result.summaries:
        parts += [
            "## Tables as a whole",
            markdown_table(SUMMARY_COLUMNS, summary_rows(result), numbers=(1, 3, 4, 5, 6)),
        ]
    if result.errors:
        parts += ["## Errors, per cent", markdown_table(ERROR_COLUMNS, error_rows(result), numbers=(2, 3, 4))]
    own = [check for check in result.checks if not check.case.group]
    notes = note_rows([check for check in own if check.status != "not scored"])
    if notes:
        parts += ["## Why the bands are as wide as they are", _list(notes)]
    unscored = note_rows([check for check in result.checks if check.status == "not scored"])
    if unscored:
        parts += ["## Shown and not scored", _list(unscored)]
    return "\n\n".join(parts) + "\n"


def _about(checks: Sequence[Check]) -> list[str]:
    """Source and reason of a table, which all its rows share."""
    case = checks[0].case
    if not case.group:
        return []
    about = [text for text in (case.source, f"band: {case.reason}" if case.reason else "") if text]
    return [markdown_text("; ".join(about)) + "."] if about else []


def _list(notes: Sequence[tuple[str, str]]) -> str:
    return "\n".join(f"* {markdown_text(name)}: {markdown_text(note)}." for name, note in notes)


def markdown_table(columns: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[int] = ()) -> str:
    """A table in Markdown, columns of numbers to the right."""
    rule = ["---:" if index in numbers else "---" for index in range(len(columns))]
    lines = [columns, rule, *([markdown_text(cell) for cell in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def markdown_text(text: str) -> str:
    """Text in which nothing is taken for markup."""
    for mark in "\\|*_<`[":
        text = text.replace(mark, "\\" + mark)
    return text


def suite_junit(result: SuiteResult) -> bytes:
    """The outcome as JUnit's XML: a test case for every case, and for every table that is held to a band."""
    suite = ElementTree.Element("testsuite", name=result.title or result.file)
    for check in result.checks:
        message = check.message or check.case.not_scored
        if check.status == "outside":
            message = f"expected {check.case.expected}, computed {check.computed}, band {check.case.band}"
        _add(suite, check.case.group or "cases", check.case.name, check.status, message)
    for summary in result.summaries:
        if summary.status != "not scored":
            message = f"RMS {summary.rms} {summary.unit}, band {summary.rms_band}"
            _add(suite, summary.name, "RMS", summary.status, message)
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("testcase/failure"))))
    suite.set("skipped", str(len(suite.findall("testcase/skipped"))))
    ElementTree.indent(suite)
    return bytes(ElementTree.tostring(suite, encoding="utf-8", xml_declaration=True))


def _add(suite: ElementTree.Element, group: str, name: str, status: Status, message: str) -> None:
    case = ElementTree.SubElement(suite, "testcase", classname=group, name=name)
    if status in FAILED:
        ElementTree.SubElement(case, "failure", message=message)
    elif status == "not scored":
        ElementTree.SubElement(case, "skipped", message=message)
