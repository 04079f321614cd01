"""Keys and values of TOML files: spelling, parts, descriptions and lines in a file."""

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from armour.errors import Problem, refuse

Parts = tuple[str, ...]
# More parts than any key of a scenario has; deeper tables exhaust the stack.
MAX_PARTS = 20
# Keys, and indices of lists.
_Place = tuple[str | int, ...]
# Texts and comments, within which brackets and ends of lines do not count, brackets, and ends of lines.
_TOKEN = re.compile(
    r'''"""(?:\\.|[^\\])*?"{3,5}|\'{3}.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|\#[^\n]*|[][{}\n]''', re.DOTALL
)


def key_name(parts: Sequence[str | int]) -> str:
    """Return a dotted key as written in TOML, from keys and indices of lists, which are in brackets."""
    name = ""
    for part in parts:
        if isinstance(part, int):
            name += f"[{part}]"
        else:
            bare = re.fullmatch(r"[A-Za-z0-9_-]+", part)
            name += f".{part}" if bare else f".{json.dumps(part, ensure_ascii=False)}"
    return name.lstrip(".")


def parts_of(key: str) -> Parts:
    """Return the parts of a dotted key as TOML reads it; raise a ValueError if it is not one."""
    parts: Parts = ()
    if not isinstance(key, str):
        raise ValueError(key)
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
    """Return keys in one spelling; they must be keys as TOML writes them, and differ from each other."""
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
    """Yield the keys of a value and of the tables within it that hold no further tables, with their values."""
    if isinstance(value, Mapping) and value:
        for name, inner in value.items():
            yield from leaves(inner, (*parts, name))
    elif parts:
        yield parts, value


def values_by_key(changes: Mapping[str, object]) -> dict[Parts, object]:
    """Return the values that changes set, by key, without the tables that hold them."""
    return {leaf: value for key, content in changes.items() for leaf, value in leaves(content, parts_of(key))}


def not_a_key(file: str, key: str) -> Problem:
    """Return the problem of a text that is not a key."""
    example = 'armour.ceramic_thickness_mm or library.projectile."7.62 mm AP"'
    return Problem(
        file, "", f"must be a key of the scenario as TOML writes it, such as {example}, found {describe(key)}"
    )


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
    table: _Place = ()
    for line, statement in _statements(text):
        try:
            data = tomllib.loads(statement)
        except tomllib.TOMLDecodeError:
            break
        is_header = statement.lstrip().startswith("[")
        if is_header:
            table = _header(data, counts)
        for key in [table] if is_header else _keys(data, table):
            lines.setdefault(key_name(key), line)
    return lines


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield the statements of a TOML text, each with the number of its first line, from 1."""
    start, line, depth = 0, 1, 0
    for token in _TOKEN.finditer(f"{text}\n"):
        depth += (token[0] in "[{") - (token[0] in "]}")
        if token[0] == "\n" and depth <= 0:
            statement = text[start : token.end()]
            yield line, statement
            start, line = token.end(), line + statement.count("\n")


def line_of(key: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of a key or, if it is not in the file, of the innermost table that would hold it, else None."""
    return next((lines[part] for part in upwards(key) if part in lines), None)


def upwards(key: str) -> list[str]:
    """Return a key and those of the tables and lists that hold it, innermost first."""
    ends = [len(key), *(match.start() for match in re.finditer(r"[.\[]", key))]
    return [key[:end] for end in sorted(ends, reverse=True)]


def _header(data: Any, counts: dict[str, int]) -> _Place:
    """Return the key of the table that a header opens; for an array of tables, of its next element."""
    parts: _Place = ()
    while data:
        [(name, data)] = data.items()
        parts = (*parts, name)
        if isinstance(data, list):
            counts[key_name(parts)] = counts.get(key_name(parts), 0) + 1
            data = data[0]
        if key_name(parts) in counts:
            parts = (*parts, counts[key_name(parts)] - 1)
    return parts


def _keys(value: Any, parts: _Place) -> Iterator[_Place]:
    """Yield the key of a value and the keys within it."""
    if parts:
        yield parts
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, child in children:
        yield from _keys(child, (*parts, name))
