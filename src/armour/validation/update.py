"""Write computed values into a suite file in place of those that the program computed before."""

import codecs
from collections.abc import Sequence
from dataclasses import replace
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
    """Return the regression values that differ from the computed ones to the digits that are written."""
    updates = []
    for case, computed in ((check.case, check.computed) for check in result.checks):
        if computed is None or case.not_scored or case.cells or not case.regression:
            continue
        new = float(f"{computed:.{DIGITS}g}") if isinstance(computed, float) else computed
        if new != case.expected:
            updates.append(Update(case, new))
    return updates


def kept_by_update(result: SuiteResult) -> SuiteResult:
    """Return the result of the cases whose values an update keeps: those that are no regression values."""
    checks = tuple(check for check in result.checks if not check.case.regression)
    groups = {check.case.group for check in checks}
    return replace(result, checks=checks, summaries=tuple(each for each in result.summaries if each.name in groups))


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
