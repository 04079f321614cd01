"""Functions of the core that another program has replaced."""

import sys

# Where the functions and classes in the modules of the core are from.
PACKAGES = ("armour.core.", "builtins.", "collections.", "enum.", "math.", "typing.")


def replaced_function() -> str:
    """Return the name of a function of the core that another program has replaced, or ""."""
    for name, module in list(sys.modules.items()):
        if name.startswith("armour.core."):
            for attribute, value in vars(module).items():
                if callable(value) and not (str(getattr(value, "__module__", "")) + ".").startswith(PACKAGES):
                    return name + "." + attribute
    return ""


def is_unchanged() -> bool:
    """Return whether no function of the core is replaced; compiled code runs only then."""
    return not replaced_function()
