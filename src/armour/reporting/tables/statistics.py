"""Tables of statistics: calibration, sensitivity, V50 and uncertainty."""

from typing import TYPE_CHECKING, Any

from armour.reporting.table import Cell, Column, Source, Table, column_of, listing, record
from armour.reporting.tables.confidence import SAMPLED_ALONE, error_note
from armour.reporting.tables.planned_shots import SCATTER_ASSUMED, prior_table, share_note
from armour.reporting.text import interval, percent
from armour.reporting.words import in_words, words_of

if TYPE_CHECKING:
    from armour.statistics.calibration import CalibrationResult
    from armour.statistics.response_curve import FittedCurve
    from armour.statistics.sensitivity import SensitivityResult
    from armour.statistics.uncertainty import UncertaintyResult
    from armour.statistics.v50 import FiringResult


# What the intervals of a propagated uncertainty are of.
SAMPLING = ", by sampling"
SAMPLING_NOTE = (
    "the intervals are those of the estimates, from the number of samples alone; the spread of the ballistic limit is "
    "V05 to V95"
)
INDEX_NOTE = "indices are from 0 to 1; estimates of small and large ones, and their intervals, may fall outside"
ELASTICITY_NOTE = "% per %: change of the answer, in per cent of it, when the input grows by 1 %"


def _between(result: Any, unit: str = "", of: str = "", *, prose: bool = False) -> Column:
    """Return the column of intervals at the confidence level of a result."""
    return Column(f"{percent(result.confidence)} interval{of}", unit, prose=prose)


def calibration_table(result: "CalibrationResult") -> Table:
    """Return the quality of a fit to tests."""
    uncertainties, prior = result.weights == "uncertainties", _has_prior(result)
    return record(
        result,
        (Column("tests", spec="d"), len({residual.test for residual in result.residuals})),
        (Column("deviations relative to"), "uncertainties of the tests" if uncertainties else "measured values"),
        (Column("law of the ceramic's flow stress"), result.law or None),
        _error("mean error", result.mean_error_percent),
        _error("mean leave-one-out error", result.left_out_error_percent),
        *([] if prior else [(Column("AICc", spec=".1f"), "too few tests" if result.aicc is None else result.aicc)]),
        column_of("degrees_of_freedom", ".4g"),
        *_agreement(result),
        (Column("starting points that reach this solution"), f"{result.starts_agreeing} of {result.starts}"),
    )


def _agreement(result: "CalibrationResult") -> list[Source]:
    """Return how well the uncertainties of the tests, if they have them, explain the deviations."""
    if result.weights != "uncertainties":
        return []
    found: list[Source] = [column_of("chi_squared", ".2f", "chi-squared")]
    if result.p_value is not None:
        found.append((Column("p value", spec=".2g"), result.p_value))
    if result.widened_by > 1.0:
        found.append((Column("intervals widened by", spec=".2f"), result.widened_by))
    return found


def _error(label: str, value: float | None) -> Source:
    return (Column(label), "too few tests") if value is None else (Column(label, "%", ".2f"), value)


def _has_prior(result: "CalibrationResult") -> bool:
    return any(coefficient.prior_share is not None for coefficient in result.coefficients)


def coefficient_table(result: "CalibrationResult") -> Table:
    """Return the fitted coefficients with their intervals, or the reason why one is not identified."""
    share = Column("part of the prior", "%", ".0f"), lambda c: None if c.prior_share is None else 100.0 * c.prior_share
    return listing(
        result.coefficients,
        (Column("coefficient", prose=True), lambda c: in_words(c.name)),
        (Column("estimate", spec=".4g"), lambda c: "not identified" if c.estimate is None else c.estimate),
        (_between(result, prose=True), lambda c: "; ".join(filter(None, (interval(c.interval, ".4g"), c.reason)))),
        *([share] if _has_prior(result) else []),
    )


