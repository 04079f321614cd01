"""Time of the engine beside that of another commit, on the same designs, in turn in one run.

    python -m tools.benchmarks.against main~1

checks the commit out in a temporary folder, lets both compute the same random designs on one core, many times in turn,
and prints the shortest times and their ratios.
"""

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from armour.engine import batch
from tests.helpers.runs import random_designs

COUNT = 2000
TURNS = 5
HERE = Path(__file__).resolve().parents[2]
LOW, HIGH, TOLERANCE = 20.0, 4000.0, 3.5e-4  # m/s

TIMED = f"""
import sys
from time import perf_counter
import numpy as np
from armour.engine import batch
with np.load(sys.argv[1]) as data:
    rows, velocities = data["rows"], data["velocities"]
one = batch.SolverOptions(threads=1)

def shortest(compute, size, times):
    total = 0.0
    for start in range(0, len(rows), size):
        part = rows[start : start + size].copy(), velocities[start : start + size].copy()
        seconds = []
        for _ in range(times):
            begin = perf_counter()
            compute(*part)
            seconds.append(perf_counter() - begin)
        total += min(seconds)
    return 1e6 * total / len(rows)

print(shortest(lambda rows, velocities: batch.impacts(rows, velocities, one), 200, 40))
print(shortest(lambda rows, _: batch.ballistic_limits(rows, {LOW}, {HIGH}, {TOLERANCE}, one), 50, 4))
"""


def times(source: Path, data: Path) -> list[float]:
    """Return the shortest times of an impact and of a ballistic limit by the engine of a source tree, µs."""
    command = [sys.executable, "-c", TIMED, str(data)]
    found = subprocess.run(command, env={"PYTHONPATH": str(source)}, capture_output=True, text=True, check=True)
    return [float(line) for line in found.stdout.split()]


def main() -> None:
    """Print the times and their ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit")
    commit = parser.parse_args().commit
    rows = batch.packed(random_designs(COUNT))
    limits = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE).perforated
    with TemporaryDirectory() as folder:
        tree, data = Path(folder) / "tree", Path(folder) / "designs.npz"
        np.savez(data, rows=rows, velocities=1.05 * limits)
        subprocess.run(
            ["git", "-C", str(HERE), "worktree", "add", "--quiet", "--detach", str(tree), commit], check=True
        )
        try:
            pairs = [(times(tree / "src", data), times(HERE / "src", data)) for _ in range(TURNS)]
        finally:
            subprocess.run(["git", "-C", str(HERE), "worktree", "remove", "--force", str(tree)], check=True)
    before, here = (np.min([pair[side] for pair in pairs], axis=0) for side in (0, 1))
    for what, old, new in zip(("impact", "ballistic limit"), before, here, strict=True):
        print(f"{what}: {old:.2f} µs at {commit}, {new:.2f} µs here, ratio {old / new:.2f}")


if __name__ == "__main__":
    main()
