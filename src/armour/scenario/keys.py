"""Keys and values of TOML files: how keys are written, where they are in a file, and changes of a scenario by key."""

import json
import re
import tomllib
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

from armour.errors import InputError, Problem, mistake, refuse, suggestion
from armour.files import parse_toml
from armour.foreign import items, plain
from armour.scenario.inputs import INPUTS, NAMES, NAMING

Parts = tuple[str, ...]
# More parts than any key of a scenario has; deeper tables exhaust the stack.
MAX_PARTS = 20
# Sections and keys that every computation reads or shows.  Entries of the library have a check of their own.
ALWAYS = ("model", "solver", "title", "library")
# Greatest length of a key, longer than any; the parser of TOML would take long on a key of thousands of parts.
MAX_KEY = 5000
LISTED = "; a list is given whole, such as threat=[{...}]"
# Keys, and indices of lists.
KeyPath = tuple[str | int, ...]


class Whole(dict[str, Any]):
    """A table that replaces an existing one; any other table is merged into it."""


def plain_name(name: str) -> str:
    """Return a name in the form in which names are compared, equal for those that look the same, as "AD85 " and "AD85".

    A no-break space is a space, and "é" may be typed as one character or as two.
    """
    return " ".join(unicodedata.normalize("NFKC", name).split())


def with_plain_keys(value: Any, file: str, parts: KeyPath = ()) -> Any:
    """Return a copy of a value as Python's own, with the keys of its tables as `plain_name` has them.

    A section becomes a `Whole` table of the values that it was given, which are thus validated again.  An InputError
    names the `file`, and a key that is given twice after `parts`, those of the key of the value.
    """
    if hasattr(value, "model_dump"):  # a section, of pydantic, which is slow to import
        value = Whole(value.model_dump(exclude_unset=True, warnings=False))
    if not isinstance(value, Mapping):
        value = plain(value)
        if isinstance(value, str | bytes) or not hasattr(value, "__len__"):
            return value
        return [with_plain_keys(inner, file, (*parts, i)) for i, inner in enumerate(items(value))]
    table: dict[Any, Any] = Whole() if isinstance(value, Whole) else {}
    for key, inner in value.items():
        name = plain_name(key) if isinstance(key, str) else key
        if name in table:
            raise mistake(file, key_name((*parts, name)), "must be given once, found it in two forms that look alike")
        table[name] = with_plain_keys(inner, file, (*parts, name))
    return table


