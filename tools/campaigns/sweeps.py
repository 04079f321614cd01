"""Kill sweeps, start two to one output, and fill disks: each ends right or with a message.

python -m tools.campaigns sweeps
"""

import os
import random
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from armour.sweeps import sweep as sweeps
from tests.helpers.cases import SCENARIOS
from tools.campaigns.trials import WRONG, command, exit_code, forked, run, timed

OVER = ["--over", "armour.ceramic_thickness_mm=2:12:0.05", "--over", "impact.velocity_m_s=700:900:20"]
QUANTITIES = ("residual_velocity_m_s,outcome", "penetration_depth_mm")
ENDINGS = ("csv", "parquet")
KILLS, PAIRS, FULL = 100, 50, 20
# Rows of a chunk: a sweep has twelve.
CHUNK = 200

references: dict[tuple[str, str], bytes] = {}
# The shortest time of a sweep, s.
sweep_s = [60.0]


def sweep(output: Path, quantities: str = QUANTITIES[0], *more: str) -> int:
    """Run a sweep and return its exit code; its messages go to a file beside the output."""
    args = ["sweep", str(SCENARIOS / "wilkins.toml"), *OVER, "--quantities", quantities]
    return command([*args, *more, "-o", str(output)], Path(f"{output.parent}.messages"))


def resumed(output: Path) -> str:
    """Resume a sweep and say how that ended."""
    was_complete = output.exists()
    code = exit_code(forked(sweep, output))
    if was_complete and code == 2 and "exists already" in messages(output) and not wrong(output):
        return "complete before"
    if code or "Traceback" in messages(output) or list(output.parent.iterdir()) != [output] or wrong(output):
        return f"{WRONG}: {code} {messages(output)}"
    return "resumed, equal"


def messages(output: Path) -> str:
    """Return what the sweeps to an output said."""
    return Path(f"{output.parent}.messages").read_text()


def wrong(output: Path, quantities: str = QUANTITIES[0]) -> bool:
    """Return whether a table is not to the byte that of an undisturbed sweep."""
    return output.read_bytes() != references[output.suffix, quantities]


def outputs(folder: Path, count: int) -> Iterator[Path]:
    """Yield outputs in new folders, CSV and Parquet in turn."""
    for number in range(count):
        output = folder / f"{number}" / f"t.{ENDINGS[number % 2]}"
        output.parent.mkdir()
        yield output


def kills(folder: Path) -> Iterator[str]:
    """Kill sweeps at random moments, some of them several times, and resume them."""
    for number, output in enumerate(outputs(folder, KILLS)):
        times = 1 + number % 3
        for _ in range(times):
            child = forked(sweep, output)
            time.sleep(random.uniform(0.2, 0.9) * sweep_s[0])
            os.kill(child, signal.SIGKILL)
            exit_code(child)
        yield f"killed {times} times; {resumed(output)}"


def pairs(folder: Path) -> Iterator[str]:
    """Start pairs of sweeps of different quantities to one output."""
    refusals = ("another sweep is writing", "exists already", "contains rows", "cannot be written")
    for output in outputs(folder, PAIRS):
        children = []
        for quantities in QUANTITIES:
            children.append(forked(sweep, output, quantities))
            time.sleep(random.choice((0.0, random.uniform(0.0, sweep_s[0]))))
        codes = [exit_code(child) for child in children]
        said = messages(output)
        if sorted(codes) != [0, 2] or "Traceback" in said or wrong(output, QUANTITIES[codes.index(0)]):
            yield f"{WRONG}: {codes} {said}"
        else:
            yield next((text for text in refusals if text in said), f"{WRONG}: {said}")


def full(folder: Path) -> Iterator[str]:
    """Sweep to small file systems that fill up; make them larger and resume."""
    for number, output in enumerate(outputs(folder, FULL)):
        mount = ["mount", "-t", "tmpfs", "-o", f"size={16 + 10 * number}k", "armour", str(output.parent)]
        if subprocess.run(mount, capture_output=True, check=False).returncode:
            yield "not possible here"
            return
        try:
            code = exit_code(forked(sweep, output, QUANTITIES[0], "--yes"))
            subprocess.run(["mount", "-o", "remount,size=10m", str(output.parent)], check=True)
            is_told = code == 0 or (code == 2 and "cannot be written: " in messages(output))
            yield f"exit code {code}; {resumed(output)}" if is_told else f"{WRONG}: {code} {messages(output)}"
        finally:
            subprocess.run(["umount", str(output.parent)], check=True)


def main() -> int:
    """Compute the tables of undisturbed sweeps, then disturb others; return the exit code."""
    sweeps.MAX_CHUNK = CHUNK
    with tempfile.TemporaryDirectory(prefix="sweeps-") as place:
        for ending in ENDINGS:
            for quantities in QUANTITIES:
                output = Path(place) / "reference" / f"{quantities}.{ending}"
                output.parent.mkdir(exist_ok=True)
                sweep_s[0] = min(sweep_s[0], timed(sweep, output, quantities))
                references[f".{ending}", quantities] = output.read_bytes()
    return run(kills, pairs, full)
