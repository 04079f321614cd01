"""Description of a chart: axes and series, independent of how they are drawn.

Numbers of series are sequences of equal length; None is a gap.  ``text`` gives each point the words shown on hover in
place of its coordinates.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from armour.reporting.text import printable

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

    @property
    def heading(self) -> str:
        """Return the label with its unit."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    def text(self, value: float) -> str:
        """Return a value with its unit."""
        return f"{value:.5g} {self.unit}".rstrip()


@dataclass(frozen=True)
class Line:
    """A curve."""

    x: Numbers
    y: Numbers
    label: str = ""
    colour: str = BLUE
    style: Style = "-"
    width: float = 1.6
    marker: str = ""
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Points:
    """Separate points, with the ends of their error bars where they have some."""

    x: Numbers
    y: Numbers
    label: str = ""
    colour: str = BLUE
    marker: str = "o"
    size: float = 5.0
    filled: bool = True
    x_ends: tuple[tuple[float, float], ...] = ()
    y_ends: tuple[tuple[float, float], ...] = ()
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Bars:
    """Horizontal bars, one for each category of the y axis; ``slot`` of ``slots`` bars that share a row."""

    starts: Numbers
    ends: Numbers
    label: str = ""
    colour: str = BLUE
    slot: int = 0
    slots: int = 1
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Band:
    """The area between two curves."""

    x: Numbers
    low: Numbers
    high: Numbers
    label: str = ""
    colour: str = BLUE


@dataclass(frozen=True)
class Rule:
    """A reference line across the panel."""

    at: float
    label: str = ""
    colour: str = INK
    style: Style = "-"
    vertical: bool = True


@dataclass(frozen=True)
class Spans:
    """Ranges of the x axis, shaded in turn and named where there is room."""

    starts: Sequence[float]
    ends: Sequence[float]
    names: tuple[str, ...] = ()
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Map:
    """A quantity over a grid, as colours; ``z[j][i]`` belongs to ``x[i]`` and ``y[j]``."""

    x: Sequence[float]
    y: Sequence[float]
    z: Sequence[Numbers]
    heading: str = ""


@dataclass(frozen=True)
class Contours:
    """Labelled lines of equal value over a grid; ``at`` is where labels go, as a part of the x axis."""

    x: Sequence[float]
    y: Sequence[float]
    z: Sequence[Numbers]
    colour: str = INK
    style: str = "solid"
    levels: int = 6
    at: float = 0.5


Series = Line | Points | Bars | Band | Rule | Spans | Map | Contours


@dataclass(frozen=True)
class Panel:
    """Axes with their series.

    Attributes
    ----------
    x, y : Axis
    series : tuple of Series
        In the order in which they are drawn.
    title : str
    height : float
        As a part of an ordinary panel's; rows of bars add to it.
    square : bool
        Whether both axes have the same scale and limits.
    shares_x : bool
        Whether the x axis is that of the panel above.
    """

    x: Axis
    y: Axis
    series: tuple[Series, ...]
    title: str = ""
    height: float = 1.0
    square: bool = False
    shares_x: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart: panels below each other, with one legend.

    Attributes
    ----------
    title : str
    panels : tuple of Panel
    note : str
        What a reader needs to know of the chart, such as the meaning of names in it.
    width : float
        Of a file, inches.
    """

    title: str
    panels: tuple[Panel, ...]
    note: str = ""
    width: float = 5.2


def printable_chart(chart: Chart) -> Chart:
    """Return a chart with the control characters of its texts escaped; line ends stay."""
    found: Chart = _printable(chart)
    return found


def _printable(value: Any) -> Any:
    if isinstance(value, str):
        return "\n".join(printable(line) for line in value.split("\n"))
    if isinstance(value, tuple):
        return tuple(_printable(item) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: _printable(getattr(value, field.name)) for field in fields(value)})
    return value
