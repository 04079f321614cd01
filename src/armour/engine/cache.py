"""Compiled kernels, kept by numba in the user's cache folder from one process to the next.

Numba would load whatever is in its folder.  The folder is therefore named after a digest of the processor and of all
code that is compiled.  It is used only if it belongs to this user or to root, and no other user can write to it or
replace it.  It must not be in a work tree or in the current folder, since these may be somebody else's.  Without numba,
with ``ARMOUR_COMPILED=0`` in the environment, or if something of the core has been replaced, Python runs the loops.
"""

import logging
import os
import platform
import re
import shutil
import sys
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from importlib.util import find_spec
from itertools import takewhile
from pathlib import Path
from threading import Lock

from platformdirs import user_cache_dir

from armour.core.replaced import is_unchanged, replaced_in_words
from armour.engine import loops
from armour.files import exchangeable, is_trusted, reason

Kernel = Callable[..., None]

PACKAGE_FOLDER = Path(__file__).resolve().parent.parent
COMPILING = "compiling the numerical code, which takes about ten seconds"
# Lines of /proc/cpuinfo that tell the type of the processor, on several architectures.
TYPE = re.compile(r"(vendor_id|cpu family|model|flags|CPU [a-z]+|Features|cpu|isa|uarch)\s*:")
# Names of which one is in the root of a work tree.
VERSIONED = (".git", ".hg", ".jj", ".svn")
# Number of folders of compiled code of other versions of the program that are kept.
OTHERS_KEPT = 4

log = logging.getLogger(__name__)
_lock = Lock()
_kernels: dict[str, Kernel] = {}
_logged: set[str] = set()


def digest(package: Path = PACKAGE_FOLDER) -> str:
    """Return a hash of the core and the loops, their location, the versions of the compiler, and the processor."""
    from importlib.metadata import version  # slow to import

    versions = [version(name) for name in ("numba", "llvmlite", "numpy")]
    # numba compiles again for each location: two installations would remove each other's compiled code.
    content = sha256(os.fsencode(f"{package} {versions} {sys.version} {processor()}"))
    engine = package / "engine"
    for path in [*sorted((package / "core").glob("*.py")), engine / "kernels.py", engine / "loops.py"]:
        content.update(sha256(path.name.encode() + path.read_bytes()).digest())
    return content.hexdigest()


def processor() -> list[str]:
    """Describe the processor that numba compiles for, without importing numba: as the environment says, or this one."""
    told = [os.environ.get(f"NUMBA_CPU_{name}", "") for name in ("NAME", "FEATURES")]
    if told[0].lower() != "generic":
        with suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as file:
            told += [line for line in takewhile(str.strip, file) if TYPE.match(line)]
    return [platform.machine(), *told]


def folder() -> tuple[Path | None, str]:
    """Return the folder for compiled code, and why nothing can be written to it, "" if it can.

    The reason completes "compiled code cannot be kept".  The folder is created if it is missing.  It is None if there
    is no safe one: it would be in a project, or other users could change it.
    """
    try:
        place = Path(user_cache_dir("armour", appauthor=False))
        project = project_around(place)
    except (OSError, RuntimeError):  # RuntimeError: no home; older versions of platformdirs return a relative path
        place, project = Path(), ""
    path = place / f"kernels-{digest()}"
    if not path.is_absolute():
        return None, "without a user cache directory"
    if project:
        return None, f"in {place}, which is in {project}"
    with suppress(OSError):
        place.parent.mkdir(mode=0o755, parents=True, exist_ok=True)
        place.mkdir(mode=0o755, exist_ok=True)
        path.mkdir(mode=0o700, exist_ok=True)
    with suppress(OSError):
        if exchangeable(place.parent, 0o022, by_owners=True) or not (is_trusted(place) and is_trusted(path)):
            return None, f"in {place}, which other users can change"
        return path, "" if os.access(path, os.W_OK) else f"in {place}, which cannot be written"
    return None, f"in {place}, which cannot be written"


def project_around(place: Path) -> str:
    """Return the work tree or current folder that contains a folder and may be somebody else's, in words, or "".

    The user's home, and the folders that contain it, are never somebody else's.
    """
    own = {Path(place.anchor)}
    with suppress(OSError, RuntimeError):  # RuntimeError: no home
        home = Path.home().resolve()
        own |= {home, *home.parents}
    real = Path(os.path.realpath(place))
    for folder in (place, *place.parents, real, *real.parents):
        if folder not in own and folder == Path.cwd():
            return "the current folder"
        if folder not in own and any(os.path.exists(folder / name) for name in VERSIONED):
            return f"the work tree {folder}"
    return ""


def obstacle() -> str:
    """Return the reason why the loops cannot be compiled, or "" if they can."""
    if os.environ.get("ARMOUR_COMPILED") == "0":
        return "ARMOUR_COMPILED is 0 in the environment"
    if name := replaced_in_words():
        return f"{name} replaced"
    return "" if find_spec("numba") else "numba is not installed"


def is_compiled(name: str) -> bool:
    """Return whether there is compiled code of a loop, unchanged since it was written; this does not import numba."""
    path = None if obstacle() else folder()[0]
    with suppress(OSError):
        return (
            path is not None
            and all(map(is_trusted, [seal(path, name), *files_of(path, name)]))
            and seal(path, name).read_text(encoding="utf-8") == content_of(path, name)
        )
    return False


def seal(path: Path, name: str) -> Path:
    """Return the file with a hash of the compiled code of a loop; numba itself would run damaged code."""
    return path / f"{name}.sha256"


def files_of(path: Path, name: str) -> list[Path]:
    """Return the files of the compiled code of a loop."""
    return sorted(path.glob(f"*.{name}-*"))


def content_of(path: Path, name: str) -> str:
    """Return a hash of the files of the compiled code of a loop."""
    return sha256(b"".join(file.read_bytes() for file in files_of(path, name))).hexdigest()


def is_loaded(name: str) -> bool:
    """Return whether this process has the compiled code of a loop."""
    return name in _kernels and not obstacle()


def kernel(name: str) -> Kernel:
    """Return a loop of `armour.engine.loops`: compiled, once in a process, or in plain Python if that fails."""
    with _lock:
        reason = obstacle()
        if not reason and name not in _kernels:
            try:
                _kernels[name] = load(name)
            except Exception as error:  # any error of a numba that does not fit numpy, Python or the machine
                first_line, *_ = f"{error}\n".splitlines()
                reason = f"numba does not work: {first_line}"
                _kernels[name] = getattr(loops, name)
        if reason and is_unchanged():  # `armour.scenario.checked` names what is replaced
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
    if path is None or (hindrance and not whole):
        return compiled(name)
    try:
        if whole:
            return compiled(name, path)
        path.chmod(0o700)
        for file in files_of(path, name):
            file.unlink(missing_ok=True)
        loop: Kernel = compiled(name, path)
        # Others may read what they cannot change: root compiles for the users of a container image.
        seal(path, name).write_text(content_of(path, name), encoding="utf-8")
        for file in [seal(path, name), *files_of(path, name)]:
            file.chmod(0o644)
        path.chmod(0o755)
    except Exception as error:  # a damaged file, or a full disk
        if isinstance(error, OSError):
            log_once(logging.WARNING, f"{path.parent}: compiled code cannot be kept: {reason(error)}")
        shutil.rmtree(path, ignore_errors=True)
        return compiled(name)
    with suppress(OSError):
        other_versions = [version for version in path.parent.glob("kernels-*") if version != path]
        for version in sorted(other_versions, key=os.path.getmtime)[:-OTHERS_KEPT]:
            shutil.rmtree(version)
    return loop
