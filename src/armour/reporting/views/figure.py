"""A figure of the paper."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from armour.analysis.quantities import QUANTITIES
from armour.reporting.chart import COLOURS, INK, SOFT, STYLES, Axis, Chart, Line, Panel, Points, Rule, Series
from armour.reporting.panels import COLUMN_INCHES
from armour.reporting.table import Column, Table

if TYPE_CHECKING:
    from armour.validation.figures import Figure


def figure_table(panels: Sequence["Figure"]) -> Table:
    """Return the curves of a figure, a column each; its panels, of equally many points, side by side."""
    quantities = {quantity.label for quantity in QUANTITIES.values()}
    columns: dict[str, Sequence[float | None]] = {}
    for panel in panels:
        y_label = panel.section.y_label
        columns[panel.section.x_label] = panel.x
        for curve in panel.curves:
            # The label of a curve may name its quantity, or what the curve differs in.
            named = curve.label.rpartition(", ")[2] in quantities
            columns[f"{curve.label}, {y_label.rpartition(', ')[2]}" if named else f"{curve.label}: {y_label}"] = (
                curve.values
            )
    return Table(
        tuple(Column(label, spec="g", key=label) for label in columns), tuple(zip(*columns.values(), strict=True))
    )


def chart(panels: Sequence["Figure"]) -> Chart:
    """Describe a figure of the paper: the model's curves, with the numbers of the paper's text as marks."""
    drawn: list[Panel] = []
    for panel in map(_figure_panel, panels):
        named = {item.label for other in drawn for item in other.series}
        series = (replace(item, label="") if item.label in named else item for item in panel.series)
        drawn.append(replace(panel, series=tuple(series)))
    return Chart(panels[0].section.title, tuple(drawn), width=COLUMN_INCHES)


def _figure_panel(figure: "Figure") -> Panel:
    section = figure.section
    series: list[Series] = [
        Line(figure.x, curve.values, STYLES[index], label=curve.label, colour=COLOURS[index])
        for index, curve in enumerate(figure.curves)
    ]
    series += (Rule(level.value, ":", vertical=False, label=level.label, colour=INK) for level in section.level)
    colours = {curve.label: colour for curve, colour in zip(figure.curves, COLOURS, strict=False)}
    for mark, marker, size in zip(section.mark, ("*", "D", "s"), (9.0, 5.0, 5.0), strict=False):
        xs, ys = zip(*mark.points, strict=True)
        ends, colour = tuple((low, high) for low, high in mark.x_ends), colours.get(mark.of, SOFT)
        series.append(Points(xs, ys, marker, size, x_ends=ends, label=mark.label, colour=colour))
    shown = [value for curve in figure.curves for value in curve.values if value is not None]
    from_zero = bool(shown) and min(shown) < 0.3 * max(shown)
    x, y = Axis(section.x_label, limits=(figure.x[0], figure.x[-1])), Axis(section.y_label, from_zero=from_zero)
    return Panel(x, y, tuple(series))
