"""Compute quantities of a scenario for many rows of values; keep them in memory or write them as a table."""

from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from functools import cache, cached_property, partial
from hashlib import sha256
from itertools import islice
from os import PathLike
from pathlib import Path
from secrets import token_hex
from time import perf_counter
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

import armour
from armour.analysis.evaluate import check_keys, check_quantities, scenarios_of
from armour.analysis.quantities import OF_WEIGHT, QUANTITIES, VERDICT, reads_of
from armour.analysis.results import OnProgress, TableResult, ignore_progress, made_by, same_columns
from armour.design.check import evaluated
from armour.design.requirements import VERDICTS
from armour.engine.changes import changed_names
from armour.errors import InputError, Note, Problem, choices, counted, duration, mistake, refuse
from armour.evidence.core_digest import changed_equations
from armour.files import finite, reason, shipped
from armour.scenario.checked import Names, Table, checked
from armour.scenario.keys import describe
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.sweeps.cases import Grid, SweepCases, source_of
from armour.sweeps.store import RESUME, Chunk, Store
from armour.sweeps.tables import read_table

# Number of rows to check at a time.
CHECKED_ROWS = 10_000
# Greatest number of rows in memory; more rows need a file.
MAX_ROWS = 10_000_000
# Target time to compute a chunk, short so that an interruption costs little, and greatest number of rows of a chunk.
CHUNK_S = 1.0
MAX_CHUNK = 100_000
# Rows are timed in samples of growing size until one takes this time; the first does not count, as it also reads data.
SAMPLE_S = 0.1
SAMPLES = (4, 4, 32, 256, 2048)
# A sweep that takes longer or has more rows needs approval.
LONG_S = 3600.0
MANY_ROWS = 10**8

# Words of a column, by quantity.
WORDS_OF: dict[str, Sequence[str]] = {"outcome": ("perforated", "stopped"), VERDICT: VERDICTS}

CODE_FOLDER = Path(__file__).resolve().parent.parent

# Columns of values by key, (rows,) each.
Rows = Mapping[str, Any]
# Called with the number of rows that are done, and whether these were on disk already.
OnChunk = Callable[[int, bool], None]


class Effort(NamedTuple):
    """Computing time of a sweep."""

    row_s: float  # time per row on one worker
    seconds: float  # of the whole sweep
    words: str  # number of rows and time
    is_large: bool  # whether the sweep needs approval


class Workers(NamedTuple):
    """Functions that compute chunks at the same time, such as on a cluster."""

    submit: Callable[[Callable[[Rows], Chunk], Rows], Any]  # starts to compute a chunk; returns a future
    result: Callable[[Any], Chunk]  # waits for the chunk of a future
    number: int  # of chunks that are computed at the same time
    ahead: int  # greatest number of chunks submitted and not yet returned


@dataclass(frozen=True, repr=False)
class SweepResult(TableResult):
    """Quantities of a scenario over rows of values.

    ``result["ballistic_limit_m_s"]`` is a column.

    Attributes
    ----------
    scenario : Scenario
    keys, quantities : tuple of str
        Names of the columns: keys whose values vary, and computed quantities.
    rows : int
    output : Path or None
        File of the table; None if it is kept in memory.
    notes : tuple of Note
        Rows unlike what the model was compared with, quantities without a value, unused threats, and omitted ends
        of ranges.
    columns : dict of str to array
        Columns by name, read from the file when they are first used.  A quantity without a value is NaN.
    """

    scenario: Scenario
    keys: tuple[str, ...]
    quantities: tuple[str, ...]
    rows: int
    output: Path | None
    notes: tuple[Note, ...]
    _computed: Mapping[str, Any]

    @cached_property
    def columns(self) -> dict[str, Any]:
        """Columns by name."""
        if self.output is None:
            return dict(self._computed)
        try:
            return read_table(self.output)
        except OSError as error:
            raise mistake(self.output, "", f"cannot be read: {reason(error)}") from None

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            message = f"must name a column, found {describe(name)}{choices(str(name), list(self.columns))}"
            raise mistake("sweep", "column", message)
        return self.columns[name]

    def __eq__(self, other: object) -> bool:
        """Return whether another result is of the same scenario and has the same columns."""
        if not isinstance(other, SweepResult) or self.scenario != other.scenario:
            return False
        return same_columns(self.columns, other.columns)

    def to_dict(self) -> dict[str, Any]:
        """Return the columns as lists by name; a quantity without a value is None."""
        return {name: finite(values.tolist()) for name, values in self.columns.items()}

    def _columns(self) -> Mapping[str, Any]:
        return self.columns


