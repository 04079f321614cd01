"""Compiled kernels, kept in the user's cache directory from one process to the next.

Numba's files are kept as one archive.  Its name is a hash of all that the machine code depends on but the processor,
which numba's own index tells apart; its first bytes are a checksum.  An archive is used only if it is intact, belongs
to the user and cannot be written by others.  Each process unpacks it for numba to a private temporary directory.  Where
the user has no cache directory, every process compiles.
"""

import io
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING
from zipfile import ZipFile

from platformdirs import user_cache_dir

if TYPE_CHECKING:
    from armour.engine.kernels import Kernel

PACKAGE = Path(__file__).resolve().parent.parent
SUFFIX = ".kernels"
# Archives of other versions of the program that are kept.
OTHERS_KEPT = 4
CHECKSUM_BYTES = 32

_lock = Lock()


def digest(package: Path = PACKAGE) -> str:
    """Return a hash of the source of the core and the kernels, and of the versions of numba and Python."""
    found = sha256(f"{version('numba')} {sys.version}".encode())
    for path in [*sorted((package / "core").glob("*.py")), package / "engine" / "kernels.py"]:
        found.update(sha256(path.name.encode() + path.read_bytes()).digest())
    return found.hexdigest()


def archive_path() -> Path | None:
    """Return the path of the archive, or None where the user has no cache directory."""
    try:
        directory = Path(user_cache_dir("armour", appauthor=False))
    except RuntimeError:  # no home; older versions of platformdirs return a relative path
        return None
    # numba's index also depends on the path of the source.
    name = sha256(f"{digest()} {PACKAGE}".encode()).hexdigest()
    return directory / f"{name}{SUFFIX}" if directory.is_absolute() else None


def is_compiled() -> bool:
    """Return whether there is an intact archive, without importing numba."""
    path = archive_path()
    return path is not None and read_archive(path) is not None


def kernel(name: str) -> "Kernel":
    """Return a kernel of `armour.engine.kernels`; each is loaded or compiled once in a process."""
    with _lock:
        return _kernel(name)


@cache
def _kernel(name: str) -> "Kernel":
    return load_kernels(name)[name]


def load_kernels(*names: str) -> "dict[str, Kernel]":
    """Load kernels, by default all, from the archive, or compile all of them and write the archive."""
    from armour.engine.kernels import compiled

    try:
        path = archive_path()
        with tempfile.TemporaryDirectory(prefix="armour-", ignore_cleanup_errors=True) as name:
            directory = Path(name)
            archive = read_archive(path) if path else None
            if archive is not None:
                ZipFile(io.BytesIO(archive)).extractall(directory)
            unpacked = _contents(directory)
            with numba_cache(directory):
                found = compiled(*names, cache=True)
                if _contents(directory) != unpacked:
                    compiled(cache=True)
            files = _contents(directory)
        if path and files != unpacked:
            write_archive(path, _zipped(files))
    except (OSError, RuntimeError):  # no temporary directory, or one that numba cannot use
        return compiled(*names, cache=False)
    return found


@contextmanager
def numba_cache(directory: Path) -> Iterator[None]:
    """Make numba cache the functions compiled within the context in a directory, and nowhere else."""
    from numba import config

    settings = {"CACHE_DIR": str(directory), "CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}
    before = {name: getattr(config, name, "") for name in settings}
    try:
        for name, value in settings.items():
            setattr(config, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(config, name, value)


def read_archive(path: Path) -> bytes | None:
    """Return the content of an archive, or None if it is missing, damaged or could be another user's."""
    try:
        if not (is_private(path.parent) and path.is_file() and is_private(path)):
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
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not is_own(directory):
            return
        if not is_private(directory):
            directory.chmod(0o700)
        handle, part = tempfile.mkstemp(prefix=path.name, dir=directory)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(checksum(path, content) + content)
            os.replace(part, path)
        except BaseException:
            os.unlink(part)
            raise
        others = [other for other in directory.glob(f"*{SUFFIX}*") if other != path]
        others.sort(key=lambda other: other.stat().st_mtime)
        for other in others[:-OTHERS_KEPT]:
            other.unlink()


def checksum(path: Path, content: bytes) -> bytes:
    """Return the checksum of the name and the content of an archive."""
    return sha256(path.name.encode() + content).digest()


def is_own(path: Path) -> bool:
    """Return whether a path belongs to this user; True where the system has no users."""
    return not hasattr(os, "getuid") or path.stat().st_uid == os.getuid()


def is_private(path: Path) -> bool:
    """Return whether a path belongs to this user and cannot be written by others; True where there are no users."""
    return not hasattr(os, "getuid") or (is_own(path) and not path.stat().st_mode & 0o022)


def _contents(directory: Path) -> dict[str, bytes]:
    return {
        path.relative_to(directory).as_posix(): path.read_bytes() for path in directory.rglob("*") if path.is_file()
    }


def _zipped(files: dict[str, bytes]) -> bytes:
    archive = io.BytesIO()
    with ZipFile(archive, "w") as writer:
        for name, content in files.items():
            writer.writestr(name, content)
    return archive.getvalue()
