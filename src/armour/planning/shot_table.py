"""The CSV file of a firing, to which shots are added as they are fired."""

import csv
from collections.abc import Sequence
from io import StringIO
from pathlib import Path

from armour.files import exists, read_text
from armour.statistics.v50 import Shots

HEADER = ("shot", "velocity_m_s", "result")


def with_shot(path: Path, velocity_m_s: float, result: str) -> str:
    """Return the text of a file of shots, which need not exist, with one more shot.

    The row has the columns of the file, and its result is spelt as the one before.  A shot that repeats another is
    named, in a column that all rows get if they have none.
    """
    text = read_text(path) if exists(path) else f"{','.join(HEADER)}\n"
    rows = [
        [cell.strip() for cell in row] for row in csv.reader(StringIO(text, newline="")) if any(map(str.strip, row))
    ]
    header, shots = rows[0], rows[1:]
    names = [row[header.index("shot")] for row in shots] if "shot" in header else []
    known = shots[-1][header.index("result")] if shots else result
    cells = {
        "shot": next_name(names, len(shots)),
        "velocity_m_s": f"{velocity_m_s:g}" if float(f"{velocity_m_s:g}") == velocity_m_s else repr(velocity_m_s),
        "result": _spelt(result, known),
    }
    row = [cells.get(name, "") for name in header]
    end = "\r\n" if "\r\n" in text else "\n"
    if row in shots:
        numbered = ([str(number), *shot] for number, shot in enumerate(shots, 1))
        return _csv([["shot", *header], *numbered, [cells["shot"], *row]], end)
    return f"{text}{'' if text.endswith(end) else end}{_csv([row], end)}"


def _csv(rows: Sequence[Sequence[str]], end: str) -> str:
    """Return the text of rows, each with an end of line."""
    made = StringIO()
    csv.writer(made, lineterminator=end).writerows(rows)
    return made.getvalue()


def _spelt(result: str, known: str) -> str:
    """Return a result as a word or a letter, in the case of a known one."""
    word = result[: len(known)] if len(known) == 1 else result
    return word.upper() if known.isupper() else word.capitalize() if known.istitle() else word


def next_name(names: Sequence[str], count: int) -> str:
    """Return the name of the shot after a number of shots: one more than the greatest number that is a name."""
    return str(max((int(name) for name in names if name.isdecimal()), default=count) + 1)


def added(shots: Shots, velocity_m_s: float, complete: bool) -> Shots:
    """Return shots with one more."""
    names = (*shots.names, next_name(shots.names, len(shots.complete))) if shots.names else ()
    return Shots((*shots.velocities_m_s, velocity_m_s), (*shots.complete, complete), shots.file, names)
