"""Tables of plans of shots and of tests."""

import re
from dataclasses import replace
from itertools import zip_longest
from operator import attrgetter, itemgetter

from armour.errors import counted
from armour.planning.firing import ShotPlan
from armour.planning.plan_tests import PlannedTests
from armour.reporting.by_result import line_of, tables_of
from armour.reporting.table import Cell, Column, Table, interval, of_part, percent
from armour.reporting.views.statistics import SCATTER_ASSUMED, prior_table, second_note, share_note
from armour.reporting.words import chance, model_error_words, rounded_down
from armour.scenario.inputs import INPUTS, VELOCITY
from armour.statistics.measured import LIMIT, MEASURED, OUTCOME, Tests

DECISION = (
    "the shots alone decide, as soon as a likelihood ratio is large enough; the model's limit and its error play no "
    "part; armour v50 decides on shots whose number was fixed beforehand, with approximate risks"
)
ONE_SIDE = (
    "all shots lie on one side of the required velocity, which says little as long as the scatter may be large; the "
    "next velocity is chosen to say more"
)
REPORT = "the posterior includes the model's prediction; report V50 from armour v50, which uses the shots alone"


@line_of.register
def plan_in_a_line(plan: ShotPlan) -> str:
    """Return the next velocity, and V50 from the shots so far."""
    following = "firing ended" if plan.next_velocity_m_s is None else f"next shot at {plan.next_velocity_m_s:.1f} m/s"
    basis = f"after {counted(len(plan.fired.complete), 'shot')}" if plan.fired.complete else "by the prior"
    ends = interval(plan.posterior.v50_interval_m_s, ".0f")
    v50 = f"V50 {plan.posterior.v50_m_s:.0f} m/s, {percent(plan.confidence)} interval {ends} m/s"
    return f"{following}; {basis} {v50}"


@tables_of.register
def tables_of_shot_plan(plan: ShotPlan) -> list[Table | str]:
    """Return all tables of a plan of shots, with notes on them."""
    shown: list[Table | str] = [_plan_table(plan), *second_note(plan.recommended)]
    if plan.stopped and not plan.fired.complete:
        shown.append("by the prior alone: no shot was fired")
    if plan.reason:
        shown.append(f"reason: {plan.reason}")
    if plan.consumers_risk is not None:
        shown.append(DECISION)
        shots = plan.fired.velocities_m_s
        if shots and not plan.stopped and not min(shots) <= (plan.requirement_m_s or 0.0) <= max(shots):
            shown.append(ONE_SIDE)
    if plan.operating_characteristic:
        shown.append(operating_table(plan))
    origin = f"prior of V50: {plan.expected_from}, with a probability of 95 %"
    if plan.model_error is not None:
        origin = model_error_words(plan.model_error)
    shown += [prior_table(plan.prior, plan.posterior, plan.confidence), origin]
    shown.append(scatter_note(plan) if plan.earlier else SCATTER_ASSUMED)
    if plan.fired.complete and not plan.contradicts_prior:
        shown.append(share_note(plan.prior_share))
        if len(set(plan.fired.complete)) == 2 and plan.model_error is not None:
            shown.append(REPORT)
    if plan.fired.complete:
        shown.append(_shot_table(plan))
    return shown


def _plan_table(plan: ShotPlan) -> Table:
    """Tabulate the next shot, when the firing ends, and the estimates from the shots so far."""
    fit, mean, fraction = plan.recommended, plan.mean, plan.requirement_fraction
    ends = None if fit is None else fit.v50_interval_m_s
    required = "V50" if fraction == 0.5 else f"velocity at which {percent(fraction)} perforate"
    by_posterior = ", by the posterior" if plan.consumers_risk is not None else ""
    expected, met = "", "" if plan.probability_met is None else chance(plan.probability_met)
    if plan.next_velocity_m_s is not None and plan.procedure == "bayesian":
        expected = _number_of_shots(plan.expected_shots)
        if plan.expected_shots_90 is not None:
            expected += f"; {plan.expected_shots_90:.0f} with --confidence 0.9"
    return Table.of_one(
        plan,
        Column.of("next_velocity_m_s", ".1f"),
        (Column("firing ended"), plan.stopped),
        Column.of("procedure"),
        (Column("shots so far", spec="d"), len(plan.fired.complete)),
        (Column("simulated", spec="d"), plan.simulated or None),
        (Column("further shots expected"), expected),
        (Column("V50 by the mean of MIL-STD-662F", "m/s", ".0f"), None if mean is None else mean.v50_m_s),
        (Column("V50 by the recommended curve", "m/s", ".0f"), None if fit is None else fit.v50_m_s),
        (Column(f"its {percent(plan.confidence)} interval", "m/s"), interval(ends, ".0f")),
        Column.of("half_width_m_s", "g", "half width at which the firing ends"),
        (Column("limits of V50", "m/s"), interval(plan.limits_m_s, ".0f")),
        Column.of("requirement_m_s", "g", f"required of the {required}"),
        (Column("consumer's risk, of accepting what fails it"), _risk(plan.consumers_risk)),
        (Column("producer's risk, of rejecting what meets it"), _risk(plan.producers_risk)),
        (Column("likelihood ratio for it"), _ratio(plan.evidence_met, plan.consumers_risk)),
        (Column("likelihood ratio against it"), _ratio(plan.evidence_not_met, plan.producers_risk)),
        (Column(f"probability that it is met{by_posterior}"), met),
        Column.of("true_v50_m_s", "g", "V50 simulated"),
        Column.of("true_scatter_m_s", "g", "scatter simulated"),
    )


