"""Base class and types of the sections of a file, and messages for the mistakes that pydantic finds in them."""

import ast
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import deepcopy
from functools import cache, reduce
from inspect import getsource
from itertools import pairwise
from math import inf
from operator import getitem
from typing import Annotated, Any, TypeVar, get_origin

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, ValidationInfo

from armour.errors import InputError, Problem, choices, point_hint, suggestion
from armour.scenario.keys import describe, key_name, upwards
from armour.units import key_hint

# Key of the number where a file may give a number or a table.
NUMBER = "value"
# Least positive number: a smaller one is a mistake, and dividing by it may overflow.
TINY = 1e-9
# Tags by which pydantic tells apart the members of unions.
TAGS = NUMBER_TAG, TEXT_TAG, LIST_TAG, RANGE_TAG = ("<number>", "<text>", "<list>", "<range>")
NumberOrText = Annotated[
    Annotated[float, Tag(NUMBER_TAG)] | Annotated[str, Tag(TEXT_TAG)],
    Discriminator(lambda value: TEXT_TAG if isinstance(value, str) else NUMBER_TAG),
]


AS_LIST, AS_RANGE = Tag(LIST_TAG), Tag(RANGE_TAG)
LIST_OR_RANGE = Discriminator(lambda value: RANGE_TAG if isinstance(value, dict | Section) else LIST_TAG)

SectionT = TypeVar("SectionT", bound="Section")
Item = TypeVar("Item")
# A list of a file, which becomes a tuple.
Items = Annotated[tuple[Item, ...], Field(strict=False)]


class Section(BaseModel):
    """Base class of the tables of a file: immutable, without unknown keys, strictly typed, with finite numbers."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)

    def __dir__(self) -> list[str]:
        """List the names for completion, without the public ones of pydantic."""
        return [name for name in super().__dir__() if name.startswith("_") or name not in vars(BaseModel)]

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        """Describe each key in the JSON Schema by its docstring."""
        schema = handler(core_schema)
        properties = handler.resolve_ref_schema(schema)["properties"]
        for section in cls.__mro__:
            if section in (Section, BaseModel):
                break
            for key, words in _docstrings(section).items():
                properties[key].setdefault("description", words)
        return schema


@cache
def _docstrings(section: type) -> dict[str, str]:
    """Return the docstring below each key of a class, from its source; {} for a class without one."""
    with suppress(OSError):
        body: Any = ast.parse(getsource(section)).body[0]
        return {
            ast.unparse(field.target): " ".join(ast.literal_eval(below.value).split())
            for field, below in pairwise(body.body)
            if isinstance(field, ast.AnnAssign) and isinstance(below, ast.Expr)
        }
    return {}


def above(key: str, *, or_equal: bool = False) -> AfterValidator:
    """Return a validator of a number that must be above that of an earlier key of its table or, if so given, equal."""

    def check(value: float | None, info: ValidationInfo) -> float | None:
        """Return the number unless it is too small."""
        low = info.data.get(key)
        if value is not None and low is not None and (value < low or (value == low and not or_equal)):
            must = f"must be {'at least' if or_equal else 'above'} {key}"
            raise ValueError(f"{must}, which is {low:g}, found {value:g}")
        return value

    return AfterValidator(check)


def _not_tiny(value: float) -> float:
    """Return a number unless it is almost 0; 0 itself is allowed."""
    if 0.0 < abs(value) < TINY:
        raise ValueError(f"must be at least {TINY:g}, found {value:g}")
    return value


NOT_TINY = AfterValidator(_not_tiny)


# Type of pydantic's error for an unknown key.
UNKNOWN_KEY = "extra_forbidden"
# Requirements by type of pydantic's error, where its own words are not plain.
_REQUIREMENTS = {
    "greater_than_equal": "must be at least {ge:g}",
    "less_than_equal": "must be at most {le:g}",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "string_type": "must be a text in quotes",
    "string_too_short": "must not be empty",
    "too_short": "must list at least {min_length} values",
    "too_long": "must list at most {max_length} values",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "bool_type": "must be true or false",
    "literal_error": "must be {expected}",
}


# Hints for keys that must be given even if that is not obvious.
MISSING_HINTS = {"impact": ", even if there is a [[threat]]", "armour.ceramic_thickness_mm": "; 0 for a bare plate"}


def problems_of(error: ValidationError, model: type[Section], file: str) -> list[Problem]:
    """Convert pydantic's errors in the data of a file, validated by a model, to problems in plain words."""
    problems = []
    for detail in error.errors():
        parts = _key_parts(detail)
        context = detail.get("ctx", {})
        if "expected" in context:
            context["expected"] = context["expected"].replace("'", '"')
        if detail["type"] == UNKNOWN_KEY:
            keys = _known_keys(model, parts[:-1])
            word, paths = str(parts[-1]), [*keys, *(_dotted_keys(model) if len(parts) == 1 else ())]
            hint = key_hint(word, paths) or suggestion(word, paths) or choices(word, keys)
            message = f"unknown key{hint}"
        elif detail["type"] == "missing":
            message = f"is missing and must be given{MISSING_HINTS.get(key_name(parts), '')}"
        elif detail["type"] == "value_error":
            message = str(context["error"])
        else:
            empty = detail["type"] == "too_short" and context["min_length"] == 1
            must = _REQUIREMENTS.get("string_too_short" if empty else detail["type"])
            must = must.format(**context) if must else detail["msg"].replace("Input should", "must")
            value = describe(detail["input"])
            message = f"{must}, found {value if empty else context.get('actual_length', value)}{_hint(detail)}"
        problems.append(Problem(file, key_name(parts), message))
    return problems


