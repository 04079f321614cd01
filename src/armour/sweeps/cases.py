"""Rows of a sweep: grids of values and tables of cases."""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import sha256
from itertools import islice, repeat
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from armour.errors import InputError, Problem, choices
from armour.files import check_unreserved, csv_value, exists, reason
from armour.scenario.assignments import parts_of
from armour.scenario.loading import Scenario
from armour.scenario.messages import key_name
from armour.scenario.parameters import INPUTS, NAMES, ROLES
from armour.scenario.schema import MAX_VALUES, Range
from armour.statistics.csv_table import finite_number, other_separator

# More rows than a sweep can compute in years.
MAX_ROWS = 10**12
# Longer than any line of numbers.
MAX_LINE_BYTES = 100_000
# Longer than any name of a projectile or material.
MAX_NAME = 200
# Lines of a file that are read at a time where nothing else is asked for.
BLOCK = 10_000

_CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f]")


@dataclass(frozen=True)
class Axis:
    """A key and its values: numbers, or names of projectiles or materials."""

    key: str
    values: tuple[float, ...] | tuple[str, ...]
    omitted: float | None = None  # end of a range that is no whole number of steps from its start


@dataclass(frozen=True)
class Grid:
    """Every combination of the values of several axes; the last axis changes fastest."""

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        if self.count > MAX_ROWS:
            message = f"must span at most {MAX_ROWS:,} rows, found {self.count:.3g}"
            raise InputError([Problem("sweep", "over", message)])

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
        """A hash of keys and values."""
        return sha256(repr(self.axes).encode()).hexdigest()

    def chunks(self, sizes: Iterable[int]) -> Iterator[dict[str, Any]]:
        """Yield the combinations as columns by key, in chunks of numbers of rows."""
        start = 0
        for size in sizes:
            if start == self.count:
                return
            stop = min(start + size, self.count)
            yield self._rows(np.arange(start, stop))
            start = stop

    def sample(self, size: int) -> dict[str, Any]:
        """Return some rows spread over the grid, as columns by key."""
        return self._rows(np.linspace(0, self.count - 1, min(size, self.count)).astype(np.int64))

    def _rows(self, places: NDArray[np.int64]) -> dict[str, Any]:
        indices = np.unravel_index(places, [len(axis.values) for axis in self.axes])
        return {axis.key: np.array(axis.values)[i] for axis, i in zip(self.axes, indices, strict=True)}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem in a row, counted from a row at which a chunk starts, with the values that make it."""
        if problem.key in self.keys:
            return Problem("sweep", f"over {problem.key}", problem.message)
        indices = np.unravel_index(start + row, [len(axis.values) for axis in self.axes])
        found = ((axis.key, axis.values[i]) for axis, i in zip(self.axes, indices, strict=True))
        values = (f"{key}={value}" if isinstance(value, str) else f"{key}={value:g}" for key, value in found)
        return Problem("sweep", f"over {', '.join(values)}", f"{problem.key}: {problem.message}")


class Cases:
    """Rows of a CSV file whose header names keys of the scenario: numbers, and names of projectiles and materials.

    The file is read from its start for each pass; a pass that does not find what the first one found raises an error.
    """

    def __init__(self, path: Path, others: Sequence[str] = ()) -> None:
        self.path = path
        self.others = others  # columns of numbers that are no keys
        self.keys: tuple[str, ...] = ()
        self.count = 0
        self.digest = ""
        for columns in self.chunks(repeat(BLOCK)):
            self.keys = tuple(columns)
            self.count += len(columns[self.keys[0]])
        if not self.count:
            raise self._error("", "must have a header of keys and at least one row")

    def sample(self, size: int) -> dict[str, Any]:
        """Return some rows as columns by key."""
        return next(self.chunks(repeat(size)))

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem in a row, counted from a row at which a chunk starts, with its line."""
        number, _ = next(islice(self._lines(len), start + row + 1, None))
        return Problem(str(self.path), f"line {number}", f"{problem.key}: {problem.message}")

    def chunks(self, sizes: Iterable[int]) -> Iterator[dict[str, Any]]:
        """Yield the rows as columns by key, in chunks of numbers of rows; notice at the end if the file has changed."""
        found = sha256()
        count = 0
        lines = self._lines(found.update)
        header = next(lines, None)
        if header is not None:
            keys = self._keys(*header)
            if self.digest and keys != self.keys:
                raise self._error("", "must not change during the sweep, found another header")
            for size in sizes:
                block = list(islice(lines, size))
                if not block:
                    break
                count += len(block)
                yield self._columns(block, keys)
        count += sum(1 for _ in lines)
        if self.digest and (self.digest, self.count) != (found.hexdigest(), count):
            raise self._error("", f"must not change during the sweep: it had {self.count:,} rows, and has {count:,}")
        self.digest = found.hexdigest()

    def _lines(self, update: Callable[[bytes], object]) -> Iterator[tuple[int, str]]:
        """Yield the lines that are not blank, with their numbers; give all bytes to a hash."""
        try:
            if exists(self.path) and not self.path.is_file():
                raise self._error("", "must be a file, since it is read several times")
            check_unreserved(self.path)
            with self.path.open("rb") as file:
                for number, line in enumerate(iter(lambda: file.readline(MAX_LINE_BYTES), b""), 1):
                    update(line)
                    text = self._decoded(number, line)
                    if text.strip():
                        yield number, text
        except OSError as error:
            raise self._error("", f"cannot be read: {reason(error)}") from None

    def _decoded(self, number: int, line: bytes) -> str:
        line = line.removesuffix(b"\n").removesuffix(b"\r")
        if len(line) >= MAX_LINE_BYTES:
            raise self._error(f"line {number}", f"must be shorter than {MAX_LINE_BYTES:,} bytes")
        try:
            text = line.decode("utf-8-sig" if number == 1 else "utf-8")
        except UnicodeDecodeError as error:
            message = f"must be UTF-8 text, found the byte {line[error.start]:#04x}"
            raise self._error(f"line {number}", message) from None
        if not text.isprintable() and (wrong := _CONTROL.search(text)):
            raise self._error(f"line {number}", f"must be text, found the character {ord(wrong[0]):#04x}")
        return text

    def _keys(self, number: int, line: str) -> tuple[str, ...]:
        keys = tuple(cell.strip() for cell in _cells(line))
        if message := other_separator(keys):
            raise self._error(f"line {number}", message)
        if "" in keys:
            raise self._error(f"line {number}", f"must name a key in each column, found none in {keys.index('') + 1}")
        if twice := [key for key in dict.fromkeys(keys) if keys.count(key) > 1]:
            raise self._error(f"line {number}: {twice[0]}", "must be the name of one column, found several")
        return keys

    def _columns(self, block: Sequence[tuple[int, str]], keys: Sequence[str]) -> dict[str, Any]:
        """Return the numbers and names in lines as columns by key, (n,)."""
        lines = [line for _, line in block]
        numeric = [i for i, key in enumerate(keys) if key not in NAMES.values()]
        try:
            names = {} if len(numeric) == len(keys) else _names(lines, keys)
            # Without names all columns are read, so that a line with more of them is noticed.
            read = partial(np.loadtxt, delimiter=",", quotechar='"', comments=None, ndmin=2)
            numbers = read(lines, usecols=numeric if names else None) if numeric else np.empty((len(lines), 0))
            if numbers.shape == (len(lines), len(numeric)) and np.isfinite(numbers).all():
                found = names | {keys[i]: column for i, column in zip(numeric, numbers.T, strict=True)}
                return {key: found[key] for key in keys}
        except ValueError:
            pass
        raise self._wrong_line(block, keys)

    def _wrong_line(self, block: Sequence[tuple[int, str]], keys: Sequence[str]) -> InputError:
        """Return the error of the first line that does not hold a number or a name for each key."""
        for number, line in block:
            cells = _cells(line)
            if len(cells) != len(keys):
                message = f"must have {len(keys)} cells as the header has, found {len(cells)}"
                return self._error(f"line {number}", message)
            for key, cell in zip(keys, cells, strict=True):
                if key in NAMES.values():
                    if not _is_name(cell):
                        return self._error(f"line {number}: {key}", f'must be a name, found "{cell[:40]}"')
                elif finite_number(cell) is None or "_" in cell or not cell.isascii():
                    known = [*NAMES.values(), *INPUTS, *self.others]
                    hint = "" if _is_key(key) or key in known else f"; unknown column{choices(key, known)}"
                    return self._error(f"line {number}: {key}", f'must be a number, found "{cell[:40]}"{hint}')
        return self._error(f"line {block[0][0]}", "must be a table of numbers from here")

    def _error(self, key: str, message: str) -> InputError:
        return InputError([Problem(str(self.path), key, message)])


