"""Functions and constants of the core that another program has replaced."""

import sys
from collections.abc import Iterator
from types import ModuleType

# Each name of each module of the core, with its value, and its code if that is a function.
_originals: dict[tuple[ModuleType, str], tuple[object, object]] = {}


def remember() -> None:
    """Take the names of the core, as they are now, for its own; the core does so when it is imported."""
    modules = [value for value in vars(sys.modules[__package__]).values() if isinstance(value, ModuleType)]
    for module in modules:
        for name, value in vars(module).items():
            if not name.startswith("__"):
                _originals[module, name] = value, _code(value)


def _code(value: object) -> object:
    """Return the code of a function, or None: other code can be put into a function, which then stays the same."""
    return getattr(value, "__code__", None)


def replaced_names() -> Iterator[tuple[ModuleType, str]]:
    """Yield each function and constant of the core that another program has replaced, by its module and name."""
    for (module, name), (original, code) in _originals.items():
        value = getattr(module, name, None)
        if value is not original or _code(value) is not code:
            yield module, name


def replaced_in_words() -> str:
    """Return the names of what another program has replaced in the core, in words, or ""; a reload replaces many."""
    names = [f"{module.__name__}.{name}" for module, name in replaced_names()]
    return " and ".join(names if len(names) < 5 else [*names[:3], f"{len(names) - 3} more"])


def is_unchanged() -> bool:
    """Return whether nothing of the core is replaced; compiled code runs only then."""
    return next(replaced_names(), None) is None
