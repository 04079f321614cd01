"""The modules that show and draw a result: they have the name of its class, and are imported when they are used."""

import re
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from typing import Any


def module_of(result: object, package: str) -> Any:
    """Return the module of a package, views or pictures, for a result; None for others, such as a history.

    A view has ``tables(result)``; where a result is written also ``csv(result)``.
    """
    words = re.findall("[A-Z][a-z]+", type(result).__name__.removesuffix("Result"))
    name = f"armour.reporting.{package}.{'_'.join(words).lower()}"
    return import_module(name) if find_spec(name) else None


def drawing_of(result: object, function: str = "draw", **changes: str) -> Callable[[Any], Any]:
    """Return what draws a result on a sheet by a function of its module, with changes, such as another title."""
    return lambda sheet: replace(getattr(module_of(result, "pictures"), function)(result, sheet), **changes)
