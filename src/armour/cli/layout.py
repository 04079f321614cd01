"""Tables and lines laid out for a given width, with every word, name and number whole.

A table that is too wide first gets headings of several lines, then narrow gaps and texts of several lines, and at last
becomes a block of lines for each row.  A terminal shows the first rows of a long table.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from rich.cells import cell_len

from armour.files import printable
from armour.reporting.table import Column, Table
from armour.reporting.text import Verdict
from armour.units import ENDINGS

GAP = "  "
# Width of what goes into a pipe, where each row of a table stays on one line.
UNLIMITED = 1_000_000
# Rows on a terminal of a table that has the rest elsewhere.
MOST_ROWS = 25
# How a table is made to fit, one after the other.
PLAIN, STACKED, NARROW = range(3)
# Least width of a column of prose before the table becomes blocks.
PROSE_WIDTH = 16
# A space at which a line may end: any but the one between a number and its unit.
BREAK = re.compile(rf"(?<!\d) | (?!(?:J|{'|'.join(ENDINGS.values())})(?!\w))")


# Makes a line bold and, on request, coloured.
Style = Callable[..., str]


def plain(text: str, _colour: str = "") -> str:
    """Return a text as it is, for output that no terminal shows."""
    return text


def rendered(items: Iterable[Table | str], room: int, *, title: str = "", style: Style = plain) -> str:
    """Format tables and lines, with an empty line between a table and what stands above it."""
    lines = [*map(style, _wrapped(printable(title), room))] if title else []
    above: Table | str = ""
    for item in items:
        close = not above or (isinstance(above, Verdict) and isinstance(item, Table) and item.record)
        above = item
        if isinstance(item, str):
            own = _wrapped(printable(item), room)
            lines += (
                [style(line, "green" if item.good else "red") for line in own] if isinstance(item, Verdict) else own
            )
            continue
        if not close or (title and item.title):
            lines.append("")
        if item.title:
            lines += map(style, _wrapped(printable(item.title), room))
        lines += _table_lines(item, room, style)
    return "".join(f"{line.rstrip(' ')}\n" for line in lines)


def _table_lines(table: Table, room: int, style: Style) -> list[str]:
    more = len(table.rows) - MOST_ROWS
    if table.rest and room < UNLIMITED and more > 0:
        table = replace(table, rows=table.rows[:MOST_ROWS])
        last = _wrapped(f"{more} more rows: {table.rest}", room)
        return [*_table_lines(table, room, style), *last]
    texts = [[printable(text) for text in row] for row in table.texts()]
    for fit in () if table.record else (PLAIN, STACKED, NARROW):
        headings = [_heading(column, fit) for column in table.columns]
        cells = [[row[index] for row in texts] for index in range(len(headings))]
        limits = [_limits(*column, fit) for column in zip(table.columns, headings, cells, strict=True)]
        gap = GAP if fit != NARROW else " "
        widths = _shared(limits, room, gap)
        if widths is not None:
            right = [column.numeric for column in table.columns]
            head = [style(line) for line in _grid([headings], widths, right, gap, at_bottom=True)]
            rule = "─" * (sum(widths) + len(gap) * (len(widths) - 1))
            return [*head, rule, *_grid(texts, widths, right, gap)]
    return _blocks(table, texts, room)


def _heading(column: Column, fit: int) -> str:
    """Return a heading; unless plain, its unit has a line of its own."""
    separator = (", ", ",\n", "\n")[fit]
    return separator.join(printable(part) for part in (column.label, column.unit) if part)


def _limits(column: Column, heading: str, cells: Sequence[str], fit: int) -> tuple[int, int]:
    """Return the least and the greatest width that a column can use."""
    longest, stacked = _longest(cells), fit != PLAIN
    least = max(_longest_word(cells), min(longest, PROSE_WIDTH)) if column.prose else longest
    if fit == NARROW and not column.numeric:
        least = _longest_word(cells)
    # Stacked headings are wrapped, and take no room from prose.
    least = max(least, _longest_word([heading]) if stacked else cell_len(heading))
    return least, max(least, longest)


def _longest(texts: Iterable[str]) -> int:
    return max(map(cell_len, texts), default=0)


def _longest_word(texts: Iterable[str]) -> int:
    return _longest(word for text in texts for line in text.split("\n") for word in BREAK.split(line))


def _shared(limits: Sequence[tuple[int, int]], room: int, gap: str = GAP) -> list[int] | None:
    """Return the widths of columns, with room for those first that lack least; None if it is too little."""
    widths = [least for least, _ in limits]
    spare = room - sum(widths) - len(gap) * (len(widths) - 1)
    if spare < 0:
        return None
    lacking = [greatest - least for least, greatest in limits]
    order = sorted(range(len(limits)), key=lacking.__getitem__)
    for left, index in zip(range(len(order), 0, -1), order, strict=True):
        more = min(lacking[index], spare // left)
        widths[index] += more
        spare -= more
    return widths


def _grid(
    rows: Iterable[Sequence[str]],
    widths: Sequence[int],
    right: Sequence[bool],
    gap: str = GAP,
    *,
    at_bottom: bool = False,
) -> list[str]:
    """Lay rows out in columns; a row is as high as its text of most lines."""
    lines = []
    for row in rows:
        cells = [_wrapped(text, width) for text, width in zip(row, widths, strict=True)]
        height = max(map(len, cells), default=0)
        for cell in cells:
            missing = [""] * (height - len(cell))
            cell[:] = [*missing, *cell] if at_bottom else [*cell, *missing]
        for parts in zip(*cells, strict=True):
            lines.append(gap.join(map(_padded, parts, widths, right)))
    return lines


def _padded(text: str, width: int, right: bool) -> str:
    space = " " * (width - cell_len(text))
    return space + text if right else text + space


def _wrapped(text: str, width: int) -> list[str]:
    """Wrap a text between words; a word that is too long has a line of its own."""
    lines: list[str] = []
    for paragraph in text.split("\n"):
        line, *words = BREAK.split(paragraph)
        for word in words:
            if cell_len(f"{line} {word}") <= width:
                line = f"{line} {word}"
            else:
                lines.append(line)
                line = word
        lines.append(line)
    return lines


def _blocks(table: Table, texts: Sequence[Sequence[str]], room: int) -> list[str]:
    """Lay out a block for each row: a line for each quantity that it has, with label, value and unit."""
    lines = []
    for index, row in enumerate(texts):
        found = [(column, text) for column, text in zip(table.columns, row, strict=True) if text]
        number = _longest(text for column, text in found if column.numeric)
        labels = [printable(column.label) for column, _ in found]
        values = [f"{text:>{number}}" if column.numeric else text for column, text in found]
        values = [
            f"{value} {column.unit}".rstrip() if value[-1].isdigit() else value
            for value, (column, _) in zip(values, found, strict=True)
        ]
        limits = [(_longest_word(texts), _longest(texts)) for texts in (labels, values)]
        widths = _shared(limits, room) or [least for least, _ in limits]
        lines += [""] if index else []
        lines += _grid(zip(labels, values, strict=True), widths, (False, False))
    return lines
