"""Processes that are disturbed, and counts of how that ended."""

import os
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from armour.cli.app import app
from tools.campaigns.verdict import verdict

WRONG = "WRONG"
# Exit code of a process that ends by an error of Python.
ERROR = 70


def forked(function: Callable[..., int], *args: object) -> int:
    """Run a function in a process of its own and return its id."""
    child = os.fork()
    if not child:
        code = ERROR
        try:
            code = function(*args) % 256
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    return child


def timed(function: Callable[..., int], *args: object) -> float:
    """Return the time that a function takes in a process of its own, undisturbed, s."""
    start = time.monotonic()
    assert exit_code(forked(function, *args)) == 0
    return time.monotonic() - start


def exit_code(child: int) -> int:
    """Wait for a process; return its exit code, or that of a signal, below zero."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def command(arguments: list[str], said: Path) -> int:
    """Run a command in this process, append what it says to a file, and return its exit code."""
    with said.open("a") as file, redirect_stdout(file), redirect_stderr(file):
        try:
            app(arguments, prog_name="armour")
        except SystemExit as end:
            return int(end.code or 0)
    return ERROR


def run(*series: Callable[[Path], Iterator[str]]) -> int:
    """Run series of trials, each in a folder of its own, and print how many of them had each outcome.

    Returns the exit code, 3 if a trial ended wrong.
    """
    counts, failed = [], 0
    with tempfile.TemporaryDirectory(prefix="campaign-") as place:
        for trials in series:
            folder = Path(place) / trials.__name__
            folder.mkdir()
            outcomes = Counter(trials(folder))
            for outcome, number in outcomes.most_common():
                print(f"{trials.__name__}: {number} {outcome}", flush=True)
            counts.append(f"{outcomes.total()} {trials.__name__}")
            failed += sum(number for outcome, number in outcomes.items() if WRONG in outcome)
    return verdict(f"{', '.join(counts)}: {failed} ended wrong", right=not failed)