PRIOR_NOTE = (
    "the part of the prior is its part of the precision, 1 over the variance: at 0 % the tests alone give the "
    "estimate, at 100 % they tell nothing"
)


def law_table(result: "CalibrationResult") -> Table:
    """Return the laws that were compared."""
    few = "too few tests"
    without = "none with a prior" if _has_prior(result) else few
    return listing(
        result.laws,
        column_of("law"),
        column_of("coefficients", "d"),
        (
            Column("mean error", "%", ".2f"),
            lambda law: few if law.mean_error_percent is None else law.mean_error_percent,
        ),
        (
            Column("mean leave-one-out error", "%", ".2f"),
            lambda law: few if law.left_out_error_percent is None else law.left_out_error_percent,
        ),
        (Column("AICc", spec=".1f"), lambda law: without if law.aicc is None else law.aicc),
    )


def correlation_table(result: "CalibrationResult") -> Table:
    """Return the correlations of the coefficients, which are numbered in the heading."""
    names = [
        f"{number} {in_words(coefficient.name)}" for number, coefficient in enumerate(result.coefficients, start=1)
    ]
    numbers = (Column(name.partition(" ")[0], spec="+.3f") for name in names)
    rows: list[tuple[Cell, ...]] = [(name, *values) for name, values in zip(names, result.correlation, strict=True)]
    return Table((Column("correlation", prose=True), *numbers), tuple(rows))


def residual_table(result: "CalibrationResult") -> Table:
    """Return measured and computed values, test by test; one-sided tests have a bound and no deviation."""
    bounds = any(residual.bound for residual in result.residuals)
    return listing(
        result.residuals,
        column_of("test", prose=True),
        (Column("quantity", prose=True), lambda r: words_of(r.quantity)[0]),
        *([column_of("bound")] if bounds else []),
        (Column("unit"), lambda r: words_of(r.quantity)[1]),
        column_of("measured", "g"),
        column_of("computed", ".2f"),
        (Column("deviation", "%", "+.2f"), lambda r: None if r.bound else deviation_percent(r.computed, r.measured)),
        (
            Column("leave-one-out deviation", "%", "+.2f"),
            lambda r: None if r.bound else deviation_percent(r.left_out, r.measured),
        ),
        *([(Column("bound met"), lambda r: "" if not r.bound else "yes" if r.met else "no")] if bounds else []),
    )


def deviation_percent(value: float | None, measured: float) -> float | None:
    """Return the deviation of a value from the measured one, per cent."""
    return None if value is None else 100.0 * (value / measured - 1.0)


def calibration_tables(result: "CalibrationResult") -> list[Table | str]:
    """Return all tables of a calibration."""
    tables: list[Table | str] = [law_table(result)] if result.laws else []
    tables += [calibration_table(result), coefficient_table(result)]
    tables += [PRIOR_NOTE] if _has_prior(result) else []
    if len(result.coefficients) > 1:
        tables.append(correlation_table(result))
    return [*tables, residual_table(result)]


def sensitivity_table(result: "SensitivityResult") -> Table:
    """Return the answers whose elasticities are given."""
    sources: list[Source] = []
    for name, value in result.answers.items():
        none = "none (defeated)" if name == "residual_velocity_m_s" else "none"
        column = Column(words_of(name)[0]) if value is None else column_of(name, ".2f")
        sources.append((column, none if value is None else value))
    return record(result, *sources)


def elasticity_table(result: "SensitivityResult") -> Table:
    """Return the elasticities: the change of each answer that has a value, in per cent, when an input grows by 1 %."""
    answers = [name for name, value in result.answers.items() if value is not None]
    return listing(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        column_of("value", "g"),
        *(
            (Column(words_of(name)[0], "% per %", "+.2f"), lambda item, name=name: item.elasticities[name])
            for name in answers
        ),
    )


def sensitivity_tables(result: "SensitivityResult") -> list[Table | str]:
    """Return all tables of a sensitivity analysis."""
    return [sensitivity_table(result), elasticity_table(result), ELASTICITY_NOTE]


