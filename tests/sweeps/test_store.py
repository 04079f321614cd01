"""Rows on disk: whole or missing, the user's own, and of one sweep at a time."""

import os
import shutil
import sqlite3
import sys
from collections.abc import Callable
from contextlib import closing
from errno import ENOSPC
from pathlib import Path
from threading import Timer

import numpy as np
import pytest

from armour.errors import InputError
from armour.sweeps.store import Chunk, Store
from armour.sweeps.tables import is_csv, read_table, write_table

on_unix = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs users")

JOB = {"version": "1.0", "program": "a", "scenario": "b", "quantities": "x", "rows": "c"}
TYPES = {"armour.x_mm": "<f8", "limit_m_s": "<f8", "outcome": "<U10"}
RESULTS = {"limit_m_s": np.array([1 / 3, np.nan, 1e300]), "outcome": np.array(["perforated", "", "stopped"])}


def part(index: int) -> Chunk:
    """Return one of several chunks of three rows."""
    return Chunk({"armour.x_mm": np.arange(3 * index, 3 * index + 3) / 10, **RESULTS}, {"far": 1})


def filled(output: Path, count: int, job: dict[str, str] = JOB) -> None:
    """Write the first chunks of a sweep, as many as are not there."""
    with Store(output, job, TYPES) as store:
        for index in range(store.done // 3, count):
            store.append(part(index))


def finished(output: Path) -> None:
    """Write what is missing of three chunks, and the table."""
    with Store(output, JOB, TYPES) as store:
        for index in range(store.done // 3, 3):
            store.append(part(index))
        store.finish()
        assert store.warnings == {"far": 3}


@pytest.fixture(params=["a.csv", "a.parquet"])
def output(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return tmp_path / str(request.param)


def rows_of(output: Path) -> Path:
    return output.with_name(f"{output.name}.parts") / "rows"


def test_chunks_make_the_table_and_leave_nothing_else(output: Path):
    filled(output, 2)
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
        ({"scenario": "other"}, "which differs in scenario; repeat"),
        ({"quantities": "y", "rows": "z"}, "which differs in quantities and rows; repeat"),
        ({"version": "0.9", "program": "z"}, "which differs in version and program; repeat"),
    ],
)
def test_what_differs_is_named_and_the_rows_stay(output: Path, change: dict[str, str], message: str):
    filled(output, 1, {**JOB, **change})
    with pytest.raises(InputError, match=message):
        filled(output, 1)
    assert rows_of(output).is_file()


def test_rows_with_any_byte_changed_never_make_another_table(tmp_path: Path):
    """They are noticed, or their change is of no effect."""
    output = tmp_path / "a.csv"
    finished(output)
    expected = output.read_bytes()
    output.unlink()
    filled(output, 3)
    content = rows_of(output).read_bytes()
    places = np.random.default_rng(1).integers(len(content), size=40).tolist()
    refused = 0
    for place in (16, 18, 20, 28, 56, *places):  # the header, and anywhere
        rows_of(output).parent.mkdir(mode=0o700, exist_ok=True)
        rows_of(output).write_bytes(content[:place] + bytes([content[place] ^ 255]) + content[place + 1 :])
        try:
            finished(output)
        except InputError as error:
            assert "remove" in str(error) or "cannot be written" in str(error)  # noqa: PT017
            refused += 1
            continue
        assert output.read_bytes() == expected
        output.unlink()
    assert refused


@pytest.mark.parametrize("size", [100, 5000])
def test_rows_that_are_cut_are_refused(output: Path, size: int):
    filled(output, 3)
    os.truncate(rows_of(output), size)
    with pytest.raises(InputError, match=r"parts: is damaged: .*; remove the folder to start again"):
        finished(output)
    assert rows_of(output).is_file()


def test_the_rows_of_a_sweep_that_was_killed_are_in_the_log(output: Path):
    """SQLite keeps them there until it closes the database; another process takes them from there."""
    killed = output.with_name("killed")
    with Store(output, JOB, TYPES) as store:
        store.append(part(0))
        store.append(part(1))
        shutil.copytree(rows_of(output).parent, killed)
    finished(output)
    output.unlink()
    killed.rename(rows_of(output).parent)
    assert {path.name for path in rows_of(output).parent.iterdir()} == {"rows", "rows-wal"}
    with Store(output, JOB, TYPES) as store:
        assert store.done == 6
    finished(output)


def test_one_process_at_a_time(output: Path):
    with Store(output, JOB, TYPES), pytest.raises(InputError, match="another sweep is writing"):
        Store(output, {**JOB, "quantities": "y"}, TYPES).__enter__()
    assert list(output.parent.iterdir()) == []


def test_a_lock_is_waited_for_as_two_sweeps_that_begin_at_once_may_each_have_half_of_it(output: Path):
    filled(output, 1)
    other = sqlite3.connect(rows_of(output), isolation_level=None, check_same_thread=False)
    other.executescript("pragma locking_mode = exclusive; begin exclusive")
    Timer(0.2, other.close).start()
    finished(output)


def test_a_full_disk_is_told_and_what_is_done_is_kept(output: Path, monkeypatch: pytest.MonkeyPatch):
    with Store(output, JOB, TYPES) as store:
        store.append(part(0))
        store._database.execute("pragma max_page_count = 1")
        big = Chunk({name: np.zeros(100_000) for name in TYPES}, {})
        with pytest.raises(InputError, match=r"cannot be written: .* full; finished rows are kept, repeat the same"):
            store.append(big)
    filled(output, 2)
    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full_disk)
        with pytest.raises(InputError, match="cannot be written: no space left on device; finished rows are kept"):
            finished(output)
    finished(output)


