"""Chunks of a sweep on a Dask cluster."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any

from armour.analysis.evaluate import evaluate_groups
from armour.errors import InputError, Problem
from armour.sweeps.sweep import Chunks, Compute, Results

if TYPE_CHECKING:
    from distributed import Client

# Chunks submitted ahead of time, per thread of the cluster.
CHUNKS_AHEAD = 3
# Times that a chunk is tried again.
RETRIES = 3


@contextmanager
def connected(scheduler: str, timeout_s: float = 10.0) -> Iterator["Client"]:
    """Connect to the cluster at an address; "local" starts one on this machine, with one process per core."""
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        message = "needs dask.distributed; pip install 'armour[cluster]'"
        raise InputError([Problem("sweep", "--scheduler", message)]) from None
    if scheduler == "local":
        with LocalCluster(threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(scheduler, timeout=timeout_s)
    except (OSError, TimeoutError, ValueError) as error:
        message = f'must be "local" or the address of a scheduler that answers, found "{scheduler}": {error}'
        raise InputError([Problem("sweep", "--scheduler", message)]) from None
    with client:
        yield client


def on_cluster(client: "Client") -> Compute:
    """Compute chunks on a cluster; the chunks of a worker that dies are tried again."""

    def compute(chunks: Chunks, quantities: Sequence[str]) -> Results:
        from distributed import as_completed

        ahead = CHUNKS_AHEAD * max(sum(client.nthreads().values()), 1)
        indices: dict[Any, int] = {}
        running = as_completed()

        def submit(count: int) -> None:
            for index, groups in islice(chunks, count):
                future = client.submit(evaluate_groups, groups, tuple(quantities), 1, pure=False, retries=RETRIES)
                indices[future.key] = index
                running.add(future)

        submit(ahead)
        for future in running:
            result = future.result()
            future.release()
            yield indices.pop(future.key), result
            submit(1)

    return compute