def v50_table(result: "FiringResult") -> Table:
    """Return the extreme velocities of the shots, and the mean of MIL-STD-662F."""
    mean = result.mean
    rule: list[Source] = [(Column("V50, mean"), "none: too few shots of each kind within the span allowed")]
    if mean is not None:
        standard = mean.rule != "no usual rule"
        rule = [
            (Column("V50, MIL-STD-662F" if standard else "V50, mean", "m/s", ".1f"), mean.v50_m_s),
            (Column("shots averaged"), f"{mean.pairs} partial and {mean.pairs} complete"),
            (Column("span of these shots", "m/s", ".1f"), mean.span_m_s),
            (Column("span allowed", "m/s", ".1f"), mean.span_allowed_m_s),
        ]
    return record(
        result,
        column_of("shots", "d"),
        column_of("complete", "d", "complete penetrations"),
        column_of("highest_partial_m_s", ".1f"),
        column_of("lowest_complete_m_s", ".1f"),
        *rule,
        column_of("model_ballistic_limit_m_s", ".1f", "ballistic limit by the model"),
        (
            Column("95 % interval, with the error of the model", "m/s"),
            interval(result.model_interval_m_s, ".0f") or None,
        ),
    )


def recommended_table(fit: "FittedCurve", level: float) -> Table:
    """Return the velocities and the scale of the recommended curve, with their intervals."""
    rows = (
        ("V50", fit.v50_m_s, fit.v50_interval_m_s),
        ("V05", fit.v05_m_s, fit.v05_interval_m_s),
        ("V95", fit.v95_m_s, fit.v95_interval_m_s),
        ("scale", fit.scale_m_s, fit.scale_interval_m_s),
    )
    columns = Column("quantity"), Column("estimate", "m/s", ".1f"), Column(f"{percent(level)} interval", "m/s")
    cells = tuple((name, value, interval(ends, ".1f")) for name, value, ends in rows)
    return Table(columns, cells, f"recommended: {fit.curve}, {fit.method}")


def curve_table(result: "FiringResult") -> Table:
    """Return all fitted curves, with their intervals."""
    return listing(
        (*result.penalised_fits, *result.fits),
        column_of("curve"),
        (Column("likelihood"), lambda fit: fit.method.removesuffix(" likelihood")),
        column_of("v50_m_s", ".1f", "V50"),
        (_between(result, "m/s", " of V50"), lambda fit: interval(fit.v50_interval_m_s, ".1f")),
        column_of("scale_m_s", ".1f"),
        (_between(result, "m/s", " of the scale"), lambda fit: interval(fit.scale_interval_m_s, ".1f")),
        column_of("v05_m_s", ".1f", "V05"),
        column_of("v95_m_s", ".1f", "V95"),
    )


# Notes on the mean by its rule.
MEAN_NOTES = {
    "usual span": "the span allowed is the one usual with this number of shots; MIL-STD-662F leaves it to the "
    "specification",
    "given span": "the span allowed is given; MIL-STD-662F leaves it to the specification",
    "no usual rule": "the mean is that of the numbers given; this number of shots is none that is usual with "
    "MIL-STD-662F",
}


