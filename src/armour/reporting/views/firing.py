"""V50 from firing results."""

from armour.reporting.table import Cell, Column, Source, Table, column_of, listing, record
from armour.reporting.text import Verdict, interval, percent, with_interval
from armour.reporting.views.shot_plan import SCATTER_ASSUMED, prior_table, share_note
from armour.reporting.words import rounded_up
from armour.statistics.curves import FittedCurve
from armour.statistics.v50 import FiringResult


def v50_table(result: FiringResult) -> Table:
    """Return the extreme velocities of the shots, and the mean of MIL-STD-662F."""
    mean = result.mean
    rule: list[Source] = [(Column("V50, mean"), "none: too few shots of each kind within the span allowed")]
    if mean is not None:
        standard = mean.rule != "no usual rule"
        rule = [
            (Column("V50, MIL-STD-662F" if standard else "V50, mean", "m/s", ".0f"), mean.v50_m_s),
            (Column("shots averaged"), f"{mean.pairs} partial and {mean.pairs} complete"),
            (Column("span of these shots", "m/s", ".0f"), mean.span_m_s),
            (Column("span allowed", "m/s", ".0f"), mean.span_allowed_m_s),
        ]
    return record(
        result,
        column_of("shots", "d"),
        column_of("complete", "d", "complete penetrations"),
        column_of("highest_partial_m_s", ".0f"),
        column_of("lowest_complete_m_s", ".0f"),
        column_of("zone_of_mixed_results_m_s", ".0f"),
        *rule,
        column_of("model_ballistic_limit_m_s", ".0f", "ballistic limit by the model"),
        (Column("its 95 % interval, with the model error", "m/s"), interval(result.model_interval_m_s, ".0f")),
    )


def recommended_table(fit: FittedCurve, level: float) -> Table:
    """Return the velocities and the scatter of the recommended curve, with their intervals."""
    keys = {"V50": "v50", "V05": "v05", "V95": "v95", "scatter": "scale"}

    def ends(name: str) -> str:
        return interval(getattr(fit, f"{keys[name]}_interval_m_s"), ".0f")

    def lower(name: str) -> Cell:
        bound = getattr(fit, f"{keys[name]}_lower_m_s", None)
        return "not bounded" if bound is None and name in ("V50", "V05") else bound

    return listing(
        keys,
        (Column("quantity"), str),
        (Column("estimate", "m/s", ".0f"), lambda name: getattr(fit, f"{keys[name]}_m_s")),
        (Column(f"{percent(level)} interval", "m/s"), ends),
        (Column(f"one-sided {percent(level)} lower bound", "m/s", ".0f"), lower),
        title=f"recommended: {fit.curve}, {fit.method}",
    )


def curve_table(result: FiringResult) -> Table:
    """Return all fitted curves, with their intervals."""
    level = f"{percent(result.confidence)} interval"
    return listing(
        (*result.penalised_fits, *result.fits),
        column_of("curve"),
        (Column("likelihood"), lambda fit: fit.method.removesuffix(" likelihood")),
        (Column(f"V50, {level}", "m/s"), lambda fit: with_interval(fit.v50_m_s, fit.v50_interval_m_s, ".0f")),
        (Column(f"scatter, {level}", "m/s"), lambda fit: with_interval(fit.scale_m_s, fit.scale_interval_m_s, ".0f")),
        column_of("v05_m_s", ".0f", "V05"),
        column_of("v95_m_s", ".0f", "V95"),
    )


PENALISED = "intervals by penalised likelihood; with few shots those of maximum likelihood are too narrow"


# Notes on the mean by its rule.
MEAN_NOTES = {
    "usual span": "the span allowed is usual with this number of shots; MIL-STD-662F leaves it to the specification",
    "given span": "the span allowed is given; MIL-STD-662F leaves it to the specification",
    "no usual rule": "MIL-STD-662F does not usually average this number of shots",
}


def answer(result: FiringResult) -> str:
    """Return V50 with an interval that is bounded, or what would bound it, and the mean of the standard."""
    parts, fit, mean = [], result.recommended, result.mean
    if fit is not None:
        words, level = f"V50 {fit.v50_m_s:.0f} m/s", result.bounded_confidence
        if level is None:
            words += f", interval not bounded: {BOUND}"
        else:
            words += f", {percent(level)} interval {interval(result.bounded_interval_m_s, '.0f')}"
            words += "" if level == result.confidence else f" ({percent(result.confidence)} not bounded: {BOUND})"
        parts.append(words)
    if mean is not None:
        by = "mean of shots" if mean.rule == "no usual rule" else "MIL-STD-662F"
        parts.append(
            f"{by}: {mean.v50_m_s:.0f} m/s from {mean.pairs} + {mean.pairs} shots within {mean.span_m_s:.0f} m/s"
        )
    return "; ".join(parts)


FIXED = (
    "the risks are approximate: where the scatter far exceeds the steps between shots, 5 % may be 8 %; they hold for "
    "shots whose number did not depend on their results; armour plan shots --requirement-m-s decides at any time, with "
    "more shots and bounded risks"
)
BOUND = "a higher complete or a lower partial would bound it"


def requirement_verdict(result: FiringResult) -> list[str]:
    """Return whether a requirement is met, with the risks of accepting and of rejecting the armour now."""
    if result.requirement_m_s is None:
        return []
    required = f"{result.requirement_m_s:g} m/s required of V50"
    if result.consumers_risk is None or result.producers_risk is None:
        return [Verdict(f"{result.decision}: {required}; no curve fits the shots", good=False)]
    allowed = percent(round(1.0 - result.confidence, 12))
    risks = (
        f"accepting it now has a risk (consumer's) of {risk_of(result.consumers_risk)}, rejecting it (producer's) of "
        f"{risk_of(result.producers_risk)}; {allowed} decides"
    )
    return [Verdict(f"{result.decision}: {required}; {risks}", good=result.decision == "met"), FIXED]


def risk_of(risk: float) -> str:
    """Return a risk, rounded up to a tenth of a per cent."""
    return "below 0.1 %" if risk < 1e-3 else f"{rounded_up(100.0 * risk)} %"


def tables(result: FiringResult) -> list[Table | str]:
    """Return V50 in a line, whether a requirement is met, the curve, the posterior, the shots and all curves."""
    shown: list[Table | str] = [*requirement_verdict(result), *filter(None, (answer(result),))]
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
