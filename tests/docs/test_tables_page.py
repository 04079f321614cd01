"""The lists of docs/howto/tables.md are those of the code.

``python -m tests.docs.test_tables_page`` rewrites them.
"""

import re
from pathlib import Path

from armour.columns import NAMES, OUTCOMES, UNITS
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


def table_of_results() -> str:
    """The words for results, as a table."""
    return "\n".join(["| stopped | perforated |", "|---|---|", *(f"| {no} | {yes} |" for no, yes in OUTCOMES)])


def with_tables(page: str) -> str:
    for header, table in (("| key |", table_of_names()), ("| stopped |", table_of_results())):
        old = re.search(rf"^{re.escape(header)}.*\n(\|.*\n)+", page, re.MULTILINE)
        assert old is not None
        page = page.replace(old[0], f"{table}\n")
    return page


def test_the_page_has_all_names_and_words():
    assert with_tables(PAGE.read_text(encoding="utf-8")) == PAGE.read_text(encoding="utf-8")


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
