"""Numbers, intervals and texts as they are shown, and tables of them for people and for CSV files.

Text from files is made safe for terminals and XML.
"""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from itertools import compress, starmap
from math import isfinite
from operator import attrgetter
from textwrap import wrap
from typing import Any, Self

from armour.analysis.quantities import QUANTITIES, label_and_unit
from armour.files import csv_cell, printable
from armour.units import ENDINGS

Cell = float | int | str | None


class VerdictLine(str):
    """A line that says how an answer ends, well or not; a terminal shows it in green or red."""

    good: bool

    def __new__(cls, text: str, *, good: bool) -> Self:
        """Make a verdict."""
        line = super().__new__(cls, text)
        line.good = good
        return line


# The space between a number and its unit, or after ±.
BESIDE_NUMBER = re.compile(rf"(?<=\d) (?=({'|'.join(map(re.escape, [*ENDINGS.values(), 'J']))})(?![\w/]))|(?<=±) ")


def printable_lines(text: str) -> str:
    """Escape the control characters of a text from a file; line ends stay."""
    return "\n".join(map(printable, text.split("\n")))


def unbroken(text: str) -> str:
    """Return a text in which no line ends between a number and its unit or ±: the space there does not break."""
    return BESIDE_NUMBER.sub("\N{NO-BREAK SPACE}", text)


def wrapped(text: str, width: int) -> list[str]:
    """Wrap a text between words, but not between a number and its unit."""
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in wrap(unbroken(text), width)]


def percent(part: float) -> str:
    """Format a part, such as a confidence level, in per cent."""
    return f"{100.0 * part:g} %"


def number(value: float | str, spec: str) -> str:
    """Format a number, with its thousands separated from 10,000 on; a text is returned as it is.

    A number that is not finite has no value and gives an empty text.
    """
    if isinstance(value, str):
        return value
    if not isfinite(value):
        return ""
    text = format(value, spec)
    if not float(text):
        return format(0, spec)  # without the sign of a number that rounds to zero
    sign = spec[:1] if spec.startswith("+") else ""
    return text if abs(float(text)) < 1e4 else format(value, f"{sign},{spec.removeprefix(sign)}")


def with_interval(value: float, ends: tuple[float | None, float | None] | None, spec: str) -> str:
    """Format an estimate with its interval, such as "0.80 (0.79 to 0.81)"."""
    return f"{number(value, spec)} ({interval(ends, spec)})"


def interval(ends: tuple[float | None, float | None] | None, spec: str) -> str:
    """Format an interval, if there is one; an end that is None is not bounded."""
    if ends is None:
        return ""
    low, high = ends
    if low is None:
        return "not bounded" if high is None else f"up to {number(high, spec)}"
    return f"from {number(low, spec)}" if high is None else f"{number(low, spec)} to {number(high, spec)}"


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading in words, and the unit."""

    label: str
    unit: str = ""
    spec: str = ""  # format specification of numbers, such as ".2f"; empty for text
    prose: bool = False  # whether text may be wrapped between words
    key: str = ""  # attribute that the column shows, and heading in CSV files, which have no column without a key

    @classmethod
    def of(cls, key: str, spec: str = "", label: str = "", *, prose: bool = False) -> Self:
        """Return the column of a quantity, an input, a key or an attribute, with label and format unless given."""
        words, unit = label_and_unit(key)
        return cls(label or words, unit, spec or (QUANTITIES[key].spec if key in QUANTITIES else ""), prose, key)

    @classmethod
    def of_each(cls, **specs: str) -> list[Self]:
        """Return the columns of attributes, given their formats."""
        return [cls.of(key, spec) for key, spec in specs.items()]

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

    @classmethod
    def of(cls, items: Iterable[Any], *sources: Source, title: str = "", rest: str = "") -> Self:
        """Make a table with a row for each item, without the columns that are empty in all of them."""
        pairs = [_with_value(source) for source in sources]
        rows = [[value(item) if callable(value) else value for _, value in pairs] for item in items]
        return cls.of_rows([column for column, _ in pairs], rows, title=title, rest=rest)

    @classmethod
    def of_rows(
        cls, columns: Sequence[Column], rows: Sequence[Sequence[Cell]], title: str = "", rest: str = ""
    ) -> Self:
        """Make a table of rows, without the columns that are empty in all of them."""
        used = [not rows or any(column.text(row[index]) for row in rows) for index, column in enumerate(columns)]
        cells = tuple(tuple(compress(row, used)) for row in rows)
        return cls(tuple(compress(columns, used)), cells, title, rest=rest)

    @classmethod
    def of_one(cls, item: Any, *sources: Source, title: str = "") -> Self:
        """Make a table of one item, without the quantities that have no value."""
        return replace(cls.of([item], *sources, title=title), record=True)

    def texts(self) -> list[list[str]]:
        """Return the rows with every value formatted."""
        return [[column.text(cell) for column, cell in zip(self.columns, row, strict=True)] for row in self.rows]


def in_words(name: str) -> str:
    """Return label and unit of a quantity, an input or a key, such as "ceramic flow stress, GPa"."""
    return Column.of(name).heading


def deviation_percent(value: float | None, reference: float) -> float | None:
    """Return the deviation of a value from a reference, per cent."""
    return None if value is None else 100.0 * (value / reference - 1.0)


def grouped(items: Iterable[Any], key: Callable[[Any], Any]) -> dict[Any, list[Any]]:
    """Return items by a key."""
    groups: dict[Any, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def of_part(part: Callable[[Any], Any], *sources: Source) -> Iterator[Source]:
    """Give the sources of a part of each item, empty for an item without this part."""

    def source_of(column: Column, value: Callable[[Any], Cell]) -> Source:
        return column, lambda item: None if part(item) is None else value(part(item))

    return starmap(source_of, map(_with_value, sources))


def _with_value(source: Source) -> tuple[Column, Any]:
    return (source, attrgetter(source.key)) if isinstance(source, Column) else source


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
