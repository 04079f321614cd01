"""Read random tables of shots as spreadsheets of three languages write them, and compare with what they hold.

    python -m tools.campaigns.exports [--tables N] [--seed N]

A table that is refused is counted; one that is read to other numbers, results or rows is wrong.
"""

import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

import armour
from armour.errors import InputError
from tests.helpers.spreadsheets import Export, export
from tools.campaigns.verdict import asked, verdict

# Least share of tables that are read, and the relative size of rounding.
LEAST_READ, ROUNDING = 0.95, 1e-9


def ends(table: Export, path: Path) -> str:
    """Read a table; return how that ends."""
    path.write_bytes(table.content)
    try:
        shots = armour.read_shots(path)
    except InputError as error:
        return f"refused: {error.problems[0].message.split(', found')[0]}"
    expected = sorted(zip(table.velocities_m_s, table.complete, strict=True))
    found = sorted(zip(shots.velocities_m_s, shots.complete, strict=True))
    same = len(found) == len(expected) and all(
        abs(v - w) <= ROUNDING * w and perforated == complete
        for (v, perforated), (w, complete) in zip(found, expected, strict=True)
    )
    return "read" if same else "wrong"


def main() -> int:
    """Print how the tables were read."""
    options = asked(__doc__, tables=1_000, seed=7)
    dice, counts = Random(options.seed), Counter[str]()
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder:
        for _ in range(options.tables):
            counts[ends(export(dice), Path(folder) / "shots.csv")] += 1
    for ending, count in counts.most_common():
        print(f"{count} {ending}", flush=True)
    refused = options.tables - counts["read"] - counts["wrong"]
    text = f"{options.tables:,} tables: {counts['read']:,} read, {refused:,} refused, {counts['wrong']} wrong"
    return verdict(text, right=not counts["wrong"] and counts["read"] >= LEAST_READ * options.tables)


if __name__ == "__main__":
    sys.exit(main())
