"""Shipped data, reading of text and TOML files, escaping of texts for files, and writing of whole files."""

import json
import os
import re
import shutil
import stat
import sys
import tomllib
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from math import isfinite
from os import PathLike
from pathlib import Path
from shlex import quote
from typing import Any, BinaryIO

from armour.errors import Problem, joined, mistake, refuse, suggestion

# Beginnings of formulas: in a cell or, for a spreadsheet whose cells semicolons divide, within one; and the apostrophe
# that prevents each.
_FORMULA = re.compile(r"""(^(?='*[=+\-@\t\r\n])|;(?=["']*[=+\-@\t\r\n]))""")
_PREVENTED = re.compile(r"""(?:(^)'(?='*[=+\-@\t\r\n])|(;)'(?=["']*[=+\-@\t\r\n]))""")

# Endings of workbooks.
WORKBOOKS = (".xlsx", ".xlsm")
# Greatest length of a file; a device such as /dev/zero has no end.
MAX_BYTES = 10_000_000
# Greatest depth of the tables in a file, and a key of as many parts, on which the parser would take long.
MAX_DEPTH = 50
_DEEP_KEY = re.compile(rf"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{MAX_DEPTH}}}""")

_PACKAGE = Path(__file__).resolve().parent


def shipped(folder: str) -> Path:
    """Return a folder of shipped data ("configs", ...): in the installed package, or at the top of a checkout."""
    installed = _PACKAGE / folder
    return installed if installed.is_dir() else _PACKAGE.parent.parent / folder


@cache
def shipped_files(folder: str, ending: str) -> dict[str, Path]:
    """Return the files in a folder of shipped data and those below it, by name: its path there without the ending."""
    top = shipped(folder)
    return {path.relative_to(top).as_posix().removesuffix(ending): path for path in sorted(top.rglob(f"*{ending}"))}


def shipped_suites() -> dict[str, Path]:
    """Return the shipped suites by name."""
    return shipped_files("suites", ".toml")


def shipped_tests() -> dict[str, Path]:
    """Return the shipped tables of tests and shots by name, such as "tests/wilkins"."""
    return shipped_files("scenarios", ".csv")


def shipped_notebooks() -> dict[str, Path]:
    """Return the shipped notebooks by file name."""
    return {path.name: path for path in shipped_files("docs", ".ipynb").values()}


def _files_by_kind() -> dict[str, dict[str, Path]]:
    """Return the shipped scenarios, suites and tables: for each kind of file, in words, the files by name."""
    return {
        "scenario": shipped_files("scenarios", ".toml"),
        "suite": shipped_suites(),
        "table of tests or shots": shipped_tests(),
    }


def located(path: Path, files: Mapping[str, Path]) -> Path:
    """Return the file at a path or, if there is none, the one of the shipped `files` with that name, without ending.

    If there is neither, raise an InputError that says what is shipped under the name, or the closest name.
    """
    name = path.as_posix()
    try:
        if not (stat.S_ISDIR(os.stat(path).st_mode) and name in files):
            return path
    except (OSError, ValueError) as error:
        if name not in files:
            with_ending, stem = path.with_suffix(".toml"), path.name.removesuffix(".toml").removesuffix(".csv")
            shipped_names = ((kind, other) for kind, names in _files_by_kind().items() for other in names)
            alike = [f"; {other} is a shipped {kind}" for kind, other in shipped_names if Path(other).name == stem]
            hints = (
                f'; did you mean "{with_ending}"?' * os.path.isfile(with_ending),
                "".join(alike),
                suggestion(path.with_suffix("").as_posix(), [*files]) or suggestion(path.stem, [*files]),
                "; `armour init --list` lists what is shipped",
            )
            raise mistake(path, "", f"cannot be read: {reason(error)}{next(filter(None, hints))}") from None
    return files[name]


def named(path: Path) -> str:
    """Return the path of a file as text; of a shipped file its name, as its path differs between installations."""
    names = {file: name for files in _files_by_kind().values() for name, file in files.items()}
    return names.get(Path(os.path.normpath(path)), str(path))


