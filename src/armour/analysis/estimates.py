"""Numbers estimated from samples, with confidence intervals."""

from dataclasses import dataclass
from math import ceil

from scipy.stats import binomtest

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A number estimated from samples, with its confidence interval."""

    value: float
    low: float
    high: float

    def samples_for(self, last_digit: float, samples: int) -> int:
        """Estimate the number of samples that determine a digit of this value, given the number that it is based on."""
        half = 0.5 * (self.high - self.low)
        return max(samples, ceil(samples * (half / (0.5 * last_digit)) ** 2)) if half > 0.5 * last_digit else samples


def proportion(hits: int, samples: int) -> Estimate:
    """Estimate a proportion, with the Clopper-Pearson confidence interval."""
    interval = binomtest(hits, samples).proportion_ci(CONFIDENCE, method="exact")
    return Estimate(hits / samples, float(interval.low), float(interval.high))
