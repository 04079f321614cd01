"""Answers on plans of shots."""

from armour.planning.firing import ShotPlan
from armour.reporting.by_result import in_a_line, line_of, tables_of
from armour.reporting.table import Column, Table, VerdictLine, between, percent
from armour.reporting.views.statistics import SCATTER_ASSUMED, prior_table, shot_table, velocity_name
from armour.reporting.words import chance, model_error_words, rounded_down

DECISION = (
    "the shots alone decide, as soon as a likelihood ratio is large enough; the model's limit and its error play no "
    "part; armour v50 decides on shots whose number was fixed beforehand, with approximate risks"
)


@line_of.register
def plan_in_a_line(plan: ShotPlan) -> str:
    """Return the next velocity, or why the firing has ended."""
    if plan.next_velocity_m_s is not None:
        return f"fire at {plan.next_velocity_m_s:.1f} m/s"
    return f"firing ended: {plan.stopped}{'' if plan.fired.complete else ', by the limit expected alone'}"


@tables_of.register
def tables_of_shot_plan(plan: ShotPlan) -> list[Table | str]:
    """Return the next velocity, the shots and V50 so far.

    If the plan's question has `every_row` (option -v), also why this velocity is next, what the plan starts from and
    each shot.
    """
    good = plan.decision == "met" if plan.stopped and plan.decision else None
    shown: list[Table | str] = [VerdictLine(in_a_line(plan), good=good), Table.of_facts(_facts_of(plan))]
    return [*shown, *_details(plan)] if plan.question.get("every_row") else shown


def _facts_of(plan: ShotPlan) -> dict[str, str]:
    """Return the shots so far, V50 and the requirement, by label."""
    found, count = plan.posterior, len(plan.fired.complete)
    shots = f"{count} so far"
    if plan.next_velocity_m_s is not None and plan.procedure == "bayesian":
        shots += f", {'about ' * (plan.expected_shots is not None)}{_number_of_shots(plan.expected_shots)} to go"
        shots += "" if plan.half_width_m_s is None else f" until V50 is known to ± {plan.half_width_m_s:g} m/s"
    shots += "" if plan.consumers_risk is None else f"; both risks at most {percent(plan.consumers_risk)}"
    v50 = f"{found.v50_m_s:.0f} m/s expected ({between(plan.confidence, found.v50_interval_m_s, '.0f')})"
    v50 += f"; scatter {found.scatter_m_s:.0f} m/s" + " assumed" * (not count)
    facts = {"shots": shots, "V50": v50}
    if plan.model_error is None:
        facts["from"] = f"V50 {plan.expected_from}"
    if (fit := plan.recommended) is not None:
        ends = between(plan.confidence, fit.v50_interval_m_s, ".0f")
        facts["by the shots"] = f"{fit.v50_m_s:.0f} m/s ({ends})"
    if plan.mean is not None:
        facts["mean"] = f"{plan.mean.v50_m_s:.0f} m/s (MIL-STD-662F)"
    if plan.requirement_m_s is not None and plan.probability_met is not None:
        required = f"{velocity_name(plan.requirement_fraction)} of at least {plan.requirement_m_s:g} m/s"
        required += f": met with {chance(plan.probability_met)}"
        facts["required"] = required + " before any shot" * (not count)
    if count and plan.consumers_risk is not None:
        ratios = [_ratio(each, plan.consumers_risk) for each in (plan.evidence_met, plan.evidence_not_met)]
        facts["evidence"] = f"for it {ratios[0]}, against it {ratios[1]}"
    return facts


def _details(plan: ShotPlan) -> list[Table | str]:
    """Return what -v adds to a plan: why the next velocity is chosen, what the plan starts from, and the shots."""
    shown: list[Table | str] = [f"reason: {plan.reason}"] if plan.reason else []
    shown += [] if plan.consumers_risk is None else [DECISION]
    shown += [operating_table(plan)] if plan.operating_characteristic else []
    shown += [prior_table(plan.prior, plan.posterior, plan.confidence)] if plan.fired.complete else []
    shown += [] if plan.model_error is None else [model_error_words(plan.model_error)]
    return [*shown, SCATTER_ASSUMED, *([shot_table(plan.fired)] if plan.fired.complete else [])]


def _ratio(ratio: float | None, risk: float) -> str:
    """Format a likelihood ratio and the ratio that decides, 1 over the accepted risk, such as "3.2 of 20"."""
    if ratio is None:
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