def _cells(line: str) -> list[str]:
    """Return the cells of a line; a quote that is not closed ends with the line."""
    return next(csv.reader([line]))


def _is_key(name: str) -> bool:
    """Return whether a column is in a section of a scenario or of a role."""
    return name.split(".")[0] in {*Scenario.model_fields, *ROLES}


def _is_name(cell: str) -> bool:
    return 0 < len(cell.strip()) <= MAX_NAME


def _names(lines: Sequence[str], keys: Sequence[str]) -> dict[str, Any]:
    """Return the names in lines as columns by key, (n,); raise a ValueError if a line does not have them."""
    rows = [_cells(line) for line in lines]
    found = {key: [csv_value(row[i].strip()) for row in rows if len(row) == len(keys)] for i, key in enumerate(keys)}
    names = {key: cells for key, cells in found.items() if key in NAMES.values()}
    if not all(len(cells) == len(lines) and all(map(_is_name, cells)) for cells in names.values()):
        raise ValueError
    return {key: np.array(cells) for key, cells in names.items()}


def range_axis(key: str, low: float, high: float, step: float) -> Axis:
    """Return the axis of evenly spaced values; raise a ValueError if they are none, or too many."""
    # A range is one of thicknesses, which a value of another key may lie below.
    above_low = Range.model_validate({"min": 0.0, "max": high - low, "step": step}).values()
    values = tuple(round(low + value, 9) for value in above_low)
    return Axis(key, values, high if high - values[-1] > 1e-3 * step else None)


