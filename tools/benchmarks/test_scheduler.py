"""Sweeps on a Dask cluster of this machine: rows per second, the cost of a chunk, and what the client itself takes."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
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
from armour.sweeps.cluster import workers_of
from armour.sweeps.store import Chunk, Store
from armour.sweeps.sweep import Workers, write_sweep

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


def timed_sweep(workers: Workers | None, quantity: str, output: Path, benchmark: Any) -> None:
    """Measure a sweep, on workers or on a thread, once they have loaded the compiled code."""
    warm = output.with_stem("warm")
    write_sweep(SCENARIO, grid(1000), [quantity], warm, workers=workers, threads=1, size=10)
    chunks: list[int] = []

    def run() -> None:
        write_sweep(
            SCENARIO,
            grid(ROWS[quantity]),
            [quantity],
            output,
            workers=workers,
            threads=1,
            on_chunk=lambda n, _: chunks.append(n),
        )

    benchmark.pedantic(run, rounds=1)
    benchmark.extra_info.update(what="workers", quantity=quantity, each=ROWS[quantity], chunks=len(chunks))


@pytest.mark.parametrize("quantity", ROWS)
def test_one_thread(benchmark: Any, tmp_path: Path, quantity: str):
    benchmark.extra_info.update(workers=0)
    timed_sweep(None, quantity, tmp_path / "t.csv", benchmark)


@pytest.mark.parametrize("quantity", ROWS)
def test_workers(benchmark: Any, tmp_path: Path, client: Client, quantity: str):
    benchmark.extra_info.update(workers=len(client.nthreads()))
    with workers_of(client) as workers:
        timed_sweep(workers, quantity, tmp_path / "t.csv", benchmark)


@cache
def limits(rows: int) -> np.ndarray:
    """Return numbers that stand for ballistic limits."""
    return np.random.default_rng(1).uniform(500, 900, rows)


def not_computed(_scenario: object, rows: Mapping[str, Any], *_more: object) -> Chunk:
    """Answer a chunk at once."""
    return Chunk({**rows, "ballistic_limit_m_s": limits(len(next(iter(rows.values()))))}, {})


def nothing_to_do() -> None:
    """Be an empty task."""


@pytest.mark.parametrize("client", [2], indirect=True)
def test_empty_tasks(benchmark: Any, client: Client):
    benchmark.extra_info.update(what="tasks", each=TASKS)
    benchmark.pedantic(
        lambda: wait([client.submit(nothing_to_do, pure=False) for _ in range(TASKS)]), rounds=2, warmup_rounds=1
    )


@pytest.mark.parametrize("cluster", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("client", [2], indirect=True)
def test_client(benchmark: Any, tmp_path: Path, client: Client, shape: tuple[int, int], *, cluster: bool):
    """A sweep whose chunks are not computed: what the client, the scheduler and the disk take."""
    chunks, size = shape
    marks: list[float] = []

    def marked(function: Callable[..., None]) -> Callable[..., None]:
        def call(*args: Any) -> None:
            marks.append(perf_counter())
            function(*args)

        return call

    def run() -> None:
        marks.append(perf_counter())
        with workers_of(client) if cluster else nullcontext() as workers:
            source, output = grid(chunks * size), tmp_path / "t.csv"
            write_sweep(SCENARIO, source, ["ballistic_limit_m_s"], output, workers=workers, threads=1, size=size)
        marks.append(perf_counter())

    limits(size)
    client.run(limits, size)
    with (
        patch("armour.sweeps.sweep.chunk_of", not_computed),
        patch.object(Store, "begin", marked(Store.begin)),  # rows are checked
        patch.object(Store, "finish", marked(Store.finish)),  # chunks are written
    ):
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
