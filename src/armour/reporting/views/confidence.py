"""The probability that an armour stops its threat."""

from armour.analysis.ballistic_limit import ConfidenceResult
from armour.reporting.table import Table, record
from armour.reporting.words import (
    BALLISTIC_LIMIT,
    STOPPING,
    chance,
    error_note,
    flow_stress_notes,
    why_unknown,
    with_error,
)


def confidence_notes(result: ConfidenceResult) -> list[str]:
    """Return what the probability rests on, or why it is not known and what the flow stress must be."""
    if result.model_error is None or result.probability_of_stopping is None:
        unknown = why_unknown(result.reason, result.probability_at_normal_incidence)
        return [unknown, *flow_stress_notes(result.flow_stress)]
    return [error_note(result, result.model_error)]


def confidence_table(result: ConfidenceResult) -> Table:
    """Return the ballistic limit and the probability that it exceeds the impact velocity."""
    sure = result.probability_of_stopping
    return record(
        result,
        BALLISTIC_LIMIT,
        with_error(result.median_m_s, result.interval_m_s),
        (STOPPING, None if sure is None else chance(sure, result.model_error)),
    )


def tables(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability, and what it rests on."""
    return [confidence_table(result), *confidence_notes(result)]
