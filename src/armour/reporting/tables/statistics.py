"""Tables of statistics: calibration, sensitivity, V50 and uncertainty."""

from typing import TYPE_CHECKING

from armour.reporting.table import Cell, Column, Table, record
from armour.reporting.text import interval
from armour.units import words_and_unit

if TYPE_CHECKING:
    from armour.statistics.calibration import CalibrationResult
    from armour.statistics.sensitivity import SensitivityResult
    from armour.statistics.uncertainty import UncertaintyResult
    from armour.statistics.v50 import FiringResult


def percent(confidence: float) -> str:
    """Format a level of confidence."""
    return f"{100.0 * confidence:g} %"


def calibration_table(result: "CalibrationResult") -> Table:
    """Return the quality of a fit to tests."""
    tests = len({residual.test for residual in result.residuals})
    uncertainties = result.weights == "uncertainties"
    return record(
        (Column("tests", spec="d"), tests),
        (Column("weights"), "uncertainties of the tests" if uncertainties else "values measured"),
        (Column("law of the ceramic's flow stress"), result.law or None),
        _error("mean error", result.mean_error_percent),
        _error("mean leave-one-out error", result.left_out_error_percent),
        (Column("degrees of freedom", spec="d"), result.degrees_of_freedom),
        (Column("chi-squared", spec=".2f"), result.chi_squared if uncertainties else None),
        (Column("starts that reach this optimum"), f"{result.starts_agreeing} of {result.starts}"),
    )


def _error(label: str, value: float | None) -> tuple[Column, Cell]:
    return (Column(label), "too few tests") if value is None else (Column(label, "%", ".2f"), value)


