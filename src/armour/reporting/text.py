"""Texts: numbers, intervals, and text from files made safe for terminals and XML."""

import re
from math import isfinite
from textwrap import wrap
from typing import TYPE_CHECKING, Self

from armour.files import printable
from armour.units import ENDINGS

if TYPE_CHECKING:
    from armour.analysis.estimates import Estimate


class VerdictLine(str):
    """A line that says how an answer ends, well or not; a terminal shows it in green or red."""

    good: bool

    def __new__(cls, text: str, *, good: bool) -> Self:
        """Make a verdict."""
        line = super().__new__(cls, text)
        line.good = good
        return line


# The space between a number and its unit, or after ±.
BESIDE_NUMBER = re.compile(rf"(?<=\d) (?=({'|'.join(map(re.escape, [*ENDINGS.values(), 'J']))})(?![\w/]))|(?<=±) ")


def printable_lines(text: str) -> str:
    """Escape the control characters of a text from a file; line ends stay."""
    return "\n".join(map(printable, text.split("\n")))


def unbroken(text: str) -> str:
    """Return a text in which no line ends between a number and its unit or ±: the space there does not break."""
    return BESIDE_NUMBER.sub("\N{NO-BREAK SPACE}", text)


def wrapped(text: str, width: int) -> list[str]:
    """Wrap a text between words, but not between a number and its unit."""
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in wrap(unbroken(text), width)]


def percent(part: float) -> str:
    """Format a part, such as a confidence level, in per cent."""
    return f"{100.0 * part:g} %"


def number(value: float | str, spec: str) -> str:
    """Format a number, with its thousands separated from 10,000 on; a text is returned as it is.

    A number that is not finite has no value and gives an empty text.
    """
    if isinstance(value, str):
        return value
    if not isfinite(value):
        return ""
    text = format(value, spec)
    if not float(text):
        return format(0, spec)  # without the sign of a number that rounds to zero
    sign = spec[:1] if spec.startswith("+") else ""
    return text if abs(float(text)) < 1e4 else format(value, f"{sign},{spec.removeprefix(sign)}")


def with_interval(value: float, ends: "tuple[float | None, float | None] | Estimate | None", spec: str) -> str:
    """Format an estimate with its interval, such as "0.80 (0.79 to 0.81)"."""
    return f"{number(value, spec)} ({interval(ends, spec)})"


def interval(ends: "tuple[float | None, float | None] | Estimate | None", spec: str) -> str:
    """Format an interval, or that of an estimate, if there is one; an end that is None is not bounded."""
    if ends is None:
        return ""
    low, high = ends if isinstance(ends, tuple) else (ends.low, ends.high)
    if low is None:
        return "not bounded" if high is None else f"up to {number(high, spec)}"
    return f"from {number(low, spec)}" if high is None else f"{number(low, spec)} to {number(high, spec)}"