def suite_file(path: str | PathLike[str]) -> Path:
    """Return the file at a path or, if there is none, the shipped suite of that name."""
    return located(Path(path), shipped_suites())


def reason(error: OSError | ValueError) -> str:
    """Return why an operation on a file failed, in lower case."""
    return (getattr(error, "strerror", None) or str(error)).lower()


def read_text(path: str | PathLike[str]) -> str:
    """Read a text file; raise an InputError if it is missing, unreadable, too long or not UTF-8 text."""
    try:
        refuse_pipe(path)
        with open(path, "rb") as file:
            return decoded(file, str(path))
    except (OSError, ValueError) as error:
        raise mistake(path, "", f"cannot be read: {reason(error)}") from None


def refuse_pipe(path: str | PathLike[str]) -> None:
    """Raise an OSError for a named pipe, which might never be written to; pipes that a shell opens are allowed."""
    if stat.S_ISFIFO(os.stat(path).st_mode) and not os.path.realpath(path).startswith(("/dev/", "/proc/")):
        raise OSError("is a named pipe")


def decoded(stream: BinaryIO, file: str) -> str:
    """Read a binary stream as UTF-8 text; an InputError that names the `file` says if it is too long or no text."""
    try:
        content = stream.read(MAX_BYTES + 1)
        if len(content) <= MAX_BYTES:
            return content.decode("utf-8-sig")
        message = f"must be at most {MAX_BYTES} bytes long"
    except UnicodeDecodeError as error:
        message = f"must be UTF-8 text, found the byte {error.object[error.start]:#04x} at {error.start}"
    raise mistake(file, "", message)


def read_json(path: str | PathLike[str], must: str) -> Any:
    """Read a JSON file; raise an InputError if it cannot be read or, saying what it `must` be, is not JSON."""
    try:
        return json.loads(read_text(path))
    except (ValueError, RecursionError):
        raise mistake(path, "", must) from None


def read_toml(path: str | PathLike[str], *, quoted: bool = True) -> dict[str, Any]:
    """Read a TOML file; raise an InputError if it cannot be read or is not valid TOML.

    The message quotes the wrong line only if `quoted`.  It must not if another file has named this one, which may then
    be any file of the user.
    """
    return parse_toml(read_text(path), str(path), quoted=quoted)


def parse_toml(text: str, file: str, *, quoted: bool = True) -> dict[str, Any]:
    """Return the content of a text in TOML; an InputError that names the `file` quotes the wrong line if `quoted`."""
    try:
        if _DEEP_KEY.search(text) or _depth(data := tomllib.loads(text)) > MAX_DEPTH:
            raise RecursionError
        return data
    except RecursionError:
        message = "must be valid TOML, found values nested too deeply"
    except tomllib.TOMLDecodeError as error:
        # Most errors are texts without quotes, and decimal commas; the line shows them.
        place = re.search(r"at line (\d+)", str(error))
        line = ": " + printable(text.split("\n")[int(place[1]) - 1].strip()[:80]) if place and quoted else ""
        message = f"must be valid TOML, found an error: {error}{line}"
    except ValueError:  # Python converts no more digits
        message = f"must be valid TOML of numbers of at most {sys.get_int_max_str_digits()} digits, found a longer one"
    raise mistake(file, "", message)


