"""Tables of uncertainties, sensitivities, calibrations, and V50 from firing results."""

from collections.abc import Collection, Sequence

from armour.analysis.ballistic_limit import ConfidenceResult, no_error
from armour.errors import counted
from armour.reporting.by_result import in_a_line, line_of, tables_of
from armour.reporting.table import Cell, Column, Table, VerdictLine, between, in_words, interval, number, percent
from armour.reporting.views.analysis import tables_of_each
from armour.reporting.words import chance, model_error_words, rounded_up, sampled_percents
from armour.scenario.scenario import rounds
from armour.statistics.calibration import CalibrationResult, Residual
from armour.statistics.curves import FittedCurve
from armour.statistics.likelihood import Coefficient
from armour.statistics.lots import V50Difference
from armour.statistics.posterior import FiringEstimate
from armour.statistics.sensitivity import SensitivityResult
from armour.statistics.uncertainty import UncertaintyResult
from armour.statistics.v50 import FiringResult, LotResults, Shots

SCATTER_ASSUMED = "the prior for the scatter is assumed; the model does not predict scatter"
# Inputs of a sensitivity, and tests of a calibration, that the first answer shows.
MOST_INPUTS, MOST_TESTS = 6, 3


def influence_table(result: UncertaintyResult) -> Table:
    """Tabulate the ballistic limits with each input in turn at its 5 and 95 % quantiles."""
    return Table.of(
        result.inputs,
        (Column("because of", prose=True), lambda item: Column.of(item.input).label),
        (Column("limit at its 5 % and 95 % quantiles"), lambda item: f"{interval(item.limits_m_s, '.0f')} m/s"),
    )


@line_of.register
def uncertainty_in_a_line(result: UncertaintyResult) -> str:
    """Return the probability of stopping a shot, or what the given distributions alone say."""
    scenario = result.question.get("scenario")
    p = result.probability_of_perforation or result.perforated_by_distributions
    assert p is not None
    value, low, high = sampled_percents(1.0 - p.value, (1.0 - p.high, 1.0 - p.low))
    if result.probability_of_perforation is None:
        reason = no_error(scenario) if scenario else "no test of such an armour is known"
        return f"not known: {reason}; with the model taken as exact {value:.1f} %"
    shot = f" of {rounds(scenario.impact, {}, ())}" if scenario else ""
    return f"stops a shot{shot} with {value:.1f} % (± {rounded_up(max(value - low, high - value))} by sampling)"


@tables_of.register
def tables_of_uncertainty(result: UncertaintyResult) -> list[Table | str]:
    """Return the probability of stopping a shot, and what makes it uncertain; with `every_row`, also the sampling."""
    low, middle, high = (each.value for each in result.limit_quantiles_m_s.values())
    limit = [f"90 % between {low:.0f} and {high:.0f} m/s", f"{result.deterministic_m_s:.0f} m/s by the model"]
    if result.model_error is not None:
        limit.insert(0, f"{middle:.0f} m/s expected")
    line = VerdictLine(in_a_line(result), good=None if result.probability_of_perforation else False)
    shown: list[Table | str] = [line, Table.of_facts({"limit": "; ".join(limit)}), influence_table(result)]
    if result.question.get("every_row"):
        sampling = f"{result.samples} by sobol, seed {result.seed}"
        spread = f"{result.standard_deviation_m_s:.0f} m/s"
        shown.append(Table.of_facts({"samples": sampling, "standard deviation": spread}))
        shown += [] if result.model_error is None else [model_error_words(result.model_error)]
    return shown


def elasticity_table(result: SensitivityResult, answers: Sequence[str], most: int | None = None) -> Table:
    """Tabulate the change of each of `answers`, %, when an input grows by 1 %, for at most the first `most` inputs."""
    rows = [item for item in result.inputs if any(item.elasticities[name] is not None for name in answers)]
    return Table.of(
        rows[:most],
        (Column("1 % more of", prose=True), lambda item: Column.of(item.input).label),
        (Column("value"), lambda item: Column.of(item.input, ".5g").with_unit(item.value)),
        *(
            (Column(f"changes the {_name_of(name)} by"), lambda item, name=name: _percent(item.elasticities[name]))
            for name in answers
        ),
    )


