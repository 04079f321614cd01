"""Tables in CSV and Parquet."""

import sys
from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.tables import csv_of, is_csv, read_table, write_table


def test_the_size_of_chunks_leaves_no_trace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.sweeps.tables.ROW_GROUP", 7)
    column = np.random.default_rng(1).normal(size=60)
    for ending in ("csv", "parquet"):
        contents = set()
        for size in (60, 4, 7):
            path = tmp_path / f"{size}.{ending}"
            chunks = ({"x": column[start : start + size]} for start in range(0, 60, size))
            with path.open("wb") as file:
                write_table(file, chunks, as_csv=ending == "csv")
            contents.add(path.read_bytes())
        assert len(contents) == 1
        np.testing.assert_array_equal(read_table(tmp_path / f"4.{ending}")["x"], column)


def test_texts_are_no_formulas_and_numbers_stay_numbers():
    columns = {"name": np.array(["=1+1", "-1", "two\nlines"]), "x": np.array([-1.5, 1e-3, np.nan])}
    assert csv_of(columns, header=True) == b"name,x\n'=1+1,-1.5\n'-1,0.001\ntwo\\nlines,\n"


def test_parquet_without_pyarrow_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    assert is_csv(Path("a.CSV"))
    with pytest.raises(InputError, match=r"a\.parquet: needs pyarrow; pip install 'armour\[parquet\]', or write \.csv"):
        is_csv(Path("a.parquet"))
