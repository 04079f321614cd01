"""CSV tables of tests and shots; every mistake in a file is reported, with its line."""

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import StringIO
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from armour.errors import InputError, Problem, choices
from armour.files import csv_value, read_text, table_file
from armour.scenario.messages import PATH
from armour.units import missing_unit

# More rows than tests or shots that anyone has made; their fits take about a minute.
MAX_ROWS = 100_000


class Frame(Protocol):
    """A data frame of pandas or polars."""

    @property
    def columns(self) -> Any:
        """Names of the columns."""

    def __getitem__(self, name: Any, /) -> Any:
        """Return a column."""


# Rows that are given: mappings by column, or a data frame.
Rows = Iterable[Mapping[str, Any]] | Frame
# A line: its place, for messages, and its cells.
Line = tuple[str, list[str]]


class CsvRow(NamedTuple):
    """A row of a CSV table: its cells by column, without the empty ones."""

    place: str  # for messages, such as "line 3"
    numbers: dict[str, float]  # without the cells that should be numbers and are not
    texts: dict[str, str]  # all cells


def read_rows(
    file: str, lines: Iterable[Line], *, numbers: Sequence[str], texts: Sequence[str], needed: Sequence[str]
) -> tuple[list[CsvRow], list[Problem]]:
    """Return the rows of a table and the mistakes in them, to which the caller adds those that it finds.

    The header names columns of numbers and of texts, at least the needed ones; the first of texts is the name of a row.
    """
    lines = [(place, cells) for place, cells in lines if any(cells)]
    if not lines:
        columns = f" with {' and '.join(needed)}" if needed else ""
        raise InputError([Problem(file, "", f"must have a header{columns}, found an empty file")])
    if len(lines) > MAX_ROWS + 1:
        message = f"must have at most {MAX_ROWS} rows below its header, found {len(lines) - 1}"
        raise InputError([Problem(file, "", message)])
    header = lines[0][1]
    if message := other_separator(header):
        raise InputError([Problem(file, lines[0][0], message)])
    wrong = [Problem(file, *found) for found in _wrong_columns(header, [*numbers, *texts], needed)]
    rows: list[CsvRow] = []
    problems: list[Problem] = []
    seen: dict[tuple[str, ...], str] = {}
    for place, cells in lines[1:]:
        if len(cells) != len(header):
            message = f"must have {len(header)} cells as the header has, found {len(cells)}"
            problems.append(Problem(file, place, message))
            continue
        if tuple(cells) in seen:
            message = f"repeats {seen[tuple(cells)]}; where both took place, name them in the column {texts[0]}"
            problems.append(Problem(file, place, message))
        seen[tuple(cells)] = place
        named = zip(header, cells, strict=True)
        row = CsvRow(place, {}, {name: csv_value(cell) if name in texts else cell for name, cell in named if cell})
        for name in filter(row.texts.get, numbers):
            if (value := finite_number(row.texts[name])) is not None:
                row.numbers[name] = value
            else:
                problems.append(Problem(file, f"{place}: {name}", f'must be a number, found "{row.texts[name]}"'))
        rows.append(row)
    if not rows and not problems and not wrong:
        problems.append(Problem(file, "", "must have at least one row below its header"))
    if wrong or not rows:
        raise InputError([*wrong, *problems])
    return rows, problems


def lines_of(table: str | PathLike[str] | Rows) -> tuple[str, Iterator[Line]]:
    """Return the name of a table, for messages, and its lines: of a CSV file, or rows that are given."""
    if isinstance(table, PATH):
        path = table_file(table)
        return str(path), _lines(path)
    columns: Any = getattr(table, "columns", None)
    found: Any = table
    try:
        # A data frame gives its columns, and anything else its rows.
        records = found if columns is None else zip(*(found[name] for name in columns), strict=True)
        rows = [dict(row) if columns is None else dict(zip(columns, row, strict=True)) for row in records]
    except (TypeError, ValueError):
        message = f"must be a path, rows as mappings, or a data frame, found a {type(table).__name__}"
        raise InputError([Problem("rows", "", message)]) from None
    header = [*dict.fromkeys(name for row in rows for name in row)]
    lines = [(f"row {place}", [_cell(row.get(name)) for name in header]) for place, row in enumerate(rows, 1)]
    return "rows", iter([("header", list(map(str, header))), *lines])


def _cell(value: object) -> str:
    """Return a value as the text of a cell, which is empty for None and NaN."""
    return "" if value is None or value != value else str(value).strip()


def _lines(path: Path) -> Iterator[Line]:
    reader = csv.reader(StringIO(read_text(path), newline=""))
    try:
        for cells in reader:
            yield f"line {reader.line_num}", [cell.strip() for cell in cells]
    except csv.Error as error:
        raise InputError([Problem(str(path), f"line {reader.line_num}", f"must be CSV: {error}")]) from None


def in_line_order(problems: Iterable[Problem]) -> list[Problem]:
    """Return the problems of a file in the order of their lines, after those of the whole file."""
    return sorted(problems, key=lambda problem: int((re.match(r"(?:line|row) (\d+)", problem.key) or [0, 0])[1]))


def other_separator(header: Sequence[str]) -> str:
    """Return what is wrong with a header of one cell that semicolons or tabs divide; "" if nothing is."""
    found = [name for mark, name in ((";", "semicolons"), ("\t", "tabs")) if mark in "".join(header)]
    return f"must separate columns by commas, found {found[0]}" if found and len(header) == 1 else ""


def finite_number(cell: str) -> float | None:
    """Return a finite number; None for any other text."""
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if isfinite(value) else None


def _wrong_columns(header: Sequence[str], known: Sequence[str], needed: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the mistakes in a header: key and message."""
    for name in dict.fromkeys(header):
        if header.count(name) > 1:
            yield name, "must be the name of one column, found several"
        if name not in known:
            yield name or "header", f"unknown column{missing_unit(name, known) or choices(name, known)}"
    for name in needed:
        if name not in header:
            yield name, "is missing and must be a column"
