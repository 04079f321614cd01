"""Lay out tables and lines for the width of a terminal, without breaking any word, name or number.

If a table is too wide, its headings are stacked; then gaps are narrowed and texts wrapped; at last each row becomes a
block of lines.  Of a long table, a terminal shows the first rows.  The library rich draws the tables.  It cuts words
that have no room, so this module first checks whether the least widths of the columns fit.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from io import StringIO
from typing import Any

from rich.box import Box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from armour.files import printable
from armour.reporting.table import Column, Table, VerdictLine, unbroken

COLUMN_GAP = 2
# Width of output to a pipe, so large that each row of a table stays on one line.
UNLIMITED = 1_000_000
# Largest number of rows that a terminal shows of a table whose other rows are found elsewhere.
MOST_ROWS = 25
# Styles of a line with an answer, by whether it is good.
STYLES = {None: "bold", True: "bold green", False: "bold red"}
# Layouts of a table, tried one after the other until it fits.
PLAIN_LAYOUT, STACKED, NARROW = range(3)
# Least width of a column of prose.
PROSE_WIDTH = 16
# Stands for a no-break space, at which rich would break a line: a character that no printable text contains.
STAND_IN = "\ue000"
# Box of rich with a line below the headings alone.
ROW_RULE = Box("    \n    \n ── \n    \n    \n    \n    \n    \n")


def rendered(items: Iterable[Table | str], width: int, colours: Any = None) -> str:
    """Format tables and lines for a width in characters, with an empty line above each table.

    ``colours`` is the name in rich of the terminal's colour system; if it is None, nothing is bold or coloured.
    """
    shown = StringIO()
    # Wider than any line, as rich would cut lines that are too long.
    console = Console(file=shown, width=UNLIMITED, height=1, color_system=colours, force_terminal=bool(colours))
    above: Table | str = ""
    for item in items:
        adjoins = not above or (isinstance(above, VerdictLine) and isinstance(item, Table) and item.record)
        above = item
        if isinstance(item, Table):
            if not adjoins:
                console.print()
            for part in _parts(console, item, width):
                console.print(part)
        else:
            style = ("yellow" if item.unsure else STYLES[item.good]) if isinstance(item, VerdictLine) else ""
            console.print(_text(console, item, width, style))
    lines = shown.getvalue().replace(STAND_IN, " ").split("\n")
    return "\n".join(line.rstrip(" ") for line in lines)


def _text(console: Console, text: str, width: int, style: str = "") -> Text:
    """Wrap a text between words to a width, characters, or to its longest word if that is wider."""
    words = Text(_unbroken(text), style)
    return Text("\n").join(words.wrap(console, max(width, _longest_word([words.plain]))))


def _unbroken(text: str) -> str:
    """Escape control characters, and replace the spaces between numbers and units by `STAND_IN`."""
    return unbroken(printable(text)).replace("\N{NO-BREAK SPACE}", STAND_IN)


def _parts(console: Console, table: Table, width: int) -> Iterator[Grid | Text | str]:
    """Yield what to print of a table: its title, its rows or the first of them, and how to see the rest."""
    if table.title:
        yield _text(console, table.title, width, "bold")
    hidden_rows = len(table.rows) - MOST_ROWS
    if table.rest and width < UNLIMITED and hidden_rows > 0:
        yield from _rows(replace(table, rows=table.rows[:MOST_ROWS]), width)
        yield _text(console, f"{hidden_rows} more rows: {table.rest}", width)
    else:
        yield from _rows(table, width)


def _rows(table: Table, width: int) -> Iterator[Grid | str]:
    """Yield the rows of a table in the first layout that fits or, if none does or it is a record, as blocks."""
    texts = [[_unbroken(text) for text in row] for row in table.texts()]
    for layout in () if table.record else (PLAIN_LAYOUT, STACKED, NARROW):
        headings = [_heading(column, layout) for column in table.columns]
        cells = [[row[index] for row in texts] for index in range(len(headings))]
        limits = [_limits(*column, layout) for column in zip(table.columns, headings, cells, strict=True)]
        gap = COLUMN_GAP if layout != NARROW else 1
        widths = _widths_that_fit(limits, width, gap)
        if widths is not None:
            yield _grid(texts, widths, [column.numeric for column in table.columns], gap, headings)
            return
    yield from _blocks(table, texts, width)


def _heading(column: Column, layout: int) -> str:
    """Return the heading of a column in a layout; unless that is plain, the unit has its own line."""
    separator = (", ", ",\n", "\n")[layout]
    return separator.join(_unbroken(part) for part in (column.label, column.unit) if part)


def _limits(column: Column, heading: str, cells: Sequence[str], layout: int) -> tuple[int, int]:
    """Return the least and the greatest width that a column can use in a layout, characters."""
    longest, stacked = _longest(cells), layout != PLAIN_LAYOUT
    least = max(_longest_word(cells), min(longest, PROSE_WIDTH)) if column.prose else longest
    if layout == NARROW and not column.numeric:
        least = _longest_word(cells)
    # Stacked headings are wrapped, so only their longest word counts.
    least = max(least, _longest_word([heading]) if stacked else cell_len(heading))
    return least, max(least, longest)


def _longest(texts: Iterable[str]) -> int:
    """Return the width of the widest text, characters."""
    return max(map(cell_len, texts), default=0)


def _longest_word(texts: Iterable[str]) -> int:
    """Return the width of the widest word in the texts, characters."""
    return _longest(word for text in texts for word in text.split())


def _widths_that_fit(limits: Sequence[tuple[int, int]], width: int, gap: int = COLUMN_GAP) -> list[int] | None:
    """Return the widths of columns that fit in a width with gaps between them; None if even the least widths do not.

    All widths are in characters; `limits` has the least and greatest of each column.  Columns that want least above
    their least width get it first.
    """
    widths = [least for least, _ in limits]
    spare = width - sum(widths) - gap * (len(widths) - 1)
    if spare < 0:
        return None
    shortfalls = [greatest - least for least, greatest in limits]
    order = sorted(range(len(limits)), key=shortfalls.__getitem__)
    for remaining, index in zip(range(len(order), 0, -1), order, strict=True):
        growth = min(shortfalls[index], spare // remaining)
        widths[index] += growth
        spare -= growth
    return widths


def _grid(
    rows: Iterable[Sequence[str]], widths: Sequence[int], right: Sequence[bool], gap: int, headings: Sequence[str] = ()
) -> Grid:
    """Return a grid of rich with rows in columns of given widths, characters, under headings if there are any.

    `right` says which columns are aligned at the right, and `gap` is the width between columns.
    """
    grid = Grid(box=ROW_RULE, show_header=bool(headings), show_edge=False, pad_edge=False, padding=(0, gap - 1, 0, 0))
    for index, width in enumerate(widths):
        heading = Text(headings[index]) if headings else ""
        grid.add_column(heading, width=width, justify="right" if right[index] else "left", overflow="fold")
    for row in rows:
        grid.add_row(*map(Text, row))
    return grid


def _blocks(table: Table, texts: Sequence[Sequence[str]], width: int) -> Iterator[Grid | str]:
    """Yield a block for each row of a table: a line for each cell that is not empty, with label, value and unit."""
    for index, row in enumerate(texts):
        filled = [(column, text) for column, text in zip(table.columns, row, strict=True) if text]
        number_width = _longest(text for column, text in filled if column.numeric)
        labels = [_unbroken(column.label) for column, _ in filled]
        values = [text.rjust(number_width, STAND_IN) if column.numeric else text for column, text in filled]
        units = [STAND_IN + column.unit if column.unit and text[-1].isdigit() else "" for column, text in filled]
        values = [value + unit for value, unit in zip(values, units, strict=True)]
        limits = [(_longest_word(column), _longest(column)) for column in (labels, values)]
        widths = _widths_that_fit(limits, width) or [least for least, _ in limits]
        if index:
            yield ""
        yield _grid(zip(labels, values, strict=True), widths, (False, False), COLUMN_GAP)
