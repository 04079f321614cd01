"""Charts drawn by matplotlib, which is imported with this module and by no other."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import offset_copy

from armour.reporting import charts
from armour.reporting.text import wrapped

# Formats of files, with what keeps two files of a chart the same.
METADATA: dict[str, Any] = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
FONT, TITLE, NAME, SMALL = 9.0, 10.5, 8.0, 7.0
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
# Heights, inches: an ordinary panel, a row, axis labels, a line of text and of a legend.
PANEL_INCHES, ROW_INCHES, LABELS_INCHES, LINE_INCHES, LEGEND_INCHES = 2.6, 0.21, 0.5, 0.16, 0.19
# Widths of a character and of a bold one, as a part of the font's size, and characters in a line of a category.
CHARACTER, BOLD, CATEGORY_CHARACTERS = 0.56, 0.64, 22
# Distance of titles from the edges of a figure, and of a line of them from the next, as a part of the font's size.
EDGE_INCHES, LEADING = 0.05, 1.25
# Names beside lines: characters in a line, at best and at least; the distance of a name from its own line and at least
# from others, beyond which more is no better, and that of the places that are tried, points; markers of a series at
# most that has its name beside one of them.
NAME_CHARACTERS, GAP, APART, FAR, STEP, FEW = (26, 13), 3.0, 4.0, 20.0, 6.0, 6
# Width that axis labels take beside a panel, inches.
SIDE_INCHES = 0.8
# Weight of the distance between labels of contours, which are longer than lines are wide; points of a contour compared.
LABEL_WEIGHT, CONTOUR_POINTS = 0.4, 200
# Distance from an edge within which a label would be cut, as a part of the axes.
EDGE = 0.06
# Tint of a region, and what is behind names; parts of the width and of the height that a name takes.
TINT, SIDE, DOWN = 0.14, 0.33, 0.1
BEHIND: Any = {"facecolor": charts.PALETTE["paper"], "alpha": 0.6, "linewidth": 0, "pad": 0.5}
# Colours in which text is hard to read on paper.
PALE = {charts.PALETTE[name] for name in ("orange", "purple")}
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
    title = _wrapped(chart.title, _characters(width - 2.0 * EDGE_INCHES, TITLE, BOLD))
    subject = _wrapped(chart.subject, _characters(width - 2.0 * EDGE_INCHES, FONT))
    note = "\n".join(_wrapped(chart.note, _characters(width - 2.0 * EDGE_INCHES, NAME)))
    heights = [_height(panel, width) for panel in chart.panels]
    if chart.beside:
        heights = [max(heights) + LINE_INCHES * 2]
    head = LEADING / 72.0 * (TITLE * len(title) + FONT * len(subject))
    with mpl.rc_context(STYLE):
        figure = NotebookFigure(figsize=(width, sum(heights) + head + LINE_INCHES * (note.count("\n") + bool(note))))
        rows = chart.beside and bool(chart.panels[0].y.categories)
        shape = (1, len(chart.panels)) if chart.beside else (len(chart.panels), 1)
        grid = figure.subplots(*shape, squeeze=False, sharey=rows, height_ratios=heights)
        panels: list[Axes] = grid.ravel().tolist()
        for index, (axes, panel) in enumerate(zip(panels, chart.panels, strict=True)):
            if panel.shares_x:
                axes.sharex(panels[index - 1])
                panels[index - 1].tick_params(labelbottom=False)
                panels[index - 1].set_xlabel("")
            own = "\n".join(wrapped(panel.title, _characters(width / len(panels), FONT) - 5 if chart.beside else 1000))
            _draw_panel(axes, replace(panel, title=own))
        if note:
            figure.supxlabel(note, fontsize=NAME, x=EDGE_INCHES / width, ha="left")
        _write_titles(figure, title, subject)
        figure.draw_without_rendering()  # places the panels
        shown = [(axes, panel) for axes, panel in zip(panels, chart.panels, strict=True) if not panel.to_scale]
        if handles := [h for axes, panel in shown for h in _name_in_place(axes, rows=bool(panel.y.categories))]:
            longest = max(len(handle.get_label()) for handle in handles) + 8
            columns = max(1, min(3, len(handles), _characters(width, NAME) // longest))
            height = figure.get_figheight() + LEGEND_INCHES * -(-len(handles) // columns)
            figure.set_figheight(height)
            figure.supxlabel("")  # the legend has the note, as both have their place below the panels
            title_of: Any = {"title": note or None, "title_fontsize": NAME, "alignment": "left"}
            figure.legend(handles=handles, loc="outside lower center", ncols=columns, **title_of)
    return figure


def _wrapped(text: str, width: int) -> list[str]:
    return [line for part in text.splitlines() for line in wrapped(part, width)]


def _write_titles(figure: Figure, title: Sequence[str], subject: Sequence[str]) -> None:
    """Write the title, bold, and beneath it what it is about, at the left edge."""
    lines = [*title, *([""] * len(subject))]
    look: Any = {"x": EDGE_INCHES / figure.get_figwidth(), "ha": "left", "linespacing": LEADING}
    if lines:
        figure.suptitle("\n".join(lines), fontsize=TITLE, fontweight="bold", **look)
    if subject:
        # At a distance from the edge: a legend makes the figure higher.
        down = EDGE_INCHES + LEADING * TITLE * len(title) / 72.0
        place = offset_copy(figure.transFigure, figure, y=-down, units="inches")
        figure.text(y=1.0, s="\n".join(subject), va="top", transform=place, **look)


def _characters(width: float, size: float, character: float = CHARACTER) -> int:
    """Return the number of characters of a size that fit into a width in inches."""
    return max(10, int(72.0 * width / (character * size)))


def _height(panel: charts.Panel, width: float) -> float:
    """Return the height of a panel, inches."""
    if panel.square:
        return width - SIDE_INCHES + LABELS_INCHES
    heading = LINE_INCHES if panel.title else 0.0
    if panel.to_scale:
        [across], [up] = (np.diff(axis.limits or (0.0, 1.0)) for axis in (panel.x, panel.y))
        words = [text for item in panel.series if isinstance(item, charts.Words) for text in item.words]
        lines = max((text.count("\n") + 1 for text in words), default=0)
        return float((width - 0.1) * up / across) + 1.3 * SMALL / 72.0 * lines
    if panel.y.categories:
        lines = max(_category(name).count("\n") + 1 for name in panel.y.categories)
        row = max(ROW_INCHES, LINE_INCHES * lines)
        return heading + LABELS_INCHES + row * len(panel.y.categories)
    return heading + PANEL_INCHES * panel.height


def _category(name: str) -> str:
    return "\n".join(wrapped(name, CATEGORY_CHARACTERS))


def _draw_panel(axes: Axes, panel: charts.Panel) -> None:
    if panel.x.limits is not None:
        axes.set_xlim(panel.x.limits)
    if panel.y.limits is not None:
        axes.set_ylim(panel.y.limits)
    for item in panel.series:
        # A label that begins with an underscore has no place in a legend.
        label = f" {item.label}" if item.label.startswith("_") else item.label
        _draw_series(replace(item, label=label, colour=charts.PALETTE[item.colour]), axes)
    if panel.y.from_zero:
        axes.set_ylim(bottom=0.0)
    axes.set(title=panel.title, xlabel=panel.x.heading, ylabel=panel.y.heading)
    if panel.y.categories:
        axes.set_yticks(range(len(panel.y.categories)), [_category(name) for name in panel.y.categories])
        axes.set_ylim(len(panel.y.categories) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
        axes.margins(x=0.08)
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
            values[(values < min(limits)) | (values > max(limits))] = np.nan
    if not np.isfinite(x + y).any():
        return  # a line without points takes room at the corner of the figure
    for ends, axis in ((item.x_ends, "x"), (item.y_ends, "y")):
        if ends:
            low, high = np.array(ends).T
            # An interval need not contain its point: the limit of the model may lie beyond that with the model error.
            seen, middle, length = np.isfinite(x + y), 0.5 * (low + high), 0.5 * (high - low)
            # As lists: matplotlib 3.10 converts arrays of one element in a way that numpy deprecates.
            given = {"x": x, "y": y, axis: middle, f"{axis}err": length}
            bars: Any = {name: values[seen].tolist() for name, values in given.items()}
            axes.errorbar(**bars, fmt="none", ecolor=item.colour, capsize=3.0)
    style: Any = {"color": item.colour, "markersize": item.size, "linestyle": "none", "clip_on": False, "zorder": 4}
    if not item.filled:
        style["markerfacecolor"] = "none"
    elif item.marker == "*" or item.label:
        style |= {"markeredgecolor": INK, "markeredgewidth": 0.6}
    axes.plot(x, y, item.marker, label=item.label, **style)
    for across, up, name in zip(x, y, item.names, strict=False):
        [(part, height)] = axes.transAxes.inverted().transform(axes.transData.transform([(across, up)])).tolist()
        right = part < (1.0 - SIDE if item.filled else SIDE)
        above = item.filled or height < DOWN
        offset = (6.0 if right else -6.0, 5.0 if above else -5.0)
        beside: Any = {"xytext": offset, "textcoords": "offset points", "ha": "left" if right else "right"}
        beside |= {"va": "bottom" if above else "top", "zorder": 5, "fontsize": NAME}
        axes.annotate(name, (across, up), bbox=BEHIND, **beside)


@_draw_series.register
def _(item: charts.Band, axes: Axes) -> None:
    style: Any = {"color": item.colour, "alpha": 0.3, "linewidth": 0, "label": item.label}
    axes.fill_between(*np.array([item.x, item.low, item.high], float), **style)


@_draw_series.register
def _(item: charts.Box, axes: Axes) -> None:
    style: Any = {"facecolor": item.colour, "edgecolor": INK, "linewidth": 0.5, "hatch": "xxx" if item.broken else None}
    axes.add_patch(Rectangle((item.left, item.bottom), item.right - item.left, item.top - item.bottom, **style))


@_draw_series.register
def _(item: charts.Words, axes: Axes) -> None:
    low, high = axes.get_xlim()
    room = np.diff(item.x).min(initial=high - low) * 72.0 / axes.figure.dpi * axes.bbox.width / (high - low)
    longest = max(len(line) for words in item.words for line in words.splitlines())
    look: Any = {"ha": "center", "va": "bottom" if item.above else "top"}
    look["fontsize"] = min(SMALL, room / (CHARACTER * (longest + 1)))
    for x, words in zip(item.x, item.words, strict=True):
        axes.text(x, item.y, words, **look)


@_draw_series.register
def _(item: charts.Rule, axes: Axes) -> None:
    draw_line = axes.axvline if item.vertical else axes.axhline
    draw_line(item.at, color=item.colour, linestyle=item.style, linewidth=1.0, label=item.label)


@_draw_series.register
def _(item: charts.Spans, axes: Axes) -> None:
    for start, end in list(zip(item.starts, item.ends, strict=True))[::2]:
        axes.axvspan(start, end, color=SOFT, alpha=0.18, linewidth=0)
    low, high = axes.get_xlim()
    points_per_unit = 72.0 / axes.figure.dpi * axes.bbox.width / (high - low)
    for start, end, name in zip(item.starts, item.ends, item.names, strict=False):
        room = int((end - start) * points_per_unit / (CHARACTER * SMALL))
        code, _, words = name.partition(": ")
        fits = max(map(len, name.split()), default=0) <= room
        lines = [code, *wrapped(words, room)] if fits else [code] * (len(code) <= room)
        place: Any = {"transform": axes.get_xaxis_transform(), "ha": "center", "va": "bottom", "fontsize": SMALL}
        axes.text(0.5 * (start + end), 1.01, "\n".join(lines), **place)


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


def _contours(axes: Axes) -> list[ContourSet]:
    return [lines for lines in axes.collections if isinstance(lines, ContourSet) and not lines.filled]


def _label_contours(axes: Axes) -> None:
    """Label every contour where it is farthest from edges, other contours and labels."""
    contours = _contours(axes)
    curves = [
        [
            axes.transLimits.transform(np.array(path.vertices)[:: 1 + len(path) // CONTOUR_POINTS])
            for path in lines.get_paths()
        ]
        for lines in contours
    ]
    labels = _names_of_points(axes)
    for lines, own in zip(contours, curves, strict=True):
        if not (words := str(lines.get_label()).removeprefix("_")):
            continue
        first = len(labels)
        for curve in filter(len, own):
            others = [np.empty((0, 2)), *(other for found in curves for other in found if other is not curve)]
            edges = np.minimum(curve, 1.0 - curve).min(axis=1)
            edges = np.where(edges < EDGE, 0.1 * edges, 1.0)
            apart = LABEL_WEIGHT * _distances(curve, 0.0, labels)
            room = np.min([edges, apart, _distances(curve, 0.0, np.concatenate(others))], axis=0)
            labels = np.append(labels, curve[[room.argmax()]], axis=0)
        places = axes.transLimits.inverted().transform(labels[first:])
        fmt = VALUE if words == VALUE else dict.fromkeys(lines.levels, words)
        axes.clabel(lines, fontsize=SMALL, fmt=fmt, manual=places.tolist())


def _names_of_points(axes: Axes) -> Any:
    """Return places of the names of points, as a part of the axes, (n, 2)."""
    found = [np.empty((0, 2))]
    for text in axes.texts:
        if isinstance(text, Annotation):
            sideways, up = np.sign(text.xyann)
            parts = np.linspace(0.0, SIDE, 4)[:, None] * [sideways, 0.0] + [0.0, 0.05 * up]
            found.append(axes.transLimits.transform(text.xy) + parts)
    return np.concatenate(found)


def _name_in_place(axes: Axes, *, rows: bool) -> list[Any]:
    """Write the name of each line, and of few points, beside it where there is room; return what needs a legend."""
    handles, labels = axes.get_legend_handles_labels()
    if rows:
        return list(handles)
    seen: dict[Any, Any] = {line: _seen(line, axes) for line in axes.lines}
    bars = [lines for lines in axes.collections if isinstance(lines, LineCollection)]
    paths = [np.array(path.vertices) for lines in (*bars, *_contours(axes)) for path in lines.get_paths()]
    scale = 72.0 / axes.figure.dpi
    fixed = [np.empty((0, 2)), *(_filled(scale * axes.transData.transform(path)) for path in paths)]
    fixed += [_inside(scale * np.array(text.get_window_extent().extents)) for text in axes.texts]
    rest = []
    for handle, label in zip(handles, labels, strict=True):
        own = seen.get(handle, fixed[0])
        others = np.concatenate([*fixed, *(points for line, points in seen.items() if line is not handle)])
        alone = isinstance(handle, Line2D) and handle.get_linestyle() == "None"
        names = dict.fromkeys("\n".join(wrapped(label, characters)) for characters in NAME_CHARACTERS)
        places = (_place(axes, name, own, others, alone=alone) for name in names)
        place = next(filter(None, places), None)
        if place is None or (alone and len(own) > FEW):
            rest.append(handle)
            continue
        name, anchor, corner, size = place
        [at] = axes.transData.inverted().transform([anchor / scale]).tolist()
        beside: Any = {"xytext": corner - anchor, "textcoords": "offset points", "ha": "left", "va": "bottom"}
        # Of lines that cross, the colour tells which one is meant.
        if isinstance(handle, Line2D) and not alone and handle.get_color() not in PALE:
            beside["color"] = handle.get_color()
        axes.annotate(name, at, fontsize=NAME, linespacing=1.1, zorder=5, annotation_clip=False, **beside)
        fixed.append(_inside([*corner, *(corner + size)]))
    return rest


def _seen(line: Line2D, axes: Axes) -> Any:
    """Return points of a line within its axes that are near each other, or its markers, in points of 1/72 inch."""
    points = 72.0 / axes.figure.dpi * line.get_transform().transform(line.get_xydata())
    points = points.reshape(-1, 2)[np.isfinite(points).reshape(-1, 2).all(axis=1)]
    return points if line.get_linestyle() == "None" else _filled(points)


def _filled(points: Any) -> Any:
    """Return points along a polyline, half a step apart."""
    points = np.reshape(points, (-1, 2))
    along = np.append(0.0, np.linalg.norm(np.diff(points, axis=0), axis=1).cumsum())
    at = np.linspace(0.0, along[-1], 1 + int(min(along[-1], 1e4) / (0.5 * STEP)))
    return np.column_stack([np.interp(at, along, part) for part in points.T]) if len(points) else points


def _inside(box: Any) -> Any:
    """Return points of a grid over a box: left, bottom, right and top."""
    left, bottom, right, top = box
    x, y = np.meshgrid(np.arange(left, right + STEP, STEP), np.arange(bottom, top + STEP, STEP))
    return np.column_stack([x.clip(max=right).ravel(), y.clip(max=top).ravel()])


def _place(axes: Axes, name: str, own: Any, others: Any, *, alone: bool) -> tuple[str, Any, Any, Any] | None:
    """Return a name with where it is farthest from other lines: a point of its own, lower left corner and size."""
    scale = 72.0 / axes.figure.dpi
    left, bottom, right, top = scale * np.array(axes.bbox.extents)
    lines = name.split("\n")
    size = np.array([CHARACTER * NAME * max(map(len, lines)), 1.15 * NAME * len(lines)])
    gap = GAP + (3.0 if alone else 0.0)
    sides = [(x, y) for x in (0.0, -0.5, -1.0) for y in (0.0, -1.0)] + [(0.0, -0.5), (-1.0, -0.5)]
    shifts = np.array([(x * size[0] + (2 * x + 1) * gap, y * size[1] + (2 * y + 1) * gap) for x, y in sides])
    anchors = own[:: 1 if alone else 2]
    anchors = anchors[((anchors >= [left, bottom]) & (anchors <= [right, top])).all(axis=1)]
    corners = (anchors[:, None] + shifts).reshape(-1, 2)
    within = ((corners >= [left + 1.0, bottom + 1.0]) & (corners + size <= [right, top])).all(axis=1)
    corners, from_points = corners[within], np.repeat(anchors, len(shifts), axis=0)[within]
    if not len(corners):
        return None
    near, far = (_distances(corners, size, points) for points in (own, others))
    room = np.where(near >= (0.5 * GAP), far.clip(max=FAR), 0.0)
    best = int(room.argmax())
    return (name, from_points[best], corners[best], size) if room[best] >= APART else None


def _distances(corners: Any, size: Any, points: Any) -> Any:
    """Return the distance of each of several boxes, of lower left corners and a size, from the nearest of points."""
    beyond = np.maximum(corners[:, None] - points, points - (corners + size)[:, None]).clip(min=0.0)
    return np.linalg.norm(beyond, axis=2).min(axis=1, initial=np.inf)


def saved(figure: Figure, suffix: str, **options: Any) -> bytes:
    """Return a figure as a file of the format that the suffix names, a key of `METADATA`."""
    content = BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(content, format=suffix[1:], metadata=METADATA[suffix], **{"dpi": 160, **options})
    return content.getvalue()


def rendered(chart: charts.Chart, suffix: str) -> bytes:
    """Return a chart as a file of the format that the suffix names, a key of `METADATA`."""
    return saved(draw(chart), suffix)
