"""Kill processes that use the folder of compiled code, fill its disk, damage its files, and start several at once.

    python -m tools.campaigns.cache

All but the last trials use a kernel that is soon compiled.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numba
import numpy as np

from armour.engine import cache, kernels, loops
from tests.helpers.faults import Fault, faults, full_disk
from tools.campaigns.trials import WRONG, exit_code, forked, run

DAMAGES, RACES, REAL = 240, 20, 5
TOGETHER = 6
COMPILED, LOADED, FAILED = 0, 1, 2
WORDS = {COMPILED: "compiled", LOADED: "loaded", FAILED: WRONG}


def doubled(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    """Double a number: a kernel."""
    values[0] *= 2.0


def computed(home: Path) -> int:
    """Compute by the kernel in this process, with a cache folder; return whether it was compiled or loaded."""
    os.environ["XDG_CACHE_HOME"] = str(home)
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


def steps(folder: Path) -> Iterator[str]:
    """Kill processes at each of their steps on files."""
    yield from at_each_step(folder, lambda _step: os.kill(os.getpid(), signal.SIGKILL), -signal.SIGKILL)


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
    """Cut a file of compiled code, or change one of its bytes."""
    for number in range(DAMAGES):
        home = folder / str(number)
        home.mkdir()
        exit_code(forked(computed, home))
        file = next(home.glob(f"*/*/*.{random.choice(('nbi', 'nbc'))}"))
        content = bytearray(file.read_bytes())
        place = random.randrange(len(content))
        content[place] ^= random.randrange(1, 256)
        file.write_bytes(content[:place] if number % 2 else content)
        yield f"{file.suffix} {'cut' if number % 2 else 'changed'}: {again(home)}"


def races(folder: Path) -> Iterator[str]:
    """Start processes at once, half of the times where a file is damaged."""
    for number, home in enumerate(homes(folder, RACES)):
        if number % 2:
            next(home.glob("*/*/*.nbc")).write_bytes(b"")
        children = [forked(computed, home) for _ in range(TOGETHER)]
        codes = [exit_code(child) for child in children]
        wrong = {*codes} - {COMPILED, LOADED}
        yield f"{WRONG}: {codes}" if wrong else f"{TOGETHER} right; {again(home)}"


def real(folder: Path) -> Iterator[str]:
    """Kill the first command of a user, which compiles for seconds, and run it again."""
    command = [sys.executable, "-m", "armour", "optimise", "paper/optimum_7.62mm_AP", "--json"]
    expected = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    for number in range(REAL):
        environment = {**os.environ, "XDG_CACHE_HOME": str(folder / str(number))}
        child = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0.5, 8.0))
        child.kill()
        child.wait()
        after = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        yield "killed; right" if (after.stdout, after.returncode) == (expected, 0) else f"{WRONG}: {after.stderr}"


def main() -> int:
    """Disturb processes that use the folder of compiled code; return the exit code."""
    vars(loops)["doubled"], kernels.SIGNATURES["doubled"] = doubled, (numba.float64[::1],)
    # So that no child has to start numba.
    kernels.compiled("doubled")
    return run(steps, full, damages, races, real)


if __name__ == "__main__":
    sys.exit(main())
