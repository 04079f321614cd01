"""Reports as one self-contained HTML file, without scripts."""

import re
from collections.abc import Iterable
from itertools import product
from operator import mul
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from armour.reporting.chart import Chart
from armour.reporting.inline_svg import inline_svg
from armour.reporting.report import Report
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
    svg = inline_svg(chart, f"chart{number}")
    *_, height = svg.partition('viewBox="')[2].partition('"')[0].split()
    points = HEADING_POINTS + NOTE_POINTS * len(chart.note) + float(height)
    return {"number": number, "chart": chart, "svg": Markup(svg), "height": points}


def _columns(drawn: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Share charts between two columns of as nearly the same height as possible."""
    heights = [chart["height"] for chart in drawn]
    signs = min(product((1, -1), repeat=len(drawn)), key=lambda signs: abs(sum(map(mul, signs, heights))))
    return [[chart for chart, own in zip(drawn, signs, strict=True) if own == sign] for sign in (1, -1)]
