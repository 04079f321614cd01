"""Sweeps on a Dask cluster of this machine: rows per second."""

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
from distributed import Client, LocalCluster

from armour.scenario.scenario import load_scenario
from armour.sweeps.cases import Axis, Grid
from armour.sweeps.cluster import workers_of
from armour.sweeps.sweep import Workers, write_sweep

SCENARIO = load_scenario("wilkins")
# Ballistic limits of a sweep: some seconds on a core.
ROWS = 100_000
TURNS = 3


def grid(rows: int) -> Grid:
    """Return a grid of thousands of rows, of both thicknesses."""
    counts = {"armour.ceramic_thickness_mm": rows // 1000, "armour.backing_thickness_mm": 1000}
    return Grid(tuple(Axis(key, tuple(np.linspace(3, 12, n).round(4).tolist())) for key, n in counts.items()))


def rate(workers: Workers | None, rows: int, output: Path) -> float:
    """Return the rows per second of a sweep, on workers or on a thread."""
    start = perf_counter()
    write_sweep(SCENARIO, grid(rows), ["ballistic_limit_m_s"], output, workers=workers, threads=1)
    seconds = perf_counter() - start
    output.unlink()
    return rows / seconds


def measured() -> list[float]:
    """Return the ballistic limits per second without a cluster, with one worker and with two, of one thread each."""
    local = partial(LocalCluster, threads_per_worker=1, dashboard_address="127.0.0.1:0")
    with (
        TemporaryDirectory() as folder,
        local(n_workers=1) as one,
        local(n_workers=2) as two,
        Client(one) as client_of_one,
        Client(two) as client_of_two,
        workers_of(client_of_one) as one_worker,
        workers_of(client_of_two) as two_workers,
    ):
        ways = (None, one_worker, two_workers)
        output = Path(folder) / "table.csv"
        for workers in ways:  # load the compiled code
            rate(workers, 1000, output)
        rates = [[rate(workers, ROWS, output) for workers in ways] for _ in range(TURNS)]
    return [max(column) for column in zip(*rates, strict=True)]