def full_disk(_file: int) -> None:
    raise OSError(ENOSPC, os.strerror(ENOSPC))


def test_existing_files_are_not_overwritten(output: Path):
    output.write_text("mine")
    with pytest.raises(InputError, match="exists already"):
        filled(output, 1)
    assert list(output.parent.iterdir()) == [output]


@pytest.mark.parametrize("name", [".armour-0123456789abcdef", "rows", "rows-wal"])
def test_a_process_that_was_killed_before_its_first_row_leaves_nothing_that_matters(output: Path, name: str):
    folder = rows_of(output).parent
    folder.mkdir(mode=0o700)
    (folder / name).touch()
    filled(output, 1)
    finished(output)
    assert list(output.parent.iterdir()) == [output]


@pytest.mark.parametrize("name", ["job", "a.new", "rows-journal"])
def test_own_files_in_a_folder_of_that_name_survive(output: Path, name: str):
    folder = rows_of(output).parent
    folder.mkdir(mode=0o700)
    (folder / name).write_text("mine")
    with pytest.raises(InputError, match=f"contains other files, such as {name}; choose another output"):
        finished(output)
    assert {path.name: path.read_text() for path in folder.iterdir()} == {name: "mine"}


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
    """Rows that are intact, and links to what would be overwritten or removed."""
    filled(output, 1)
    folder = output.with_name(f"{output.name}.parts")
    victim = output.with_name("victim")
    victim.write_text("mine")
    for name in ("rows-wal", "lock"):
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(victim)
    planted = {path.name for path in folder.iterdir()}
    assert folder.stat().st_mode & 0o777 == 0o700
    with monkeypatch.context() as patch:
        how(folder, patch)
        with pytest.raises(InputError, match=r"parts: must belong to you and be writable by no other user"):
            finished(output)
    assert not output.exists()
    assert victim.read_text() == "mine"
    assert {path.name for path in folder.iterdir()} == planted


@pytest.fixture
def strange(output: Path) -> sqlite3.Connection:
    """A database that came with the files of somebody else."""
    rows_of(output).parent.mkdir(mode=0o700)
    return sqlite3.connect(rows_of(output))


TABLE = "create table chunk (start integer primary key, checksum, content);"
ENDLESS = "with recursive n(i) as (select 1 union all select i + 1 from n) select i, i, i from n"


@pytest.mark.parametrize(
    "schema",
    [
        f"create view chunk as {ENDLESS}",
        f"{TABLE} create trigger t after insert on chunk begin delete from chunk; end",
        f"{TABLE} create table other (x)",
        f"{TABLE} create index i on chunk (hex(content))",
        "create table chunk (start, checksum, content)",
    ],
)
def test_other_tables_are_refused(strange: sqlite3.Connection, output: Path, schema: str):
    strange.executescript(schema)
    with closing(strange), pytest.raises(InputError, match=r"parts: must .* this sweep, found tables that no"):
        finished(output)
    assert [path.name for path in output.parent.iterdir()] == [f"{output.name}.parts"]


def test_the_database_is_no_link(strange: sqlite3.Connection, output: Path):
    strange.close()
    victim = output.with_name("victim")
    with closing(sqlite3.connect(victim)) as database, database:
        database.execute("create table bookmarks (name)")
    before = victim.read_bytes()
    rows_of(output).unlink()
    rows_of(output).symlink_to(victim)
    with pytest.raises(InputError, match="contains other files, such as rows"):
        finished(output)
    assert victim.read_bytes() == before


def test_only_a_file_is_replaced_where_that_is_asked_for(output: Path):
    output.write_text("old")
    with Store(output, JOB, TYPES, replace=True) as store:
        store.append(part(0))
        assert output.read_bytes() == b"old"
        store.finish()
    assert output.read_bytes() != b"old"
    link = output.with_stem("link")
    link.symlink_to(output)
    with pytest.raises(InputError, match=r"link\.\w+: exists already"):
        Store(link, JOB, TYPES, replace=True).__enter__()


def test_an_output_that_comes_during_the_sweep_stays(output: Path):
    with Store(output, JOB, TYPES) as store:
        store.append(part(0))
        output.write_text("mine")
        with pytest.raises(InputError, match="exists already"):
            store.finish()
    assert output.read_text() == "mine"


def test_files_that_cannot_be_written(tmp_path: Path):
    for name, message in (("a.txt", "must end in"), ("no/a.csv", "there is no folder")):
        with pytest.raises(InputError, match=message):
            filled(tmp_path / name, 1)
    assert list(tmp_path.iterdir()) == []


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


def test_parquet_without_pyarrow_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    assert is_csv(Path("a.CSV"))
    with pytest.raises(InputError, match=r'a\.parquet: needs pyarrow; pip install "pyarrow>=17", or write \.csv'):
        is_csv(Path("a.parquet"))
