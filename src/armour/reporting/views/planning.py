"""Tables of plans of shots."""

from itertools import zip_longest

from armour.errors import counted
from armour.planning.firing import ShotPlan
from armour.reporting.by_result import line_of, tables_of
from armour.reporting.table import Column, Table, interval, percent
from armour.reporting.views.statistics import SCATTER_ASSUMED, prior_table, second_note, share_note
from armour.reporting.words import chance, model_error_words, rounded_down

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
