"""Functions of the core that another program has replaced."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = str(Path(__file__).parent)


def replaced_functions() -> Iterator[tuple[Any, str]]:
    """Yield each function of the core that another program has replaced, by its module and name.

    Constants are not compared.
    """
    for name, module in list(sys.modules.items()):
        if name.startswith("armour.core."):
            for attribute, value in list(vars(module).items()):
                if callable(value) and not _is_own(attribute, value):
                    yield module, attribute


def replaced_function() -> str:
    """Return the names of the functions of the core that another program has replaced, in words, or ""."""
    return " and ".join(f"{module.__name__}.{attribute}" for module, attribute in replaced_functions())


def _is_own(attribute: str, value: Any) -> bool:
    """Return whether a function or class is one of the core, by its code, or is that of the standard library."""
    if hasattr(value, "__origin__"):  # a type
        return True
    name = str(getattr(value, "__module__", ""))
    if getattr(value, "__name__", "") != attribute:
        return False
    if name.startswith("armour.core."):
        code = getattr(value, "__code__", None)
        return isinstance(value, type) or str(getattr(code, "co_filename", "")).startswith(FOLDER)
    is_standard = name.partition(".")[0] in sys.stdlib_module_names
    return is_standard and getattr(sys.modules[name], attribute, None) is value


def is_unchanged() -> bool:
    """Return whether no function of the core is replaced; compiled code runs only then."""
    return next(replaced_functions(), None) is None
