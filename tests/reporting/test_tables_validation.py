from pathlib import Path
from typing import Any

import pytest

from armour.reporting.table import Table, csv_text
from armour.reporting.views.figure import figure_table
from armour.reporting.views.suite import check_groups, check_table, note_rows, parity_table, suite_tables, verdict
from armour.validation.figures import Figure, FigureCurve, FigureSection
from armour.validation.validate import SuiteResult
from tests.helpers.suites import TABLE, case, result


@pytest.fixture
def outcome(folder: Path) -> SuiteResult:
    return result(folder, case("out", 725.0, 'band = 1.0\nreason = "as measured"') + TABLE)


def test_checks_stand_below_their_table(outcome: SuiteResult):
    assert list(check_groups(outcome)) == ["t", "cases"]
    table = check_table(check_groups(outcome)["cases"])
    assert table.headings()[1:4] == ["expected, m/s", "computed, m/s", "deviation, m/s"]
    assert table.texts() == [["out", "725", "723.8", "-1.2", "-0.17", "1", "outside"]]
    assert [column.numeric for column in table.columns] == [False, *[True] * 5, False]


def test_checks_of_several_quantities_have_units_of_their_own(folder: Path):
    other = (
        case("outcome", 0.0, "")
        .replace("expected = 0.0", 'expected = "perforated"')
        .replace("ballistic_limit_m_s", "outcome")
    )
    table = check_table(result(folder, case("out", 725.0, "band = 1.0") + other).checks)
    assert [row[1] for row in table.rows] == ["m/s", ""]
    assert table.texts()[1] == ["outcome", "", "perforated", "perforated", "", "", "", "within"]


def test_a_suite_has_its_tables_as_a_whole(outcome: SuiteResult):
    assert [table.title for table in suite_tables(outcome)] == ["t", "cases", "tables as a whole", "errors"]
    assert note_rows(outcome.checks) == [("out", "as measured")]
    assert verdict(outcome) == "2 of 4 within their bands, 2 outside"


def test_curves_as_a_file():
    axes: dict[str, Any] = {"x_label": "x, mm", "y_label": "V, m/s"}
    section = FigureSection.model_construct(**axes)
    figure = Figure(section, (1.0, 2.0), (FigureCurve("a", (0.1, None)),))
    assert csv_text(figure_table([figure])) == '"x, mm","a: V, m/s"\n1.0,0.1\n2.0,\n'
    axes = {"x_label": "y, mm", "y_label": "m"}
    other = Figure(FigureSection.model_construct(**axes), (3.0, 4.0), figure.curves)
    assert csv_text(figure_table([figure, other])).startswith('"x, mm","a: V, m/s","y, mm",a: m\n1.0,0.1,3.0,0.1\n')


def test_parity_as_a_file(outcome: SuiteResult):
    table = parity_table(outcome)
    assert isinstance(table, Table)
    assert csv_text(table).splitlines()[0] == "table,row,quantity,expected,computed"
    assert len(table.rows) == 3
