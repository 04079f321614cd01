"""Progress of long computations: its callback, and parts that are short enough to report."""

from collections.abc import Callable, Iterator
from time import perf_counter

# How much is done since the last call, and how much there is, None where not known.
OnProgress = Callable[[int, int | None], None]

# Rows of the first part, of impacts and of searches, and seconds that each further part is to take.
FIRST_IMPACTS, FIRST_SEARCHES = 256, 16
PORTION_S = 0.5


def ignore_progress(_done: int, _total: int | None) -> None:
    """Do nothing."""


def portions(count: int, most: int, first: int = FIRST_SEARCHES) -> Iterator[slice]:
    """Yield the parts of n rows that are computed one after the other: at most some, which bounds the memory.

    Each takes about half a second at the speed of the part before it; what is computed does not depend on them.
    """
    start, size = 0, min(first, most)
    while start < count:
        end, begun = min(start + size, count), perf_counter()
        yield slice(start, end)
        # A clock may be too coarse for short parts.
        speed = (end - start) / max(perf_counter() - begun, 1e-3)
        start, size = end, min(max(int(PORTION_S * speed), 1), most)