def scatter_note(plan: ShotPlan) -> str:
    """Return a note on the prior of the scatter, which combines earlier firings with the expected scatter."""
    firings = "an earlier firing" if plan.earlier == 1 else f"{plan.earlier} earlier firings"
    scatter = f"{plan.scatter_percent:.2g} % of V50 within a factor of {plan.scatter_factor:.2g}"
    return f"the prior for the scatter, {scatter}, combines {firings} and the scatter that was expected"


def _risk(risk: float | None) -> str:
    """Format the greatest accepted risk; None gives an empty text."""
    return "" if risk is None else f"at most {percent(risk)}"


def _ratio(ratio: float | None, risk: float | None) -> str:
    """Format a likelihood ratio and the ratio that decides, 1 over the accepted risk, such as "3.2 of 20"."""
    if ratio is None or risk is None:
        return ""
    reached = f"{rounded_down(min(ratio, 9999.0), 1):g}" if ratio >= 1.0 else f"{ratio:.2g}"
    return f"{reached} of {1.0 / risk:.3g}"


def _number_of_shots(median: float | None) -> str:
    """Format a median number of shots; None means that it exceeds 100, where simulations end."""
    return "more than 100" if median is None else f"{median:.0f}"


def operating_table(plan: ShotPlan) -> Table:
    """Tabulate the decisions and numbers of shots of simulated firings, for true V50 around the required velocity."""
    scatter = plan.operating_characteristic[0].scatter_m_s
    return Table.of(
        plan.operating_characteristic,
        Column.of("v50_m_s", ".0f", "V50"),
        (Column("met"), lambda point: percent(point.met)),
        (Column("not met"), lambda point: percent(point.not_met)),
        (Column("median of shots"), lambda point: _number_of_shots(point.shots)),
        title=f"operating characteristic: simulated firings at a scatter of {scatter:.0f} m/s",
    )


def _shot_table(plan: ShotPlan) -> Table:
    """Tabulate the shots in the order fired."""
    fired = plan.fired
    kinds = ["complete" if complete else "partial" for complete in fired.complete]
    rows = zip_longest(fired.names, fired.velocities_m_s, kinds, fillvalue="")
    shots = tuple((name or str(number), *shot) for number, (name, *shot) in enumerate(rows, start=1))
    decimals = max(len(f"{velocity:.3f}".rstrip("0").partition(".")[2]) for velocity in fired.velocities_m_s)
    columns = Column("shot"), Column("velocity", "m/s", f".{max(decimals, 1)}f"), Column("penetration")
    return Table(columns, shots)


CRITERION_WORDS = {
    "D": "D, the smallest confidence region of the fitted inputs",
    "I": "I, the least mean variance of the limits of the designs",
}


PRIOR_SOURCES = {
    "given": "given",
    "uncertainties": "from the uncertainties of the tests made before",
    "residuals": "estimated from the residuals of the tests made before",
}


PLANNED = re.compile(r"planned (\d{1,15})")


NOTE = (
    "±: expected half-width of the interval after this test and all before it; for limits by the model, without the "
    "model error"
)


SLOPE_NOTE = "slope: relative change of the flow stress per projectile diameter of layer thickness"


