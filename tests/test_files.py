import os
from pathlib import Path

import pytest

from armour.errors import InputError
from armour.files import check_writable, read_toml, shipped, write_atomic, wrong_ending


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
        (b"a." * 500 + b"a = 1", "nested too deeply"),
        (b"a = " + b"[" * 60 + b"]" * 60, "nested too deeply; at most 50 tables and lists"),
    ],
)
def test_invalid_toml_is_reported(tmp_path: Path, content: bytes, words: str):
    path = tmp_path / "a.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_toml(path)


def test_an_endless_file_is_not_read_to_its_end():
    with pytest.raises(InputError, match="must be at most"):
        read_toml(Path("/dev/zero"))


def test_a_missing_file_and_a_folder_cannot_be_read(tmp_path: Path):
    for path in (tmp_path / "nothing.toml", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            read_toml(path)


def test_a_file_is_written_whole(tmp_path: Path):
    path = tmp_path / "out.csv"
    write_atomic(path, b"new")
    assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["out.csv"]


def test_a_failed_write_leaves_the_existing_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "out.csv"
    path.write_bytes(b"old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["out.csv"]


def test_a_written_file_has_the_permissions_of_a_new_file(tmp_path: Path):
    plain, whole = tmp_path / "plain", tmp_path / "whole"
    plain.write_bytes(b"")
    write_atomic(whole, b"")
    assert whole.stat().st_mode == plain.stat().st_mode


def test_a_symbolic_link_stays_one(tmp_path: Path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write_atomic(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_pipe_is_not_replaced(tmp_path: Path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_atomic(pipe, b"new")
    assert os.read(reader, 10) == b"new"
    os.close(reader)
    assert pipe.is_fifo()


def test_unwritable_outputs_are_reported(tmp_path: Path):
    check_writable(tmp_path / "new.csv")
    for path in (tmp_path, tmp_path / "nowhere" / "a.csv"):
        with pytest.raises(InputError, match="cannot be written"):
            check_writable(path)


def test_the_ending_of_an_output_is_checked():
    assert wrong_ending(Path("a.CSV"), (".csv", ".parquet")) == []
    [problem] = wrong_ending(Path("a.txt"), (".csv", ".json", ".parquet"))
    assert str(problem) == "a.txt: must end in .csv, .json or .parquet, found .txt"
