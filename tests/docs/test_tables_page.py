"""The lists of docs/howto/tables.md are those of the code.

``python -m tests.docs.test_tables_page`` rewrites them.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from armour.columns import COUNTED, NAMES, OUTCOMES, UNITS, YES_OR_NO
from armour.units import words_and_unit

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "tables.md"


def table_of_names() -> str:
    """The names of the columns, as a table."""
    lines = ["| key | names | units |", "|---|---|---|"]
    for key, names in NAMES.items():
        if key in ("impact.velocity_m_s", "outcome"):
            continue
        own = [name for name in names if key != "test" or name not in NAMES["shot"]]
        units = UNITS.get(words_and_unit(key)[1], {})
        lines.append(f"| `{key}` | {', '.join(dict.fromkeys(own))} | {', '.join(units)} |")
    return "\n".join(lines)


def table_of_words(no: str, yes: str, pairs: Sequence[tuple[str, str]]) -> str:
    """Pairs of words, as a table."""
    return "\n".join([f"| {no} | {yes} |", "|---|---|", *(f"| {first} | {second} |" for first, second in pairs)])


def with_tables(page: str) -> str:
    tables = (
        table_of_names(),
        table_of_words("stopped", "perforated", OUTCOMES),
        table_of_words("does not count", "counts", (*YES_OR_NO, *COUNTED)),
    )
    for table in tables:
        header = table.partition(" |")[0]
        old = re.search(rf"^{re.escape(header)}.*\n(\|.*\n)+", page, re.MULTILINE)
        assert old is not None
        page = page.replace(old[0], f"{table}\n")
    return page


def test_the_page_has_all_names_and_words():
    assert with_tables(PAGE.read_text(encoding="utf-8")) == PAGE.read_text(encoding="utf-8")


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
