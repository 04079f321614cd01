"""Errors that armour raises on purpose.

::

    ArmourError
    ├── InputError            the input is wrong; lists every mistake found        (exit code 2)
    └── NoAnswerError         the question has no answer in the given range        (exit code 1)
        └── NoLimitError      no ballistic limit in the range of velocities
"""

import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches
from os import PathLike
from typing import NamedTuple

# Greatest number of names to suggest one from, as a wrong name is compared with each of them.
MAX_WORDS = 1000
# Least likeness of two names, and of the words within them, for one to be a misspelling of the other: "stres" is like
# "stress", but "length" is not like "diameter".
LIKENESS = 0.6
# Separators of the words of a name; a point in a number is none.
_BETWEEN = re.compile(r"[\s_,]+|\.(?=[a-z])")
# Numbers in a name; names with different numbers, such as 5083 and 5086, name different things.
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
# Precedes a list of names in a message.
CHOOSE = "; choose from "
# Greatest number of names in a sentence.
MAX_NAMES = 7
# Greatest number of mistakes shown; a script may make thousands.
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


@dataclass(frozen=True)
class Note:
    """A warning on a result.

    Attributes
    ----------
    text : str
        What a reader should know.
    key : str
        Dotted key that the warning is about; empty if it is about none.
    said : str
        "caveat" if the answer itself contains the text, "too low" if the armour may stop more than the answer says,
        "not known" if it is the answer, "pairs" if the table of pairs of materials contains it, "detail" if a reader
        need not know it first; else empty.
    about : tuple
        Kind of a caveat, with the numbers or the name that it is about; empty for other warnings.
    """

    text: str
    key: str = ""
    said: str = ""
    about: tuple[str | float, ...] = ()

    def __str__(self) -> str:
        return f"{self.key}: {self.text}" if self.key else self.text

    def against(self, threats: str) -> "Note":
        """Return the warning with words at its end that say which threats it is about, as " against M2"; "" for all."""
        return replace(self, text=self.text + threats)


class ArmourError(Exception):
    """Base class of all errors that armour raises on purpose."""


class InputError(ArmourError):
    """Wrong input.

    Attributes
    ----------
    problems : tuple of Problem
        All mistakes found.
    options : tuple of str
        Options with which the command line has no mistake; empty if these are not known.
    """

    def __init__(self, problems: Sequence[Problem], options: Sequence[str] = ()) -> None:
        self.problems, self.options = tuple(_listed_once(problems)), tuple(options)
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
    """Return the InputError of one mistake: its file, its dotted key or "", and what is wrong, as in `Problem`."""
    return InputError([Problem(str(file), key, message)])


@contextmanager
def restated(restate: Callable[[Problem], Problem]) -> Iterator[None]:
    """Make a context in which `restate` changes each mistake found, as to name the file or key that a user knows."""
    try:
        yield
    except InputError as error:
        raise InputError([restate(problem) for problem in error.problems], error.options) from None


def refuse(problems: Iterable[Problem]) -> None:
    """Raise an InputError with these problems, if there are any."""
    if listed_problems := tuple(problems):
        raise InputError(listed_problems)


def _listed_once(problems: Iterable[Problem]) -> Iterator[Problem]:
    """Yield the problems; if the messages of several list the same choices, only the first one keeps the list."""
    lists = set[str]()
    for problem in problems:
        message, _, names = problem.message.partition(CHOOSE)
        yield problem._replace(message=message) if names and names in lists else problem
        lists.add(names)


def listed(names: Sequence[str]) -> str:
    """Return names as part of a sentence: the first ones, and how many more there are."""
    omitted = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {omitted} more" if omitted > 0 else "")


def joined(names: Sequence[str], word: str = "and") -> str:
    """Return all of at least one name as part of a sentence, such as "a, b and c"."""
    *first, last = names
    return f"{', '.join(first)} {word} {last}" if first else last


def point_hint(value: object) -> str:
    """Return the end of a message, a hint at the decimal point, if a value is a text with a decimal comma; else ""."""
    return "; decimals have a point" if re.fullmatch(r"[+-]?\d+,\d+", str(value)) else ""


def counted(number: int, noun: str) -> str:
    """Return a number of things, such as "1 row" or "2 rows"."""
    digits = f"{number:,}" if number >= 10_000 else f"{number}"
    return f"{digits} {noun}{'' if number == 1 else 's'}"


def duration(seconds: float) -> str:
    """Return a length of time in words, such as "90 hours"."""
    for limit, unit, name in ((120, 1, "seconds"), (7200, 60, "minutes"), (360000, 3600, "hours")):
        if seconds < limit:
            number = max(round(seconds / unit), 1)
            return f"{number} {name if number > 1 else name[:-1]}"
    return f"{seconds / 86400:,.0f} days"


def suggestion(word: str, names: Sequence[str]) -> str:
    """Return a hint at the one of `names` closest to a wrong word, as '; did you mean "AD85"?'; "" if none is close."""
    if len(names) > MAX_WORDS:
        return ""
    folded, by_folded = _folded(word), {_folded(name): name for name in names}
    # A name that contains every part of the word is closer than any other.
    parts = {*folded.split()}
    complete = [name for name in by_folded if parts and parts <= {*name.replace(",", " ").split()}]
    like = complete or [name for name in by_folded if _is_like(folded, name)]
    closest = get_close_matches(folded, like, n=1, cutoff=0.0 if complete else LIKENESS)
    return f'; did you mean "{by_folded[closest[0]]}"?' if closest else ""


def _folded(name: str) -> str:
    """Return a name in lower case and with one form of each character, so that it compares equal to similar names."""
    return unicodedata.normalize("NFKC", name).casefold()


def _is_like(word: str, name: str) -> bool:
    """Return whether `word` may be a misspelling of a name; both are as `_folded` returns them.

    The name must have each number of the other; and all words of one of the two must be like words of the other.
    """
    if not {*_NUMBER.findall(word)} <= {*_NUMBER.findall(name)}:
        return False
    parts, others = _BETWEEN.split(word), _BETWEEN.split(name)
    return any(
        all(get_close_matches(part, all_words, n=1, cutoff=LIKENESS) for part in some)
        for some, all_words in ((parts, others), (others, parts))
    )


def choices(word: str, names: Sequence[str]) -> str:
    """Return a hint at the one of `names` closest to a wrong word, or a list of all names if none is close."""
    separator = "; " if any("," in name for name in names) else ", "
    return suggestion(word, names) or CHOOSE + separator.join(names)