def v50_tables(result: "FiringResult") -> list[Table | str]:
    """Return all tables of firing results, with notes on them."""
    found: list[Table | str] = [v50_table(result)]
    if result.mean is not None:
        found.append(MEAN_NOTES[result.mean.rule])
    if result.prior is not None and result.posterior is not None and result.prior_share is not None:
        table = prior_table(result.prior, result.posterior, result.confidence)
        found += [table, SCATTER_ASSUMED, share_note(result.prior_share)]
    if not result.fits:
        return [
            *found,
            "the shots alone have no curve: none were complete, none partial, or the complete ones no faster",
        ]
    if result.recommended is None:
        found.append("no curve is recommended: the penalised likelihood is greatest for a curve that does not rise")
    else:
        found.append(recommended_table(result.recommended, result.confidence))
        found.append(
            "with few shots its intervals hold the true values about as often as they say; those of maximum likelihood "
            "are too short"
        )
        if result.recommended.v05_m_s is None:
            found.append("V05 has no estimate: the curve has 5 % at a velocity below 0")
    found.append(curve_table(result))
    if result.separated:
        found.append(
            "every complete penetration was faster than every partial one: by maximum likelihood any V50 between them "
            "is as likely, and the scale is 0"
        )
    if result.model_ballistic_limit_m_s is not None:
        found.append("the model's limit is deterministic: one velocity for one set of inputs, without scatter")
    return found


def uncertainty_table(result: "UncertaintyResult") -> Table:
    """Return the samples, and the ballistic limit with and without them."""
    return record(
        result,
        column_of("samples", "d"),
        (Column("method"), f"{result.method}, seed {result.seed}"),
        column_of("deterministic_m_s", ".1f", "ballistic limit of the scenario"),
        column_of("standard_deviation_m_s", ".1f"),
    )


def estimate_table(result: "UncertaintyResult") -> Table:
    """Return the estimated probability, quantiles and mean."""
    # Imported here because commands without tables do not need scipy.
    from armour.analysis.estimates import Estimate

    columns = (
        Column("quantity"),
        Column("unit"),
        Column("estimate", spec="g"),
        _between(result, of=SAMPLING),
    )
    found = [("probability of perforation", "", result.probability_of_perforation, 3)]
    limits = {
        **result.ballistic_limit_m_s,
        "mean ballistic limit": Estimate(result.mean_m_s, *result.mean_interval_m_s),
    }
    found += [(name, "m/s", estimate, 1) for name, estimate in limits.items()]
    rows = []
    for name, unit, estimate, decimals in found:
        spec = f".{decimals}f"
        # A probability and velocities have different decimals, so that the number is formatted here.
        rows.append((name, unit, f"{estimate.value:{spec}}", interval((estimate.low, estimate.high), spec)))
    return Table(columns, tuple(rows))


def index_table(result: "UncertaintyResult") -> Table:
    """Return the Sobol' indices of each input, and the ballistic limits at its quantiles."""
    return listing(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        (Column("first-order index", spec=".3f"), lambda item: getattr(item.first, "value", None)),
        (
            _between(result, of=SAMPLING),
            lambda item: item.first and interval((item.first.low, item.first.high), ".3f"),
        ),
        (Column("total index", spec=".3f"), lambda item: getattr(item.total, "value", None)),
        (
            _between(result, of=SAMPLING),
            lambda item: item.total and interval((item.total.low, item.total.high), ".3f"),
        ),
        (Column("ballistic limit at its 5 % quantile", "m/s", ".1f"), lambda item: item.limits_m_s[0]),
        (Column("ballistic limit at its 95 % quantile", "m/s", ".1f"), lambda item: item.limits_m_s[1]),
    )


def uncertainty_tables(result: "UncertaintyResult", *, excluded: bool | None = None) -> list[Table | str]:
    """Return all tables of a propagated uncertainty."""
    found: list[Table | str] = [uncertainty_table(result), estimate_table(result), SAMPLING_NOTE, index_table(result)]
    estimates = [estimate for index in result.inputs for estimate in (index.first, index.total) if estimate]
    if any(estimate.low < 0.0 or estimate.high > 1.0 for estimate in estimates):
        found.append(INDEX_NOTE)
    found.append(error_note(result.model_error, excluded=excluded))
    if result.model_error is None:
        found.append(SAMPLED_ALONE)
    if any(index.first and not index.total for index in result.inputs):
        found.append(
            "inputs are correlated: a first-order index includes what an input shares with those that it is correlated "
            "with, so that their sum may exceed 1; total indices are not given"
        )
    return found
