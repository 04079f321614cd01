"""The probability that an armour stops its threat."""

from armour.analysis.ballistic_limit import ConfidenceResult
from armour.reporting.table import Table, record
from armour.reporting.words import BALLISTIC_LIMIT, STOPPING, basis_notes, chance, with_error


def confidence_table(result: ConfidenceResult) -> Table:
    """Return the ballistic limit and the probability that it exceeds the impact velocity."""
    probability = result.probability_of_stopping
    return record(
        result,
        BALLISTIC_LIMIT,
        with_error(result.median_m_s, result.interval_m_s),
        (STOPPING, None if probability is None else chance(probability, result.model_error)),
    )


def tables(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability, and what it rests on."""
    return [confidence_table(result), *basis_notes(result)]
