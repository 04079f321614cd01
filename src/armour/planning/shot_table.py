"""The CSV file of a firing, to which shots are added as they are fired."""

import csv
from io import StringIO
from pathlib import Path

from armour.errors import InputError, Problem
from armour.files import read_text
from armour.statistics.v50 import Shots

HEADER = ("shot", "velocity_m_s", "result")


def with_shot(path: Path, velocity_m_s: float, result: str) -> str:
    """Return the text of a file of shots, which need not exist, with one more shot.

    The row has the columns of the file, and its result is spelt as the one before.
    """
    text = read_text(path) if path.exists() else f"{','.join(HEADER)}\n"
    rows = [
        [cell.strip() for cell in row] for row in csv.reader(StringIO(text, newline="")) if any(map(str.strip, row))
    ]
    header, shots = rows[0], rows[1:]
    names = [row[header.index("shot")] for row in shots] if "shot" in header else []
    last = names[-1] if names else "0"
    known = shots[-1][header.index("result")] if shots else result
    cells = {
        "shot": str(int(last) + 1 if last.isdecimal() else len(shots) + 1),
        "velocity_m_s": f"{velocity_m_s:g}" if float(f"{velocity_m_s:g}") == velocity_m_s else repr(velocity_m_s),
        "result": _spelt(result, known),
    }
    row = [cells[name] for name in header]
    if row in shots:
        message = f"repeats {','.join(row)}; where both took place, name them in a column shot"
        raise InputError([Problem(str(path), f"line {shots.index(row) + 2}", message)])
    end = "\r\n" if "\r\n" in text else "\n"
    made = StringIO()
    csv.writer(made, lineterminator=end).writerow(row)
    return f"{text}{'' if text.endswith(end) else end}{made.getvalue()}"


def _spelt(result: str, known: str) -> str:
    """Return a result as a word or a letter, in the case of a known one."""
    word = result[: len(known)] if len(known) == 1 else result
    return word.upper() if known.isupper() else word.capitalize() if known.istitle() else word


def added(shots: Shots, velocity_m_s: float, result: str) -> Shots:
    """Return shots with one more."""
    return Shots((*shots.velocities_m_s, velocity_m_s), (*shots.complete, result == "complete"), shots.file)
