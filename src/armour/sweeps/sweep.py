"""Sweeps: quantities of a scenario for many rows of values, computed in chunks."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from armour.analysis.evaluate import Group, check_keys, check_quantities, evaluate_groups, groups_of, scenarios_of
from armour.analysis.progress import ignore_progress
from armour.analysis.quantities import reads_of
from armour.analysis.variants import Floats, outside_limits
from armour.errors import InputError, Problem, refuse
from armour.scenario.loading import Scenario
from armour.sweeps.cases import BLOCK, Cases, Grid
from armour.sweeps.checkpoint import RESUME, DamagedError, Store
from armour.sweeps.job import job_of
from armour.sweeps.plan import Plan, plan_of

# Times that the chunks are joined, with those computed anew that prove damaged, before the disk is to blame.
PASSES = 3

# Chunks by index, as groups of rows, and their quantities.
Chunks = Iterator[tuple[int, list[Group]]]
Results = Iterator[tuple[int, dict[str, Any]]]
# Callback after each chunk: its number of rows, and whether it was on disk already.
OnChunk = Callable[[int, bool], None]


class Compute(NamedTuple):
    """A way to compute chunks."""

    run: Callable[[Chunks, Sequence[str]], Results]  # in any order
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
    damaged on disk, and at the end one for each limit of what the model was compared with that rows lie outside of.
    ``replace`` allows the output to take the place of an older file.
    """
    check(scenario, source, quantities)
    compute = compute or in_process()
    with Store(output, job_of(scenario, source, quantities), replace=replace) as store:
        if store.finished is not None:
            return store.finished
        size = store.size or size
        if size is None:
            try:
                plan = plan_of(scenario, source, quantities, output, threads=compute.threads, workers=compute.workers)
            except InputError:
                check_rows(scenario, source)  # says which row is wrong
                raise
            approve(plan)
            size = plan.chunk_rows
        check_rows(scenario, source)
        size = store.begin(size)
        count = -(-source.count // size)
        pending: dict[int, Mapping[str, Floats]] = {}
        outside: Counter[str] = Counter()
        counted = 0  # chunks
        flying = "impact" in reads_of(quantities)

        def missing_chunks() -> Chunks:
            nonlocal counted
            for index, values in enumerate(source.chunks(size)):
                groups = groups_of(scenario, values)
                # Also those that an earlier process computed, each once.
                for group in groups if index >= counted else ():
                    outside.update(dict(outside_limits(group.variants, velocities=flying)))
                counted = max(counted, index + 1)
                try:
                    if store.has(index, values):
                        on_chunk(len(values[source.keys[0]]), True)
                        continue
                except DamagedError as error:
                    tell(f"{error}: damaged, computed anew")
                pending[index] = values
                yield index, groups

        try:
            for _ in range(PASSES):
                for index, results in compute.run(missing_chunks(), quantities):
                    values = pending.pop(index)
                    store.save(index, values, results)
                    on_chunk(len(values[source.keys[0]]), False)
                with suppress(DamagedError):
                    rows = store.finish(count, source.count)
                    for limit, number in outside.items():
                        tell(f"warning: {limit}; this concerns {number:,} of {rows:,} rows")
                    return rows
                on_chunk = ignore_progress  # each was, in the first pass
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"{store.chunks():,} of {count:,} chunks are done; {RESUME}") from None
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
    first = next(source.chunks(1))
    check_keys(scenario, {key: values[0].item() for key, values in first.items()}, quantities, "sweep")


def check_rows(scenario: Scenario, source: Grid | Cases) -> None:
    """Check all rows before the first chunk is computed."""
    start = 0
    for chunk in source.chunks(BLOCK):
        for where, _ in scenarios_of(scenario, chunk, partial(source.place, start)):
            start += len(where)


def in_process(threads: int | None = None) -> Compute:
    """Compute chunks in this process, one after the other, each on all threads."""

    def run(chunks: Chunks, quantities: Sequence[str]) -> Results:
        for index, groups in chunks:
            yield index, evaluate_groups(groups, quantities, threads)

    return Compute(run, threads, workers=1)
