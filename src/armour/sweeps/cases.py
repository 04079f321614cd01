"""Rows of a sweep: grids of values and tables of cases."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from itertools import islice
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from armour.csv_files import check_header, in_line_order, number, read_csv, wrong_width
from armour.errors import Problem, mistake, refuse, restated
from armour.files import csv_value
from armour.scenario.inputs import NAMING
from armour.scenario.keys import describe, key_name, parts_of
from armour.scenario.schema import Steps
from armour.scenario.sections import validated

# Cases are kept in memory, at 8 bytes per number.
MAX_CASES = 10_000_000
# Rows of a grid are numbered by integers of 64 bits.
MAX_COMBINATIONS = 10**18
# Greatest length of the name of a projectile or material.
MAX_NAME = 200
# Number of characters of an invalid value that a message shows.
MAX_SHOWN = 60
# Number of rows to read or check at a time.
BLOCK = 10_000


@dataclass(frozen=True)
class Axis:
    """A key and its values: numbers, or names of projectiles or materials."""

    key: str
    values: tuple[float, ...] | tuple[str, ...]
    omission: str = ""  # warning that the end of a range is left out, because it is not a whole number of steps away


@dataclass(frozen=True)
class Grid:
    """Every combination of the values of several axes; the last axis changes fastest."""

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        if self.count > MAX_COMBINATIONS:
            raise mistake("sweep", "over", "must have at most 10^18 combinations of values, found more")

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the axes."""
        return tuple(axis.key for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of combinations."""
        return prod(len(axis.values) for axis in self.axes)

    @cached_property
    def digest(self) -> str:
        """Hash of keys and values."""
        return sha256(json.dumps([(axis.key, axis.values) for axis in self.axes]).encode()).hexdigest()

    def rows(self, places: NDArray[np.int64]) -> dict[str, Any]:
        """Return the combinations with given numbers, counted from 0, as columns by key."""
        indices = np.unravel_index(places, [len(axis.values) for axis in self.axes])
        return {axis.key: np.array(axis.values)[i] for axis, i in zip(self.axes, indices, strict=True)}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem of a row, counted from the first row of a chunk, with the values of the row."""
        if problem.key in self.keys:
            return Problem("sweep", f"over {problem.key}", problem.message)
        indices = np.unravel_index(start + row, [len(axis.values) for axis in self.axes])
        row_values = ((axis.key, axis.values[i]) for axis, i in zip(self.axes, indices, strict=True))
        values = (f"{key}={value}" if isinstance(value, str) else f"{key}={value:g}" for key, value in row_values)
        return Problem("sweep", f"over {', '.join(values)}", f"{problem.key}: {problem.message}")


class Cases:
    """Rows of a CSV file whose header names keys of the scenario: numbers, and names of projectiles and materials.

    The file is read once.
    """

    axes: tuple[Axis, ...] = ()  # those of a grid

    def __init__(self, path: Path) -> None:
        self.path = path
        lines = read_csv(path)
        first, header = next(lines, (0, []))
        place = f"line {first}"
        check_header(str(path), place, header)
        if "" in header:
            raise mistake(path, place, f"must name a key in each column, found none in {header.index('') + 1}")
        self.keys = tuple(header)
        self.count = 0
        blocks: list[tuple[Any, ...]] = []
        while block := list(islice(lines, BLOCK)):
            self.count += len(block)
            if self.count > MAX_CASES:
                raise mistake(path, "", f"must have at most {MAX_CASES:,} rows, found more")
            blocks.append((np.array([line for line, _ in block]), *self._read(block)))
        if not self.count:
            raise mistake(path, "", "must have a header of keys and at least one row")
        self._lines, *columns = map(np.concatenate, zip(*blocks, strict=True))
        self._columns = dict(zip(self.keys, columns, strict=True))
        content = sha256()
        for key, column in self._columns.items():
            content.update(json.dumps([key, column.dtype.str, self.count]).encode())
            content.update(column.tobytes())
        self.digest = content.hexdigest()

    def rows(self, places: NDArray[np.int64]) -> dict[str, Any]:
        """Return the rows with given numbers, counted from 0, as columns by key."""
        return {key: column[places] for key, column in self._columns.items()}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem of a row, counted from the first row of a chunk, with its line."""
        return Problem(str(self.path), f"line {self._lines[start + row]}", f"{problem.key}: {problem.message}")

    def _read(self, block: Sequence[tuple[int, Sequence[str]]]) -> list[Any]:
        """Return the columns of n lines, each with numbers or names, (n,)."""
        file = str(self.path)
        refuse(
            Problem(file, f"line {line}", wrong_width(cells, self.keys))
            for line, cells in block
            if len(cells) != len(self.keys)
        )
        columns, problems = [], list[Problem]()
        for key, cells in zip(self.keys, zip(*(cells for _, cells in block), strict=True), strict=True):
            kind, read = ("name", _name) if key in NAMING else ("number", number)
            values = [read(cell) for cell in cells]
            if None in values:
                problems += (
                    Problem(file, f"line {line}: {key}", f'must be a {kind}, found "{cell[:40]}"')
                    for (line, _), cell, value in zip(block, cells, values, strict=True)
                    if value is None
                )
            columns.append(np.array(values))
        refuse(in_line_order(problems))
        return columns


def _name(cell: str) -> str | None:
    """Return the name in a cell; None if it cannot be a name."""
    name = csv_value(cell)
    return name if 0 < len(name) <= MAX_NAME else None


def axis_of(text: str) -> Axis:
    """Parse an axis of numbers from ``KEY=MIN:MAX:STEP`` or ``KEY=VALUE,VALUE,...``."""
    key, _, values = text.rpartition("=")
    try:
        key = key_name(parts_of(key))
    except ValueError:
        raise mistake("sweep", "over", f'must be KEY=MIN:MAX:STEP or KEY=VALUE,VALUE,..., found "{text}"') from None
    if key in NAMING:
        message = f'must be a key of numbers, found "{values}"; names are given by --cases, in a column {key}'
        raise mistake("sweep", f"over {key}", message)
    is_range = ":" in values
    cells = values.split(":" if is_range else ",")
    numbers = [value for cell in cells if (value := number(cell)) is not None]
    if len(numbers) < len(cells) or (is_range and len(numbers) != 3):
        message = f'must be MIN:MAX:STEP or VALUE,VALUE,... of finite numbers, found "{values[:MAX_SHOWN]}"'
        raise mistake("sweep", f"over {key}", message)
    return axis(key, dict(zip(("min", "max", "step"), numbers, strict=True)) if is_range else numbers)


def source_of(over: Mapping[str, object] | str | PathLike[str]) -> Grid | Cases:
    """Return the rows of a sweep: a grid of a mapping, or the cases in a file."""
    if not isinstance(over, Mapping):
        return Cases(Path(over))
    if not over:
        raise mistake("sweep", "over", "must contain at least one key with its values, found none")
    return Grid(tuple(axis(key, values) for key, values in over.items()))


def axis(key: str, values: object) -> Axis:
    """Return a key with its values: a sequence, or a mapping with min, max and step."""
    is_name = key in NAMING
    if isinstance(values, Mapping) and not is_name:
        with restated(lambda problem: Problem("sweep", f"over {key}", str(problem))):
            steps = validated(Steps, dict(values), "")
        return Axis(key, steps.values(), steps.omission())
    array = np.asarray(values)
    if array.ndim == 1 and array.size and array.dtype.kind in ("U" if is_name else "iuf"):
        if is_name:
            return Axis(key, tuple(array.tolist()))
        if np.isfinite(array).all():
            return Axis(key, tuple(array.astype(np.float64).tolist()))
    must = f"must be a sequence of {'names' if is_name else 'finite numbers, or a range with min, max and step'}"
    shown = describe(values) if isinstance(values, str) else repr(values)[:MAX_SHOWN]
    raise mistake("sweep", f"over {key}", f"{must}, found {shown}")