def omission(axis: Axis) -> str:
    """Return which end of a range is omitted."""
    return f"the last value is {axis.values[-1]:g}, since {axis.omitted:g} is no whole number of steps away"


def axis_of(text: str) -> Axis:
    """Parse an axis from ``KEY=MIN:MAX:STEP`` or ``KEY=VALUE,VALUE,...``."""
    key, _, values = text.rpartition("=")
    try:
        key = key_name(parts_of(key))
    except ValueError:
        message = f'must be KEY=MIN:MAX:STEP or KEY=VALUE,VALUE,..., found "{text}"'
        raise InputError([Problem("sweep", "over", message)]) from None
    if key in NAMES.values():
        message = f'must be a key of numbers, found "{values}"; names are given by --cases, in a column {key}'
        raise InputError([Problem("sweep", f"over {key}", message)])
    cells = values.split(":" if ":" in values else ",")
    numbers = [finite_number(cell) for cell in cells]
    found = tuple(number for number in numbers if number is not None)
    message = ""
    if "_" in values or not values.isascii() or len(found) < len(cells):
        wrong = next((cell for cell, number in zip(cells, numbers, strict=True) if number is None), values)
        message = f'must be a finite number at each place of MIN:MAX:STEP or VALUE,VALUE,..., found "{wrong}"'
    elif ":" in values and len(found) != 3:
        message = f'must be MIN:MAX:STEP, found {len(found)} numbers in "{values}"'
    elif ":" in values and found[1] < found[0]:
        message = f"must have a MAX of at least MIN in MIN:MAX:STEP, found {values}"
    elif ":" in values and found[2] <= 0.0:
        message = f"must have a STEP greater than 0 in MIN:MAX:STEP, found {values}"
    elif len(found) <= MAX_VALUES:
        try:
            return range_axis(key, *found) if ":" in values else Axis(key, found)
        except ValueError:
            pass
    message = message or f"must be at most {MAX_VALUES:,} numbers, found more in {values[:40]}"
    raise InputError([Problem("sweep", f"over {key}", message)])
