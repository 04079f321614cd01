from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.cases import Axis, Cases, axis_of
from tests.helpers.cases import csv_file, sweep_grid


def test_axes():
    assert axis_of("armour.ceramic_thickness_mm=4:5:0.5") == Axis("armour.ceramic_thickness_mm", (4.0, 4.5, 5.0))
    assert axis_of('library.metal."a=b".x = 1, 2.5') == Axis('library.metal."a=b".x', (1.0, 2.5))


@pytest.mark.parametrize("text", ["a", "=1", "a=", "a=1:2", "a=2:1:1", "a=1:2:0", "a=x", "a=0:1:1e-9", "a=1:nan:1"])
def test_texts_that_are_not_axes(text: str):
    with pytest.raises(InputError, match="--over"):
        axis_of(text)


def test_a_grid_gives_every_combination_once():
    source = sweep_grid("a=1,2,3", "b=4:5:0.5")
    rows = [(a, b) for chunk in source.chunks(2) for a, b in zip(chunk["a"].tolist(), chunk["b"].tolist(), strict=True)]
    assert rows == [(a, b) for a in (1.0, 2.0, 3.0) for b in (4.0, 4.5, 5.0)]
    assert (source.keys, source.count) == (("a", "b"), 9)


def test_cases_in_chunks(tmp_path: Path):
    rows = np.random.default_rng(3).uniform(0.0, 1.0, (57, 2))
    source = Cases(csv_file(tmp_path / "cases.csv", "a,b", *(f"{a!r},{b!r}" for a, b in rows.tolist())))
    assert (source.keys, source.count) == (("a", "b"), 57)
    chunks = list(source.chunks(10))
    assert [len(chunk["a"]) for chunk in chunks] == [10, 10, 10, 10, 10, 7]
    for column, key in enumerate(source.keys):
        np.testing.assert_array_equal(np.concatenate([chunk[key] for chunk in chunks]), rows[:, column])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be a table of numbers"),
        ("a,b\n", "at least one row"),
        ("a,b\n1,2\n\n3,x\n", 'line 4: b: must be a number, found "x"'),
        ("a,b\n1,\n", 'line 2: b: must be a number, found ""'),
        ("a,b\n1,2,3\n", "must be a table of numbers below a header of keys: .*got 3"),
        ("a,b\n1,1_0\n", "must be a table of numbers below a header of keys: .*1_0"),
    ],
)
def test_wrong_tables(tmp_path: Path, text: str, message: str):
    (tmp_path / "cases.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        Cases(tmp_path / "cases.csv")


def test_a_missing_table(tmp_path: Path):
    with pytest.raises(InputError, match="cannot be read"):
        Cases(tmp_path / "cases.csv")
