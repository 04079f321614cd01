"""Mixtures of Student's t distributions, which describe the ballistic limit of an armour given the evidence.

Student's t distribution is computed by quadrature for one armour, as scipy is slow to import, and by scipy for many.
"""

from collections.abc import Callable
from functools import lru_cache
from math import lgamma
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

# Tolerance of a quantile, or of its logarithm, and the most steps to it; ten are usual.
QUANTILE_TOLERANCE, MOST_STEPS = 1e-12, 200
# Most values of one armour that are computed without scipy.
MOST_WITHOUT_SCIPY = 1000


class Mixture(NamedTuple):
    """Distribution of a ballistic limit, or of its ratio to that of the model, for one armour or for each of n.

    Each component is Student's t distribution of the logarithm or, if `logarithmic` is false, of the number itself.

    Attributes
    ----------
    weights : array, (k, ...)
        Probabilities of the k components, which add up to 1 along the first axis; NaN if the distribution is not
        known.  Further axes, such as (k, n) for n armours, broadcast with velocities and probabilities.
    locations, scales : array, (k, ...)
        Of the logarithm of the limit, in m/s, or of the ratio; of the number itself if not `logarithmic`.
    degrees_of_freedom : array, (k, ...)
        At most 1e6, where the distribution is practically normal.
    logarithmic : bool
        Whether the components are distributions of the logarithm.
    narrowed : array, (k, ...) or float
        Factors that multiply the scales for values above the locations; 1 for symmetric components.
    """

    weights: Floats
    locations: Floats
    scales: Floats
    degrees_of_freedom: Floats
    logarithmic: bool = True
    narrowed: Floats | float = 1.0

    def _many(self, values: Floats) -> bool:
        """Return whether to compute by scipy: always for an array of armours, and for many values of one armour."""
        return self.weights.ndim > 1 or values.size > MOST_WITHOUT_SCIPY

    def times(self, limits: ArrayLike) -> "Mixture":
        """Return the distribution of the armour's limit, m/s, if this is that of its ratio to the model's limit.

        `limits` are those by the model, m/s, with the shape (k, ...), or there is one for all.
        """
        factors = np.asarray(limits, dtype=np.float64)
        if self.logarithmic:
            return self._replace(locations=self.locations + np.log(factors))
        return self._replace(locations=self.locations * factors, scales=self.scales * factors)

    def of_shots(self, scatter: Floats | float) -> "Mixture":
        """Return the distribution of the velocity below which a single shot is stopped, if this is that of V50.

        `scatter` is the standard deviation of these velocities about V50, over V50: one for all armours, or (n,).
        """
        deviations = scatter if self.logarithmic else scatter * self.locations
        scales = np.hypot(self.scales, deviations)
        return self._replace(scales=scales, narrowed=np.hypot(self.scales * self.narrowed, deviations) / scales)

    def one(self, place: int = 0) -> "Mixture":
        """Return the distribution of one of n armours, with the shape (k,), from a mixture with the shape (k, n)."""
        return self.mapped(lambda array: array[:, place])

    def mapped(self, function: Callable[[Floats], Floats]) -> "Mixture":
        """Return the mixture with a function applied to each of its arrays, such as one that selects armours."""
        weights, locations, scales, freedom = map(function, self[:4])
        narrowed = self.narrowed if isinstance(self.narrowed, float) else function(self.narrowed)
        return Mixture(weights, locations, scales, freedom, self.logarithmic, narrowed)

    def probability_above(self, values: ArrayLike) -> Any:
        """Return the probability of exceeding each value, such as a velocity in m/s."""
        places = self._at(values)
        weights, freedom, scores, _ = self._scores(places)
        return (weights * probability_below(freedom, -scores, many=self._many(places))).sum(axis=0)

    def quantile(self, probabilities: ArrayLike) -> Any:
        """Return the values that are not exceeded with given probabilities, 0 to 1; NaN where not known."""
        chances = np.asarray(probabilities, dtype=np.float64)
        weights, locations, scales, freedom, narrowed = self._parts(chances)
        many = self._many(chances)
        scores = quantile(freedom, chances, many=many)
        scales = scales * np.where(scores > 0.0, narrowed, 1.0)
        by_component = np.where(weights > 0.0, locations, np.nan) + scales * scores
        low, high = np.fmin.reduce(by_component), np.fmax.reduce(by_component)
        places = np.where(low == high, low, 0.5 * (low + high))
        moving = np.ones_like(places, dtype=bool)
        # Newton's method, for each value until its own last step, within an interval that the steps narrow.
        for _ in range(MOST_STEPS if len(by_component) > 1 else 0):
            below = (weights * probability_below(freedom, self._scores(places)[2], many=many)).sum(axis=0)
            low, high = np.where(below < chances, places, low), np.where(below < chances, high, places)
            with np.errstate(all="ignore"):
                new = places + (chances - below) * np.exp(-self._log_density(places))
                new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
                last, places = places, np.where(moving, np.where(low == high, low, new), places)
                moving &= np.abs(places - last) > QUANTILE_TOLERANCE * np.maximum(1.0, np.abs(places))
            if not moving.any():
                break
        return np.exp(places) if self.logarithmic else places

    def log_density(self, values: ArrayLike) -> Any:
        """Return the logarithm of the density at values above 0, per their unit."""
        places = self._at(values)
        return self._log_density(places) - (places if self.logarithmic else 0.0)

    def _log_density(self, places: Floats) -> Any:
        """Return the logarithm of the density at places that `_at` has returned, per unit of these."""
        weights, freedom, scores, scales = self._scores(places)
        constant = np.log(_constants(freedom) / np.sqrt(freedom))
        kernel = 0.5 * (freedom + 1.0) * np.log1p(scores**2 / freedom)
        with np.errstate(divide="ignore"):
            return np.logaddexp.reduce(np.log(weights) + constant - np.log(scales) - kernel)

    def drawn(self, chances: Floats) -> tuple[Any, Floats]:
        """Return the component, and the value, of each of n draws from the mixture of one armour, (n,).

        `chances`, (n,), are uniform between 0 and 1: each chooses a component, and the quantile within it.
        """
        ends = np.cumsum(self.weights)
        components = np.minimum(np.searchsorted(ends, chances, side="right"), np.flatnonzero(self.weights)[-1])
        weights, locations, scales, freedom, narrowed = (array[components] for array in self._parts(np.zeros(())))
        parts = ((chances - ends[components]) / weights + 1.0).clip(2.0**-53, 1.0 - 2.0**-53)
        scores = quantile(freedom, parts, many=True)
        values = locations + scales * np.where(scores > 0.0, narrowed, 1.0) * scores
        return components, np.exp(values) if self.logarithmic else values

    def _parts(self, values: Floats) -> list[Floats]:
        """Return weights, locations, scales, degrees of freedom and `narrowed`, with axes to broadcast with values."""
        arrays = (*self[:4], self.narrowed * np.ones_like(self.scales))
        return [array.reshape(array.shape + (1,) * (values.ndim + 1 - array.ndim)) for array in arrays]

    def _scores(self, places: Floats) -> tuple[Floats, ...]:
        """Return weights, degrees of freedom, (places - locations) / scales, and scales, narrowed above locations."""
        weights, locations, scales, freedom, narrowed = self._parts(places)
        scales = scales * np.where(places > locations, narrowed, 1.0)
        return weights, freedom, (places - locations) / scales, scales

    def _at(self, values: ArrayLike) -> Floats:
        """Return the places where the components are evaluated: the values or, if `logarithmic`, their logarithms."""
        with np.errstate(divide="ignore"):
            return np.log(values) if self.logarithmic else np.asarray(values, dtype=np.float64)