def _name_of(answer: str) -> str:
    """Return the short name of the quantity that a sensitivity is of, such as "limit"."""
    return Column.of(answer).label.replace("ballistic ", "")


def _percent(change: float | None) -> str | None:
    """Format a change, %, with its sign; None stays None."""
    return None if change is None else f"{number(change, '+.2f')} %"


@line_of.register
def sensitivity_in_a_line(result: SensitivityResult) -> str:
    """Return the input on which the first answer, the ballistic limit if there is one, depends most."""
    answer, value = next((pair for pair in result.answers.items() if pair[1] is not None), ("", None))
    inputs = [item for item in result.inputs if item.elasticities.get(answer)]
    if not inputs:
        return "no answer depends on any input"
    most = max(inputs, key=lambda item: abs(item.elasticities[answer] or 0.0))
    return f"the {_name_of(answer)} by the model, {value:.0f} m/s, depends most on the {Column.of(most.input).label}"


@tables_of.register
def tables_of_sensitivity(result: SensitivityResult) -> list[Table | str]:
    """Return the inputs on which the first answer depends most; with `every_row`, all inputs and answers."""
    answers = [name for name, value in result.answers.items() if value is not None]
    line = VerdictLine(in_a_line(result))
    if result.question.get("every_row"):
        values = {
            Column.of(name).label: "none" if value is None else f"{value:.0f} m/s by the model"
            for name, value in result.answers.items()
        }
        return [line, Table.of_facts(values), elasticity_table(result, answers)]
    table, rest = elasticity_table(result, answers[:1], MOST_INPUTS), result.inputs[MOST_INPUTS:]
    changes = [abs(item.elasticities[answers[0]] or 0.0) for item in rest if item.elasticities[answers[0]] is not None]
    return [line, table, *([f"{len(changes)} more, each at most {max(changes):.2f} %"] if changes else [])]


@line_of.register
def calibration_in_a_line(result: CalibrationResult) -> str:
    """Return the fitted inputs with their intervals, or why one is not identified, in a line."""
    return "; ".join(_coefficient_words(each, result.confidence) for each in result.coefficients)


def _coefficient_words(coefficient: Coefficient, level: float) -> str:
    """Return a fitted input with its interval, or why it is not identified."""
    column, ends = Column.of(coefficient.name, ".4g"), coefficient.interval
    if coefficient.estimate is None:
        return f"{column.label} not identified: {coefficient.reason}"
    words = "; ".join([*([between(level, ends, ".4g")] if ends else []), *filter(None, [coefficient.reason])])
    return f"{column.label} {column.with_unit(coefficient.estimate)} ({words})"


def calibration_table(result: CalibrationResult) -> Table:
    """Tabulate how a fit was made and, if the tests have uncertainties, its chi-squared test."""
    weighted = result.weights == "uncertainties"
    return Table.of_one(
        result,
        (Column("deviations relative to"), "uncertainties of the tests" if weighted else "measured values"),
        Column.of("law", label="law of the ceramic's flow stress"),
        Column.of("degrees_of_freedom", ".4g"),
        (Column("chi-squared", spec=".2f"), result.chi_squared if weighted else None),
        (Column("p value", spec=".2g"), result.p_value if weighted else None),
        (Column("intervals widened by", spec=".2f"), result.widened_by if result.widened_by > 1.0 else None),
        (Column("starting points that reach this solution"), f"{result.starts_agreeing} of {result.starts}"),
    )


def correlation_table(result: CalibrationResult) -> Table:
    """Tabulate the correlations of the coefficients, whose numbers head the columns."""
    names = [f"{number} {in_words(c.name)}" for number, c in enumerate(result.coefficients, start=1)]
    numbers = (Column(name.partition(" ")[0], spec="+.3f") for name in names)
    rows: list[tuple[Cell, ...]] = [(name, *values) for name, values in zip(names, result.correlation, strict=True)]
    return Table((Column("correlation", prose=True), *numbers), tuple(rows))


