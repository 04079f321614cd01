"""A cluster gives the same rows, whatever happens to a worker."""

import os
import pickle
import signal
import socket
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from armour.errors import InputError, Problem
from armour.sweeps.dask import connected, on_cluster
from armour.sweeps.sweep import sweep
from tests.helpers.cases import sweep_grid, sweep_scenario

QUANTITIES = ("ballistic_limit_m_s", "residual_velocity_m_s", "outcome")


def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path: Path):
    source = sweep_grid("armour.ceramic_thickness_mm=2:12:0.05", "impact.velocity_m_s=700:900:20")
    case = sweep_scenario()
    sweep(case, source, QUANTITIES, tmp_path / "here.csv", size=100)
    killed: list[int] = []
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):

        def kill(_rows: int, _stored: bool) -> None:
            if not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        compute = on_cluster(client)
        rows = sweep(case, source, QUANTITIES, tmp_path / "there.csv", compute=compute, size=100, on_chunk=kill)
    assert killed
    assert rows == source.count
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


def test_an_address_where_nothing_answers():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(InputError, match="--scheduler: must be"), connected(f"tcp://127.0.0.1:{port}", timeout_s=0.5):
        pass


def test_errors_of_workers_arrive_whole():
    error = pickle.loads(pickle.dumps(InputError([Problem("file", "key", "message")])))
    assert (str(error), error.problems) == ("file: key: message", (Problem("file", "key", "message"),))
