"""Write computed values into a suite file as its expected values."""

import codecs
from collections.abc import Sequence
from typing import Any, NamedTuple

import tomlkit

from armour.validation.suite import Case
from armour.validation.validate import SuiteResult

# Significant digits of the values that are written.
DIGITS = 8


class Update(NamedTuple):
    """A case and its new expected value."""

    case: Case
    expected: float | str


def updates_of(result: SuiteResult) -> list[Update]:
    """Return the expected values of the suite's file that differ from the computed ones to the digits written."""
    updates = []
    for case, computed in ((check.case, check.computed) for check in result.checks):
        if computed is None or case.not_scored or case.cells:
            continue
        new = float(f"{computed:.{DIGITS}g}") if isinstance(computed, float) else computed
        if new != case.expected:
            updates.append(Update(case, new))
    return updates


def updated_file(content: bytes, updates: Sequence[Update]) -> bytes:
    """Return a suite file with other expected values; its comments, layout, line ends and byte order mark stay."""
    mark = codecs.BOM_UTF8 if content.startswith(codecs.BOM_UTF8) else b""
    document = tomlkit.parse(content.removeprefix(mark).decode())
    for update in updates:
        table: Any = document
        *path, last = update.case.place
        for key in path:
            table = table[key]
        table[last] = update.expected
    return mark + tomlkit.dumps(document).encode()
