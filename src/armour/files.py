"""Read text and TOML files, locate the shipped data and write files atomically."""

import os
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

from armour.errors import InputError, Problem

# Longer than any scenario or library; a device such as /dev/zero has no end.
MAX_BYTES = 10_000_000

_PACKAGE = Path(__file__).resolve().parent
_CHECKOUT = _PACKAGE.parent.parent


def shipped(folder: str) -> Path:
    """Return a folder of shipped data: in the installed package, or at the top of a checkout.

    Parameters
    ----------
    folder : {"configs", "scenarios", "suites"}
    """
    installed = _PACKAGE / folder
    return installed if installed.is_dir() else _CHECKOUT / folder


def reason(error: OSError) -> str:
    """Return the message of the operating system, in lower case."""
    return (error.strerror or str(error)).lower()


def read_text(path: Path) -> str:
    """Read a text file.

    Raises
    ------
    InputError
        If the file is missing, unreadable, too long or not UTF-8 text.
    """
    try:
        with path.open("rb") as file:
            return decoded(file, str(path))
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be read: {reason(error)}")]) from None


def decoded(stream: BinaryIO, file: str) -> str:
    """Read a binary stream as UTF-8 text.

    Parameters
    ----------
    stream : binary stream
    file : str
        Name of the stream for messages.

    Raises
    ------
    InputError
        If the content is too long or not UTF-8 text.
    """
    try:
        content = stream.read(MAX_BYTES + 1)
        if len(content) <= MAX_BYTES:
            return content.decode("utf-8-sig")
        message = f"must be at most {MAX_BYTES} bytes long"
    except UnicodeDecodeError as error:
        message = f"must be UTF-8 text, found the byte {error.object[error.start]:#04x} at {error.start}"
    raise InputError([Problem(file, "", message)])


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        If the file cannot be read or is not valid TOML.
    """
    return parse_toml(read_text(path), str(path))


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """Parse a text in TOML.

    Parameters
    ----------
    text : str
    file : str
        Name of the text for messages.

    Raises
    ------
    InputError
        If the text is not valid TOML.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"must be valid TOML, found an error: {error}"
    except RecursionError:
        message = "must be valid TOML, found values nested too deeply"
    raise InputError([Problem(file, "", message)])


def wrong_ending(path: Path, endings: Sequence[str]) -> list[Problem]:
    """Check the ending of an output file.

    Parameters
    ----------
    path : Path
    endings : sequence of str
        At least two allowed endings, such as ".csv".

    Returns
    -------
    list of Problem
        Empty if the ending is allowed.
    """
    if path.suffix.lower() in endings:
        return []
    listed = f"{', '.join(endings[:-1])} or {endings[-1]}"
    return [Problem(str(path), "", f"must end in {listed}, found {path.suffix or 'no ending'}")]


def check_writable(path: Path) -> None:
    """Check that a file can be written, before a long computation.

    Raises
    ------
    InputError
        If the path is a folder, its folder does not exist, or the file or its folder is not writable.
    """
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
    """Write a file atomically; write to a device or a pipe directly.

    Parameters
    ----------
    path : Path
        A symbolic link stays one; its target is replaced.
    content : bytes

    Raises
    ------
    InputError
        If the file cannot be written; an existing file is then left unchanged.
    """
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            _replace(path.resolve(), content)
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be written: {reason(error)}")]) from None


def _replace(path: Path, content: bytes) -> None:
    """Write a temporary file in the same folder and rename it."""
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, _new_file_mode())
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def _new_file_mode() -> int:
    """Return the permissions that this process gives to a new file."""
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
