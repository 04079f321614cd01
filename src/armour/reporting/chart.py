"""Description of a chart: axes and series, independent of how they are drawn.

Numbers of series are sequences of equal length; None is a gap.  On hover a point shows its values or its ``text``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from armour.reporting.text import number, printable_lines

# Palette of Okabe and Ito, which colour-blind readers can tell apart.
BLUE, VERMILION, GREEN, ORANGE, PURPLE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7"
# Text and reference lines; a page replaces them by the colours of its theme.
INK, SOFT = "#16191c", "#80868c"
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, INK)
Style = str | tuple[int, tuple[int, ...]]
# Line styles and markers that go with the colours, so that series differ in more than colour.
STYLES: tuple[Style, ...] = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)))
MARKERS = ("o", "s", "^", "D", "v", "P")

Numbers = Sequence[float | None]


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
    colour: str = BLUE
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
    x_ends: tuple[tuple[float, float], ...] = ()
    y_ends: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Bars(Series):
    """Horizontal bars, one for each category of the y axis; ``slot`` of ``slots`` bars that share a row."""

    starts: Numbers
    ends: Numbers
    slot: int = 0
    slots: int = 1


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
    """Ranges of an x axis with limits, shaded in turn and named where there is room."""

    starts: Sequence[float]
    ends: Sequence[float]
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Map(Series):
    """A quantity over a grid, as colours; ``z[j][i]`` belongs to ``x[i]`` and ``y[j]``."""

    x: Sequence[float]
    y: Sequence[float]
    z: Sequence[Numbers]
    heading: str = ""


@dataclass(frozen=True)
class Contours(Series):
    """Labelled lines of equal value over a grid."""

    x: Sequence[float]
    y: Sequence[float]
    z: Sequence[Numbers]
    style: str = "solid"
    levels: int = 6


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


@dataclass(frozen=True)
class Chart:
    """A chart: panels below each other, with one legend, and a note such as the meaning of names in it."""

    title: str
    panels: tuple[Panel, ...]
    note: str = ""
    width: float = 5.2  # of a file, inches

    def headed(self, lines: Sequence[str]) -> "Chart":
        """Return the chart with lines above its title."""
        return replace(self, title="\n".join(filter(None, (*lines, self.title))))


def printable_chart(chart: Any) -> Any:
    """Return a chart, or a part of one, with the control characters of its texts escaped; line ends stay."""
    if isinstance(chart, str):
        return printable_lines(chart)
    if isinstance(chart, tuple):
        return tuple(printable_chart(part) for part in chart)
    if is_dataclass(chart) and not isinstance(chart, type):
        return replace(chart, **{field.name: printable_chart(getattr(chart, field.name)) for field in fields(chart)})
    return chart
