"""Write docs/evidence/validation.md: the paper's suite, with other predictions of Wilkins' tests beside the model.

    python -m tools.rivals

They are the paper's program, Florence's formula, and what is fitted to the tests: the flow stress of the model, and a
rule of areal density, both also with each test left out of the fit that predicts it.
"""

from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np

from armour.reporting.formats import markdown_report
from armour.reporting.report import Report, ReportSection
from armour.reporting.table import Column, Table
from armour.reporting.views.validation import suite_report
from armour.scenario.scenario import load_scenario
from armour.statistics.calibration import calibrate
from armour.statistics.measured import read_tests
from armour.validation.comparison import Prediction, compare
from armour.validation.tested import COMPARED_TESTS, wilkins_tests
from armour.validation.validate import SuiteResult, validate

PAGE = Path(__file__).parents[1] / "docs" / "evidence" / "validation.md"
# Table of the paper's suite with the limits by the paper's program.
PROGRAM = "table 3, the paper's program, 5.2 GPa"
# Section before which the errors stand.
REASONS = "Reasons for the bands"


def predictions(paper: SuiteResult) -> list[Prediction]:
    """Return each prediction of Wilkins' tests with its errors, given the result of the paper's suite."""
    printed, measured = (
        np.array([check.case.expected for check in paper.checks if check.case.group == name], dtype=np.float64)
        for name in (PROGRAM, COMPARED_TESTS)
    )
    wilkins = load_scenario("wilkins")
    model, *formulas = compare(wilkins).predictions
    fit = calibrate(read_tests("tests/wilkins", wilkins), wilkins)
    computed, left_out = (
        np.array([getattr(test, name) for test in fit.residuals], dtype=np.float64) for name in ("computed", "left_out")
    )
    stress = f"flow stress of AD85 to these tests: {fit.coefficients[0].estimate:.2f} GPa"
    refitted = Prediction("the model, flow stress refitted", nan, fitted=stress)
    program = Prediction("the paper's program", nan)
    others = [program.on_tests(measured, printed), refitted.on_tests(measured, computed, left_out)]
    return [model, *others, *formulas]


def page(paper: SuiteResult) -> Report:
    """Return the report on the paper's suite with a table of the errors."""
    table = Table.of(
        predictions(paper),
        Column.of("method", label="predicted by", prose=True),
        Column.of("mean_percent", ".1f", "mean error"),
        Column.of("left_out_percent", ".1f"),
        Column.of("largest_percent", ".1f"),
        Column.of("fitted", prose=True),
    )
    report = suite_report(paper)
    place = [section.heading for section in report.sections].index(REASONS)
    section = ReportSection(f"Errors, {COMPARED_TESTS}, {len(wilkins_tests().limits)} rows", tables=(table,))
    return replace(report, sections=(*report.sections[:place], section, *report.sections[place:]))


def main() -> None:
    """Write the page."""
    PAGE.write_text(markdown_report(page(validate("paper"))), encoding="utf-8")


if __name__ == "__main__":
    main()
