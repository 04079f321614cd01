"""Changes of a scenario written as texts, such as ``armour.ceramic_thickness_mm=8``."""

import json
import tomllib
from collections.abc import Iterable
from typing import Any

from armour.errors import InputError, Problem
from armour.scenario.loading import changed


def changes_of(assignments: Iterable[str], file: str = "command line", key: str = "--set") -> dict[str, Any]:
    """Return the changes that assignments make, as tables within tables.

    An assignment is a line of TOML; a value that is not TOML is taken as a text.

    Parameters
    ----------
    assignments : iterable of str
    file, key : str
        Where the assignments come from, for messages.

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
            problems.append(Problem(file, key, message))
        else:
            changes = changed(changes, found)
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
