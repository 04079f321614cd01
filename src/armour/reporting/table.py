"""Tables: columns described once, rows of raw values, and their text for people and for CSV files."""

import csv
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from io import StringIO
from math import isfinite
from typing import Any

from armour.analysis.quantities import QUANTITIES, label_and_unit
from armour.files import csv_cell
from armour.reporting.text import number

Cell = float | int | str | None


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading in words, and the unit."""

    label: str
    unit: str = ""
    spec: str = ""  # format specification of numbers, such as ".2f"; empty for text
    prose: bool = False  # whether text may be wrapped between words
    key: str = ""  # attribute that the column shows, and heading in CSV files, which have no column without a key

    @property
    def heading(self) -> str:
        """Label and unit."""
        return ", ".join(part for part in (self.label, self.unit) if part)

    @property
    def numeric(self) -> bool:
        """Whether the column holds numbers."""
        return bool(self.spec)

    def text(self, value: Cell) -> str:
        """Format a value; None gives an empty text, and a text is returned as it is."""
        return "" if value is None else number(value, self.spec)

    def with_unit(self, value: Cell) -> str:
        """Format a value with its unit."""
        return f"{self.text(value)} {self.unit}".rstrip()


# A column of the attribute that its key names, or a column and its value, or the function of an item that gives it.
Source = Column | tuple[Column, Cell | Callable[[Any], Cell]]


@dataclass(frozen=True)
class Table:
    """Rows of values under their columns; a record is a single row, which is listed quantity by quantity."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    record: bool = False
    rest: str = ""  # how to get all rows, where a terminal shows the first ones only

    def texts(self) -> list[list[str]]:
        """Return the rows with every value formatted."""
        return [[column.text(cell) for column, cell in zip(self.columns, row, strict=True)] for row in self.rows]


def column_of(key: str, spec: str = "", label: str = "", *, prose: bool = False) -> Column:
    """Return the column of a quantity, an input, a key or an attribute, with label and format unless given."""
    words, unit = label_and_unit(key)
    return Column(label or words, unit, spec or (QUANTITIES[key].spec if key in QUANTITIES else ""), prose, key)


def in_words(name: str) -> str:
    """Return label and unit of a quantity, an input or a key, such as "ceramic flow stress, GPa"."""
    return column_of(name).heading


def deviation_percent(value: float | None, reference: float) -> float | None:
    """Return the deviation of a value from a reference, per cent."""
    return None if value is None else 100.0 * (value / reference - 1.0)


def grouped(items: Iterable[Any], key: Callable[[Any], str]) -> dict[str, list[Any]]:
    """Return items by a key."""
    groups: dict[str, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def listing(items: Iterable[Any], *sources: Source, title: str = "", rest: str = "") -> Table:
    """Make a table with a row for each item, without the columns that are empty in all of them."""
    rows = [[_cell(item, source) for source in sources] for item in items]
    columns = [_column(source) for source in sources]
    filled = [index for index, column in enumerate(columns) if not rows or any(column.text(row[index]) for row in rows)]
    cells = tuple(tuple(row[index] for index in filled) for row in rows)
    return Table(tuple(columns[index] for index in filled), cells, title, rest=rest)


def record(item: Any, *sources: Source, title: str = "") -> Table:
    """Make a table of one item, without the quantities that have no value."""
    return replace(listing([item], *sources, title=title), record=True)


def _column(source: Source) -> Column:
    return source if isinstance(source, Column) else source[0]


def _cell(item: Any, source: Source) -> Cell:
    value = getattr(item, source.key) if isinstance(source, Column) else source[1]
    return value(item) if callable(value) else value


def csv_text(table: Table) -> str:
    """Format a table as a CSV file: the keys of its columns, and numbers with all their digits."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keyed = [index for index, column in enumerate(table.columns) if column.key]
    writer.writerow([_csv_cell(table.columns[index].key) for index in keyed])
    writer.writerows([_csv_cell(row[index]) for index in keyed] for row in table.rows)
    return text.getvalue()


def rows_csv(rows: Iterable[Mapping[str, Any]]) -> str:
    """Format rows of a result as a CSV file; an interval, such as "v50_interval_m_s", has two columns, low and high."""
    cells = [dict(_with_ends(row)) for row in rows]
    keys = list(cells[0])
    return csv_text(Table(tuple(Column(key, key=key) for key in keys), tuple(tuple(row.values()) for row in cells)))


def _with_ends(row: Mapping[str, Any]) -> Iterator[tuple[str, Cell]]:
    for key, value in row.items():
        if "interval" in key:
            low, high = value or (None, None)
            yield key.replace("interval", "interval_low"), low
            yield key.replace("interval", "interval_high"), high
        else:
            yield key, value


def _csv_cell(cell: Cell) -> Cell:
    if isinstance(cell, str):
        return csv_cell(cell)
    return None if cell is None or not isfinite(cell) else cell
