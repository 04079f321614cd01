"""Draw the parts that all pictures share: panels, marks, legends and titles, in common colours; save pictures."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import offset_copy

from armour.errors import mistake
from armour.reporting.table import in_words, printable_lines, wrapped

# The palette of Okabe and Ito, which colour-blind readers can tell apart, and the colours of text and reference lines.
BLUE, VERMILION, GREEN, ORANGE, PURPLE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7"
INK, SOFT = "#16191c", "#6a7178"
# Colours, line styles and markers of series one after the other, so that they differ in more than colour.
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, INK)
STYLES: Any = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)))
MARKERS = "os^DvP"
# Sizes of text, points: default, title, legend and names of marks, and labels in small type.
FONT, TITLE, NAME, SMALL_FONT = 9.0, 10.5, 8.0, 7.0
STYLE: Any = {
    "axes.axisbelow": True,
    **dict.fromkeys(("axes.edgecolor", "axes.labelcolor", "text.color", "xtick.color", "ytick.color"), INK),
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": FONT,
    "figure.constrained_layout.use": True,
    "font.size": FONT,
    "grid.alpha": 0.25,
    "grid.color": SOFT,
    "legend.fontsize": NAME,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.0,
    "svg.fonttype": "none",
    "svg.hashsalt": "armour",
    "text.parse_math": False,  # a title from the user may contain "$"
}
# A new figure starts from matplotlib's defaults, not from the settings of a user or a folder.
SETTINGS: Any = {key: value for key, value in mpl.rcParamsDefault.items() if key != "backend"} | STYLE
# Formats of files, with the metadata that make the files of a picture reproducible.
METADATA: dict[str, Any] = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
# Width of a picture and height of a panel, inches.
WIDTH, PANEL = 5.2, 2.6
# Width of a plain and of a bold character, as fractions of the font size.
CHARACTER, BOLD = 0.56, 0.64
# Styles of a reference line, of a shaded range, of a band about a curve.
RULE: Any = {"linewidth": 1.0, "color": INK}
SHADE: Any = {"color": SOFT, "alpha": 0.18, "linewidth": 0}
BAND: Any = {"alpha": 0.3, "linewidth": 0}


class NotebookFigure(Figure):
    """A figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        return saved(self, ".png", dpi=100)


@dataclass(frozen=True)
class Picture:
    """What a function that draws returns: panels, with a title that gives the answer and a note to put below."""

    axes: list[Axes]
    title: str
    note: str = ""

    @property
    def figure(self) -> Any:
        """The figure of the panels."""
        return self.axes[0].figure


@dataclass(frozen=True)
class Sheet:
    """What to draw on: a new figure, `width` inches wide, or the axes `ax` of a user."""

    width: float = WIDTH
    ax: Axes | None = None

    def panels(self, title: str, *heights: float, note: str = "", sharex: bool = False) -> Picture:
        """Return a picture with empty panels, one below the other, with the given heights, inches."""
        if self.ax is not None:
            if len(heights) > 1:
                raise mistake("plot", "ax", f"must not be given for a picture of {len(heights)} panels")
            return Picture([self.ax], title, note)
        figure = NotebookFigure(figsize=(self.width, sum(heights)))
        panels = figure.subplots(len(heights), squeeze=False, height_ratios=heights, sharex=sharex)
        return Picture(panels.ravel().tolist(), title, note)


