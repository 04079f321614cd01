"""Read random tables of shots as spreadsheets of three languages write them, and compare with what they hold.

    python -m tools.campaigns exports

A table is read, or read with its remarks quoted, or refused as a column divides its shots; it is then right once this
column is chosen by or ignored. One that is read to other numbers, results or rows is wrong, and so is a remark by which
a shot does not count, if it is not quoted.
"""

import tempfile
from collections import Counter
from pathlib import Path
from random import Random

from tests.helpers.spreadsheets import export
from tools.campaigns.verdict import asked, verdict

# Least share of tables that are read at once.
LEAST_READ = 0.5


def main() -> int:
    """Print how the tables were read."""
    options = asked(__doc__, tables=1_000, seed=7)
    dice, counts = Random(options.seed), Counter[str]()
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder:
        for _ in range(options.tables):
            counts[export(dice).ends(Path(folder) / "shots.csv")] += 1
    endings = ("read", "quoted", "refused", "asked")
    wrong = options.tables - sum(counts[ending] for ending in endings)
    shares = ("read", "with remarks quoted", "refused with cause", "right after `--ignore`")
    words = ", ".join(f"{counts[ending]:,} {share}" for ending, share in zip(endings, shares, strict=True))
    text = f"{options.tables:,} tables: {words}, {wrong} wrong"
    is_enough = counts["read"] + counts["quoted"] >= LEAST_READ * options.tables
    return verdict(text, right=not wrong and is_enough)
