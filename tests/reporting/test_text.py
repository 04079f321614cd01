import pytest

from armour.files import printable
from armour.reporting.text import interval, percent, unbroken, wrapped


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Ø 7.62 mm, µ ± 3 — ok", "Ø 7.62 mm, µ ± 3 — ok"),
        ("no-break\u00a0space", "no-break\u00a0space"),
        ("\x1b[31mred\x07", "\\x1b[31mred\\x07"),
        ("two\nlines\r\u2028", "two\\nlines\\r\\u2028"),
        ("\u202etxt.exe", "\\u202etxt.exe"),
        ("\udcff", "\\udcff"),
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


def test_parts_are_in_per_cent():
    assert (percent(0.95), percent(0.999)) == ("95 %", "99.9 %")


@pytest.mark.parametrize("unit", ["mm", "m/s", "kg/m²", "%", "J", "g", "GPa"])
def test_no_line_ends_between_a_number_and_its_unit(unit: str):
    text = f"6.35 {unit} on 7 {unit}, and some grams"
    assert unbroken(text) == f"6.35\u00a0{unit} on 7\u00a0{unit}, and some grams"
    for width in range(10, 30):
        lines = wrapped(text, width)
        assert " ".join(lines) == text
        assert not [line for line in lines if line[-1].isdecimal()]
