"""Read the rows of a sweep, from values of keys, which make a grid, or from a table of cases."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from itertools import islice
from math import prod
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from armour import csv_files
from armour.columns import Column, column_of
from armour.errors import Problem, counted, listed, mistake, refuse, restated
from armour.files import csv_value, shell_line
from armour.foreign import Rows
from armour.scenario.checked import is_name, is_number, several
from armour.scenario.inputs import INPUTS, NAMES, NAMING
from armour.scenario.keys import key_name, parts_of
from armour.scenario.schema import ThicknessSteps
from armour.scenario.sections import validated

# Greatest number of cases, which are read as a whole.
MAX_CASES = 1_000_000
# Rows of a grid are numbered by integers of 64 bits.
MAX_COMBINATIONS = 10**18
# Greatest length of the name of a projectile or material.
MAX_NAME = 200
# Keys whose columns may have other names and units.
CASE_KEYS = (*INPUTS, *NAMES.values())


@dataclass(frozen=True)
class Axis:
    """A key of the scenario and its values: numbers, or names of projectiles or materials."""

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
        """Hash of the keys and values of all axes, by which a resumed sweep recognises its rows."""
        return sha256(json.dumps([(axis.key, axis.values) for axis in self.axes]).encode()).hexdigest()

    def rows(self, places: NDArray[np.int64]) -> dict[str, Any]:
        """Return the combinations at the indices `places`, (n,), as columns by key, (n,) each."""
        indices = np.unravel_index(places, [len(axis.values) for axis in self.axes])
        return {axis.key: np.array(axis.values)[i] for axis, i in zip(self.axes, indices, strict=True)}

    def labels(self, _places: NDArray[np.int64]) -> dict[str, Any]:
        """Return no labels: only a table of cases has them."""
        return {}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem of row `start + row`, named by the key of an axis or, for other keys, by its values."""
        if problem.key in self.keys:
            return Problem("sweep", f"over {problem.key}", problem.message)
        row_values = {key: values[0].item() for key, values in self.rows(np.array([start + row])).items()}
        values = [f"{key}={value if isinstance(value, str) else f'{value:g}'}" for key, value in row_values.items()]
        return Problem("sweep", f"over {', '.join(values)}", f"{problem.key}: {problem.message}")


class SweepCases:
    """Rows of a table whose header names keys of the scenario: numbers, and names of projectiles and materials.

    Columns of the names in `keep` are labels, such as an offer or its price.  A file is read once.

    `count` is the number of rows, `keys` and `kept` are the names of the columns, `digest` is a hash of the values, and
    `read` says how the table was read, or is "" if that was obvious.
    """

    axes: tuple[Axis, ...] = ()  # none: only a grid has axes

    def __init__(self, table: str | PathLike[str] | Rows, sheet: str | None = None, keep: Sequence[str] = ()) -> None:
        source = csv_files.open_table(table, _is_key, sheet, own=True)
        self.file = source.file
        named = [(name, column_of(name, CASE_KEYS)._replace(known=True)) for name in source.header]
        columns = [
            Column(name, known=False) if name in keep else column if column.factor else Column(name)
            for name, column in named
        ]
        source.check_kept(keep)
        names = tuple(column.key for column in columns)
        self.kept = tuple(name for name in names if name in keep)
        self.keys = tuple(name for name in names if name not in keep)
        for index, key in enumerate(names):
            where = f"{source.place}: {key}" if key else source.place
            if not key:
                raise mistake(self.file, where, f"must name a key in each column, found none in {index + 1}")
            if names.index(key) < index:
                raise mistake(self.file, where, "must be the name of one column, found several")
        lines = [*islice(source.lines, MAX_CASES + 1)]
        self.count, self._places = len(lines), [place for place, _ in lines]
        if not lines:
            raise mistake(self.file, "", "must have a header of keys and at least one row")
        if self.count > MAX_CASES:
            raise mistake(self.file, "", f"must have at most {MAX_CASES:,} rows, found more")
        wrong = [(place, cells) for place, cells in lines if len(cells) != len(names)]
        refuse(Problem(self.file, place, csv_files.wrong_width(cells, names)) for place, cells in wrong)
        source.check_marks(self._places)
        texts_of = zip(columns, zip(*(cells for _, cells in lines), strict=True), strict=True)
        self._columns = {column.key: _read(column, self._places, texts, source) for column, texts in texts_of}
        source.refuse()
        content = sha256()
        for key, column in ((key, self._columns[key]) for key in self.keys):
            content.update(json.dumps([key, column.dtype.str, self.count]).encode())
            content.update(column.tobytes())
        self.digest = content.hexdigest()
        words, plain = source.told(counted(self.count, "row"), [f"{listed(self.kept)} kept unused"] * bool(self.kept))
        self.read = "" if plain else words

    def rows(self, places: NDArray[np.int64]) -> dict[str, Any]:
        """Return the rows at the indices `places`, (n,), as columns by key, (n,) each."""
        return {key: self._columns[key][places] for key in self.keys}

    def labels(self, places: NDArray[np.int64]) -> dict[str, Any]:
        """Return the labels of the rows at the indices `places`, (n,), as columns by name, (n,) each."""
        return {name: self._columns[name][places] for name in self.kept}

    def place(self, start: int, row: int, problem: Problem) -> Problem:
        """Return a problem of row `start + row`, named by the line of this row in the table."""
        return Problem(self.file, self._places[start + row], f"{problem.key}: {problem.message}")


