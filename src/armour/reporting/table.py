"""Format numbers, intervals and texts, and make tables of them for people and for CSV files.

Control characters in text from files are escaped, so that it is safe for terminals and XML.
"""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from itertools import compress, starmap
from math import ceil, floor, isfinite
from operator import attrgetter
from textwrap import wrap
from typing import Any, Self

from armour.analysis.quantities import QUANTITIES, label_and_unit
from armour.files import csv_cell, finite, printable
from armour.units import ENDINGS

Cell = float | int | str | None


class VerdictLine(str):
    """A line with an answer, which a terminal shows bold: green if it is good, red if not, yellow if that is unsure."""

    good: bool | None
    unsure: bool

    def __new__(cls, text: str, *, good: bool | None = None, unsure: bool = False) -> Self:
        """Make the line; without `good` and `unsure`, it has no colour."""
        line = super().__new__(cls, text)
        line.good, line.unsure = good, unsure
        return line


# Matches the space between a number and its unit, or after ±.
BESIDE_NUMBER = re.compile(rf"(?<=\d) (?=({'|'.join(map(re.escape, [*ENDINGS.values(), 'J']))})(?![\w/]))|(?<=±) ")


def printable_lines(text: str) -> str:
    """Escape the control characters of a text from a file, but keep its line ends."""
    return "\n".join(map(printable, text.split("\n")))


def unbroken(text: str) -> str:
    """Replace the spaces between numbers and units, and after ±, by no-break spaces."""
    return BESIDE_NUMBER.sub("\N{NO-BREAK SPACE}", text)


def wrapped(text: str, width: int) -> list[str]:
    """Wrap a text to lines of at most `width` characters, never between a number and its unit."""
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in wrap(unbroken(text), width)]


def sentence(words: str) -> str:
    """Return words as a sentence, with a capital letter and a full stop."""
    return f"{words[:1].upper()}{words[1:]}."


def percent(part: float) -> str:
    """Format a fraction, such as a confidence level, in per cent: 0.95 gives "95 %"."""
    return f"{100.0 * part:g} %"


def number(value: float | str, spec: str) -> str:
    """Format a number by a format specification, with thousands separated from 10,000 on.

    A text is returned as it is.  NaN and infinity give an empty text.
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


def beside(value: float, bound: float, decimals: int, *, at_most: bool = False) -> str:
    """Format a number beside a bound, the least allowed or, if `at_most`, the greatest, so that a miss stays a miss.

    It is rounded half up, but to the unsafe side where it would otherwise seem to keep the bound; a bound with more
    decimals gives more.
    """
    if isfinite(bound):
        decimals = max(decimals, len(f"{bound:.10g}".partition(".")[2]))
    scale, side = 10.0**decimals, -1.0 if at_most else 1.0
    rounded = floor(value * scale + 0.5 + 1e-6) / scale
    if side * value < side * bound <= side * rounded:
        rounded = (ceil if at_most else floor)(value * scale) / scale
    return number(rounded, f".{decimals}f")


def interval(ends: tuple[float | None, float | None] | None, spec: str) -> str:
    """Format an interval; None gives an empty text, and an end that is None is unbounded."""
    if ends is None:
        return ""
    low, high = ends
    if low is None:
        return "not bounded" if high is None else f"up to {number(high, spec)}"
    return f"from {number(low, spec)}" if high is None else f"{number(low, spec)} to {number(high, spec)}"


def between(level: float, ends: tuple[float | None, float | None], spec: str) -> str:
    """Format an interval with its confidence level, such as "95 % between 764 and 798"."""
    words = interval(ends, spec)
    return f"{percent(level)} {words}" if None in ends else f"{percent(level)} between {words.replace(' to ', ' and ')}"


@dataclass(frozen=True)
class Column:
    """A column of a table: its label and unit, and how its cells are formatted."""

    label: str
    unit: str = ""
    spec: str = ""  # format specification of numbers, such as ".2f"; empty for text
    prose: bool = False  # whether text may be wrapped between words
    key: str = ""  # attribute of items that it shows, and heading in CSV files, which omit columns without a key

    @classmethod
    def of(cls, key: str, spec: str = "", label: str = "", *, prose: bool = False) -> Self:
        """Return the column of a quantity, input, key or attribute; label and format follow from `key` unless given."""
        words, unit = label_and_unit(key)
        return cls(label or words, unit, spec or (QUANTITIES[key].spec if key in QUANTITIES else ""), prose, key)

    @property
    def heading(self) -> str:
        """Label and unit, such as "velocity, m/s"."""
        return ", ".join(part for part in (self.label, self.unit) if part)

    @property
    def numeric(self) -> bool:
        """Whether the column holds numbers."""
        return bool(self.spec)

    def text(self, value: Cell) -> str:
        """Format a cell of the column without its unit; None gives an empty text, and a text is returned as it is."""
        return "" if value is None else number(value, self.spec)

    def with_unit(self, value: Cell) -> str:
        """Format a value with its unit."""
        return f"{self.text(value)} {self.unit}".rstrip()


# Where the cells of a column come from: a column alone shows the attribute of each item that its key names; with a
# second member, it shows this value, or what this function returns for the item.
Source = Column | tuple[Column, Cell | Callable[[Any], Cell]]


@dataclass(frozen=True)
class Table:
    """Rows of cells under columns; a record is a table of one row, shown with a line for each column."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    record: bool = False
    rest: str = ""  # option that shows all rows, where a terminal shows only the first

    @classmethod
    def of(cls, items: Iterable[Any], *sources: Source, title: str = "", rest: str = "") -> Self:
        """Make a table with a row for each item; omit columns without a value in any row."""
        pairs = [_column_and_value(source) for source in sources]
        rows = [[value(item) if callable(value) else value for _, value in pairs] for item in items]
        return cls.of_rows([column for column, _ in pairs], rows, title=title, rest=rest)

    @classmethod
    def of_rows(
        cls, columns: Sequence[Column], rows: Sequence[Sequence[Cell]], title: str = "", rest: str = ""
    ) -> Self:
        """Make a table of rows, each with a cell for every column; omit columns without a value in any row."""
        used = [not rows or any(column.text(row[index]) for row in rows) for index, column in enumerate(columns)]
        cells = tuple(tuple(compress(row, used)) for row in rows)
        return cls(tuple(compress(columns, used)), cells, title, rest=rest)

    @classmethod
    def of_one(cls, item: Any, *sources: Source, title: str = "") -> Self:
        """Make a record of one item; omit columns without a value."""
        return replace(cls.of([item], *sources, title=title), record=True)

    @classmethod
    def of_facts(cls, facts: Mapping[str, str]) -> Self:
        """Make a record of texts by label; omit those that are empty."""
        return cls.of_one(None, *((Column(label, prose=True), text) for label, text in facts.items()))

    def texts(self) -> list[list[str]]:
        """Return the rows with every cell formatted as text."""
        return [[column.text(cell) for column, cell in zip(self.columns, row, strict=True)] for row in self.rows]


