"""Chunks on disk: whole or missing, the user's own, and of one sweep at a time."""

import itertools
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.store import Chunk, Store, csv_of, is_csv, read_table
from tests.helpers.faults import faults, full_disk

on_unix = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs users")

JOB = {"version": "1.0", "program": "a", "scenario": "b", "quantities": "x", "rows": "c"}


def values(index: int, rows: int = 3) -> dict[str, np.ndarray]:
    return {"armour.x_mm": np.arange(index * rows, (index + 1) * rows) / 10}


RESULTS = {
    "limit_m_s": np.array([1 / 3, np.nan, 1e300]),
    "outcome": np.array(["perforated", "", "stopped"]),
}


def saved(store: Store, index: int) -> None:
    """Write one of several chunks."""
    store.save(3 * index, Chunk({**values(index), **RESULTS}, {}))


def filled(output: Path, indices: tuple[int, ...] = (0, 1, 2), job: dict[str, str] = JOB) -> None:
    """Write some of three chunks, and all that is not there."""
    with Store(output, job) as store:
        store.begin(3)
        for index in indices:
            saved(store, index)


def finished(output: Path, count: int = 3) -> None:
    """Write what is missing or damaged of some chunks, and the table."""
    with Store(output, JOB) as store:
        store.begin(3)
        chunks = []
        for index in range(count):
            chunk = store.load(3 * index, values(index))
            if chunk is None:
                saved(store, index)
            chunks.append(chunk or Chunk({**values(index), **RESULTS}, {}))
        store.finish(chunk.columns for chunk in chunks)


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that need not survive a loss of power."""
    monkeypatch.setattr("os.fsync", lambda _handle: None)


@pytest.fixture(params=["a.csv", "a.parquet"])
def output(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return tmp_path / str(request.param)


def test_chunks_in_any_order_make_the_table(output: Path):
    filled(output, (2, 0, 1))
    assert not output.exists()
    finished(output)
    if output.suffix == ".csv":
        assert output.read_text().splitlines()[2] == "0.1,,"
    table = read_table(output)
    assert table["armour.x_mm"].tolist() == [i / 10 for i in range(9)]
    np.testing.assert_array_equal(table["limit_m_s"], [1 / 3, np.nan, 1e300] * 3)
    assert [text or "" for text in table["outcome"]] == ["perforated", "", "stopped"] * 3
    assert list(output.parent.iterdir()) == [output]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scenario": "other"}, "which differs in scenario; finish"),
        ({"quantities": "y", "rows": "z"}, "which differs in quantities and rows; finish"),
        ({"version": "0.9", "program": "z"}, "which differs in version and program; finish"),
    ],
)
def test_what_differs_is_named(output: Path, change: dict[str, str], message: str):
    filled(output, (0,), {**JOB, **change})
    with pytest.raises(InputError, match=message):
        Store(output, JOB).__enter__()
    assert output.with_name(output.name + ".parts").is_dir()


def bit_flipped(chunk: Path, _other: Path) -> None:
    data = bytearray(chunk.read_bytes())
    data[data.index(b"NUMPY") + 130] ^= 4
    chunk.write_bytes(data)


def emptied(chunk: Path, _other: Path) -> None:
    chunk.write_bytes(b"")


def exchanged(chunk: Path, other: Path) -> None:
    shutil.copy(other, chunk)


def deleted(chunk: Path, _other: Path) -> None:
    chunk.unlink()


@pytest.mark.parametrize("damage", [bit_flipped, emptied, exchanged, deleted])
def test_a_damaged_chunk_is_noticed(output: Path, damage: Callable[..., None]):
    finished(output.with_stem("b"))
    filled(output)
    chunk, other = (output.with_name(output.name + ".parts") / f"{first:013d}.npz" for first in (3, 6))
    damage(chunk, other)
    with Store(output, JOB) as store:
        assert [store.load(3 * index, values(index)) is None for index in range(3)] == [False, True, False]
    finished(output)
    assert output.read_bytes() == output.with_stem("b").read_bytes()


def test_a_chunk_of_another_job_is_none_of_this(output: Path):
    filled(output, (0,), {**JOB, "scenario": "other"})
    folder = output.with_name(f"{output.name}.parts")
    content = (folder / "0000000000000.npz").read_bytes()
    shutil.rmtree(folder)
    filled(output, (0,))
    (folder / "0000000000000.npz").write_bytes(content)
    with Store(output, JOB) as store:
        assert store.load(0, values(0)) is None


def test_the_size_of_chunks_leaves_no_trace(output: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("armour.sweeps.store.ROW_GROUP", 7)
    column = np.random.default_rng(1).normal(size=60)
    for name, size in (("one", 60), ("many", 4), ("groups", 7)):
        with Store(output.with_stem(name), JOB) as store:
            store.begin(size)
            store.finish({"x": column[start : start + size]} for start in range(0, 60, size))
    assert len({output.with_stem(name).read_bytes() for name in ("one", "many", "groups")}) == 1
    np.testing.assert_array_equal(read_table(output.with_stem("one"))["x"], column)


def test_one_process_at_a_time(output: Path):
    with Store(output, JOB) as first:
        with pytest.raises(InputError, match="another sweep is at work"):
            Store(output, {**JOB, "quantities": "y"}).__enter__()
        first.begin(3)
    assert list(output.parent.iterdir()) == []


class KilledError(BaseException):
    """The process is dead: nothing that it does reaches the disk."""


def test_a_kill_at_any_step_leaves_what_can_be_resumed(output: Path, monkeypatch: pytest.MonkeyPatch):
    def kill(_step: str) -> None:
        raise KilledError

    finished(output.with_stem("b"), 1)
    expected = output.with_stem("b").read_bytes()
    # The lock of a process that is killed here dies with it.
    monkeypatch.setattr("armour.sweeps.store.FileLock.acquire", lambda lock: Path(lock.lock_file).touch())
    killed = []
    for step in itertools.count():
        with faults(step, kill) as steps:
            try:
                finished(output, 1)
            except KilledError:
                killed.append(steps[step])
        if len(steps) <= step:
            break
        if not output.exists():
            finished(output, 1)
        assert output.read_bytes() == expected
        shutil.rmtree(output.with_name(output.name + ".parts"), ignore_errors=True)  # of a kill once it was complete
        assert {path.name for path in output.parent.iterdir()} == {output.name, output.with_stem("b").name}
        output.unlink()
    assert set(killed) == {"open", "mkdir", "create", "write", "fsync", "replace", "unlink", "rmdir"}


def test_a_full_disk_at_any_step_is_told(output: Path):
    finished(output.with_stem("b"), 1)
    for step in itertools.count():
        with faults(step, full_disk) as steps:
            try:
                finished(output, 1)
            except InputError as error:
                assert "cannot be written: no space left on device" in str(error)  # noqa: PT017
                kept = "what is done is kept, repeat the same command to resume" in str(error)
                assert kept == bool(list(output.parent.glob("*.parts/*.npz")))
        if len(steps) <= step:
            break
        if not output.exists():
            finished(output, 1)
        assert output.read_bytes() == output.with_stem("b").read_bytes()
        shutil.rmtree(output.with_name(output.name + ".parts"), ignore_errors=True)
        output.unlink()
    assert step > 15


def test_existing_files_are_not_overwritten(output: Path):
    output.write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        Store(output, JOB).__enter__()
    assert list(output.parent.iterdir()) == [output]
    folder = output.with_name("b.csv.parts")
    folder.mkdir()
    (folder / "mine").touch()
    with pytest.raises(InputError, match=r"b\.csv\.parts: contains other files, such as mine"):
        Store(output.with_name("b.csv"), JOB).__enter__()
    assert [path.name for path in folder.iterdir()] == ["mine"]


@pytest.mark.parametrize("name", ["job", "a.new", "0000000000000.npz"])
def test_own_files_in_a_folder_of_that_name_survive(output: Path, name: str):
    folder = output.with_name(f"{output.name}.parts")
    folder.mkdir(mode=0o700)
    (folder / name).write_text("mine")
    with pytest.raises(InputError, match="choose another output"):
        finished(output)
    assert {path.name: path.read_text() for path in folder.iterdir()} == {name: "mine"}


def test_own_files_beside_the_chunks_survive(output: Path):
    filled(output, (0,))
    folder = output.with_name(f"{output.name}.parts")
    names = {"a.new", "whole", "joined", "1.npz"}
    for name in names:
        (folder / name).write_text("mine")
    finished(output)
    assert {path.name: path.read_text() for path in folder.iterdir()} == dict.fromkeys(names, "mine")


def writable(folder: Path, _monkeypatch: pytest.MonkeyPatch) -> None:
    folder.chmod(0o770)


def of_another_user(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    user = os.geteuid() + 1
    if user == 1:
        os.chown(folder, user, user)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: user)


def behind_a_link(folder: Path, _monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = folder.with_name("elsewhere")
    folder.rename(elsewhere)
    folder.symlink_to(elsewhere)


@on_unix
@pytest.mark.parametrize("how", [writable, of_another_user, behind_a_link])
def test_what_another_user_may_have_planted_is_not_used(
    output: Path, how: Callable[..., None], monkeypatch: pytest.MonkeyPatch
):
    """Chunks that are intact, and links to what would be overwritten or removed."""
    filled(output)
    folder = output.with_name(f"{output.name}.parts")
    victim = output.with_name("victim")
    victim.write_text("mine")
    for name in ("job.new", "whole", "lock"):
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(victim)
    planted = {path.name for path in folder.iterdir()}
    assert folder.stat().st_mode & 0o777 == 0o700
    how(folder, monkeypatch)
    with pytest.raises(InputError, match=r"parts: must belong to you and be writable by no other user"):
        finished(output)
    assert not output.exists()
    assert victim.read_text() == "mine"
    assert {path.name for path in folder.iterdir()} == planted


def test_a_job_that_was_killed_before_its_first_chunk_is_begun(output: Path):
    kept = output.with_name("kept")
    with Store(output, JOB) as store:
        store.begin(3)
        shutil.copytree(store.folder, kept)
    shutil.copytree(kept, store.folder)
    with Store(output, {**JOB, "rows": "other"}) as store:
        assert not store.size
    kept.rename(store.folder)
    with Store(output, JOB) as store:
        assert store.size == 3


def test_only_a_file_is_replaced_where_that_is_asked_for(output: Path):
    output.write_text("old")
    with Store(output, JOB, replace=True) as store:
        store.begin(3)
        assert output.read_bytes() == b"old"
        store.finish([values(0)])
    assert output.read_bytes() != b"old"
    link = output.with_stem("link")
    link.symlink_to(output)
    with pytest.raises(InputError, match=r"link\.\w+: exists already"):
        Store(link, JOB, replace=True).__enter__()


def test_an_output_that_comes_during_the_sweep_stays(output: Path):
    with Store(output, JOB) as store:
        store.begin(3)
        saved(store, 0)
        output.write_text("mine")
        with pytest.raises(InputError, match="exists already"):
            store.finish([values(0)])
    assert output.read_text() == "mine"


@pytest.mark.parametrize("mark", [b"\xff\xfe", b"", b"[1]", b'{"size": 3}'])
def test_a_mark_that_cannot_be_read(output: Path, mark: bytes):
    filled(output, (0,))
    output.with_name(output.name + ".parts").joinpath("job").write_bytes(mark)
    with pytest.raises(InputError, match="job: does not identify its sweep; choose another output, or remove"):
        Store(output, JOB).__enter__()


def test_files_that_cannot_be_written(tmp_path: Path):
    for name, message in (("a.txt", "must end in"), ("no/a.csv", "there is no folder")):
        with pytest.raises(InputError, match=message):
            Store(tmp_path / name, JOB).__enter__()
    assert list(tmp_path.iterdir()) == []


def test_texts_are_no_formulas_and_numbers_stay_numbers():
    columns = {"name": np.array(["=1+1", "-1", "two\nlines"]), "x": np.array([-1.5, 1e-3, np.nan])}
    assert csv_of(columns, header=True) == b"name,x\n'=1+1,-1.5\n'-1,0.001\ntwo\\nlines,\n"


def test_parquet_without_pyarrow_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    assert is_csv(Path("a.CSV"))
    with pytest.raises(InputError, match=r"a\.parquet: needs pyarrow; pip install 'armour\[parquet\]', or write \.csv"):
        is_csv(Path("a.parquet"))