def _deviation_percent(residual: Residual, value: float | None) -> float | None:
    """Return the deviation of a value from the one measured, %; None for a bound, or without a value."""
    return None if residual.bound or value is None else 100.0 * (value / residual.measured - 1.0)


def residual_table(result: CalibrationResult) -> Table:
    """Tabulate measured and computed values, test by test; shots give a bound and have no deviation."""
    return Table.of(
        result.residuals,
        Column.of("test", prose=True),
        (Column("quantity", prose=True), lambda r: in_words(r.quantity)),
        Column.of("bound"),
        Column.of("measured", "g"),
        Column.of("computed", ".4g"),
        (Column("deviation", "%", "+.1f"), lambda r: _deviation_percent(r, r.computed)),
        (Column("leave-one-out deviation", "%", "+.1f"), lambda r: _deviation_percent(r, r.left_out)),
        (Column("bound met"), lambda r: "" if not r.bound else "yes" if r.met else "no"),
    )


@tables_of.register
def tables_of_calibration(result: CalibrationResult) -> list[Table | str]:
    """Return the fitted inputs, the tests, and those that deviate most; with `every_row`, all details of the fit."""
    facts = {"tests": _tests_words(result), "farthest": _farthest(result)}
    before, now = result.question.get("before"), result.question.get("now")
    if before is not None and now is not None:
        at = f" at {result.question['scenario'].impact.velocity_m_s:g} m/s"
        facts["armour"] = f"was {_limit_words(before, at)}; now {_limit_words(now)}"
    shown: list[Table | str] = [VerdictLine(in_a_line(result)), Table.of_facts(facts)]
    if result.question.get("every_row"):
        shown.append(calibration_table(result))
        shown += [correlation_table(result)] if len(result.coefficients) > 1 else []
        shown.append(residual_table(result))
    return shown


def _tests_words(result: CalibrationResult) -> str:
    """Return the number of tests with the errors of the fit or, if there are only a few, what each measured."""
    tests = list(dict.fromkeys(residual.test for residual in result.residuals))
    if len(tests) <= MOST_TESTS:
        measured = ((r, f"{r.bound} {r.measured:g}".strip()) for r in result.residuals)
        words = [f"{r.test} {value} {Column.of(r.quantity).unit}" for r, value in measured]
        return f"{len(tests)}: {', '.join(words)}"
    words = [str(len(tests))]
    if result.mean_error_percent is not None:
        words.append(f"mean error {result.mean_error_percent:.1f} %")
    if result.left_out_error_percent is not None:
        words.append(f"each predicted from the others {result.left_out_error_percent:.1f} %")
    if missed := sum(not residual.met for residual in result.residuals):
        words.append(f"{counted(missed, 'outcome')} contradict{'s' * (missed == 1)} the fit")
    return ", ".join(words)


def _farthest(result: CalibrationResult) -> str:
    """Return the tests that deviate most from the fit, with these errors; "" if there are only a few tests."""
    errors = [(r.test, _deviation_percent(r, r.computed) or 0.0) for r in result.residuals if not r.bound]
    errors.sort(key=lambda pair: -abs(pair[1]))
    return ", ".join(f"{test} {part:+.1f} %" for test, part in errors[:MOST_TESTS]) if len(errors) > MOST_TESTS else ""


def _limit_words(found: ConfidenceResult, at: str = "") -> str:
    """Return an armour's limit and its probability of stopping a shot; `at` is the velocity, as " at 800 m/s"."""
    if found.expected_limit_m_s is not None:
        return f"{found.expected_limit_m_s:.0f} m/s expected, {chance(found.probability_of_stopping)}{at}"
    return "no limit" if found.ballistic_limit_m_s is None else f"{found.ballistic_limit_m_s:.0f} m/s by the model"


