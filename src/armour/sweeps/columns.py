"""Sweeps in Python: from values by key to columns, in memory or in a file."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from armour.analysis.evaluate import evaluate_groups, groups_of
from armour.analysis.progress import OnProgress, ignore_progress
from armour.analysis.quantities import reads_of
from armour.analysis.results import TableResult, same_columns
from armour.errors import InputError, Problem, choices
from armour.files import reason
from armour.scenario.checked import Names, checked
from armour.scenario.inputs import NAMES
from armour.scenario.keys import describe
from armour.scenario.scenario import Scenario
from armour.scenario.schema import MAX_VALUES
from armour.scenario.sections import NOT_TINY, Section, above, validated
from armour.scenario.words import ANY_VELOCITY
from armour.sweeps import sweep as in_chunks
from armour.sweeps.cases import Axis, Cases, Grid, range_axis
from armour.sweeps.tables import read_table

# Rows that are kept in memory; more go to a file.
MAX_ROWS = 10_000_000
# Characters of a wrong value in a message.
MAX_SHOWN = 60


class _Range(Section):
    """Evenly spaced values."""

    min: float
    max: Annotated[float, above("min", or_equal=True)]
    step: Annotated[float, Field(gt=0.0), NOT_TINY]


@dataclass(frozen=True, repr=False)
class SweepResult(TableResult):
    """Quantities of a scenario over rows of values.

    ``result["ballistic_limit_m_s"]`` is a column; iteration gives the names of the columns.

    Attributes
    ----------
    scenario : Scenario
    keys, quantities : tuple of str
        Names of the columns: keys whose values differ, and what is computed.
    rows : int
    output : Path or None
        File of the table; None where it is kept in memory.
    warnings : tuple of str
        Limits of what the model was compared with that rows lie outside of, quantities that are not all of the answer,
        and ends of ranges that are omitted.
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
        if self.output is None:
            return dict(self._computed)
        try:
            return read_table(self.output)
        except OSError as error:
            raise InputError([Problem(str(self.output), "", f"cannot be read: {reason(error)}")]) from None

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            message = f"must name a column, found {describe(name)}{choices(str(name), list(self.columns))}"
            raise InputError([Problem("sweep", "column", message)])
        column: NDArray[Any] = self.columns[name]
        return column

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __eq__(self, other: object) -> bool:
        """Return whether another sweep is of the same scenario and has the same columns."""
        if not isinstance(other, SweepResult) or self.scenario != other.scenario:
            return False
        return same_columns(self.columns, other.columns)

    def to_dict(self) -> dict[str, Any]:
        """Return the columns as lists by name; a question without an answer has None."""
        return {
            name: [None if value != value else value for value in values.tolist()]
            for name, values in self.columns.items()
        }

    def _words(self) -> str:
        where = "" if self.output is None else f", in {self.output}"
        return f"{', '.join(self.quantities)} over {' and '.join(self.keys)}, {self.rows:,} rows{where}"

    def _columns(self) -> Mapping[str, Any]:
        return self.columns


@checked
def sweep(
    scenario: Scenario,
    over: Mapping[str, object] | str | PathLike[str],
    quantities: Names = "ballistic_limit_m_s",
    output: str | PathLike[str] | None = None,
    *,
    threads: Annotated[int, Field(ge=1)] | None = None,
    on_progress: OnProgress = ignore_progress,
) -> SweepResult:
    """Compute quantities of a scenario over a grid of values, or over a table of cases.

    Parameters
    ----------
    scenario : Scenario
    over : mapping of str to values, or path-like
        Values by dotted key; every combination is computed, and the last key changes fastest.  Values are a sequence
        or an array of numbers, or a range, ``{"min": 4.0, "max": 12.0, "step": 0.5}``; for the projectile and the
        materials names.  A path is that of a CSV file whose header names keys, with a case on each line.
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
    >>> scenario = armour.load_scenario("wilkins")
    >>> found = armour.sweep(scenario, {"armour.ceramic_thickness_mm": [4.0, 6.0, 8.0, 10.0]})
    >>> found["ballistic_limit_m_s"].round(1)
    array([607.7, 711. , 778.2, 841.8])
    """
    names = tuple(quantities)
    if not names:
        raise InputError([Problem("sweep", "quantities", "must name at least one quantity, found none")])
    source = source_of(over)
    axes = source.axes if isinstance(source, Grid) else ()
    warnings = [f"{axis.key}: {axis.omission}" for axis in axes if axis.omission]
    computed: Mapping[str, Any] = {}
    if output is None:
        if source.count > MAX_ROWS:
            message = f"must be given for more than {MAX_ROWS:,} rows, found {source.count:,}"
            raise InputError([Problem("sweep", "output", message)])
        [columns] = source.chunks([source.count])
        in_chunks.check(scenario, source, names)
        warnings += in_chunks.unanswered(scenario, names)
        try:
            results, concerning = evaluate_groups(groups_of(scenario, columns), names, threads)
        except InputError:
            in_chunks.check_rows(scenario, source)  # says which row is wrong
            raise
        computed = {**columns, **results}
        warnings += in_chunks.lines_of(concerning, source.count)
        on_progress(source.count, source.count)
    else:
        output = Path(output).absolute()
        in_chunks.sweep(
            scenario,
            source,
            names,
            output,
            compute=in_chunks.in_process(threads),
            on_chunk=lambda rows, _stored: on_progress(rows, source.count),
            tell=lambda line: warnings.append(line.removeprefix("warning: ")),
        )
    found = SweepResult(scenario, source.keys, names, source.count, output, tuple(warnings), computed)
    return found._of(subject_of(scenario, source, names), scenario=scenario)


def source_of(over: Mapping[str, object] | str | PathLike[str]) -> Grid | Cases:
    """Return the rows to compute."""
    if not isinstance(over, Mapping):
        return Cases(Path(over))
    if not over:
        raise InputError([Problem("sweep", "over", "must hold at least one key with its values, found none")])
    return Grid(tuple(_axis(key, values) for key, values in over.items()))


def _axis(key: str, values: object) -> Axis:
    """Return a key with its values."""
    shown = describe(values) if isinstance(values, str) else repr(values)[:MAX_SHOWN]
    is_name = key in NAMES.values()
    must = f"be a sequence of {'names' if is_name else 'numbers, or a range with min, max and step'}"
    if isinstance(values, Mapping) and not is_name:
        section = validated(_Range, dict(values), f"sweep: over {key}")
        with suppress(ValueError):
            return range_axis(key, section.min, section.max, section.step)
        must = f"hold at most {MAX_VALUES:,} values"
    elif not isinstance(values, Mapping):
        found = np.asarray(values)
        if found.ndim == 1 and not found.size:
            must, shown = "hold at least one value", "none"
        elif found.ndim == 1 and found.dtype.kind in ("U" if is_name else "iuf"):
            if is_name:
                return Axis(key, tuple(found.tolist()))
            if np.isfinite(found).all():
                return Axis(key, tuple(found.astype(np.float64).tolist()))
            must = "be finite numbers"
    raise InputError([Problem("sweep", f"over {key}", f"must {must}, found {shown}")])


def subject_of(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str]) -> str:
    """Return the armours and rounds of a sweep, such as "AD85 on 6.35 mm 6061-T6 against 7.62 mm AP"."""
    axes = source.axes if isinstance(source, Grid) else ()
    varied = {**dict.fromkeys(source.keys, ()), **{axis.key: axis.values for axis in axes}}
    return scenario.subject(varied if "impact" in reads_of(quantities) else {**ANY_VELOCITY, **varied})
