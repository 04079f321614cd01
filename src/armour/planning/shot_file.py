"""Add a shot to the file of a firing, or take the last one back."""

import csv
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import StringIO
from itertools import chain
from pathlib import Path

from filelock import FileLock

from armour.columns import GROUPS, OUTCOME_WORDS, PAIRS, Column, columns_of, letters, perforates
from armour.csv_files import Source, decimal_mark, open_table, places_of, read_rows
from armour.errors import mistake
from armour.files import reason
from armour.statistics.v50 import SHOTS, TARGET, is_of_shots

HEADER = ("shot", "velocity_m_s", "result")


@contextmanager
def locked(path: Path | None) -> Iterator[None]:
    """Make a context in which no other command changes a file; without a file, it does nothing.

    The lock is on a file beside it, as the file itself is replaced.
    """
    if path is None:
        yield
        return
    target = Path(os.path.realpath(path))
    lock = FileLock(target.with_name(f".{target.name}.lock"))
    try:
        held = lock.acquire()
    except OSError as error:
        raise mistake(lock.lock_file, "", f"cannot be locked: {reason(error)}") from None
    with held:
        yield


def content_of(path: Path) -> bytes | None:
    """Return the content of a file; None if there is no such file."""
    return path.read_bytes() if path.exists() else None


def with_shot(
    path: Path, velocity_m_s: float, word: str, where: Mapping[str, str] | None = None, target: str = ""
) -> bytes:
    """Return the content of a file of shots with one more shot; the file need not exist.

    The new row has the columns, the unit and the decimal marks of the file, and words spelt like those of earlier
    shots.  ``word`` is the result; ``where`` has the cells of other columns, by name.  A new file also has a column of
    the ``target``, the armour and round, if they are known.
    """
    content = content_of(path)
    content = f"{','.join((*HEADER, *[TARGET] * bool(target)))}\n".encode() if content is None else content
    source = _open_csv(path, content)
    columns, shots = columns_of(source.header, (*HEADER, TARGET)), [cells for _, cells in source.lines]
    row = [""] * len(columns)
    for place, column in enumerate(columns):
        cells = [cells[place] for cells in shots]
        if column.known and column.key == "shot":
            row[place] = next_name(cells, len(shots))
        elif column.known and column.key in (*GROUPS, TARGET):
            row[place] = filled.pop() if len(filled := {*filter(None, cells)}) == 1 else ""
            row[place] = row[place] or (target if column.key == TARGET else "")
        elif column.known and column.key == "result":
            row[place] = _result_text(bool(perforates(word)), word, cells, column)
        elif column.known and column.counts:
            row[place] = _result_text(True, "no" if column.yes is False else "yes", cells, column)
        elif column.known and column.key == "velocity_m_s":
            usual = "," if source.separator == ";" else "."
            mark = decimal_mark(cells, column, source.separator) if {",", "."} & {*"".join(cells)} else usual
            row[place] = _velocity_text(velocity_m_s, column.factor).replace(".", mark or ".")
    for name, value in (where or {}).items():
        for place in places_of(source, columns, name):
            row[place] = value
    encoding = source.encoding
    end = "\r\n" if "\r\n".encode(encoding) in content else "\n"
    line = StringIO()
    csv.writer(line, delimiter=source.separator, lineterminator=end).writerow(row)
    begun = "" if content.endswith("\n".encode(encoding)) else end
    return content + (begun + line.getvalue()).encode(encoding)


def without_last(path: Path, where: Mapping[str, str] | None = None, ignore: Collection[str] = ()) -> tuple[bytes, str]:
    """Return the content of a file of shots without the last shot, and the line of this shot, after its number.

    It is the last one that counts and has the cells `where`, by column; columns to `ignore` do not divide the shots.
    """
    content = content_of(path) or b""
    source = _open_csv(path, content)
    rows = read_rows(source, SHOTS, where, 0, ignore, closed=False).rows if source.header else []
    source.refuse()
    if not rows:
        raise mistake(path, "", "must have a shot to take back, found none")
    # Lines that are not UTF-8 stay as they are.
    is_utf16 = source.encoding.startswith("utf-16")
    encoding, errors = (source.encoding, "strict") if is_utf16 else ("utf-8", "surrogateescape")
    lines = [*StringIO(content.decode(encoding, errors), newline="")]
    taken = lines.pop(int(rows[-1].place.removeprefix("line ")) - 1)
    return "".join(lines).encode(encoding, errors), f"{rows[-1].place}: {taken.strip()}"


def _open_csv(path: Path, content: bytes) -> Source:
    """Open a file of shots with this content, which is to be changed; raise an InputError if it is not CSV."""
    source = open_table(path, is_of_shots, content=content)
    if not source.separator:
        raise mistake(path, "", "must be a CSV file for a shot to be added or taken back")
    return source


def _velocity_text(velocity_m_s: float, factor: float) -> str:
    """Return a velocity as the text of a cell whose unit is `factor` m/s: exact in m/s, else with nine digits."""
    value = velocity_m_s / factor
    return f"{value:.9g}" if factor != 1.0 else f"{value:g}" if float(f"{value:g}") == value else repr(value)


def _result_text(says: bool, word: str, cells: Sequence[str], column: Column) -> str:
    """Return the cell of a new row in a column of results, or of which shots count, in words as the column has them.

    The cell means `says`: whether the shot perforated, or counts.  It is the last of the earlier `cells` that mean the
    same.  Without one, it is the counterpart of the last word in the column or else `word`, capitalised like the last
    word.
    """
    meant = column.words(cells)
    if same := [cell for cell, text in zip(cells, meant, strict=True) if column.says(text) == says]:
        return same[-1]
    if meant is not cells:
        return ""
    example = next((cell for cell in reversed(cells) if cell), "")
    pairs = [pair for pair in PAIRS if letters(example) in map(letters, pair)]
    word = next(text for text in (*chain(*pairs), word, *OUTCOME_WORDS[0]) if column.says(text) == says)
    return word.upper() if example.isupper() else word[0].upper() + word[1:] if example[:1].isupper() else word


def next_name(names: Sequence[str], count: int) -> str:
    """Return the name of the next shot: the greatest number among the names, or else the number of shots, plus 1."""
    numbers = (int(name) for name in names if name.isdecimal() and len(name) <= 15)
    return str(max(numbers, default=count) + 1)