def recommended_table(fit: FittedCurve, level: float) -> Table:
    """Tabulate V50, V05, V95 and scatter of the recommended curve, with intervals and bounds at a confidence level."""
    rows = (
        ("V50", fit.v50_m_s, interval(fit.v50_interval_m_s, ".0f"), fit.v50_lower_m_s or "not bounded"),
        ("V05", fit.v05_m_s, interval(fit.v05_interval_m_s, ".0f"), fit.v05_lower_m_s or "not bounded"),
        ("V95", fit.v95_m_s, interval(fit.v95_interval_m_s, ".0f"), None),
        ("scatter", fit.scale_m_s, interval(fit.scale_interval_m_s, ".0f"), None),
    )
    lower = Column(f"one-sided {percent(level)} lower bound", "m/s", ".0f")
    columns = Column("quantity"), Column("estimate", "m/s", ".0f"), Column(f"{percent(level)} interval", "m/s"), lower
    return Table.of_rows(columns, rows, f"recommended: {fit.curve}, {fit.method}")


PENALISED = "intervals by penalised likelihood; with few shots those of maximum likelihood are too narrow"


# Words by the rule for the span of the shots that a mean averages.
MEANS = {"usual span": "MIL-STD-662F", "given span": "span as given", "no usual rule": "no usual rule"}
FIXED = (
    "the risks are approximate: where the scatter far exceeds the steps between shots, 5 % may be 13 %; they hold only "
    "if the number of shots was fixed beforehand; armour plan shots --requirement-m-s may decide after any shot, with "
    "bounded risks, but needs more shots"
)


def _further_shot(result: FiringResult) -> str:
    """Return the one further shot that would bound V50 best, in words; "" if the result has none."""
    if (further := result.further) is None:
        return ""
    shot = f"a shot {'perforating' if further.complete else 'stopped'} at {further.velocity_m_s:.0f} m/s"
    if further.confidence is None or further.interval_m_s is None:
        return f"no single shot bounds V50; {shot} comes nearest"
    lower = "" if further.confidence == result.confidence else f"{percent(further.confidence)} "
    return f"{shot} would bound V50: {lower}{interval(further.interval_m_s, '.0f')} m/s"


def points(result: FiringResult) -> dict[str, str]:
    """Return the points of the recommended curve that were asked for, with their intervals, by label."""
    points, level = {}, percent(result.confidence)
    if (at := result.at) is not None:
        high, low = (chance(1.0 - end) for end in at.interval)
        words = f"stops a shot with {chance(1.0 - at.probability)} ({level} between {low} and {high})"
        points[f"at {at.velocity_m_s:g} m/s"] = words
    if (point := result.velocity_of) is not None:
        value = "no positive estimate" if point.velocity_m_s is None else f"{point.velocity_m_s:.0f} m/s"
        value += f" ({between(result.confidence, point.interval_m_s, '.0f')})"
        points[velocity_name(point.fraction)] = value + _at_least(point.lower_m_s, level)
    return points


def _at_least(lower_m_s: float | None, level: str) -> str:
    """Return a one-sided lower bound of a velocity in words; "" if there is none."""
    return "" if lower_m_s is None else f", at least {lower_m_s:.0f} m/s with {level}"


def velocity_name(fraction: float) -> str:
    """Return the name of the velocity at which a fraction perforates, such as "V05" for 0.05."""
    number = f"{100.0 * fraction:.3g}"
    return f"V{number.zfill(2)}"


def decision(result: FiringResult) -> str:
    """Return whether a required velocity is met, with the risk of the decision."""
    velocity = f"{velocity_name(result.requirement_fraction)} of at least {result.requirement_m_s:g} m/s"
    if result.consumers_risk is None or result.producers_risk is None:
        return f"{result.decision}: {velocity}; no curve fits the shots"
    deciding, risk = "accepting", result.consumers_risk
    if result.decision == "not met":
        deciding, risk = "rejecting", result.producers_risk
    now, allowed = " now" * (result.decision == "not decided"), percent(round(1.0 - result.confidence, 12))
    return f"{result.decision}: {velocity}; risk of {deciding}{now} {rounded_risk(risk)} ({allowed} decides)"


def rounded_risk(risk: float) -> str:
    """Format a risk in per cent, rounded up to a tenth."""
    return "below 0.1 %" if risk < 1e-3 else f"{rounded_up(100.0 * risk)} %"


@line_of.register
def firing_in_a_line(result: FiringResult) -> str:
    """Return the decision on a required velocity or, without one, V50 with its interval."""
    return decision(result) if result.decision else _v50_words(result)