def plan_table(result: PlannedTests) -> Table:
    """Tabulate the settings of a plan of tests: criterion, candidates, scatter, inputs to fit, and its efficiency."""
    measured = relative_to = "ballistic limit"
    if result.measure == "outcome":
        measured, relative_to = "outcome of one shot, stopped or perforated", "impact velocity"
    efficient = f"none: {'the candidates do not determine the inputs' if result.not_identified else 'too few tests'}"
    if result.efficiency is not None:
        efficient = f"at least {percent(int(1000.0 * result.efficiency) / 1000.0)}"
    scatter = f"{result.scatter_percent:.3g} % of the {relative_to}, {PRIOR_SOURCES[result.scatter_source]}"
    return Table.of_one(
        result,
        (Column("criterion"), CRITERION_WORDS[result.criterion]),
        (Column("candidates", spec="d"), len(next(iter(result.candidates.values())))),
        (Column("measured"), measured),
        (Column("scatter of a test"), scatter),
        (Column("tests made before"), result.tests),
        (Column("law of the ceramic's flow stress"), result.law),
        *((Column.of(name, ".4g"), value) for name, value in result.values.items()),
        (Column("efficiency"), efficient),
    )


def step_table(result: PlannedTests) -> Table:
    """Tabulate the planned tests in order, with the half-widths of the intervals expected after each."""
    before = result.planned[0]
    is_nothing_known = {*before.half_widths.values(), *before.limit_half_widths_m_s} == {None}
    steps = result.planned[1:] if is_nothing_known else result.planned
    keys = list(result.candidates)
    varied = [key for key in keys if len(set(result.candidates[key])) > 1] or keys
    names = result.designs if len(result.designs) > 1 else ["the design"] * len(result.designs)
    inputs = ((Column.of(key, "g" if key in INPUTS else ""), itemgetter(key)) for key in varied)
    widths = (replace(Column.of(name, ".3g"), label=f"± {Column.of(name).label}") for name in result.values)
    limits = ((Column(f"± limit of {name}", "m/s", ".0f"), itemgetter(index)) for index, name in enumerate(names))
    return Table.of(
        steps,
        (Column("test"), lambda step: str(step.number or "before")),
        *of_part(lambda step: step.inputs if step.number else None, *inputs),
        Column.of("ballistic_limit_m_s", ".0f", "limit by the model"),
        Column.of("total_cost", ".6g"),
        *of_part(attrgetter("half_widths"), *((column, itemgetter(column.key)) for column in widths)),
        *of_part(attrgetter("limit_half_widths_m_s"), *limits),
    )


@tables_of.register
def tables_of_planned_tests(result: PlannedTests) -> list[Table | str]:
    """Return all tables of planned tests."""
    slopes = [SLOPE_NOTE] if any(name.endswith("_slope") for name in result.values) else []
    return [step_table(result), NOTE, *slopes, plan_table(result)]


def form_table(result: PlannedTests) -> Table:
    """Return a form: a table of the planned tests for `armour calibrate`, with the measured values left blank.

    The uncertainty of a planned test is filled in if it is known.  Tests made before come first, with their values.
    The numbering of planned tests continues from theirs.
    """
    tests: Tests | None = result.question.get("tests")
    has_scatter = tests.weighted if tests is not None else result.scatter_known
    uncertainty_key = MEASURED[LIMIT]
    measured_key = LIMIT if result.measure == "limit" else OUTCOME
    earlier = {} if tests is None else dict(zip(tests.names, tests.cells, strict=True))
    rows: list[dict[str, Cell]] = [{**cells, "test": name} for name, cells in earlier.items()]
    last = max((int(match[1]) for match in map(PLANNED.fullmatch, earlier) if match), default=0)
    for step in result.planned[1:]:  # the first is the state before all tests
        row: dict[str, Cell] = {"test": f"planned {last + step.number}", **step.inputs}
        expected_m_s = step.ballistic_limit_m_s if result.measure == "limit" else step.inputs[VELOCITY]
        if has_scatter and expected_m_s is not None:
            row[uncertainty_key] = float(f"{result.scatter_percent / 100.0 * float(expected_m_s):.3g}")
        rows.append(row)
    keys = dict.fromkeys(["test", *(key for row in rows for key in row if key not in (measured_key, uncertainty_key))])
    columns = [*keys, measured_key, *([uncertainty_key] if has_scatter else [])]
    headings = tuple(Column(Column.of(key).label, key=key) for key in columns)
    return Table(headings, tuple(tuple(row.get(key) for key in columns) for row in rows))
