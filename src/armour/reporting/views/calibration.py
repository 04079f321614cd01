"""A calibration."""

from collections.abc import Mapping, Sequence

from armour.analysis.quantities import label_and_unit
from armour.reporting import charts
from armour.reporting.table import (
    Cell,
    Column,
    Source,
    Table,
    between,
    column_of,
    deviation_percent,
    in_words,
    listing,
    record,
)
from armour.reporting.text import interval, number
from armour.scenario.inputs import BACKING, CERAMIC
from armour.statistics.calibration import CalibrationResult, Residual


def calibration_table(result: CalibrationResult) -> Table:
    """Return the quality of a fit to tests, and how well the tests' uncertainties, if any, explain the deviations."""
    weighted = result.weights == "uncertainties"
    aicc = None if _has_prior(result) else _or(result.aicc, "too few tests")
    return record(
        result,
        (Column("tests", spec="d"), len({residual.test for residual in result.residuals})),
        (Column("deviations relative to"), "uncertainties of the tests" if weighted else "measured values"),
        (Column("law of the ceramic's flow stress"), result.law),
        _error("mean error", result.mean_error_percent),
        _error("mean leave-one-out error", result.left_out_error_percent),
        (Column("AICc", spec=".1f"), aicc),
        column_of("degrees_of_freedom", ".4g"),
        (Column("chi-squared", spec=".2f"), result.chi_squared if weighted else None),
        (Column("p value", spec=".2g"), result.p_value if weighted else None),
        (Column("intervals widened by", spec=".2f"), result.widened_by if result.widened_by > 1.0 else None),
        (Column("starting points that reach this solution"), f"{result.starts_agreeing} of {result.starts}"),
    )


def _error(label: str, value: float | None) -> Source:
    return (Column(label), "too few tests") if value is None else (Column(label, "%", ".1f"), value)


def _has_prior(result: CalibrationResult) -> bool:
    return any(coefficient.prior_share is not None for coefficient in result.coefficients)


def coefficient_table(result: CalibrationResult) -> Table:
    """Return the fitted coefficients with their intervals, or the reason why one is not identified."""
    return listing(
        result.coefficients,
        (Column("coefficient", prose=True), lambda c: in_words(c.name)),
        (Column("estimate", spec=".4g"), lambda c: _or(c.estimate, "not identified")),
        (between(result, prose=True), lambda c: "; ".join(filter(None, (interval(c.interval, ".4g"), c.reason)))),
        (Column("part of the prior", "%", ".0f"), lambda c: c.prior_share and 100.0 * c.prior_share),
    )


PRIOR_NOTE = (
    "part of the prior: its share of the precision (inverse variance); at 0 % the tests alone determine the estimate, "
    "at 100 % they add nothing"
)


def law_table(result: CalibrationResult) -> Table:
    """Return the laws that were compared."""
    few = "too few tests"
    without = "none with a prior" if _has_prior(result) else few
    return listing(
        result.laws,
        column_of("law"),
        column_of("coefficients", "d"),
        (column_of("mean_error_percent", ".1f"), lambda law: _or(law.mean_error_percent, few)),
        (Column("mean leave-one-out error", "%", ".1f"), lambda law: _or(law.left_out_error_percent, few)),
        (Column("AICc", spec=".1f"), lambda law: _or(law.aicc, without)),
    )


def _or(value: float | None, words: str) -> Cell:
    return words if value is None else value


def correlation_table(result: CalibrationResult) -> Table:
    """Return the correlations of the coefficients, which are numbered in the heading."""
    names = [f"{number} {in_words(each.name)}" for number, each in enumerate(result.coefficients, start=1)]
    numbers = (Column(name.partition(" ")[0], spec="+.3f") for name in names)
    rows: list[tuple[Cell, ...]] = [(name, *values) for name, values in zip(names, result.correlation, strict=True)]
    return Table((Column("correlation", prose=True), *numbers), tuple(rows))


