"""Show a result as tables, as a line or as a picture, by the implementation registered for its class.

`tables_of`, `line_of` and `draw` are functions of `functools.singledispatch`; views and pictures register with them.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatch
from importlib import import_module
from typing import Any

from armour.analysis.results import Result
from armour.reporting.table import Table


@singledispatch
def tables_of(result: Result) -> list[Table | str]:
    """Return what shows a result in a terminal or a report: tables, and lines before, between and after them.

    If its `question` has `every_row`, which the option -v sets, these are all rows and details, else the main ones.
    """
    raise NotImplementedError(type(result).__name__)


@singledispatch
def line_of(result: Result) -> str:
    """Return the answer of a result in a line; see `in_a_line`."""
    raise NotImplementedError(type(result).__name__)


@singledispatch
def draw(result: Result, sheet: Any) -> Any:
    """Draw a result on a sheet and return the picture; see `Sheet` and `Picture` in `reporting.pictures.drawing`."""
    raise NotImplementedError(type(result).__name__)


# Packages of the implementations.  Each has a module for each package of results: views/design.py for armour/design.
VIEW_PACKAGES = {tables_of: "views", line_of: "views", draw: "pictures"}


def by_result(function: Any, result: object) -> Any:
    """Return the implementation of `tables_of`, `line_of` or `draw` for a result, after importing its module.

    Return None if the class has none, such as no picture.
    """
    import_module(f"armour.reporting.{VIEW_PACKAGES[function]}.{type(result).__module__.split('.')[1]}")
    chosen = function.dispatch(type(result))
    return None if chosen is function.dispatch(object) else chosen


def in_a_line(result: Result) -> str:
    """Return the answer of a result in a line, the same in its tables, its picture, its report and its `repr`."""
    chosen = by_result(line_of, result)
    return "" if chosen is None else str(chosen(result))


def headline(result: Result) -> str:
    """Return the answer of a result in a line that begins with a capital letter."""
    line = in_a_line(result)
    return line[:1].upper() + line[1:]


def drawing_of(result: object, **changes: str) -> Callable[[Any], Any]:
    """Return a function that draws a result on a sheet; `changes` replace fields of the picture, such as its title."""
    return lambda sheet: replace(by_result(draw, result)(result, sheet), **changes)
