"""Kill processes that use the folder of compiled code, damage its files, and let users and processes share it.

    python -m tools.campaigns.cache [NAME]...

runs the named campaigns, by default all; it counts how the trials ended, and exits with 3 if a process has not computed
what is right.  All but the last use a kernel that is soon compiled.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numba
import numpy as np

from armour.engine import cache, kernels, loops
from tests.helpers.faults import Fault, faults, full_disk
from tools.campaigns.sweeps import WRONG, exit_code, forked, run

KILLS, DAMAGES, RACES, REAL = 200, 240, 20, 5
TOGETHER = 6
COMPILED, LOADED, FAILED = 0, 1, 2
WORDS = {COMPILED: "compiled", LOADED: "loaded", FAILED: WRONG}
NOBODY = 65534
TIME_S = 60.0


def doubled(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    """Double a number: a kernel."""
    values[0] *= 2.0


def computed(home: Path, user: int = 0) -> int:
    """Compute by the kernel in this process, with a cache folder; return whether it was compiled or loaded."""
    os.environ["XDG_CACHE_HOME"] = str(home)
    if user:
        os.setuid(user)
    values = np.array([21.0])
    kernel = cache.kernel("doubled")
    kernel(values)
    hits = sum(kernel.stats.cache_hits.values())  # type: ignore[attr-defined]
    return FAILED if values[0] != 42.0 else LOADED if hits else COMPILED


def again(home: Path) -> str:
    """Tell how two processes end that come after."""
    return ", then ".join(WORDS.get(exit_code(forked(computed, home)), WRONG) for _ in range(2))


def at_step(home: Path, step: int, fault: Fault) -> int:
    """Compute with a fault at a step on files; return -1 if there are not so many."""
    with faults(step, fault) as steps:
        code = computed(home)
    return code if len(steps) > step else -1


def homes(folder: Path, count: int) -> Iterator[Path]:
    """Yield cache folders, empty and with compiled code in turn."""
    for number in range(count):
        home = folder / str(number)
        home.mkdir()
        if number % 2:
            exit_code(forked(computed, home))
        yield home
        shutil.rmtree(home)


def kills(folder: Path) -> Iterator[str]:
    """Kill processes that compile or load at random moments."""
    for home in homes(folder, KILLS):
        kind = "loading" if any(home.iterdir()) else "compiling"
        child = forked(computed, home)
        time.sleep(random.uniform(0.0, TIME_S))
        os.kill(child, signal.SIGKILL)
        killed = exit_code(child) < 0
        yield f"{'killed' if killed else 'ended before'} {kind}; {again(home)}"


def steps(folder: Path) -> Iterator[str]:
    """Kill processes at each of their steps on files."""

    def kill(_step: str) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    yield from at_each_step(folder, kill, -signal.SIGKILL)


def full(folder: Path) -> Iterator[str]:
    """Let the disk be full from each step on files on."""
    yield from at_each_step(folder, full_disk, COMPILED)


def at_each_step(folder: Path, fault: Fault, expected: int) -> Iterator[str]:
    """Disturb a process at each of its steps on files."""
    for step, home in enumerate(homes(folder, 2000)):
        code = exit_code(forked(at_step, home, step // 2, fault))
        if code == 255 and step % 2 == 0:
            return
        if code not in (expected, LOADED, 255):
            yield f"{WRONG}: {code} at step {step}"
        yield again(home)


def damages(folder: Path) -> Iterator[str]:
    """Damage a file of compiled code."""
    for number in range(DAMAGES):
        home = folder / str(number)
        home.mkdir()
        exit_code(forked(computed, home))
        index, code = (next(home.glob(f"*/*/*/*.{ending}")) for ending in ("nbi", "nbc"))
        chosen = random.choice([index, code])
        content = bytearray(chosen.read_bytes())
        kind = ("cut", "emptied", "exchanged", "deleted", "overwritten", "extended")[number % 6]
        if kind == "cut":
            os.truncate(chosen, random.randrange(len(content)))
        elif kind == "emptied":
            chosen.write_bytes(b"")
        elif kind == "exchanged":
            index.write_bytes(code.read_bytes())
            code.write_bytes(content if chosen is index else b"")
        elif kind == "deleted":
            chosen.unlink()
        elif kind == "overwritten":
            at = random.randrange(len(content))
            chosen.write_bytes(content[:at] + random.randbytes(len(content) - at))
        else:
            chosen.write_bytes(content + random.randbytes(100))
        yield f"{chosen.suffix} {kind}: {again(home)}"


def races(folder: Path) -> Iterator[str]:
    """Start processes at once, half of the times where a file is damaged."""
    for number, home in enumerate(homes(folder, RACES)):
        if number % 2:
            next(home.glob("*/*/*/*.nbc")).write_bytes(b"")
        children = [forked(computed, home) for _ in range(TOGETHER)]
        codes = [exit_code(child) for child in children]
        wrong = {*codes} - {COMPILED, LOADED}
        yield f"{WRONG}: {codes}" if wrong else f"{TOGETHER} right; {again(home)}"


def users(folder: Path) -> Iterator[str]:
    """Let another user use the folder, and the owner after it."""
    folder.parent.chmod(0o755)
    for home in homes(folder, 4):
        home.chmod(0o755)
        try:
            code = exit_code(forked(computed, home, NOBODY))
        except PermissionError:
            yield "not possible here"
            return
        yield f"another user: {WORDS.get(code, WRONG) if code != LOADED else WRONG}; {again(home)}"


def real(folder: Path) -> Iterator[str]:
    """Kill the first command of a user, which compiles for seconds, and run it again."""
    command = [sys.executable, "-m", "armour", "ballistic-limit", "wilkins", "--json"]
    expected, first_s = "", 0.0
    for number in range(REAL + 1):
        environment = {**os.environ, "XDG_CACHE_HOME": str(folder / str(number))}
        if expected:
            child = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(random.uniform(0.0, first_s))
            child.kill()
            child.wait()
        start = time.monotonic()
        found = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if not expected:
            expected, first_s = found.stdout, time.monotonic() - start
        yield "killed; right" if (found.stdout, found.returncode) == (expected, 0) else f"{WRONG}: {found.stderr}"


CAMPAIGNS = {f.__name__: f for f in (kills, steps, full, damages, races, users, real)}


def main(names: list[str]) -> int:
    """Run campaigns; return the exit code."""
    global TIME_S
    vars(loops)["doubled"], kernels.SIGNATURES["doubled"] = doubled, (numba.float64[::1],)
    # So that no child has to start numba, or to read files that are not its user's.
    kernels.compiled("doubled")
    cache.digest()
    with tempfile.TemporaryDirectory(prefix="cache-") as place:
        for _ in range(2):
            start = time.monotonic()
            assert exit_code(forked(computed, Path(place) / str(start))) == COMPILED
            TIME_S = time.monotonic() - start
        return run({name: CAMPAIGNS[name] for name in names or CAMPAIGNS}, Path(place))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
