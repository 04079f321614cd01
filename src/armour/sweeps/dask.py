"""Chunks of a sweep on a Dask cluster."""

import asyncio
import logging
import pickle
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from queue import Empty, SimpleQueue
from time import monotonic
from typing import TYPE_CHECKING, Any

import armour
from armour.errors import ArmourError, InputError, Problem
from armour.sweeps.checkpoint import RESUME
from armour.sweeps.job import program
from armour.sweeps.sweep import Compute, Part, Question, Rows, computed

if TYPE_CHECKING:
    from distributed import Client

# Chunks submitted ahead of time, per thread of the cluster.
CHUNKS_AHEAD = 3
# Time in which a scheduler and a worker must answer, and in which a worker must follow where all are lost.
TIMEOUT_S = 10.0


@contextmanager
def connected(scheduler: str, timeout_s: float = TIMEOUT_S) -> Iterator["Client"]:
    """Connect to the cluster at an address; "local" starts one on this machine, with one process per core."""
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise _error("needs dask.distributed; pip install 'armour[cluster]'") from None
    # What goes wrong is said once, by an error.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if scheduler == "local":
        with LocalCluster(threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
            yield client
        return
    try:
        asyncio.run(asyncio.wait_for(_check_scheduler(scheduler), timeout_s))
        client = Client(scheduler, timeout=timeout_s)
    except Exception as error:  # of any kind, depending on the kind of address
        found = "no answer" if isinstance(error, TimeoutError) else str(error)
        raise _error(
            f'must be "local" or the address of a Dask scheduler that answers, found "{scheduler}": {found}'
        ) from None
    with client:
        check_workers(client, timeout_s)
        yield client


async def _check_scheduler(address: str) -> None:
    """Check that a scheduler answers; a `Client` waits for ever for another server's answer."""
    from distributed import Security, rpc

    async with rpc(address, connection_args=Security().get_connection_args("client")) as scheduler:
        found = await scheduler.identity()
    if found.get("type") != "Scheduler":
        raise ValueError(f"that is a {found.get('type')}")


def check_workers(client: "Client", timeout_s: float = TIMEOUT_S) -> None:
    """Check that a cluster has workers, and that they run this program."""
    try:
        client.wait_for_workers(1, timeout=timeout_s)
    except TimeoutError:
        raise _error("must have a worker, found none; start some with the command dask worker") from None
    with _answering():
        found = client.run(identity, on_error="return")
    for worker, answer in found.items():
        check_identity(answer, identity(), worker)


def identity() -> tuple[str, str]:
    """Return the version and a hash of this program."""
    return armour.__version__, program()


def check_identity(found: object, expected: tuple[str, str], worker: str) -> None:
    """Check the identity of the program of a worker."""
    if found != expected:
        version = found[0] if isinstance(found, tuple) else "another version"
        message = (
            f"must have workers with this program, armour {expected[0]}, and the same numba and numpy; "
            f"found {version} with other sources or libraries on {worker}"
        )
        raise _error(message)


def computed_there(question: bytes, rows: bytes, expected: tuple[str, str]) -> Part:
    """Compute a part of a table for pickled arguments on a worker, which must run the expected program."""
    from distributed import get_worker

    check_identity(identity(), expected, get_worker().address)
    return computed(pickle.loads(question), pickle.loads(rows), threads=1)


def on_cluster(client: "Client") -> Compute:
    """Compute chunks on a cluster; the chunks of a worker that dies are tried again."""
    threads = max(sum(client.nthreads().values()), 1)

    def run(question: Question, chunks: Iterator[Rows]) -> Iterator[tuple[int, Part]]:
        # As bytes, which a worker of another version does not read.
        pickled = pickle.dumps(question)
        running: dict[Any, int] = {}
        done: SimpleQueue[Any] = SimpleQueue()

        def submit(count: int) -> None:
            for rows in islice(chunks, count):
                with _answering():
                    future = client.submit(computed_there, pickled, pickle.dumps(rows), identity(), pure=False)
                running[future] = rows.start
                future.add_done_callback(done.put)

        submit(CHUNKS_AHEAD * threads)
        seen = monotonic()
        while running:
            try:
                future = done.get(timeout=1.0)
            except Empty:
                with _answering():
                    if client.nthreads():
                        seen = monotonic()
                if monotonic() - seen > TIMEOUT_S:
                    raise _error(f"lost all workers; start others, then {RESUME}") from None
                continue
            seen = monotonic()
            with _answering():
                part = future.result()
                future.release()
            yield running.pop(future), part
            submit(1)

    return Compute(run, threads=1, workers=threads)


@contextmanager
def _answering() -> Iterator[None]:
    """Turn what a cluster raises when it fails into a message."""
    try:
        yield
    except ArmourError:
        raise
    except asyncio.CancelledError:
        raise _error(f"lost the connection to the scheduler; what is done is kept, {RESUME}") from None
    except Exception as error:
        raise _error(f"failed: {str(error) or type(error).__name__}; what is done is kept, {RESUME}") from None


def _error(message: str) -> InputError:
    return InputError([Problem("sweep", "--scheduler", message)])
