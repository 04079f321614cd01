"""Tables of sweeps."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from armour.analysis.evaluate import outside_of
from armour.analysis.quantities import QUANTITIES
from armour.errors import counted
from armour.reporting.by_result import line_of, tables_of
from armour.reporting.table import Column, Table
from armour.scenario.scenario import Scenario
from armour.sweeps.sweep import SweepResult

# Largest number of rows of a sweep that a terminal shows.
SWEEP_ROWS = 20


@line_of.register
def sweep_in_a_line(result: SweepResult) -> str:
    """Return quantities, keys and the number of rows, and the file that has them."""
    where = "" if result.output is None else f", in {result.output}"
    return f"{', '.join(result.quantities)} over {' and '.join(result.keys)}, {counted(result.rows, 'row')}{where}"


@tables_of.register
def tables_of_sweep(result: SweepResult) -> list[Table | str]:
    """Return the first rows of a sweep, with a note if there are more."""
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    return [first_rows(result.columns, result.scenario, result.keys), *notes]


def first_rows(columns: Mapping[str, Any], scenario: Scenario, keys: Sequence[str]) -> Table:
    """Tabulate the first rows of a sweep.

    `columns` has an array (rows,) by name; the names in `keys` are the swept inputs.  If any row shown lies outside the
    tests, a last column says which do.
    """
    first = {name: values[:SWEEP_ROWS] for name, values in columns.items()}
    quantities = [name for name in columns if name in QUANTITIES and name not in keys]
    is_outside = outside_of(scenario, {key: first[key] for key in keys}, quantities)
    headings = [Column.of(name, ".6g" if is_number(values) else "") for name, values in columns.items()]
    cells = [values.tolist() for values in first.values()]
    if is_outside.any():
        headings.append(Column("tests"))
        cells.append(np.where(is_outside, "outside", "inside").tolist())
    return Table(tuple(headings), tuple(zip(*cells, strict=True)))


def is_number(values: Any) -> bool:
    """Return whether an array holds numbers."""
    return values.dtype.kind in "iuf"
