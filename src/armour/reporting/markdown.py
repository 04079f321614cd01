"""Tables and reports as Markdown."""

import re
from typing import TYPE_CHECKING

from armour.files import printable
from armour.reporting.table import Table
from armour.reporting.text import printable_lines

if TYPE_CHECKING:
    from armour.reporting.report import Report, Section


def markdown_table(table: Table) -> str:
    """Format a table as Markdown, without its title."""
    lines = [
        [markdown_text(heading) for heading in table.headings()],
        ["---:" if column.numeric else "---" for column in table.columns],
        *([markdown_text(text) for text in texts] for texts in table.texts()),
    ]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def markdown_text(text: str) -> str:
    """Escape the markup and the control characters of a text, and join its lines."""
    text = re.sub(r"[\\|*_<>`\[~$&]", r"\\\g<0>", printable(" ".join(text.split())))
    # What begins a heading, a list or a rule at the start of a line.
    return re.sub(r"^(#{0,5}|\d{0,9})([#+\-.)])(?=[ -]|$)", r"\1\\\2", text)


def markdown_report(report: "Report") -> str:
    """Format a report as Markdown, without its charts."""
    parts = [f"# {markdown_text(report.title)}"]
    if report.byline:
        parts.append(", ".join(markdown_text(f"{name}: {text}") for name, text in report.byline))
    parts += (markdown_text(words) for words in (report.lead, *report.remarks))
    if report.cards:
        cards = ([markdown_text(text) for text in card] for card in report.cards)
        parts.append(
            "\n".join(
                f"* {subject}: **{words}**" + (f"; {detail}" if detail else "") for subject, words, detail in cards
            )
        )
    parts += (f"Warning: {markdown_text(warning)}" for warning in report.warnings)
    for section in report.sections:
        parts += _section(section)
    return "\n\n".join(parts) + "\n"


def _section(section: "Section") -> list[str]:
    parts = [f"## {markdown_text(section.heading)}", *(markdown_text(words) for words in section.paragraphs)]
    if section.code:
        parts.append(_fenced(section.code, section.language))
    parts += (markdown_table(table) for table in section.tables)
    if section.notes:
        parts.append("\n".join(f"* {markdown_text(name)}: {markdown_text(note)}." for name, note in section.notes))
    return parts


def _fenced(text: str, language: str) -> str:
    """Return text within a fence longer than any in it."""
    text = printable_lines(text)
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"
