"""Charts as SVG within a page: in the page's colours, with the values of points shown on hover, focus and touch."""

import re
from collections.abc import Iterator
from dataclasses import replace
from math import dist
from textwrap import wrap
from typing import TYPE_CHECKING, NamedTuple
from xml.etree import ElementTree

from armour.reporting.chart import (
    BLUE,
    INK,
    SOFT,
    Axis,
    Bars,
    Chart,
    Line,
    Panel,
    Points,
    Series,
    Spans,
    printable_chart,
)
from armour.reporting.plots import bar_places, draw, saved

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
WIDTH_INCHES, POINTS_PER_INCH = 4.2, 72
# Colours that follow the theme of the page.
THEME = {INK: "var(--ink)", SOFT: "var(--soft)", BLUE: "var(--blue)"}
# Points of a series with a tooltip, and their least distance on a curve and radius, points of 1/72 inch.
MAX_POINTS, SPACING, RADIUS = 200, 4.0, 6.0
# Height of a line of a tooltip and its distance from the point, points.
LINE_HEIGHT, ABOVE = 10.5, 8.0
# Width of a character of a tooltip, points, and characters in a line of it.
CHARACTER, LINE_CHARACTERS = 5.0, 54


class _Place(NamedTuple):
    """A point of a chart in the SVG's coordinates, and its words."""

    x: float
    y: float
    text: str


def inline_svg(chart: Chart, name: str) -> str:
    """Return a chart without its title and note as an SVG element.

    Parameters
    ----------
    chart : Chart
    name : str
        Prefix of the element's identifiers, different for every chart of a page.
    """
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
            root.extend(_point(place) for place in _places(axes, panel, item, float(figure.bbox.height)))
    ElementTree.register_namespace("", SVG)
    ElementTree.register_namespace("xlink", XLINK)
    return ElementTree.tostring(root, encoding="unicode")


def _places(axes: "Axes", panel: Panel, item: Series, height: float) -> list[_Place]:
    """Return the points of a series that have words, at a distance from each other on a curve."""
    found: list[_Place] = []
    curve = isinstance(item, Line) and not item.marker
    window = axes.bbox.padded(1.0)
    for x, y, text in _values(panel, item):
        across, up = axes.transData.transform((x, y)).tolist()
        if isinstance(item, Spans):
            up = axes.bbox.y1 - SPACING
        place = _Place(across, height - up, text)
        near = curve and found and dist(place[:2], found[-1][:2]) < SPACING
        if window.contains(across, up) and not near:
            found.append(place)
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
    """Give the points of a series in data coordinates, with their words."""
    if isinstance(item, Line | Points):
        for index, (x, y) in enumerate(zip(item.x, item.y, strict=True)):
            words = item.text[index] if item.text else _coordinates(panel.x, panel.y, x, y, item.label)
            if x is not None and y is not None and words:
                yield x, y, words
    elif isinstance(item, Bars) and item.text:
        for start, end, place, words in zip(item.starts, item.ends, bar_places(item).tolist(), item.text, strict=True):
            if start is not None and end is not None and start != end:
                yield 0.5 * (start + end), place, words
    elif isinstance(item, Spans):
        for start, end, words in zip(item.starts, item.ends, item.text, strict=False):
            yield 0.5 * (start + end), 0.0, words


def _coordinates(x: Axis, y: Axis, at: float | None, value: float | None, label: str) -> str:
    if at is None or value is None:
        return ""
    return f"{label or y.label}: {y.text(value)}\n{x.label} {x.text(at)}"


def _point(place: _Place) -> ElementTree.Element:
    """Return a transparent circle with its words, which the page shows on hover and focus."""
    group = ElementTree.Element("g", {"class": "point", "tabindex": "-1"})
    ElementTree.SubElement(group, "circle", {"cx": f"{place.x:.1f}", "cy": f"{place.y:.1f}", "r": f"{RADIUS:g}"})
    lines = [line for paragraph in place.text.splitlines() for line in wrap(paragraph, LINE_CHARACTERS)]
    reach = CHARACTER * max(len(line) for line in lines)
    x = max(2.0, min(place.x - 0.5 * reach, POINTS_PER_INCH * WIDTH_INCHES - reach))
    above = ABOVE + LINE_HEIGHT * (len(lines) - 1)
    y = place.y - above if place.y > above + LINE_HEIGHT else place.y + ABOVE + LINE_HEIGHT
    text = ElementTree.SubElement(group, "text", {"x": f"{x:.1f}", "y": f"{y:.1f}"})
    for index, line in enumerate(lines):
        moved = {"x": f"{x:.1f}", "dy": f"{LINE_HEIGHT:g}"} if index else {}
        ElementTree.SubElement(text, "tspan", moved).text = line
    return group