def drawn(draw: Callable[[Sheet], Picture], sheet: Sheet, subject: str = "", title: str | None = None) -> Picture:
    """Return the picture that `draw` makes on a sheet, with its title, subject, note and legends added.

    `title` replaces the picture's title and the subject, which is what was drawn; an empty one leaves out title,
    subject and note.  A picture in a user's axes has neither subject nor note.
    """
    with mpl.rc_context(SETTINGS if sheet.ax is None else STYLE):
        picture = draw(sheet)
        lines = [picture.title, subject] if title is None else [title]
        for text in (text for axes in picture.axes for text in axes.findobj(Text)):
            text.set_text(printable_lines(text.get_text()))
        if sheet.ax is not None:
            room = sheet.ax.bbox.width / sheet.ax.figure.dpi
            sheet.ax.set_title("\n".join(_wrapped_lines([lines[0]], room, FONT)))
            if sheet.ax.get_legend_handles_labels()[0]:
                sheet.ax.legend()
            return picture
        if any(lines):
            _make_room(picture.figure, _write_title_and_note(picture.figure, list(filter(None, lines)), picture.note))
        picture.figure.draw_without_rendering()  # places the panels
        _make_room(picture.figure, [legend for axes in picture.axes for legend in _add_legend(axes)])
    return picture


def _make_room(figure: Any, parts: Sequence[Any]) -> None:
    """Make a figure taller by the height of its titles, notes or legends, so that its panels keep their height."""
    height = sum(part.get_window_extent().height for part in parts) / figure.dpi
    figure.set_figheight(figure.get_figheight() + height)


def _write_title_and_note(figure: Figure, lines: Sequence[str], note: str) -> list[Any]:
    """Write the title in bold, the subject beneath it, and the note below the panels, all at the left edge.

    `lines` has the title and, if there is one, the subject.  Return title and note, for which `_make_room` makes room.
    """
    width, (title, *subject) = figure.get_figwidth(), lines
    bold, plain = _wrapped_lines([title], width, TITLE, BOLD), _wrapped_lines(subject, width, FONT)
    look: Any = {"x": 0.05 / width, "ha": "left", "linespacing": 1.25}
    above = figure.suptitle("\n".join([*bold, *([""] * len(plain))]), fontsize=TITLE, fontweight="bold", **look)
    # Placed by its distance from the top edge, since a note or a legend makes the figure taller.
    place = offset_copy(figure.transFigure, figure, y=-0.05 - 1.25 * TITLE * len(bold) / 72.0, units="inches")
    figure.text(y=1.0, s="\n".join(plain), va="top", transform=place, **look)
    return [above, figure.supxlabel("\n".join(_wrapped_lines([note], width, NAME)), fontsize=NAME, **look)]


def _wrapped_lines(texts: Iterable[str], width: float, size: float, character: float = CHARACTER) -> list[str]:
    """Wrap texts to a width, inches; `size` is the font size, and `character` the mean width as a fraction of it."""
    room = max(10, int(72.0 * (width - 0.1) / (character * size)))
    return [line for text in texts for part in printable_lines(text).splitlines() for line in wrapped(part, room)]


def _add_legend(axes: Axes) -> list[Any]:
    """Add a legend of curves, marks and regions below a panel; return a list with it, empty if nothing has a label."""
    handles: list[Any] = axes.get_legend_handles_labels()[0]
    if not handles:
        return []
    figure: Any = axes.figure
    box: Any = axes.get_tightbbox()
    room = int(72.0 * box.width / figure.dpi / (CHARACTER * NAME))  # characters
    labels = ["\n".join(wrapped(handle.get_label(), room - 7)) for handle in handles]
    columns = room // (max(len(line) for label in labels for line in label.splitlines()) + 7)
    # The legend is at a fixed distance, in inches, below the panel, so that the panel keeps its height.
    left, down = (box.x0 - axes.bbox.x0) / figure.dpi, (axes.bbox.y0 - box.y0) / figure.dpi
    place = offset_copy(axes.transAxes, figure, x=left, y=-down, units="inches")
    look: Any = {"loc": "upper left", "bbox_to_anchor": (0.0, 0.0), "bbox_transform": place, "borderaxespad": 0.4}
    return [axes.legend(handles, labels, ncols=max(1, min(3, columns, len(handles))), **look)]


