"""Sweeps on a Dask cluster of this machine: rows per second, the cost of a chunk, and what the client itself takes."""

import os
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from distributed import Client, LocalCluster, wait

from armour.scenario.scenario import load_scenario
from armour.sweeps.cases import Axis, Grid
from armour.sweeps.dask import on_cluster
from armour.sweeps.sweep import Compute, Part, Question, Rows, in_process, sweep
from armour.sweeps.tables import encoded

SCENARIO = load_scenario("wilkins")
TASKS = 2000
# Number of rows by quantity: some seconds on a core.
ROWS = {"ballistic_limit_m_s": 200_000, "residual_velocity_m_s": 1_000_000}
# Numbers and sizes of chunks that are not computed, of which the time of a chunk and of a row follow.
SHAPES = ((2000, 10), (50, 100_000))


def grid(rows: int) -> Grid:
    """Return a grid of thousands of rows, of both thicknesses."""
    counts = {"armour.ceramic_thickness_mm": rows // 1000, "armour.backing_thickness_mm": 1000}
    return Grid(tuple(Axis(key, tuple(np.linspace(3, 12, n).round(4).tolist())) for key, n in counts.items()))


@pytest.fixture(params=[1, 2, 4], scope="module")
def client(request: pytest.FixtureRequest) -> Iterator[Client]:
    """A cluster on this machine, with one process a worker."""
    with (
        LocalCluster(n_workers=request.param, threads_per_worker=1, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        yield client


def timed_sweep(compute: Compute, quantity: str, output: Path, benchmark: Any) -> None:
    """Measure a sweep, once the workers have loaded the compiled code."""
    sweep(SCENARIO, grid(1000), [quantity], output.with_stem("warm"), compute=compute, size=10)
    chunks: list[int] = []

    def run() -> None:
        sweep(
            SCENARIO, grid(ROWS[quantity]), [quantity], output, compute=compute, on_chunk=lambda n, _: chunks.append(n)
        )

    benchmark.pedantic(run, rounds=1)
    benchmark.extra_info.update(what="workers", quantity=quantity, each=ROWS[quantity], chunks=len(chunks))


@pytest.mark.parametrize("quantity", ROWS)
def test_one_thread(benchmark: Any, tmp_path: Path, quantity: str):
    benchmark.extra_info.update(workers=0)
    timed_sweep(in_process(1), quantity, tmp_path / "t.csv", benchmark)


@pytest.mark.parametrize("quantity", ROWS)
def test_workers(benchmark: Any, tmp_path: Path, client: Client, quantity: str):
    benchmark.extra_info.update(workers=len(client.nthreads()))
    timed_sweep(on_cluster(client), quantity, tmp_path / "t.csv", benchmark)


@cache
def content(rows: int, *, header: bool = False) -> bytes:
    """Return rows as they are in a table of ballistic limits."""
    random = np.random.default_rng(1)
    columns = {"a": random.uniform(3, 12, rows).round(4), "b": random.uniform(3, 12, rows).round(4)}
    return encoded({**columns, "c": random.uniform(500, 900, rows)}, as_csv=True, header=header)


def not_computed(_question: object, rows: Rows, threads: int | None = None) -> Part:  # noqa: ARG001
    """Answer a chunk at once."""
    return Part(content(len(next(iter(rows.values.values()))), header=rows.start == 0), Counter(), 0.0)


def nothing_to_do() -> None:
    """Be an empty task."""


@pytest.mark.parametrize("client", [2], indirect=True)
def test_empty_tasks(benchmark: Any, client: Client):
    benchmark.extra_info.update(what="tasks", each=TASKS)
    benchmark.pedantic(
        lambda: wait([client.submit(nothing_to_do, pure=False) for _ in range(TASKS)]), rounds=2, warmup_rounds=1
    )


def at_once(question: Question, chunks: Iterator[Rows]) -> Iterator[tuple[int, Part]]:
    """Answer chunks in this process."""
    for rows in chunks:
        yield rows.start, not_computed(question, rows)


@pytest.mark.parametrize("cluster", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("client", [2], indirect=True)
def test_client(benchmark: Any, tmp_path: Path, client: Client, shape: tuple[int, int], *, cluster: bool):
    """A sweep whose chunks are not computed: what the client, the scheduler and the disk take."""
    chunks, size = shape
    marks: list[float] = []

    def marked(question: Question, chunks: Iterator[Rows]) -> Iterator[tuple[int, Part]]:
        marks.append(perf_counter())  # rows are checked
        yield from on_cluster(client).run(question, chunks) if cluster else at_once(question, chunks)
        marks.append(perf_counter())  # chunks are written

    def run() -> None:
        marks.append(perf_counter())
        source, output = grid(chunks * size), tmp_path / "t.csv"
        sweep(SCENARIO, source, ["ballistic_limit_m_s"], output, compute=Compute(marked, 1, 2), size=size)
        marks.append(perf_counter())

    for header in (False, True):
        content(size, header=header)
        client.run(content, size, header=header)
    with patch("armour.sweeps.dask.computed_there", answered_there):
        benchmark.pedantic(run, rounds=1)
    check_s, write_s, join_s = np.diff(marks)
    benchmark.extra_info.update(
        what="client",
        cluster=cluster,
        each=chunks * size,
        chunks=chunks,
        check_s=check_s,
        write_s=write_s,
        join_s=join_s,
        bytes=os.path.getsize(tmp_path / "t.csv"),
    )


def answered_there(question: bytes, rows: bytes, expected: object) -> Part:  # noqa: ARG001
    """Answer a pickled chunk at once on a worker."""
    import pickle

    return not_computed(pickle.loads(question), pickle.loads(rows))