@checked
def sweep(
    scenario: Scenario,
    over: Mapping[str, object] | None = None,
    quantities: Names = "ballistic_limit_m_s",
    output: str | PathLike[str] | None = None,
    *,
    cases: Table | None = None,
    keep: Names = (),
    threads: Annotated[int, Field(ge=1)] | None = None,
    on_progress: OnProgress = ignore_progress,
) -> SweepResult:
    """Compute quantities of a scenario over a grid of values, or over a table of cases.

    Parameters
    ----------
    scenario : Scenario
    over : mapping of str to values, optional
        Values by dotted key; every combination is computed, and the last key changes fastest.  Values are a sequence
        or an array of numbers, or a range, ``{"min": 4.0, "max": 12.0, "step": 0.5}``; for the projectile and the
        materials, names.
    quantities : str or sequence of str, default "ballistic_limit_m_s"
        Names of quantities; ``armour sweep --help`` lists them.
    output : path-like, optional
        Table to write, .csv or .parquet.  Rows are computed in chunks, and the same call resumes an interrupted sweep.
        Without it the columns are kept in memory, for at most ten million rows.
    cases : path-like, data frame, mapping of columns or sequence of mappings, optional
        In place of ``over``, a table with a case in each row, whose columns are keys: a CSV file, a data frame, or
        columns by key.
    keep : str or sequence of str, optional
        Columns of the cases that are no keys, such as the name or the price of an offer; they are kept as texts.
    threads : int, optional
        Number of threads, by default one per core.
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
    >>> thicknesses = {"armour.ceramic_thickness_mm": [4.0, 6.0, 8.0, 10.0]}
    >>> armour.sweep(scenario, thicknesses)["ballistic_limit_m_s"].round(1)
    array([607.7, 711. , 778.2, 841.8])
    """
    names = tuple(quantities)
    if not names:
        raise mistake("sweep", "quantities", "must name at least one quantity, found none")
    source = source_of(over, cases, (*keep,))
    if output is None:
        result = sweep_in_memory(scenario, source, names, threads, MAX_ROWS)
        on_progress(source.count, source.count)
        return result
    output, warnings = Path(output).absolute(), list[str]()
    write_sweep(
        scenario,
        source,
        names,
        output,
        threads=threads,
        on_chunk=lambda rows, _stored: on_progress(rows, source.count),
        tell=lambda line: warnings.append(line.removeprefix("warning: ")),
    )
    return result_of(scenario, source, names, warnings, output=output)


def sweep_in_memory(
    scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str], threads: int | None, most: int
) -> SweepResult:
    """Return quantities of a scenario for every row of a source, as `sweep` without a file; refuse over `most` rows."""
    if source.count > most:
        raise mistake("sweep", "output", f"must be given for more than {most:,} rows, found {source.count:,}")
    check(scenario, source, quantities)
    check_rows(scenario, source)
    columns, row_counts = chunk_of(scenario, source.rows(places := np.arange(source.count)), quantities, threads)
    warnings = [*general_warnings(scenario, source, quantities), *row_warnings(row_counts, source.count)]
    return result_of(scenario, source, quantities, warnings, {**source.labels(places), **columns})


def result_of(
    scenario: Scenario,
    source: Grid | SweepCases,
    quantities: Sequence[str],
    warnings: Sequence[str],
    columns: Mapping[str, Any] = {},
    output: Path | None = None,
) -> SweepResult:
    """Return the result of a sweep, whose columns, by name, are in memory or in the file `output`."""
    notes = tuple(map(Note, warnings))
    result = SweepResult(scenario, source.keys, tuple(quantities), source.count, output, notes, columns)
    return result.of(subject_of(scenario, source, quantities), scenario=scenario, changed=changed_equations())


