"""Load the loops of `armour.engine.loops`, compiled when the program was built: a library that needs only that of C.

`hatch_build.py` makes it.  Its name has a hash of the sources that it is made from and one of its content: a library of
other sources, or a damaged one, is not used.  Without it, and where equations are changed, Python runs the loops.
"""

import logging
from collections.abc import Callable, Iterator
from contextlib import suppress
from ctypes import CDLL, byref, c_double, c_int64, c_void_p
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from armour.engine import loops
from armour.engine.changes import changed_names

FOLDER = Path(__file__).parent
# The code that is compiled.
SOURCES = (*sorted(FOLDER.parent.glob("core/*.py")), FOLDER / "loops.py")
NOT_COMPILED = "it is not compiled; install it where there is a C compiler or, in a clone, run make build"

log = logging.getLogger(__name__)


def library_name(content: bytes) -> str:
    """Return the name that the file of a library with this content must have, given the sources as they are."""
    sources = sha256(b"".join(sha256(path.read_bytes()).digest() for path in SOURCES))
    return f"compiled-{sources.hexdigest()[:16]}-{sha256(content).hexdigest()[:16]}.so"


def find_library() -> Path | None:
    """Return the file of the compiled code; None if there is none that is made from these sources and undamaged."""
    for file in FOLDER.glob("compiled-*.so"):
        if file.name == library_name(file.read_bytes()):
            return file
    return None


@cache
def library() -> CDLL | None:
    """Load the compiled code; None if there is none for these sources and this system."""
    with suppress(OSError):
        if file := find_library():
            return CDLL(str(file))
    return None


def kernel(name: str, is_long: bool) -> Callable[..., None]:
    """Return a loop of `armour.engine.loops`, given its name: the compiled one if that can be used.

    If it cannot and the computation `is_long`, a warning says so.
    """
    changed = changed_names()
    code = None if changed else library()
    if code is None:
        if is_long:
            _warn(f"{changed} changed" if changed else NOT_COMPILED)
        loop: Callable[..., None] = getattr(loops, name)
        return loop
    function = getattr(code, f"armour_{name}")

    def call(*arguments: Any) -> None:
        # numba passes two places for results first, of which these loops use none.
        function(byref(c_void_p()), byref(c_void_p()), *(word for value in arguments for word in _numba_words(value)))

    return call


@cache
def _warn(reason: str) -> None:
    """Warn, once for each reason, that plain Python computes."""
    log.warning("computing in plain Python, about a hundred times slower: %s", reason)


def _numba_words(value: Any) -> Iterator[Any]:
    """Yield the machine words by which numba passes a value: an array, a number or a tuple of them."""
    if isinstance(value, tuple):
        for item in value:
            yield from _numba_words(item)
    elif isinstance(value, int | float):
        yield c_int64(value) if isinstance(value, int) else c_double(value)
    else:
        yield from (c_void_p(), c_void_p(), c_int64(value.size), c_int64(value.itemsize), c_void_p(value.ctypes.data))
        yield from map(c_int64, (*value.shape, *value.strides))
