"""Write docs/evidence/validation.md and plates.md: the suites `paper` and `plates`, in short.

python -m tools.published

Beside the model stand other predictions of Wilkins' tests: the paper's program, Florence's formula, and what is fitted
to the tests: the flow stress of the model, and a rule of areal density, both also with each test left out of the fit
that predicts it.
"""

from pathlib import Path

import numpy as np

from armour import __version__
from armour.reporting.by_result import in_a_line
from armour.reporting.formats import markdown_table, markdown_text
from armour.reporting.table import Column, Table
from armour.reporting.views.validation import (
    USABLE,
    check_groups,
    check_table,
    group_table,
    summary_table,
    usable_table,
)
from armour.scenario.scenario import load_scenario
from armour.statistics.calibration import calibrate
from armour.statistics.measured import read_tests
from armour.validation.comparison import Error, compare
from armour.validation.suite_sections import CASES
from armour.validation.tested import COMPARED_TESTS
from armour.validation.validate import SuiteResult, validate

EVIDENCE = Path(__file__).parents[1] / "docs" / "evidence"
# Tables of the paper's suite with the limits by the paper's program.
BEFORE, PROGRAM = (f"table 3, the paper's program, {stress} GPa" for stress in (3.8, 5.2))


def errors(paper: SuiteResult) -> list[Error]:
    """Return the errors of each prediction of Wilkins' tests, given the result of the paper's suite."""
    printed, measured = (
        np.array([check.case.expected for check in check_groups(paper)[name]], dtype=np.float64)
        for name in (PROGRAM, COMPARED_TESTS)
    )
    wilkins = load_scenario("wilkins")
    model, *formulas, rule, rule_of_power = compare(wilkins).errors
    fit = calibrate(read_tests("tests/wilkins", wilkins), wilkins)
    computed, left_out = (
        np.array([getattr(test, name) for test in fit.residuals], dtype=np.float64) for name in ("computed", "left_out")
    )
    stress = f"flow stress of AD85 to these tests: {fit.coefficients[0].estimate:.2f} GPa"
    refitted = Error.of("this model, flow stress refitted", measured, computed, left_out, stress)
    return [Error.of("the paper's program", measured, printed), model, *formulas, refitted, rule, rule_of_power]


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
    return [f"# {result.title}", lead, markdown_text(result.description), USABLE, markdown_table(usable_table(result))]


def paper_page(result: SuiteResult) -> str:
    """Return the page on the numbers of the paper."""
    found = errors(result)
    predicted = Table.of(
        found,
        Column.of("predictor", label="predicted by", prose=True),
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
        markdown_table(only(summary_table(result), "table", "unit", "mean", "RMS", "largest", "RMS band")),
        "## Cases",
        "What has no band is not scored.",
        markdown_table(only(check_table(cases), "case", "unit", "expected", "computed", "band ±")),
        f"## Errors, {COMPARED_TESTS}, {found[0].count} rows",
        markdown_table(predicted),
    ]
    return "\n\n".join(parts) + "\n"


def plates_page(result: SuiteResult) -> str:
    """Return the page on bare plates: of each table, all tests, and those by thickness or round that have a band."""
    parts = beginning("plates", result)
    for name in check_groups(result):
        table = group_table(result, name)
        shown = Table(
            table.columns, tuple(row for row in table.rows if row[0] == "all" or (row[-1] and ", " not in str(row[0])))
        )
        parts += [f"## {name[:1].upper()}{name[1:]}", markdown_table(only(shown, "tests", "number", "mean", "RMS"))]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    (EVIDENCE / "validation.md").write_text(paper_page(validate("paper")), encoding="utf-8")
    (EVIDENCE / "plates.md").write_text(plates_page(validate("plates")), encoding="utf-8")
