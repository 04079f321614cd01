"""Sweeps on a Dask cluster of this machine: rows per second, and the processor time of client and scheduler.

Both are threads of this process.
"""

from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from distributed import Client, LocalCluster, wait

from armour.scenario.scenario import load_scenario
from armour.sweeps.cases import Axis, Grid
from armour.sweeps.cluster import workers_of
from armour.sweeps.store import Chunk, Store
from armour.sweeps.sweep import Workers, computed, write_sweep

SCENARIO = load_scenario("wilkins")
LIMIT = "ballistic_limit_m_s"
# Ballistic limits of a sweep: some seconds on a core.
ROWS = 100_000
TURNS = 3
TASKS = 2000
# Numbers and sizes of chunks that are not computed, from which the time of a chunk and of a row follow.
SHAPES = ((1000, 10), (30, 100_000))


class Cost(NamedTuple):
    """Processor time for each chunk and for each row, s."""

    chunk: float
    row: float


class Cluster(NamedTuple):
    """What was measured."""

    rates: list[float]  # ballistic limits per second: without a cluster, with one worker, with two
    task: float  # an empty task of the scheduler, s
    check: float  # checking a row at the start, s
    send: Cost  # hashing, sending, receiving and writing chunks
    join: Cost  # joining chunks at the end
    row_bytes: float  # of the table


def grid(rows: int) -> Grid:
    """Return a grid of thousands of rows, of both thicknesses."""
    counts = {"armour.ceramic_thickness_mm": rows // 1000, "armour.backing_thickness_mm": 1000}
    return Grid(tuple(Axis(key, tuple(np.linspace(3, 12, n).round(4).tolist())) for key, n in counts.items()))


def swept(workers: Workers | None, rows: int, output: Path) -> float:
    """Return the rows per second of a sweep, on workers or on a thread."""
    start = perf_counter()
    write_sweep(SCENARIO, grid(rows), [LIMIT], output, workers=workers, threads=1)
    seconds = perf_counter() - start
    output.unlink()
    return rows / seconds


@cache
def limits(rows: int) -> np.ndarray:
    """Return numbers in place of ballistic limits."""
    return np.random.default_rng(1).uniform(500, 900, rows)


def not_computed(_scenario: object, rows: Mapping[str, Any], **_settings: object) -> Chunk:
    """Answer a chunk at once."""
    return Chunk({**rows, LIMIT: limits(len(next(iter(rows.values()))))}, {})


def nothing_to_do() -> None:
    """Be an empty task."""


def timed_tasks(client: Client) -> float:
    """Return the time of an empty task, submitted and answered, s."""
    start = process_time()
    wait([client.submit(nothing_to_do, pure=False) for _ in range(TASKS)])
    return (process_time() - start) / TASKS


def client_times(client: Client, chunks: int, size: int, output: Path) -> list[float]:
    """Return the times of checking, sending and joining of a sweep whose chunks are not computed, s; and its bytes."""
    marks = []

    def marked(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any) -> Any:
            marks.append(process_time())
            return function(*args)

        return call

    client.run(limits, size)
    with (
        patch("armour.sweeps.sweep.chunk_of", not_computed),
        patch("armour.sweeps.sweep.computed", marked(computed)),  # rows are checked
        patch.object(Store, "finish", marked(Store.finish)),  # chunks are written
        workers_of(client) as workers,
    ):
        marks.append(process_time())
        write_sweep(SCENARIO, grid(chunks * size), [LIMIT], output, workers=workers, threads=1, size=size)
        marks.append(process_time())
    return [*np.diff(marks).tolist(), output.stat().st_size]


def measured() -> Cluster:
    """Measure sweeps on a cluster with one thread for each worker."""
    local = partial(LocalCluster, threads_per_worker=1, dashboard_address="127.0.0.1:0")
    with TemporaryDirectory() as name, local(n_workers=1) as one, local(n_workers=2) as two:
        output = Path(name) / "table.csv"
        with (
            Client(one) as of_one,
            Client(two) as client,
            workers_of(of_one) as one_worker,
            workers_of(client) as two_workers,
        ):
            ways = (None, one_worker, two_workers)
            for workers in ways:  # load the compiled code
                swept(workers, 1000, output)
            rates = [[swept(workers, ROWS, output) for workers in ways] for _ in range(TURNS)]
        with Client(two) as client:
            task = median(timed_tasks(client) for _ in range(TURNS))
            shapes = np.array([[chunks, chunks * size] for chunks, size in SHAPES], dtype=float)
            found = [client_times(client, chunks, size, output.with_stem(f"{size}")) for chunks, size in SHAPES]
    check, send, join, table = np.array(found).T
    rows = shapes[-1, 1]
    return Cluster(
        np.max(rates, axis=0).tolist(),
        task,
        check[-1] / rows,
        Cost(*np.linalg.solve(shapes, send).tolist()),
        Cost(*np.linalg.solve(shapes, join).tolist()),
        table[-1] / rows,
    )
