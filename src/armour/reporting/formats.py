"""Reports and tables as one self-contained HTML file, without scripts, and as Markdown."""

import re
from collections.abc import Iterable
from itertools import product
from operator import mul
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from armour.files import printable
from armour.reporting.chart import Chart
from armour.reporting.report import Report, Section
from armour.reporting.table import Table
from armour.reporting.text import printable_lines, unbroken

# Heights of a heading and of a character of a note, in the points of a chart.
HEADING_POINTS, NOTE_POINTS = 40.0, 0.2
# Options of the command line, and names with a number, such as "6061-T6", at whose hyphens no line may end.
OPTION = re.compile(r"(?<![\w-])--[a-z]+(-[a-z]+)*(?![\w-])")
NAME = re.compile(r"(?<![\w-])(?=[\w-]*\d)\w+(-\w+)+(?![\w-])")


def html_report(report: Report) -> str:
    """Format a report as HTML."""
    drawn = [_drawn(chart, number) for number, chart in enumerate(report.charts, start=1) if chart.panels]
    return _rendered("report.html", report=report, columns=_columns(drawn))


def html_tables(tables: Iterable[Table | str]) -> str:
    """Format tables and notes as HTML, which is a part of a page."""
    return _rendered("notebook.html", tables=list(tables))


def _rendered(template: str, **context: Any) -> str:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        # Control characters are escaped, and no line of a text ends between a number and its unit.
        finalize=lambda value: unbroken(printable_lines(value)) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"zip": zip, "whole": _whole, "printable": printable_lines, "unbroken": unbroken}
    return environment.get_template(template).render(context) + "\n"


def _whole(text: str) -> Markup:
    """Return a text with marks on options and names, so that no line ends within one."""
    marked = NAME.sub(r"<span>\g<0></span>", str(escape(printable_lines(text))))
    return Markup(OPTION.sub(r"<code>\g<0></code>", marked))


def _drawn(chart: Chart, number: int) -> dict[str, Any]:
    """Return a chart as the template shows it, with its height in points."""
    # Imported here, as only HTML has charts.
    from armour.reporting.inline_svg import inline_svg

    svg = inline_svg(chart, f"chart{number}")
    *_, height = svg.partition('viewBox="')[2].partition('"')[0].split()
    points = HEADING_POINTS + NOTE_POINTS * len(chart.note) + float(height)
    return {"number": number, "chart": chart, "svg": Markup(svg), "height": points}


def _columns(drawn: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Share charts between two columns of as nearly the same height as possible."""
    heights = [chart["height"] for chart in drawn]
    signs = min(product((1, -1), repeat=len(drawn)), key=lambda signs: abs(sum(map(mul, signs, heights))))
    return [[chart for chart, own in zip(drawn, signs, strict=True) if own == sign] for sign in (1, -1)]


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


def markdown_report(report: Report) -> str:
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


def _section(section: Section) -> list[str]:
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
