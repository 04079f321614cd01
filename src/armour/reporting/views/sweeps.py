"""Sweeps."""

from collections.abc import Mapping
from typing import Any

from armour.reporting.by_result import tables_of
from armour.reporting.table import Table, column_of
from armour.sweeps.sweep import SweepResult

# Rows of a sweep that are shown.
SWEEP_ROWS = 20


@tables_of.register
def tables_of_sweep(result: SweepResult) -> list[Table | str]:
    """Return the first rows of a sweep."""
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    return [first_rows(result.columns), *notes]


def first_rows(columns: Mapping[str, Any]) -> Table:
    """Return the first rows of the columns of a sweep."""
    shown = tuple(zip(*(values[:SWEEP_ROWS].tolist() for values in columns.values()), strict=True))
    headings = [column_of(name, ".6g" if is_number(values) else "") for name, values in columns.items()]
    return Table(tuple(headings), shown)


def is_number(values: Any) -> bool:
    """Return whether a column holds numbers."""
    return values.dtype.kind in "iuf"
