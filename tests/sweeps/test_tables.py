"""Tables of sweeps."""

import sys
from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.tables import encoded, is_csv


def test_texts_are_no_formulas_and_numbers_stay_numbers():
    columns = {"name": np.array(["=1+1", "-1", "two\nlines"]), "x": np.array([-1.5, 1e-3, np.nan])}
    table = encoded(columns, as_csv=True, header=True)
    assert table == b"name,x\n'=1+1,-1.5\n'-1,0.001\ntwo\\nlines,\n"


def test_parquet_without_pyarrow_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    assert is_csv(Path("a.CSV"))
    with pytest.raises(InputError, match=r"a\.parquet: needs pyarrow; pip install 'armour\[parquet\]', or write \.csv"):
        is_csv(Path("a.parquet"))
