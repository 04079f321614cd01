"""The functions that show a result, `tables_of` and `draw`, which `functools.singledispatch` chooses by its class."""

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatch
from importlib import import_module
from typing import Any

from armour.analysis.results import Result
from armour.reporting.table import Table


@singledispatch
def tables_of(result: Result) -> list[Table | str]:
    """Return all tables of a result, with notes on them."""
    raise NotImplementedError(type(result).__name__)


@singledispatch
def draw(result: Result, sheet: Any) -> Any:
    """Draw a result on a sheet, and return the picture; see `armour.reporting.pictures.drawing`."""
    raise NotImplementedError(type(result).__name__)


# Packages with a module for each package of results: views/design.py shows those of armour/design.
VIEW_PACKAGES = {tables_of: "views", draw: "pictures"}


def by_result(function: Any, result: object) -> Any:
    """Return one of the functions above for the class of a result, from a module that is imported now; None without."""
    import_module(f"armour.reporting.{VIEW_PACKAGES[function]}.{type(result).__module__.split('.')[1]}")
    chosen = function.dispatch(type(result))
    return None if chosen is function.dispatch(object) else chosen


def drawing_of(result: object, **changes: str) -> Callable[[Any], Any]:
    """Return what draws a result on a sheet, with changes, such as another title."""
    return lambda sheet: replace(by_result(draw, result)(result, sheet), **changes)
