"""What is asked of a campaign, and how it ends: a line for the page of results, and an exit code."""

from argparse import ArgumentParser, Namespace
from typing import NamedTuple

RESULT, WRONG = "result: ", 3


def asked(words: str | None, **usual: int) -> Namespace:
    """Return the numbers that options ask for, such as ``--trials``, or the usual ones; and the other words."""
    parser = ArgumentParser(description=words)
    parser.add_argument("words", nargs="*")
    for name, number in usual.items():
        parser.add_argument(f"--{name}", type=int, default=number)
    return parser.parse_args()


def verdict(found: str, *, right: bool) -> int:
    """Print what a campaign has found; return the exit code, 3 if it is not as it should be."""
    print(f"{RESULT}{found}", flush=True)
    return 0 if right else WRONG


def holds(interval: tuple[float | None, float | None], value: float) -> bool:
    """Return whether an interval, whose ends may be open, contains a value."""
    low, high = interval
    return (low is None or low <= value) and (high is None or value <= high)


class Share(NamedTuple):
    """How many samples of a case have a property, such as an interval that contains the truth."""

    case: str
    name: str
    hits: int
    samples: int
    least: float | None = None  # per cent that must be reached, if the share is judged

    @property
    def percent(self) -> float:
        """The share, per cent."""
        return 100.0 * self.hits / self.samples
