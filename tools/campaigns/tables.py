"""Record shots in pairs, kill the commands that record them, and save the table meanwhile: no shot may be lost.

    python -m tools.campaigns.tables [NAME]...

runs the named campaigns, by default all; it counts how the trials ended, and exits with 3 if one ended wrong.
"""

import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest.mock import patch

from armour.cli.app import app
from armour.engine.cache import kernel
from armour.errors import InputError
from armour.files import write_file
from armour.statistics.v50 import read_shots
from tests.helpers.faults import faults
from tools.campaigns.sweeps import WRONG, exit_code, forked, run

PAIRS, KILLS, SAVES = 50, 200, 50
TABLES = (
    "velocity_m_s,result\n700,partial\n771.5,complete\n",
    '\ufeffshot,velocity_m_s,"result"\r\n,700,PP\r\n\r\nno. 2, 771.5 ,CP',
)
# Time of a command, and of its writing.
COMMAND_S, WRITING_S = 60.0, 0.1


def recorded(table: Path, velocity_m_s: float) -> int:
    """Record a partial penetration and return the exit code."""
    args = ["plan", "shots", "wilkins", str(table), "--result", "partial", "--velocity-m-s", str(velocity_m_s)]
    with Path(os.devnull).open("w") as said, redirect_stdout(said), redirect_stderr(said):
        try:
            app(args, prog_name="armour")
        except SystemExit as end:
            return int(end.code or 0)
    return 70


def tables(folder: Path, count: int) -> Iterator[Path]:
    """Yield tables of two shots, of two kinds in turn."""
    for number in range(count):
        table = folder / f"{number}.csv"
        table.write_bytes(TABLES[number % 2].encode())
        yield table


def velocities(table: Path) -> list[float]:
    """Return the velocities in a table, m/s; none if it cannot be read."""
    try:
        return sorted(read_shots(table).velocities_m_s)
    except InputError:
        return []


def pairs(folder: Path) -> Iterator[str]:
    """Record two shots at once."""
    for number, table in enumerate(tables(folder, PAIRS)):
        if number % 5 == 4:
            table.unlink()
        there = velocities(table) if table.exists() else []
        children = []
        for velocity in (720.0, 730.0):
            children.append(forked(recorded, table, velocity))
            time.sleep(random.choice((0.0, random.uniform(0.0, COMMAND_S))))
        codes = [exit_code(child) for child in children]
        found = sorted(read_shots(table, one_kind=True).velocities_m_s)
        both = codes == [0, 0] and found == sorted([*there, 720.0, 730.0])
        yield (
            f"both there, {'new table' if not there else 'table of two shots'}" if both else f"{WRONG}: {codes} {found}"
        )


def ended(table: Path, before: bytes, code: int) -> str:
    """Return how the recording of a shot ended: whole, or not at all."""
    now = table.read_bytes()
    if now == before and code:
        outcome = "not recorded"
    elif now.startswith(before) and velocities(table) == [700.0, 720.0, 771.5]:
        outcome = "recorded"
    else:
        return f"{WRONG}: {code} {now!r}"
    left = [path for path in table.parent.iterdir() if path.name.startswith(".armour-")]
    for path in left:
        path.unlink()
    return f"{outcome}, {len(left)} hidden files left"


def recorded_telling(table: Path, velocity_m_s: float, pipe: int) -> int:
    """Record a shot; tell by a pipe when it is about to be written."""

    def telling(*args: Any) -> Any:
        os.write(pipe, b".")
        return write_file(*args)

    with patch("armour.cli.runner.write_file", telling):
        return recorded(table, velocity_m_s)


def kills(folder: Path) -> Iterator[str]:
    """Kill the recording of a shot at a random moment, and while it is written, in turn; then record another one."""
    for number, table in enumerate(tables(folder, KILLS)):
        before = table.read_bytes()
        reading, writing = os.pipe()
        child = forked(recorded_telling, table, 720.0, writing)
        if number % 2:
            os.read(reading, 1)
        time.sleep(random.uniform(0.0, WRITING_S if number % 2 else COMMAND_S))
        os.kill(child, signal.SIGKILL)
        code = exit_code(child)
        outcome = ended(table, before, code)
        if number % 10 < 2 and (exit_code(forked(recorded, table, 740.0)) or 740.0 not in velocities(table)):
            outcome = f"{WRONG}: no shot after it"
        os.close(reading)
        os.close(writing)
        yield f"{'while writing' if number % 2 else 'at any moment'}: {'killed' if code else 'ended before'}, {outcome}"


def killed_at(table: Path, velocity_m_s: float, step: int) -> int:
    """Record a shot, killed at a step on files; return -1 if there are not so many."""
    with faults(step, lambda _step: os.kill(os.getpid(), signal.SIGKILL)):
        return recorded(table, velocity_m_s) or -1


def steps(folder: Path) -> Iterator[str]:
    """Kill the recording of a shot at each of its steps on files."""
    for step, table in enumerate(tables(folder, 1000)):
        before = table.read_bytes()
        code = exit_code(forked(killed_at, table, 720.0, step))
        if code == 255:
            return
        yield ended(table, before, code)


def saves(folder: Path) -> Iterator[str]:
    """Save the table with a shot more, as an editor does, while a shot is recorded."""
    for table in tables(folder, SAVES):
        saved = (
            table.read_bytes().rstrip() + b"\r\n" + (b"9,760,PP" if b"shot" in table.read_bytes() else b"760,partial")
        )
        child = forked(recorded, table, 720.0)
        time.sleep(random.uniform(0.0, COMMAND_S))
        new = table.with_suffix(".new")
        new.write_bytes(saved)
        new.replace(table)
        code = exit_code(child)
        found = velocities(table)
        if found == [700.0, 720.0, 760.0, 771.5] and code == 0:
            yield "saved before it was read: both there"
        elif found == [700.0, 760.0, 771.5]:
            yield "saved meanwhile: refused" if code == 2 else "saved once it was written"
        else:
            yield f"{WRONG}: {code} {found}"


CAMPAIGNS = {f.__name__: f for f in (pairs, kills, steps, saves)}


def main(names: list[str]) -> int:
    """Run campaigns; return the exit code."""
    global COMMAND_S
    kernel("impacts")
    with tempfile.TemporaryDirectory(prefix="tables-") as place:
        for table in tables(Path(place), 2):
            recorded(table, 720.0)
            start = time.monotonic()
            assert exit_code(forked(recorded, table, 720.0)) == 0
            COMMAND_S = time.monotonic() - start
        return run({name: CAMPAIGNS[name] for name in names or CAMPAIGNS}, Path(place))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
