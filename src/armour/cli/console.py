"""Tables, lines and JSON on standard output; messages and progress on standard error.

A terminal shows every word, name and number whole: a table that is too wide first gets headings of several lines,
then becomes a block of lines for each row.  In a pipe each row stays on one line.
"""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, Any, NamedTuple

from armour.reporting.table import Column, Table
from armour.reporting.text import printable

if TYPE_CHECKING:
    from rich.console import Console

# Room between two columns.
GAP = 2
# Least width of a column of prose before the table becomes blocks.
PROSE_WIDTH = 16
# Width to measure texts in, and to lay out what goes into a pipe.
UNLIMITED = 1_000_000


def show(*items: Table | str, title: str = "", stderr: bool = False) -> None:
    """Print tables and lines; a reader that has closed the pipe is no error."""
    _write(sys.stderr if stderr else sys.stdout, rendered(items, _console(stderr=stderr), title))


def show_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object on standard output."""
    _write(sys.stdout, json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def say(*lines: str) -> None:
    """Print messages on standard error."""
    _write(sys.stderr, "".join(f"{printable(line)}\n" for line in lines))


def _write(stream: IO[str], text: str) -> None:
    """Write at once, so that a closed pipe is noticed here and not at the end of the process."""
    try:
        stream.write(text)
        stream.flush()
    except BrokenPipeError:
        # What is still in the buffer goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _console(*, stderr: bool = False) -> "Console":
    """Return a console as wide as the terminal; in a pipe without a limit."""
    from rich.console import Console

    console = Console(stderr=stderr, highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = UNLIMITED
    return console


def rendered(items: Sequence[Table | str], console: "Console", title: str = "") -> str:
    """Format tables and lines for a console, with an empty line between a table and what stands above it."""
    from rich.text import Text

    room = console.width
    # Rich would fold what does not fit; what is wider than the terminal is left to the terminal.
    console.width = UNLIMITED
    with console.capture() as capture:
        if title:
            console.print(Text(printable(title), style="bold"))
        for index, item in enumerate(items):
            if isinstance(item, str):
                console.out(printable(item), highlight=False)
                continue
            if index or (title and item.title):
                console.out()
            if item.title:
                console.print(Text(printable(item.title), style="bold"))
            _print_table(item, console, room)
    return "\n".join(line.rstrip(" ") for line in capture.get().split("\n"))


class _Size(NamedTuple):
    """Width of the longest word and of the longest line, in cells of the terminal."""

    word: int
    line: int


def _print_table(table: Table, console: "Console", room: int) -> None:
    if table.record:
        _print_blocks(table, console, room)
        return
    texts = [[printable(text) for text in row] for row in table.texts()]
    for stacked in (False, True):
        headings = [_heading(column, stacked=stacked) for column in table.columns]
        sizes = [
            _column_size(column, heading, [row[index] for row in texts], stacked=stacked)
            for index, (column, heading) in enumerate(zip(table.columns, headings, strict=True))
        ]
        widths = _widths(sizes, room - GAP * (len(sizes) - 1))
        if widths is not None:
            _print_grid(table, headings, texts, widths, console)
            return
    _print_blocks(table, console, room)


def _heading(column: Column, *, stacked: bool) -> str:
    """Return a heading; stacked, its unit has a line of its own."""
    separator = ",\n" if stacked else ", "
    return separator.join(printable(part) for part in (column.label, column.unit) if part)


def _size(texts: Iterable[str]) -> _Size:
    """Return the size of several texts."""
    from rich.cells import cell_len

    lines = [line for text in texts for line in text.split("\n")]
    words = (cell_len(word) for line in lines for word in line.split(" "))
    return _Size(max(words, default=0), max(map(cell_len, lines), default=0))


def _column_size(column: Column, heading: str, texts: Sequence[str], *, stacked: bool) -> _Size:
    """Return the least and the greatest width that a column can use."""
    head, cells = _size([heading]), _size(texts)
    least = max(cells.word, min(cells.line, PROSE_WIDTH)) if column.prose else cells.line
    # Rich gives an empty column a cell of its own.
    least = max(least, head.word if stacked else head.line, 1)
    # Stacked headings take no room from prose.
    return _Size(least, max(least, cells.line))


def _widths(sizes: Sequence[_Size], room: int) -> list[int] | None:
    """Share the room among columns, those that lack least first; None where it is too little."""
    widths = [size.word for size in sizes]
    spare = room - sum(widths)
    if spare < 0:
        return None
    order = sorted(range(len(sizes)), key=lambda index: sizes[index].line - sizes[index].word)
    for left, index in zip(range(len(order), 0, -1), order, strict=True):
        more = min(sizes[index].line - sizes[index].word, spare // left)
        widths[index] += more
        spare -= more
    return widths


def _wrapped(text: str, width: int) -> str:
    """Wrap a text between words; a word that is too long has a line of its own."""
    from rich.cells import cell_len

    lines: list[str] = []
    for paragraph in text.split("\n"):
        line, *rest = paragraph.split(" ")
        for word in rest:
            longer = f"{line} {word}"
            if cell_len(longer) > width:
                lines.append(line)
                longer = word
            line = longer
        lines.append(line)
    return "\n".join(lines)


def _print_grid(
    table: Table, headings: Sequence[str], texts: Sequence[Sequence[str]], widths: Sequence[int], console: "Console"
) -> None:
    from rich import box
    from rich.table import Table as Grid
    from rich.text import Text

    # Of the gap, the box fills one cell.
    grid = Grid(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, GAP - 1, 0, 0))
    for column, heading, width in zip(table.columns, headings, widths, strict=True):
        grid.add_column(
            Text(_wrapped(heading, width)), justify="right" if column.numeric else "left", width=width, no_wrap=True
        )
    for row in texts:
        grid.add_row(*(Text(_wrapped(text, width)) for text, width in zip(row, widths, strict=True)))
    console.print(grid)


def _print_blocks(table: Table, console: "Console", room: int) -> None:
    """Print a block for each row: a line for each quantity that it has, with label, value and unit."""
    from rich.table import Table as Grid
    from rich.text import Text

    for index, row in enumerate(table.texts()):
        found = [(column, printable(text)) for column, text in zip(table.columns, row, strict=True) if text]
        number = _size(text for column, text in found if column.numeric).line
        lines = [
            (printable(column.label), f"{text:>{number}} {column.unit}".rstrip() if column.numeric else text)
            for column, text in found
        ]
        sizes = [_size(line[part] for line in lines) for part in (0, 1)]
        widths = _widths(sizes, room - GAP) or [size.word for size in sizes]
        grid = Grid.grid(padding=(0, GAP, 0, 0))
        for width in widths:
            grid.add_column(width=width, no_wrap=True)
        for line in lines:
            grid.add_row(*(Text(_wrapped(text, width)) for text, width in zip(line, widths, strict=True)))
        if index:
            console.out()
        console.print(grid)


@contextmanager
def progress(what: str) -> Iterator[Callable[[int], None]]:
    """Give a function that counts one more of a total: a progress bar on a terminal, nothing elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _total: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda total: bar.update(task, total=total, advance=1)


@contextmanager
def rate(what: str, total: int) -> Iterator[Callable[[int], None]]:
    """Give a function that counts some more of a total: a bar with rate and time left on a terminal."""
    if not sys.stderr.isatty():
        yield lambda _count: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total, rate="compiling or reading compiled code")

        def advance(count: int) -> None:
            bar.advance(task, count)
            speed = bar.tasks[task].speed
            bar.update(task, rate=f"{speed:,.0f} {what}/s" if speed else "")

        yield advance
