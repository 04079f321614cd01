"""Line numbers of the keys of a TOML file."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from armour.scenario.messages import key_name

Parts = tuple[str | int, ...]
# What decides where a statement ends: texts and comments as wholes, brackets and ends of lines.
_TOKEN = re.compile(
    r"""
    "{3} [^"\\]* (?: (?: \\. | "(?!"") ) [^"\\]* )* "{3,5} | '{3} .*? '{3,5} | "{3} | '{3}
    | " [^"\\\n]* (?: \\[^\n] [^"\\\n]* )* "? | ' [^'\n]* '? | \#[^\n]* | [\[\]{}\n]
    """,
    re.DOTALL | re.VERBOSE,
)


def lines_of(text: str) -> dict[str, int]:
    """Return the line numbers, from 1, of every key and table of a TOML text, up to a syntax error.

    The text is parsed statement by statement, each once.
    """
    found: dict[str, int] = {}
    counts: dict[str, int] = {}
    table: Parts = ()
    for start, statement in statements(text):
        try:
            data = tomllib.loads(statement)
            parts = _header(data, counts) if statement.lstrip().startswith("[") else ()
            keys = [parts] if parts else list(_keys(data, table))
        except (tomllib.TOMLDecodeError, RecursionError):
            break
        table = parts or table
        for key in keys:
            found.setdefault(key_name(key), start)
    return found


def statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield the statements of a TOML text, each with its first line; they end where a line does, outside brackets."""
    text += "\n"
    start, line, depth = 0, 1, 0
    for match in _TOKEN.finditer(text):
        token = match[0]
        if token in ("[", "{"):
            depth += 1
        elif token in ("]", "}"):
            depth -= 1
        elif token in ('"""', "'''"):
            return  # a text without an end
        elif token == "\n" and depth <= 0:
            statement = text[start : match.end()]
            yield line, statement
            start, line, depth = match.end(), line + statement.count("\n"), 0


def line_of(key: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of a key or, if the file does not hold it, of the innermost table that would; None if neither."""
    return next((lines[part] for part in upwards(key) if part in lines), None)


def upwards(key: str) -> list[str]:
    """Return a key and those of the tables and lists that hold it, innermost first."""
    ends = [len(key), *(match.start() for match in re.finditer(r"[.\[]", key))]
    return [key[:end] for end in sorted(ends, reverse=True)]


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
