"""A calibration."""

from armour.analysis.quantities import label_and_unit
from armour.reporting.table import Cell, Column, Source, Table, column_of, deviation_percent, in_words, listing, record
from armour.reporting.text import interval, percent
from armour.statistics.calibration import CalibrationResult


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
        (
            Column(f"{percent(result.confidence)} interval", prose=True),
            lambda c: "; ".join(filter(None, (interval(c.interval, ".4g"), c.reason))),
        ),
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
    parts: list[Table | str] = [law_table(result)] if result.laws else []
    parts.append(coefficient_table(result))
    parts += [PRIOR_NOTE] if _has_prior(result) else []
    parts.append(calibration_table(result))
    if len(result.coefficients) > 1:
        parts.append(correlation_table(result))
    return [*parts, residual_table(result)]