def in_words(name: str) -> str:
    """Return the label and unit of a quantity, input or key, such as "ceramic flow stress, GPa"."""
    return Column.of(name).heading


def grouped(items: Iterable[Any], key: Callable[[Any], Any]) -> dict[Any, list[Any]]:
    """Group items by the value of a function, in the order of first appearance."""
    groups: dict[Any, list[Any]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def of_part(part: Callable[[Any], Any], *sources: Source) -> Iterator[Source]:
    """Yield sources that show a part of each item, which `part` returns; cells are empty where it returns None."""

    def source_of(column: Column, value: Callable[[Any], Cell]) -> Source:
        return column, lambda item: None if part(item) is None else value(part(item))

    return starmap(source_of, map(_column_and_value, sources))


def _column_and_value(source: Source) -> tuple[Column, Any]:
    """Return the column of a source, and its value or the function that gives the value for an item."""
    return (source, attrgetter(source.key)) if isinstance(source, Column) else source


def csv_text(table: Table) -> str:
    """Format the columns of a table that have a key as CSV, under these keys and with numbers unrounded."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keyed = [index for index, column in enumerate(table.columns) if column.key]
    writer.writerow([_csv_cell(table.columns[index].key) for index in keyed])
    writer.writerows([_csv_cell(row[index]) for index in keyed] for row in table.rows)
    return text.getvalue()


def rows_csv(rows: Iterable[Mapping[str, Any]]) -> str:
    """Format mappings with the same keys as CSV; an interval becomes two columns.

    "v50_interval_m_s", for example, becomes "v50_interval_low_m_s" and "v50_interval_high_m_s".
    """
    cells = [dict(_with_ends(row)) for row in rows]
    keys = list(cells[0])
    return csv_text(Table(tuple(Column(key, key=key) for key in keys), tuple(tuple(row.values()) for row in cells)))


def _with_ends(row: Mapping[str, Any]) -> Iterator[tuple[str, Cell]]:
    """Yield the keys and cells of a row, with both ends of each interval instead of the interval."""
    for key, value in row.items():
        if "interval" in key:
            low, high = value or (None, None)
            yield key.replace("interval", "interval_low"), low
            yield key.replace("interval", "interval_high"), high
        else:
            yield key, value


def _csv_cell(cell: Cell) -> Cell:
    """Return a cell as CSV has it: text safe for spreadsheets, and nothing for NaN and infinity."""
    return csv_cell(cell) if isinstance(cell, str) else finite(cell)
