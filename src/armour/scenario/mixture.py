"""Mixtures of Student's t distributions: where the evidence puts the ballistic limit of an armour."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gammaln, ndtri, stdtr, stdtrit

Floats = NDArray[np.float64]

# Of a quantile, or its logarithm, and the most steps to it; five are usual.
TOLERANCE, MOST_STEPS = 1e-12, 200


@dataclass(frozen=True, eq=False)
class Mixture:
    """Distribution of a ballistic limit, or of its ratio to that of the model; of one armour or of each of n.

    Of each component, the logarithm has Student's t distribution, or the number itself where `logarithmic` is false.

    Attributes
    ----------
    weights : array, (k, ...)
        Probabilities of the k components, which add up to 1 along the first axis; NaN if the distribution is not
        known.  Further axes, such as (k, n) for n armours, broadcast with the velocities and probabilities asked for.
    locations, scales : array, (k, ...)
        Of the logarithms: of m/s, or of the ratio.
    degrees_of_freedom : array, (k, ...)
        At most 1e6, which is as good as a normal distribution.
    logarithmic : bool
    """

    weights: Floats
    locations: Floats
    scales: Floats
    degrees_of_freedom: Floats
    logarithmic: bool = True

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Weights, locations, scales and degrees of freedom."""
        return self.weights, self.locations, self.scales, self.degrees_of_freedom

    def times(self, limits: ArrayLike) -> "Mixture":
        """Return the distribution of a ratio times numbers: limits by the model, m/s, (k, ...) or one for all."""
        factors = np.asarray(limits, dtype=np.float64)
        if self.logarithmic:
            return replace(self, locations=self.locations + np.log(factors))
        return replace(self, locations=self.locations * factors, scales=self.scales * factors)

    def one(self, place: int = 0) -> "Mixture":
        """Return the distribution of one of n armours, (k, n) -> (k,)."""
        return self.mapped(lambda array: array[:, place])

    def mapped(self, of: Callable[[Floats], Floats]) -> "Mixture":
        """Return the mixture whose arrays are a function of these."""
        weights, locations, scales, freedom = map(of, self.arrays)
        return Mixture(weights, locations, scales, freedom, self.logarithmic)

    def probability_above(self, values: ArrayLike) -> Any:
        """Return the probability of more than each of some values, such as velocities in m/s."""
        places = self._places(values)
        weights, locations, scales, freedom = self._parts(places)
        return (weights * stdtr(freedom, (locations - places) / scales)).sum(axis=0)

    def quantile(self, probabilities: ArrayLike) -> Any:
        """Return the values that are not exceeded with each of some probabilities, 0 to 1."""
        wanted = np.asarray(probabilities, dtype=np.float64)
        weights, locations, scales, freedom = self._parts(wanted)
        known = np.where(weights > 0.0, 0.0, np.nan)
        of_each = known + _quantiles(locations, scales, freedom, wanted)
        if len(of_each) > 1:
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                found = self._solved(np.fmin.reduce(of_each), np.fmax.reduce(of_each), wanted)
        else:
            [found] = of_each
        return np.exp(found) if self.logarithmic else found

    def _solved(self, low: Floats, high: Floats, wanted: Floats) -> Floats:
        """Return what lies between ends, below which the mixture has a probability of at most, and at least, one.

        By Newton's method on the normal score, and halves of the interval where a step is not half of the last one.
        """
        weights, locations, scales, freedom = self._parts(wanted)
        score, last, found = ndtri(wanted), high - low, np.where(low == high, low, 0.5 * (low + high))
        for _ in range(MOST_STEPS):
            below = (weights * stdtr(freedom, (found - locations) / scales)).sum(axis=0)
            low, high = np.where(below < wanted, found, low), np.where(below < wanted, high, found)
            here = ndtri(below)
            step = (score - here) * np.exp(-0.5 * here**2 - self._log_density(found)) / np.sqrt(2.0 * np.pi)
            least = TOLERANCE * np.maximum(1.0, np.abs(found))
            near = (np.abs(step) <= 0.5 * last) & (found + step >= low) & (found + step <= high)
            step = np.where(
                near | (np.abs(step) <= least), step, np.where(low == high, 0.0, 0.5 * (low + high) - found)
            )
            found, last = found + step, np.abs(step)
            if not (last > least).any():
                break
        return found

    def log_density(self, values: ArrayLike) -> Any:
        """Return the logarithm of the density at values above 0, per their unit."""
        places = self._places(values)
        return self._log_density(places) - (places if self.logarithmic else 0.0)

    def _log_density(self, places: Floats) -> Any:
        """Return the logarithm of the density at values, or per unit of their logarithms at these."""
        weights, locations, scales, freedom = self._parts(places)
        deviations = (places - locations) / scales
        constant = gammaln(0.5 * (freedom + 1.0)) - gammaln(0.5 * freedom) - 0.5 * np.log(freedom * np.pi)
        logarithms = constant - np.log(scales) - 0.5 * (freedom + 1.0) * np.log1p(deviations**2 / freedom)
        with np.errstate(divide="ignore"):
            return np.logaddexp.reduce(np.log(weights) + logarithms)

    def _places(self, values: ArrayLike) -> Floats:
        """Return where components are evaluated at values: their logarithms, or themselves."""
        with np.errstate(divide="ignore"):
            return np.log(values) if self.logarithmic else np.asarray(values, dtype=np.float64)

    def drawn(self, chances: Floats) -> tuple[Any, Floats]:
        """Return components and values at chances, (n,), between 0 and 1, one for each draw.

        The mixture is of one armour, its arrays (k,).  A chance chooses the component, and within it the quantile.
        """
        ends = np.cumsum(self.weights)
        which = np.minimum(np.searchsorted(ends, chances, side="right"), np.flatnonzero(self.weights)[-1])
        parts = ((chances - ends[which]) / self.weights[which] + 1.0).clip(2.0**-53, 1.0 - 2.0**-53)
        values = _quantiles(self.locations[which], self.scales[which], self.degrees_of_freedom[which], parts)
        return which, np.exp(values) if self.logarithmic else values

    def _parts(self, values: Floats) -> list[Floats]:
        """Return weights, locations, scales and degrees of freedom with axes after the first one to broadcast."""
        return [array.reshape(array.shape + (1,) * (values.ndim + 1 - array.ndim)) for array in self.arrays]


def _quantiles(locations: Floats, scales: Floats, freedom: Floats, probabilities: Floats) -> Floats:
    """Return quantiles of Student's t distributions."""
    # Versions of scipy differ at 0 and at 1.
    ends = [probabilities == 0.0, probabilities == 1.0]
    return locations + scales * np.select(ends, [-np.inf, np.inf], stdtrit(freedom, probabilities))
