"""Tables of uncertainties, sensitivities, calibrations, and V50 from firing results."""

from collections.abc import Sequence
from operator import attrgetter, itemgetter

from armour.analysis.estimates import Estimate
from armour.errors import counted
from armour.reporting.by_result import line_of, tables_of
from armour.reporting.table import (
    Cell,
    Column,
    Source,
    Table,
    VerdictLine,
    deviation_percent,
    in_words,
    interval,
    of_part,
    percent,
    with_interval,
)
from armour.reporting.views.analysis import tables_of_each
from armour.reporting.words import (
    SAMPLED_ALONE,
    STOPPING,
    chance,
    error_note,
    risk,
    rounded_up,
    sampled_percents,
)
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.curves import FittedCurve
from armour.statistics.lots import V50Difference
from armour.statistics.own_tests import OwnTest
from armour.statistics.posterior import FiringEstimate
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult, LotResults

STOPPED_ALONE = "stopped by the given distributions alone"
SCATTER_ASSUMED = "the prior for the scatter is assumed; the model does not predict scatter"
SAMPLING_NOTE = "more samples make the intervals narrower, but not the spread of the ballistic limit"


def estimate_table(result: UncertaintyResult) -> Table:
    """Tabulate the probability of stopping, %, and quantiles and mean of the ballistic limit, m/s.

    Intervals show the sampling errors.
    """
    known, alone = result.probability_of_perforation, result.perforated_by_distributions
    rows = [] if known else [(STOPPING.label, "%", "unknown", "")]
    for label, p in ((STOPPING.label, known), (STOPPED_ALONE, alone)):
        if p is not None:
            value, least, most = sampled_percents(1.0 - p.value, (1.0 - p.high, 1.0 - p.low))
            rows.append((label, "%", f"{value:.1f}", interval((least, most), ".1f")))
    low, middle, high = result.limit_quantiles_m_s.values()
    mean = Estimate(result.mean_m_s, *result.mean_interval_m_s)
    for label, each in (("ballistic limit, median", middle), ("mean ballistic limit", mean)):
        rows.append((label, "m/s", f"{each.value:.0f}", interval((each.low, each.high), ".0f")))
    rows.insert(-1, ("90 % between", "m/s", interval((low.value, high.value), ".0f"), ""))
    sampling = Column(f"sampling error, {percent(result.confidence)} interval")
    return Table((Column("quantity"), Column("unit"), Column("estimate", spec="g"), sampling), tuple(rows))


def influence_table(result: UncertaintyResult) -> Table:
    """Tabulate the ballistic limits with each input in turn at its 5 and 95 % quantiles."""
    return Table.of(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        (Column("limit at 5 and 95 %", "m/s"), lambda item: interval(item.limits_m_s, ".0f")),
    )


@line_of.register
def uncertainty_in_a_line(result: UncertaintyResult) -> str:
    """Return the probability of perforation at the velocity of the threat."""
    scenario, p = result.question.get("scenario"), result.probability_of_perforation
    at = f" at {scenario.impact.velocity_m_s:g} m/s" if scenario else ""
    return (
        f"probability of perforation{at}: unknown"
        if p is None
        else (f"perforated with a probability of {risk(1.0 - p.value)}{at}")
    )


@tables_of.register
def tables_of_uncertainty(result: UncertaintyResult) -> list[Table | str]:
    """Return all tables of an uncertainty analysis, with notes."""
    error = error_note(result.model_error, result.question.get("scenario"))
    parts: list[Table | str] = [estimate_table(result), SAMPLING_NOTE, error]
    parts += [SAMPLED_ALONE] if result.model_error is None else []
    method = Column("method"), f"{result.method}, seed {result.seed}"
    of_scenario = Column.of("deterministic_m_s", ".0f", "ballistic limit of the scenario")
    spread = Column.of("standard_deviation_m_s", ".0f")
    parts += [Table.of_one(result, Column.of("samples", "d"), method, of_scenario, spread), influence_table(result)]
    return parts


ELASTICITY_NOTE = "% per %: change of the answer, in per cent of it, when the input grows by 1 %"


def elasticity_table(result: SensitivityResult) -> Table:
    """Tabulate the elasticities: the change of each answer, %, when an input grows by 1 %.

    Answers without a value, such as the residual velocity of a stopped projectile, have no column.
    """
    answers = [name for name, value in result.answers.items() if value is not None]
    changes = ((Column(Column.of(name).label, "% per %", "+.2f"), itemgetter(name)) for name in answers)
    inputs: Source = Column("input", prose=True), lambda item: in_words(item.input)
    return Table.of(result.inputs, inputs, Column.of("value", "g"), *of_part(attrgetter("elasticities"), *changes))


