"""Sweeps: quantities of a scenario for many rows of values, computed in chunks."""

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from itertools import repeat
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from armour.analysis.evaluate import check_keys, check_quantities, evaluate_groups, groups_of, scenarios_of
from armour.analysis.progress import ignore_progress
from armour.analysis.quantities import QUANTITIES
from armour.errors import InputError, Problem, refuse
from armour.scenario.scenario import Scenario
from armour.sweeps.cases import BLOCK, Cases, Grid, hash_of
from armour.sweeps.checkpoint import RESUME, Chunk, DamagedError, Store
from armour.sweeps.job import job_of
from armour.sweeps.plan import Pace, Plan, plan_of
from armour.sweeps.tables import encoded

# Times that the chunks are joined, with those computed anew that prove damaged, before the disk is to blame.
PASSES = 3

# Callback after each chunk: its number of rows, and whether it was on disk already.
OnChunk = Callable[[int, bool], None]


class Question(NamedTuple):
    """What a sweep computes for each of its rows."""

    scenario: Scenario
    quantities: Sequence[str]
    as_csv: bool


class Rows(NamedTuple):
    """Rows of a chunk."""

    start: int  # first of them
    values: dict[str, Any]  # by key, each (n,)


class Part(NamedTuple):
    """Part of a table, as it is written to the disk."""

    content: bytes
    warnings: Counter[str]  # with the number of rows that each concerns
    seconds: float  # that it took


class Compute(NamedTuple):
    """A way to compute chunks."""

    run: Callable[[Question, Iterator[Rows]], Iterator[tuple[int, Part]]]  # parts by first row, in any order
    threads: int | None  # for a chunk; None is one per core
    workers: int  # that compute chunks at the same time


def sweep(
    scenario: Scenario,
    source: Grid | Cases,
    quantities: Sequence[str],
    output: Path,
    *,
    compute: Compute | None = None,
    size: int | None = None,
    replace: bool = False,
    on_chunk: OnChunk = ignore_progress,
    approve: Callable[[Plan], None] = lambda _plan: None,
    tell: Callable[[str], None] = lambda _line: None,
) -> int:
    """Compute quantities of a scenario for every row of a source, write them to a table and return the number of rows.

    Each chunk is written when it is computed: the same call resumes an interrupted sweep.  A question without an answer
    gives an empty field in CSV and NaN in Parquet.  Without a size of chunks, a new sweep measures some rows;
    ``approve`` gets what all of them take and raises an error to stop.  ``tell`` gets a line for each chunk that is
    damaged on disk, and at the end one for each warning on some rows.
    ``replace`` allows the output to take the place of an older file.
    """
    check(scenario, source, quantities)
    for line in unanswered(scenario, quantities):
        tell(f"warning: {line}")
    compute = compute or in_process()
    with Store(output, job_of(scenario, source, quantities), replace=replace) as store:
        if store.finished is not None:
            return store.finished
        row_s = 0.0
        if size is None:
            try:
                plan = plan_of(scenario, source, quantities, output, threads=compute.threads, workers=compute.workers)
            except InputError:
                check_rows(scenario, source)  # says which row is wrong
                raise
            if not store.begun:
                approve(plan)
            row_s = plan.row_s
        check_rows(scenario, source)
        store.begin()
        pace = Pace(row_s, size)
        pending: dict[int, tuple[int, str, float]] = {}  # rows, hash of their values and time so far, by first row
        warnings: Counter[str] = Counter()
        first_pass = True
        question = Question(scenario, quantities, store.is_csv)

        def missing_chunks() -> Iterator[Rows]:
            start = 0
            found: Chunk | None = None
            starts = store.starts()

            def sizes() -> Iterator[int]:
                nonlocal found
                while start < source.count:
                    try:
                        found = store.chunk(start)
                    except DamagedError as error:
                        found = None
                        tell(f"{error}: damaged, computed anew")
                    after = bisect_right(starts, start)
                    end = starts[after] if after < len(starts) else source.count
                    yield found.rows if found else min(pace.rows, end - start)

            began = perf_counter()
            for values in source.chunks(sizes()):
                rows = len(values[source.keys[0]])
                first, start = start, start + rows
                source_hash = hash_of(values)
                if found and found.source == source_hash:
                    if first_pass:
                        warnings.update(found.warnings)
                        on_chunk(rows, True)
                else:
                    if found:
                        tell(f"{store.path(first)}: of other values, computed anew")
                    pending[first] = rows, source_hash, perf_counter() - began
                    yield Rows(first, values)
                began = perf_counter()

        try:
            for _ in range(PASSES):
                for start, part in compute.run(question, missing_chunks()):
                    rows, source_hash, seconds = pending.pop(start)
                    began = perf_counter()
                    store.save(start, rows, source_hash, part.content, part.warnings)
                    pace.note(rows, seconds + part.seconds + perf_counter() - began)
                    if first_pass:
                        warnings.update(part.warnings)
                        on_chunk(rows, False)
                with suppress(DamagedError):
                    rows = store.finish(source.count)
                    for line in lines_of(warnings, rows):
                        tell(f"warning: {line}")
                    return rows
                first_pass = False
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"{store.rows():,} of {source.count:,} rows are done; {RESUME}") from None
    message = f"are damaged each time that they are written; check the disk, then {RESUME}"
    raise InputError([Problem(f"chunks of {output}", "", message)])


def check(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str]) -> None:
    """Check the question, and that every key counts."""
    problems: list[Problem] = []
    try:
        check_quantities(scenario, quantities, "sweep", "quantities")
    except InputError as error:
        problems += error.problems
    if len(set(source.keys)) != len(source.keys):
        problems.append(Problem("sweep", "over", "must not name a key twice"))
    refuse(problems)
    first = next(source.chunks(repeat(1)))
    check_keys(scenario, {key: values[0].item() for key, values in first.items()}, quantities, "sweep")


def unanswered(scenario: Scenario, quantities: Sequence[str]) -> list[str]:
    """Return a warning where a quantity needs the error of the model, which the scenario excludes."""
    needing = [
        name for name in quantities if "uncertainty.model" in QUANTITIES[name].reads and scenario.excludes_error()
    ]
    return [f"{name}: has no value where uncertainty.model.included is false" for name in needing]


def check_rows(scenario: Scenario, source: Grid | Cases) -> None:
    """Check all rows before the first chunk is computed."""
    start = 0
    for chunk in source.chunks(repeat(BLOCK)):
        for where, _ in scenarios_of(scenario, chunk, partial(source.place, start)):
            start += len(where)


def computed(question: Question, rows: Rows, threads: int | None) -> Part:
    """Compute a part of a table."""
    began = perf_counter()
    scenario, quantities, as_csv = question
    groups = groups_of(scenario, rows.values)
    results, warnings = evaluate_groups(groups, quantities, threads)
    content = encoded({**rows.values, **results}, as_csv=as_csv, header=rows.start == 0)
    return Part(content, warnings, perf_counter() - began)


def lines_of(warnings: Counter[str], rows: int) -> list[str]:
    """Return warnings on some of the rows of a table as lines."""
    return [f"{words}; this concerns {number:,} of {rows:,} rows" for words, number in sorted(warnings.items())]


def in_process(threads: int | None = None) -> Compute:
    """Compute chunks in this process, one after the other, each on all threads."""

    def run(question: Question, chunks: Iterator[Rows]) -> Iterator[tuple[int, Part]]:
        for rows in chunks:
            yield rows.start, computed(question, rows, threads)

    return Compute(run, threads, workers=1)
