"""Line numbers of the keys of a TOML file."""

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from armour.scenario.messages import key_name

Parts = tuple[str | int, ...]


def lines_of(text: str) -> dict[str, int]:
    """Return the line numbers, from 1, of every key and table of a TOML text, up to a syntax error.

    The text is parsed statement by statement; a statement is the least number of lines that is valid TOML.
    """
    found: dict[str, int] = {}
    counts: dict[str, int] = {}
    table: Parts = ()
    statement, start = "", 1
    for number, line in enumerate(text.split("\n"), 1):
        if not statement:
            start = number
        statement += line + "\n"
        try:
            data = tomllib.loads(statement)
        except tomllib.TOMLDecodeError:
            continue
        if statement.lstrip().startswith("["):
            table = _header(data, counts)
            found.setdefault(key_name(table), start)
        else:
            for parts in _keys(data, table):
                found.setdefault(key_name(parts), start)
        statement = ""
    return found


def line_of(key: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of a key or, if the file does not hold it, of the innermost table that would; None if neither."""
    holding = [name for name in lines if key == name or (key.startswith(name) and key[len(name)] in ".[")]
    return lines[max(holding, key=len)] if holding else None


def _header(data: Any, counts: dict[str, int]) -> Parts:
    """Return the key of the table that a header opens; for an array of tables, of its next element."""
    parts: Parts = ()
    while data:
        [(name, data)] = data.items()
        parts = (*parts, name)
        if isinstance(data, list):
            counts[key_name(parts)] = counts.get(key_name(parts), 0) + 1
            data = data[0]
        if key_name(parts) in counts:
            parts = (*parts, counts[key_name(parts)] - 1)
    return parts


def _keys(value: Any, parts: Parts) -> Iterator[Parts]:
    """Yield the key of a value and the keys within it."""
    if parts:
        yield parts
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, child in children:
        yield from _keys(child, (*parts, name))
