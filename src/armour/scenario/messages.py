"""Checked fields of the files, and pydantic's errors in the words of this project."""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError

from armour.errors import Problem, suggestion


class Section(BaseModel):
    """A table of a file: immutable, no key but the known ones, numbers that are numbers."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


def key_name(parts: Sequence[str | int]) -> str:
    """Dotted key as TOML writes it."""
    name = ""
    for part in parts:
        if isinstance(part, int):
            name += f"[{part}]"
        else:
            bare = re.fullmatch(r"[A-Za-z0-9_-]+", part)
            name += f".{part}" if bare else f".{json.dumps(part, ensure_ascii=False)}"
    return name.lstrip(".")


def describe(value: object) -> str:
    """What was found, in the words of TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, str):
        return f'the text "{value}"' if len(value) <= 40 else f'the text "{value[:37]}..."'
    return str(value)


_MUST = {
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than_equal": "must be at most {le:g}",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "string_type": "must be a text in quotes",
    "string_too_short": "must not be empty",
    "too_short": "must have at least {min_length} of them",
    "list_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "literal_error": "must be {expected}",
}


def problems_of(error: ValidationError, model: type[Section], file: str) -> list[Problem]:
    """Pydantic's errors as problems of the file that was validated against the model."""
    problems = []
    for detail in error.errors():
        # pydantic names the member of a union that it tried, here in angle brackets.
        parts = [part for part in detail["loc"] if part != NUMBER and not str(part).startswith("<")]
        context = detail.get("ctx", {})
        if detail["type"] == "extra_forbidden":
            message = "unknown key" + suggestion(str(parts[-1]), _known_keys(model, parts[:-1]))
        elif detail["type"] == "missing":
            message = "is missing and must be given"
        elif detail["type"] == "value_error":
            message = str(context["error"])
        else:
            one = detail["type"] == "too_short" and context["min_length"] == 1
            must = _MUST.get("string_too_short" if one else detail["type"])
            must = must.format(**context) if must else detail["msg"]
            message = f"{must}, found {describe(detail['input'])}"
        problems.append(Problem(file, key_name(parts), message))
    return problems


# Name under which a plain number is kept where a file may give a number or a table.
NUMBER = "value"


def _known_keys(model: Any, parts: Sequence[str | int]) -> list[str]:
    """Keys that the model knows in the table that the parts lead to."""
    named_freely = False
    for part in parts:
        if named_freely:
            named_freely = False
        elif model is not None and part in model.model_fields:
            annotation = model.model_fields[str(part)].annotation
            named_freely = get_origin(annotation) is dict
            model = _model_in(annotation)
        else:
            return []
    return list(model.model_fields) if model is not None else []


def _model_in(annotation: Any) -> Any:
    """The model within an annotation such as ``Model | None`` or ``dict[str, Model]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in getattr(annotation, "__args__", ()):
        found = _model_in(inner)
        if found is not None:
            return found
    return None
