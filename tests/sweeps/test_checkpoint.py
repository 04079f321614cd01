from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.checkpoint import Store, read_table


def chunk(index: int, rows: int = 3) -> dict[str, object]:
    first = index * rows
    return {
        "armour.x_mm": np.arange(first, first + rows) / 10,
        "limit_m_s": np.array([1 / 3, np.nan, 1e300]),
        "outcome": np.array(["perforated", "", "defeated"], dtype=object),
    }


@pytest.mark.parametrize("name", ["a.csv", "a.parquet"])
def test_chunks_in_any_order_make_the_table(tmp_path: Path, name: str):
    path = tmp_path / name
    store = Store(path, "job")
    for index in (2, 0, 1):
        store.save(index, chunk(index))
    assert not path.exists()
    store.finish(3)
    if name == "a.csv":
        assert path.read_text().splitlines()[2] == '0.1,,""'
    table = read_table(path)
    assert table["armour.x_mm"].tolist() == [i / 10 for i in range(9)]
    np.testing.assert_array_equal(table["limit_m_s"], [1 / 3, np.nan, 1e300] * 3)
    assert [text or "" for text in table["outcome"]] == ["perforated", "", "defeated"] * 3
    assert list(tmp_path.iterdir()) == [path]


def test_a_store_resumes_with_its_own_chunks(tmp_path: Path):
    path = tmp_path / "a.csv"
    first = Store(path, "job")
    first.save(0, chunk(0))
    again = Store(path, "job")
    assert again.has(0)
    assert not again.has(1)
    with pytest.raises(InputError, match="holds chunks of another sweep"):
        Store(path, "another job")


def test_existing_files_are_not_overwritten(tmp_path: Path):
    path = tmp_path / "a.csv"
    path.write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        Store(path, "job")
    folder = tmp_path / "b.csv.parts"
    folder.mkdir()
    with pytest.raises(InputError, match="another sweep"):
        Store(tmp_path / "b.csv", "job")


@pytest.mark.parametrize("name", ["a.txt", "a", "no/a.csv"])
def test_files_that_cannot_be_written(tmp_path: Path, name: str):
    with pytest.raises(InputError):
        Store(tmp_path / name, "job")
    assert list(tmp_path.iterdir()) == []
