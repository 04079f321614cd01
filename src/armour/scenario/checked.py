"""Arguments of the public functions, checked by the types and bounds of their signatures."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from inspect import signature
from os import PathLike
from types import NoneType, UnionType
from typing import Annotated, Any, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from pydantic import PlainValidator, ValidationError, create_model

from armour.errors import InputError
from armour.scenario.keys import describe
from armour.scenario.sections import Section, problems_of

P = ParamSpec("P")
R = TypeVar("R")
Kind = TypeVar("Kind")

# What objects are called in messages, and the functions that make those of this project.
_WORDS: dict[object, str] = {str: "a text", Mapping: "a mapping", Callable: "a function", PathLike: "a path"}
_MAKERS = {
    "Scenario": "load_scenario",
    "Suite": "load_suite",
    "Tests": "read_tests",
    "Shots": "read_shots",
    "Library": "shipped_library",
    "SuiteResult": "validate",
    "CalibrationResult": "calibrate",
}


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Check the arguments of a function by its annotations; an InputError names the function and the argument.

    Numbers, words and tuples are pydantic's, with bounds as in ``Annotated[float, Field(ge=0.0)]``; of anything else,
    such as a Scenario or a Mapping, an object of the class must be given.
    """
    parameters = signature(function)

    @cache
    def model() -> type[Section]:
        # At the first call, as this takes longer than an import should.
        hints = get_type_hints(function, include_extras=True)
        kinds: dict[str, Any] = {name: (_kind(hints[name]), ...) for name in parameters.parameters if name in hints}
        return create_model(function.__name__, __base__=Section, **kinds)

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        given = parameters.bind(*args, **kwargs)
        given.apply_defaults()
        asked = {name: value for name, value in given.arguments.items() if name in model().model_fields}
        try:
            found = model().model_validate(asked)
        except ValidationError as error:
            raise InputError(problems_of(error, model(), function.__name__)) from None
        given.arguments |= {name: getattr(found, name) for name in asked}
        return function(*given.args, **given.kwargs)

    return call


def _kind(hint: Any) -> Any:
    """Return what pydantic is to check for an annotation."""
    members = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    kinds = [get_origin(member) or member for member in members]
    if not all(isinstance(kind, type) for kind in kinds) or {int, float, bool, Annotated} & {*kinds}:
        return hint
    return Annotated[Any, PlainValidator(lambda value: instance(value, *kinds))]


def instance(value: object, *kinds: type[Kind]) -> Kind:
    """Return a value that is of one of some classes; a ValueError says what it must be."""
    if isinstance(value, kinds):
        return value
    maker = _MAKERS.get(kinds[0].__name__)
    raise ValueError(f"must be {_called(kinds)}, found {_found(value)}{f'; {maker} makes one' if maker else ''}")


def _called(kinds: Sequence[type]) -> str:
    # A path may be given as a text.
    named = [kind for kind in kinds if kind is not NoneType and not (kind is str and PathLike in kinds)]
    return " or ".join(_WORDS.get(kind, f"a {kind.__name__}") for kind in named)


def _found(value: object) -> str:
    """Return a wrong argument in words; of an object, its type."""
    return describe(value) if value is None or isinstance(value, str | int | float) else f"a {type(value).__name__}"


def _names(given: object) -> tuple[str, ...]:
    if isinstance(given, Mapping) or not isinstance(given, Iterable):
        raise ValueError(f"must be a name or a sequence of names, found {_found(given)}")
    names = (given,) if isinstance(given, str) else tuple(given)
    for one in names:
        if not isinstance(one, str):
            raise ValueError(f"must be a sequence of names, found {_found(one)} in it")
        if names.count(one) > 1:
            raise ValueError(f"must not name anything twice, found {describe(one)} twice")
    return names


# A name or several different ones, which become a tuple.
Names = Annotated[str | Sequence[str], PlainValidator(_names)]
