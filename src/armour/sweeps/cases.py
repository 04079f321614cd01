"""Rows of a sweep: grids of values and tables of cases."""

from collections.abc import Iterator
from csv import reader
from dataclasses import dataclass
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from armour.analysis.variants import Floats
from armour.errors import InputError, Problem
from armour.files import reason
from armour.scenario.assignments import parts_of
from armour.scenario.messages import key_name
from armour.scenario.schema import MAX_VALUES, Range
from armour.statistics.csv_table import finite_number


@dataclass(frozen=True)
class Axis:
    """A key and its values."""

    key: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Grid:
    """Every combination of the values of several axes; the last axis changes fastest."""

    axes: tuple[Axis, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the axes."""
        return tuple(axis.key for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of combinations."""
        return prod(len(axis.values) for axis in self.axes)

    def chunks(self, size: int) -> Iterator[dict[str, Floats]]:
        """Yield the combinations as columns by key, ``size`` rows at a time."""
        shape = [len(axis.values) for axis in self.axes]
        values = [np.array(axis.values) for axis in self.axes]
        for start in range(0, self.count, size):
            indices = np.unravel_index(np.arange(start, min(start + size, self.count)), shape)
            yield {axis.key: v[i] for axis, v, i in zip(self.axes, values, indices, strict=True)}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem in a row, counted from a row at which a chunk starts, with the options that make it."""
        if problem.key in self.keys:
            return Problem("command line", f"--over {problem.key}", problem.message)
        indices = np.unravel_index(start + row, [len(axis.values) for axis in self.axes])
        values = (f"{axis.key}={axis.values[i]:g}" for axis, i in zip(self.axes, indices, strict=True))
        return Problem("command line", f"--over {', '.join(values)}", f"{problem.key}: {problem.message}")


class Cases:
    """Rows of a CSV file of numbers whose header names keys of the scenario."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.count = 0
        for batch in self._batches():
            self.keys = tuple(batch.schema.names)
            self.count += batch.num_rows
        if not self.count:
            raise InputError([Problem(str(path), "", "must have a header of keys and at least one row of numbers")])

    def chunks(self, size: int) -> Iterator[dict[str, Floats]]:
        """Yield the rows as columns by key, ``size`` rows at a time."""
        kept: dict[str, Floats] = {}
        for batch in self._batches():
            columns = {name: batch.column(name).to_numpy(zero_copy_only=False) for name in self.keys}
            kept = {key: np.concatenate([kept[key], column]) if kept else column for key, column in columns.items()}
            while len(kept[self.keys[0]]) >= size:
                yield {key: column[:size] for key, column in kept.items()}
                kept = {key: column[size:] for key, column in kept.items()}
        if len(kept[self.keys[0]]):
            yield kept

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem in a row, counted from a row at which a chunk starts, with its line."""
        with self.path.open(newline="", encoding="utf-8-sig") as file:
            lines = reader(file)
            next(islice(filter(None, lines), start + row + 1, None))
            return Problem(str(self.path), f"line {lines.line_num}", f"{problem.key}: {problem.message}")

    def _batches(self) -> Iterator[Any]:
        """Yield record batches of the file with numeric columns."""
        try:
            with csv.open_csv(self.path) as first:
                types = {name: pa.float64() for name in first.schema.names}
            options = csv.ConvertOptions(column_types=types, strings_can_be_null=False)
            with csv.open_csv(self.path, convert_options=options) as batches:
                for batch in batches:
                    for name in batch.schema.names:
                        if batch.column(name).null_count:
                            raise pa.ArrowInvalid(f"column {name} has empty values")
                    yield batch
        except pa.ArrowInvalid as error:
            message = f"must be a table of numbers below a header of keys: {error}"
            raise InputError([_wrong_cell(self.path) or Problem(str(self.path), "", message)]) from None
        except OSError as error:
            raise InputError([Problem(str(self.path), "", f"cannot be read: {reason(error)}")]) from None


def _wrong_cell(path: Path) -> Problem | None:
    """Return the first cell of a file that is not a number; pyarrow does not say where it is."""
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        lines = reader(file)
        header = next(lines, [])
        for cells in filter(None, lines):
            for name, cell in zip(header, cells, strict=False):
                if finite_number(cell) is None:
                    key = f"line {lines.line_num}: {name}"
                    return Problem(str(path), key, f'must be a number, found "{cell[:40]}"')
    return None


def axis_of(text: str) -> Axis:
    """Parse an axis from ``KEY=MIN:MAX:STEP`` or ``KEY=VALUE,VALUE,...``."""
    key, _, values = text.rpartition("=")
    try:
        key = key_name(parts_of(key))
        if ":" in values:
            low, high, step = (float(part) for part in values.split(":"))
            found = Range.model_validate({"min": low, "max": high, "step": step}).values()
        else:
            found = tuple(float(part) for part in values.split(","))
        if len(found) <= MAX_VALUES:
            return Axis(key, found)
    except ValueError:
        pass
    message = f'must be KEY=MIN:MAX:STEP or KEY=VALUE,VALUE,... of at most {MAX_VALUES} numbers, found "{text}"'
    raise InputError([Problem("sweep", "--over", message)])