@line_of.register
def sensitivity_in_a_line(result: SensitivityResult) -> str:
    """Return the input on which the first answer, the ballistic limit if there is one, depends most."""
    answer = next((name for name, value in result.answers.items() if value is not None), "")
    inputs = [item for item in result.inputs if item.elasticities.get(answer)]
    if not inputs:
        return "no answer depends on any input"
    most = max(inputs, key=lambda item: abs(item.elasticities[answer] or 0.0))
    words = f"the {Column.of(answer).label} depends most on the {Column.of(most.input).label}"
    return f"{words}: {most.elasticities[answer]:+.2f} % for 1 % more"


@tables_of.register
def tables_of_sensitivity(result: SensitivityResult) -> list[Table | str]:
    """Return the answers of a sensitivity analysis and their elasticities, with a note."""
    answers: list[Source] = []
    for name, value in result.answers.items():
        none = "none (stopped)" if name == "residual_velocity_m_s" else "none"
        answers.append((Column(Column.of(name).label), none) if value is None else (Column.of(name), value))
    return [Table.of_one(result, *answers), elasticity_table(result), ELASTICITY_NOTE]


@line_of.register
def calibration_in_a_line(result: CalibrationResult) -> str:
    """Return the number of tests and the errors of the fit."""
    line = f"calibration to {counted(len({residual.test for residual in result.residuals}), 'test')}"
    if result.mean_error_percent is not None:
        line += f": mean error {result.mean_error_percent:.1f} %"
    if result.left_out_error_percent is not None:
        line += f", {result.left_out_error_percent:.1f} % leave-one-out"
    return line


def calibration_table(result: CalibrationResult) -> Table:
    """Tabulate the errors of a fit to tests and, if the tests have uncertainties, its chi-squared test."""
    weighted, few = result.weights == "uncertainties", _no_error(result)
    return Table.of_one(
        result,
        (Column("tests", spec="d"), len({residual.test for residual in result.residuals})),
        (Column("deviations relative to"), "uncertainties of the tests" if weighted else "measured values"),
        Column.of("law", label="law of the ceramic's flow stress"),
        _error("mean error", result.mean_error_percent, few),
        _error("mean leave-one-out error", result.left_out_error_percent, few),
        Column.of("degrees_of_freedom", ".4g"),
        (Column("chi-squared", spec=".2f"), result.chi_squared if weighted else None),
        (Column("p value", spec=".2g"), result.p_value if weighted else None),
        (Column("intervals widened by", spec=".2f"), result.widened_by if result.widened_by > 1.0 else None),
        (Column("starting points that reach this solution"), f"{result.starts_agreeing} of {result.starts}"),
    )


def _no_error(result: CalibrationResult) -> str:
    """Return why a fit has no error: outcomes have none, and others need enough tests."""
    return "outcomes have none" if all(residual.bound for residual in result.residuals) else "too few tests"


def _error(label: str, value: float | None, few: str) -> Source:
    """Return the column of an error, %, with its value, or with why there is none."""
    return (Column(label), few) if value is None else (Column(label, "%", ".1f"), value)


def coefficient_table(result: CalibrationResult) -> Table:
    """Tabulate the fitted coefficients with their intervals, or the reasons why they are not identified."""
    known = Column(f"{percent(result.confidence)} interval", prose=True)
    return Table.of(
        result.coefficients,
        (Column("coefficient", prose=True), lambda c: in_words(c.name)),
        (Column("estimate", spec=".4g"), lambda c: _value_or(c.estimate, "not identified")),
        (known, lambda c: "; ".join(filter(None, (interval(c.interval, ".4g"), c.reason)))),
    )


def _value_or(value: float | None, words: str) -> Cell:
    """Return a value, or the words if it is None."""
    return words if value is None else value


def correlation_table(result: CalibrationResult) -> Table:
    """Tabulate the correlations of the coefficients, whose numbers head the columns."""
    names = [f"{number} {in_words(c.name)}" for number, c in enumerate(result.coefficients, start=1)]
    numbers = (Column(name.partition(" ")[0], spec="+.3f") for name in names)
    rows: list[tuple[Cell, ...]] = [(name, *values) for name, values in zip(names, result.correlation, strict=True)]
    return Table((Column("correlation", prose=True), *numbers), tuple(rows))


