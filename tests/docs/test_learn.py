"""The numbers of docs/learn are those of the examples on the same page, and its pictures are those of the program."""

import re
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow

DOCS = SCENARIOS.parent / "docs"
PAGES = sorted((DOCS / "learn").glob("*.md"))
NUMBER = r"(?<![\w.-])\d+(?:\.\d+)?(?![\w-]|\.\w)"


def numbers(text: str) -> set[float]:
    """Numbers of two digits or more; names such as AD85 have none."""
    return {float(found) for found in re.findall(NUMBER, text) if len(found) > 1}


def given(page: str) -> set[float]:
    """Numbers of the examples and pictures of a page, and of the scenario that all of them are about."""
    pictures = re.findall(r"\]\(\.\./images/(\w+\.svg)\)", page)
    texts = [
        *re.findall(r"^```.*?^```", page, re.MULTILINE | re.DOTALL),
        *(" ".join(re.findall(r">([^<]+)</text>", (DOCS / "images" / name).read_text())) for name in pictures),
        (SCENARIOS / "wilkins.toml").read_text(),
    ]
    # In examples a number may have an exponent, as 5.2e9.
    return numbers(re.sub(r"(\d)e-?\d+", r"\1", " ".join(texts)))


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_every_number_of_a_page_is_in_an_example_that_is_run(page: Path):
    text = page.read_text()
    prose = re.sub(
        r"^```.*?^```|`[^`\n]*`|\]\([^)]*\)|\\tag\{.*?\}|\([\d, to]+\)|10\^\{?-?\d+\}?|\^", " ", text, flags=re.M | re.S
    )
    assert numbers(prose) - given(text) == set()


def test_the_pictures_are_those_of_the_program():
    from tools import pictures

    for name, drawing in pictures.PICTURES.items():
        assert drawing() == (DOCS / "images" / f"{name}.svg").read_text(), "run python -m tools.pictures"
