"""A sweep."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from armour.errors import InputError, Problem
from armour.reporting import charts
from armour.reporting.table import Table, column_of
from armour.reporting.text import number
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import Scenario
from armour.sweeps.sweep import SweepResult
from armour.units import MM

# Quantities that are zero where the projectile is stopped, and lines of equal value on a map, about.
RESIDUALS, CONTOURS = ("residual_velocity_m_s", "residual_mass_g"), 10
# Rows of a sweep that are shown.
SWEEP_ROWS = 20


def tables(result: SweepResult) -> list[Table | str]:
    """Return the first rows of a sweep."""
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    return [first_rows(result.columns), *notes]


def first_rows(columns: Mapping[str, Any]) -> Table:
    """Return the first rows of the columns of a sweep."""
    shown = tuple(zip(*(values[:SWEEP_ROWS].tolist() for values in columns.values()), strict=True))
    headings = [column_of(name, ".6g" if _is_number(values) else "") for name, values in columns.items()]
    return Table(tuple(headings), shown)


def chart(result: SweepResult) -> charts.Chart:
    """Describe the first quantity of a sweep that is a number over its one or two keys."""
    if len(result.keys) > 2:
        raise _undrawn(f"must be a sweep over one or two keys, found {len(result.keys)}")
    numbers = [name for name in result.quantities if _is_number(result[name])]
    if not numbers:
        raise _undrawn(f"must have a quantity that is a number, found only {', '.join(result.quantities)}")
    if np.isnan(result[numbers[0]]).all():
        raise _undrawn(f"must have a value of {numbers[0]} in at least one row, found none")
    return sweep_chart(result.columns, result.keys, numbers[0], result.scenario)


def _undrawn(message: str) -> InputError:
    return InputError([Problem("plot", "result", message)])


# Rows of a sweep whose points are marked on a curve.
MAX_MARKERS = 40


def sweep_chart(table: Mapping[str, Any], keys: Sequence[str], name: str, scenario: Scenario) -> charts.Chart:
    """Describe a quantity over one key of a sweep, as a curve, or two, as a map; thicknesses have areal densities.

    Over a key of names there is a mark for each name, and over such a key and numbers a curve for each.
    """
    answer, values = charts.quantity_axis(name, spec=".4g"), table[name]
    title = _sweep_title(answer.label, *(charts.quantity_axis(key).label for key in keys))
    if np.nanmin(values) < np.nanmax(values):
        title += f": {number(np.nanmin(values), answer.spec)} to {answer.text(np.nanmax(values))}"
    missing = np.count_nonzero(np.isnan(values))
    notes = [f"{missing} of {len(values)} rows have no {answer.label}."] if missing else []
    named = [key for key in keys if not _is_number(table[key])]
    if len(named) == len(keys):
        panel = _names_panel(table, named, answer, values)
    elif len(keys) == 1 or named:
        panel = _curves_panel(table, next(key for key in keys if key not in named), named, answer, values)
    else:
        panel = _map_panel(table, keys, name, answer, scenario)
        if name in RESIDUALS and (stopped := np.count_nonzero(values == 0.0)):
            notes.append(f"White: {stopped} cases that are stopped.")
    return charts.Chart(title, (panel,), " ".join(notes))


def _is_number(values: Any) -> bool:
    return values.dtype.kind in "iuf"


def _names_panel(table: Mapping[str, Any], named: Sequence[str], answer: charts.Axis, values: Any) -> charts.Panel:
    """Describe values by the names of one key or of two."""
    names = tuple(dict.fromkeys(table[named[0]].tolist()))
    by_name = {
        label: list(map(dict(zip(table[named[0]][own].tolist(), values[own].tolist(), strict=True)).get, names))
        for label, own in _by_name(table, named[1:])
    }
    return charts.rows_panel(answer, names, by_name)


def _curves_panel(
    table: Mapping[str, Any], key: str, named: Sequence[str], answer: charts.Axis, values: Any
) -> charts.Panel:
    """Describe values over a key of numbers, a curve for each name of another key."""
    x = table[key]
    # The axis reaches rows without an answer too, and a single row has a point.
    whole = np.isnan(values).any() or len(set(x)) == 1
    curves = []
    for index, (label, own) in enumerate(_by_name(table, named)):
        order = np.flatnonzero(own)[np.argsort(x[own], kind="stable")]
        look = charts.look_of(index)
        if len(order) > MAX_MARKERS:
            look = {"colour": charts.COLOURS[index % len(charts.COLOURS)]}
        curves.append(charts.Line(x[order].tolist(), values[order].tolist(), label=label, **look))
    across = charts.quantity_axis(key, limits=charts.widened(x.tolist()) if whole else None)
    return charts.Panel(across, answer, tuple(curves), height=1.1)


def _map_panel(
    table: Mapping[str, Any], keys: Sequence[str], name: str, answer: charts.Axis, scenario: Scenario
) -> charts.Panel:
    """Describe a quantity over two keys of numbers."""
    x, y, z = charts.on_grid(table[keys[0]], table[keys[1]], table[name])
    # A residual velocity of zero is no level of the perforated ones: contours towards it would follow the cells.
    some: Any = np.where(z > 0.0, z, np.nan) if name in RESIDUALS else z
    series: list[charts.Series] = [charts.Map(x, y, some, answer.heading)]
    if min(z.shape) > 1 and np.isfinite(some).any() and np.nanmin(some) < np.nanmax(some):
        series.append(charts.Contours(x, y, some, levels=CONTOURS, colour="ink"))
    if set(keys) == {CERAMIC, BACKING} and min(z.shape) > 1:
        ceramic, backing = np.meshgrid(x, y) if keys[0] == CERAMIC else np.meshgrid(x, y)[::-1]
        armour = scenario.core_armour()
        areal = armour.rho_c * MM * ceramic + armour.rho_B * MM * backing
        label = f"lines of equal {charts.quantity_axis('areal_density_kg_m2').heading}"
        series.append(charts.Contours(x, y, areal, "dashed", 5, label=label, colour="vermilion"))
    across, up = map(charts.quantity_axis, keys)
    return charts.Panel(across, up, tuple(series), height=1.2)


def _by_name(table: Mapping[str, Any], keys: Sequence[str]) -> list[tuple[str, Any]]:
    """Return each name of a key with its rows, as a mask; without a key all rows."""
    if not keys:
        return [("", np.ones(len(next(iter(table.values()))), dtype=bool))]
    names = table[keys[0]]
    return [(name, names == name) for name in dict.fromkeys(names.tolist())]


def _sweep_title(answer: str, first: str, second: str = "") -> str:
    """Return the title of a sweep, in which words that both keys end in stand once."""
    words, others = first.split(" "), second.split(" ")
    # Of each, one word at least remains.
    while second and len(words) > 1 and len(others) > 1 and words[-1] == others[-1]:
        words, others = words[:-1], others[:-1]
    over = f"{' '.join(words)} and {second}" if second else first
    return f"{answer[:1].upper()}{answer[1:]} over {over}"
