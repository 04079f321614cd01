"""Functions of the core that another program has replaced."""

import sys
from pathlib import Path
from typing import Any

FOLDER = str(Path(__file__).parent)


def replaced_function() -> str:
    """Return the name of a function of the core that another program has replaced, or "".

    Constants are not compared.
    """
    for name, module in list(sys.modules.items()):
        if name.startswith("armour.core."):
            for attribute, value in vars(module).items():
                if callable(value) and not _is_own(value):
                    return name + "." + attribute
    return ""


def _is_own(value: Any) -> bool:
    """Return whether a function or class is one of the core, by its code, or is that of the standard library."""
    name = str(getattr(value, "__module__", ""))
    if name.startswith("armour.core."):
        return not hasattr(value, "__code__") or str(value.__code__.co_filename).startswith(FOLDER)
    if hasattr(value, "__origin__"):  # a type
        return True
    is_standard = name.partition(".")[0] in sys.stdlib_module_names
    return is_standard and getattr(sys.modules[name], value.__name__, None) is value


def is_unchanged() -> bool:
    """Return whether no function of the core is replaced; compiled code runs only then."""
    return not replaced_function()
