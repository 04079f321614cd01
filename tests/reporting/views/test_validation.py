"""Tables, report and JUnit XML of a suite."""

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from armour.reporting.by_result import in_a_line
from armour.reporting.table import Table, csv_text
from armour.reporting.views import validation as view
from armour.reporting.views.validation import check_table, figure_table, suite_junit
from armour.validation.figures import Figure, FigureSection
from tests.helpers.suites import TABLE, WILKINS_LIMIT, case, result


def test_checks_of_several_quantities_have_units_of_their_own(folder: Path):
    other = (
        case("outcome", 0.0, "")
        .replace("expected = 0.0", 'expected = "perforated"')
        .replace("ballistic_limit_m_s", "outcome")
    )
    table = check_table(result(folder, case("out", 725.0, "band = 1.0") + other).checks)
    assert [row[1] for row in table.rows] == ["m/s", ""]
    assert table.texts()[1] == ["outcome", "", "perforated", "perforated", "", "", "", "within"]


def test_a_suite_is_its_verdict_and_a_row_for_each_table(folder: Path):
    near, slip = case("near", WILKINS_LIMIT, "band = 1.0"), case("slip", 1.0, 'not_scored = "a slip"')
    found = result(folder, near + slip + TABLE)
    line, overview, *_ = view.tables_of_suite(found)
    assert line == "3 of 4 within their bands, 1 outside; 1 not scored (-v)"
    assert isinstance(overview, Table)
    assert [row[:2] for row in overview.texts()] == [["t", "2 of 2"], ["2 other cases", "1 of 1"]]
    assert overview.texts()[0][3] == "5 m/s"
    assert view.tables_of_suite(found.of(every_row=True))[0] == in_a_line(found)


def test_curves_as_a_file():
    axes: dict[str, Any] = {"x_label": "x, mm", "y_label": "V, m/s"}
    section = FigureSection.model_construct(**axes)
    figure = Figure(section, (1.0, 2.0), {"a": (0.1, None)})
    assert csv_text(figure_table([figure])) == '"x, mm","a: V, m/s"\n1.0,0.1\n2.0,\n'
    axes = {"x_label": "y, mm", "y_label": "m"}
    other = Figure(FigureSection.model_construct(**axes), (3.0, 4.0), figure.curves)
    assert csv_text(figure_table([figure, other])).startswith('"x, mm","a: V, m/s","y, mm",a: m\n1.0,0.1,3.0,0.1\n')


def test_a_table_has_its_source(folder: Path):
    sourced = result(folder, TABLE + 'source = "table 3"\nreason = "as printed"\n')
    _, table, *_ = view.suite_report(sourced).sections
    assert (table.heading, table.paragraphs) == ("T", ("Table 3; band: as printed.",))


def test_the_report_begins_with_the_verdict_and_the_overview(folder: Path):
    found = result(folder, TABLE)
    report = view.suite_report(found)
    assert report.lead == "2 of 3 within their bands, 1 outside."
    assert report.facts == (view.overview_table(found),)
    unfilled = view.suite_report(
        result(folder, case("new", 0.0, "band = 1.0\nregression = true").replace("expected = 0.0\n", ""))
    )
    assert unfilled.lead == "0 of 1 within their bands, 1 no expected value."
    unscored = view.suite_report(result(folder, case("none", 700.0, 'not_scored = "a slip"')))
    assert (unscored.lead, unscored.passed) == ("No case is scored.", False)


def test_every_case_and_table_is_a_test_case(folder: Path):
    text = (
        case("in", 724.0, "band = 1.0")
        + case("out", 725.0, "band = 1.0")
        + case("none", 724.0, "band = 1.0\nset.ballistic_limit.velocity_min_m_s = 1000.0")
        + case("slip", 1.0, 'not_scored = "a slip"')
    )
    computed = result(folder, 'title = "A | suite"\n' + text + TABLE)
    [suite] = ElementTree.fromstring(suite_junit(computed, [0.25] * len(computed.checks), {"version": "2"}))
    found = (suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("skipped"))
    assert found == ("A | suite", "7", "3", "1")
    assert suite.get("time") == f"{0.25 * len(computed.checks):.3f}"
    cases = {(c.get("classname"), c.get("name")): c for c in suite}
    failure = cases["cases", "out"].find("failure")
    assert failure is not None
    assert failure.get("message") == (
        "expected 725 m/s, computed 723.778 m/s, deviation -1.222 m/s, relative deviation -0.17 %, band ± 1 m/s"
    )
    assert cases["cases", "slip"].find("skipped") is not None
    assert cases["cases", "in"].find("failure") is None
    assert cases["cases", "in"].get("time") == "0.250"
    rows = [name for group, name in cases if group == "t"]  # two rows of the same values are two test cases
    assert rows == ["tile thickness 6.35 mm", "tile thickness 6.35 mm (2)", "RMS"]
    rms = cases["t", "RMS"].find("failure")
    assert rms is not None
    assert re.fullmatch(r"RMS \d+\.\d\d m/s, RMS band \S+ m/s", str(rms.get("message")))
    message = cases["cases", "none"].find("failure")
    assert message is not None
    assert "no ballistic limit" in str(message.get("message"))


def test_control_characters_leave_it_well_formed(folder: Path):
    xml = suite_junit(result(folder, 'title = "a\\u001b[31m"\n' + case("b\\u0007", 725.0, "band = 1.0")), [0.0], {})
    [suite] = ElementTree.fromstring(xml)
    [test_case] = suite.iter("testcase")
    assert (suite.get("name"), test_case.get("name")) == ("a\\x1b[31m", "b\\x07")
