"""A propagated uncertainty."""

from dataclasses import replace

from armour.analysis.estimates import Estimate
from armour.reporting import charts
from armour.reporting.table import Column, Table, between, column_of, in_words, listing, record
from armour.reporting.text import interval, percent
from armour.reporting.views.confidence import SAMPLED_ALONE, error_note
from armour.statistics.uncertainty import UncertaintyResult

# What the intervals of a propagated uncertainty are of.
SAMPLING = ", by sampling"


SAMPLING_NOTE = (
    "the intervals are those of the estimates, from the number of samples alone; the spread of the ballistic limit is "
    "V05 to V95"
)


INDEX_NOTE = "indices are from 0 to 1; estimates of small and large ones, and their intervals, may fall outside"


def uncertainty_table(result: UncertaintyResult) -> Table:
    """Return the samples, and the ballistic limit with and without them."""
    return record(
        result,
        column_of("samples", "d"),
        (Column("method"), f"{result.method}, seed {result.seed}"),
        column_of("deterministic_m_s", ".1f", "ballistic limit of the scenario"),
        column_of("standard_deviation_m_s", ".1f"),
    )


def estimate_table(result: UncertaintyResult) -> Table:
    """Return the estimated probability, quantiles and mean."""
    mean = Estimate(result.mean_m_s, *result.mean_interval_m_s)
    limits = {**result.ballistic_limit_m_s, "mean ballistic limit": mean}
    # A probability and velocities have different decimals, so that the numbers are formatted here.
    found = [
        ("probability of perforation", "", result.probability_of_perforation, ".3f"),
        *((name, "m/s", estimate, ".1f") for name, estimate in limits.items()),
    ]
    columns = (Column("quantity"), Column("unit"), Column("estimate", spec="g"), between(result, of=SAMPLING))
    rows = ((name, unit, format(e.value, spec), interval(e, spec)) for name, unit, e, spec in found)
    return Table(columns, tuple(rows))


def index_table(result: UncertaintyResult) -> Table:
    """Return the Sobol' indices of each input, and the ballistic limits at its quantiles."""
    return listing(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        (Column("first-order index", spec=".3f"), lambda item: getattr(item.first, "value", None)),
        (between(result, of=SAMPLING), lambda item: interval(item.first, ".3f")),
        (Column("total index", spec=".3f"), lambda item: getattr(item.total, "value", None)),
        (between(result, of=SAMPLING), lambda item: interval(item.total, ".3f")),
        (Column("ballistic limit at its 5 % quantile", "m/s", ".1f"), lambda item: item.limits_m_s[0]),
        (Column("ballistic limit at its 95 % quantile", "m/s", ".1f"), lambda item: item.limits_m_s[1]),
    )


def tables(result: UncertaintyResult) -> list[Table | str]:
    """Return all tables of a propagated uncertainty."""
    found: list[Table | str] = [uncertainty_table(result), estimate_table(result), SAMPLING_NOTE, index_table(result)]
    estimates = [estimate for index in result.inputs for estimate in (index.first, index.total) if estimate]
    if any(estimate.low < 0.0 or estimate.high > 1.0 for estimate in estimates):
        found.append(INDEX_NOTE)
    found.append(error_note(result, result.model_error))
    if result.model_error is None:
        found.append(SAMPLED_ALONE)
    if any(index.first and not index.total for index in result.inputs):
        found.append(
            "inputs are correlated: a first-order index includes what an input shares with those that it is correlated "
            "with, so that their sum may exceed 1; total indices are not given"
        )
    return found


# Probabilities between which the curve of a chart is shown whole.
SHOWN_PROBABILITY = 0.002


def chart(result: UncertaintyResult) -> charts.Chart:
    """Describe the probability of perforation over velocity, and the ballistic limits at quantiles of each input."""
    curve, p = result.curve, result.probability_of_perforation
    at = charts.needed(result, "scenario").impact.velocity_m_s
    found, level = result.deterministic_m_s, percent(result.confidence)
    points = list(zip(curve.velocity_m_s, curve.probability, curve.low, curve.high, strict=True))
    text = tuple(
        f"perforated in {100.0 * value:.1f} % at {velocity:.1f} m/s\n{level} interval {low:.3f} to {high:.3f}"
        for velocity, value, low, high in points
    )
    label = f"at {at:g} m/s: {p.value:.3f}, {p.low:.3f} to {p.high:.3f} by sampling"
    quantiles = {name: result.ballistic_limit_m_s[name].value for name in ("V05", "V50", "V95")}
    series: list[charts.Series] = [
        charts.Band(curve.velocity_m_s, curve.low, curve.high),
        charts.Line(
            curve.velocity_m_s, curve.probability, label=f"probability, with its {level} band by sampling", text=text
        ),
        charts.velocity_rule("nominal ballistic limit", found, "ink", ":"),
        *(
            charts.velocity_rule(*item, "soft", style)
            for item, style in zip(quantiles.items(), ("-.", "-", "--"), strict=True)
        ),
        charts.Points(
            [at], [p.value], y_ends=((p.low, p.high),), label=label, colour="vermilion", text=(f"perforated {label}",)
        ),
    ]
    uncertain = [velocity for velocity, value, *_ in points if SHOWN_PROBABILITY < value < 1.0 - SHOWN_PROBABILITY]
    changed = [limit for index in result.inputs for limit in index.limits_m_s]
    limits = charts.widened([at, found, quantiles["V05"], quantiles["V95"], *uncertain, *changed])
    x = charts.Axis("velocity", "m/s", spec=".1f", limits=limits)
    panels = [charts.Panel(x, charts.Axis("probability of perforation", limits=(0.0, 1.0)), tuple(series))]
    if result.inputs:
        names = tuple(charts.quantity_axis(index.input).label for index in result.inputs)
        values = {
            f"input at its {quantile} quantile": [index.limits_m_s[side] for index in result.inputs]
            for side, quantile in enumerate(("5 %", "95 %"))
        }
        title = "Ballistic limit with one input changed"
        swings = charts.bars_panel(x, names, values, title, found)
        panels.append(replace(swings, shares_x=True))
    return charts.Chart("Probability of perforation", tuple(panels))
