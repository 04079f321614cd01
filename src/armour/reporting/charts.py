"""Description of a chart: axes and series, independent of how they are drawn, and those that several charts have.

Numbers of series are sequences of equal length; None or NaN is a gap.  On hover a point shows its values or its
``text``.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.quantities import label_and_unit
from armour.analysis.results import Result
from armour.errors import InputError, Problem
from armour.reporting.text import number, percent, printable_lines
from armour.scenario.inputs import VELOCITY

# The palette of Okabe and Ito, which colour-blind readers can tell apart, and the colours of text and reference lines.
PALETTE = {
    "blue": "#0072b2",
    "vermilion": "#d55e00",
    "green": "#009e73",
    "orange": "#e69f00",
    "purple": "#cc79a7",
    "ink": "#16191c",
    "soft": "#6a7178",
    "paper": "#ffffff",
    "ceramic": "#d9c48f",
    "metal": "#a9b8c6",
    "rod": "#5c6875",
}
# Colours of series one after the other.
COLOURS = tuple(PALETTE)[:6]
Style = str | tuple[int, tuple[int, ...]]
# Line styles and markers that go with the colours, so that series differ in more than colour.
STYLES: tuple[Style, ...] = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)))
MARKERS = ("o", "s", "^", "D", "v", "P")

# Points of a panel up to which their marks are large.
MANY = 100

Numbers = Sequence[float | None]
# Width of a column of a two-column page, inches.
COLUMN_INCHES = 3.45


@dataclass(frozen=True)
class Axis:
    """An axis: a quantity in words and its unit, or the names of rows of bars, the first on top."""

    label: str = ""
    unit: str = ""
    from_zero: bool = False
    limits: tuple[float, float] | None = None
    categories: tuple[str, ...] = ()
    spec: str = ".5g"  # format specification of values

    @property
    def heading(self) -> str:
        """Return the label with its unit."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def text(self, value: float) -> str:
        """Return a value with its unit."""
        return f"{number(value, self.spec)} {self.unit}".rstrip()


@dataclass(frozen=True, kw_only=True)
class Series:
    """What all series have: their name in the legend, their colour, and the words of each point."""

    label: str = ""
    colour: str = "blue"  # of the palette
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Line(Series):
    """A curve."""

    x: Numbers
    y: Numbers
    style: Style = "-"
    width: float = 1.6
    marker: str = ""


@dataclass(frozen=True)
class Points(Series):
    """Separate points, with the ends of their error bars where they have some."""

    x: Numbers
    y: Numbers
    marker: str = "o"
    size: float = 5.0
    filled: bool = True
    # Beside the points: above to the right of those that are filled, below to the left of others.
    names: tuple[str, ...] = ()
    x_ends: tuple[tuple[float, float], ...] = ()
    y_ends: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Band(Series):
    """The area between two curves."""

    x: Numbers
    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class Rule(Series):
    """A reference line across the panel."""

    at: float
    style: Style = "-"
    vertical: bool = True


@dataclass(frozen=True)
class Spans(Series):
    """Ranges of an x axis with limits, shaded in turn.

    They are named where there is room, or by what precedes a colon.
    """

    starts: Sequence[float]
    ends: Sequence[float]
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Box(Series):
    """A rectangle; one of a broken material is hatched."""

    left: float
    right: float
    bottom: float
    top: float
    broken: bool = False


@dataclass(frozen=True)
class Words(Series):
    """Words at places along a line, on which they stand, or below which they hang."""

    x: Sequence[float]
    y: float
    words: tuple[str, ...]
    above: bool = True


@dataclass(frozen=True)
class OnGrid(Series):
    """A quantity over a grid; ``z[j][i]`` belongs to ``x[i]`` and ``y[j]``."""

    x: Sequence[float]
    y: Sequence[float]
    z: Sequence[Numbers]


@dataclass(frozen=True)
class Map(OnGrid):
    """A quantity over a grid, as colours."""

    heading: str = ""


@dataclass(frozen=True)
class Contours(OnGrid):
    """Lines of equal value over a grid: at given values, with words, or at about so many round ones, with these."""

    style: str = "solid"
    levels: int = 6
    at: tuple[float, ...] = ()
    words: str = ""
    width: float = 0.8


@dataclass(frozen=True)
class Region(OnGrid):
    """The part of a grid where a quantity is at least one value and below another, tinted."""

    low: float = -np.inf
    high: float = np.inf


@dataclass(frozen=True)
class Panel:
    """Axes with their series, in the order in which they are drawn."""

    x: Axis
    y: Axis
    series: tuple[Series, ...]
    title: str = ""
    height: float = 1.0  # as a part of an ordinary panel's; rows of bars add to it
    square: bool = False  # both axes have the same scale and limits
    shares_x: bool = False  # the x axis is that of the panel above
    to_scale: bool = False  # a drawing: both axes, which have limits, have the same scale and are not shown


@dataclass(frozen=True)
class Chart:
    """A chart: panels below each other, a title that is the answer, what it is about, and a note.

    Names of series stand beside them where there is room, and else in a legend.
    """

    title: str
    panels: tuple[Panel, ...]
    note: str = ""
    width: float = 5.2  # of a file, inches
    subject: str = ""
    beside: bool = False  # the panels stand side by side and share their rows

    def about(self, heading: Sequence[str]) -> "Chart":
        """Return the chart with its subject, the first line of a heading."""
        subject = "".join(heading[:1])
        return replace(self, subject=subject) if self.title else replace(self, title=subject)


