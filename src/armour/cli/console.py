"""Print tables, lines and JSON on standard output, and messages and progress on standard error."""

import json
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import IO, Any

from rich.console import Console

from armour.cli.layout import UNLIMITED, rendered
from armour.errors import mistake
from armour.files import finite, reason
from armour.reporting.table import Table, printable_lines

# What begins a command in a log of GitHub or Azure, but may stand in a name of a file; it is escaped as in JSON.
_COMMAND = re.compile(r"(?m)^([^\S\n]*):(?=:)|#(?=#(?:\[|vso\[))")


def show(*items: Table | str, stderr: bool = False) -> None:
    """Print tables and lines, fitted to the width of a terminal; in a pipe or a file, each row stays on one line."""
    console = Console(stderr=stderr)
    width = console.width if console.is_terminal else UNLIMITED
    _write(rendered(items, width, console.color_system), sys.stderr if stderr else sys.stdout)


def show_json(data: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
    """Print a JSON object, or an array of objects, in ASCII; NaN and infinity become null."""
    emit(json.dumps(finite(data), indent=2, allow_nan=False) + "\n")


def say(*lines: str) -> None:
    """Print messages on standard error."""
    if lines:
        show(*lines, stderr=True)


def emit(text: str, stream: IO[str] | None = None) -> None:
    """Write a text to a stream, by default standard output, with control characters escaped."""
    _write(printable_lines(text), stream or sys.stdout)


def _write(text: str, stream: IO[str]) -> None:
    """Write a text to a stream and flush it, so that errors appear here and not when the program ends.

    A pipe that its reader has closed is no error.  On standard error, any text that cannot be written is dropped.
    """
    try:
        stream.write(_COMMAND.sub(lambda mark: f"{mark[1] or ''}\\u{ord(mark[0][-1]):04x}", text))
        stream.flush()
    except OSError as error:
        discard(stream)
        if stream is not sys.stderr and not isinstance(error, BrokenPipeError):
            raise mistake("standard output", "", f"cannot be written: {reason(error)}") from None


def discard(stream: IO[str]) -> None:
    """Discard what a stream has buffered and all that is written to it later."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def progress(unit: str, total: int | None = None) -> Iterator[Callable[..., None]]:
    """Yield a function to call with the number of units done since the last call; on a terminal, it moves a bar.

    The total may also be given, or changed, with each call.  Units that were ``stored`` by an earlier run do not count
    for the rate.
    """
    if not sys.stderr.isatty():
        yield lambda *_count, **_stored: None
        return
    from rich import progress as bars

    rate = bars.TextColumn("{task.fields[rate]}")
    columns = (bars.BarColumn(), bars.MofNCompleteColumn(), rate, bars.TimeRemainingColumn())
    with bars.Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(unit, total=total, rate="")

        def advance(count: int, total: int | None = None, stored: bool = False) -> None:
            if stored:
                bar.reset(task, completed=int(bar.tasks[task].completed) + count)
                return
            bar.update(task, advance=count, total=total)
            speed = bar.tasks[task].speed
            bar.update(task, rate=f"{speed:,.1f} {unit}/s" if speed else "")

        yield advance
