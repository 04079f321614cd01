"""CSV tables of tests and shots; every mistake in a file is reported, with its line."""

import csv
from collections.abc import Iterator, Sequence
from io import StringIO
from math import isfinite
from pathlib import Path
from typing import NamedTuple

from armour.errors import InputError, Problem, suggestion
from armour.files import read_text
from armour.units import missing_unit


class CsvRow(NamedTuple):
    """A row of a CSV table; empty cells are left out."""

    place: str  # for messages, such as "line 3"
    numbers: dict[str, float]  # by column
    texts: dict[str, str]


def read_rows(path: Path, *, numbers: Sequence[str], texts: Sequence[str], needed: Sequence[str]) -> list[CsvRow]:
    """Read a CSV file with a header; its columns of numbers and of texts are those given, at least the needed ones."""
    lines = [(place, cells) for place, cells in _lines(path) if any(cells)]
    if not lines:
        raise InputError(
            [Problem(str(path), "", f"must have a header with {' and '.join(needed)}, found an empty file")]
        )
    header = lines[0][1]
    problems = [Problem(str(path), *found) for found in _wrong_columns(header, [*numbers, *texts], needed)]
    rows: list[CsvRow] = []
    seen: dict[tuple[str, ...], str] = {}
    for place, cells in lines[1:]:
        if len(cells) != len(header):
            message = f"must have {len(header)} cells as the header has, found {len(cells)}"
            problems.append(Problem(str(path), place, message))
            continue
        if tuple(cells) in seen:
            message = f"repeats {seen[tuple(cells)]}; name tests in a column of their own where both took place"
            problems.append(Problem(str(path), place, message))
        seen[tuple(cells)] = place
        row = CsvRow(place, {}, {})
        for name, cell in zip(header, cells, strict=True):
            if not cell:
                continue
            if name not in numbers:
                row.texts[name] = cell
            elif (value := _number(cell)) is not None:
                row.numbers[name] = value
            else:
                problems.append(Problem(str(path), f"{place}: {name}", f'must be a number, found "{cell}"'))
        rows.append(row)
    if not rows and not problems:
        problems.append(Problem(str(path), "", "must have at least one row below its header"))
    if problems:
        raise InputError(problems)
    return rows


def _lines(path: Path) -> Iterator[tuple[str, list[str]]]:
    reader = csv.reader(StringIO(read_text(path), newline=""))
    try:
        for cells in reader:
            yield f"line {reader.line_num}", [cell.strip() for cell in cells]
    except csv.Error as error:
        raise InputError([Problem(str(path), f"line {reader.line_num}", f"must be CSV: {error}")]) from None


def _number(cell: str) -> float | None:
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
            hint = missing_unit(name, known) or suggestion(name, known)
            yield name or "header", f"unknown column{hint or '; there are ' + ', '.join(known)}"
    for name in needed:
        if name not in header:
            yield name, "is missing and must be a column"
