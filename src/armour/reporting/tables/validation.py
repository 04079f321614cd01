"""Tables of a suite of cases and of the paper's figures."""

from collections.abc import Sequence
from math import floor, log10
from typing import TYPE_CHECKING

from armour.reporting.table import Column, Table
from armour.units import words_and_unit

if TYPE_CHECKING:
    from armour.validation.figures import Figure
    from armour.validation.suite import Case
    from armour.validation.update import Update
    from armour.validation.validate import Check, SuiteResult


def check_groups(result: "SuiteResult") -> dict[str, list["Check"]]:
    """Return the checks of a suite by table; those of no table are "cases"."""
    groups: dict[str, list[Check]] = {}
    for check in result.checks:
        groups.setdefault(check.case.group or "cases", []).append(check)
    return groups


def check_table(checks: Sequence["Check"], title: str = "") -> Table:
    """Return expected and computed values with the bands they are held to."""
    units = [words_and_unit(check.case.quantity)[1] for check in checks]
    shared = units[0] if len(set(units)) == 1 else ""
    columns = (
        Column("case", prose=True),
        *([] if shared else [Column("unit")]),
        Column("expected", shared, ".10g"),
        Column("computed", shared, "g"),
        Column("deviation", shared, "g"),
        Column("deviation", "%", "+.2f"),
        Column("band ±", shared, ".4g"),
        Column("status"),
    )
    rows = tuple(
        (
            check.case.name,
            *([] if shared else [unit]),
            check.case.expected,
            # Each case has decimals of its own, so that computed value and deviation are formatted here.
            _decimal(check.computed, _decimals(check.case)),
            _decimal(check.deviation, _decimals(check.case), sign="+"),
            check.deviation_percent,
            check.case.band,
            check.status,
        )
        for check, unit in zip(checks, units, strict=True)
    )
    return Table(columns, rows, title)


def _decimals(case: "Case") -> int:
    """Return the decimals of a computed value: one more than those of the expected value and of its band."""
    given = len(Column("", spec=".10g").text(case.expected).partition(".")[2])
    of_band = -floor(log10(case.band)) if case.band else 0
    return min(max(given, of_band) + 1, 12)


def _decimal(value: float | str | None, decimals: int, sign: str = "") -> str | None:
    return f"{value:{sign}.{decimals}f}" if isinstance(value, float) else value


def summary_table(result: "SuiteResult") -> Table:
    """Return the deviations of each table of a suite as a whole."""
    columns = (
        Column("table", prose=True),
        Column("rows", spec="d"),
        Column("unit"),
        Column("mean", spec="+.2f"),
        Column("RMS", spec=".2f"),
        Column("largest", spec=".2f"),
        Column("RMS band", spec="g"),
        Column("status"),
    )
    rows = tuple((s.name, s.count, s.unit, s.mean, s.rms, s.largest, s.rms_band, s.status) for s in result.summaries)
    return Table(columns, rows, "tables as a whole")


def error_table(result: "SuiteResult") -> Table:
    """Return the errors of every prediction that a table compares."""
    columns = (
        Column("table", prose=True),
        Column("predicted by", prose=True),
        Column("rows", spec="d"),
        Column("mean error", "%", ".1f"),
        Column("largest error", "%", ".1f"),
    )
    rows = tuple((e.table, e.predictor, e.count, e.mean_percent, e.largest_percent) for e in result.errors)
    return Table(columns, rows, "errors")


def note_rows(checks: Sequence["Check"]) -> list[tuple[str, str]]:
    """Return why cases are not scored, have no answer or have their band; the same note of a table once."""
    notes: dict[tuple[str, str], None] = {}
    for check in checks:
        case = check.case
        if check.message:
            notes[case.full_name, check.message] = None
        elif case.not_scored or case.reason:
            notes[case.group or case.name, case.not_scored or case.reason] = None
    return list(notes)


def note_table(checks: Sequence["Check"]) -> Table:
    """Return the notes on cases."""
    return Table((Column("case", prose=True), Column("reason", prose=True)), tuple(note_rows(checks)))


def verdict(result: "SuiteResult") -> str:
    """Return the outcome of a suite in a line."""
    scored = result.count("within", "outside", "no answer")
    parts = [f"{result.count('within')} of {scored} within their bands"]
    for status in ("outside", "no answer"):
        if result.count(status):
            parts.append(f"{result.count(status)} {status}")
    unscored = sum(check.status == "not scored" for check in result.checks)
    return ", ".join(parts) + (f"; {unscored} shown and not scored" if unscored else "")


def suite_tables(result: "SuiteResult") -> list[Table]:
    """Return the tables of a suite: those as a whole, the errors, and the cases of each table."""
    found = [check_table(checks, name) for name, checks in check_groups(result).items()]
    if result.summaries:
        found.append(summary_table(result))
    if result.errors:
        found.append(error_table(result))
    return found


def update_table(updates: Sequence["Update"]) -> Table:
    """Return the expected values that an update changes."""
    columns = (Column("case", prose=True), Column("expected", spec=".10g"), Column("computed", spec=".10g"))
    return Table(columns, tuple((update.case.full_name, update.case.expected, update.expected) for update in updates))


def figure_table(figure: "Figure") -> Table:
    """Return the curves of a figure, a column each."""
    labels = [figure.x_label, *(f"{curve.label}: {figure.y_label}" for curve in figure.curves)]
    values = [figure.x, *(curve.values for curve in figure.curves)]
    return Table(tuple(Column(label, spec="g", key=label) for label in labels), tuple(zip(*values, strict=True)))


def parity_table(result: "SuiteResult") -> Table:
    """Return expected and computed values of a suite's tables."""
    names = ("table", "row", "quantity")
    columns = (
        *(Column(name, key=name) for name in names),
        *(Column(n, spec="g", key=n) for n in ("expected", "computed")),
    )
    rows = tuple((c.case.group, c.case.name, c.case.quantity, c.case.expected, c.computed) for c in result.checks)
    return Table(columns, rows)
