"""Measure the processor time of commands, and write it into the table of docs/performance.md.

python -m tools.benchmarks
"""

import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from tools.tables import table, write_tables

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"
OPTIMUM = "paper/optimum_7.62mm_AP"
TILES, PLATES = "--over=armour.ceramic_thickness_mm=2:11.98:0.02", "--over=armour.backing_thickness_mm=3:"
SWEEP = f"sweep wilkins {TILES} -o t.csv --force --quantities"
FINE = "--set=optimise.ceramic_thickness_mm.step=0.018018 --set=optimise.backing_thickness_mm.step=0.012012"
# Commands whose words the page shows, and others by what it calls them.
SHORT = (
    *("--help", "simulate wilkins", "ballistic-limit wilkins", "check wilkins", f"optimise {OPTIMUM}"),
    *("uncertainty uncertain", "sensitivity wilkins", "plan shots wilkins", "validate"),
)
COMMANDS = {
    **dict(zip(SHORT, SHORT, strict=True)),
    f"report {OPTIMUM}": f"report {OPTIMUM} -o report.html --force",
    "calibrate tests/wilkins": "calibrate tests/wilkins wilkins",
    "sweep, 1,000,000 impacts": f"{SWEEP} residual_velocity_m_s {PLATES}3.7996:4e-4",
    "sweep, 100,000 ballistic limits": f"{SWEEP} ballistic_limit_m_s {PLATES}3.0796:4e-4",
    "optimise, 1,000,000 designs": f"optimise {OPTIMUM} {FINE}",
    "uncertainty, 65,536 samples of 5 inputs": "uncertainty uncertain --set=uncertainty.samples=65536",
}
TURNS = 3


def used(arguments: list[str], folder: str) -> float:
    """Return the processor time of a command run in a folder, s."""
    command, null = [sys.executable, "-m", "armour", *arguments], subprocess.DEVNULL
    with subprocess.Popen(command, cwd=folder, stdout=null, stderr=null) as process:
        _, status, usage = os.wait4(process.pid, 0)
        code = process.returncode = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        raise RuntimeError(f"armour {' '.join(arguments)}: exit code {code}")
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    """Write the table of the page."""
    with TemporaryDirectory() as folder:
        rows = [
            [f"`{name}`", f"{median(used(command.split(), folder) for _ in range(TURNS)):.1f}"]
            for name, command in COMMANDS.items()
        ]
    write_tables(PAGE, table(("command", "s"), rows))


if __name__ == "__main__":
    main()
