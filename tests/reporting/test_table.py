import csv
from io import StringIO
from types import SimpleNamespace

import pytest
from hypothesis import given, strategies

from armour.files import FORMULA, csv_cell, csv_value
from armour.reporting.table import Column, Table, column_of, csv_text, listing, record

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


def test_headings_and_texts_follow_from_the_column():
    table = Table((NAME, LENGTH, Column("ratio", spec="g")), (("a", 1.0, 0.5), ("b", None, 2.0)))
    assert table.headings() == ["name", "length, mm", "ratio"]
    assert [column.numeric for column in table.columns] == [False, True, True]
    assert table.texts() == [["a", "1.00", "0.5"], ["b", "", "2"]]


def test_a_row_has_a_cell_for_every_column():
    with pytest.raises(ValueError, match="zip"):
        Table((NAME, LENGTH), (("a",),)).texts()


def test_a_record_leaves_out_what_is_not_known():
    table = record(None, (NAME, "a"), (LENGTH, None), (Column("runs", spec="d"), 0), title="T")
    assert (table.headings(), table.texts(), table.record, table.title) == (["name", "runs"], [["a", "0"]], True, "T")


def test_label_and_unit_of_a_column_follow_from_its_key():
    assert column_of("backing_thickness_mm", "g") == Column(
        "back plate thickness", "mm", "g", key="backing_thickness_mm"
    )
    assert column_of("count", "d", "rows").heading == "rows"


def test_columns_show_attributes_values_and_functions_of_items():
    items = [SimpleNamespace(name="a", length_mm=2.0), SimpleNamespace(name="b", length_mm=None)]
    table = listing(
        items, NAME, LENGTH, (Column("kind"), "rod"), (Column("twice"), lambda item: item.name * 2), title="T"
    )
    assert table.rows == (("a", 2.0, "rod", "aa"), ("b", None, "rod", "bb"))
    assert (table.headings(), table.title) == (["name", "length, mm", "kind", "twice"], "T")
    assert record(items[1], NAME, LENGTH).rows == (("b",),)
    assert listing(items[1:], NAME, LENGTH).headings() == ["name"]
    assert listing([], NAME, LENGTH).headings() == ["name", "length, mm"]


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


@given(strategies.text(alphabet="'=+-@a1 "))
def test_a_text_in_csv_is_no_formula_and_is_read_as_it_was(text: str):
    assert csv_cell(text)[:1] not in FORMULA
    assert csv_value(csv_cell(text)) == text


def test_a_number_that_is_not_finite_is_left_out():
    table = Table((NAME, LENGTH), (("a", float("nan")), ("b", float("inf"))))
    assert csv_text(table) == "name,length_mm\na,\nb,\n"
    assert table.texts() == [["a", ""], ["b", ""]]
