"""Record shots in pairs, kill the commands that record them, and save the table meanwhile: no shot may be lost.

python -m tools.campaigns tables
"""

import os
import random
import signal
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from armour.errors import InputError
from armour.statistics.v50 import read_shots
from tests.helpers.faults import faults
from tools.campaigns.trials import WRONG, command, exit_code, forked, run, timed

PAIRS, SAVES = 50, 50
TABLES = (
    "velocity_m_s,result\n700,partial\n771.5,complete\n",
    '\ufeffshot,velocity_m_s,"result"\r\n,700,PP\r\n\r\nno. 2, 771.5 ,CP',
)
# Time of a command, s.
command_s = [60.0]


def recorded(table: Path, velocity_m_s: float) -> int:
    """Record a partial penetration and return the exit code."""
    shot = ["--result", "partial", "--velocity-m-s", str(velocity_m_s)]
    return command(["plan", "shots", "wilkins", str(table), *shot], Path(os.devnull))


def tables(folder: Path, count: int) -> Iterator[Path]:
    """Yield tables of two shots, of two kinds in turn."""
    for number in range(count):
        table = folder / f"{number}.csv"
        table.write_bytes(TABLES[number % 2].encode())
        yield table


def velocities(table: Path) -> list[float]:
    """Return the velocities in a table, m/s; none if it cannot be read."""
    try:
        return sorted(read_shots(table, one_kind=True).velocities_m_s)
    except InputError:
        return []


def pairs(folder: Path) -> Iterator[str]:
    """Record two shots at once, in a table of two shots or in a new one."""
    for number, table in enumerate(tables(folder, PAIRS)):
        before = velocities(table)
        if number % 5 == 4:
            table.unlink()
            before = []
        children = []
        for velocity in (720.0, 730.0):
            children.append(forked(recorded, table, velocity))
            time.sleep(random.choice((0.0, random.uniform(0.0, command_s[0]))))
        codes = [exit_code(child) for child in children]
        after = velocities(table)
        kept = [velocity for velocity, code in zip((720.0, 730.0), codes, strict=True) if code == 0]
        right = kept and {*codes} <= {0, 2} and after == sorted([*before, *kept])
        yield f"{len(kept)} there, the others refused" if right else f"{WRONG}: {codes} {after}"


def killed_at(table: Path, step: int) -> int:
    """Record a shot, killed at a step on files; return -1 if there are not so many."""
    with faults(step, lambda _step: os.kill(os.getpid(), signal.SIGKILL)):
        return recorded(table, 720.0) or -1


def steps(folder: Path) -> Iterator[str]:
    """Kill the recording of a shot at each of its steps on files: it is recorded whole, or not at all."""
    for step, table in enumerate(tables(folder, 1000)):
        before = table.read_bytes()
        code = exit_code(forked(killed_at, table, step))
        if code == 255:
            return
        if table.read_bytes() == before:
            yield "not recorded"
        else:
            right = table.read_bytes().startswith(before) and velocities(table) == [700.0, 720.0, 771.5]
            yield "recorded" if right else f"{WRONG}: {code} {table.read_bytes()!r}"


def saves(folder: Path) -> Iterator[str]:
    """Save the table with a shot more, as an editor does, while a shot is recorded."""
    for table in tables(folder, SAVES):
        before = table.read_bytes()
        saved = before.rstrip() + b"\r\n" + (b"9,760,PP" if b"shot" in before else b"760,partial")
        child = forked(recorded, table, 720.0)
        time.sleep(random.uniform(0.0, command_s[0]))
        new = table.with_suffix(".new")
        new.write_bytes(saved)
        new.replace(table)
        code = exit_code(child)
        after = velocities(table)
        if after == [700.0, 720.0, 760.0, 771.5] and code == 0:
            yield "saved before it was read: both there"
        elif after == [700.0, 760.0, 771.5]:
            yield "saved meanwhile: refused" if code == 2 else "saved once it was written"
        else:
            yield f"{WRONG}: {code} {after}"


def main() -> int:
    """Disturb commands that record shots; return the exit code."""
    with tempfile.TemporaryDirectory(prefix="tables-") as place:
        command_s[0] = min(timed(recorded, table, 720.0) for table in tables(Path(place), 4))
    return run(pairs, steps, saves)