def coefficient_table(result: "CalibrationResult") -> Table:
    """Return the fitted coefficients with their intervals, or the reason why one is not identified."""
    columns = (
        Column("coefficient"),
        Column("estimate", spec=".4g"),
        Column(f"{percent(result.confidence)} interval", prose=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for c in result.coefficients:
        found = c.reason if c.interval is None else interval(*c.interval, ".4g")
        rows.append((c.name, "not identified" if c.estimate is None else c.estimate, found))
    return Table(columns, tuple(rows))


def correlation_table(result: "CalibrationResult") -> Table:
    """Return the correlations of the coefficients, which are numbered in the heading."""
    names = [coefficient.name for coefficient in result.coefficients]
    numbers = (Column(str(number), spec="+.3f") for number in range(1, len(names) + 1))
    rows: list[tuple[Cell, ...]] = []
    for number, (name, values) in enumerate(zip(names, result.correlation, strict=True), start=1):
        rows.append((f"{number} {name}", *values))
    return Table((Column("correlation"), *numbers), tuple(rows))


def residual_table(result: "CalibrationResult") -> Table:
    """Return measured and computed values, test by test; one-sided tests have a bound and no deviation."""
    bounds = any(residual.bound for residual in result.residuals)
    columns = (
        Column("test", prose=True),
        Column("quantity", prose=True),
        *([Column("bound")] if bounds else []),
        Column("unit"),
        Column("measured", spec="g"),
        Column("computed", spec=".2f"),
        Column("deviation", "%", "+.2f"),
        Column("leave-one-out deviation", "%", "+.2f"),
        *([Column("bound met")] if bounds else []),
    )
    rows: list[tuple[Cell, ...]] = []
    for r in result.residuals:
        words, unit = words_and_unit(r.quantity)
        deviations = [None if r.bound else _percent_off(value, r.measured) for value in (r.computed, r.left_out)]
        row: list[Cell] = [r.test, words, unit, r.measured, r.computed, *deviations]
        if bounds:
            row.insert(2, r.bound)
            row.append("" if not r.bound else "yes" if r.met else "no")
        rows.append(tuple(row))
    return Table(columns, tuple(rows))


def _percent_off(value: float | None, measured: float) -> float | None:
    return None if value is None else 100.0 * (value / measured - 1.0)


def calibration_tables(result: "CalibrationResult") -> list[Table | str]:
    """Return all tables of a calibration."""
    tables = [calibration_table(result), coefficient_table(result)]
    if len(result.coefficients) > 1:
        tables.append(correlation_table(result))
    return [*tables, residual_table(result)]


def sensitivity_table(result: "SensitivityResult") -> Table:
    """Return the answers whose elasticities are given."""
    found: list[tuple[Column, Cell]] = []
    for name, value in result.answers.items():
        words, unit = words_and_unit(name)
        found.append((Column(words), "none") if value is None else (Column(words, unit, ".2f"), value))
    return record(*found)


def elasticity_table(result: "SensitivityResult") -> Table:
    """Return the elasticities: the change of each answer, in per cent, when an input grows by 1 %."""
    answers = (Column(words_and_unit(name)[0], "% per %", "+.3f") for name in result.answers)
    rows = tuple((item.input, item.value, *item.elasticities.values()) for item in result.inputs)
    return Table((Column("input"), Column("value", spec="g"), *answers), rows)


def sensitivity_tables(result: "SensitivityResult") -> list[Table | str]:
    """Return all tables of a sensitivity analysis."""
    return [sensitivity_table(result), elasticity_table(result)]


def v50_table(result: "FiringResult") -> Table:
    """Return what firing results say of V50 without a fitted curve."""
    mean = result.mean
    none = "none: too few shots of each kind within the span allowed"
    velocity = ("m/s", ".1f")
    rule: list[tuple[Column, Cell]] = [(Column("V50, MIL-STD-662F"), none)]
    if mean is not None:
        rule = [
            (Column("V50, MIL-STD-662F", *velocity), mean.v50_m_s),
            (Column("shots averaged"), f"{mean.pairs} partial and {mean.pairs} complete"),
            (Column("their span", *velocity), mean.span_m_s),
            (Column("span allowed", *velocity), mean.span_allowed_m_s),
        ]
    return record(
        (Column("shots", spec="d"), result.shots),
        (Column("complete penetrations", spec="d"), result.complete),
        (Column("highest partial", *velocity), result.highest_partial_m_s),
        (Column("lowest complete", *velocity), result.lowest_complete_m_s),
        *rule,
        (Column("ballistic limit by the model", *velocity), result.model_ballistic_limit_m_s),
    )


def curve_table(result: "FiringResult") -> Table:
    """Return the curves fitted by maximum likelihood, with their intervals."""
    columns = (
        Column("maximum likelihood"),
        Column("V50", "m/s", ".1f"),
        Column(f"{percent(result.confidence)} interval", "m/s"),
        Column("scale", "m/s", ".1f"),
        Column(f"{percent(result.confidence)} interval", "m/s"),
    )
    rows = tuple(
        (
            fit.curve,
            fit.v50_m_s,
            interval(*fit.v50_interval_m_s, ".1f"),
            fit.scale_m_s,
            interval(*fit.scale_interval_m_s, ".1f"),
        )
        for fit in result.fits
    )
    return Table(columns, rows)


def v50_tables(result: "FiringResult") -> list[Table | str]:
    """Return all tables of firing results, with what to know of them."""
    found: list[Table | str] = [v50_table(result), curve_table(result)]
    if result.separated:
        found.append("every complete penetration was faster than every partial one: any V50 between them is as likely")
    if result.model_ballistic_limit_m_s is not None:
        found.append("the model's limit is deterministic: one velocity for one set of inputs, without scatter")
    return found


def uncertainty_table(result: "UncertaintyResult") -> Table:
    """Return the samples, and the ballistic limit with and without them."""
    return record(
        (Column("samples", spec=",d"), result.samples),
        (Column("method"), f"{result.method}, seed {result.seed}"),
        (Column("ballistic limit of the scenario", "m/s", ".1f"), result.deterministic_m_s),
        (Column("mean ballistic limit", "m/s", ".1f"), result.mean_m_s),
        (Column("standard deviation", "m/s", ".1f"), result.standard_deviation_m_s),
    )


def estimate_table(result: "UncertaintyResult") -> Table:
    """Return probability and quantiles with their intervals, and whether the samples settle the last digit."""
    columns = (
        Column("quantity"),
        Column("unit"),
        Column("estimate", spec="g"),
        Column(f"{percent(result.confidence)} interval"),
        Column("last digit settled", prose=True),
    )
    found = [("probability of perforation", "", result.probability_of_perforation, 3)]
    found += [(name, "m/s", estimate, 1) for name, estimate in result.ballistic_limit_m_s.items()]
    rows = []
    for name, unit, estimate, decimals in found:
        spec = f".{decimals}f"
        needed = estimate.samples_for(10.0**-decimals, result.samples)
        settled = "yes" if needed <= result.samples else f"no, about {float(f'{needed:.2g}'):,.0f} samples would"
        # A probability and velocities have different decimals, so that the number is formatted here.
        rows.append((name, unit, f"{estimate.value:{spec}}", interval(estimate.low, estimate.high, spec), settled))
    return Table(columns, tuple(rows))


def index_table(result: "UncertaintyResult") -> Table:
    """Return how much each input matters for the ballistic limit."""
    between = f"{percent(result.confidence)} interval"
    columns = (
        Column("input"),
        Column("first-order index", spec=".3f"),
        Column(between),
        Column("total index", spec=".3f"),
        Column(between),
        Column("limit at the 5 % quantile", "m/s", ".1f"),
        Column("limit at the 95 % quantile", "m/s", ".1f"),
    )
    rows = []
    for index in result.inputs:
        indices: list[Cell] = []
        for e in (index.first, index.total):
            indices += (None, None) if e is None else (e.value, interval(e.low, e.high, ".3f"))
        rows.append((index.input, *indices, *index.limits_m_s))
    return Table(columns, tuple(rows))


def uncertainty_tables(result: "UncertaintyResult") -> list[Table | str]:
    """Return all tables of a propagated uncertainty."""
    found: list[Table | str] = [uncertainty_table(result), estimate_table(result), index_table(result)]
    if any(index.first is None for index in result.inputs):
        found.append("Sobol' indices are not defined for correlated inputs")
    return found