# Nodes and weights of a quadrature, exact to 1e-12 for 2.5 degrees of freedom or more, and the number of standard
# deviations that it covers.
_OFF_DIAGONAL = np.arange(1.0, 64.0) / np.sqrt(4.0 * np.arange(1.0, 64.0) ** 2 - 1.0)
# Gauss-Legendre by Golub and Welsch: numpy's own function would import all of numpy.polynomial.
ANGLE_NODES, _VECTORS = np.linalg.eigh(np.diag(_OFF_DIAGONAL, 1) + np.diag(_OFF_DIAGONAL, -1))
ANGLE_WEIGHTS = 2.0 * _VECTORS[0] ** 2
COVERED_DEVIATIONS = 9.0
# Tolerance of an angle, and the most steps to it; ten are usual.
ANGLE_TOLERANCE, MOST_ANGLES = 1e-14, 100
# Least density to divide by, far beyond any probability of use.
LEAST_DENSITY = 1e-300


def probability_below(freedom: Floats, t: Floats, *, many: bool) -> Floats:
    """Return the probability that Student's t distribution gives values below `t`; the arrays broadcast.

    `freedom` are its degrees of freedom.  If `many`, scipy computes it, which is fast but slow to import.
    """
    if many:
        from scipy.special import stdtr  # slow to import

        return np.asarray(stdtr(freedom, t))
    return _below(freedom, _constants(freedom), np.arctan(t / np.sqrt(freedom)))


