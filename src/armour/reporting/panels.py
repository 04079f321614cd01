"""Axes, series and panels that the charts of several results have."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from armour.analysis.quantities import label_and_unit
from armour.errors import InputError, Problem
from armour.reporting.chart import COLOURS, INK, MARKERS, Axis, Bars, Line, Panel, Points, Rule, Series, Style
from armour.reporting.text import percent
from armour.scenario.inputs import VELOCITY

if TYPE_CHECKING:
    from armour.analysis.results import Result

# Width of a column of a two-column page, inches.
COLUMN_INCHES = 3.45


def quantity_axis(name: str, **options: Any) -> Axis:
    """Return the axis of a quantity, an input or a key of a scenario, in words."""
    words, unit = label_and_unit(name)
    return Axis(words, unit, **options)


def velocity_rule(label: str, velocity: float, colour: str, style: Style = "-") -> Rule:
    """Return a line at a velocity, with its value in the legend."""
    return Rule(velocity, style, label=f"{label} {velocity:.1f} m/s", colour=colour)


def residual_velocity_panel(series: Iterable[Series], limits: tuple[float, float] | None = None) -> Panel:
    """Describe residual over impact velocity."""
    x = quantity_axis(VELOCITY, limits=limits)
    return Panel(x, quantity_axis("residual_velocity_m_s", from_zero=True), tuple(series), height=1.2)


def look_of(index: int) -> dict[str, Any]:
    """Return colour and marker of one of several series; when colours repeat, they have other markers."""
    turn, colour = divmod(index, len(COLOURS))
    return {"colour": COLOURS[colour], "marker": MARKERS[(colour + turn) % len(MARKERS)]}


def agreement_panel(
    quantity: str, word: str, groups: Mapping[str, Sequence[tuple[str, str, float, float, float]]], part: float = 0.0
) -> Panel:
    """Describe computed over known values, with lines of agreement and, on request, a part away from it.

    Each group has points of a name, the word for the known value, this value, the computed one, and the standard
    deviation of the known value, 0 where none is given.
    """
    axis = quantity_axis(quantity)
    series: list[Series] = []
    for index, (group, points) in enumerate(groups.items()):
        text = tuple(
            f"{n}\n{w} {axis.text(k)}{f' ± {axis.text(s)}' if s else ''}, computed {axis.text(c)}"
            for n, w, k, c, s in points
        )
        known, computed = [point[2] for point in points], [point[3] for point in points]
        ends = tuple((k - s, k + s) for *_, k, _, s in points) if any(point[4] for point in points) else ()
        series.append(Points(known, computed, filled=False, x_ends=ends, label=group, text=text, **look_of(index)))
    span = widened(end for points in groups.values() for *_, k, c, s in points for end in (k - s, k + s, c))
    lines = [(1.0, "agreement", "-")]
    if part:
        # Few points that are near each other are shown with the lines beside them.
        margin = part * span[1] if span[1] - span[0] < part * span[1] else 0.0
        span = span[0] - margin, span[1] + margin
        lines += [(1.0 - part, f"± {percent(part)}", ":"), (1.0 + part, "", ":")]
    for factor, label, style in lines:
        across = [factor * end for end in span]
        series.append(Line(span, across, style, 0.8, label=label, colour=INK, text=("", "")))
    x, y = (replace(axis, label=f"{prefix} {axis.label}", limits=span) for prefix in (word, "computed"))
    return Panel(x, y, tuple(series), square=True)


def widened(values: Iterable[float]) -> tuple[float, float]:
    """Return the range of values, a little wider than it is."""
    found = list(values)
    margin = 0.05 * (max(found) - min(found)) or 0.05 * abs(found[0]) or 1.0
    return min(found) - margin, max(found) + margin


def grouped(items: Iterable[Any], key: Callable[[Any], str]) -> dict[str, list[Any]]:
    """Return items by a key."""
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def bars_panel(
    x: Axis, names: tuple[str, ...], values: Mapping[str, Sequence[float | None]], title: str = "", start: float = 0.0
) -> Panel:
    """Describe several values of each name as bars side by side; from a start other than zero, in one row."""
    series: list[Series] = [Rule(start, colour=INK)]
    for slot, (label, ends) in enumerate(values.items()):
        place = (slot, len(values)) if start == 0.0 else (0, 1)
        series.append(Bars([start] * len(ends), ends, *place, label=label, colour=COLOURS[slot % len(COLOURS)]))
    return Panel(x, Axis(categories=names), tuple(series), title)


def needed(result: "Result", key: str) -> Any:
    """Return what a chart shows beside the result, its scenario or its shots; only a result made by hand has none."""
    if (value := result._question.get(key)) is None:
        raise InputError([Problem("plot", key, "must be given to draw this result")])
    return value