def residual_table(result: CalibrationResult) -> Table:
    """Return measured and computed values, test by test; one-sided tests have a bound and no deviation."""
    quantities = {residual.quantity for residual in result.residuals}
    words, unit = label_and_unit(*quantities) if len(quantities) == 1 else ("", "")
    each: tuple[Source, ...] = (
        (Column("quantity", prose=True), lambda r: label_and_unit(r.quantity)[0]),
        (Column("unit"), lambda r: label_and_unit(r.quantity)[1]),
    )
    return listing(
        result.residuals,
        column_of("test", prose=True),
        *(() if words else each),
        column_of("bound"),
        (Column(f"measured {words}".rstrip(), unit, "g"), lambda r: r.measured),
        (Column("computed", unit, ".4g"), lambda r: r.computed),
        (Column("deviation", "%", "+.1f"), lambda r: None if r.bound else deviation_percent(r.computed, r.measured)),
        (
            Column("leave-one-out deviation", "%", "+.1f"),
            lambda r: None if r.bound else deviation_percent(r.left_out, r.measured),
        ),
        (Column("bound met"), lambda r: "" if not r.bound else "yes" if r.met else "no"),
    )


def tables(result: CalibrationResult) -> list[Table | str]:
    """Return all tables of a calibration."""
    found: list[Table | str] = [law_table(result)] if result.laws else []
    found.append(coefficient_table(result))
    found += [PRIOR_NOTE] if _has_prior(result) else []
    found.append(calibration_table(result))
    if len(result.coefficients) > 1:
        found.append(correlation_table(result))
    return [*found, residual_table(result)]


# Rows of deviations.
MAX_ROWS = 40


def chart(result: CalibrationResult) -> charts.Chart:
    """Describe computed over measured values, and the deviations test by test, fitted and left out."""
    words = {"": "measured", "at least": "stopped at", "at most": "perforated at"}
    panels = []
    names = _test_names(result)
    for quantity, residuals in charts.grouped(result.residuals, lambda residual: residual.quantity).items():
        by_bound = charts.grouped(residuals, lambda residual: residual.bound)
        groups = {
            words[bound] if bound else "tests": [
                charts.Compared(names[r.test], words[bound], r.measured, r.computed, r.uncertainty or 0.0)
                for r in by_bound[bound]
            ]
            for bound in words
            if bound in by_bound
        }
        panels.append(charts.agreement_panel(quantity, "measured", groups))
        if "" in by_bound:
            panels.append(_deviation_panel(quantity, by_bound[""], names))
    given = any(residual.uncertainty for residual in result.residuals)
    note = "Error bars: ± one standard deviation of the measured value." if given else ""
    title = f"Calibration to {len(names)} tests"
    if result.mean_error_percent is not None:
        title += f": mean error {result.mean_error_percent:.1f} %"
    if result.left_out_error_percent is not None:
        title += f", {result.left_out_error_percent:.1f} % leave-one-out"
    return charts.Chart(title, tuple(panels), note)


def _test_names(result: CalibrationResult) -> dict[str, str]:
    """Return the name of each test or, where it has none, its armour."""
    names = {residual.test: residual.test for residual in result.residuals}
    tests = result.question.get("tests")
    for name, place, cells in zip(tests.names, tests.places, tests.cells, strict=True) if tests else ():
        layers = [number(float(cells[key]), "g") for key in (CERAMIC, BACKING) if key in cells]
        if name == place and layers:
            names[name] = f"{' on '.join(layers)} mm"
    return names


def _deviation_panel(quantity: str, residuals: Sequence[Residual], names: Mapping[str, str]) -> charts.Panel:
    """Describe deviations from measured values; of many tests those with the largest."""
    title = f"Deviation of the computed {charts.quantity_axis(quantity).label}"
    shown = sorted(residuals, key=lambda r: -abs(deviation_percent(r.computed, r.measured) or 0.0))[:MAX_ROWS]
    if len(shown) < len(residuals):
        title += f", the {MAX_ROWS} largest of {len(residuals)}"
    values = {
        "fitted": [deviation_percent(residual.computed, residual.measured) for residual in shown],
        "leave-one-out": [deviation_percent(residual.left_out, residual.measured) for residual in shown],
    }
    x = charts.Axis("deviation", "%", spec="+.2f")
    return charts.rows_panel(x, tuple(names[residual.test] for residual in shown), values, title, 0.0)