def printable_chart(chart: Any) -> Any:
    """Return a chart, or a part of one, with the control characters of its texts escaped; line ends stay."""
    if isinstance(chart, str):
        return printable_lines(chart)
    if isinstance(chart, tuple):
        return tuple(printable_chart(part) for part in chart)
    if is_dataclass(chart) and not isinstance(chart, type):
        return replace(chart, **{field.name: printable_chart(getattr(chart, field.name)) for field in fields(chart)})
    return chart


def quantity_axis(name: str, **options: Any) -> Axis:
    """Return the axis of a quantity, an input or a key of a scenario, in words."""
    words, unit = label_and_unit(name)
    return Axis(words, unit, **options)


def velocity_rule(label: str, velocity: float, colour: str, style: Style = "-") -> Rule:
    """Return a line at a velocity, with its value in its name."""
    return Rule(velocity, style, label=f"{label} {velocity:.1f} m/s", colour=colour)


def residual_velocity_panel(series: Iterable[Series], limits: tuple[float, float]) -> Panel:
    """Describe residual over impact velocity."""
    x = quantity_axis(VELOCITY, limits=limits)
    return Panel(x, quantity_axis("residual_velocity_m_s", from_zero=True), tuple(series), height=1.2)


def look_of(index: int) -> dict[str, Any]:
    """Return colour and marker of one of several series; when colours repeat, they have other markers."""
    turn, colour = divmod(index, len(COLOURS))
    return {"colour": COLOURS[colour], "marker": MARKERS[(colour + turn) % len(MARKERS)]}


class Compared(NamedTuple):
    """A known and a computed value, with their name, the word for the known one and its standard deviation, if any."""

    name: str
    word: str
    known: float
    computed: float
    deviation: float = 0.0

    def text(self, axis: Axis) -> str:
        """Return both values in words."""
        within = f" ± {axis.text(self.deviation)}" if self.deviation else ""
        return f"{self.name}\n{self.word} {axis.text(self.known)}{within}, computed {axis.text(self.computed)}"

    def ends(self) -> tuple[float, float]:
        """Return the known value less and plus its standard deviation."""
        return self.known - self.deviation, self.known + self.deviation


def agreement_panel(quantity: str, word: str, groups: Mapping[str, Sequence[Compared]], part: float = 0.0) -> Panel:
    """Describe computed over known values, with lines of agreement and, on request, a part away from it."""
    axis = quantity_axis(quantity)
    series: list[Series] = []
    every = [point for points in groups.values() for point in points]
    for index, (label, points) in enumerate(groups.items()):
        marks: dict[str, Any] = {"filled": False, "size": 5.0 if len(every) <= MANY else 3.0, "label": label}
        marks["text"] = tuple(point.text(axis) for point in points)
        marks["x_ends"] = tuple(point.ends() for point in points) if any(p.deviation for p in points) else ()
        series.append(Points([p.known for p in points], [p.computed for p in points], **marks, **look_of(index)))
    span = widened(value for point in every for value in (*point.ends(), point.computed))
    lines = [(1.0, "agreement", "-")]
    if part:
        # Few points that are near each other are shown with the lines beside them.
        margin = part * span[1] if span[1] - span[0] < part * span[1] else 0.0
        span = span[0] - margin, span[1] + margin
        lines += [(1.0 - part, f"± {percent(part)}", ":"), (1.0 + part, "", ":")]
    for factor, label, style in lines:
        across = [factor * end for end in span]
        series.append(Line(span, across, style, 0.8, label=label, colour="ink", text=("", "")))
    x, y = (replace(axis, label=f"{prefix} {axis.label}", limits=span) for prefix in (word, "computed"))
    return Panel(x, y, tuple(series), square=True)


def widened(values: Iterable[float], part: float = 0.05) -> tuple[float, float]:
    """Return the range of values, wider by a part of it at each end."""
    found = list(values)
    margin = part * (max(found) - min(found)) or 0.05 * abs(found[0]) or 1.0
    return min(found) - margin, max(found) + margin


def grouped(items: Iterable[Any], key: Callable[[Any], str]) -> dict[str, list[Any]]:
    """Return items by a key."""
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def rows_panel(
    x: Axis,
    names: tuple[str, ...],
    values: Mapping[str, Sequence[float | None]],
    title: str = "",
    start: float | None = None,
) -> Panel:
    """Describe values of each name as marks in its row, from a start on with stems."""
    series: list[Series] = [] if start is None else [Rule(start, colour="ink")]
    for index, (label, found) in enumerate(values.items()):
        known = [(float(place), value) for place, value in enumerate(found) if value is not None and np.isfinite(value)]
        ends = () if start is None else tuple((min(start, value), max(start, value)) for _, value in known)
        text = tuple(f"{names[int(place)]}\n{label}: {x.label} {x.text(value)}" for place, value in known)
        marks: dict[str, Any] = {"filled": not index, "x_ends": ends, "label": label, "text": text}
        series.append(Points([value for _, value in known], [place for place, _ in known], **marks, **look_of(index)))
    return Panel(x, Axis(categories=names), tuple(series), title)


def on_grid(x: Any, y: Any, values: Any) -> tuple[Any, Any, Any]:
    """Return the different x and y of points in order, and their values, z[j, i] at x[i] and y[j]; NaN without one."""
    xs, ys = np.unique(x), np.unique(y)
    z = np.full((len(ys), len(xs)), np.nan)
    z[np.searchsorted(ys, y), np.searchsorted(xs, x)] = values
    return xs, ys, z


def needed(result: Result, key: str) -> Any:
    """Return what a chart shows beside the result, its scenario or its shots; only a result made by hand has none."""
    if (value := result.question.get(key)) is None:
        raise InputError([Problem("plot", key, "must be given to draw this result")])
    return value
