"""Arguments of the public functions, checked by their signatures."""

import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import cache, wraps
from inspect import signature
from os import PathLike
from sys import float_info
from types import NoneType, UnionType
from typing import Annotated, Any, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from pydantic import PlainValidator, create_model

from armour.foreign import Rows, items, plain
from armour.scenario.keys import describe
from armour.scenario.sections import Section, validated

P = ParamSpec("P")
R = TypeVar("R")
Kind = TypeVar("Kind")

# Treatment of floating-point errors that numpy and scipy start with, by module.
USUAL_ERRORS = {
    "numpy": {"divide": "warn", "over": "warn", "under": "ignore", "invalid": "warn"},
    "scipy.special": {"all": "ignore"},
}
# Hints on the functions that make an object from a file, by the name of its class.
_HINTS = {"Scenario": "; load_scenario makes one", "Tests": "; read_tests makes one", "Shots": "; read_shots makes one"}
# Words for classes in messages.
_WORDS: dict[object, str] = {str: "a text", Mapping: "a mapping", Callable: "a function", PathLike: "a path"}


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Check the arguments of a function by its annotations; an InputError names the function and the argument.

    Numbers, words and tuples are checked by pydantic, with bounds as in ``Annotated[float, Field(ge=0.0)]``; any other
    argument, such as a Scenario or a Mapping, must be an object of its class.
    """
    parameters = signature(function)

    @cache
    def model() -> type[Section]:
        """Return a class with a key for each annotated argument, which validates the arguments."""
        # Made at the first call, as this takes longer than an import should.
        hints = get_type_hints(function, include_extras=True)
        kinds: dict[str, Any] = {name: (_kind(hints[name]), ...) for name in parameters.parameters if name in hints}
        return create_model(function.__name__, __base__=Section, **kinds)

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        """Call the function with its arguments checked, and converted as their types require."""
        bound = None
        with suppress(TypeError):
            bound = parameters.bind(*args, **kwargs)
        if bound is None:
            # Python's own message names the function.
            return function(*args, **kwargs)
        bound.apply_defaults()
        annotated = {name: plain(value) for name, value in bound.arguments.items() if name in model().model_fields}
        bound.arguments |= dict(validated(model(), annotated, function.__name__))
        with usual_errors():
            return function(*bound.args, **bound.kwargs)

    # Help shows types without bounds, which the docstring states.  The class of a method does not exist yet.
    hints = {} if "." in function.__qualname__ else get_type_hints(function)
    shown = [item.replace(annotation=hints.get(name, item.annotation)) for name, item in parameters.parameters.items()]
    call.__signature__ = parameters.replace(parameters=shown)  # type: ignore[attr-defined]
    return call


@contextmanager
def usual_errors() -> Iterator[None]:
    """Make a context in which numpy and scipy treat floating-point errors as usual, whatever the caller has set."""
    with ExitStack() as stack:
        for name, usual in USUAL_ERRORS.items():
            # Nothing is imported for this: nothing is set in what is not imported.
            if module := sys.modules.get(name):
                stack.enter_context(module.errstate(**usual))
        yield


def _kind(hint: Any) -> Any:
    """Return the annotation by which pydantic checks an argument with this type hint.

    It is the hint itself for numbers, words and tuples; for classes, that the argument is an instance of one of them.
    """
    members = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    kinds = [get_origin(member) or member for member in members]
    if not all(isinstance(kind, type) for kind in kinds) or {int, float, bool, Annotated} & {*kinds}:
        return hint
    return Annotated[Any, PlainValidator(lambda value: instance(value, *kinds))]


def instance(value: object, *kinds: type[Kind]) -> Kind:
    """Return a value if it is an instance of one of the classes `kinds`; otherwise raise a ValueError."""
    if isinstance(value, kinds):
        return value
    # A path may be given as a text.
    listed = [kind for kind in kinds if kind is not NoneType and not (kind is str and PathLike in kinds)]
    words = " or ".join(_WORDS.get(kind, f"a {kind.__name__}") for kind in listed)
    raise ValueError(f"must be {words}, found {_in_words(value)}{_HINTS.get(kinds[0].__name__, '')}")


def _in_words(value: object) -> str:
    """Describe a wrong argument: its value if it is None, a text or a number, otherwise its type."""
    return describe(value) if value is None or isinstance(value, str | int | float) else f"a {type(value).__name__}"


def several(argument: object, is_right: Callable[[Any], bool], must: str) -> list[Any]:
    """Return the items of a sequence, an array or a column if `is_right` holds for each; otherwise raise a ValueError.

    Its message begins with `must`, which says what the argument must be, as in "must be a sequence of names".
    """
    try:
        listed = items(argument)
    except TypeError:
        raise ValueError(f"{must}, found {_in_words(argument)}") from None
    for item in listed:
        if not is_right(item):
            raise ValueError(f"{must}, found {describe(item)} in it")
    return listed


def is_name(item: object) -> bool:
    """Return whether an item is a text."""
    return isinstance(item, str)


def is_number(item: object) -> bool:
    """Return whether an item is a finite number."""
    return isinstance(item, int | float) and not isinstance(item, bool) and abs(item) <= float_info.max


def _names(argument: object) -> tuple[str, ...]:
    """Return an argument that is a name, or several different names, as a tuple; else raise a ValueError."""
    must = "must be a name or a sequence of names"
    listed = [argument] if isinstance(argument, str) else several(argument, is_name, must)
    for name, count in Counter(listed).items():
        if count > 1:
            raise ValueError(f"must not name anything twice, found {describe(name)} twice")
    return tuple(listed)


def _array(argument: Any) -> Any:
    """Return an argument that is a number, or an array of numbers, as an array of floats; else raise a ValueError."""
    import numpy as np  # slow to import

    def nested(value: Any) -> Any:
        """Return numbers as floats, and anything with items as nested lists of them."""
        value = plain(value)
        is_one = isinstance(value, int | float) and not isinstance(value, bool)
        return float(value) if is_one else list(map(nested, items(value)))

    with suppress(TypeError, ValueError, OverflowError):
        return np.array(nested(argument), dtype=np.float64)
    raise ValueError(f"must be a number or an array of numbers, found {_in_words(argument)}")


# A name, or several different names, as a tuple.
Names = Annotated[str | Iterable[str], PlainValidator(_names)]
# A number or an array of numbers, as an array of floats; NaN where one is missing.
FloatOrArray = Annotated[Any, PlainValidator(_array)]
# A table, which is checked when it is read.
Table = Annotated[str | PathLike[str] | Rows, PlainValidator(lambda table: table)]
