"""Tables of the pages that programs write."""

import re
from collections.abc import Sequence
from pathlib import Path


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown; of the first two cells, those that repeat the row above are empty."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)]]
    above: Sequence[str] = ["", ""]
    for row in rows:
        same = 0 if row[0] != above[0] else 1 if row[1] != above[1] else 2
        lines.append([""] * same + [*row[same:]])
        above = row
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def write_tables(page: Path, *tables: str) -> None:
    """Write tables in place of those of a page, in their order."""
    remaining = iter(tables)
    text = page.read_text(encoding="utf-8")
    page.write_text(re.sub(r"(?:^\|.*\n)+", lambda _: f"{next(remaining)}\n", text, flags=re.M), encoding="utf-8")