def _v50_words(result: FiringResult) -> str:
    """Return V50 by the recommended curve, with its interval and, without a requirement, its lower bound."""
    level, ends, fit = result.bounded_confidence, result.bounded_interval_m_s, result.recommended
    if fit is None:
        return f"V50 not known: no curve {'rises with the velocity' if result.fits else 'fits the shots alone'}"
    if result.extrapolated:
        return "V50 not bounded by these shots"
    is_open = f"{percent(result.confidence)} is not bounded"
    if level is None or ends is None:
        return f"V50 {fit.v50_m_s:.0f} m/s ({is_open})"
    if level < result.confidence:
        return f"V50 {fit.v50_m_s:.0f} m/s ({between(level, ends, '.0f')}; {is_open})"
    lower = "" if result.decision else _at_least(fit.v50_lower_m_s, percent(level))
    return f"V50 {fit.v50_m_s:.0f} m/s ({between(level, ends, '.0f')}){lower}"


@tables_of.register
def tables_of_firing(result: FiringResult) -> list[Table | str]:
    """Return whether a requirement is met, V50, and what it rests on; with `every_row`, also V05, V95 and intervals."""
    good = result.decision == "met" if result.decision else None
    details = estimates(result) if result.question.get("every_row") else []
    return [VerdictLine(in_a_line(result), good=good), *facts_of_firing(result), *details]


def facts_of_firing(result: FiringResult) -> list[Table | str]:
    """Return what V50 rests on, below V50 itself if the line of the result has a decision in its place."""
    v50 = [VerdictLine(_v50_words(result))] if result.decision else []
    return [*v50, Table.of_facts(_facts_of(result))]


def estimates(result: FiringResult) -> list[Table | str]:
    """Return how V50 is estimated: the risks of deciding now, the recommended curve, prior and posterior."""
    limit = result.model_ballistic_limit_m_s
    shown: list[Table | str] = [] if limit is None else [f"ballistic limit {limit:.0f} m/s by the model"]
    if result.consumers_risk is not None and result.producers_risk is not None:
        risks = f"{rounded_risk(result.consumers_risk)}, of rejecting it {rounded_risk(result.producers_risk)}"
        shown.append(f"risk of accepting the armour now {risks}; {FIXED}")
    if result.recommended is not None:
        shown += [recommended_table(result.recommended, result.confidence), PENALISED]
    if result.prior is not None and result.posterior is not None:
        shown += [prior_table(result.prior, result.posterior, result.confidence), SCATTER_ASSUMED]
    return shown


def _facts_of(result: FiringResult) -> dict[str, str]:
    """Return what V50 rests on, by label."""
    mean, fit, posterior, facts = result.mean, result.recommended, result.posterior, dict[str, str]()
    spans = ((m.pairs, round(m.span_m_s, 1), round(m.span_allowed_m_s, 1)) for m in result.means)
    means = [f"{pairs} + {pairs} shots within {span:g} m/s, {allowed:g} allowed" for pairs, span, allowed in spans]
    facts["mean"] = f"none: {'; '.join(means) or 'too few shots of each kind'}"
    if mean is not None:
        facts["mean"] = f"{mean.v50_m_s:.0f} m/s of {means[-1]} ({MEANS[mean.rule]})"
    highest, lowest = result.highest_partial_m_s, result.lowest_complete_m_s
    ends = [] if highest is None else [f"highest stopped {highest:.0f} m/s"]
    ends += [] if lowest is None else [f"lowest perforated {lowest:.0f} m/s"]
    facts["shots"] = f"{result.shots}, {result.complete} perforated; {', '.join(ends)}"
    if fit is not None and not result.decision:
        slow = "at no positive velocity" if fit.v05_m_s is None else f"at {fit.v05_m_s:.0f}"
        scatter = between(result.confidence, fit.scale_interval_m_s, ".0f")
        facts["scatter"] = f"{fit.scale_m_s:.0f} m/s ({scatter}); 5 % perforate {slow}, 95 % at {fit.v95_m_s:.0f} m/s"
    facts |= {"more": _further_shot(result), **points(result)}
    if (limit := result.model_ballistic_limit_m_s) is not None:
        facts["expected"] = f"{limit:.0f} m/s by the model"
        if result.expected_limit_m_s is not None and result.model_interval_m_s is not None:
            ends_of_model = between(0.95, result.model_interval_m_s, ".0f")
            facts["expected"] = f"{result.expected_limit_m_s:.0f} m/s before these shots ({ends_of_model})"
    if posterior is not None:
        ends_of_v50 = between(result.confidence, posterior.v50_interval_m_s, ".0f")
        facts["together"] = f"{posterior.v50_m_s:.0f} m/s ({ends_of_v50}), with the expected limit as prior"
    return facts


