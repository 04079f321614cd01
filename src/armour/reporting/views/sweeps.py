"""Sweeps."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from armour.analysis.evaluate import outside_of
from armour.reporting.table import Column, Table, column_of
from armour.sweeps.sweep import SweepResult

# Rows of a sweep that are shown.
SWEEP_ROWS = 20


def tables_of_sweep(result: SweepResult) -> list[Table | str]:
    """Return the first rows of a sweep."""
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    table = first_rows(result.columns)
    rows_shown = {key: result[key][:SWEEP_ROWS] for key in result.keys}
    is_outside = outside_of(result.scenario, rows_shown, result.quantities)
    if is_outside.any():
        words = np.where(is_outside, "outside", "inside").tolist()
        rows = tuple((*row, word) for row, word in zip(table.rows, words, strict=True))
        table = replace(table, columns=(*table.columns, Column("tests")), rows=rows)
    return [table, *notes]


def first_rows(columns: Mapping[str, Any]) -> Table:
    """Return the first rows of the columns of a sweep."""
    shown = tuple(zip(*(values[:SWEEP_ROWS].tolist() for values in columns.values()), strict=True))
    headings = [column_of(name, ".6g" if is_number(values) else "") for name, values in columns.items()]
    return Table(tuple(headings), shown)


def is_number(values: Any) -> bool:
    """Return whether a column holds numbers."""
    return values.dtype.kind in "iuf"