def write_sweep(
    scenario: Scenario,
    source: Grid | SweepCases,
    quantities: Sequence[str],
    output: Path,
    *,
    workers: Workers | None = None,
    threads: int | None = None,
    size: int | None = None,
    replace: bool = False,
    command: str = "",
    on_chunk: OnChunk = ignore_progress,
    approve: Callable[[Effort], None] = lambda _effort: None,
    tell: Callable[[str], None] = lambda _line: None,
) -> int:
    """Compute quantities of a scenario for every row of a source, write them to a table and return the number of rows.

    Rows are kept on disk chunk by chunk, so that the same call resumes an interrupted sweep.  A quantity without a
    value is an empty field in CSV and NaN in Parquet.  Chunks are computed by ``workers``, each on one thread, or else
    in this process on ``threads``.  ``size`` is the number of rows of a chunk.  Without it, the time of some rows is
    measured to choose it; ``approve`` is then called with the effort of a new sweep, and may raise an error to stop it.
    ``tell`` is called with each warning, and if kept rows are used.  With ``replace``, the output replaces
    an older file; a Parquet file records the ``command`` that made it.
    """
    check(scenario, source, quantities)
    for line in general_warnings(scenario, source, quantities):
        tell(f"warning: {line}")
    threads = threads if workers is None else 1
    compute = partial(chunk_of, scenario, quantities=quantities, threads=threads)
    job, fits = job_of(scenario, source, quantities), partial(is_part_of, source)
    with Store(output, job, types_of(source, quantities), replace=replace, fits=fits) as store:
        if size is None:
            try:
                effort = effort_of(scenario, source, quantities, threads, workers)
            except InputError:
                check_rows(scenario, source)  # names the row
                raise
            if not store.done:
                approve(effort)
            size = int(min(max(CHUNK_S / effort.row_s, 1.0), MAX_CHUNK))
        if store.done:
            tell(f"resuming {store.folder}: {store.done:,} of {source.count:,} rows")
        else:
            check_rows(scenario, source)
        drawn = np.array([*store.drawn], dtype=np.int64)
        drawn_blocks = (source.rows(drawn[start : start + size]) for start in range(0, len(drawn), size))
        blocks = (rows for _, rows in blocks_of(source, size, store.done))
        try:
            with ThreadPoolExecutor(1) as executor:
                workers = workers or Workers(executor.submit, Future.result, 1, ahead=2)
                with closing(computed(drawn_blocks, compute, workers)) as chunks:
                    store.check_drawn(chunks)
                if store.done:
                    on_chunk(store.done, True)
                with closing(computed(blocks, compute, workers)) as chunks:
                    for chunk in chunks:
                        store.append(chunk)
                        on_chunk(chunk.rows, False)
            store.finish(made_by(scenario, command), source.labels)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"{store.done:,} of {source.count:,} rows are done; {RESUME}") from None
    for line in row_warnings(store.warnings, source.count):
        tell(f"warning: {line}")
    return source.count


def blocks_of(source: Grid | SweepCases, size: int, start: int = 0) -> Iterator[tuple[int, Rows]]:
    """Yield blocks of `size` rows from the row `start` on: the index of the first row, and the columns by key."""
    for first in range(start, source.count, size):
        yield first, source.rows(np.arange(first, min(first + size, source.count)))


def chunk_of(scenario: Scenario, rows: Rows, quantities: Sequence[str], threads: int | None) -> Chunk:
    """Return the chunk of some rows: their columns of values by key, the quantities computed, and warnings."""
    results, warnings = evaluated(scenario, rows, quantities, threads)
    words = {name: results[name].astype(np.array(WORDS_OF[name]).dtype) for name in WORDS_OF.keys() & {*quantities}}
    return Chunk({**rows, **results, **words}, warnings)


def types_of(source: Grid | SweepCases, quantities: Sequence[str]) -> dict[str, Any]:
    """Return the types of the columns in numpy, by name: of the keys of a source, and of quantities."""
    types = {key: values.dtype for key, values in source.rows(np.arange(1)).items()}
    return types | {name: np.array(WORDS_OF.get(name, 0.0)).dtype for name in quantities}


def is_part_of(source: Grid | SweepCases, start: int, chunk: Chunk) -> bool:
    """Return whether a stored chunk has the rows of a source from `start` on, and only words of their quantities."""
    if chunk.rows > MAX_CHUNK or start + chunk.rows > source.count:
        return False
    rows = source.rows(np.arange(start, start + chunk.rows))
    is_same = all(np.array_equal(values, chunk.columns[key]) for key, values in rows.items())
    return is_same and all(np.isin(chunk.columns.get(name, ()), words).all() for name, words in WORDS_OF.items())


