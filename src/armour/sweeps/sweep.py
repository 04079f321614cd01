"""Sweeps: quantities of a scenario for many rows of values, computed in chunks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from armour.analysis.evaluate import Group, check_keys, check_quantities, evaluate_groups, groups_of, scenarios_of
from armour.analysis.variants import Floats
from armour.engine.cache import digest
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.sweeps.cases import Cases, Grid
from armour.sweeps.checkpoint import Store

# Rows that are computed, written and, on a cluster, sent at a time; ballistic limits of a chunk take about a second.
CHUNK = 10_000

# Chunks by index, as groups of rows, and their quantities.
Chunks = Iterator[tuple[int, list[Group]]]
Results = Iterator[tuple[int, dict[str, Any]]]
# Computes chunks, in any order.
Compute = Callable[[Chunks, Sequence[str]], Results]
# Callback after each chunk: its number of rows, and whether it was on disk already.
OnChunk = Callable[[int, bool], None]


def sweep(
    scenario: Scenario,
    source: Grid | Cases,
    quantities: Sequence[str],
    output: Path,
    *,
    compute: Compute | None = None,
    size: int = CHUNK,
    on_chunk: OnChunk | None = None,
) -> int:
    """Compute quantities of a scenario for every row of a source, write them to a table and return the number of rows.

    Each chunk is written when it is computed: the same call resumes an interrupted sweep.  A question without an answer
    gives an empty field in CSV and NaN in Parquet.
    """
    _check(scenario, source, quantities)
    start = 0
    for chunk in source.chunks(size):
        for where, _ in scenarios_of(scenario, chunk, partial(source.place, start)):
            start += len(where)  # a wrong value raises an error before the first chunk is computed
    store = Store(output, _job(scenario, source, quantities, size))
    pending: dict[int, Mapping[str, Floats]] = {}
    notify = on_chunk or (lambda _rows, _stored: None)
    count = 0

    def missing_chunks() -> Chunks:
        nonlocal count
        for index, columns in enumerate(source.chunks(size)):
            count = index + 1
            if store.has(index):
                notify(len(columns[source.keys[0]]), True)
            else:
                pending[index] = columns
                yield index, groups_of(scenario, columns)

    for index, results in (compute or in_process())(missing_chunks(), quantities):
        columns = pending.pop(index)
        store.save(index, {**columns, **results})
        notify(len(columns[source.keys[0]]), False)
    store.finish(count)
    return source.count


def _check(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str]) -> None:
    """Check the question, and that every key counts."""
    problems: list[Problem] = []
    try:
        check_quantities(scenario, quantities, "sweep", "--quantities")
    except InputError as error:
        problems += error.problems
    if len(set(source.keys)) != len(source.keys):
        problems.append(Problem("sweep", "--over", "must not name a key twice"))
    if problems:
        raise InputError(problems)
    first = next(source.chunks(1))
    check_keys(scenario, {key: float(values[0]) for key, values in first.items()}, quantities, "sweep")


def _job(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str], size: int) -> str:
    """Return a digest of everything that the table of a sweep depends on."""
    rows = source.axes if isinstance(source, Grid) else sha256(source.path.read_bytes()).hexdigest()
    parts = (digest(), repr(scenario), repr(scenario.core_armour()), rows, tuple(quantities), size)
    return sha256(repr(parts).encode()).hexdigest()


def in_process(threads: int | None = None) -> Compute:
    """Compute chunks in this process, one after the other, each on all threads."""

    def compute(chunks: Chunks, quantities: Sequence[str]) -> Results:
        for index, groups in chunks:
            yield index, evaluate_groups(groups, quantities, threads)

    return compute