def _read(column: Column, places: Sequence[str], cells: Sequence[str], source: csv_files.Source) -> NDArray[Any]:
    """Return the cells of a column as numbers or names, (rows,); record mistakes in the source.

    `places` names the row of each cell, such as "line 3".
    """
    key, values = column.key, list[Any]()
    if key in NAMING or not column.known:
        values = [*map(csv_value, cells)]
        for place, cell, name in zip(places, cells, values, strict=True):
            if len(name) > MAX_NAME or (column.known and not name):
                source.wrong(f"{place}: {key}", f'must be a name, found "{cell[:40]}"')
    elif key not in CASE_KEYS and any(cells) and not any(map(csv_files.is_number, cells)):
        found = f'must be a key of numbers, found "{next(filter(None, cells))[:40]}"'
        source.wrong(f"{source.place}: {key}", f"{found}; --keep {shell_line([key])} keeps it as a label, unused")
    else:
        values = source.numbers(key, column, places, cells, needed=True)
    return np.array(values)


def _is_key(name: str) -> bool:
    """Return whether a heading names an input, or has the form of a dotted key, such as "armour.ceramic"."""
    return column_of(name, CASE_KEYS).known or re.match(r"[a-z_]+\.[^\s\d]", name) is not None


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
    numbers = [value for cell in cells if (value := csv_files.number(cell)) is not None]
    if len(numbers) < len(cells) or (is_range and len(numbers) != 3):
        message = f'must be MIN:MAX:STEP or VALUE,VALUE,... of finite numbers, found "{values[:60]}"'
        raise mistake("sweep", f"over {key}", message)
    return axis(key, dict(zip(("min", "max", "step"), numbers, strict=True)) if is_range else numbers)


def source_of(
    over: Mapping[str, object] | None, cases: str | PathLike[str] | Rows | None = None, keep: Sequence[str] = ()
) -> Grid | SweepCases:
    """Return the rows of a sweep: a grid of the values by key in `over`, or a table of cases with labels `keep`."""
    if (over is None) == (cases is None):
        raise mistake("sweep", "over", "must be given, or cases, but not both")
    if cases is not None:
        return SweepCases(cases, keep=keep)
    if keep:
        raise mistake("sweep", "keep", "must be given with cases")
    if not isinstance(over, Mapping) or not over:
        raise mistake("sweep", "over", "must contain at least one key with its values, found none")
    return Grid(tuple(axis(key, values) for key, values in over.items()))


def axis(key: str, values: object) -> Axis:
    """Return the axis of a key; `values` are a sequence, or a mapping with min, max and step."""
    of_names = key in NAMING
    if isinstance(values, Mapping) and not of_names:
        with restated(lambda problem: Problem("sweep", f"over {key}", str(problem))):
            steps = validated(ThicknessSteps, dict(values), "")
        return Axis(key, steps.values(), steps.omission())
    must = f"must be a sequence of {'names' if of_names else 'finite numbers, or a range with min, max and step'}"
    try:
        listed = several(values, is_name if of_names else is_number, must)
    except ValueError as error:
        raise mistake("sweep", f"over {key}", str(error)) from None
    if not listed:
        raise mistake("sweep", f"over {key}", f"{must}, found none")
    return Axis(key, tuple(listed if of_names else map(float, listed)))
