"""Read text and TOML files, locate the shipped data and write files atomically."""

import os
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from armour.errors import InputError, Problem

# Longer than any scenario or library; a device such as /dev/zero has no end.
MAX_BYTES = 10_000_000
# Deeper than the tables and lists of any file; what copies and checks them is recursive.
MAX_DEPTH = 50

_PACKAGE = Path(__file__).resolve().parent
_CHECKOUT = _PACKAGE.parent.parent


def shipped(folder: str) -> Path:
    """Return a folder of shipped data ("configs", ...): in the installed package, or at the top of a checkout."""
    installed = _PACKAGE / folder
    return installed if installed.is_dir() else _CHECKOUT / folder


def reason(error: OSError) -> str:
    """Return the message of the operating system, in lower case."""
    return (error.strerror or str(error)).lower()


def read_text(path: Path) -> str:
    """Read a text file; raise an InputError if it is missing, unreadable, too long or not UTF-8 text."""
    try:
        with path.open("rb") as file:
            return decoded(file, str(path))
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be read: {reason(error)}")]) from None


def decoded(stream: BinaryIO, file: str) -> str:
    """Read a binary stream as UTF-8 text; `file` is its name in messages."""
    try:
        content = stream.read(MAX_BYTES + 1)
        if len(content) <= MAX_BYTES:
            return content.decode("utf-8-sig")
        message = f"must be at most {MAX_BYTES} bytes long"
    except UnicodeDecodeError as error:
        message = f"must be UTF-8 text, found the byte {error.object[error.start]:#04x} at {error.start}"
    raise InputError([Problem(file, "", message)])


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; raise an InputError if it cannot be read or is not valid TOML."""
    return parse_toml(read_text(path), str(path))


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """Parse a text in TOML; `file` is its name in messages."""
    try:
        data = tomllib.loads(text)
        if not nested_too_deeply(data):
            return data
    except tomllib.TOMLDecodeError as error:
        raise InputError([Problem(file, "", f"must be valid TOML, found an error: {error}")]) from None
    except RecursionError:
        pass
    message = f"must be valid TOML, found values nested too deeply; at most {MAX_DEPTH} tables and lists in each other"
    raise InputError([Problem(file, "", message)])


def nested_too_deeply(data: object) -> bool:
    """Return whether tables and lists are nested deeper than any file needs."""
    level = [data]
    for _ in range(MAX_DEPTH + 1):
        level = [child for value in level for child in _children(value)]
    return bool(level)


def _children(value: object) -> Iterable[object]:
    return value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()


def wrong_ending(path: Path, endings: Sequence[str]) -> list[Problem]:
    """Return the problem of an output file that has none of two or more endings, such as ".csv"; [] if it has one."""
    if path.suffix.lower() in endings:
        return []
    listed = f"{', '.join(endings[:-1])} or {endings[-1]}"
    return [Problem(str(path), "", f"must end in {listed}, found {path.suffix or 'no ending'}")]


def check_writable(path: Path) -> None:
    """Check before a long computation that a file can be written; raise an InputError if it cannot."""
    problem = ""
    if path.is_dir():
        problem = "is a folder"
    elif not path.parent.is_dir():
        problem = f"there is no folder {path.parent}"
    elif not os.access(path.parent, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        problem = "permission denied"
    if problem:
        raise InputError([Problem(str(path), "", f"cannot be written: {problem}")])


def write_atomic(path: Path, content: bytes) -> None:
    """Write a file atomically, and a device or a pipe directly; the target of a symbolic link is replaced.

    Raise an InputError if the file cannot be written; an existing file is then left unchanged.
    """
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            _replace(path.resolve(), content)
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be written: {reason(error)}")]) from None


def _replace(path: Path, content: bytes) -> None:
    # Permissions that this process gives to new files; they can only be read by changing them.
    mask = os.umask(0)
    os.umask(mask)
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise
