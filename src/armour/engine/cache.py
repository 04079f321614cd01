"""Compiled kernels, kept in the user's cache directory from one process to the next.

Numba's files are kept as one archive.  Its name is a hash of all that the machine code depends on but the processor,
which numba's own index tells apart; its first bytes are a checksum.  An archive is used only if it is intact and only
the user can have written it.  Each process unpacks it for numba to a private temporary directory.  Where compiled code
cannot be kept, every process compiles.
"""

import io
import os
import secrets
import shutil
import signal
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from threading import Lock, current_thread, main_thread
from typing import TYPE_CHECKING
from zipfile import ZipFile

from platformdirs import user_cache_dir

from armour.errors import ArmourError
from armour.files import is_private

if TYPE_CHECKING:
    from armour.engine.kernels import Kernel

PACKAGE = Path(__file__).resolve().parent.parent
SUFFIX = ".kernels"
# Archives of other versions of the program that are kept.
OTHERS_KEPT = 4
CHECKSUM_BYTES = 32

_lock = Lock()


def digest(package: Path = PACKAGE) -> str:
    """Return a hash of the source of the core and the kernels, and of the versions of what compiles them."""
    try:
        versions = [version(name) for name in ("numba", "llvmlite", "numpy")]
    except PackageNotFoundError as error:
        raise _unusable(f"{error.name} is not installed") from error
    found = sha256(f"{versions} {sys.version}".encode())
    for path in [*sorted((package / "core").glob("*.py")), package / "engine" / "kernels.py"]:
        found.update(sha256(path.name.encode() + path.read_bytes()).digest())
    return found.hexdigest()


def archive_path() -> Path | None:
    """Return the path of the archive, or None where the user has no cache directory or the package no source files."""
    try:
        directory = Path(user_cache_dir("armour", appauthor=False))
        # numba's index also depends on the path of the source.
        name = sha256(f"{digest()} {PACKAGE}".encode()).hexdigest()
    except (OSError, RuntimeError):  # RuntimeError: no home; older versions of platformdirs return a relative path
        return None
    return directory / f"{name}{SUFFIX}" if directory.is_absolute() else None


def is_compiled() -> bool:
    """Return whether there is an intact archive, without importing numba."""
    path = archive_path()
    return path is not None and read_archive(path) is not None


def obstacle() -> str:
    """Return why compiled code cannot be kept; "" if it can."""
    path = archive_path()
    if path is None:
        return "without a user cache directory"
    directory = path.parent
    if not is_exclusive(directory):
        return f"in {directory}, which other users can change"
    existing = next(place for place in path.parents if os.path.lexists(place))
    if not (os.path.isdir(existing) and os.access(existing, os.W_OK)):
        return f"in {directory}, which cannot be written"
    return ""


def kernel(name: str) -> "Kernel":
    """Return a kernel of `armour.engine.kernels`; each is loaded or compiled once in a process."""
    with _lock:
        return _kernel(name)


@cache
def _kernel(name: str) -> "Kernel":
    return load_kernels(name)[name]


def load_kernels(*names: str) -> "dict[str, Kernel]":
    """Load kernels, by default all, from the archive, or compile all of them and write the archive."""
    try:
        from armour.engine.kernels import compiled
    except ImportError as error:
        raise _unusable(f"numba cannot be imported: {error}") from error

    path = archive_path()
    archive = read_archive(path) if path else None
    # What an archive holds may be of no use though it is intact; then it is made anew.
    for content in dict.fromkeys((archive, None)):
        if path and (content or not obstacle()):
            with suppress(Exception):
                return _load(path, content, *names)
    return compiled(*names)


def _unusable(reason: str) -> ArmourError:
    return ArmourError(f"{reason}; this computation needs it: type `python -m pip install --upgrade numba`")


def _load(path: Path, archive: bytes | None, *names: str) -> "dict[str, Kernel]":
    """Load kernels from the content of an archive, or compile all; write the archive if anything was compiled."""
    from armour.engine.kernels import compiled

    with _temporary_directory() as directory:
        if not is_trusted(directory):
            raise PermissionError
        if archive is not None:
            ZipFile(io.BytesIO(archive)).extractall(directory)
        unpacked = contents(directory)
        found = compiled(*names, directory=directory)
        if contents(directory) != unpacked:
            compiled(directory=directory)
        files = contents(directory)
    if files != unpacked:
        write_archive(path, zipped(files))
    return found


@contextmanager
def _temporary_directory() -> Iterator[Path]:
    """Make a private temporary directory, which is removed also where a signal ends the process."""
    directory = Path(tempfile.gettempdir()) / f"armour-{secrets.token_hex(8)}"

    def end(number: int, _frame: object) -> None:
        shutil.rmtree(directory, ignore_errors=True)
        signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)

    # Only the main thread can handle signals; Windows has no SIGHUP.
    signals = {signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)} if current_thread() is main_thread() else ()
    handled = [number for number in signals if signal.getsignal(number) == signal.SIG_DFL]
    try:
        for number in handled:
            signal.signal(number, end)
        directory.mkdir(mode=0o700)
        yield directory
    finally:
        shutil.rmtree(directory, ignore_errors=True)
        for number in handled:
            signal.signal(number, signal.SIG_DFL)


def read_archive(path: Path) -> bytes | None:
    """Return the content of an archive, or None if it is missing, damaged or could be another user's."""
    try:
        if not (is_exclusive(path.parent) and stat.S_ISREG(path.lstat().st_mode) and is_private(path.stat())):
            return None
        data = path.read_bytes()
    except OSError:
        return None
    content = data[CHECKSUM_BYTES:]
    return content if data[:CHECKSUM_BYTES] == checksum(path, content) else None


def write_archive(path: Path, content: bytes) -> None:
    """Write an archive atomically and delete the oldest others; give up silently if that is impossible."""
    directory = path.parent
    with suppress(OSError):
        if not is_exclusive(directory):
            return
        for parent in reversed(path.parents):
            parent.mkdir(mode=0o700, exist_ok=True)
        handle, part = tempfile.mkstemp(prefix=path.name, dir=directory)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(checksum(path, content) + content)
            os.replace(part, path)
        except BaseException:
            os.unlink(part)
            raise
        others = [other for other in directory.glob(f"*{SUFFIX}*") if other != path]
        others.sort(key=lambda other: other.lstat().st_mtime)
        for other in others[:-OTHERS_KEPT]:
            other.unlink()


def checksum(path: Path, content: bytes) -> bytes:
    """Return the checksum of the name and the content of an archive."""
    return sha256(path.name.encode() + content).digest()


def is_exclusive(directory: Path) -> bool:
    """Return whether a directory is this user's alone, or will be when it is made."""
    return is_trusted(directory) and (not os.path.exists(directory) or is_private(directory.stat()))


def is_trusted(path: Path) -> bool:
    """Return whether only this user and the system can change where a path leads; True where there are no users.

    Directories and links on the way, as far as they exist, must belong to either, and others must be unable to replace
    what is in them.
    """
    if not hasattr(os, "geteuid"):
        return True
    owners = {os.geteuid(), Path(path.anchor).stat().st_uid}
    ways, seen = [path], set[Path]()
    while ways:
        way = ways.pop()
        for part in {way, *way.parents} - seen:
            seen.add(part)
            try:
                status = part.lstat()
            except (FileNotFoundError, NotADirectoryError):
                continue
            except OSError:
                return False
            if status.st_uid not in owners:
                return False
            if stat.S_ISLNK(status.st_mode):
                ways.append(part.parent / part.readlink())
            elif stat.S_ISDIR(status.st_mode) and status.st_mode & 0o022 and not status.st_mode & stat.S_ISVTX:
                return False
    return True


def contents(directory: Path) -> dict[str, bytes]:
    """Return the files below a directory, by their relative paths."""
    return {
        path.relative_to(directory).as_posix(): path.read_bytes() for path in directory.rglob("*") if path.is_file()
    }


def zipped(files: dict[str, bytes]) -> bytes:
    """Return a zip file of files by their paths."""
    archive = io.BytesIO()
    with ZipFile(archive, "w") as writer:
        for name, content in files.items():
            writer.writestr(name, content)
    return archive.getvalue()
