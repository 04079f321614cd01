"""Changes of a scenario by key, also as texts such as ``armour.ceramic_thickness_mm=8``."""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

from armour.errors import InputError, Problem, refuse, suggestion
from armour.files import parse_toml
from armour.scenario.inputs import INPUTS, NAMING
from armour.scenario.keys import Parts, describe, key_name, leaves, not_a_key, parts_of

LISTED = "; a list is given whole, such as threat=[{...}]"


def changed(data: Mapping[str, Any], changes: Mapping[str, object], file: str = "scenario") -> dict[str, Any]:
    """Return the data of a scenario with other values by dotted key; a table is merged into an existing one.

    A key that goes below a value, or is given twice, is refused.
    """
    result = dict(data)
    set_values: dict[Parts, object] = {}
    problems = []
    for key, value in changes.items():
        try:
            parts = parts_of(key)
        except ValueError:
            problems.append(not_a_key(file, key))
            continue
        for leaf, leaf_value in leaves(value, parts):
            if leaf in set_values and set_values[leaf] != leaf_value:
                message = f"must be given once, found {describe(set_values[leaf])} and {describe(leaf_value)}"
                problems.append(Problem(file, key_name(leaf), message))
            set_values[leaf] = leaf_value
        if message := _put(result, parts, value):
            problems.append(Problem(file, key_name(parts), message))
    refuse(problems)
    return result


def _put(table: dict[str, Any], parts: Parts, value: object, above: Parts = ()) -> str:
    """Put a value into a table; return a message if the key goes below a value that is not a table, otherwise "".

    Tables that change are copied first, as those of the data may be shared.
    """
    name, *rest = parts
    present: Any = table.get(name, {} if rest else None)
    if rest and not isinstance(present, dict):
        hint = LISTED if isinstance(present, list) else suggestion(key_name((*above, *parts)), list(INPUTS))
        return f"must not go below {key_name((*above, name))}, which is {describe(present)}{hint}"
    if rest:
        table[name] = dict(present)
        return _put(table[name], (*rest,), value, (*above, name))
    if isinstance(value, Mapping) and isinstance(present, dict):
        table[name] = dict(present)
        for inner in value:
            _put(table[name], (inner,), value[inner])
    else:
        table[name] = value
    return ""


def changes_of(assignments: Iterable[str]) -> dict[str, Any]:
    """Return the values that assignments on the command line set, by dotted key.

    An assignment is a line of TOML; a value that is not TOML, or a number in place of a name, is taken as a text.
    """
    changes: dict[str, Any] = {}
    problems = []
    for assignment in assignments:
        key_and_value = _parsed(assignment)
        if key_and_value is None:
            listed = LISTED if "[" in assignment.partition("=")[0] else ""
            message = f"must be KEY=VALUE, such as impact.velocity_m_s=900, found {json.dumps(assignment)}{listed}"
            problems.append(Problem("command line", "--set", message))
            continue
        key, value = key_and_value
        if key in changes and changes[key] != value:
            message = f"must be given once, found {describe(changes[key])} and {describe(value)}"
            problems.append(Problem("command line", f"--set {key}", message))
        changes[key] = value
    refuse(problems)
    return changes


def _parsed(text: str) -> tuple[str, Any] | None:
    """Return key and value of an assignment; None if the text is not one."""
    for equals in re.finditer("=", text):
        try:
            key = key_name(parts_of(text[: equals.start()]))
        except ValueError:
            continue
        value = text[equals.end() :].strip()
        try:
            parsed = parse_toml(f"value = {value}", "")["value"]
            if "\n" in value:
                return None
            return key, value if key in NAMING and not isinstance(parsed, str) else parsed
        except InputError:
            return key, value
    return None
