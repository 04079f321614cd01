"""Time of the engine beside that of another commit, on the same designs, in turn in one run.

    python -m tools.benchmarks.against d3db797

checks the commit out in a temporary folder and lets both compute portions of the same random designs in turn, each in a
process with one thread.  The designs are those within the ranges that the model was compared with.  Printed are the
ratios of processor time, medians over the turns, and the mean number of runs of a ballistic limit.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from armour.engine import batch
from armour.evidence.tests import is_unusual
from tests.helpers.runs import random_designs
from tools.benchmarks.methods import HIGH, LOW, TOLERANCE

COUNT = 2000
PORTIONS, TURNS = 20, 10
HERE = Path(__file__).resolve().parents[2]

# Answers each line, which names a portion, with the time of its impacts and limits, s, and the runs of the latter.
TIMED = f"""
import sys
from time import thread_time
import numpy as np
from armour.engine import batch
with np.load(sys.argv[1]) as data:
    rows, velocities = data["rows"], data["velocities"]
one = batch.SolverOptions(threads=1)
for line in sys.stdin:
    i = int(line)
    some, at = rows[i :: {PORTIONS}].copy(), velocities[i :: {PORTIONS}].copy()
    start = thread_time()
    for _ in range(10):
        batch.impacts(some, at, one)
    middle = thread_time()
    limits = batch.ballistic_limits(some, {LOW}, {HIGH}, {TOLERANCE}, one)
    print((middle - start) / 10, thread_time() - middle, limits.runs.sum(), flush=True)
"""


def started(source: Path, data: Path) -> subprocess.Popen[str]:
    """Start the engine of a source tree."""
    environment = os.environ | {"PYTHONPATH": str(source)}
    command = [sys.executable, "-c", TIMED, str(data)]
    return subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def answer(engine: Any, portion: int) -> list[float]:
    """Return an engine's times of a portion, s, and its runs."""
    engine.stdin.write(f"{portion}\n")
    engine.stdin.flush()
    return [float(word) for word in engine.stdout.readline().split()]


def main() -> None:
    """Print the times and their ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit")
    commit = parser.parse_args().commit
    rows = batch.packed(random_designs(COUNT))
    rows = rows[~is_unusual(batch.fields(rows))]
    limits = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE).perforated
    with TemporaryDirectory() as folder:
        tree, data = Path(folder) / "tree", Path(folder) / "designs.npz"
        np.savez(data, rows=rows, velocities=1.05 * limits)
        git = ["git", "-C", str(HERE), "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", str(tree), commit], check=True)
        try:
            found = measured([tree / "src", HERE / "src"], data)
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)
    for what, times in zip(("impact", "ballistic limit"), np.moveaxis(found[..., :2], -1, 0), strict=True):
        old, new = 1e6 * np.median(times, axis=1).sum(axis=1) / len(rows)
        ratio = median((times[0] / times[1]).ravel().tolist())
        print(f"{what}: {old:.2f} µs at {commit}, {new:.2f} µs here, ratio {ratio:.2f}")
    old, new = found[:, 0, :, 2].sum(axis=1) / len(rows)
    print(f"runs of a ballistic limit: {old:.2f} at {commit}, {new:.2f} here, in the mean of {len(rows):,} designs")


def measured(sources: list[Path], data: Path) -> np.ndarray:
    """Return the answers of each source tree, by tree, turn and portion, without a first turn, which compiles."""
    engines = [started(source, data) for source in sources]
    answers = [[[answer(engine, i) for engine in engines] for i in range(PORTIONS)] for _ in range(TURNS + 1)]
    for engine in engines:
        engine.communicate()
    return np.moveaxis(np.array(answers[1:]), 2, 0)


if __name__ == "__main__":
    main()
