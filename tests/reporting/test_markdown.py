from pathlib import Path
from xml.etree import ElementTree

import pytest

from armour.reporting.markdown import suite_junit, suite_markdown
from armour.validation.validate import SuiteResult
from tests.suites import TABLE, case, result


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


def test_markdown(outcome: SuiteResult):
    text = suite_markdown(outcome)
    assert text.startswith("# A \\| suite\n")
    assert "4 of 8" not in text
    assert ": 3 of 6 within their bands, 2 outside, 1 no answer; 1 shown and not scored.\n" in text
    assert "| out | m/s | 725 | 723.8 | -1.2 | -0.17 | 1 | outside |" in text
    assert "* in: as \\*measured\\*." in text
    assert "## Shown and not scored\n\n* slip: a slip." in text
    assert "| t | this model | 2 |" in text
    assert text.endswith("\n")


def test_markdown_tables_have_as_many_cells_as_columns(outcome: SuiteResult):
    for block in suite_markdown(outcome).split("\n\n"):
        lines = [line.replace("\\|", "") for line in block.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in lines}) <= 1


def test_junit(outcome: SuiteResult):
    suite = ElementTree.fromstring(suite_junit(outcome))
    assert (suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("skipped")) == (
        "A | suite",
        "7",
        "3",
        "1",
    )
    cases = {(c.get("classname"), c.get("name")): c for c in suite}
    failure = cases["cases", "out"].find("failure")
    assert failure is not None
    assert "expected 725.0, computed 723.77" in str(failure.get("message"))
    assert cases["cases", "slip"].find("skipped") is not None
    assert cases["cases", "in"].find("failure") is None
    assert cases["t", "RMS"].find("failure") is not None
    message = cases["cases", "none"].find("failure")
    assert message is not None
    assert "no ballistic limit" in str(message.get("message"))
