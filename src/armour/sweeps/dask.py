"""Chunks of a sweep on a Dask cluster."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from armour.analysis.evaluate import Group, evaluate_groups
from armour.errors import InputError, Problem
from armour.sweeps.sweep import Compute

if TYPE_CHECKING:
    from distributed import Client

# Chunks submitted ahead of time, per thread of the cluster.
CHUNKS_AHEAD = 3
# Times that a chunk is tried again.
RETRIES = 3
LOCAL = "local"


@contextmanager
def connected(scheduler: str, timeout_s: float = 10.0) -> Iterator["Client"]:
    """Connect to a cluster.

    Parameters
    ----------
    scheduler : str
        Address of the scheduler; "local" starts a cluster on this machine, with one process per core.
    timeout_s : float
        Time to wait for an answer, s.

    Raises
    ------
    InputError
        If dask.distributed is not installed or no scheduler answers at the address.
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


def on_cluster(client: "Client") -> Compute:
    """Compute chunks on a cluster; the chunks of a worker that dies are tried again."""

    def compute(
        chunks: Iterator[tuple[int, list[Group]]], quantities: Sequence[str]
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        from distributed import as_completed

        ahead = CHUNKS_AHEAD * max(sum(client.nthreads().values()), 1)
        indices: dict[Any, int] = {}
        running = as_completed()

        def submit_next() -> None:
            for index, groups in chunks:
                future = client.submit(evaluate_groups, groups, tuple(quantities), 1, pure=False, retries=RETRIES)
                indices[future.key] = index
                running.add(future)
                return

        for _ in range(ahead):
            submit_next()
        for future in running:
            result = future.result()
            future.release()
            yield indices.pop(future.key), result
            submit_next()

    return compute
