"""CSV files that people write: shots, tests and cases; every mistake in a file is reported, with its line."""

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice
from math import isfinite, nan
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from armour.errors import CHOOSE, InputError, Problem, mistake, refuse, suggestion
from armour.files import csv_value, located, named, reason, refuse_pipe, shipped_tests
from armour.units import key_hint

# Greatest number of rows, more than anyone has tests or shots; a fit to so many takes about a minute.
MAX_ROWS = 100_000
# Greatest length of a line; a device such as /dev/zero has no end of line.
MAX_LINE = 100_000
# Pairs of words, in lower case, for an armour that stopped a shot and for one that was perforated.
OUTCOMES = (
    ("stopped", "perforated"),
    ("partial", "complete"),
    ("p", "c"),
    ("pp", "cp"),
    ("no", "yes"),
    ("stop", "perforate"),
    ("defeated", "perforated"),
)
# Whether the armour was perforated, by word.
PERFORATED = {word: word == perforated for stopped, perforated in OUTCOMES for word in (stopped, perforated)}
MUST_SAY = 'must be "stopped" or "perforated" (or partial or complete, P or C, PP or CP, no or yes)'
# Bytes that are not UTF-8 text, as they are read.
_UNDECODED = re.compile("[\udc80-\udcff]")


class Frame(Protocol):
    """A data frame of pandas or polars."""

    @property
    def columns(self) -> Any:
        """Names of the columns."""

    def __getitem__(self, name: Any, /) -> Any:
        """Return a column."""


# Rows given in Python: mappings by column, or a data frame.
Rows = Iterable[Mapping[str, Any]] | Frame
# A line: its place, for messages, and its cells.
Line = tuple[str, list[str]]


class CsvRow(NamedTuple):
    """A row of a CSV table: its cells by column, without the empty ones."""

    place: str  # for messages, such as "line 3"
    numbers: dict[str, float]  # without the cells that should be numbers and are not
    texts: dict[str, str]  # all cells


def read_rows(
    file: str,
    lines: Iterable[Line],
    *,
    numbers: Sequence[str],
    texts: Sequence[str],
    needed: Sequence[str],
    usual: str = "",
) -> tuple[list[CsvRow], list[Problem]]:
    """Return the rows of a table and the mistakes in them, to which the caller adds its own.

    The header names columns of numbers and of texts, at least those needed; the first column of texts names the row.
    If a name resembles none of them, the message lists the ``usual`` ones, by default all.
    """
    lines = list(islice(lines, MAX_ROWS + 2))
    if not lines:
        needed_columns = f" with {' and '.join(needed)}" if needed else ""
        raise mistake(file, "", f"must have a header{needed_columns}, found an empty file")
    if len(lines) > MAX_ROWS + 1:
        raise mistake(file, "", f"must have at most {MAX_ROWS} rows below its header, found more")
    header = lines[0][1]
    check_header(file, *lines[0])
    columns = [*numbers, *texts]
    usual = usual or ", ".join(columns)
    wrong = [
        Problem(file, name or "header", f"unknown column{key_hint(name, columns) or like or CHOOSE + usual}")
        for name in dict.fromkeys(header)
        if name not in columns
        for like in [suggestion(name, columns)]
    ]
    wrong += (Problem(file, name, "is missing and must be a column") for name in needed if name not in header)
    rows: list[CsvRow] = []
    problems: list[Problem] = []
    places: dict[tuple[str, ...], str] = {}
    for place, cells in lines[1:]:
        if len(cells) != len(header):
            problems.append(Problem(file, place, wrong_width(cells, header)))
            continue
        if tuple(cells) in places:
            message = f"repeats {places[tuple(cells)]}; if both took place, name them in the column {texts[0]}"
            problems.append(Problem(file, place, message))
        places[tuple(cells)] = place
        filled = {name: cell for name, cell in zip(header, cells, strict=True) if cell}
        row = CsvRow(place, {}, {name: csv_value(cell) if name in texts else cell for name, cell in filled.items()})
        for name in filter(row.texts.get, numbers):
            if (value := number(row.texts[name])) is not None:
                row.numbers[name] = value
            else:
                problems.append(Problem(file, f"{place}: {name}", f'must be a number, found "{row.texts[name]}"'))
        rows.append(row)
    if not rows and not problems and not wrong:
        problems.append(Problem(file, "", "must have at least one row below its header"))
    if wrong or not rows:
        raise InputError([*wrong, *problems])
    return rows, problems