def residual_table(result: CalibrationResult) -> Table:
    """Tabulate measured and computed values, test by test; shots give a bound and have no deviation."""
    quantities = {residual.quantity for residual in result.residuals}
    shared = Column.of(*quantities) if len(quantities) == 1 else Column("")

    def deviation(residual: Residual, value: float | None) -> float | None:
        return None if residual.bound else deviation_percent(value, residual.measured)

    return Table.of(
        result.residuals,
        Column.of("test", prose=True),
        (Column("quantity", prose=True), lambda r: "" if shared.label else Column.of(r.quantity).label),
        (Column("unit"), lambda r: "" if shared.label else Column.of(r.quantity).unit),
        Column.of("bound"),
        (Column(f"measured {shared.label}".rstrip(), shared.unit, "g"), lambda r: r.measured),
        (Column("computed", shared.unit, ".4g"), lambda r: r.computed),
        (Column("deviation", "%", "+.1f"), lambda r: deviation(r, r.computed)),
        (Column("leave-one-out deviation", "%", "+.1f"), lambda r: deviation(r, r.left_out)),
        (Column("bound met"), lambda r: "" if not r.bound else "yes" if r.met else "no"),
    )


def own_test_table(tests: Sequence[OwnTest]) -> Table:
    """Tabulate own tests: the measured limits, those computed, and those predicted from the other own tests."""
    predicted = Column("predicted from the others (95 % interval)", "m/s")
    return Table.of(
        tests,
        Column.of("name", label="test", prose=True),
        *Column.of_each(ceramic_thickness_mm="g", backing_thickness_mm="g", obliquity_deg=".0f"),
        Column.of("penetrator_diameter_mm", ".4g", "penetrator diameter"),
        (Column("measured", "m/s"), own_measured),
        Column.of("computed_m_s", ".0f", "computed"),
        (predicted, lambda test: f"{test.predicted_m_s:.0f} ({interval(test.interval_m_s, '.0f')})"),
        (Column("out of line"), lambda test: "yes" if test.out_of_line else ""),
    )


def own_measured(test: OwnTest) -> str:
    """Return what an own test measured, m/s, with its standard deviation, such as "at least 820 ± 15"."""
    deviation = f" ± {test.uncertainty_m_s:.0f}" if test.uncertainty_m_s else ""
    return f"{test.bound}{' ' * bool(test.bound)}{test.measured_m_s:.0f}{deviation}"


@tables_of.register
def tables_of_calibration(result: CalibrationResult) -> list[Table | str]:
    """Return all tables of a calibration."""
    parts: list[Table | str] = [coefficient_table(result), calibration_table(result)]
    parts += [correlation_table(result)] if len(result.coefficients) > 1 else []
    return [*parts, residual_table(result)]


def v50_table(result: FiringResult) -> Table:
    """Tabulate the shots: their numbers, the zone of mixed results, the mean of MIL-STD-662F, and the model's limit."""
    spans = [
        f"{m.pairs} + {m.pairs} within {m.span_m_s:.4g} m/s, {m.span_allowed_m_s:.4g} allowed" for m in result.means
    ]
    rule: list[Source] = [(Column("V50, mean"), f"none: {'; '.join(spans) or 'too few shots of each kind'}")]
    if (mean := result.mean) is not None:
        rule = [
            (Column("V50, MIL-STD-662F" if mean.rule == "usual span" else "V50, mean", "m/s", ".0f"), mean.v50_m_s),
            (Column("shots averaged"), f"{mean.pairs} partial and {mean.pairs} complete"),
            (Column("span of these shots", "m/s", ".4g"), mean.span_m_s),
            (Column("span allowed", "m/s", ".4g"), mean.span_allowed_m_s),
        ]
    return Table.of_one(
        result,
        Column.of("shots", "d"),
        Column.of("complete", "d", "complete penetrations"),
        *Column.of_each(highest_partial_m_s=".0f", lowest_complete_m_s=".0f", zone_of_mixed_results_m_s=".0f"),
        *rule,
        Column.of("model_ballistic_limit_m_s", ".0f", "ballistic limit by the model"),
        (Column("its 95 % interval, with the model error", "m/s"), interval(result.model_interval_m_s, ".0f")),
    )