def without_none(value: Any) -> Any:
    """Return a value without the keys of its tables that are None, which TOML cannot write: None means the default."""
    if isinstance(value, list):
        return [without_none(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    return {key: without_none(inner) for key, inner in value.items() if inner is not None}


def key_name(parts: Sequence[str | int]) -> str:
    """Return a dotted key as TOML has it, from its parts: keys, quoted if needed, and indices of lists in brackets."""
    name = ""
    for part in parts:
        if isinstance(part, int):
            name += f"[{part}]"
        else:
            bare = re.fullmatch(r"[A-Za-z0-9_-]+", part)
            name += f".{part}" if bare else f".{json.dumps(part, ensure_ascii=False)}"
    return name.lstrip(".")


def parts_of(key: str) -> Parts:
    """Return the parts of a dotted key as TOML reads it; raise a ValueError if the text is not a key."""
    parts: Parts = ()
    if not isinstance(key, str) or len(key) > MAX_KEY:
        raise ValueError(key)
    key = plain_name(key)
    if re.fullmatch(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*", key):
        parts = tuple(key.split("."))
    else:
        # A key, and nothing else, can stand both in the header of a table and before a value.
        tomllib.loads(f"{key} = 0")
        table = tomllib.loads(f"[{key}]")
        while table:
            [(name, table)] = table.items()
            parts = (*parts, name)
    if len(parts) > MAX_PARTS:
        raise ValueError(key)
    return parts


def canonical(keys: Iterable[str], file: str) -> list[str]:
    """Return dotted keys as `key_name` writes them; an InputError lists those that are no keys or repeated."""
    names: list[str] = []
    problems = []
    for key in keys:
        try:
            name = key_name(parts_of(key))
        except ValueError:
            problems.append(not_a_key(file, key))
            continue
        if name in names:
            problems.append(Problem(file, name, "must be given once, found it twice"))
        names.append(name)
    refuse(problems)
    return names


def leaves(value: object, parts: Parts = ()) -> Iterator[tuple[Parts, object]]:
    """Yield each innermost value of nested tables, after the parts of its key; an empty table is a value.

    `parts` are those of the key of `value`.
    """
    if isinstance(value, Mapping) and value:
        for name, inner in value.items():
            yield from leaves(inner, (*parts, name))
    elif parts:
        yield parts, value


def values_by_key(changes: Mapping[str, object]) -> dict[Parts, object]:
    """Return the values set by `changes`, each by the parts of its full key; tables are taken apart as by `leaves`."""
    return {leaf: value for key, content in changes.items() for leaf, value in leaves(content, parts_of(key))}


def not_a_key(file: str, key: str) -> Problem:
    """Return the problem of a text in a file that should be a key and is none."""
    example = 'armour.ceramic_thickness_mm or library.projectile."7.62 mm AP"'
    message = f"must be a key of the scenario as TOML writes it, such as {example}, found {describe(key)}"
    return Problem(file, "", message)


def describe(value: object) -> str:
    """Return a wrong value in words, such as "a table" or 'the text "x"'."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, int) and abs(value) >= 2**63:
        return "a whole number of more than 64 bits"
    text = str(value)
    text = text if len(text) <= 40 else f"{text[:37]}..."
    return f'the text "{text}"' if isinstance(value, str) else text


def lines_of(text: str) -> dict[str, int]:
    """Return the line numbers, from 1, of every key and table of a TOML text, up to a syntax error."""
    lines: dict[str, int] = {}
    counts: dict[str, int] = {}
    table: KeyPath = ()
    for line, statement, data in _statements(text):
        is_header = statement.lstrip().startswith("[")
        if is_header:
            table = _key_of_header(data, counts)
        for key in [table] if is_header else _keys_within(data, table):
            lines.setdefault(key_name(key), line)
    return lines


def _statements(text: str) -> Iterator[tuple[int, str, dict[str, Any]]]:
    """Yield the number of the first line, from 1, the text and the content of each statement of a TOML text.

    A statement ends with the first line up to which it is valid.
    """
    first, statement = 1, ""
    for number, line in enumerate(text.split("\n"), 1):
        statement += f"{line}\n"
        try:
            yield first, statement, tomllib.loads(statement)
        except tomllib.TOMLDecodeError:
            if number - first < 500:  # lines
                continue
            return
        first, statement = number + 1, ""


def line_of(key: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of a key, or else that of the innermost table that would hold it; None if none of them is there.

    `lines` are those of `lines_of`.
    """
    return next((lines[part] for part in upwards(key) if part in lines), None)


def upwards(key: str) -> list[str]:
    """Return a key and those of the tables and lists that hold it, innermost first."""
    ends = [len(key), *(match.start() for match in re.finditer(r"[.\[]", key))]
    return [key[:end] for end in sorted(ends, reverse=True)]


def is_read(key: Parts, reads: Collection[str]) -> bool:
    """Return whether a computation depends on a key, given its `reads`.

    It depends on an input of a role, such as "ceramic.flow_stress_GPa", if it reads the key that names the ceramic, and
    on an empty table if it reads a key of that table.
    """
    name = NAMES.get(key[0]) or key_name(key)
    return not {*ALWAYS, *reads}.isdisjoint(upwards(name)) or any(read.startswith(f"{name}.") for read in reads)


def _key_of_header(data: Any, counts: dict[str, int]) -> KeyPath:
    """Return the key of the table that a header opens; in an array of tables, that of the next element.

    `data` are the content of the header alone; `counts`, which is updated, has the number of elements so far by array.
    """
    parts: KeyPath = ()
    while data:
        [(name, data)] = data.items()
        parts = (*parts, name)
        if isinstance(data, list):
            counts[key_name(parts)] = counts.get(key_name(parts), 0) + 1
            data = data[0]
        if key_name(parts) in counts:
            parts = (*parts, counts[key_name(parts)] - 1)
    return parts


def _keys_within(value: Any, parts: KeyPath) -> Iterator[KeyPath]:
    """Yield the key of a value, `parts`, and the keys of all that is within it."""
    if parts:
        yield parts
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, child in children:
        yield from _keys_within(child, (*parts, name))


def changed(data: Mapping[str, Any], changes: Mapping[str, object], file: str = "scenario") -> dict[str, Any]:
    """Return the data of a scenario with `changes`, values by dotted key; a table is merged into an existing one.

    A table that is `Whole` replaces it, whichever comes first of its key and of keys below.  A key that goes below a
    value is refused.
    """
    result, problems = dict(data), list[Problem]()
    for key, value in sorted(changes.items(), key=lambda item: len(item[0]) if isinstance(item[1], Whole) else inf):
        try:
            parts = parts_of(key)
            for name in reversed(parts):
                value = {name: value}
            result = _merged(result, value, file, parts)
        except ValueError:
            problems.append(not_a_key(file, key))
        except InputError as error:
            problems += error.problems
    refuse(problems)
    return result


def _merged(present: Any, value: object, file: str, key: Parts, place: int = 0) -> Any:
    """Return what replaces the `present` value: `value` or, for a table, the present table with it merged in.

    `key` is the changed key, `place` the number of its parts that lead to the value; an InputError names it if it goes
    below something else than a table.  The present data may be shared, and are not changed.
    """
    if not isinstance(value, Mapping):
        return value
    if place < len(key) and not isinstance(present, dict | None):
        hint = LISTED if isinstance(present, list) else suggestion(key_name(key), list(INPUTS))
        message = f"must not go below {key_name(key[:place])}, which is {describe(present)}{hint}"
        raise mistake(file, key_name(key), message)
    table = present if isinstance(present, dict) and not isinstance(value, Whole) else {}
    return table | {name: _merged(table.get(name), inner, file, key, place + 1) for name, inner in value.items()}


def changes_of(assignments: Iterable[str]) -> dict[str, Any]:
    """Return the values that assignments on the command line set, by dotted key.

    An assignment is a line of TOML; a value that is not TOML, or a number in place of a name, is taken as a text.  A
    table is `Whole`.
    """
    changes: dict[str, Any] = {}
    problems = []
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        try:
            key = key_name(parts_of(name if equals else ""))
        except ValueError:
            listed = LISTED if "[" in name else ""
            message = f"must be KEY=VALUE, such as impact.velocity_m_s=900, found {json.dumps(assignment)}{listed}"
            problems.append(Problem("command line", "--set", message))
            continue
        value = with_plain_keys(_value_of(key, text.strip()), "command line", (f"--set {key}",))
        if key in changes and changes[key] != value:
            message = f"must be given once, found {describe(changes[key])} and {describe(value)}"
            problems.append(Problem("command line", f"--set {key}", message))
        changes[key] = Whole(value) if isinstance(value, dict) else value
    refuse(problems)
    return changes


def _value_of(key: str, text: str) -> Any:
    """Return the value of a key that an assignment sets: as TOML reads the text or else the text itself."""
    try:
        [parsed] = parse_toml(f"value = {text}", "").values()
    except (InputError, ValueError):  # not TOML, or several lines
        return text
    return text if key in NAMING and not isinstance(parsed, str) else parsed