def _key_parts(detail: Any) -> list[str | int]:
    """Return the parts of the key of one of pydantic's errors, without the tags that it adds for members of unions."""
    parts = [part for part in detail["loc"] if part not in TAGS]
    return parts[:-1] if parts[-1:] == [NUMBER] and detail["type"] != UNKNOWN_KEY else parts


def every_problem(
    error: ValidationError, model: type[Section], data: Any, file: str, read: Callable[[Any], object]
) -> list[Problem]:
    """Return the problems of pydantic's error, and further ones that are found in the data without the keys at fault.

    `model` is the class by which the data of the `file` are validated.  `read` validates such data, and raises an error
    if they are wrong.
    """
    problems = problems_of(error, model, file)
    remaining_data, tables = deepcopy(data), set[str]()
    for detail in error.errors():
        *above, last = _key_parts(detail) or [""]
        if detail["type"] != UNKNOWN_KEY:
            tables |= {*upwards(key_name(above))}
        with suppress(KeyError, TypeError):  # the table may have been removed with another mistake
            table: Any = reduce(getitem, above, remaining_data)
            if isinstance(table, dict):
                table.pop(last, None)
    if remaining_data == data:
        return problems
    try:
        read(remaining_data)
        return problems
    except ValidationError as later_error:
        further: Sequence[Problem] = problems_of(later_error, model, file)
    except InputError as later_error:
        further = later_error.problems
    # A problem in a table from which a wrong value was removed may just come of the removal.
    reported = {problem.key for problem in problems} | tables
    return problems + [problem for problem in further if not {*upwards(problem.key)[:2]} & reported]


def _hint(detail: Any) -> str:
    """Return the end of a message, a hint at what is probably meant by a wrong value; "" if nothing is known.

    It hints at a word, the form of a list or a number, or a probability that is given in per cent.
    """
    value, context = detail["input"], detail.get("ctx", {})
    if detail["type"] == "float_type":
        return point_hint(value)
    if detail["type"] == "literal_error":
        return suggestion(str(value), re.findall('"(.*?)"', context["expected"]))
    if detail["type"] in ("list_type", "tuple_type") and isinstance(value, dict):
        return "; write its heading in double brackets"
    if detail["type"] == "list_type" and LIST_TAG in detail["loc"]:
        return "; a range is a table such as { min = 4.0, max = 12.0 }"
    most = context.get("le", context.get("lt", inf))
    return f"; did you mean {value / 100.0:g}?" if most <= 1.0 < 50.0 <= value <= 100.0 * most else ""


def validated(model: type[SectionT], data: object, file: str) -> SectionT:
    """Return data as the sections of a model; raise an InputError with every mistake, which names the `file`."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise InputError(problems_of(error, model, file)) from None


def _dotted_keys(model: type[Section]) -> list[str]:
    """Return the keys of all sections of a model, with the section, such as "armour.backing_thickness_mm"."""
    sections = ((name, model_in(field.annotation)) for name, field in model.model_fields.items())
    return [f"{name}.{key}" for name, section in sections if section for key in section.model_fields]


def _known_keys(model: Any, parts: Sequence[str | int]) -> list[str]:
    """Return the keys that a model knows in one of its tables, given the parts of the key of this table."""
    is_free_name = False
    for part in parts:
        if isinstance(part, str) and is_free_name:
            is_free_name = False
        elif isinstance(part, str):
            annotation = model.model_fields[part].annotation
            model, is_free_name = model_in(annotation), get_origin(annotation) is dict
    return list(model.model_fields)


def model_in(annotation: Any) -> Any:
    """Return the model within an annotation such as ``Model | None`` or ``dict[str, Model]``; None if there is none."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in getattr(annotation, "__args__", ()):
        if (model := model_in(inner)) is not None:
            return model
    return None
