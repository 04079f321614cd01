"""Write docs/evidence/validation.md and plates.md: the suites `paper` and `plates`, in short.

python -m tools.published

Beside the model stand other predictions of Wilkins' tests: the paper's program, Florence's formula, and what is fitted
to the tests: the flow stress of the model, and a rule of areal density, both also with each test left out of the fit
that predicts it.
"""

from math import nan
from pathlib import Path

import numpy as np

from armour import __version__
from armour.reporting.by_result import in_a_line
from armour.reporting.formats import markdown_table, markdown_text
from armour.reporting.table import Column, Table, sentence
from armour.reporting.views.validation import check_groups, check_table, summary_table
from armour.scenario.scenario import load_scenario
from armour.statistics.calibration import calibrate
from armour.statistics.measured import read_tests
from armour.validation.comparison import Prediction, compare
from armour.validation.suite_sections import CASES
from armour.validation.tested import COMPARED_TESTS, wilkins_tests
from armour.validation.validate import SuiteResult, validate

EVIDENCE = Path(__file__).parents[1] / "docs" / "evidence"
# Tables of the paper's suite with the limits by the paper's program.
BEFORE, PROGRAM = (f"table 3, the paper's program, {stress} GPa" for stress in (3.8, 5.2))


def predictions(paper: SuiteResult) -> list[Prediction]:
    """Return each prediction of Wilkins' tests with its errors, given the result of the paper's suite."""
    printed, measured = (
        np.array([check.case.expected for check in check_groups(paper)[name]], dtype=np.float64)
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


def table_3(paper: SuiteResult) -> Table:
    """Return the limits of Wilkins' armours: printed, by this program, and measured."""
    groups = check_groups(paper)
    columns = [Column(label, "mm", "g") for label in ("tile", "plate")]
    columns += [
        Column(f"{of} with {stress} GPa", "m/s", "g")
        for stress, name in ((3.8, BEFORE), (5.2, PROGRAM))
        for of in ("printed", "computed")
    ]
    rows = []
    for before, fitted, test in zip(*(groups[name] for name in (BEFORE, PROGRAM, COMPARED_TESTS)), strict=True):
        armour = test.case.scenario.armour
        limits = [number for check in (before, fitted) for number in (check.case.expected, f"{check.computed:.1f}")]
        rows.append((armour.ceramic_thickness_mm, armour.backing_thickness_mm, *limits, test.case.expected))
    return Table((*columns, Column("measured", "m/s", "g")), tuple(rows))


def only(table: Table, *labels: str) -> Table:
    """Return a table with some of its columns."""
    places = [number for number, column in enumerate(table.columns) if column.label in labels]
    rows = tuple(tuple(row[place] for place in places) for row in table.rows)
    return Table(tuple(table.columns[place] for place in places), rows)


def beginning(name: str, result: SuiteResult) -> list[str]:
    """Return the parts that a page on a suite begins with."""
    lead = f"By armour {__version__}, {in_a_line(result)}. `suites/{name}.toml` states the reason for each band."
    return [f"# {result.title}", lead, markdown_text(result.description)]


def paper_page(result: SuiteResult) -> str:
    """Return the page on the numbers of the paper."""
    predicted = Table.of(
        predictions(result),
        Column.of("method", label="predicted by", prose=True),
        Column.of("mean_percent", ".1f", "mean error"),
        Column.of("left_out_percent", ".1f"),
        Column.of("largest_percent", ".1f"),
        Column.of("fitted", prose=True),
    )
    cases = check_groups(result)[CASES]
    parts = [
        *beginning("paper", result),
        "## Table 3",
        markdown_table(table_3(result)),
        "## Tables as a whole",
        markdown_table(
            only(summary_table(result.summaries, ""), "tests", "unit", "mean", "RMS", "largest", "RMS band")
        ),
        "## Cases",
        "What has no band is not scored.",
        markdown_table(only(check_table(cases), "case", "unit", "expected", "computed", "band ±")),
        f"## Errors, {COMPARED_TESTS}, {len(wilkins_tests().limits)} rows",
        markdown_table(predicted),
    ]
    return "\n\n".join(parts) + "\n"


def plates_page(result: SuiteResult) -> str:
    """Return the page on bare plates: all tests of each table, and those by thickness or round that have a band."""
    columns, parts = ("tests", "number", "mean", "RMS"), beginning("plates", result)
    whole = [summary for summary in result.summaries if not summary.group]
    parts += [
        "Relative errors of the limits by the model, %.",
        markdown_table(only(summary_table(whole, ""), *columns)),
    ]
    for summary in whole:
        groups = [each for each in result.summaries if each.name == summary.name and each.rms_band and each.group]
        if shown := [each for each in groups if ", " not in each.group]:
            parts += [f"## {sentence(summary.name).removesuffix('.')}"]
            parts += [markdown_table(only(summary_table(shown, ""), *columns))]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    (EVIDENCE / "validation.md").write_text(paper_page(validate("paper")), encoding="utf-8")
    (EVIDENCE / "plates.md").write_text(plates_page(validate("plates")), encoding="utf-8")
