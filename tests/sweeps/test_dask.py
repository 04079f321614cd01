"""The same rows from a cluster, whatever happens to a worker."""

import os
import signal
import socket
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from armour.errors import InputError
from armour.sweeps.dask import connected, on
from armour.sweeps.sweep import sweep
from tests.sweeps.test_sweep import case, grid

SOURCE = grid("armour.ceramic_thickness_mm=2:12:0.05", "impact.velocity_m_s=700:900:20")
QUANTITIES = ("ballistic_limit_m_s", "residual_velocity_m_s", "outcome")


def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path: Path):
    sweep(case(), SOURCE, QUANTITIES, tmp_path / "here.csv", size=100)
    killed: list[int] = []
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):

        def kill(_rows: int, _before: bool) -> None:
            if not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        rows = sweep(case(), SOURCE, QUANTITIES, tmp_path / "there.csv", compute=on(client), size=100, on_chunk=kill)
    assert killed
    assert rows == SOURCE.count
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


def test_an_address_where_nothing_answers():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(InputError, match="--scheduler: must be"), connected(f"tcp://127.0.0.1:{port}", timeout_s=0.5):
        pass
