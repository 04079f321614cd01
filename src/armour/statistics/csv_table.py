"""Reading of CSV tables: all mistakes are reported, with their lines."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from math import isfinite
from pathlib import Path

from armour.errors import InputError, Problem, suggestion
from armour.files import read_text
from armour.units import missing_unit

Cell = float | str | None


@dataclass(frozen=True)
class CsvRow:
    """A row of a CSV table: numbers and texts by column, None where a cell is empty."""

    line: int
    cells: Mapping[str, Cell]

    @property
    def place(self) -> str:
        """Place of the row, for messages."""
        return f"line {self.line}"

    def __getitem__(self, name: str) -> Cell:
        """Return the cell of a column; None where it is empty or the table has no such column."""
        return self.cells.get(name)


def read_rows(path: Path, *, numbers: Sequence[str], texts: Sequence[str], needed: Sequence[str]) -> list[CsvRow]:
    """Read a CSV file with a header.

    Parameters
    ----------
    path : Path
    numbers, texts : sequence of str
        Columns of numbers and of texts that are allowed.
    needed : sequence of str
        Columns that are required.

    Raises
    ------
    InputError
        With every mistake: unknown columns, cells that are not numbers, repeated rows.
    """
    lines = [(number, cells) for number, cells in _lines(path) if any(cell.strip() for cell in cells)]
    if not lines:
        raise InputError(
            [Problem(str(path), "", f"must have a header with {' and '.join(needed)}, found an empty file")]
        )
    header = [cell.strip() for cell in lines[0][1]]
    problems = [Problem(str(path), *found) for found in _wrong_columns(header, [*numbers, *texts], needed)]
    rows: list[CsvRow] = []
    seen: dict[tuple[tuple[str, str], ...], int] = {}
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            message = f"must have {len(header)} cells as the header has, found {len(cells)}"
            problems.append(Problem(str(path), f"line {number}", message))
            continue
        row = {name: cell.strip() for name, cell in zip(header, cells, strict=True)}
        whole = tuple(row.items())
        if whole in seen:
            message = f"repeats line {seen[whole]}; name tests in a column of their own where both took place"
            problems.append(Problem(str(path), f"line {number}", message))
        seen[whole] = number
        values: dict[str, Cell] = {}
        for name, cell in row.items():
            try:
                values[name] = _value(cell, number=name in numbers)
            except ValueError:
                problems.append(Problem(str(path), f"line {number}: {name}", f'must be a number, found "{cell}"'))
        rows.append(CsvRow(number, values))
    if not rows and not problems:
        problems.append(Problem(str(path), "", "must have at least one row below its header"))
    if problems:
        raise InputError(problems)
    return rows


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(StringIO(read_text(path), newline=""))
    try:
        for cells in reader:
            yield reader.line_num, cells
    except csv.Error as error:
        raise InputError([Problem(str(path), f"line {reader.line_num}", f"must be CSV: {error}")]) from None


def _value(cell: str, *, number: bool) -> Cell:
    """Convert a cell.

    Raises
    ------
    ValueError
        If it must be a number and is not.
    """
    if not cell:
        return None
    if not number:
        return cell
    value = float(cell)
    if not isfinite(value):
        raise ValueError
    return value


def _wrong_columns(header: Sequence[str], known: Sequence[str], needed: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the mistakes in a header: key and message."""
    for name in dict.fromkeys(header):
        if header.count(name) > 1:
            yield name, "must be the name of one column, found several"
        if name not in known:
            hint = missing_unit(name, known) or suggestion(name, known)
            yield name or "header", f"unknown column{hint or '; there are ' + ', '.join(known)}"
    for name in needed:
        if name not in header:
            yield name, "is missing and must be a column"
