"""Compute the chunks of a sweep on a Dask cluster."""

import asyncio
import logging
import pickle
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from armour.errors import ArmourError, InputError, mistake
from armour.sweeps.store import RESUME, Chunk
from armour.sweeps.sweep import Rows, Workers, program

if TYPE_CHECKING:
    from distributed import Client

# Greatest number of chunks submitted and not yet returned, per thread of the cluster.
CHUNKS_AHEAD = 3
# Time within which a scheduler and a worker must answer; and within which, if all workers are lost, one must appear.
TIMEOUT_S = 10.0


@contextmanager
def connected(scheduler: str) -> Iterator["Client"]:
    """Yield a client of the Dask cluster at an address; "local" starts one here, with one process per core."""
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise _error('needs dask.distributed; pip install "distributed>=2024.12"') from None
    # Failures are reported once, by an error.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with ExitStack() as started:
        try:
            cluster: Any = scheduler
            if scheduler == "local":
                cluster = started.enter_context(LocalCluster(threads_per_worker=1, dashboard_address="127.0.0.1:0"))
            else:
                asyncio.run(asyncio.wait_for(_check_scheduler(scheduler), TIMEOUT_S))
            client = started.enter_context(Client(cluster, timeout=TIMEOUT_S))
        except Exception as error:  # of any kind, depending on the kind of address and on Dask's settings
            obstacle = "no answer" if isinstance(error, TimeoutError) else str(error)
            must = 'must be "local" or the address of a Dask scheduler that answers'
            raise _error(f'{must}, found "{scheduler}": {obstacle}') from None
        try:
            client.wait_for_workers(1, timeout=TIMEOUT_S)
        except TimeoutError:
            raise _error("must have a worker, found none; start some with the command dask worker") from None
        yield client


async def _check_scheduler(address: str) -> None:
    """Check that a scheduler answers at an address; a `Client` would wait forever if another kind of server did."""
    from distributed import Security, rpc

    async with rpc(address, connection_args=Security().get_connection_args("client")) as scheduler:
        identity = await scheduler.identity()
    if identity.get("type") != "Scheduler":
        raise ValueError(f"that is a {identity.get('type')}")


@contextmanager
def workers_of(client: "Client") -> Iterator[Workers]:
    """Yield functions that compute chunks on a cluster; the chunks of a worker that dies are tried again."""
    from distributed import wait

    def submit(function: Callable[[Rows], Chunk], rows: Rows) -> Any:
        # Pickled, so that a worker with another version can refuse the call before it is unpickled.
        return client.submit(_call, program(), pickle.dumps((function, rows)), pure=False)

    def result(future: Any) -> Chunk:
        seconds_without = 0  # without any worker
        while not future.done():
            with suppress(TimeoutError):
                wait(future, timeout=1.0)
            seconds_without = 0 if client.nthreads() else seconds_without + 1
            if seconds_without > TIMEOUT_S:
                raise _error(f"lost all workers; start others, then {RESUME}")
        chunk: Chunk = future.result()
        return chunk

    try:
        client.run(program)  # a worker without armour would die of a call
        threads = max(sum(client.nthreads().values()), 1)
        yield Workers(submit, result, threads, CHUNKS_AHEAD * threads)
    except ArmourError:
        raise
    except (asyncio.CancelledError, CancelledError):
        raise _error(f"lost the connection to the scheduler; finished rows are kept, {RESUME}") from None
    except Exception as error:  # of any kind, depending on what fails
        raise _error(f"failed: {str(error) or type(error).__name__}; finished rows are kept, {RESUME}") from None


def _call(expected: str, call: bytes) -> Chunk:
    """Call a pickled function with its rows, return the chunk that it computes, and refuse a program of another hash.

    The hash of the worker's program must be the `expected` one.
    """
    if program() != expected:
        raise _error("must have workers with this version of armour and numpy, found a worker with others")
    function, rows = pickle.loads(call)
    chunk: Chunk = function(rows)
    return chunk


def _error(message: str) -> InputError:
    """Return the error of a cluster that cannot be used, which names the option --scheduler."""
    return mistake("sweep", "--scheduler", message)