def _depth(value: object) -> int:
    """Return how deeply tables and lists are nested; 1 for any other value."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return 1 + max(map(_depth, inner), default=0)


def printable(text: str) -> str:
    """Return a text from a file with its control characters, including line ends, escaped."""
    return "".join(
        character
        if character.isprintable() or unicodedata.category(character) == "Zs"
        else character.encode("unicode_escape").decode("ascii")
        for character in text
    )


def shell_line(words: Iterable[str]) -> str:
    """Return words as a command line that is one line of printable text, quoted so that a shell reads them again."""
    return " ".join(map(_shell_word, words))


def _shell_word(text: str) -> str:
    """Return a word quoted for a shell, with octal codes for control characters and for bytes that are no text.

    The form with codes, in $'', is that of POSIX since 2024.
    """
    if text.isprintable():
        return quote(text)
    codes = [c if c.isprintable() and c not in "'\\" else [*os.fsencode(c)] for c in text]
    return "$'" + "".join(c if isinstance(c, str) else "".join(f"\\{byte:03o}" for byte in c) for c in codes) + "'"


def csv_cell(text: str) -> str:
    """Return a text as a cell of CSV: an apostrophe precedes what a spreadsheet would take for a formula."""
    return printable(_FORMULA.sub(r"\1'", text))


def csv_value(cell: str) -> str:
    """Return the text of a cell, without the apostrophes of `csv_cell`."""
    return _PREVENTED.sub(r"\1\2", cell)


def finite(value: Any) -> Any:
    """Return a value with None in place of NaN and infinity, which JSON lacks, also within mappings and lists."""
    if isinstance(value, Mapping):
        return {key: finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        inner_values = map(finite, value)
        return list(inner_values) if isinstance(value, list) else tuple(inner_values)
    return None if isinstance(value, float) and not isfinite(value) else value


def wrong_ending(path: Path, endings: Sequence[str]) -> list[Problem]:
    """Return the problem of an output file whose ending is not one of those allowed, such as ".csv"; [] if it is."""
    if path.suffix.lower() in endings:
        return []
    return [Problem(str(path), "", f"must end in {joined(endings, 'or')}, found {path.suffix or 'no ending'}")]


def unwritable(path: Path) -> list[Problem]:
    """Return the problem of a file that cannot be written; [] if it can."""
    try:
        obstacle = _obstacle(path)
    except (OSError, ValueError) as error:
        obstacle = reason(error)
    return [Problem(str(path), "", f"cannot be written: {obstacle}")] if obstacle else []


def _obstacle(path: Path) -> str:
    """Return why a file cannot be written, in words; "" if it can."""
    with suppress(FileNotFoundError):
        os.stat(path)  # a loop of links, or a name that is too long
    if path.is_dir():
        return "is a folder"
    folder = Path(os.path.realpath(path)).parent
    if not path.exists() and not folder.is_dir():
        return f"there is no folder {path.parent}"
    if path.is_symlink() and folder != Path(os.path.realpath(path.parent)) and not _is_stream(path):
        return f"is a link to another folder, {folder}"  # which a stranger may have made
    needed = [*([path] if path.exists() else []), *([] if _is_stream(path) else [folder])]
    return "" if all(os.access(name, os.W_OK) for name in needed) else "permission denied"


def _is_stream(path: Path) -> bool:
    """Return whether a path is a device or a pipe, which is written to directly, as it cannot be replaced."""
    return path.exists() and not path.is_file()


def write_file(path: Path, content: bytes) -> None:
    """Write a file completely or not at all, under another name at first; raise an InputError if it cannot be written.

    The target of a symbolic link within a folder is replaced, and the new file gets the permissions of the old one.
    Devices and pipes are written to directly.
    """
    refuse(unwritable(path))
    target = Path(os.path.realpath(path))
    part = target.with_name(f".armour-{os.urandom(8).hex()}")
    try:
        if _is_stream(path):
            # The reader may have closed the pipe.
            with suppress(BrokenPipeError):
                path.write_bytes(content)
            return
        with part.open("xb") as file:
            if target.exists():
                shutil.copymode(target, part)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(target)
    except OSError as error:
        raise mistake(path, "", f"cannot be written: {reason(error)}") from None
    finally:
        part.unlink(missing_ok=True)


def exchangeable(folder: Path) -> bool:
    """Return whether another user could replace a folder: others may write to it, or above, without a sticky bit."""
    if not hasattr(os, "geteuid"):
        return False
    modes = (path.stat().st_mode for path in {folder.absolute(), *folder.absolute().parents, *folder.resolve().parents})
    return any(mode & stat.S_IWOTH and not mode & stat.S_ISVTX for mode in modes)


def make_private(folder: Path) -> bool:
    """Make a folder that only this user can enter; return False if there is one that others may have changed."""
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    status = folder.lstat()
    is_own = not hasattr(os, "geteuid") or (status.st_uid == os.geteuid() and not status.st_mode & 0o022)
    return stat.S_ISDIR(status.st_mode) and is_own
