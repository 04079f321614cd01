"""Tables, and the texts of their cells."""

import csv
from io import StringIO
from types import SimpleNamespace

import pytest

from armour.files import printable
from armour.reporting.table import Column, Table, csv_text, interval
from tests.reporting.tables import headings

LENGTH = Column("length", "mm", ".2f", key="length_mm")
NAME = Column("name", key="name")


@pytest.mark.parametrize(
    ("column", "value", "text"),
    [
        (LENGTH, 1.005, "1.00"),
        (LENGTH, 3, "3.00"),
        (LENGTH, None, ""),
        (LENGTH, "not identified", "not identified"),
        (Column("runs", spec="d"), 9999, "9999"),
        (Column("runs", spec="d"), 12345, "12,345"),
        (Column("energy", "J", "+.1f"), 9999.96, "+10,000.0"),
        (NAME, "AD85", "AD85"),
        (NAME, "", ""),
    ],
)
def test_a_value_is_formatted_by_its_column(column: Column, value: float | str | None, text: str):
    assert column.text(value) == text


def test_a_record_leaves_out_what_is_not_known():
    table = Table.of_one(None, (NAME, "a"), (LENGTH, None), (Column("runs", spec="d"), 0), title="T")
    assert (headings(table), table.texts(), table.record, table.title) == (["name", "runs"], [["a", "0"]], True, "T")


def test_columns_show_attributes_values_and_functions_of_items():
    items = [SimpleNamespace(name="a", length_mm=2.0), SimpleNamespace(name="b", length_mm=None)]
    table = Table.of(
        items, NAME, LENGTH, (Column("kind"), "rod"), (Column("twice"), lambda item: item.name * 2), title="T"
    )
    assert table.rows == (("a", 2.0, "rod", "aa"), ("b", None, "rod", "bb"))
    assert (headings(table), table.title) == (["name", "length, mm", "kind", "twice"], "T")
    assert Table.of_one(items[1], NAME, LENGTH).rows == (("b",),)
    assert headings(Table.of(items[1:], NAME, LENGTH)) == ["name"]
    assert headings(Table.of([], NAME, LENGTH)) == ["name", "length, mm"]


def test_csv_has_keys_and_numbers_with_all_digits():
    table = Table((NAME, LENGTH, Column("shown only")), (('a "b", c', 0.1 + 0.2, "x"), ("d", None, "y")))
    assert csv_text(table).splitlines()[0] == "name,length_mm"
    first, second = csv.DictReader(StringIO(csv_text(table)))
    assert (first["name"], float(first["length_mm"])) == ('a "b", c', 0.1 + 0.2)
    assert second == {"name": "d", "length_mm": ""}


def test_a_text_is_no_formula_for_a_spreadsheet():
    texts = ["=cmd|' /C calc'!A0", "+1", "-x", "@x", "\tx", "\rx", "a=b", "6061-T6", ""]
    table = Table((NAME, LENGTH), tuple((text, -1.5) for text in texts))
    cells = [row["name"] for row in csv.DictReader(StringIO(csv_text(table)))]
    assert cells == ["'=cmd|' /C calc'!A0", "'+1", "'-x", "'@x", "'\\tx", "'\\rx", "a=b", "6061-T6", ""]
    assert {row["length_mm"] for row in csv.DictReader(StringIO(csv_text(table)))} == {"-1.5"}


def test_a_number_that_is_not_finite_is_left_out():
    table = Table((NAME, LENGTH), (("a", float("nan")), ("b", float("inf"))))
    assert csv_text(table) == "name,length_mm\na,\nb,\n"
    assert table.texts() == [["a", ""], ["b", ""]]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Ø 7.62 mm, µ ± 3 — ok", "Ø 7.62 mm, µ ± 3 — ok"),
        ("\x1b[31mred\x07", "\\x1b[31mred\\x07"),
        ("two\nlines\r\u2028", "two\\nlines\\r\\u2028"),
        ("\u202etxt.exe", "\\u202etxt.exe"),
        ("\x9b2J", "\\x9b2J"),
    ],
)
def test_control_characters_are_shown_and_not_obeyed(text: str, shown: str):
    assert printable(text) == shown


def test_intervals():
    assert interval((1.25, 2.0), ".1f") == "1.2 to 2.0"
    assert interval((None, 2.0), ".1f") == "up to 2.0"
    assert interval((1.0, None), "g") == "from 1"
    assert interval((None, None), "g") == "not bounded"
    assert interval((9000.0, 12345.6), ".1f") == "9000.0 to 12,345.6"
