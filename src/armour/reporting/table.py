"""Tables: columns described once, rows of raw values, and their text for people and for CSV files."""

import csv
from dataclasses import dataclass
from io import StringIO
from typing import Literal

Cell = float | int | str | None


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    label : str
        Heading in words, without the unit.
    unit : str
    spec : str
        Format specification of the column's numbers, such as ".2f"; empty for a column of text.
    prose : bool
        Whether text may be wrapped between words.
    key : str
        Heading in CSV files; a column without one is left out of them.
    """

    label: str
    unit: str = ""
    spec: str = ""
    prose: bool = False
    key: str = ""

    @property
    def heading(self) -> str:
        """Label and unit."""
        return ", ".join(part for part in (self.label, self.unit) if part)

    @property
    def numeric(self) -> bool:
        """Whether the column holds numbers."""
        return bool(self.spec)

    @property
    def alignment(self) -> Literal["left", "right"]:
        """Numbers are aligned to the right, text to the left."""
        return "right" if self.numeric else "left"

    def text(self, value: Cell) -> str:
        """Format a value; None gives an empty text, and a text is returned as it is."""
        if value is None:
            return ""
        return value if isinstance(value, str) else format(value, self.spec)


@dataclass(frozen=True)
class Table:
    """Rows of values under their columns.

    Attributes
    ----------
    columns : tuple of Column
    rows : tuple of tuple of Cell
    title : str
    record : bool
        Whether the table has one row, which is listed quantity by quantity.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    record: bool = False

    def headings(self) -> list[str]:
        """Return the headings of the columns, with units."""
        return [column.heading for column in self.columns]

    def alignments(self) -> list[Literal["left", "right"]]:
        """Return the alignments of the columns."""
        return [column.alignment for column in self.columns]

    def texts(self) -> list[list[str]]:
        """Return the rows with every value formatted."""
        return [[column.text(cell) for column, cell in zip(self.columns, row, strict=True)] for row in self.rows]


def record(*quantities: tuple[Column, Cell], title: str = "") -> Table:
    """Make a table of one row from columns and their values; quantities without a value are left out."""
    known = [(column, value) for column, value in quantities if value is not None]
    return Table(tuple(column for column, _ in known), (tuple(value for _, value in known),), title, record=True)


def csv_text(table: Table) -> str:
    """Format a table as a CSV file: the keys of its columns, and numbers with all their digits."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    kept = [index for index, column in enumerate(table.columns) if column.key]
    writer.writerow([table.columns[index].key for index in kept])
    writer.writerows([row[index] for index in kept] for row in table.rows)
    return text.getvalue()