ONE_SCATTER = (
    "the difference supposes that the lots have the same scatter; with several pairs, the confidence is that of all "
    "intervals together, and each p is multiplied by the number of pairs"
)


@line_of.register
def lots_in_a_line(result: LotResults) -> str:
    """Return whether the lots differ or, if they are not compared, their names."""
    return "; ".join(difference_words(result)) or ", ".join((*result.results, *result.unanswered))


def difference_words(result: LotResults, name: str = "") -> list[str]:
    """Return a line for each two lots that are compared, or for those with lot `name`: whether they differ."""
    asked = {lots: each for lots, each in result.differences.items() if not name or name in lots}
    return [
        _difference_words(" minus ".join(lots), difference, len(result.differences))
        for lots, difference in asked.items()
    ]


def _difference_words(lots: str, found: V50Difference, comparisons: int) -> str:
    """Return whether two lots, as "lot A minus lot B", differ, with the interval of the difference.

    The confidence of `found` is that of its interval alone: all `comparisons` hold together with a lower one, which the
    line states.  Its p value is already multiplied by their number.
    """
    together = 1.0 - (1.0 - found.confidence) * comparisons
    ends = interval(found.interval_m_s, ".0f")
    p_value = "< 0.001" if found.p_value < 1e-3 else f"= {found.p_value:.2g}"
    says = "V50 differs" if found.p_value < 1.0 - together else "V50 not found to differ"
    return f"{says}: {lots} {found.difference_m_s:+.0f} m/s, {percent(round(together, 9))} interval {ends}, p {p_value}"


@tables_of.register
def tables_of_lots(result: LotResults) -> list[Table | str]:
    """Return whether the lots differ, and the line or the tables of each."""
    shown: list[Table | str] = [*difference_words(result)]
    shown += [ONE_SCATTER] if shown else []
    return [*shown, *tables_of_each(result)]


def prior_table(prior: FiringEstimate, posterior: FiringEstimate, level: float) -> Table:
    """Tabulate V50 and the scatter before and after the shots, with intervals at a confidence level."""
    v50, scatter = (Column(f"{name}, {percent(level)} interval", "m/s") for name in ("V50", "scatter"))

    def estimate(value: float, ends: tuple[float, float]) -> str:
        return f"{number(value, '.0f')} ({interval(ends, '.0f')})"

    return Table.of(
        (("prior", prior), ("posterior", posterior)),
        (Column("distribution"), lambda row: row[0]),
        (v50, lambda row: estimate(row[1].v50_m_s, row[1].v50_interval_m_s)),
        (Column("standard deviation of V50", "m/s", ".0f"), lambda row: row[1].standard_deviation_m_s),
        (scatter, lambda row: estimate(row[1].scatter_m_s, row[1].scatter_interval_m_s)),
    )


def shot_table(shots: Shots, averaged: Collection[int] = (), heading: str = "") -> Table:
    """Tabulate shots in the order fired; those whose indices are in `averaged` are marked in a column `heading`."""
    decimals = max(len(f"{velocity:.3f}".rstrip("0").partition(".")[2]) for velocity in shots.velocities_m_s)
    return Table.of(
        range(len(shots.complete)),
        (Column("shot"), lambda i: (shots.names[i] if shots.names else "") or str(i + 1)),
        (Column("velocity", "m/s", f".{max(decimals, 1)}f"), lambda i: shots.velocities_m_s[i]),
        (Column("result"), lambda i: "perforated" if shots.complete[i] else "stopped"),
        (Column(heading), lambda i: "yes" if i in averaged else ""),
    )
