"""Tables of sweeps."""

from collections.abc import Mapping, Sequence
from typing import Any

from armour.analysis.variants import row_of
from armour.design.check import shown_limit
from armour.errors import counted
from armour.evidence.tests import far_from_tests
from armour.reporting import words as phrases
from armour.reporting.by_result import line_of, tables_of
from armour.reporting.table import Column, Source, Table, beside
from armour.reporting.views.design import BY_MODEL, LIMIT, STOPS, VERDICT, verdict_word
from armour.scenario.scenario import Scenario
from armour.sweeps.sweep import SweepResult

# Largest number of rows of a sweep that a terminal shows.
SWEEP_ROWS = 20
# Limits by the model and expected ones, which share a column.
BOTH = MODEL, EXPECTED = "ballistic_limit_m_s", "expected_limit_m_s"


@line_of.register
def sweep_in_a_line(result: SweepResult) -> str:
    """Return quantities, keys and the number of rows, and the file that has them."""
    where = "" if result.output is None else f", in {result.output}"
    return f"{', '.join(result.quantities)} over {' and '.join(result.keys)}, {counted(result.rows, 'row')}{where}"


@tables_of.register
def tables_of_sweep(result: SweepResult) -> list[Table | str]:
    """Return the first rows of a sweep, with a note if there are more."""
    notes = [f"the first {SWEEP_ROWS} of {result.rows:,} rows"] if result.rows > SWEEP_ROWS else []
    return [*first_rows(result.columns, result.scenario, result.keys), *notes]


def first_rows(columns: Mapping[str, Any], scenario: Scenario, keys: Sequence[str]) -> list[Table | str]:
    """Tabulate the first rows of a sweep.

    `columns` has an array (rows,) by name; the names in `keys` are the swept inputs.  Where the expected limit is not
    known, that by the model stands in its place, with "*".  A last column says in what a row is far from the tests.
    """
    names, first = [*columns], [values[:SWEEP_ROWS].tolist() for values in columns.values()]
    rows = [dict(zip(names, row, strict=True)) for row in zip(*first, strict=True)]
    items = [(row, scenario.replaced({key: row[key] for key in keys})) for row in rows]
    both = {*BOTH} <= {*names}
    sources = {name: _source(name, columns[name], both=both) for name in names if name != MODEL or not both}
    far = Column("far from the tests", prose=True), lambda item: _far(item[1], every_threat=VERDICT.label in names)
    table = Table.of(items, *sources.values(), far)
    return [table, *[BY_MODEL] * (both and any(_limit(*item).endswith("*") for item in items))]


def _source(name: str, values: Any, *, both: bool) -> Source:
    """Return the column that shows a key or quantity, whose `values` are an array, (rows,).

    Items are pairs of a row and its scenario.  If there are limits of `both` kinds, one column shows them.
    """
    if name == EXPECTED and both:
        return LIMIT, lambda item: _limit(*item)
    if name == "probability_of_stopping":
        return STOPS, lambda item: phrases.chance(_known(item[0][name]))
    if name == VERDICT.label:
        return VERDICT, lambda item: verdict_word(item[0][name])
    return Column.of(name, ".6g" if is_number(values) else ""), lambda item: item[0][name]


def _known(value: float) -> float | None:
    """Return a value; None for NaN, which stands for a value that is not known."""
    return value if value == value else None


def _limit(row: Mapping[str, Any], scenario: Scenario) -> str:
    """Return the expected limit, or that by the model with a mark, m/s, beside the velocity; "none" without one."""
    by_model, expected = _known(row[MODEL]), _known(row[EXPECTED])
    shown, mark = shown_limit(by_model, expected), "*" * (expected is None)
    return "none" if shown is None else beside(shown, scenario.impact.velocity_m_s, 0) + mark


def _far(scenario: Scenario, *, every_threat: bool) -> str:
    """Return in what an armour and its impact, or every threat, are far from the tests; "" if in nothing."""
    scenarios = map(scenario.against, scenario.threats()) if every_threat else [scenario]
    far = (each for scenario in scenarios for each in far_from_tests(scenario, row_of(scenario).armours))
    return ", ".join(dict.fromkeys(each.found for each in far))


def is_number(values: Any) -> bool:
    """Return whether an array holds numbers."""
    return values.dtype.kind in "iuf"
