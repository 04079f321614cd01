"""A report as Markdown, without its pictures."""

import re

from markupsafe import Markup

from armour.files import printable
from armour.reporting.html import rendered
from armour.reporting.report import Report
from armour.reporting.table import Table
from armour.reporting.text import printable_lines


def markdown_report(report: Report) -> str:
    """Format a report as Markdown."""
    return rendered("report.md", markdown_text, report=report, fenced=_fenced).rstrip() + "\n"


def markdown_table(table: Table) -> str:
    """Format a table, without its title."""
    return rendered("table.md", markdown_text, table=table).rstrip()


def markdown_text(text: str) -> str:
    """Escape the markup and the control characters of a text, and join its lines."""
    text = re.sub(r"[\\|*_<>`\[~$&]", r"\\\g<0>", printable(" ".join(text.split())))
    # What begins a heading, a list or a rule at the start of a line.
    return re.sub(r"^(#{0,5}|\d{0,9})([#+\-.)])(?=[ -]|$)", r"\1\\\2", text)


def _fenced(text: str, language: str) -> Markup:
    """Return text within a fence longer than any in it."""
    text = printable_lines(text)
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return Markup(f"{fence}{language}\n{text.rstrip()}\n{fence}")
