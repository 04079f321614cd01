"""Tables, lines and JSON on standard output; messages and progress on standard error."""

import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import isfinite
from typing import IO, Any

from armour.errors import mistake
from armour.files import reason
from armour.reporting.table import Table, printable_lines


def show(*items: Table | str, title: str = "", stderr: bool = False) -> None:
    """Print tables and lines; a reader that has closed the pipe is no error."""
    from rich.console import Console

    from armour.cli.layout import UNLIMITED, rendered

    console = Console(stderr=stderr)
    room = console.width if console.is_terminal else UNLIMITED
    _write(rendered(items, room, title, console.color_system), sys.stderr if stderr else sys.stdout)


def show_json(data: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
    """Print a JSON object, or an array of them, on standard output, in ASCII; a number that is not finite is null."""
    emit(json.dumps(_finite(data), indent=2, allow_nan=False) + "\n")


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def say(*lines: str) -> None:
    """Print messages on standard error."""
    if lines:
        show(*lines, stderr=True)


def emit(text: str, stream: IO[str] | None = None) -> None:
    """Write lines to a stream, by default standard output, with control characters from files escaped."""
    _write(printable_lines(text), stream or sys.stdout)


def _write(text: str, stream: IO[str]) -> None:
    """Write printable text to a stream at once, so that errors appear here and not at the end.

    A reader that has closed the pipe is no error; messages that cannot be written are lost.
    """
    try:
        stream.write(text)
        stream.flush()
    except OSError as error:
        discard(stream)
        if stream is not sys.stderr and not isinstance(error, BrokenPipeError):
            raise mistake("standard output", "", f"cannot be written: {reason(error)}") from None


def discard(stream: IO[str]) -> None:
    """Discard the buffered content of a stream and everything written to it later."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def progress(unit: str, total: int | None = None, first: str = "") -> Iterator[Callable[..., None]]:
    """Yield a function to call with progress; on a terminal it moves a bar with the rate and the remaining time.

    The total may also be given, or changed, with each count; without one, the bar only moves.  A count of units
    ``stored`` before is not part of the rate.  ``first`` names the step before the first count; by default, compiling.
    """
    if not sys.stderr.isatty():
        yield lambda *_count, **_stored: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(unit, total=total, rate=first or "compiling or reading compiled code")

        def advance(count: int, total: int | None = None, stored: bool = False) -> None:
            if stored:
                bar.reset(task, completed=int(bar.tasks[task].completed) + count)
                return
            bar.update(task, advance=count, total=total)
            speed = bar.tasks[task].speed
            bar.update(task, rate=f"{speed:,.1f} {unit}/s" if speed else "")

        yield advance