def recommended_table(fit: FittedCurve, level: float) -> Table:
    """Tabulate V50, V05, V95 and scatter of the recommended curve, with intervals and bounds at a confidence level."""
    rows = (
        ("V50", fit.v50_m_s, interval(fit.v50_interval_m_s, ".0f"), _value_or(fit.v50_lower_m_s, "not bounded")),
        ("V05", fit.v05_m_s, interval(fit.v05_interval_m_s, ".0f"), _value_or(fit.v05_lower_m_s, "not bounded")),
        ("V95", fit.v95_m_s, interval(fit.v95_interval_m_s, ".0f"), None),
        ("scatter", fit.scale_m_s, interval(fit.scale_interval_m_s, ".0f"), None),
    )
    lower = Column(f"one-sided {percent(level)} lower bound", "m/s", ".0f")
    columns = Column("quantity"), Column("estimate", "m/s", ".0f"), Column(f"{percent(level)} interval", "m/s"), lower
    return Table.of_rows(columns, rows, f"recommended: {fit.curve}, {fit.method}")


def curve_table(result: FiringResult) -> Table:
    """Tabulate all fitted curves: V50 and scatter with their intervals, V05 and V95."""
    level = f"{percent(result.confidence)} interval"
    return Table.of(
        (*result.penalised_fits, *result.fits),
        Column.of("curve"),
        (Column("likelihood"), lambda fit: fit.method.removesuffix(" likelihood")),
        (Column(f"V50, {level}", "m/s"), lambda fit: with_interval(fit.v50_m_s, fit.v50_interval_m_s, ".0f")),
        (Column(f"scatter, {level}", "m/s"), lambda fit: with_interval(fit.scale_m_s, fit.scale_interval_m_s, ".0f")),
        Column.of("v05_m_s", ".0f", "V05"),
        Column.of("v95_m_s", ".0f", "V95"),
    )


WIDER = (
    "the posterior is wider than the interval by the shots alone: its prior expects more scatter than the shots show"
)
PENALISED = "intervals by penalised likelihood; with few shots those of maximum likelihood are too narrow"


# Names of the mean of velocities, and notes on it, by the rule for the span of its shots.
MEANS = {"usual span": "MIL-STD-662F", "given span": "mean within the span given", "no usual rule": "mean of shots"}
MEAN_NOTES = {
    "usual span": "the span allowed is usual with this number of shots; MIL-STD-662F leaves it to the specification",
    "given span": "the span allowed is given and not the usual one; MIL-STD-662F leaves it to the specification",
    "no usual rule": "MIL-STD-662F does not usually average this number of shots",
}


def answer(result: FiringResult) -> str:
    """Return V50 and the mean of velocities in a line.

    The interval of V50 has the confidence level asked for or, if it is not bounded at this level, a lower one.
    """
    parts, fit, mean = [], result.recommended, result.mean
    if fit is not None:
        words, level = f"V50 {fit.v50_m_s:.0f} m/s", result.bounded_confidence
        open_level = f"{percent(result.confidence)} not bounded"
        if result.extrapolated:
            words = "V50 not bounded by these shots"
        elif level is None:
            words += f", interval not bounded ({open_level})"
        else:
            words += f", {percent(level)} interval {interval(result.bounded_interval_m_s, '.0f')}"
            words += f" ({open_level})" if level < result.confidence else ""
        parts.append(words)
    if mean is not None:
        shots = f"{mean.pairs} + {mean.pairs} shots within {mean.span_m_s:.4g} m/s"
        parts.append(f"{MEANS[mean.rule]}: {mean.v50_m_s:.0f} m/s from {shots}")
    return "; ".join(parts)


FIXED = (
    "the risks are approximate: where the scatter far exceeds the steps between shots, 5 % may be 13 %; they hold for "
    "shots whose number did not depend on their results; armour plan shots --requirement-m-s decides at any time, with "
    "more shots and bounded risks"
)


def further_note(result: FiringResult) -> list[str]:
    """Return a note on the one further shot that would bound V50 best, if the result has one."""
    if (further := result.further) is None:
        return []
    shot = f"a {'complete' if further.complete else 'partial'} penetration at {further.velocity_m_s:.0f} m/s"
    if further.confidence is None:
        return [f"no single further result bounds V50; {shot} comes nearest"]
    found = f"{percent(further.confidence)} interval {interval(further.interval_m_s, '.0f')} m/s"
    if further.confidence == result.confidence:
        return [f"one further result would bound V50, best {shot}: {found}"]
    return [f"no single further result bounds V50 at {percent(result.confidence)}; best is {shot}: {found}"]