def read_csv(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and cells of each line of a CSV file that is not blank; no cell spans several lines."""

    def texts() -> Iterator[str]:
        for place, line in enumerate(iter(lambda: file.readline(MAX_LINE), ""), 1):
            if len(line) == MAX_LINE:
                raise mistake(path, f"line {place}", f"must be shorter than {MAX_LINE:,} characters")
            if not line.isascii() and (undecoded := _UNDECODED.search(line)):
                byte = ord(undecoded[0]) - 0xDC00
                raise mistake(path, f"line {place}", f"must be UTF-8 text, found the byte {byte:#04x}")
            yield line

    last_line = 0
    try:
        refuse_pipe(path)
        with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
            reader = csv.reader(texts(), strict=True)
            for cells in reader:
                if reader.line_num > last_line + 1:
                    raise csv.Error
                last_line += 1
                stripped = [cell.strip() for cell in cells]
                if any(stripped):
                    yield last_line, stripped
    except csv.Error:
        message = "must close each quote on its line, before a comma or the end of the line"
        raise mistake(path, f"line {last_line + 1}", message) from None
    except (OSError, ValueError) as error:
        raise mistake(path, "", f"cannot be read: {reason(error)}") from None


def shipped_rows(name: str) -> list[dict[str, str]]:
    """Return the rows of a shipped table by column."""
    (_, header), *lines = lines_of(shipped_tests()[name])[1]
    return [dict(zip(header, cells, strict=True)) for _, cells in lines]


def lines_of(table: str | PathLike[str] | Rows) -> tuple[str, Iterator[Line]]:
    """Return the name of a table, for messages, and its lines, from rows or a CSV file, perhaps a shipped one."""
    if isinstance(table, str | PathLike):
        path = located(Path(table), shipped_tests())
        name = named(path)
        shown = name if name == str(path) else f"{name} (shipped)"
        return shown, ((f"line {number}", cells) for number, cells in read_csv(path))
    columns: Any = getattr(table, "columns", None)
    frame: Any = table
    try:
        # A data frame gives its columns, and anything else its rows.
        records = frame if columns is None else zip(*(frame[name] for name in columns), strict=True)
        rows = [dict(row) if columns is None else dict(zip(columns, row, strict=True)) for row in records]
    except (TypeError, ValueError):
        message = f"must be a path, rows as mappings, or a data frame, found a {type(table).__name__}"
        raise mistake("rows", "", message) from None
    header = [*dict.fromkeys(name for row in rows for name in row)]
    lines = [(f"row {place}", [_cell(row.get(name)) for name in header]) for place, row in enumerate(rows, 1)]
    filled = (line for line in lines if any(line[1]))
    return "rows", chain([("header", list(map(str, header)))] if header else [], filled)


def _cell(value: object) -> str:
    """Return a value as the text of a cell, which is empty for None and NaN."""
    return "" if value is None or value != value else str(value).strip()


def in_line_order(problems: Iterable[Problem]) -> list[Problem]:
    """Return the problems of a file in the order of their lines, after those of the whole file."""
    return sorted(problems, key=lambda problem: int((re.match(r"(?:line|row) (\d+)", problem.key) or [0, 0])[1]))


def check_header(file: str, place: str, header: Sequence[str]) -> None:
    """Raise an InputError if semicolons or tabs divide a header, or if it names a column twice."""
    separators = [name for mark, name in ((";", "semicolons"), ("\t", "tabs")) if mark in "".join(header)]
    if separators and len(header) == 1:
        message = f"must separate columns by commas and write decimals with points, found {separators[0]}"
        raise mistake(file, place, message)
    message = "must be the name of one column, found several"
    twice = [name for name in dict.fromkeys(header) if header.count(name) > 1]
    refuse(Problem(file, f"{place}: {name}" if name else place, message) for name in twice)


def wrong_width(cells: Sequence[str], header: Sequence[str]) -> str:
    """Return what is wrong with a row that has more or fewer cells than the header."""
    hint = "; write decimals with points, and texts with commas in quotes" if len(cells) > len(header) else ""
    return f"must have {len(header)} cells as the header has, found {len(cells)}{hint}"


def number(cell: str) -> float | None:
    """Return a finite decimal number as people write it; None for any other text, such as "7_00"."""
    try:
        value = float(cell) if cell.isascii() and "_" not in cell else nan
    except ValueError:
        return None
    return value if isfinite(value) else None
