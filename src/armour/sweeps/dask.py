"""Chunks of a sweep on a Dask cluster."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from armour.errors import InputError, Problem
from armour.sweeps.sweep import Compute, Group, computed

if TYPE_CHECKING:
    from distributed import Client

# Chunks that each thread of the cluster is given ahead of time.
AHEAD = 3
# How often a chunk is tried again.
RETRIES = 3
LOCAL = "local"


@contextmanager
def connected(scheduler: str, timeout_s: float = 10.0) -> Iterator["Client"]:
    """A client of the cluster at an address; "local" starts one on this machine, a process per core.

    Raises
    ------
    InputError
        If dask.distributed is not installed or nothing answers there.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        message = "needs dask.distributed; pip install 'armour[cluster]'"
        raise InputError([Problem("sweep", "--scheduler", message)]) from None
    if scheduler == LOCAL:
        with LocalCluster(threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(scheduler, timeout=timeout_s)
    except (OSError, TimeoutError, ValueError) as error:
        message = f'must be "{LOCAL}" or the address of a scheduler that answers, found "{scheduler}": {error}'
        raise InputError([Problem("sweep", "--scheduler", message)]) from None
    with client:
        yield client


def on(client: "Client") -> Compute:
    """Compute chunks on a cluster; a worker that dies costs its chunks another try."""

    def compute(
        chunks: Iterator[tuple[int, list[Group]]], quantities: Sequence[str]
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        from distributed import as_completed

        ahead = AHEAD * max(sum(client.nthreads().values()), 1)
        numbers: dict[Any, int] = {}
        waiting = as_completed()

        def submit() -> None:
            for index, groups in chunks:
                future = client.submit(computed, groups, tuple(quantities), 1, pure=False, retries=RETRIES)
                numbers[future.key] = index
                waiting.add(future)
                return

        for _ in range(ahead):
            submit()
        for future in waiting:
            result = future.result()
            future.release()
            yield numbers.pop(future.key), result
            submit()

    return compute