def second_note(fit: FittedCurve | None) -> list[str]:
    """Return a note on a second curve that fits the shots nearly as well as the recommended one, if there is one."""
    if fit is None or fit.second_v50_m_s is None:
        return []
    return [
        f"two curves fit these shots nearly equally: V50 {fit.v50_m_s:.1f} m/s with a scatter of {fit.scale_m_s:.1f} "
        f"m/s, and V50 {fit.second_v50_m_s:.1f} m/s with a scatter of {fit.second_scale_m_s:.1f} m/s; further shots "
        "decide between them"
    ]


def point_notes(result: FiringResult) -> list[str]:
    """Return notes on the points of the recommended curve that were asked for, with their intervals.

    They are the probability of perforation at a velocity, and the velocity at which a fraction perforates.
    """
    notes, level = [], percent(result.confidence)
    if (at := result.at) is not None:
        perforated, ends = risk(1.0 - at.probability), f"{chance(at.interval[0])} to {risk(1.0 - at.interval[1])}"
        notes.append(f"probability of perforation at {at.velocity_m_s:g} m/s: {perforated}, {level} interval {ends}")
    if (point := result.velocity_of) is not None:
        value = "no positive estimate" if point.velocity_m_s is None else f"{point.velocity_m_s:.0f} m/s"
        bound = "not bounded" if point.lower_m_s is None else f"{point.lower_m_s:.0f} m/s"
        ends = f"{level} interval {interval(point.interval_m_s, '.0f')}, one-sided {level} lower bound {bound}"
        notes.append(f"{velocity_name(point.fraction)}: {value}, {ends}")
    return notes


def velocity_name(fraction: float) -> str:
    """Return the name of the velocity at which a fraction perforates, such as "V05" for 0.05."""
    number = f"{100.0 * fraction:.3g}"
    return f"V{number.zfill(2)}"


def requirement_verdict(result: FiringResult) -> list[str]:
    """Return whether the required velocity is met, with the risks of accepting and of rejecting the armour now.

    Without a requirement, return no line.
    """
    if result.requirement_m_s is None:
        return []
    required = f"{result.requirement_m_s:g} m/s required of {velocity_name(result.requirement_fraction)}"
    if result.consumers_risk is None or result.producers_risk is None:
        return [VerdictLine(f"{result.decision}: {required}; no curve fits the shots", good=False)]
    allowed = percent(round(1.0 - result.confidence, 12))
    risks = (
        f"accepting it now has a risk (consumer's) of {rounded_risk(result.consumers_risk)}, rejecting it (producer's) "
        f"of {rounded_risk(result.producers_risk)}; {allowed} decides"
    )
    return [VerdictLine(f"{result.decision}: {required}; {risks}", good=result.decision == "met"), FIXED]


def rounded_risk(risk: float) -> str:
    """Format a risk in per cent, rounded up to a tenth."""
    return "below 0.1 %" if risk < 1e-3 else f"{rounded_up(100.0 * risk)} %"


@line_of.register
def firing_in_a_line(result: FiringResult) -> str:
    """Return V50 by the recommended curve, or else the first, with its interval at the level asked for."""
    fit = result.recommended or next(iter(result.fits), None)
    if fit is None or result.extrapolated:
        return "V50 not bounded by these shots"
    ends = fit.v50_interval_m_s
    unit = " m/s" if ends != (None, None) else ""
    return f"V50 {fit.v50_m_s:.1f} m/s, {percent(result.confidence)} interval {interval(ends, '.1f')}{unit}"


@tables_of.register
def tables_of_firing(result: FiringResult) -> list[Table | str]:
    """Return whether a requirement is met, V50, the recommended curve, the posterior, the shots and all curves."""
    shown: list[Table | str] = [*requirement_verdict(result), *filter(None, (answer(result),))]
    shown += [*second_note(result.recommended), *further_note(result), *point_notes(result)]
    if result.recommended is not None:
        shown += [recommended_table(result.recommended, result.confidence), PENALISED]
        if result.recommended.v05_m_s is None:
            shown.append("V05 has no estimate: the curve is at 5 % at a velocity below 0")
    elif result.fits:
        shown.append("no curve is recommended: the penalised likelihood is greatest for a curve that does not rise")
    else:
        shown.append("no curve fits the shots alone: none complete, none partial, or the complete ones no faster")
    if result.prior is not None and result.posterior is not None and result.prior_share is not None:
        table = prior_table(result.prior, result.posterior, result.confidence)
        shown += [table, SCATTER_ASSUMED, share_note(result.prior_share)]
        low, high = (None, None) if result.recommended is None else result.recommended.v50_interval_m_s
        slowest, fastest = result.posterior.v50_interval_m_s
        shown += [WIDER] if low is not None and high is not None and high - low < fastest - slowest else []
    shown.append(v50_table(result))
    if result.mean is not None:
        shown.append(MEAN_NOTES[result.mean.rule])
    if result.fits:
        shown.append(curve_table(result))
    if result.separated:
        shown.append(
            "every complete penetration was faster than every partial one: by maximum likelihood every V50 between "
            "them is equally likely, and the scatter is 0"
        )
    return shown


