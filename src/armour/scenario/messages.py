"""Checks of the arguments of public functions."""

import json
from collections.abc import Callable, Mapping
from os import PathLike
from types import NoneType
from typing import Any, cast

from armour.errors import InputError, Problem, refuse
from armour.scenario.keys import describe

# Types of arguments of the public functions, what they are called, and the functions that make objects of ours.
PATH = (str, PathLike)
_WORDS: dict[object, str] = {
    str: "a text",
    int: "a whole number",
    float: "a number",
    Mapping: "a mapping",
    Callable: "a function",
}
_WORDS |= {PATH: "a path", PathLike: "a path", NoneType: "None"}
_MAKERS = {"Scenario": "load_scenario", "Suite": "load_suite", "Tests": "read_tests", "Shots": "read_shots"}
_MAKERS |= {"Library": "shipped_library", "SuiteResult": "validate", "CalibrationResult": "calibrate"}


def check_types(function: str, **given: tuple[object, Any]) -> None:
    """Check the types of arguments of a public function, given by name: value, and a type or several."""
    refuse(
        Problem(function, name, f"must be {_called(kind)}, found {_found(value)}{_maker(value, kind)}")
        for name, (value, kind) in given.items()
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is int)
    )


def check_sequence(function: str, name: str, given: object) -> tuple[str, ...]:
    """Check that an argument of a public function is a name or a sequence of different names, and return them."""
    names: Any = (given,) if isinstance(given, str) else given
    if isinstance(names, Mapping) or not hasattr(names, "__iter__"):
        raise InputError([Problem(function, name, f"must be a name or a sequence of names, found {_found(given)}")])
    names = tuple(names)
    wrong = [one for one in names if not isinstance(one, str)]
    refuse(Problem(function, name, f"must be a sequence of names, found {_found(one)} in it") for one in wrong)
    refuse(
        Problem(function, name, f"must not name anything twice, found {describe(one)} twice")
        for one in dict.fromkeys(names)
        if names.count(one) > 1
    )
    return cast("tuple[str, ...]", names)


def _called(kind: Any) -> str:
    if kind in _WORDS:
        return _WORDS[kind]
    return " or ".join(map(_called, kind)) if isinstance(kind, tuple) else f"a {kind.__name__}"


def _found(value: object) -> str:
    """Return a wrong argument in words; of an object, its type."""
    known = value is None or isinstance(value, str | int | float)
    return describe(value) if known else f"a {type(value).__name__}"


def _maker(value: object, kind: Any) -> str:
    """Return which function makes what is wanted, "" if none does; a name or path given in its place, it may read."""
    maker = _MAKERS.get(getattr(kind, "__name__", ""), "")
    if maker.startswith(("load", "read")):
        return f"; {maker}({json.dumps(str(value))}) reads one" if isinstance(value, PATH) else f"; {maker} reads one"
    return f"; {maker} makes one" if maker else ""
