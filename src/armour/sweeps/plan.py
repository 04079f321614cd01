"""What a sweep takes: its time and space, from some of its rows, and the rows of its chunks."""

import shutil
from collections.abc import Sequence
from itertools import repeat
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from armour.analysis.evaluate import evaluate_groups, groups_of
from armour.scenario.scenario import Scenario
from armour.sweeps.cases import Cases, Grid
from armour.sweeps.tables import encoded

# A chunk takes about this time, so that a kill costs little, and has at most so many rows.
CHUNK_S = 1.0
MAX_CHUNK = 100_000
# By what factor chunks grow at most from one to the next.
MAX_GROWTH = 2.0
# Samples grow until one takes this time.
SAMPLE_S = 0.1
SAMPLES = (1, 4, 32, 256, 2048)
# What a sweep may take unasked.
LONG_S = 3600.0
MANY_ROWS = 10**8


class Plan(NamedTuple):
    """Work of a sweep."""

    rows: int
    row_s: float  # on one worker
    seconds: float
    bytes: float  # of the output, or more if it is Parquet
    free_bytes: int  # on its disk

    def __str__(self) -> str:
        text = f"{self.rows:,} rows; about {duration(self.seconds)}"
        if self._fits:
            return text
        return f"{text}; {size(2 * self.bytes)} to write and join, where {size(self.free_bytes)} are free"

    @property
    def _fits(self) -> bool:
        return 2 * self.bytes <= self.free_bytes

    @property
    def is_large(self) -> bool:
        """Return whether to ask before such a sweep."""
        return self.seconds > LONG_S or self.rows > MANY_ROWS or not self._fits


class Pace:
    """Rows of the next chunk, so that it takes about a second, from the time of a row in the last one.

    Chunks grow step by step, as the rows that follow may be slower; they shrink at once.
    """

    def __init__(self, row_s: float, size: int | None = None) -> None:
        self.row_s = row_s
        self.size = size  # where it is fixed

    @property
    def rows(self) -> int:
        """Number of rows of the next chunk."""
        return self.size or int(min(max(CHUNK_S / self.row_s, 1.0), MAX_CHUNK))

    def note(self, rows: int, seconds: float) -> None:
        """Take note of the time of a chunk."""
        self.row_s = max(seconds / rows, self.row_s / MAX_GROWTH)


def plan_of(
    scenario: Scenario,
    source: Grid | Cases,
    quantities: Sequence[str],
    output: Path,
    *,
    threads: int | None = None,
    workers: int = 1,
) -> Plan:
    """Measure some rows of a sweep; ``workers`` compute chunks at the same time, each on some threads."""
    each = bytes_each = 0.0
    for number in SAMPLES:
        columns = source.sample(number)
        groups = groups_of(scenario, columns)
        start = perf_counter()
        results, _ = evaluate_groups(groups, quantities, threads)
        # Rows of a chunk follow each other, and share more scenarios than rows from all over the source.
        groups_of(scenario, next(source.chunks(repeat(number))))
        taken = perf_counter() - start
        rows = len(columns[source.keys[0]])
        # The first row also loads the compiled code.
        each = taken / rows
        bytes_each = len(encoded({**columns, **results}, as_csv=True)) / rows
        if rows < number or (number > 1 and taken > SAMPLE_S):
            break
    free = shutil.disk_usage(output.parent).free
    return Plan(source.count, each, each * source.count / workers, bytes_each * source.count, free)


def size(count: float) -> str:
    """Return a number of bytes in words, such as "1.5 GB"."""
    return f"{count / 1e9:,.1f} GB" if count >= 1e9 else f"{count / 1e6:.1f} MB"


def duration(seconds: float) -> str:
    """Return a length of time in words, such as "90 hours"."""
    for limit, unit, name in (
        (120, 1, "seconds"),
        (7200, 60, "minutes"),
        (360000, 3600, "hours"),
        (2e8, 86400, "days"),
    ):
        if seconds < limit:
            number = max(round(seconds / unit), 1)
            return f"{number} {name if number > 1 else name[:-1]}"
    return f"{seconds / 31557600:,.0f} years"