def computed(blocks: Iterator[Rows], compute: Callable[[Rows], Chunk], workers: Workers) -> Generator[Chunk]:
    """Yield the chunk that `compute` makes of each block of rows, in order, while workers compute the next ones."""
    running = deque[Any]()
    try:
        while True:
            for rows in islice(blocks, workers.ahead - len(running)):
                running.append(workers.submit(compute, rows))
            if not running:
                return
            yield workers.result(running[0])
            running.popleft()
    finally:
        for future in running:
            future.cancel()


def check(scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str]) -> None:
    """Check the names of the quantities, and that every key of the rows has an effect on one of them."""
    check_quantities(scenario, quantities, "sweep")
    if len(set(source.keys)) != len(source.keys):
        raise mistake("sweep", "over", "must not name a key twice")
    first_row = {key: values[0].item() for key, values in source.rows(np.arange(1)).items()}
    check_keys(scenario, first_row, quantities, "sweep")
    refuse(
        Problem("sweep", "keep", f"must not name a quantity to compute, found {name}")
        for name in source.labels(np.arange(1))
        if name in quantities
    )


def general_warnings(scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str]) -> list[str]:
    """Return warnings of omitted ends of ranges, of unused threats, and of quantities without the model error."""
    of_impact = [name for name in quantities if name != VERDICT]
    empty = [name for name in of_impact if scenario.excludes_error() and "uncertainty.model" in QUANTITIES[name].reads]
    return [
        *(f"{axis.key}: {axis.omission}" for axis in source.axes if axis.omission),
        *(map(str, scenario.unused_threats()) if {*reads_of(of_impact)} - {*OF_WEIGHT} else ()),
        *(f"{name}: has no value if uncertainty.model.included is false" for name in empty),
    ]


def check_rows(scenario: Scenario, source: Grid | SweepCases) -> None:
    """Raise an error that names the rows that are no valid scenarios, if there are any."""
    for start, rows in blocks_of(source, CHECKED_ROWS):
        for _ in scenarios_of(scenario, rows, partial(source.place, start)):
            pass


def row_warnings(warnings: Mapping[str, int], rows: int) -> list[str]:
    """Return each warning in words with the number of rows that it concerns, of all `rows` of the table."""
    return [f"{words}; this concerns {number:,} of {rows:,} rows" for words, number in sorted(warnings.items())]


def effort_of(
    scenario: Scenario,
    source: Grid | SweepCases,
    quantities: Sequence[str],
    threads: int | None = None,
    workers: Workers | None = None,
) -> Effort:
    """Estimate the effort of a sweep from the measured time of rows spread over it."""
    row_s = 0.0
    for sample, number in enumerate(SAMPLES):
        count = min(number, source.count)
        rows = source.rows(np.linspace(0, source.count - 1, count).astype(np.int64))
        begun = perf_counter()
        chunk_of(scenario, rows, quantities, threads)
        row_s = (perf_counter() - begun) / count
        if sample and (count < number or row_s * count > SAMPLE_S):
            break
    seconds = row_s * source.count / (workers.number if workers else 1)
    words = f"{counted(source.count, 'row')} take{'s' * (source.count == 1)} about {duration(seconds)}"
    return Effort(row_s, seconds, words, is_large=seconds > LONG_S or source.count > MANY_ROWS)


def program() -> str:
    """Return the hash of this program, or a random hash while equations are changed."""
    return token_hex(32) if changed_names() else _program()


@cache
def _program() -> str:
    """Return a hash of this program, of its data, and of the version of numpy, which computes."""
    content = sha256(np.__version__.encode())
    for path in [*sorted(CODE_FOLDER.rglob("*.py")), *sorted(shipped("configs").glob("*.toml"))]:
        content.update(sha256(path.name.encode() + b"\n" + path.read_bytes()).digest())
    return content.hexdigest()


def job_of(scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str]) -> dict[str, str]:
    """Return what identifies a sweep that is resumed: all that its rows depend on, in part as hashes, by name."""
    return {
        "version": armour.__version__,
        "program": program(),
        "scenario": scenario.digest(whole_library=True),  # rows may name other entries
        "quantities": ",".join(quantities),
        "rows": source.digest,
    }


def subject_of(scenario: Scenario, source: Grid | SweepCases, quantities: Sequence[str]) -> str:
    """Return the armour and the threat of a sweep, such as "AD85 on 6.35 mm 6061-T6 against 7.62 mm AP"."""
    varied = {**dict.fromkeys(source.keys, ()), **{axis.key: axis.values for axis in source.axes}}
    return scenario.subject(varied if "impact" in reads_of(quantities) else {**ANY_VELOCITY, **varied})
