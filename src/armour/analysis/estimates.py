"""Estimates from samples: proportions, means and statistics of replicates, with confidence intervals."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Annotated

import numpy as np
from pydantic import Field

from armour.analysis.variants import Floats

CONFIDENCE = 0.95
Confidence = Annotated[float, Field(ge=0.5, le=0.9999)]
# Probability beyond each end of an interval.
INTERVAL_TAIL = 0.5 * (1.0 - CONFIDENCE)


@dataclass(frozen=True)
class Estimate:
    """A number estimated from samples, with its 95 % confidence interval.

    Attributes
    ----------
    value : float
    low, high : float
        Ends of the interval.
    """

    value: float
    low: float
    high: float

    def at_least(self, least: float) -> "Estimate":
        """Return the estimate with value and ends raised to at least `least`."""
        return Estimate(max(self.value, least), max(self.low, least), max(self.high, least))


def proportion(hits: int, samples: int) -> Estimate:
    """Estimate the proportion of `hits` among `samples`, with the Clopper-Pearson confidence interval [Clopper1934]."""
    from scipy.special import betaincinv  # slow to import

    misses = samples - hits
    low = float(betaincinv(hits, misses + 1, INTERVAL_TAIL)) if hits else 0.0
    high = float(betaincinv(hits + 1, misses, 1.0 - INTERVAL_TAIL)) if misses else 1.0
    return Estimate(hits / samples, low, high)


def mean_of_replicates(values: Floats) -> Estimate:
    """Estimate a mean from one value for each independent replicate, (replicates,), with the t interval."""
    from scipy.special import stdtrit  # slow to import

    mean, count = float(values.mean()), len(values)
    half = float(stdtrit(count - 1, 1.0 - INTERVAL_TAIL) * values.std(ddof=1)) / sqrt(count)
    return Estimate(mean, mean - half, mean + half)


def proportion_of_replicates(hits: Sequence[int], sizes: Sequence[int]) -> Estimate:
    """Estimate a proportion from the hits in each independent replicate, given their sizes, with the t interval.

    If there are fewer hits, or misses, than replicates, the interval is the Clopper-Pearson one.
    """
    samples = sum(sizes)
    plain = proportion(sum(hits), samples)
    if min(sum(hits), samples - sum(hits)) < len(sizes):
        return plain
    mean = mean_of_replicates(np.divide(hits, sizes))
    # All replicates may have the same proportion, but the interval is not narrower than about one hit in all of them.
    half = max(mean.high - mean.value, -log(INTERVAL_TAIL) / samples)
    return Estimate(plain.value, max(0.0, plain.value - half), min(1.0, plain.value + half))
