"""Tables on terminals of several widths and in pipes."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from armour.cli.layout import rendered
from armour.reporting.table import Column, Table, VerdictLine
from tests.helpers.examples import examples

PIPE = 1_000_000


def printed(*items: Table | str, width: int) -> list[str]:
    """Lines of a terminal without colours."""
    return rendered(items, width).splitlines()


def words(lines: list[str]) -> list[str]:
    return [word for line in lines for word in line.split()]


@pytest.fixture
def wide() -> Table:
    columns = (Column("name"), Column("areal density", "kg/m²", ".1f"), Column("ballistic limit", "m/s", ".1f"))
    return Table(columns, (("AD85 on 6061-T6", 39.24, 723.77), ("a", None, 1.0)))


def test_a_table_that_fits(wide: Table):
    assert printed(wide, width=70) == [
        "name             areal density, kg/m²  ballistic limit, m/s",
        "─" * 59,
        "AD85 on 6061-T6                  39.2                 723.8",
        "a                                                       1.0",
    ]


def test_headings_are_stacked_first(wide: Table):
    assert printed(wide, width=40) == [
        "                    areal  ballistic",
        "                 density,     limit,",
        "name                kg/m²        m/s",
        "─" * 36,
        "AD85 on 6061-T6      39.2      723.8",
        "a                                1.0",
    ]


def test_then_rows_become_blocks(wide: Table):
    assert printed(wide, width=22) == [
        "name       AD85 on",
        "           6061-T6",
        "areal       39.2 kg/m²",
        "density",
        "ballistic  723.8 m/s",
        "limit",
        "",
        "name           a",
        "ballistic      1.0 m/s",
        "limit",
    ]


def test_texts_are_wrapped_before_that(wide: Table):
    assert printed(wide, width=30) == [
        "               areal ballistic",
        "             density     limit",
        "name           kg/m²       m/s",
        "─" * 30,
        "AD85 on         39.2     723.8",
        "6061-T6",
        "a                          1.0",
    ]


def test_a_verdict_is_coloured_and_stands_at_its_numbers():
    table = Table.of_one(None, (Column("limit", "m/s", ".0f"), 724.0))

    for good, style in ((True, "1;32"), (False, "1;31"), (None, "1")):
        lines = rendered([VerdictLine("outcome", good=good), table], 80, "standard")
        assert lines.splitlines() == [f"\x1b[{style}moutcome\x1b[0m", "limit  724 m/s"]


def test_a_terminal_shows_the_first_rows_where_the_rest_is_elsewhere():
    table = Table((Column("a"),), (("1",),) * 30, rest="--csv FILE")
    assert printed(table, width=80)[-2:] == ["1", "5 more rows: --csv FILE"]
    assert len(printed(table, width=80)) == 2 + 25 + 1
    assert len(printed(table, width=PIPE)) == len(printed(replace(table, rest=""), width=80)) == 2 + 30


def test_a_record_is_a_list():
    table = Table.of_one(
        None, (Column("outcome"), "perforated"), (Column("length", "mm", ".2f"), 14.6), (Column("runs", spec="d"), 3)
    )
    assert printed("first", table, width=80) == [
        "first",
        "",
        "outcome  perforated",
        "length   14.60 mm",
        "runs         3",
    ]


@pytest.mark.parametrize("text", ["at most 12 mm", "at least 4 kg/m² of it", "up to 95 % or more", "some 12 J"])
@pytest.mark.parametrize("width", range(10, 23))
def test_numbers_keep_their_units(text: str, width: int):
    table = Table((Column("note", prose=True),), ((text,),))
    for lines in (printed(text, width=width), printed(table, width=width)):
        assert not any(line[-1] in "0123456789" for line in lines)


def test_control_characters_are_not_obeyed():
    table = Table((Column("na\x1bme"),), (("\x1b]0;title\x07",),), title="\x1b[2J")
    lines = printed("\r", table, "\x1b[31m", width=80)
    assert lines == ["\\r", "", "\\x1b[2J", "na\\x1bme", "─" * 16, "\\x1b]0;title\\x07", "\\x1b[31m"]


WORD = st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=9)
WORDS = st.lists(WORD, max_size=4).map(" ".join)
HEADING = st.lists(WORD, min_size=1, max_size=4).map(" ".join)


@st.composite
def tables_of_words(draw: st.DrawFn) -> Table:
    columns = tuple(
        Column(draw(HEADING), draw(st.sampled_from(["", "m/s", "kg/m²"])), spec, prose=not spec and draw(st.booleans()))
        for spec in draw(st.lists(st.sampled_from(["", "", ".2f"]), min_size=1, max_size=8))
    )
    number = st.one_of(st.none(), st.floats(-1e6, 1e6))
    cells = [number if column.numeric else WORDS for column in columns]
    rows = draw(st.lists(st.tuples(*cells), min_size=1, max_size=4))
    return Table(columns, tuple(rows))


@given(tables_of_words(), st.integers(40, 130))
@examples(max_examples=50)
def test_no_word_of_any_table_is_split(table: Table, width: int):
    cells = {word for row in table.texts() for cell in row for word in cell.split()}
    lines = printed(table, width=width)
    assert cells <= set(words(lines))
    assert max((cell_len(line) for line in lines), default=0) <= width
    piped = printed(table, width=PIPE)
    assert cells <= set(words(piped))
    assert len(piped) == 2 + len(table.rows)
