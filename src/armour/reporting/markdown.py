"""Markdown: tables, and the outcome of a suite."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from armour import __version__
from armour.reporting.table import Table
from armour.reporting.tables.validation import (
    check_groups,
    check_table,
    error_table,
    note_rows,
    summary_table,
    verdict,
)
from armour.reporting.text import printable

if TYPE_CHECKING:
    from armour.validation.validate import Check, SuiteResult

RULES = {"left": "---", "right": "---:"}


def markdown_table(table: Table) -> str:
    """Format a table as Markdown, without its title."""
    lines = [
        [markdown_text(heading) for heading in table.headings()],
        [RULES[alignment] for alignment in table.alignments()],
        *([markdown_text(text) for text in texts] for texts in table.texts()),
    ]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def markdown_text(text: str) -> str:
    """Escape the markup and the control characters of a text, and join its lines."""
    text = printable(" ".join(text.split()))
    for mark in "\\|*_<`[":
        text = text.replace(mark, "\\" + mark)
    return text


def suite_markdown(result: "SuiteResult") -> str:
    """Format the outcome of a suite: verdict, cases, tables, errors, and the reasons for the bands."""
    parts = [f"# {markdown_text(result.title or result.file)}", f"armour {__version__}: {verdict(result)}."]
    for name, checks in check_groups(result).items():
        parts += [f"## {markdown_text(name[:1].upper() + name[1:])}", *_about(checks)]
        parts.append(markdown_table(check_table(checks)))
    if result.summaries:
        parts += ["## Tables as a whole", markdown_table(summary_table(result))]
    if result.errors:
        parts += ["## Errors", markdown_table(error_table(result))]
    own = [check for check in result.checks if not check.case.group]
    notes = note_rows([check for check in own if check.status != "not scored"])
    if notes:
        parts += ["## Reasons for the bands", _list(notes)]
    unscored = note_rows([check for check in result.checks if check.status == "not scored"])
    if unscored:
        parts += ["## Shown and not scored", _list(unscored)]
    return "\n\n".join(parts) + "\n"


def _about(checks: Sequence["Check"]) -> list[str]:
    """Return source and reason of a table, which all its rows share."""
    case = checks[0].case
    if not case.group:
        return []
    about = [text for text in (case.source, f"band: {case.reason}" if case.reason else "") if text]
    return [markdown_text("; ".join(about)) + "."] if about else []


def _list(notes: Sequence[tuple[str, str]]) -> str:
    return "\n".join(f"* {markdown_text(name)}: {markdown_text(note)}." for name, note in notes)
