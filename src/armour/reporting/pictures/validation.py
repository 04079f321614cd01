"""Draw suites and figures of the paper."""

from collections.abc import Sequence
from math import sqrt
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.errors import mistake
from armour.reporting.by_result import draw
from armour.reporting.pictures import drawing
from armour.reporting.table import grouped
from armour.reporting.views.validation import drawn_checks
from armour.validation.figures import Figure
from armour.validation.suite_sections import CASES
from armour.validation.validate import SuiteResult

# Kinds of cases that are not drawn.
LEFT_OUT = "outcomes, relative differences, and those of no table or without an answer"


@draw.register
def draw_suite(result: SuiteResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the computed over the expected values of a suite, with a panel for each quantity.

    They are those of its tables or, if it has none, of its cases.
    """
    if not (checks := drawn_checks(result)):
        raise mistake("plot", "result", "must have a case whose value is a number, found none")
    by_quantity = grouped(checks, lambda check: check.case.quantity)
    left_out = len(result.checks) - len(checks)
    title = "Computed and expected values"
    if relative := [check.deviation_percent for check in checks if check.deviation_percent is not None]:
        rms = sqrt(sum(part * part for part in relative) / len(relative))
        title = f"{len(relative)} computed values deviate by {rms:.1f} % (RMS) from those expected"
    note = f"{left_out} of {len(result.checks)} cases are not shown: {LEFT_OUT}." if left_out else ""
    picture = sheet.panels(title, *[sheet.width - 0.3] * len(by_quantity), note=note)
    for axes, (quantity, checks_of_quantity) in zip(picture.axes, by_quantity.items(), strict=True):
        by_group = grouped(checks_of_quantity, lambda check: check.case.group or CASES)
        groups = {
            group: [(each.case.expected, each.computed, 0.0) for each in some] for group, some in by_group.items()
        }
        drawing.agreement(axes, quantity, "expected", groups)
    return picture


def draw_figure(panels: Sequence[Figure], sheet: drawing.Sheet) -> drawing.Picture:
    """Draw a figure of the paper: curves by the model, and marks for the numbers that the text of the paper gives."""
    picture = sheet.panels(panels[0].section.title, *[drawing.PANEL] * len(panels))
    for axes, figure in zip(picture.axes, panels, strict=True):
        _draw_panel(axes, figure)
    return picture


def _draw_panel(axes: Axes, figure: Figure) -> None:
    """Draw the curves of a panel, lines at the values that the text of the paper gives, and marks at its points."""
    section = figure.section
    axes.set(xlabel=section.x_label, ylabel=section.y_label, xlim=(figure.x[0], figure.x[-1]))
    for index, (label, values) in enumerate(figure.curves.items()):
        look: Any = {"linestyle": drawing.STYLES[index], "color": drawing.COLOURS[index]}
        axes.plot(figure.x, np.array(values, float), label=drawing.legible(label), **look)
    for level in section.level:
        axes.axhline(level.value, linestyle=":", label=drawing.legible(level.label), **drawing.RULE)
    colours = dict(zip(figure.curves, drawing.COLOURS, strict=False))
    for mark, marker, size in zip(section.mark, ("*", "D", "s"), (9.0, 5.0, 5.0), strict=False):
        xs, ys = zip(*mark.points, strict=True)
        colour = colours.get(mark.of, drawing.SOFT)
        if mark.x_ends:
            drawing.ranges(axes, ys, mark.x_ends, colour)
        drawing.points(axes, xs, ys, marker=marker, markersize=size, color=colour, label=drawing.legible(mark.label))
    shown = [value for values in figure.curves.values() for value in values if value is not None]
    if shown and min(shown) < 0.3 * max(shown):
        axes.set_ylim(bottom=0.0)