def quantile(freedom: Floats, probabilities: Floats, *, many: bool) -> Floats:
    """Return quantiles of Student's t distribution with `freedom` degrees of freedom; `many` as above."""
    if many:
        from scipy.special import stdtrit  # slow to import

        values = stdtrit(freedom, probabilities)
    else:
        constants, angle = _constants(freedom), np.zeros(np.broadcast_shapes(freedom.shape, probabilities.shape))
        # Newton's method does not pass the root: the function bends one way on each side of 0.
        for _ in range(MOST_ANGLES):
            density = np.maximum(constants * np.cos(angle) ** (freedom - 1.0), LEAST_DENSITY)
            step = (probabilities - _below(freedom, constants, angle)) / density
            angle = (angle + step).clip(-0.5 * np.pi, 0.5 * np.pi)
            if not (np.abs(step) > ANGLE_TOLERANCE).any():
                break
        values = np.sqrt(freedom) * np.tan(angle)
    # Versions of scipy give different results at 0 and 1.
    ends = [np.isnan(probabilities), probabilities == 0.0, probabilities == 1.0]
    return np.select(ends, [np.nan, -np.inf, np.inf], values)


def _below(freedom: Floats, constants: Floats, angle: Floats) -> Floats:
    """Return the probability that Student's t distribution gives values below sqrt(freedom) * tan(angle).

    The density over the angle is constant * cos(angle)**(freedom - 1), which is integrated by quadrature.
    """
    reach = np.minimum(np.abs(angle), COVERED_DEVIATIONS / np.sqrt(freedom))[..., None]
    log_cosines = 0.5 * np.log1p(-(np.sin(0.5 * reach * (1.0 + ANGLE_NODES)) ** 2))
    integral = (0.5 * reach * ANGLE_WEIGHTS * np.exp((freedom[..., None] - 1.0) * log_cosines)).sum(axis=-1)
    return 0.5 + np.sign(angle) * constants * integral


def _constants(freedom: Floats) -> Floats:
    """Return the density over the angle at 0, see `_constant`, in the shape of the degrees of freedom."""
    return np.reshape([_constant(each) for each in freedom.ravel().tolist()], freedom.shape)


@lru_cache(1000)
def _constant(freedom: float) -> float:
    """Return the density over the angle at 0, Gamma((freedom + 1) / 2) / (Gamma(freedom / 2) sqrt(pi)).

    From 200 degrees of freedom on, a series gives it, as differences of large logarithms would lose digits.
    """
    half = 0.5 * freedom
    if half < 100.0:
        return float(np.exp(lgamma(half + 0.5) - lgamma(half)) / np.sqrt(np.pi))
    series = 1.0 - 1.0 / (8.0 * half) + 1.0 / (128.0 * half**2) + 5.0 / (1024.0 * half**3) - 21.0 / (32768.0 * half**4)
    return float(np.sqrt(half) * series / np.sqrt(np.pi))
