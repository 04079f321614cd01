"""Results as HTML for a notebook: the tables that the commands print."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from armour.reporting.html import html_tables
from armour.reporting.table import Table, column_of
from armour.reporting.tables.comparison import comparison_tables
from armour.reporting.tables.confidence import confidence_note
from armour.reporting.tables.design import design_tables
from armour.reporting.tables.impact import confidence_table, impact_table, limit_tables, stage_table
from armour.reporting.tables.planned_shots import shot_plan_tables
from armour.reporting.tables.planned_tests import planned_tables
from armour.reporting.tables.statistics import calibration_tables, sensitivity_tables, uncertainty_tables, v50_tables
from armour.reporting.tables.validation import suite_tables, verdict

if TYPE_CHECKING:
    from armour.analysis.results import Result
    from armour.sweeps.columns import SweepResult

# Rows of a sweep that are shown.
SWEEP_ROWS = 20


def in_html(result: "Result") -> str | None:
    """Return the tables of a result as HTML; None where it has none."""
    tables = TABLES.get(type(result).__name__)
    if tables is None:
        return None
    return html_tables(
        [*result._heading(), *tables(result), *(f"warning: {warning}" for warning in getattr(result, "warnings", ()))]
    )


def sweep_tables(result: "SweepResult") -> list[Table | str]:
    """Return the first rows of a sweep."""
    columns = result.columns
    shown = tuple(zip(*(values[:SWEEP_ROWS].tolist() for values in columns.values()), strict=True))
    headings = [column_of(name, ".6g" if values.dtype.kind in "iuf" else "") for name, values in columns.items()]
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    return [Table(tuple(headings), shown), *notes]


# By the name of the result's class: the modules of most need not be imported for one.
TABLES: Mapping[str, Callable[[Any], list[Table | str]]] = {
    "CalibrationResult": calibration_tables,
    "Comparison": comparison_tables,
    "ConfidenceResult": lambda result: [confidence_table(result), confidence_note(result)],
    "DesignResult": lambda result: design_tables(result, {}),
    "FiringResult": v50_tables,
    "ImpactResult": lambda result: [impact_table(result), stage_table(result)],
    "LimitResult": limit_tables,
    "PlannedTests": planned_tables,
    "SensitivityResult": sensitivity_tables,
    "ShotPlan": shot_plan_tables,
    "SuiteResult": lambda result: [*suite_tables(result), verdict(result)],
    "SweepResult": sweep_tables,
    "UncertaintyResult": uncertainty_tables,
}
