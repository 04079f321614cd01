"""A cluster gives the same rows, whatever happens to a worker."""

import asyncio
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import CancelledError
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from armour.errors import InputError
from armour.sweeps.cluster import connected, workers_of
from armour.sweeps.sweep import write_sweep
from tests.helpers.cases import sweep_grid, sweep_scenario

if TYPE_CHECKING:
    from distributed import Client

pytestmark = pytest.mark.slow

VELOCITIES = "impact.velocity_m_s=700,800"
QUANTITIES = ("ballistic_limit_m_s", "residual_velocity_m_s", "outcome")


def test_a_worker_that_is_killed_costs_nothing_but_time(tmp_path: Path):
    from distributed import Client, LocalCluster

    source = sweep_grid("armour.ceramic_thickness_mm=2:12:1", "impact.velocity_m_s=700:900:20")
    case = sweep_scenario()
    write_sweep(case, source, QUANTITIES, tmp_path / "here.csv", size=10)
    killed: list[int] = []
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):

        def kill(_rows: int, _stored: bool) -> None:
            if not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        with workers_of(client) as workers:
            rows = write_sweep(
                case, source, QUANTITIES, tmp_path / "there.csv", workers=workers, size=10, on_chunk=kill
            )
    assert killed
    assert rows == source.count
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("tcp://127.0.0.1:{}", "no answer"),
        ("nowhere:x", "invalid literal"),
    ],
)
def test_an_address_without_a_scheduler(address: str, message: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.sweeps.cluster.TIMEOUT_S", 0.3)
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        found = address.format(server.getsockname()[1])
        expected = f'--scheduler: must be "local" or .*, found "{found}": .*{message}'
        with pytest.raises(InputError, match=expected), connected(found):
            pass


@pytest.fixture(scope="module")
def client() -> "Iterator[Client]":
    """A cluster in this process, without workers."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=0, processes=False, protocol="tcp://", dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        yield client


def sweep_on(client: "Client", output: Path) -> None:
    """A sweep on a cluster, a row a chunk."""
    with workers_of(client) as workers:
        write_sweep(sweep_scenario(), sweep_grid(VELOCITIES), ["outcome"], output, workers=workers, size=1)


def test_a_cluster_without_workers(client: "Client", tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert client.cluster is not None
    address = client.cluster.scheduler_address
    monkeypatch.setattr("armour.sweeps.cluster.TIMEOUT_S", 1.0)
    with pytest.raises(InputError, match="must have a worker, found none"), connected(address):
        pass
    monkeypatch.setattr("armour.sweeps.cluster.TIMEOUT_S", 0.1)
    with pytest.raises(InputError, match="lost all workers; start others, then repeat the same sweep to resume"):
        sweep_on(client, tmp_path / "a.csv")


def test_workers_of_another_version_are_refused(client: "Client", tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    here = threading.get_ident()
    assert client.cluster is not None
    client.cluster.scale(1)
    client.wait_for_workers(1)
    sweep_on(client, tmp_path / "a.csv")
    monkeypatch.setattr("armour.sweeps.cluster.program", lambda: "this" if threading.get_ident() == here else "other")
    message = "must have workers with this version of armour and numpy, found a worker with others"
    with pytest.raises(InputError, match=message):
        sweep_on(client, tmp_path / "b.csv")


def test_a_scheduler_is_connected_to_and_a_worker_is_none(client: "Client", tmp_path: Path):
    assert client.cluster is not None
    client.cluster.scale(1)
    client.wait_for_workers(1)
    with connected(client.cluster.scheduler_address) as found:
        sweep_on(found, tmp_path / "a.csv")
    write_sweep(sweep_scenario(), sweep_grid(VELOCITIES), ["outcome"], tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    [worker] = client.scheduler_info()["workers"]
    with pytest.raises(InputError, match=f'found "{worker}": that is a Worker'), connected(worker):
        pass


def test_a_cluster_is_started_on_this_machine(monkeypatch: pytest.MonkeyPatch):
    from distributed import LocalCluster

    monkeypatch.setattr("distributed.LocalCluster", partial(LocalCluster, n_workers=1, processes=False))
    with connected("local") as found:
        assert list(found.nthreads().values()) == [1]


def test_a_worker_without_armour_is_told(tmp_path: Path):
    from distributed import Client, LocalCluster

    (tmp_path / "armour").mkdir()
    (tmp_path / "armour" / "__init__.py").write_text("raise ImportError('none here')")
    with (
        LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0", host="127.0.0.1") as cluster,
        Client(cluster) as client,
    ):
        words = [sys.executable, "-m", "dask", "worker", cluster.scheduler_address, "--nthreads", "1", "--no-nanny"]
        worker = subprocess.Popen(
            [*words, "--no-dashboard"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)}, stderr=-3
        )
        try:
            client.wait_for_workers(1)
            with pytest.raises(InputError, match=r"failed: ImportError.*none here"):
                sweep_on(client, tmp_path / "a.csv")
        finally:
            worker.kill()
            worker.wait()


def test_without_dask_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r'needs dask\.distributed; pip install "distributed>=2024\.12"'),
        connected("local"),
    ):
        pass


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (asyncio.CancelledError(), "lost the connection to the scheduler; finished rows are kept, repeat the same"),
        (CancelledError(), "lost the connection to the scheduler"),
        (OSError("no route"), "failed: no route; finished rows are kept"),
    ],
)
def test_what_fails_on_a_cluster_is_told(
    client: "Client", tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, message: str
):
    def submit(*_args: Any, **_settings: Any) -> None:
        raise error

    monkeypatch.setattr(client, "submit", submit)
    with pytest.raises(InputError, match=message):
        sweep_on(client, tmp_path / "a.csv")
