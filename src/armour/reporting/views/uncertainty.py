"""A propagated uncertainty."""

from armour.analysis.samples import Estimate
from armour.reporting.table import Column, Table, column_of, in_words, listing, record
from armour.reporting.text import interval, percent, with_interval
from armour.reporting.words import SAMPLED_ALONE, STOPPING, error_note, rounded_down
from armour.statistics.uncertainty import UncertaintyResult

SAMPLING_NOTE = "more samples make the intervals narrower; the spread of the ballistic limit is V05 to V95"


INDEX_NOTE = "true indices lie between 0 and 1; sampling error can push estimates and intervals slightly outside"


def estimate_table(result: UncertaintyResult) -> Table:
    """Return the estimated probability, quantiles and mean."""
    mean, perforated = Estimate(result.mean_m_s, *result.mean_interval_m_s), result.probability_of_perforation
    stopped = Estimate(
        *(rounded_down(100.0 * (1.0 - p), 1) for p in (perforated.value, perforated.high, perforated.low))
    )
    limits = {**result.ballistic_limit_m_s, "mean ballistic limit": mean}
    # A probability and velocities have different decimals, so that the numbers are formatted here.
    parts = [
        (STOPPING.label, "%", stopped, ".1f"),
        *((name, "m/s", estimate, ".0f") for name, estimate in limits.items()),
    ]
    sampling = Column(f"sampling error, {percent(result.confidence)} interval")
    columns = (Column("quantity"), Column("unit"), Column("estimate", spec="g"), sampling)
    rows = ((name, unit, format(e.value, spec), interval(e, spec)) for name, unit, e, spec in parts)
    return Table(columns, tuple(rows))


def index_table(result: UncertaintyResult) -> Table:
    """Return the Sobol' indices of each input, and the ballistic limits at its quantiles."""
    return listing(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        (Column("first-order index"), lambda item: item.first and with_interval(item.first.value, item.first, ".2f")),
        (Column("total index"), lambda item: item.total and with_interval(item.total.value, item.total, ".2f")),
        (Column("limit at 5 and 95 %", "m/s"), lambda item: interval(item.limits_m_s, ".0f")),
    )


def tables(result: UncertaintyResult) -> list[Table | str]:
    """Return all tables of a propagated uncertainty."""
    parts: list[Table | str] = [
        estimate_table(result),
        SAMPLING_NOTE,
        error_note(result.model_error, result.question.get("scenario")),
    ]
    if result.model_error is None:
        parts.append(SAMPLED_ALONE)
    samples = record(
        result,
        column_of("samples", "d"),
        (Column("method"), f"{result.method}, seed {result.seed}"),
        column_of("deterministic_m_s", ".0f", "ballistic limit of the scenario"),
        column_of("standard_deviation_m_s", ".0f"),
    )
    parts += [samples, index_table(result)]
    estimates = [estimate for index in result.inputs for estimate in (index.first, index.total) if estimate]
    if any(estimate.low < 0.0 or estimate.high > 1.0 for estimate in estimates):
        parts.append(INDEX_NOTE)
    if any(index.first and not index.total for index in result.inputs):
        parts.append(
            "inputs are correlated: variance that they share is attributed to each of them, so that the first-order "
            "indices may sum to more than 1; total indices are not given"
        )
    return parts