def saved(figure: Figure, suffix: str, made_by: str = "", **options: Any) -> bytes:
    """Return a figure as the content of a file; `suffix`, a key of `METADATA`, is its format.

    `made_by` is recorded in the file, and `options` are those of `Figure.savefig`.
    """
    content = BytesIO()
    metadata = METADATA[suffix] | {"Subject" if suffix == ".pdf" else "Description": made_by}
    with mpl.rc_context(SETTINGS):
        figure.draw_without_rendering()
        engine = figure.get_layout_engine()
        figure.set_layout_engine("none")
        # Rounded, because the last digits of a layout differ between processes, and identifiers in SVG depend on them.
        for axes in figure.axes:
            axes.set_position(np.round(axes.get_position(original=True).bounds, 9).tolist())
            axes.set_in_layout(True)
        figure.savefig(content, format=suffix[1:], metadata=metadata, **{"dpi": 160, **options})
        figure.set_layout_engine(engine)
    return content.getvalue()


def legible(label: str) -> str:
    """Return a user's text as a label for the legend, which would leave out one that begins with an underscore."""
    return printable_lines(f" {label}" if label.startswith("_") else label)


def look_of(index: int) -> dict[str, Any]:
    """Return colour and marker of the series at an index, as options of `plot`; if colours repeat, markers differ."""
    turn, colour = divmod(index, len(COLOURS))
    return {"color": COLOURS[colour], "marker": MARKERS[(colour + turn) % len(MARKERS)]}


def points(axes: Axes, x: Any, y: Any, *, filled: bool = True, **look: Any) -> None:
    """Draw separate points, whose marks may overlap the edge of the panel; `look` has options of `plot`."""
    style: Any = {"marker": "o", "linestyle": "none", "clip_on": False, "zorder": 4, "markeredgewidth": 0.6}
    style |= {"markeredgecolor": INK} if filled else {"markerfacecolor": "none", "markeredgewidth": 1.0}
    if len(x):
        axes.plot(x, y, **style | look)


def curve(axes: Axes, x: Any, y: Any, is_outside: Any, **look: Any) -> None:
    """Draw a curve through n points, dashed and with hollow marks where `is_outside`, (n,), is true.

    `look` has options of `plot`.
    """
    outside = {"markerfacecolor": "none", "linestyle": "--"} if is_outside.any() else {}
    axes.plot(x, y, **look | outside)
    if outside and not is_outside.all():
        axes.plot(x, np.where(is_outside, np.nan, y), **look | {"label": "_nolegend_"})


def ranges(axes: Axes, y: Any, ends: Sequence[Sequence[float]], colour: str) -> None:
    """Draw a horizontal bar at each of the given y, between the two x in `ends`."""
    low, high = np.sort(np.array(ends, float), axis=1).T
    # As lists: matplotlib 3.10 converts arrays of one element in a way that numpy deprecates.
    middles, halves = (0.5 * (low + high)).tolist(), (0.5 * (high - low)).tolist()
    axes.errorbar(middles, list(y), xerr=halves, fmt="none", ecolor=colour, capsize=3.0)


def velocity_line(axes: Axes, velocity: float | None, colour: str, style: str, name: str = "") -> None:
    """Draw a vertical line at a velocity, m/s, unless it is None; with a name, it is in the legend."""
    if velocity is not None:
        label = f"{name} {velocity:.1f} m/s" if name else ""
        axes.axvline(velocity, linestyle=style, linewidth=1.0, color=colour, label=label)


def contours(
    axes: Axes, x: Any, y: Any, z: Any, levels: Any, *, numbered: bool = False, label: str = "", **look: Any
) -> None:
    """Draw contours of z, (y, x), with their levels beside them if `numbered`.

    `levels` has the levels, or is about how many to draw.
    """
    z = np.ma.masked_invalid(np.array(z, float))
    if np.ndim(levels) == 0:
        levels = MaxNLocator(levels).tick_values(z.min(), z.max())
    axes.grid(visible=False)
    inside = [level for level in levels if z.min() < level < z.max()]
    style: Any = {"color": INK, "linewidth": 0.8, "linestyle": "-"} | look
    if inside:
        lines = axes.contour(x, y, z, levels=inside, **{f"{name}s": value for name, value in style.items()})
        if numbered:
            axes.clabel(lines, fontsize=SMALL_FONT, fmt="%g")
    if label:
        axes.plot([], [], label=label, **style)


