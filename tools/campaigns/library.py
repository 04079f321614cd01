"""Damage the compiled code, remove it, plant others, and compute: no number may be wrong, and no foreign code may run.

    python -m tools.campaigns library

Each trial is a process with a copy of the package.
"""

import os
import platform
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from armour.engine import compiled
from tools.campaigns.trials import WRONG, run

DAMAGES, PLANTED = 120, 20
COMPUTE = """
import logging, sys
logging.basicConfig(format="%(message)s")
import numpy as np
from armour.engine import batch
from tests.helpers.runs import random_designs
rows = batch.packed(random_designs(12)).repeat(25, axis=0)
print(hash(batch.impacts(rows, np.linspace(300.0, 1200.0, len(rows))).V.tobytes()))
"""
# Leaves a file where it is loaded; another library than that of the engine, with its names.
FOREIGN = """
#include <stdio.h>
__attribute__((constructor)) static void run(void) { fclose(fopen("%s", "w")); }
void armour_impacts(void) {}
void armour_ballistic_limits(void) {}
"""


# What each process has printed.
expected: list[str] = []


def copied(folder: Path) -> Path:
    """Return the folder of the engine in a copy of the package, as installed."""
    root = compiled.FOLDER.parents[2]
    for name in ("src", "configs", "scenarios", "suites"):
        shutil.copytree(root / name, folder / name, symlinks=True)
    return folder / "src" / "armour" / "engine"


def computed(engine: Path, here: Path, **environment: str) -> str:
    """Compute in a process, and say by what."""
    path = os.pathsep.join([str(engine.parents[1]), str(compiled.FOLDER.parents[2])])
    command = [sys.executable, "-P", "-c", COMPUTE]
    variables = {**os.environ, "PYTHONHASHSEED": "0", "PYTHONPATH": path, **environment}
    done = subprocess.run(command, cwd=here, env=variables, capture_output=True, text=True, check=False)
    # The first trial is undisturbed.
    expected.append(done.stdout)
    if done.returncode or done.stdout != expected[0]:
        return f"{WRONG}: exit code {done.returncode} {done.stderr[-200:]}"
    return "right, by plain Python" if "plain Python" in done.stderr else "right, by compiled code"


def library_in(engine: Path) -> Path:
    """Return the file of the compiled code."""
    return next(engine.glob("compiled-*.so"))


def damages(folder: Path) -> Iterator[str]:
    """Cut the file, or change one of its bytes."""
    engine = copied(folder)
    file, content = library_in(engine), library_in(engine).read_bytes()
    for number in range(DAMAGES):
        place = random.randrange(len(content))
        damaged = content[:place] + bytes([content[place] ^ random.randrange(1, 256)]) + content[place + 1 :]
        file.write_bytes(damaged if number % 2 else content[:place])
        yield f"{'changed' if number % 2 else 'cut'}: {computed(engine, folder)}"


def others(folder: Path) -> Iterator[str]:
    """Take the library away, edit what it is made from, and put those of another version or system in its place."""
    engine = copied(folder)
    file, content = library_in(engine), library_in(engine).read_bytes()
    yield f"as it is: {computed(engine, folder)}"
    for source in (engine / "loops.py", engine.parent / "core" / "search.py"):
        text = source.read_bytes()
        source.write_bytes(text + b"# edited\n")
        yield f"other sources: {computed(engine, folder)}"
        source.write_bytes(text)
    file.unlink()
    yield f"missing: {computed(engine, folder)}"
    foreign = bytearray(content)
    foreign[18:20] = b"\xb7\x00" if platform.machine() == "x86_64" else b"\x3e\x00"  # the machine, in an ELF file
    (engine / compiled.library_name(bytes(foreign))).write_bytes(foreign)
    yield f"another system: {computed(engine, folder)}"


def planted(folder: Path) -> Iterator[str]:
    """Put foreign code into the current folder, a user's cache and the folders of libraries."""
    engine = copied(folder)
    name, ran, source = library_in(engine).name, folder / "ran", folder / "foreign.c"
    source.write_text(FOREIGN % ran)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", folder / "foreign.so", source], check=True)
    for number in range(PLANTED):
        here = folder / str(number)
        places = [here, here / "armour" / "engine", here / ".cache" / "armour", here / "lib"]
        for place in places:
            place.mkdir(parents=True, exist_ok=True)
            for each in (name, compiled.library_name((folder / "foreign.so").read_bytes()), "compiled.so"):
                shutil.copy(folder / "foreign.so", place / each)
        variables = {"LD_LIBRARY_PATH": str(here / "lib"), "XDG_CACHE_HOME": str(here / ".cache"), "HOME": str(here)}
        chosen = dict(random.sample([*variables.items()], random.randint(0, 3)))
        outcome = computed(engine, here, **chosen)
        yield f"{WRONG}: foreign code ran" if ran.exists() else outcome


def main() -> int:
    """Print how the trials ended."""
    return run(others, damages, planted)
