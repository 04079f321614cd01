import gc
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from time import process_time

import pytest

from armour.csv_files import open_table
from armour.errors import InputError
from armour.files import (
    csv_cell,
    csv_value,
    parse_toml,
    read_toml,
    shell_line,
    shipped,
    unwritable,
    write_file,
    wrong_ending,
)


def test_shipped_data_is_found():
    assert (shipped("configs") / "metals.toml").is_file()
    assert (shipped("scenarios") / "wilkins.toml").is_file()


@pytest.fixture
def uncollected() -> Iterator[None]:
    """Nothing that other tests left is finalised at the bottom of a recursion, where it fails."""
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("uncollected")
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xfe\x00", "UTF-8"),
        (b"a = ", "valid TOML"),
        (b"a = 1\r\nvelocity_m_s = 800,5", r"at line 2, column 19\): velocity_m_s = 800,5$"),
        (b"a = " + b"[" * 5000, "nested too deeply"),
        (b".".join([b"a"] * 500) + b" = 1", "nested too deeply"),
        (b"a = " + b"1" * 5000, "numbers of at most 4300 digits, found a longer one$"),
    ],
)
def test_invalid_toml_is_reported(tmp_path: Path, content: bytes, words: str):
    path = tmp_path / "a.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_toml(path)


def test_what_is_no_file_cannot_be_read(tmp_path: Path):
    for path in (tmp_path / "nothing.toml", tmp_path, Path("a\0b"), tmp_path / ("n" * 256)):
        with pytest.raises(InputError, match="cannot be read"):
            read_toml(path)
    with pytest.raises(InputError, match="must be at most"):
        read_toml(Path("/dev/zero"))


def header_of(path: Path) -> object:
    return open_table(path, lambda _name: False).header


@pytest.mark.skipif(os.name != "posix", reason="has no pipes with names in folders")
def test_only_a_pipe_of_the_shell_is_read(tmp_path: Path):
    os.mkfifo(tmp_path / "pipe")
    for read in (read_toml, header_of):
        with pytest.raises(InputError, match="pipe: cannot be read: is a named pipe"):
            read(tmp_path / "pipe")
    for read, content in ((read_toml, {"a": 1}), (header_of, ["a = 1"])):
        reader, writer = os.pipe()
        os.write(writer, b"a = 1")
        os.close(writer)
        assert read(Path(f"/dev/fd/{reader}")) == content
        os.close(reader)


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str):
    path = tmp_path / "old"
    path.write_bytes(b"old")

    def fails(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, call, fails)
        with pytest.raises(InputError, match="no space left"):
            write_file(path, b"changed")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"old": b"old"}
    write_file(path, b"changed")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"old": b"changed"}


def test_a_new_file_has_the_permissions_of_any(tmp_path: Path):
    (tmp_path / "plain").touch()
    write_file(tmp_path / "whole", b"")
    assert (tmp_path / "whole").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o666])
def test_a_replaced_file_keeps_its_permissions(tmp_path: Path, mode: int):
    path = tmp_path / "private"
    path.write_bytes(b"old")
    path.chmod(mode)
    write_file(path, b"new")
    assert path.stat().st_mode & 0o777 == mode


def test_a_long_name(tmp_path: Path):
    path = tmp_path / ("n" * 255)
    assert unwritable(path) == []
    write_file(path, b"new")
    assert path.read_bytes() == b"new"


def test_a_symbolic_link_stays_one(tmp_path: Path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_link_to_another_folder_is_not_followed(tmp_path: Path):
    (tmp_path / "hers").write_bytes(b"old")
    (tmp_path / "his").mkdir()
    link = tmp_path / "his" / "link"
    link.symlink_to("../hers")
    with pytest.raises(InputError, match="is a link to another folder"):
        write_file(link, b"new")
    assert (tmp_path / "hers").read_bytes() == b"old"
    (tmp_path / "folder").symlink_to("his")
    write_file(tmp_path / "folder" / "new", b"new")
    assert (tmp_path / "his" / "new").read_bytes() == b"new"


def test_a_pipe_is_not_replaced(tmp_path: Path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_file(pipe, b"new")
    assert os.read(reader, 10) == b"new"
    os.close(reader)
    assert pipe.is_fifo()


def test_what_cannot_be_written_is_reported(tmp_path: Path):
    assert unwritable(tmp_path / "new.csv") == []
    (tmp_path / "loop").symlink_to("loop")
    for path in (tmp_path, tmp_path / "no" / "a.csv", tmp_path / "loop", tmp_path / ("n" * 256), Path("a\0b")):
        [problem] = unwritable(path)
        assert "cannot be written" in problem.message
        with pytest.raises(InputError, match="cannot be written"):
            write_file(path, b"")


def test_the_ending_of_an_output_is_checked():
    assert wrong_ending(Path("a.CSV"), (".csv", ".parquet")) == []
    [problem] = wrong_ending(Path("a.txt"), (".csv", ".json", ".parquet"))
    assert str(problem) == "a.txt: must end in .csv, .json or .parquet, found .txt"


def test_no_text_in_a_table_is_a_formula_whatever_divides_its_cells():
    assert csv_cell("T;=cmd|' /C calc'!A0") == "T;'=cmd|' /C calc'!A0"
    assert csv_cell('T;"=1') == "T;'\"=1"
    for length in range(6):
        for characters in product("a;'=\"", repeat=length):
            text = "".join(characters)
            assert csv_value(csv_cell(text)) == text
            assert not re.search('(^|;"*)=', csv_cell(text))


NAMES = ("a b", '$x*"', "x\n::error::y", "\x1b[31m7", "caf\udce9", "it's\\\r", "\u202ea", "\u00a0", "$'x'\t1", "é\n7")


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_a_shell_reads_each_word_again(name: str):
    word = shell_line([name])
    assert word.isprintable()
    shell = shutil.which("bash")
    if shell is None:
        pytest.skip("needs bash")
    done = subprocess.run([shell, "-c", f"printf %s {word}"], capture_output=True, check=True)
    assert done.stdout == os.fsencode(name)


@pytest.mark.parametrize("part", ["a", '"a"', "' a '"])
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "a = {{ {} = 1 }}"])
def test_a_key_of_thousands_of_parts_takes_no_time(part: str, form: str):
    start = process_time()
    with pytest.raises(InputError, match="values nested too deeply"):
        parse_toml(form.format(" . ".join([part] * 20_000)), "a.toml")
    assert process_time() - start < 1.0
    assert parse_toml(form.format(".".join([part] * 30)), "a.toml")
