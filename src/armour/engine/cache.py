"""Compiled kernels, kept by numba in the user's cache folder from one process to the next.

Numba itself notices only changes to the file of the loops, so the folder is named after a digest of all code that is
compiled.  The folder is used only if no other user can write to it or replace it; otherwise every process compiles.
Without numba, with ``ARMOUR_COMPILED=0`` in the environment, or if a function of the core has been replaced, Python
runs the loops.
"""

import logging
import os
import shutil
import sys
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from threading import Lock

from platformdirs import user_cache_dir

from armour.core.replaced import replaced_function
from armour.engine import loops
from armour.files import exchangeable, make_private

Kernel = Callable[..., None]

PACKAGE = Path(__file__).resolve().parent.parent
COMPILING = "compiling the numerical code, which takes about ten seconds"
# Number of folders of other versions of the program that are kept.
OTHERS_KEPT = 4

log = logging.getLogger(__name__)
_lock = Lock()
_kernels: dict[str, Kernel] = {}
_logged: set[str] = set()


def digest(package: Path = PACKAGE) -> str:
    """Return a hash of the location and source of the core and the loops, and of the compiler's versions."""
    from importlib.metadata import version  # slow to import

    versions = [version(name) for name in ("numba", "llvmlite", "numpy")]
    # numba compiles again for each location: two installations would remove each other's compiled code.
    content = sha256(f"{package} {versions} {sys.version}".encode())
    engine = package / "engine"
    for path in [*sorted((package / "core").glob("*.py")), engine / "kernels.py", engine / "loops.py"]:
        content.update(sha256(path.name.encode() + path.read_bytes()).digest())
    return content.hexdigest()


def folder() -> tuple[Path | None, str]:
    """Make the folder of the compiled code and return it, or return None and why compiled code cannot be kept."""
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


def obstacle() -> str:
    """Return why the loops are not compiled, or "" if they are."""
    if os.environ.get("ARMOUR_COMPILED") == "0":
        return "ARMOUR_COMPILED is 0 in the environment"
    if name := replaced_function():
        return f"{name} is replaced"
    return "" if find_spec("numba") else "numba is not installed"


def is_compiled(name: str) -> bool:
    """Return whether the compiled code of a loop is there, unchanged since it was written, without importing numba."""
    path = None if obstacle() else folder()[0]
    with suppress(OSError):
        return path is not None and seal(path, name).read_text(encoding="utf-8") == content_of(path, name)
    return False


def seal(path: Path, name: str) -> Path:
    """Return the file that holds a hash of the compiled code of a loop: numba would run code that is damaged."""
    return path / f"{name}.sha256"


def content_of(path: Path, name: str) -> str:
    """Return a hash of the files of the compiled code of a loop."""
    return sha256(b"".join(file.read_bytes() for file in sorted(path.glob(f"*/*{name}*")))).hexdigest()


def is_loaded(name: str) -> bool:
    """Return whether this process has the compiled code of a loop."""
    return name in _kernels and not obstacle()


def kernel(name: str) -> Kernel:
    """Return a loop of `armour.engine.loops`, compiled or loaded once in a process, or in plain Python."""
    with _lock:
        reason = obstacle()
        if not reason and name not in _kernels:
            try:
                _kernels[name] = load(name)
            except Exception as error:  # any error of a numba that does not fit numpy, Python or the machine
                first_line, *_ = f"{error}\n".splitlines()
                reason = f"numba does not work: {first_line}"
                _kernels[name] = getattr(loops, name)
        if reason:
            log_once(logging.WARNING, f"computing in plain Python, about a hundred times slower: {reason}")
        loop: Kernel = getattr(loops, name) if reason else _kernels[name]
        return loop


def log_once(level: int, message: str) -> None:
    """Log a message unless this process has logged it before."""
    if message not in _logged:
        log.log(level, message)
        _logged.add(message)


def load(name: str) -> Kernel:
    """Load the compiled code of a loop, or compile it and keep the code; log the compiling."""
    from armour.engine.kernels import compiled

    path, hindrance = folder()
    whole = is_compiled(name)
    if not whole:
        kept = f" at every start: compiled code cannot be kept {hindrance}; XDG_CACHE_HOME names another folder"
        log_once(logging.INFO, COMPILING + kept * bool(hindrance))
    if path is None:
        return compiled(name)
    if not whole:
        for file in path.glob(f"*/*{name}*"):
            file.unlink(missing_ok=True)
    try:
        loop: Kernel = compiled(name, path)
    except Exception:  # a damaged file, or a full disk
        shutil.rmtree(path, ignore_errors=True)
        return compiled(name)
    with suppress(OSError):
        if not whole:
            seal(path, name).write_text(content_of(path, name), encoding="utf-8")
        other_versions = [version for version in path.parent.glob("kernels-*") if version != path]
        for version in sorted(other_versions, key=os.path.getmtime)[:-OTHERS_KEPT]:
            shutil.rmtree(version)
    return loop
