"""Changes of a scenario by key, also as texts such as ``armour.ceramic_thickness_mm=8``."""

import json
import tomllib
from collections.abc import Iterable, Mapping
from copy import deepcopy
from typing import Any

from armour.errors import InputError, Problem
from armour.files import nested_too_deeply


def changed(data: Mapping[str, Any], changes: Mapping[str, object]) -> dict[str, Any]:
    """Return the data of a scenario with other values by dotted key; a table is merged into an existing one."""
    result = deepcopy(dict(data))
    for key, value in changes.items():
        *sections, last = key.split(".")
        table = result
        for section in sections:
            table = table.setdefault(section, {})
            if not isinstance(table, dict):
                break  # the validation reports that this must be a table
        else:
            _put(table, last, value)
    return result


def _put(table: dict[str, Any], key: str, value: object) -> None:
    there = table.get(key)
    if isinstance(value, Mapping) and isinstance(there, dict):
        for inner in value:
            _put(there, inner, value[inner])
    else:
        table[key] = deepcopy(value)


def changes_of(assignments: Iterable[str]) -> dict[str, Any]:
    """Return the changes that assignments on the command line make, as tables within tables.

    An assignment is a line of TOML; a value that is not TOML is taken as a text.
    """
    changes: dict[str, Any] = {}
    problems = []
    for assignment in assignments:
        found = _parsed(assignment)
        if found is None:
            message = f"must be KEY=VALUE, such as impact.velocity_m_s=900, found {json.dumps(assignment)}"
            problems.append(Problem("command line", "--set", message))
        else:
            changes = changed(changes, found)
    if problems:
        raise InputError(problems)
    return changes


def changes_of_values(values: Mapping[str, float]) -> dict[str, Any]:
    """Return the changes that numbers by TOML key make, as tables within tables."""
    changes: dict[str, Any] = {}
    problems = []
    for key, value in values.items():
        try:
            changes = changed(changes, tomllib.loads(f"{key} = {float(value)!r}"))
        except tomllib.TOMLDecodeError:
            problems.append(Problem("sweep", key, "must be a key of the scenario"))
    if problems:
        raise InputError(problems)
    return changes


def _parsed(text: str) -> dict[str, Any] | None:
    """Return the data of an assignment; None if the text is not one."""
    key, equals, value = text.partition("=")
    for line in (text, f"{key}{equals}{json.dumps(value.strip())}"):
        try:
            data = tomllib.loads(line) if equals and "\n" not in line else None
            return None if nested_too_deeply(data) else data
        except (tomllib.TOMLDecodeError, RecursionError):
            continue
    return None
