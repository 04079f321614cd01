"""The probability that an armour stops its threat."""

from armour.analysis.ballistic_limit import ConfidenceResult, LimitResult
from armour.analysis.results import Result
from armour.reporting.table import Column, Source, Table, column_of, record
from armour.reporting.text import interval
from armour.scenario.evidence import REMEDY, ModelError

DEFEAT = Column("probability of stopping the projectile", prose=True)


UNKNOWN = "the model error is not known for such an armour"


EXCLUDED = "the model error is not included, as uncertainty.model says"


# What distributions tell where the model error is not known.
SAMPLED_ALONE = "a probability from the given distributions alone takes the model as exact"


def chance(probability: float | None) -> str:
    """Format a probability, such as "73 %"; one that is near 0 or 1 is not shown as that."""
    if probability is None:
        return "unknown"
    if probability < 0.005:
        return "below 0.5 %"
    return "above 99.5 %" if probability > 0.995 else f"{100.0 * probability:.0f} %"


def error_note(result: Result, error: ModelError | None) -> str:
    """Return what the model error is and rests on, in a sentence, for a result."""
    if error is None:
        scenario = result.question.get("scenario")
        if scenario is None:
            return f"{UNKNOWN}, or not included"
        return EXCLUDED if scenario.excludes_error() else f"{UNKNOWN}; {REMEDY}"
    return "; ".join([from_tests(error), *extrapolation(error)])


def from_tests(error: ModelError) -> str:
    """Return what the model error is, and what it is estimated from."""
    if error.ratio.logarithmic:
        low, middle, high = (error.quantiles_percent[p] for p in ("0.025", "0.5", "0.975"))
        return f"model error: {middle:+.1f} %, 95 % interval {low:+.1f} to {high:+.1f} %, from {error.source}"
    mean = f"{error.mean_percent:+.1f} % " if error.mean_percent else ""
    return f"model error: {mean}± {error.scale_percent:.1f} %, from {error.source}"


def extrapolation(error: ModelError) -> list[str]:
    """Return what the model error is extrapolated from, if it is."""
    return [f"extrapolated from {', '.join(error.extrapolated)}"] if error.extrapolated else []


def confidence_note(result: ConfidenceResult) -> str:
    """Return what the probability rests on, or why it is not known."""
    if result.model_error is None or result.probability_of_defeat is None:
        return f"the probability of stopping the projectile is not known: {result.reason}"
    return error_note(result, result.model_error)


BALLISTIC_LIMIT = column_of("ballistic_limit_m_s")


def expected_limit(result: ConfidenceResult | LimitResult) -> tuple[Source, Source]:
    """Return where the model error puts the ballistic limit of the armour."""
    return (
        (Column("expected, with the model error", "m/s", ".0f"), result.median_m_s),
        (Column("its 95 % interval", "m/s"), interval(result.interval_m_s, ".0f")),
    )


def confidence_table(result: ConfidenceResult) -> Table:
    """Return the ballistic limit and the probability that it exceeds the impact velocity."""
    return record(result, BALLISTIC_LIMIT, *expected_limit(result), (DEFEAT, chance(result.probability_of_defeat)))


def tables(result: ConfidenceResult) -> list[Table | str]:
    """Return the probability, and what it rests on."""
    return [confidence_table(result), confidence_note(result)]
