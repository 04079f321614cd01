"""Tables of sweeps."""

import sys
from pathlib import Path

import pytest

from armour.errors import InputError
from armour.sweeps.tables import is_csv


def test_parquet_without_pyarrow_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    assert is_csv(Path("a.CSV"))
    with pytest.raises(InputError, match=r"a\.parquet: needs pyarrow; pip install 'armour\[parquet\]', or write \.csv"):
        is_csv(Path("a.parquet"))
