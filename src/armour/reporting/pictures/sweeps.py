"""Draw sweeps: a quantity over one key or two."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.analysis.evaluate import far_of
from armour.errors import mistake
from armour.reporting.by_result import draw
from armour.reporting.pictures import drawing
from armour.reporting.table import Column, in_words
from armour.reporting.views.sweeps import is_number
from armour.sweeps.sweep import SweepResult


@draw.register
def draw_sweep(result: SweepResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the first numerical quantity of a sweep: over one key as a curve, over two as a map."""
    numbers = [key for key in result.keys if is_number(result[key])]
    if len(result.keys) > 2 or len(numbers) < len(result.keys):
        message = f"must be a sweep over one or two keys of numbers, found {', '.join(result.keys)}"
        raise mistake("plot", "result", message)
    quantities = [name for name in result.quantities if is_number(result[name])]
    if not quantities:
        message = f"must have a quantity that is a number, found only {', '.join(result.quantities)}"
        raise mistake("plot", "result", message)
    table, keys, scenario = result.columns, result.keys, result.scenario
    answer, values = Column.of(quantities[0], ".4g"), table[quantities[0]]
    title = f"{answer.label[:1].upper()}{answer.label[1:]} over {' and '.join(Column.of(key).label for key in keys)}"
    missing = np.count_nonzero(np.isnan(values))
    notes = [f"{missing} of {len(values)} rows have no {answer.label}."] if missing else []
    notes += [f"Computed with {changed}."] if (changed := result.question.get("changed")) else []
    is_far = far_of(scenario, {key: table[key] for key in keys}) if len(keys) == 1 else np.zeros(len(values), bool)
    notes += [f"{far} of {len(values)}, hollow and dashed, are far from the tests."] if (far := is_far.sum()) else []
    picture = sheet.panels(title, 1.2 * drawing.PANEL, note=" ".join(notes))
    [axes] = picture.axes
    if len(keys) == 2:
        _draw_map(axes, table, keys, answer)
    else:
        _draw_curve(axes, table[keys[0]], values, is_far)
        axes.set(xlabel=in_words(keys[0]), ylabel=answer.heading)
    return picture


def _draw_curve(axes: Axes, x: Any, values: Any, is_far: Any) -> None:
    """Draw a quantity over a key, both (rows,); dashed with hollow marks where `is_far`, from the tests, (rows,)."""
    order = np.argsort(x, kind="stable")
    marker = "" if len(order) > 40 else "o"  # marks of more points would run together
    drawing.curve(axes, x[order], values[order], is_far[order], marker=marker, color=drawing.BLUE)
    # Include rows without an answer, and widen the range of a single row.
    if np.isnan(values).any() or len(set(x)) == 1:
        axes.set_xlim(drawing.widened(x.tolist()))


def _draw_map(axes: Axes, table: Mapping[str, Any], keys: Sequence[str], answer: Column) -> None:
    """Draw the quantity `answer` over two numerical keys as colours and contours; `table` is the columns, by name."""
    (x, column), (y, row) = (np.unique(table[key], return_inverse=True) for key in keys)
    z = np.full((len(y), len(x)), np.nan)
    z[row, column] = table[answer.key]
    drawing.colours_of(axes, x, y, z, answer.heading)
    if min(z.shape) > 1:
        drawing.contours(axes, x, y, z, 10, numbered=True)
    axes.set(xlabel=in_words(keys[0]), ylabel=in_words(keys[1]))
