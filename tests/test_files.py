import os
from contextvars import copy_context
from errno import EINVAL, EIO
from functools import partial
from pathlib import Path

import pytest

from armour.errors import ArmourError, InputError
from armour.files import (
    parse_toml,
    read_toml,
    reserve,
    shipped,
    sync_folder,
    unwritable,
    write_files,
    wrong_ending,
)


def test_shipped_data_is_found():
    assert (shipped("configs") / "metals.toml").is_file()
    assert (shipped("scenarios") / "wilkins.toml").is_file()


def test_a_byte_order_mark_is_ignored(tmp_path: Path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbftitle = 'x'")
    assert read_toml(path) == {"title": "x"}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xfe\x00", "UTF-8"),
        (b"a = ", "valid TOML"),
        (b"a = " + b"[" * 5000, "nested too deeply"),
        (b".".join([b"a"] * 500) + b" = 1", "nested too deeply"),
        (b"a = " + b"1" * 5000, "more than 64 bits"),
        (b"a = [{ b = 0x" + b"f" * 17 + b" }]", "more than 64 bits"),
    ],
)
def test_invalid_toml_is_reported(tmp_path: Path, content: bytes, words: str):
    path = tmp_path / "a.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_toml(path)


def test_the_longest_integers_are_read():
    assert parse_toml(f"a = [{2**63 - 1}, {-(2**63)}]", "a") == {"a": [2**63 - 1, -(2**63)]}


def test_an_endless_file_is_not_read_to_its_end():
    with pytest.raises(InputError, match="must be at most"):
        read_toml(Path("/dev/zero"))


def test_a_missing_file_and_a_folder_cannot_be_read(tmp_path: Path):
    for path in (tmp_path / "nothing.toml", tmp_path, Path("a\0b"), tmp_path / ("n" * 256)):
        with pytest.raises(InputError, match="cannot be read"):
            read_toml(path)


def test_a_file_is_written_whole(tmp_path: Path):
    path = tmp_path / "out.csv"
    write_files({path: b"new"})
    assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["out.csv"]


def full(*_: object) -> None:
    raise OSError(28, "No space left on device")


def two_files(folder: Path) -> dict[Path, bytes]:
    """Contents of a file that is there and of a new one."""
    (folder / "old").write_bytes(b"old")
    return {folder / "old": b"changed", folder / "new": b"new"}


def two_are_as_before(folder: Path) -> bool:
    return os.listdir(folder) == ["old"] and (folder / "old").read_bytes() == b"old"


def test_files_are_written_all(tmp_path: Path):
    write_files(two_files(tmp_path))
    assert (tmp_path / "old").read_bytes() == b"changed"
    assert (tmp_path / "new").read_bytes() == b"new"
    assert sorted(os.listdir(tmp_path)) == ["new", "old"]


@pytest.mark.parametrize(("call", "nth"), [("fsync", 1), ("fsync", 2), ("replace", 1)])
def test_or_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str, nth: int):
    contents = two_files(tmp_path)
    really, calls = getattr(os, call), []

    def fails_once(*args: object) -> None:
        calls.append(args)
        full() if len(calls) == nth else really(*args)

    monkeypatch.setattr(os, call, fails_once)
    with pytest.raises(InputError, match="no space left"):
        write_files(contents)
    assert two_are_as_before(tmp_path)


def test_a_file_that_has_changed_since_it_was_read_stays(tmp_path: Path):
    with pytest.raises(InputError, match="old: cannot be written: it has changed since it was read; repeat"):
        write_files(two_files(tmp_path), read={tmp_path / "old": b"older"})
    assert two_are_as_before(tmp_path)


def test_every_file_that_cannot_be_written_is_named(tmp_path: Path):
    wrong = {tmp_path / "no" / "a": b"", tmp_path / ("n" * 256): b""}
    with pytest.raises(InputError) as error:
        write_files({**two_files(tmp_path), **wrong})
    assert [problem.file for problem in error.value.problems] == list(map(str, wrong))
    assert two_are_as_before(tmp_path)


def test_a_failed_write_leaves_the_existing_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "out.csv"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        write_files({path: b"new"})
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["out.csv"]


def test_a_written_file_has_the_permissions_of_a_new_file(tmp_path: Path):
    plain, whole = tmp_path / "plain", tmp_path / "whole"
    plain.write_bytes(b"")
    write_files({whole: b""})
    assert whole.stat().st_mode == plain.stat().st_mode


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o666])
def test_a_replaced_file_keeps_its_permissions(tmp_path: Path, mode: int):
    path = tmp_path / "private"
    path.write_bytes(b"old")
    path.chmod(mode)
    write_files({path: b"new"})
    assert path.stat().st_mode & 0o777 == mode


@pytest.mark.parametrize("length", [246, 255])
def test_a_long_name(tmp_path: Path, length: int):
    path = tmp_path / ("n" * length)
    assert unwritable(path) == []
    write_files({path: b"new"})
    assert path.read_bytes() == b"new"


def test_a_reserved_output_is_not_read(tmp_path: Path):
    (tmp_path / "out.toml").write_text("a = 1")
    (tmp_path / "link.toml").symlink_to("out.toml")
    (tmp_path / "other.toml").write_text("a = 2")

    def in_a_command() -> None:
        reserve([tmp_path / "new.toml", tmp_path / "out.toml"])
        assert read_toml(tmp_path / "other.toml") == {"a": 2}
        with pytest.raises(ArmourError, match=r"out\.toml: must not be the file that is read"):
            read_toml(tmp_path / "link.toml")

    copy_context().run(in_a_command)
    assert read_toml(tmp_path / "link.toml") == {"a": 1}


def test_a_symbolic_link_stays_one(tmp_path: Path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write_files({tmp_path / "link": b"new"})
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_pipe_is_not_replaced(tmp_path: Path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_files({pipe: b"new"})
    assert os.read(reader, 10) == b"new"
    os.close(reader)
    assert pipe.is_fifo()


def test_unwritable_outputs_are_reported(tmp_path: Path):
    assert unwritable(tmp_path / "new.csv") == []
    (tmp_path / "loop").symlink_to("loop")
    wrong = (tmp_path / "nowhere" / "a.csv", tmp_path / "loop", tmp_path / ("n" * 256), Path("a\0b"))
    for path in (tmp_path, *wrong):
        [problem] = unwritable(path)
        assert "cannot be written" in problem.message


def test_the_ending_of_an_output_is_checked():
    assert wrong_ending(Path("a.CSV"), (".csv", ".parquet")) == []
    assert "must end in .csv, found .txt" in str(wrong_ending(Path("a.txt"), (".csv",))[0])
    [problem] = wrong_ending(Path("a.txt"), (".csv", ".json", ".parquet"))
    assert str(problem) == "a.txt: must end in .csv, .json or .parquet, found .txt"


def test_a_folder_is_synced_where_the_file_system_can(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def refused(number: int) -> None:
        monkeypatch.setattr("os.fsync", partial(fail, number))

    def fail(number: int, _handle: int) -> None:
        raise OSError(number, os.strerror(number))

    refused(EINVAL)
    sync_folder(tmp_path)
    refused(EIO)
    with pytest.raises(OSError, match=os.strerror(EIO)):
        sync_folder(tmp_path)
