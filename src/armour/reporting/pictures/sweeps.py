"""Draw sweeps: a quantity over one key or two."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from armour.analysis.evaluate import far_of
from armour.errors import mistake
from armour.reporting.by_result import draw
from armour.reporting.pictures import drawing
from armour.reporting.table import Column, in_words, number
from armour.reporting.views.sweeps import is_number
from armour.scenario.scenario import Scenario
from armour.sweeps.sweep import SweepResult

# Quantities that are zero where the projectile is stopped.
RESIDUALS = ("residual_velocity_m_s", "residual_mass_g", "plug_velocity_m_s")
# Largest number of points of a curve that have marks.
MAX_MARKERS = 40


@draw.register
def draw_sweep(result: SweepResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw the first numerical quantity of a sweep."""
    if len(result.keys) > 2:
        raise mistake("plot", "result", f"must be a sweep over one or two keys, found {len(result.keys)}")
    numbers = [name for name in result.quantities if is_number(result[name])]
    if not numbers:
        message = f"must have a quantity that is a number, found only {', '.join(result.quantities)}"
        raise mistake("plot", "result", message)
    return draw_columns(result.columns, result.keys, numbers[0], result.scenario, sheet)


def draw_columns(
    table: Mapping[str, Any], keys: Sequence[str], name: str, scenario: Scenario, sheet: drawing.Sheet
) -> drawing.Picture:
    """Draw the quantity `name` over one numerical key of a sweep, as a curve, or over two, as a map.

    `table` has an array (rows,) by name of key or quantity.  A key whose values are names gives a mark for each name
    or, beside a numerical key, a curve.
    """
    answer, values = Column.of(name, ".4g"), table[name]
    title = f"{answer.label[:1].upper()}{answer.label[1:]} over {' and '.join(Column.of(key).label for key in keys)}"
    numbers = values[~np.isnan(values)]
    if numbers.size and numbers.min() < numbers.max():
        title += f": {number(numbers.min(), '.4g')} to {answer.with_unit(numbers.max())}"
    missing = np.count_nonzero(np.isnan(values))
    notes = [f"{missing} of {len(values)} rows have no {answer.label}."] if missing else []
    named = [key for key in keys if not is_number(table[key])]
    is_map = not named and len(keys) == 2
    if is_map and name in RESIDUALS and (stopped := np.count_nonzero(values == 0.0)):
        notes.append(f"White: {stopped} cases without {answer.label}.")
    is_far = np.zeros(len(values), dtype=bool)
    if not is_map and len(named) < len(keys):
        is_far = far_of(scenario, {key: table[key] for key in keys})
        if count := np.count_nonzero(is_far):
            notes.append(f"{count} of {len(values)}, hollow and dashed, are far from the tests.")
    height = 1.2 * drawing.PANEL
    if len(named) == len(keys):
        height = drawing.rows_height(dict.fromkeys(table[named[0]].tolist()))
    picture = sheet.panels(title, height, note=" ".join(notes))
    [axes] = picture.axes
    if len(named) == len(keys):
        _draw_names(axes, table, named, answer, values)
    elif is_map:
        _draw_map(axes, table, keys, answer)
    else:
        _draw_curves(axes, table, next(key for key in keys if key not in named), named, answer, is_far)
    return picture


def _draw_names(axes: Axes, table: Mapping[str, Any], named: Sequence[str], answer: Column, values: Any) -> None:
    """Draw values, (rows,), as marks: a row for each name of the first key, a series for each name of the second."""
    names, by_name = list(dict.fromkeys(table[named[0]].tolist())), {}
    for label, mask in _by_name(table, named[1:]):
        answers = dict(zip(table[named[0]][mask].tolist(), values[mask].tolist(), strict=True))
        by_name[label] = [answers.get(name) for name in names]
    drawing.rows(axes, names, by_name)
    axes.set_xlabel(answer.heading)


def _draw_curves(
    axes: Axes, table: Mapping[str, Any], key: str, named: Sequence[str], answer: Column, is_far: Any
) -> None:
    """Draw a quantity over a numerical key, with a curve for each name of another key, if `named` has one.

    Where `is_far`, (rows,), is true, the curve is dashed, and its marks are hollow.
    """
    x, values = table[key], table[answer.key]
    for index, (label, mask) in enumerate(_by_name(table, named)):
        order = np.flatnonzero(mask)[np.argsort(x[mask], kind="stable")]
        look = drawing.look_of(index) | {"label": drawing.legible(label)}
        if len(order) > MAX_MARKERS:
            look["marker"] = ""
        drawing.curve(axes, x[order], values[order], is_far[order], **look)
    axes.set(xlabel=in_words(key), ylabel=answer.heading)
    # Include rows without an answer, and widen the range of a single row.
    if np.isnan(values).any() or len(set(x)) == 1:
        axes.set_xlim(drawing.widened(x.tolist()))


def _draw_map(axes: Axes, table: Mapping[str, Any], keys: Sequence[str], answer: Column) -> None:
    """Draw a quantity over two numerical keys as colours and contours."""
    x, y, z = drawing.on_grid(table[keys[0]], table[keys[1]], table[answer.key])
    # Where the projectile is stopped, a residual is left out: contours towards its zero would follow the cells.
    shown: Any = np.where(z > 0.0, z, np.nan) if answer.key in RESIDUALS else z
    drawing.colours_of(axes, x, y, shown, answer.heading)
    if min(z.shape) > 1:
        drawing.contours(axes, x, y, shown, 10, numbered=True)
    axes.set(xlabel=in_words(keys[0]), ylabel=in_words(keys[1]))


def _by_name(table: Mapping[str, Any], keys: Sequence[str]) -> list[tuple[str, Any]]:
    """Return each name of the first key with a mask of its rows, (rows,); without keys, "" with all rows."""
    if not keys:
        return [("", np.ones(len(next(iter(table.values()))), dtype=bool))]
    names = table[keys[0]]
    return [(name, names == name) for name in dict.fromkeys(names.tolist())]
