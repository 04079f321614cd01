"""What can go wrong, as a tree.

::

    ArmourError
    ├── InputError            the input is wrong: every mistake found in it        (exit code 2)
    └── NoAnswerError         the question has no answer in the range given        (exit code 1)
        ├── NoLimitError      no ballistic limit in the range of velocities
        └── NoDesignError     no design of the grid defeats the threat
"""

from collections.abc import Sequence
from difflib import get_close_matches
from typing import NamedTuple


class Problem(NamedTuple):
    """One mistake: where it is and what must hold there."""

    file: str
    key: str  # empty where the whole file is meant
    message: str

    def __str__(self) -> str:
        return ": ".join(part for part in self if part)


class ArmourError(Exception):
    """Base of all errors that armour raises on purpose."""


class InputError(ArmourError):
    """The input is wrong.

    Attributes
    ----------
    problems : tuple of Problem
        All mistakes found.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


class NoAnswerError(ArmourError):
    """The question has no answer in the range given."""


class NoLimitError(NoAnswerError):
    """No ballistic limit in the range of velocities."""


class NoDesignError(NoAnswerError):
    """No design of the grid defeats the threat."""


def suggestion(word: str, known: Sequence[str]) -> str:
    """A hint at the known word that is most like the one given; empty where none is."""
    by_lower = {name.lower(): name for name in known}
    found = get_close_matches(word.lower(), list(by_lower), n=1, cutoff=0.5)
    return f"; did you mean {by_lower[found[0]]!r}?" if found else ""
