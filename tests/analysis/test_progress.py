"""Parts of long computations."""

from itertools import pairwise

import pytest

from armour.analysis import progress


def parts_at(rows_per_second: float, count: int, most: int, monkeypatch: pytest.MonkeyPatch) -> list[slice]:
    """The parts where each row takes the same time, by a clock of our own."""
    now, parts = [0.0], []
    monkeypatch.setattr(progress, "perf_counter", lambda: now[0])
    for part in progress.portions(count, most, 20):
        now[0] += (part.stop - part.start) / rows_per_second
        parts.append(part)
    return parts


@pytest.mark.parametrize(
    ("rows_per_second", "expected"),
    [(256.0, [20, *[128] * 7, 84]), (1e9, [20, 400, 400, 180]), (0.1, [20, *[1] * 980])],
)
def test_parts_take_half_a_second(rows_per_second: float, expected: list[int], monkeypatch: pytest.MonkeyPatch):
    parts = parts_at(rows_per_second, 1000, 400, monkeypatch)
    assert [part.stop - part.start for part in parts] == expected
    assert parts[0].start == 0
    assert all(before.stop == after.start for before, after in pairwise(parts))


def test_no_rows_have_no_part():
    assert list(progress.portions(0, 10)) == []
