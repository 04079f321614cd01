"""Charts drawn by matplotlib, which is imported with this module and by no other."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator

from armour.reporting import charts
from armour.reporting.text import wrapped

# Formats of files, with what keeps two files of a chart the same.
METADATA: dict[str, Any] = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
FONT, TITLE = 9.0, 10.0
INK, SOFT = charts.PALETTE["ink"], charts.PALETTE["soft"]
STYLE: Any = {
    "axes.axisbelow": True,
    "axes.edgecolor": INK,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": FONT,
    "figure.constrained_layout.use": True,
    "font.size": FONT,
    "grid.alpha": 0.25,
    "grid.color": SOFT,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "armour",
    "text.color": INK,
    "text.parse_math": False,  # titles are the user's
    "xtick.color": INK,
    "ytick.color": INK,
}
# Heights, inches: an ordinary panel, a row of bars and a bar in it, axis labels, a line of text and of a legend.
PANEL_INCHES, ROW_INCHES, BAR_INCHES, LABELS_INCHES, LINE_INCHES, LEGEND_INCHES = 2.6, 0.08, 0.15, 0.5, 0.16, 0.19
# Widths of a character, as a part of the font's size, and characters in a line of a category.
CHARACTER, CATEGORY_CHARACTERS = 0.56, 22
# Width that axis labels take beside a panel, inches.
SIDE_INCHES = 0.8
# Weight of the distance between labels of contours, which are longer than lines are wide; points of a contour compared.
LABEL_WEIGHT, CONTOUR_POINTS = 0.4, 200
# Tint of a region, and what is behind names; part of the width that a name takes.
TINT, SIDE = 0.14, 0.33
BEHIND: Any = {"facecolor": charts.PALETTE["paper"], "alpha": 0.6, "linewidth": 0, "pad": 0.5}
# Format of the value on a contour.
VALUE = "%g"
# Resolution in notebooks, points per inch.
NOTEBOOK_DPI = 100


class NotebookFigure(Figure):
    """A figure that a notebook shows."""

    def _repr_png_(self) -> bytes:
        return saved(self, ".png", dpi=NOTEBOOK_DPI)


def draw(chart: charts.Chart, width: float | None = None) -> Figure:
    """Draw a chart in its own or another width, inches; the first axes are those of the panels, in their order."""
    chart = charts.printable_chart(chart)
    width = width or chart.width
    labels = [item.label for panel in chart.panels for item in panel.series if item.label]
    columns = _legend_columns(labels, width)
    title = "\n".join(line for part in chart.title.splitlines() for line in wrapped(part, _characters(width, TITLE)))
    note = "\n".join(wrapped(chart.note, _characters(width - SIDE_INCHES, 8.0)))
    heights = [_height(panel, width) for panel in chart.panels]
    texts = title.count("\n") + note.count("\n") + 2 * bool(title) + bool(note)
    legend = -(-len(labels) // columns)
    with mpl.rc_context(STYLE):
        figure = NotebookFigure(figsize=(width, sum(heights) + LINE_INCHES * texts + LEGEND_INCHES * legend))
        panels = figure.subplots(len(chart.panels), 1, squeeze=False, height_ratios=heights)[:, 0].tolist()
        for index, (axes, panel) in enumerate(zip(panels, chart.panels, strict=True)):
            if panel.shares_x:
                axes.sharex(panels[index - 1])
                panels[index - 1].tick_params(labelbottom=False)
                panels[index - 1].set_xlabel("")
            _draw_panel(axes, panel)
        if note:
            place: Any = {"xy": (0.0, 0.0), "xytext": (0.0, -34.0), "textcoords": "offset points"}
            panels[-1].annotate(note, **place, xycoords="axes fraction", va="top", fontsize=8.0, annotation_clip=False)
        if labels:
            figure.legend(loc="outside lower center", ncols=columns)
        if title:
            figure.suptitle(title, fontsize=TITLE)
    return figure


def _characters(width: float, size: float) -> int:
    """Return the number of characters of a size that fit into a width in inches."""
    return max(10, int(72.0 * width / (CHARACTER * size)))


def _legend_columns(labels: Sequence[str], width: float) -> int:
    """Return the number of columns of a legend that fit side by side."""
    longest = max((len(label) for label in labels), default=0) + 8
    return max(1, min(3, len(labels), _characters(width, 8.0) // longest))


def _height(panel: charts.Panel, width: float) -> float:
    """Return the height of a panel, inches."""
    if panel.square:
        return width - SIDE_INCHES + LABELS_INCHES
    if panel.to_scale:
        [across], [up] = (np.diff(axis.limits or (0.0, 1.0)) for axis in (panel.x, panel.y))
        return float((width - SIDE_INCHES) * up / across)
    if panel.y.categories:
        slots = max((item.slots for item in panel.series if isinstance(item, charts.Bars)), default=1)
        lines = max(_category(name).count("\n") + 1 for name in panel.y.categories)
        row = max(BAR_INCHES * slots + ROW_INCHES, LINE_INCHES * lines)
        return LABELS_INCHES + row * len(panel.y.categories)
    return PANEL_INCHES * panel.height


def _category(name: str) -> str:
    return "\n".join(wrapped(name, CATEGORY_CHARACTERS)) or name


def _draw_panel(axes: Axes, panel: charts.Panel) -> None:
    if panel.x.limits is not None:
        axes.set_xlim(panel.x.limits)
    if panel.y.limits is not None:
        axes.set_ylim(panel.y.limits)
    for item in panel.series:
        # A label that begins with an underscore has no place in a legend.
        label = f" {item.label}" if item.label.startswith("_") else item.label
        _draw_series(replace(item, label=label, colour=charts.PALETTE[item.colour]), axes)
    if panel.x.from_zero:
        axes.set_xlim(left=0.0)
    if panel.y.from_zero:
        axes.set_ylim(bottom=0.0)
    axes.set(title=panel.title, xlabel=panel.x.heading, ylabel=panel.y.heading)
    if panel.y.categories:
        axes.set_yticks(range(len(panel.y.categories)), [_category(name) for name in panel.y.categories])
        axes.set_ylim(len(panel.y.categories) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
    if panel.square or panel.to_scale:
        axes.set_aspect("equal")
    if panel.to_scale:
        axes.set_axis_off()
    _label_contours(axes)


@singledispatch
def _draw_series(item: charts.Series, _axes: Axes) -> None:
    """Draw a series into axes."""
    raise TypeError(f"must be a series, found {type(item).__name__}")


@_draw_series.register
def _(item: charts.Line, axes: Axes) -> None:
    style: Any = {"color": item.colour, "linestyle": item.style, "linewidth": item.width, "markerfacecolor": "none"}
    style |= {"marker": item.marker, "markersize": 5.0, "label": item.label}
    axes.plot(np.array(item.x, float), np.array(item.y, float), **style)


@_draw_series.register
def _(item: charts.Points, axes: Axes) -> None:
    x, y = np.array(item.x, float), np.array(item.y, float)
    # Markers on an edge are not cut, so that those beyond fixed limits must be left out.
    for values, limits, free in (
        (x, axes.get_xlim(), axes.get_autoscalex_on()),
        (y, axes.get_ylim(), axes.get_autoscaley_on()),
    ):
        if not free:
            values[(values < limits[0]) | (values > limits[1])] = np.nan
    for ends, values, axis in ((item.x_ends, x, "xerr"), (item.y_ends, y, "yerr")):
        if ends:
            low, high = np.array(ends).T
            # As lists: matplotlib 3.10 converts arrays of one element in a way that numpy deprecates.
            lengths = np.array([values - low, high - values]).tolist()
            bars: Any = {axis: lengths, "fmt": "none", "ecolor": item.colour, "capsize": 3.0}
            axes.errorbar(x, y, **bars)
    style: Any = {"color": item.colour, "markersize": item.size, "linestyle": "none", "clip_on": False, "zorder": 4}
    if not item.filled:
        style["markerfacecolor"] = "none"
    elif item.marker == "*" or item.label:
        style |= {"markeredgecolor": INK, "markeredgewidth": 0.6}
    axes.plot(x, y, item.marker, label=item.label, **style)
    for across, up, name in zip(x, y, item.names, strict=False):
        [(part, _)] = axes.transAxes.inverted().transform(axes.transData.transform([(across, up)])).tolist()
        right = part < (1.0 - SIDE if item.filled else SIDE)
        offset = (6.0 if right else -6.0, 5.0 if item.filled else -5.0)
        beside: Any = {"xytext": offset, "textcoords": "offset points", "ha": "left" if right else "right"}
        beside |= {"va": "bottom" if item.filled else "top", "color": item.colour, "zorder": 5, "fontsize": 8.0}
        axes.annotate(name, (across, up), bbox=BEHIND, **beside)


@_draw_series.register
def _(item: charts.Band, axes: Axes) -> None:
    style: Any = {"color": item.colour, "alpha": 0.3, "linewidth": 0, "label": item.label or None}
    axes.fill_between(*np.array([item.x, item.low, item.high], float), **style)


@_draw_series.register
def _(item: charts.Bars, axes: Axes) -> None:
    starts, ends = np.array(item.starts, float), np.array(item.ends, float)
    style: Any = {"height": 0.8 / item.slots, "color": item.colour, "label": item.label or None}
    axes.barh(item.places, ends - starts, left=starts, **style)


@_draw_series.register
def _(item: charts.Boxes, axes: Axes) -> None:
    style: Any = {"facecolor": item.colour, "edgecolor": INK, "linewidth": 0.5, "hatch": "xxx" if item.broken else None}
    for index, (left, bottom, width, height) in enumerate(item.places):
        label = "" if index else item.label
        axes.add_patch(Rectangle((left, bottom), width, height, label=label, **style))


@_draw_series.register
def _(item: charts.Words, axes: Axes) -> None:
    for x, y, words in zip(item.x, item.y, item.words, strict=True):
        axes.text(x, y, words, color=item.colour, ha="center", va="bottom", fontsize=7.0)


@_draw_series.register
def _(item: charts.Rule, axes: Axes) -> None:
    draw_line = axes.axvline if item.vertical else axes.axhline
    draw_line(item.at, color=item.colour, linestyle=item.style, linewidth=1.0, label=item.label or None)


@_draw_series.register
def _(item: charts.Spans, axes: Axes) -> None:
    for start, end in list(zip(item.starts, item.ends, strict=True))[::2]:
        axes.axvspan(start, end, color=SOFT, alpha=0.18, linewidth=0)
    low, high = axes.get_xlim()
    points_per_unit = 72.0 / axes.figure.dpi * axes.bbox.width / (high - low)
    for start, end, name in zip(item.starts, item.ends, item.names, strict=False):
        room = (end - start) * points_per_unit / (CHARACTER * 8.0)
        fitting = [words for words in (name, name.partition(":")[0]) if len(words) < room]
        if fitting:
            place = 0.5 * (start + end), 1.01
            axes.text(*place, fitting[0], transform=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=8.0)


@_draw_series.register
def _(item: charts.Map, axes: Axes) -> None:
    z = np.ma.masked_invalid(np.array(item.z, float))
    # The light part of the scale alone, on which lines and labels are legible.
    colours = ListedColormap(mpl.colormaps["Blues"](np.linspace(0.02, 0.5, 256)))
    axes.grid(visible=False)
    drawn = axes.pcolormesh(item.x, item.y, z, cmap=colours, shading="nearest", rasterized=True)
    axes.figure.colorbar(drawn, ax=axes, label=item.heading)


@_draw_series.register
def _(item: charts.Contours, axes: Axes) -> None:
    z = np.ma.masked_invalid(np.array(item.z, float))
    levels = MaxNLocator(item.levels).tick_values(z.min(), z.max())
    inside = np.array([level for level in item.at or tuple(levels) if z.min() < level < z.max()])
    axes.grid(visible=False)
    style: Any = {"colors": item.colour, "linewidths": item.width, "linestyles": item.style}
    if len(inside):
        # A label that begins with an underscore has no place in a legend.
        axes.contour(item.x, item.y, z, levels=inside, **style).set_label(
            f"_{item.words or ('' if item.at else VALUE)}"
        )
    if item.label:
        axes.plot([], [], color=item.colour, linewidth=item.width, linestyle=item.style, label=item.label)


@_draw_series.register
def _(item: charts.Region, axes: Axes) -> None:
    z = np.ma.masked_invalid(np.array(item.z, float))
    low, high = max(item.low, z.min() - 1.0), min(item.high, z.max() + 1.0)
    if low < z.max() and high > z.min():
        axes.contourf(item.x, item.y, z, levels=[low, high], colors=[item.colour], alpha=TINT)
        axes.fill([], [], color=item.colour, alpha=TINT, linewidth=0, label=item.label)


def _label_contours(axes: Axes) -> None:
    """Label every contour where it is farthest from edges, other contours and labels."""
    contours = [lines for lines in axes.collections if isinstance(lines, ContourSet) and lines.get_label() != "_"]
    contours = [lines for lines in contours if not lines.filled]
    curves = [[axes.transLimits.transform(_thinned(path.vertices)) for path in lines.get_paths()] for lines in contours]
    labels = _names_of_points(axes)
    for lines, own in zip(contours, curves, strict=True):
        first = len(labels)
        for curve in filter(len, own):
            others = [np.empty((0, 2)), *(other for found in curves for other in found if other is not curve)]
            edges = np.minimum(curve, 1.0 - curve).min(axis=1)
            apart = LABEL_WEIGHT * _distances(curve, labels)
            room = np.min([edges, apart, _distances(curve, np.concatenate(others))], axis=0)
            labels = np.append(labels, curve[[room.argmax()]], axis=0)
        places = axes.transLimits.inverted().transform(labels[first:])
        words = str(lines.get_label()).removeprefix("_")
        axes.clabel(
            lines, fontsize=7.0, fmt=VALUE if words == VALUE else lambda _, words=words: words, manual=places.tolist()
        )


def _names_of_points(axes: Axes) -> Any:
    """Return places of the names of points, as a part of the axes, (n, 2)."""
    found = [np.empty((0, 2))]
    for text in axes.texts:
        if isinstance(text, Annotation):
            sideways, up = np.sign(text.xyann)
            parts = np.linspace(0.0, SIDE, 4)[:, None] * [sideways, 0.0] + [0.0, 0.05 * up]
            found.append(axes.transLimits.transform(text.xy) + parts)
    return np.concatenate(found)


def _thinned(points: Any) -> Any:
    return points[:: 1 + len(points) // CONTOUR_POINTS]


def _distances(points: Any, others: Any) -> Any:
    """Return the distance of each point from the nearest of others, as a part of the axes."""
    return np.linalg.norm(points[:, None] - others, axis=2).min(axis=1, initial=np.inf)


def saved(figure: Figure, suffix: str, **options: Any) -> bytes:
    """Return a figure as a file of the format that the suffix names, a key of `METADATA`."""
    content = BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(content, format=suffix[1:], metadata=METADATA[suffix], **{"dpi": 160, **options})
    return content.getvalue()


def rendered(chart: charts.Chart, suffix: str) -> bytes:
    """Return a chart as a file of the format that the suffix names, a key of `METADATA`."""
    return saved(draw(chart), suffix)
