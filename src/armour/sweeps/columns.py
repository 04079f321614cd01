"""Sweeps in Python: from values by key to columns, in memory or in a file."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from armour.analysis.evaluate import evaluate, groups_of
from armour.analysis.quantities import reads_of
from armour.analysis.results import TableResult
from armour.analysis.variants import Floats, OnProgress, ignore_progress, outside_limits
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.scenario.messages import describe, validated
from armour.scenario.schema import Range
from armour.sweeps import sweep as in_chunks
from armour.sweeps.cases import Axis, Cases, Grid
from armour.sweeps.tables import read_table

# Rows that are kept in memory; more go to a file.
MAX_ROWS = 10_000_000
# Characters of a wrong value in a message.
MAX_SHOWN = 60

# Values of a key: numbers, or a range with min, max and step.
Values = Sequence[float] | Floats | Mapping[str, float]


@dataclass(frozen=True, repr=False)
class SweepResult(TableResult):
    """Quantities of a scenario over rows of values.

    ``result["ballistic_limit_m_s"]`` is a column.

    Attributes
    ----------
    scenario : Scenario
    keys, quantities : tuple of str
        Names of the columns: keys whose values differ, and what is computed.
    rows : int
    output : Path or None
        File of the table; None where it is kept in memory.
    warnings : tuple of str
        Limits of what the model was compared with that rows lie outside of.
    columns : dict of str to array
        Column by name, read from the file when it is first used.  A question without an answer gives NaN.
    """

    scenario: Scenario
    keys: tuple[str, ...]
    quantities: tuple[str, ...]
    rows: int
    output: Path | None
    warnings: tuple[str, ...]
    _computed: Mapping[str, Any]

    @cached_property
    def columns(self) -> dict[str, Any]:
        """Columns by name."""
        return dict(self._computed) if self.output is None else read_table(self.output)

    def __getitem__(self, name: str) -> Any:
        return self.columns[name]

    def to_dict(self) -> dict[str, Any]:
        """Return the columns as lists by name."""
        return {name: values.tolist() for name, values in self.columns.items()}

    def _words(self) -> str:
        where = "" if self.output is None else f", in {self.output}"
        return f"{', '.join(self.quantities)} over {' and '.join(self.keys)}, {self.rows:,} rows{where}"

    def _columns(self) -> Mapping[str, Any]:
        return self.columns


def sweep(
    scenario: Scenario,
    over: Mapping[str, Values] | str | PathLike[str],
    quantities: str | Sequence[str] = "ballistic_limit_m_s",
    output: str | PathLike[str] | None = None,
    *,
    threads: int | None = None,
    on_progress: OnProgress = ignore_progress,
) -> SweepResult:
    """Compute quantities of a scenario over a grid of values, or over a table of cases.

    Parameters
    ----------
    scenario : Scenario
    over : mapping of str to values, or path-like
        Values by dotted key; every combination is computed, and the last key changes fastest.  Values are a sequence
        or an array of numbers, or a range, ``{"min": 4.0, "max": 12.0, "step": 0.5}``.  A path is that of a CSV file
        whose header names keys, with a case on each line.
    quantities : str or sequence of str, default "ballistic_limit_m_s"
        Names of quantities; ``armour sweep --help`` lists them.
    output : path-like, optional
        Table to write, .csv or .parquet.  Rows are computed in chunks, and the same call resumes an interrupted sweep.
        Without it the columns are kept in memory, for at most ten million rows.
    threads : int, optional
        By default one per core.
    on_progress : callable, optional
        Called with the number of rows computed since the last call, and the number of all.

    Returns
    -------
    SweepResult

    Raises
    ------
    InputError
        If a key or a quantity is unknown or has no effect, a row is not a valid scenario, the file exists already or
        cannot be written, or a run does not end.

    Examples
    --------
    >>> import armour
    >>> scenario = armour.load_scenario("scenarios/wilkins.toml")
    >>> found = armour.sweep(scenario, {"armour.ceramic_thickness_mm": [4.0, 6.0, 8.0, 10.0]})
    >>> found["ballistic_limit_m_s"].round(1)
    array([607.7, 711. , 778.2, 841.8])
    """
    names = (quantities,) if isinstance(quantities, str) else tuple(quantities)
    if not names:
        raise InputError([Problem("sweep", "quantities", "must name at least one quantity, found none")])
    source = _source(over)
    warnings: list[str] = []
    computed: Mapping[str, Any] = {}
    if output is None:
        if source.count > MAX_ROWS:
            message = f"must be given for more than {MAX_ROWS:,} rows, found {source.count:,}"
            raise InputError([Problem("sweep", "output", message)])
        [columns] = source.chunks(source.count)
        computed = {**columns, **evaluate(scenario, columns, names, threads)}
        warnings += _outside(scenario, columns, names)
        on_progress(source.count, source.count)
    else:
        output = Path(output)
        in_chunks.sweep(
            scenario,
            source,
            names,
            output,
            compute=in_chunks.in_process(threads),
            on_chunk=lambda rows, _stored: on_progress(rows, source.count),
            tell=lambda line: warnings.append(line.removeprefix("warning: ")),
        )
    return SweepResult(scenario, source.keys, names, source.count, output, tuple(warnings), computed)


def _source(over: Mapping[str, Values] | str | PathLike[str]) -> Grid | Cases:
    """Return the rows to compute."""
    if not isinstance(over, Mapping):
        return Cases(Path(over))
    if not over:
        raise InputError([Problem("sweep", "over", "must hold at least one key with its values, found none")])
    return Grid(tuple(Axis(key, _numbers(key, values)) for key, values in over.items()))


def _numbers(key: str, values: Values) -> tuple[float, ...]:
    """Return the values of a key."""
    if isinstance(values, Mapping):
        return validated(Range, dict(values), f"sweep: {key}").values()
    found = np.asarray(values)
    if found.ndim != 1 or not found.size or found.dtype.kind not in "iuf" or not np.isfinite(found).all():
        shown = describe(values) if isinstance(values, str) else repr(values)[:MAX_SHOWN]
        message = f"must be numbers, or a range with min, max and step, found {shown}"
        raise InputError([Problem("sweep", key, message)])
    numbers: list[float] = found.astype(np.float64).tolist()
    return tuple(numbers)


def _outside(scenario: Scenario, columns: Mapping[str, Floats], quantities: Sequence[str]) -> list[str]:
    """Return the limits of what the model was compared with that rows lie outside of."""
    outside: Counter[str] = Counter()
    for group in groups_of(scenario, columns):
        outside.update(dict(outside_limits(group.variants, velocities="impact" in reads_of(quantities))))
    return [f"{limit}; {number:,} rows lie outside" for limit, number in outside.items()]
