"""Compiled code is kept from one process to the next, and never beyond a change of what it was made of."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from armour.engine import compiled

LOADED = "import sys; from armour.engine.compiled import kernel; kernel('impacts'); print('numba' in sys.modules)"


def loaded_by_numba() -> bool:
    result = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=True)
    return result.stdout == "True\n"


def test_another_content_of_any_file_of_the_core_is_another_folder(tmp_path: Path):
    folder = Path(compiled.__file__).parent
    before = compiled.digest(folder)
    assert compiled.cache_folder().name == before[:16]
    copy = tmp_path / "core"
    shutil.copytree(folder, copy)
    assert compiled.digest(copy) == before
    for path in sorted(copy.glob("*.py")):
        text = path.read_text()
        path.write_text(text + "\n")
        assert compiled.digest(copy) != before
        path.write_text(text)


def test_only_the_first_process_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert not compiled.is_compiled()
    assert loaded_by_numba()
    assert compiled.is_compiled()
    assert sorted(path.name for path in compiled.cache_folder().iterdir()) == ["impacts.o", "limits.o", "thinnest.o"]
    assert not loaded_by_numba()


def test_a_cache_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "armour").write_text("a file where a folder should be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert loaded_by_numba()
