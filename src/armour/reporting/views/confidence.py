"""The probability that an armour stops its threat."""

from armour.analysis.ballistic_limit import ConfidenceResult
from armour.reporting.table import Table, record
from armour.reporting.words import BALLISTIC_LIMIT, STOPPING, basis_notes, chance, with_error


def tables(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability, and what it rests on."""
    limit, probability = with_error(result.median_m_s, result.interval_m_s), result.probability_of_stopping
    stopping = STOPPING, None if probability is None else chance(probability, result.model_error)
    return [record(result, BALLISTIC_LIMIT, limit, stopping), *basis_notes(result)]
