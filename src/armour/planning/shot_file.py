"""Add a shot to the file of a firing."""

import os
from codecs import BOM_UTF8
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from armour.csv_files import OUTCOMES, PERFORATED, read_csv
from armour.errors import mistake
from armour.files import reason
from armour.statistics.v50 import Shots

HEADER = ("shot", "velocity_m_s", "result")
# Time to wait for other commands that are adding a shot to the same file; each takes a second or two.
WAIT_S = 120.0
# Most digits of the number of a shot; a longer name is a name.
MOST_DIGITS = 15


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other commands from adding a shot to a file, by a lock file beside it, as the file itself is replaced."""
    target = Path(os.path.realpath(path))
    lock = FileLock(target.with_name(f".{target.name}.lock"), timeout=WAIT_S)
    try:
        held = lock.acquire()
    except Timeout:
        message = f"cannot be written: other commands have been adding shots to it for {WAIT_S:.0f} s"
        raise mistake(path, "", message) from None
    except OSError as error:
        raise mistake(lock.lock_file, "", f"cannot be locked: {reason(error)}") from None
    with held:
        yield


def content_of(path: Path) -> bytes | None:
    """Return the content of a file; None if there is no such file."""
    return path.read_bytes() if path.exists() else None


def with_shot(path: Path, velocity_m_s: float, word: str) -> bytes:
    """Return the content of a file of shots, which need not exist, with one more shot.

    The row has the columns of the file, and its result is spelt like that of the last shot.  If the row equals another
    one, all rows get a first column with the name of their shot.
    """
    content = content_of(path)
    lines = [(1, [*HEADER])] if content is None else [*read_csv(path)]
    content = f"{','.join(HEADER)}\n".encode() if content is None else content
    (_, header), *shots = lines
    names = [cells[header.index("shot")] for _, cells in shots] if "shot" in header else []
    word_before = shots[-1][1][header.index("result")] if shots else word
    texts = {
        "shot": next_name(names, len(shots)),
        "velocity_m_s": f"{velocity_m_s:g}" if float(f"{velocity_m_s:g}") == velocity_m_s else repr(velocity_m_s),
        "result": _spelt(word, word_before),
    }
    row = [texts.get(name, "") for name in header]
    if any(cells == row for _, cells in shots):
        row = [texts["shot"], *row]
        content = _named(content, [place for place, _ in lines])
    end = b"\r\n" if b"\r\n" in content else b"\n"
    return content + (b"" if content.endswith(b"\n") else end) + ",".join(row).encode() + end


def _named(content: bytes, places: Sequence[int]) -> bytes:
    """Return the content of a file with a first column of shots, numbered from 1, in the lines at some places."""
    lines = content.removeprefix(BOM_UTF8).splitlines(keepends=True)
    for name, place in enumerate(places):
        lines[place - 1] = f"{name or 'shot'},".encode() + lines[place - 1]
    return (BOM_UTF8 if content.startswith(BOM_UTF8) else b"") + b"".join(lines)


def _spelt(word: str, example: str) -> str:
    """Return a word for a result from the pair to which an example belongs, capitalised like the example."""
    pair = next(pair for pair in OUTCOMES if example.lower() in pair)
    word = pair[PERFORATED[word.lower()]]
    return word.upper() if example.isupper() else word.capitalize() if example.istitle() else word


def next_name(names: Sequence[str], count: int) -> str:
    """Return the name of the next shot: the greatest name that is a number or, without one, the count, plus 1."""
    numbers = (int(name) for name in names if name.isdecimal() and len(name) <= MOST_DIGITS)
    return str(max(numbers, default=count) + 1)


def added(shots: Shots, velocity_m_s: float, complete: bool) -> Shots:
    """Return shots with one more."""
    names = (*shots.names, next_name(shots.names, len(shots.complete))) if shots.names else ()
    return Shots((*shots.velocities_m_s, velocity_m_s), (*shots.complete, complete), shots.file, names)
