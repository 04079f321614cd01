from pathlib import Path

import pytest

from armour.reporting.markdown import markdown_table, markdown_text, suite_markdown
from armour.reporting.table import Column, Table
from armour.validation.validate import SuiteResult
from tests.helpers.suites import TABLE, case, result


@pytest.fixture
def outcome(folder: Path) -> SuiteResult:
    text = (
        'title = "A | suite"\n'
        + case("in", 724.0, 'band = 1.0\nreason = "as *measured*"')
        + case("out", 725.0, "band = 1.0")
        + case("none", 724.0, "band = 1.0\nset.ballistic_limit.velocity_min_m_s = 1000.0")
        + case("slip", 1.0, 'not_scored = "a slip"')
        + TABLE
    )
    return result(folder, text)


def test_a_table():
    table = Table((Column("name | key"), Column("length", "mm", ".1f")), (("a*b", 1.25), ("c", None)))
    assert markdown_table(table).splitlines() == [
        "| name \\| key | length, mm |",
        "| --- | ---: |",
        "| a\\*b | 1.2 |",
        "| c |  |",
    ]


def test_text_is_no_markup_and_one_line():
    assert markdown_text("a_b <i>\n[x](y) `z` \x1b[1m") == "a\\_b \\<i> \\[x](y) \\`z\\` \\\\x1b\\[1m"


def test_a_suite(outcome: SuiteResult):
    text = suite_markdown(outcome)
    assert text.startswith("# A \\| suite\n")
    assert ": 3 of 6 within their bands, 2 outside, 1 no answer; 1 shown and not scored.\n" in text
    assert "| out | 725 | 723.8 | -1.2 | -0.17 | 1 | outside |" in text
    assert "* in: as \\*measured\\*." in text
    assert "## Shown and not scored\n\n* slip: a slip." in text
    assert "| t | this model | 2 |" in text
    assert text.endswith("\n")


def test_tables_have_as_many_cells_as_columns(outcome: SuiteResult):
    for block in suite_markdown(outcome).split("\n\n"):
        lines = [line.replace("\\|", "") for line in block.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in lines}) <= 1
