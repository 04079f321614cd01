"""Compiled kernels: from the user's cache, else compiled by numba, which is imported for nothing else.

The cache is kept by the contents of the core's files, numba's version and the processor.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from ctypes import CFUNCTYPE, byref, c_double, c_int32, c_int64, c_void_p
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from typing import Any

import llvmlite.binding as llvm

_AT, _I, _F = c_void_p, c_int64, c_double

# Arguments of the kernels; armour.engine.kernels has their names.
ARGUMENTS = {
    "impacts": (_I, _AT, _AT, _F, _F, _I, _AT, _AT),
    "ballistic_limits": (_I, _AT, _F, _F, _F, _F, _F, _I, _AT, _AT),
    "least_thicknesses": (_I, _AT, _AT, _F, _F, _F, _F, _F, _I, _AT, _AT),
}

_lock = Lock()


def digest(core: Path = Path(__file__).parent.parent / "core") -> str:
    """What tells the contents of the core's files, this numba and this processor from any other."""
    told = sha256(f"{llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}".encode())
    numba = find_spec("numba")
    assert numba is not None
    folders = numba.submodule_search_locations or []
    for path in [*(Path(folder) / "_version.py" for folder in folders), *sorted(core.glob("*.py"))]:
        told.update(path.read_bytes())
    return told.hexdigest()


def cache_folder() -> Path:
    """Folder of this user's compiled code, of these very files."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "armour" / digest()[:16]


def is_compiled() -> bool:
    """Whether an earlier process has left its compiled code."""
    folder = cache_folder()
    return all((folder / f"{name}.o").exists() for name in ARGUMENTS)


def kernel(name: str) -> Callable[..., None]:
    """A function of `armour.engine.kernels`, compiled; it lets other threads run meanwhile."""
    with _lock:
        return _linked(name)


@cache
def _linked(name: str) -> Callable[..., None]:
    code = llvm.JITLibraryBuilder().add_object_img(_object_code(name)).add_current_process().export_symbol(name)
    library = code.link(_linker(), name)
    call = CFUNCTYPE(c_int32, c_void_p, c_void_p, *ARGUMENTS[name])(library[name])

    def checked(*args: Any) -> None:
        nothing, error = c_void_p(), c_void_p()
        if call(byref(nothing), byref(error), *args) != 0:
            raise RuntimeError(f"compiled {name} failed")

    checked.library = library  # type: ignore[attr-defined]  # lives as long as what it holds
    return checked


@cache
def _linker() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler()


def _object_code(name: str) -> bytes:
    folder = cache_folder()
    try:
        return (folder / f"{name}.o").read_bytes()
    except OSError:
        from armour.engine.kernels import object_code

        codes = {each: object_code(each) for each in ARGUMENTS}
        for each, code in codes.items():
            _keep(folder / f"{each}.o", code)
        return codes[name]


def _keep(path: Path, code: bytes) -> None:
    """Write whole or not at all; a folder that cannot be written costs the next process its time."""
    part = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(code)
        part.replace(path)
    except OSError:
        with suppress(OSError):
            part.unlink()