ONE_SCATTER = (
    "a difference supposes that the lots have one scatter; of several pairs, all intervals hold together with the "
    "confidence, and each p is multiplied by their number"
)


@line_of.register
def lots_in_a_line(result: LotResults) -> str:
    """Return whether the lots differ or, if they are not compared, their names."""
    return "; ".join(difference_words(result)) or ", ".join((*result.results, *result.unanswered))


def difference_words(result: LotResults, name: str = "") -> list[str]:
    """Return a line for each pair of lots, or of those with a name, which says whether they differ."""
    return [
        _difference(pair, difference, len(result.differences))
        for pair, difference in result.differences.items()
        if not name or name in pair.split(" minus ")
    ]


def _difference(pair: str, found: V50Difference, pairs: int) -> str:
    """Return whether a pair of lots differ, with the interval of the difference."""
    together = 1.0 - (1.0 - found.confidence) * pairs
    ends = interval(found.interval_m_s, ".0f")
    p_value = "< 0.001" if found.p_value < 1e-3 else f"= {found.p_value:.2g}"
    says = "V50 differs" if found.p_value < 1.0 - together else "V50 not found to differ"
    return f"{says}: {pair} {found.difference_m_s:+.0f} m/s, {percent(round(together, 9))} interval {ends}, p {p_value}"


@tables_of.register
def tables_of_lots(result: LotResults) -> list[Table | str]:
    """Return whether the lots differ, V50 of each at one level, and the tables of each."""
    shown: list[Table | str] = [*difference_words(result)]
    shown += [ONE_SCATTER] if shown else []
    fits = {name: lot.recommended for name, lot in result.results.items() if isinstance(lot, FiringResult)}
    if any(fits.values()):
        level = percent(next(lot.confidence for lot in result.results.values() if isinstance(lot, FiringResult)))
        v50: Source = Column("V50", "m/s", ".0f"), lambda row: row[1].v50_m_s
        ends: Source = Column(f"{level} interval", "m/s"), lambda row: interval(row[1].v50_interval_m_s, ".0f")
        scatter: Source = Column("scatter", "m/s", ".0f"), lambda row: row[1].scale_m_s
        known = [(name, fit) for name, fit in fits.items() if fit is not None]
        shown.append(Table.of(known, (Column("lot"), itemgetter(0)), v50, ends, scatter, title="V50 of each"))
    return [*shown, *tables_of_each(result)]


def prior_table(prior: FiringEstimate, posterior: FiringEstimate, level: float) -> Table:
    """Tabulate V50 and the scatter before and after the shots, with intervals at a confidence level."""
    v50, scatter = (Column(f"{name}, {percent(level)} interval", "m/s") for name in ("V50", "scatter"))
    return Table.of(
        (("prior", prior), ("posterior", posterior)),
        (Column("distribution"), lambda row: row[0]),
        (v50, lambda row: with_interval(row[1].v50_m_s, row[1].v50_interval_m_s, ".0f")),
        (Column("standard deviation of V50", "m/s", ".0f"), lambda row: row[1].standard_deviation_m_s),
        (scatter, lambda row: with_interval(row[1].scatter_m_s, row[1].scatter_interval_m_s, ".0f")),
    )


def share_note(share: float) -> str:
    """Return a note on how much the prior contributes to the posterior of V50; `share` is part of the precision."""
    if share >= 1.0:
        return "the shots do not narrow V50: its posterior is no narrower than its prior"
    part = f"{100.0 * share:.{0 if share > 0.095 else 1}f} %"
    return f"the prior contributes {part} of the precision (inverse variance) of V50, and the shots contribute the rest"
