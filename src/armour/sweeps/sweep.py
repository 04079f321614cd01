"""Sweeps: quantities of a scenario for many rows of values, computed in chunks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from armour.analysis.evaluate import Group, evaluate_groups, groups_of
from armour.analysis.quantities import QUANTITIES
from armour.analysis.variants import Floats, grid_of
from armour.engine.cache import digest
from armour.errors import InputError, Problem, suggestion
from armour.scenario.loading import Scenario
from armour.sweeps.cases import Cases, Grid
from armour.sweeps.checkpoint import Store

# Rows that are computed, written and, on a cluster, sent at a time; ballistic limits of a chunk take about a second.
CHUNK = 10_000

# Computes chunks, given by index and groups of rows, in any order.
Compute = Callable[[Iterator[tuple[int, list[Group]]], Sequence[str]], Iterator[tuple[int, dict[str, Any]]]]
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
    """Compute quantities of a scenario for every row of a source, and write them to a table.

    Each chunk is written when it is computed.  A sweep that was interrupted is resumed by the same call.

    Parameters
    ----------
    scenario : Scenario
    source : Grid or Cases
        Values by key of the scenario or name of input.
    quantities : sequence of str
        Names of `armour.analysis.quantities.QUANTITIES`.
    output : Path
        CSV or Parquet file, by its suffix.  A question without an answer gives an empty field in CSV and NaN in
        Parquet.
    compute : callable, optional
        How chunks are computed: `in_process` (the default) or `armour.sweeps.dask.on_cluster`.
    size : int
        Rows per chunk.
    on_chunk : callable, optional
        Callback after each chunk: number of rows, and whether the chunk was on disk already.

    Returns
    -------
    int
        Number of rows.

    Raises
    ------
    InputError
        If a key, a value or a quantity is not allowed, a run does not end, or the output cannot be written.
    """
    check_sweep(scenario, source, quantities)
    store = Store(output, job_of(scenario, source, quantities, size))
    pending: dict[int, Mapping[str, Floats]] = {}
    notify = on_chunk or (lambda _rows, _stored: None)
    count = 0

    def missing_chunks() -> Iterator[tuple[int, list[Group]]]:
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


def check_sweep(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str]) -> None:
    """Check keys and quantities before computing.

    Raises
    ------
    InputError
        With every mistake.
    """
    problems = []
    for name in quantities:
        if name not in QUANTITIES:
            hint = suggestion(name, list(QUANTITIES)) or f"; there are {', '.join(QUANTITIES)}"
            problems.append(Problem("sweep", "--quantities", f'must be of quantities, found "{name}"{hint}'))
    if len(set(source.keys)) != len(source.keys):
        problems.append(Problem("sweep", "--over", "must not name a key twice"))
    if any(QUANTITIES[name].on_grid for name in quantities if name in QUANTITIES):
        try:
            grid_of(scenario)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)


def job_of(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str], size: int) -> str:
    """Return a digest of everything that the table of a sweep depends on."""
    rows = source.axes if isinstance(source, Grid) else sha256(source.path.read_bytes()).hexdigest()
    parts = (digest(), repr(scenario), repr(scenario.core_armour()), rows, tuple(quantities), size)
    return sha256(repr(parts).encode()).hexdigest()


def in_process(threads: int | None = None) -> Compute:
    """Compute chunks in this process, one after the other, each on all threads."""

    def compute(
        chunks: Iterator[tuple[int, list[Group]]], quantities: Sequence[str]
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        for index, groups in chunks:
            yield index, evaluate_groups(groups, quantities, threads)

    return compute
