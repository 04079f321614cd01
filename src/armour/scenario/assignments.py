"""Changes of a scenario by key: written as texts, such as ``armour.ceramic_thickness_mm=8``, or as numbers."""

import json
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from armour.errors import InputError, Problem
from armour.scenario.loading import changed


def changes_of(assignments: Iterable[str]) -> dict[str, Any]:
    """Return the changes that assignments on the command line make, as tables within tables.

    An assignment is a line of TOML; a value that is not TOML is taken as a text.

    Raises
    ------
    InputError
        With every text that is not an assignment.
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
    """Return the changes that numbers by TOML key make, as tables within tables.

    Raises
    ------
    InputError
        With every key that is not one.
    """
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
    """Return the data of an assignment; None where it is not one."""
    key, equals, value = text.partition("=")
    for line in (text, f"{key}{equals}{json.dumps(value.strip())}"):
        try:
            return tomllib.loads(line) if equals and "\n" not in line else None
        except (tomllib.TOMLDecodeError, RecursionError):
            continue
    return None
