"""Reports and tables as HTML: one self-contained page without scripts, with its charts as SVG.

The charts have the page's colours, and show the values of points on hover, focus and touch.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import count
from math import dist, inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from armour.reporting.charts import PALETTE, Chart, Line, Panel, Points, Series, Spans, printable_chart
from armour.reporting.report import Report
from armour.reporting.table import Table
from armour.reporting.text import printable_lines, unbroken, wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Options of the command line, and names with a number, such as "6061-T6", at whose hyphens no line may end.
OPTION = re.compile(r"(?<![\w-])--[a-z]+(-[a-z]+)*(?![\w-])")
NAME = re.compile(r"(?<![\w-])(?=[\w-]*\d)\w+(-\w+)+(?![\w-])")
SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
TEMPLATES = Path(__file__).parent / "templates"
WIDTH_INCHES, POINTS_PER_INCH = 4.2, 72
# Colours that follow the theme of the page.
THEME = {PALETTE[name]: f"var(--{name})" for name in ("ink", "soft", "blue", "paper")}
# Points of a series with a tooltip, and their least distance on a curve and radius, points of 1/72 inch.
MAX_POINTS, SPACING, RADIUS = 200, 4.0, 6.0
# Height of a line of a tooltip and its distance from the point, points.
LINE_HEIGHT, ABOVE = 10.5, 8.0
# Width of a character of a tooltip, points, and characters in a line of it.
CHARACTER, LINE_CHARACTERS = 5.0, 54


def html_report(report: Report) -> str:
    """Format a report as HTML."""
    numbers = count(1)

    def svg(chart: Chart) -> Markup:
        return Markup(inline_svg(chart, f"chart{next(numbers)}"))

    return rendered("report.html", report=report, svg=svg)


def html_tables(tables: Iterable[Table | str]) -> str:
    """Format tables and notes as HTML, which is a part of a page."""
    return rendered("notebook.html", tables=list(tables))


def rendered(template: str, **context: Any) -> str:
    """Return a page or a part of one."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
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


def inline_svg(chart: Chart, name: str) -> str:
    """Return a chart without its title and note as an SVG element.

    The name is the prefix of the element's identifiers, different for every chart of a page.
    """
    # Imported here, as it is slow, and not every page has charts.
    from armour.reporting.draw import draw, saved

    chart = printable_chart(chart)
    figure = draw(replace(chart, title="", note=""), WIDTH_INCHES)
    figure.set_dpi(POINTS_PER_INCH)
    root = ElementTree.fromstring(saved(figure, ".svg", dpi=POINTS_PER_INCH, transparent=True))
    for part in root.findall(f"{{{SVG}}}metadata") + root.findall(f"{{{SVG}}}defs[{{{SVG}}}style]"):
        root.remove(part)
    for element in root.iter():
        for key, value in element.attrib.items():
            element.set(key, _attribute(key, value, name))
    for size in ("width", "height"):
        del root.attrib[size]
    root.attrib |= {"role": "group", "aria-label": " ".join(chart.title.splitlines())}
    for axes, panel in zip(figure.axes, chart.panels, strict=False):
        for item in panel.series:
            root.extend(_points(axes, panel, item, float(figure.bbox.height)))
    ElementTree.register_namespace("", SVG)
    ElementTree.register_namespace("xlink", XLINK)
    return ElementTree.tostring(root, encoding="unicode")


def _points(axes: "Axes", panel: Panel, item: Series, height: float) -> list[ElementTree.Element]:
    """Return the points of a series that have words, at a distance from each other on a curve."""
    found: list[ElementTree.Element] = []
    curve = isinstance(item, Line) and not item.marker
    window = axes.bbox.padded(1.0)
    last = inf, inf
    for x, y, text in _values(panel, item):
        across, up = axes.transData.transform((x, y)).tolist()
        if isinstance(item, Spans):
            up = axes.bbox.y1 - SPACING
        near = curve and dist((across, up), last) < SPACING
        if text and window.contains(across, up) and not near:
            last = across, up
            found.append(_point(across, height - up, text))
    return found[:MAX_POINTS]


def _attribute(key: str, value: str, name: str) -> str:
    """Return an attribute with its identifiers prefixed and its colours those of the theme."""
    if key == "id":
        return f"{name}-{value}"
    if key == f"{{{XLINK}}}href" and value.startswith("#"):
        return f"#{name}-{value[1:]}"
    value = value.replace("url(#", f"url(#{name}-")
    if key == "style":
        value = re.sub(r"'DejaVu Sans'.*?(?=;|$)", "sans-serif", value)
        for colour, themed in THEME.items():
            value = value.replace(colour, themed)
    return value


def _values(panel: Panel, item: Series) -> Iterator[tuple[float, float, str]]:
    """Give the points of a series in data coordinates, with their words: those of the series, or else their values."""
    if isinstance(item, Line | Points):
        for index, (x, y) in enumerate(zip(item.x, item.y, strict=True)):
            if x is not None and y is not None and isfinite(y):
                values = f"{item.label or panel.y.label}: {panel.y.text(y)}\n{panel.x.label} {panel.x.text(x)}"
                yield x, y, item.text[index] if item.text else values
    elif isinstance(item, Spans):
        for start, end, words in zip(item.starts, item.ends, item.text, strict=False):
            yield 0.5 * (start + end), 0.0, words


def _point(across: float, down: float, words: str) -> ElementTree.Element:
    """Return a transparent circle with its words, which the page shows on hover and focus."""
    group = ElementTree.Element("g", {"class": "point", "tabindex": "-1"})
    ElementTree.SubElement(group, "circle", {"cx": f"{across:.1f}", "cy": f"{down:.1f}", "r": f"{RADIUS:g}"})
    lines = [line for paragraph in words.splitlines() for line in wrapped(paragraph, LINE_CHARACTERS)]
    reach = CHARACTER * max(len(line) for line in lines)
    x = max(2.0, min(across - 0.5 * reach, POINTS_PER_INCH * WIDTH_INCHES - reach))
    above = ABOVE + LINE_HEIGHT * (len(lines) - 1)
    y = down - above if down > above + LINE_HEIGHT else down + ABOVE + LINE_HEIGHT
    text = ElementTree.SubElement(group, "text", {"x": f"{x:.1f}", "y": f"{y:.1f}"})
    for index, line in enumerate(lines):
        moved = {"x": f"{x:.1f}", "dy": f"{LINE_HEIGHT:g}"} if index else {}
        ElementTree.SubElement(text, "tspan", moved).text = line
    return group