def colours_of(axes: Axes, x: Any, y: Any, z: Any, heading: str) -> None:
    """Draw a quantity z, (y, x), as colours, light enough for lines and names on them, with a bar headed `heading`."""
    axes.grid(visible=False)
    mesh = axes.pcolormesh(x, y, np.ma.masked_invalid(z), cmap="Blues", alpha=0.5, shading="nearest", rasterized=True)
    axes.figure.colorbar(mesh, ax=axes, label=heading)


def rows_height(names: Iterable[str], *, titled: bool = False) -> float:
    """Return the height of a panel that `rows` draws in, inches, with a row for each name and, if `titled`, a title."""
    lines = max((len(wrapped(name, 22)) for name in names), default=1)
    return 0.6 + 0.2 * titled + max(0.21, 0.16 * lines) * len(list(names))


def rows(axes: Axes, names: Sequence[str], values: Mapping[str, Sequence[Any]], start: float | None = None) -> None:
    """Draw series of values as marks, with a row for each name, the first on top.

    `values` has the series by label, each with an x for every name, None to leave it out.  If `start` is given, a stem
    joins each mark to this x.
    """
    axes.set_yticks(range(len(names)), ["\n".join(wrapped(printable_lines(name), 22)) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0.0)
    axes.margins(x=0.08)
    if start is not None:
        axes.axvline(start, **RULE)
    for index, (label, series) in enumerate(values.items()):
        numbers, look = np.array(series, float), look_of(index)
        places = np.flatnonzero(np.isfinite(numbers))
        if start is not None:
            axes.hlines(places, start, numbers[places], color=SOFT, linewidth=1.0)
        points(axes, numbers[places], places, label=legible(label), filled=not index, **look)


def agreement(axes: Axes, quantity: str, word: str, groups: Mapping[str, Sequence[tuple[Any, Any, float]]]) -> None:
    """Draw computed over expected values of a quantity, with lines of agreement and of deviations of ± 10 %.

    `word` names the expected values on the axis.  `groups` has by label the expected and the computed values, each with
    the standard deviation of the expected one, 0 if none is known.
    """
    heading, pairs = in_words(quantity), [pair for group in groups.values() for pair in group]
    low, high = widened(end for expected, computed, d in pairs for end in (expected - d, expected + d, computed))
    # If the values are close together, widen the axes to show the lines on both sides.
    margin = 0.1 * high if high - low < 0.1 * high else 0.0
    span = low - margin, high + margin
    axes.set(xlabel=f"{word} {heading}", ylabel=f"computed {heading}", xlim=span, ylim=span)
    axes.set_aspect("equal")
    for index, (label, group) in enumerate(groups.items()):
        expected, computed, deviations = zip(*group, strict=True)
        look = look_of(index) | {"label": legible(label), "markersize": 5.0 if len(pairs) <= 100 else 3.0}
        if any(deviations):
            ranges(axes, computed, [(value - d, value + d) for value, _, d in group], look["color"])
        points(axes, expected, computed, filled=False, **look)
    for factor, label, style in ((1.0, "agreement", "-"), (0.9, "± 10 %", ":"), (1.1, "", ":")):
        axes.plot(span, [factor * end for end in span], linestyle=style, color=INK, linewidth=0.8, label=label)


def widened(values: Iterable[float], part: float = 0.05) -> tuple[float, float]:
    """Return the least and greatest value, moved apart by a fraction of their difference at each end."""
    numbers = list(values)
    margin = part * (max(numbers) - min(numbers)) or 0.05 * abs(numbers[0]) or 1.0
    return min(numbers) - margin, max(numbers) + margin
