from pathlib import Path

import pytest

from armour.reporting.formats import markdown_report
from armour.reporting.views import suite as suite_view
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


def test_a_suite(outcome: SuiteResult):
    text = markdown_report(suite_view.report(outcome))
    assert text.startswith("# A \\| suite\n")
    assert ": 3 of 6 within their bands, 2 outside, 1 no answer; 1 shown but not scored.\n" in text
    assert "| out | 725 | 723.8 | -1.2 | -0.17 | 1 | outside |" in text
    assert "* in: as \\*measured\\*." in text
    assert "## Shown but not scored\n\n* slip: a slip." in text
    assert "| t | this model | 2 |" in text
    assert text.endswith("\n")


def test_tables_have_as_many_cells_as_columns(outcome: SuiteResult):
    for block in markdown_report(suite_view.report(outcome)).split("\n\n"):
        lines = [line.replace("\\|", "") for line in block.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in lines}) <= 1


def test_a_report_made_by_a_command_says_so(outcome: SuiteResult):
    *_, origin = suite_view.report(outcome, "armour report s.toml").sections
    assert (origin.heading, origin.code) == ("Origin", "armour report s.toml")
    assert "Origin" not in [section.heading for section in suite_view.report(outcome).sections]


def test_a_table_has_its_source(outcome: SuiteResult, folder: Path):
    sourced = result(folder, TABLE + 'source = "table 3"\nreason = "as printed"\n')
    table, *_ = suite_view.report(sourced).sections
    assert (table.heading, table.paragraphs) == ("T", ("Table 3; band: as printed.",))
    found = {section.heading: section for section in suite_view.report(outcome).sections}
    assert found["Cases"].paragraphs == ()
    assert found["Tables as a whole"].tables[0].headings()[0] == "table"
