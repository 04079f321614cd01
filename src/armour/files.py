"""Files read and written: the data shipped with the package, TOML in, results out whole or not at all."""

import os
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

from armour.errors import InputError, Problem

# No scenario or library is longer; a device can be without end.
MAX_BYTES = 10_000_000

_PACKAGE = Path(__file__).resolve().parent
_CHECKOUT = _PACKAGE.parent.parent


def shipped(folder: str) -> Path:
    """Folder of shipped data: in the package once installed, at the top of a checkout before that."""
    installed = _PACKAGE / folder
    return installed if installed.is_dir() else _CHECKOUT / folder


def reason(error: OSError) -> str:
    """What the system says of a file."""
    return (error.strerror or str(error)).lower()


def read_text(path: Path) -> str:
    """Read a text file.

    Raises
    ------
    InputError
        If the file is missing, cannot be read, is too long or is not UTF-8 text.
    """
    try:
        with path.open("rb") as file:
            return decoded(file, str(path))
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be read: {reason(error)}")]) from None


def decoded(stream: BinaryIO, file: str) -> str:
    """What a stream holds, as text; ``file`` is its name for messages.

    Raises
    ------
    InputError
        If it is too long or is not UTF-8 text.
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
        If the file is no text that can be read, or not valid TOML.
    """
    return parse_toml(read_text(path), str(path))


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """The data of a text in TOML; ``file`` is its name for messages.

    Raises
    ------
    InputError
        If it is not valid TOML.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"must be valid TOML, found an error: {error}"
    except RecursionError:
        message = "must be valid TOML, found values nested too deeply"
    raise InputError([Problem(file, "", message)])


def wrong_ending(path: Path, endings: Sequence[str]) -> list[Problem]:
    """What is wrong with the ending of a file to write; nothing where it is one of those."""
    if path.suffix.lower() in endings:
        return []
    listed = f"{', '.join(endings[:-1])} or {endings[-1]}"
    return [Problem(str(path), "", f"must end in {listed}, found {path.suffix or 'no ending'}")]


def check_writable(path: Path) -> None:
    """Make sure, before long work, that a result can be written there.

    Raises
    ------
    InputError
        If the path is a folder, or it or its folder is missing or cannot be written to.
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
    """Write a file whole or not at all; a device or a pipe is written to as it is.

    Raises
    ------
    InputError
        If the file cannot be written; what stood there before then still does.
    """
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            _replace(path.resolve(), content)
    except OSError as error:
        raise InputError([Problem(str(path), "", f"cannot be written: {reason(error)}")]) from None


def _replace(path: Path, content: bytes) -> None:
    """Write a draft beside the file and put it in its place."""
    handle, draft = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(draft, _new_file_mode())
        os.replace(draft, path)
    except BaseException:
        os.unlink(draft)
        raise


def _new_file_mode() -> int:
    """Permissions of a file newly made by this process."""
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
