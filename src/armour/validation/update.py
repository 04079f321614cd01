"""Write computed values into a suite file as its expected values."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import tomlkit

from armour.validation.suite import Case
from armour.validation.validate import SuiteResult

# Significant digits of the values that are written.
DIGITS = 8


@dataclass(frozen=True)
class Update:
    """An expected value that changes."""

    case: Case
    old: float | str
    new: float | str


def updates_of(result: SuiteResult) -> list[Update]:
    """Return the expected values that differ from the computed ones to the digits that are written."""
    updates = []
    for item in result.checks:
        if item.computed is None or item.case.not_scored:
            continue
        new = float(f"{item.computed:.{DIGITS}g}") if isinstance(item.computed, float) else item.computed
        if new != item.case.expected:
            updates.append(Update(item.case, item.case.expected, new))
    return updates


def updated_text(text: str, updates: Sequence[Update]) -> str:
    """Return the text of a suite file with other expected values; its comments and layout stay."""
    document = tomlkit.parse(text)
    for update in updates:
        table: Any = document
        *path, last = update.case.place.keys
        for key in path:
            table = table[key]
        table[last] = update.new
    return tomlkit.dumps(document)
