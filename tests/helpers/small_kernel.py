"""A kernel that compiles quickly, beside those of the engine."""

from typing import Any


def doubled(rows: Any, ends: Any) -> None:
    """Write each number of the first column twice as large."""
    for i in range(len(rows)):
        ends[i, 0] = 2.0 * rows[i, 0]
