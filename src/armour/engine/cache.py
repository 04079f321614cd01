"""Compiled kernels, kept by numba in the user's cache folder from one process to the next.

Numba itself notices changes of the kernels' file only: the folder is named after a digest of all that is compiled.  It
is used where it is the user's and no other user can write it.  Elsewhere every process compiles.
"""

import os
import shutil
import sys
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from platformdirs import user_cache_dir

from armour.errors import ArmourError
from armour.files import make_private

if TYPE_CHECKING:
    from armour.engine.kernels import Kernel

PACKAGE = Path(__file__).resolve().parent.parent
# Folders of other versions of the program that are kept.
OTHERS_KEPT = 4

_lock = Lock()
_loaded: set[str] = set()


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


def folder() -> Path | None:
    """Return the folder of the compiled code, or None where the user has no cache folder."""
    try:
        parent = Path(user_cache_dir("armour", appauthor=False))
    except (OSError, RuntimeError):  # RuntimeError: no home; older versions of platformdirs return a relative path
        return None
    return parent / f"kernels-{digest()}" if parent.is_absolute() else None


def obstacle() -> str:
    """Return why compiled code cannot be kept; "" if it can, in a folder that is made."""
    path = folder()
    if path is None:
        return "without a user cache directory"
    try:
        path.parent.parent.mkdir(parents=True, exist_ok=True)
        if not (make_private(path.parent) and make_private(path)):
            return f"in {path.parent}, which other users can change"
        writable = os.access(path, os.W_OK)
    except OSError:
        writable = False
    return "" if writable else f"in {path.parent}, which cannot be written"


def is_compiled(name: str = "") -> bool:
    """Return whether there is compiled code, or that of a kernel, without importing numba."""
    path = folder()
    return path is not None and not obstacle() and any(name in file.name for file in path.glob("*/*.nbi"))


def kernel(name: str) -> "Kernel":
    """Return a kernel of `armour.engine.kernels`; each is loaded or compiled once in a process."""
    with _lock:
        found = _kernel(name)
        _loaded.add(name)
        return found


def is_loaded(name: str) -> bool:
    """Return whether this process has a kernel."""
    return name in _loaded


@cache
def _kernel(name: str) -> "Kernel":
    try:
        from armour.engine.kernels import compiled
    except ImportError as error:
        raise _unusable(f"numba cannot be imported: {error}") from error
    path = folder()
    if path is None or obstacle():
        return compiled(name)
    try:
        found = compiled(name, path)
    except Exception:  # a damaged file, or a full disk
        shutil.rmtree(path, ignore_errors=True)
        return compiled(name)
    with suppress(OSError):
        others = [other for other in path.parent.glob("kernels-*") if other != path]
        for other in sorted(others, key=os.path.getmtime)[:-OTHERS_KEPT]:
            shutil.rmtree(other)
    return found


def _unusable(reason: str) -> ArmourError:
    return ArmourError(f"{reason}; this computation needs it: type `python -m pip install --upgrade numba`")
