"""The compiled code: used if it is whole and of these sources, and only from the package's own folder."""

import logging
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import armour
from armour.engine import batch, compiled

MUST = "needs compiled code: run make build"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The library of another installation, whose sources are the same."""
    original = compiled.find_library()
    assert original, MUST
    monkeypatch.setattr(compiled, "FOLDER", tmp_path)
    return Path(shutil.copy(original, tmp_path))


ROOT = Path(__file__).parents[2]


@pytest.mark.skipif(not (ROOT / "src").exists(), reason="needs a clone")
def test_what_is_built_is_not_built_again():
    before = compiled.find_library()
    assert subprocess.run([sys.executable, ROOT / "hatch_build.py"], check=False).returncode == 0
    assert compiled.find_library() == before


def test_a_damaged_library_is_not_used(file: Path):
    assert compiled.find_library() == file
    content = file.read_bytes()
    middle = len(content) // 2
    for damaged in (b"", content[:-1], content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]):
        file.write_bytes(damaged)
        assert compiled.find_library() is None


def test_a_library_of_other_sources_is_not_used(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    content = b"a = 1\n"
    edited = tmp_path / "run.py"
    edited.write_bytes(content)
    monkeypatch.setattr(compiled, "SOURCES", (*compiled.SOURCES[:-1], edited))
    assert compiled.find_library() is None
    edited.write_bytes(content + b"\n")
    file.rename(tmp_path / compiled.library_name(file.read_bytes()))
    assert compiled.find_library()
    edited.write_bytes(content)
    assert compiled.find_library() is None


def test_what_is_no_library_of_this_system_is_not_used(file: Path, tmp_path: Path):
    file.unlink()
    content = b"of another system"
    (tmp_path / compiled.library_name(content)).write_bytes(content)
    assert compiled.find_library()
    assert compiled.library.__wrapped__() is None


def test_without_it_python_computes_and_says_so_where_it_takes_long(
    file: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    scenario = armour.load_scenario("wilkins")
    expected = armour.ballistic_limit(scenario)
    file.unlink()
    monkeypatch.setattr(compiled, "library", compiled.library.__wrapped__)
    compiled._warn.cache_clear()
    with caplog.at_level(logging.WARNING):
        assert armour.ballistic_limit(scenario) == expected
        assert not caplog.records
        monkeypatch.setitem(batch.PORTIONS, "impacts", 1)
        armour.sweep(scenario, {"armour.ceramic_thickness_mm": [6.0, 7.0]}, ["outcome"])
    [record] = caplog.records
    assert record.getMessage() == (
        "computing in plain Python, about a hundred times slower: it is not compiled; install it where there is a C "
        "compiler or, in a clone, run make build"
    )


def test_nothing_is_loaded_from_the_current_folder(file: Path, tmp_path: Path):
    here = tmp_path / "here" / "armour" / "engine"
    here.mkdir(parents=True)
    content = b"not a library"
    for name in (compiled.library_name(content), file.name):
        for folder in (here, here.parents[1]):
            (folder / name).write_bytes(content)
    command = [sys.executable, "-P", "-c", "from armour.engine.compiled import library; print(library()._name)"]
    run = subprocess.run(command, cwd=here.parents[1], capture_output=True, text=True, check=True)
    assert Path(run.stdout.strip()).parent == Path(compiled.__file__).parent
