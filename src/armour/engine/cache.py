"""Compiled kernels, kept by numba in the user's cache folder from one process to the next.

Numba itself notices changes of the kernels' file only: the folder is named after a digest of all that is compiled.  It
is used if no other user can write to it or put another in its place.  Otherwise every process compiles.
"""

import logging
import os
import shutil
import sys
from contextlib import suppress
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from platformdirs import user_cache_dir

from armour.errors import ArmourError
from armour.files import exchangeable, make_private

if TYPE_CHECKING:
    from armour.engine.kernels import Kernel

PACKAGE = Path(__file__).resolve().parent.parent
COMPILING = "compiling the numerical code, which takes about ten seconds"
# Folders of other versions of the program that are kept.
OTHERS_KEPT = 4

log = logging.getLogger(__name__)
_lock = Lock()
_kernels: dict[str, "Kernel"] = {}


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


def folder() -> tuple[Path | None, str]:
    """Return the folder of the compiled code, which is made, or None and why compiled code cannot be kept."""
    try:
        path = Path(user_cache_dir("armour", appauthor=False), f"kernels-{digest()}")
    except (OSError, RuntimeError):  # RuntimeError: no home; older versions of platformdirs return a relative path
        path = Path()
    if not path.is_absolute():
        return None, "without a user cache directory"
    with suppress(OSError):
        path.parent.parent.mkdir(parents=True, exist_ok=True)
        if exchangeable(path.parent.parent, 0o022, by_owners=True) or not (
            make_private(path.parent) and make_private(path)
        ):
            return None, f"in {path.parent}, which other users can change"
        if os.access(path, os.W_OK):
            return path, ""
    return None, f"in {path.parent}, which cannot be written"


def is_compiled(name: str) -> bool:
    """Return whether there is the compiled code of a kernel, without importing numba."""
    path, _ = folder()
    return path is not None and any(name in file.name for file in path.glob("*/*.nbi"))


def kernel(name: str) -> "Kernel":
    """Return a kernel of `armour.engine.kernels`; each is loaded or compiled once in a process."""
    with _lock:
        if name not in _kernels:
            _kernels[name] = load(name)
        return _kernels[name]


def is_loaded(name: str) -> bool:
    """Return whether this process has a kernel."""
    return name in _kernels


def load(name: str) -> "Kernel":
    """Load a kernel, or compile it, which is logged, and keep it."""
    try:
        from armour.engine.kernels import compiled
    except ImportError as error:
        raise _unusable(f"numba cannot be imported: {error}") from error
    path, obstacle = folder()
    if not is_compiled(name):
        kept = f" at every start: compiled code cannot be kept {obstacle}; XDG_CACHE_HOME names another folder"
        log.info(COMPILING + kept * bool(obstacle))
    if path is None:
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
