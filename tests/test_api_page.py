"""docs/api.md is the page of the docstrings."""

import inspect
from pathlib import Path

import armour
from docs.api import page

PAGE = Path(__file__).parent.parent / "docs" / "api.md"


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "make docs writes the page"


def test_every_public_name_has_its_entry():
    headings = [line.removeprefix("### ") for line in PAGE.read_text().splitlines() if line.startswith("### ")]
    assert sorted(headings) == sorted(dir(armour))


def test_every_parameter_of_a_public_function_is_described():
    text = PAGE.read_text()
    for name in dir(armour):
        thing = getattr(armour, name)
        if inspect.isfunction(thing):
            entry = text.partition(f"### {name}\n")[2].partition("\n### ")[0]
            for parameter in inspect.signature(thing).parameters:
                assert f"* `{parameter}`" in entry, f"{name}: {parameter}"
