"""Errors that armour raises on purpose.

::

    ArmourError
    ├── InputError            the input is wrong; lists every mistake found        (exit code 2)
    └── NoAnswerError         the question has no answer in the given range        (exit code 1)
        └── NoLimitError      no ballistic limit in the range of velocities
"""

from collections.abc import Iterable, Iterator, Sequence
from difflib import get_close_matches
from os import PathLike
from typing import NamedTuple, Self

# Known words beyond which none is suggested, as each wrong word is compared with all of them.
MAX_WORDS = 1000
# What a list of them follows in a message.
CHOOSE = "; choose from "
# Names that a sentence lists.
MAX_NAMES = 7
# Mistakes of a kind that are shown; a script may make thousands.
MAX_PROBLEMS = 20


class Problem(NamedTuple):
    """A mistake in the input.

    Attributes
    ----------
    file : str
        File that contains the mistake.
    key : str
        Dotted key of the mistake; empty if the mistake concerns the whole file.
    message : str
        The condition and what was found instead.
    """

    file: str
    key: str
    message: str

    def __str__(self) -> str:
        return ": ".join(part for part in self if part)


class Note(str):
    """A warning on a result: a text, such as "impact.velocity_m_s: ...", with the key that it is about.

    Attributes
    ----------
    key : str
        Dotted key that the warning is about; empty if it is about none.
    text : str
        What a reader should know.
    brief : str
        What is outside what the model was compared with, in a few words; empty of other warnings.
    """

    key: str
    text: str
    brief: str

    def __new__(cls, text: str, key: str = "", brief: str = "") -> Self:
        """Make the warning of its text and its key."""
        made = super().__new__(cls, f"{key}: {text}" if key else text)
        made.key, made.text, made.brief = key, text, brief
        return made


class ArmourError(Exception):
    """Base class of all errors that armour raises on purpose."""


class InputError(ArmourError):
    """Wrong input.

    Attributes
    ----------
    problems : tuple of Problem
        All mistakes found.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(_listed_once(problems))
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


class NoAnswerError(ArmourError):
    """The question has no answer in the given range."""


class NoLimitError(NoAnswerError):
    """No ballistic limit in the range of velocities; `above` if none of the velocities scanned perforates."""

    def __init__(self, message: str, *, above: bool = False) -> None:
        super().__init__(message)
        self.above = above


def mistake(file: str | PathLike[str], key: str, message: str) -> InputError:
    """Return the error of one mistake; see `Problem`."""
    return InputError([Problem(str(file), key, message)])


def refuse(problems: Iterable[Problem]) -> None:
    """Raise an InputError if there are problems."""
    if found := tuple(problems):
        raise InputError(found)


def _listed_once(problems: Iterable[Problem]) -> Iterator[Problem]:
    """Yield the problems; a list of choices that several have stands in the first of them only."""
    listed = set[str]()
    for problem in problems:
        message, _, names = problem.message.partition(CHOOSE)
        yield problem._replace(message=message) if names in listed else problem
        listed.update({names} if names else ())


def listed(names: Sequence[str]) -> str:
    """Return names as part of a sentence: the first ones, and how many more there are."""
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")


def in_two_lines(warnings: Sequence[str], where: str) -> list[str]:
    """Return warnings in two lines at most: what is outside what the model was compared with, and the first other one.

    The words say where the others are.
    """
    outside = [each for each in warnings if isinstance(each, Note) and each.brief]
    others = [each for each in warnings if each not in outside]
    briefs = list(dict.fromkeys(each.brief for each in outside))
    found: list[str] = list(outside[:1])
    if len(briefs) > 1:
        found = [f"outside what the model was compared with: {listed(briefs)}; explained {where}"]
    more = len(others) - 1
    return [*found, *(f"{each}; {more} more {where}" if more > 0 else each for each in others[:1])]


def suggestion(word: str, known: Sequence[str]) -> str:
    """Return a hint at the known word closest to a given one, such as '; did you mean "AD85"?'; "" if none is close."""
    if len(known) > MAX_WORDS:
        return ""
    by_lower = {name.lower(): name for name in known}
    # A name with every word that is given is closer than one with other words.
    parts = {*word.lower().split()}
    whole = [name for name in by_lower if parts and parts <= {*name.replace(",", " ").split()}]
    found = get_close_matches(word.lower(), whole or list(by_lower), n=1, cutoff=0.0 if whole else 0.6)
    return f'; did you mean "{by_lower[found[0]]}"?' if found else ""


def choices(word: str, known: Sequence[str]) -> str:
    """Return a hint at the known word closest to a given one, or at all known words if none is close."""
    return suggestion(word, known) or f"{CHOOSE}{', '.join(known)}"
