"""Samples of uncertain inputs: points of the unit cube, quantiles of the distributions and a Gaussian copula."""

from collections.abc import Mapping
from math import hypot, log, log1p, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr, ndtri

from armour.evidence.mixture import Floats
from armour.scenario.schema import Distribution, Uncertainty, correlation_matrix

# Independent replicates into which `np.array_split` divides samples; their differences give the intervals.
# More replicates would be smaller, and the samples as a whole would converge more slowly.
REPLICATES = 16
# Greatest shift of the mean by truncation without a warning, in standard deviations; probabilities that give the mean.
MOVED = 0.1
MIDDLES = (np.arange(1000) + 0.5) / 1000


def points_of(uncertainty: Uncertainty) -> Floats:
    """Return points within the unit cube, shape (samples, inputs)."""
    return replicated_points(uncertainty.method, len(uncertainty.inputs()), uncertainty.samples, uncertainty.seed)


def replicated_points(method: str, width: int, samples: int, seed: int) -> Floats:
    """Return points within the unit cube, shape (samples, width): scrambled Sobol' sequences or Latin hypercubes."""
    from scipy.stats import qmc  # slow to import

    rng = np.random.default_rng(seed)
    sampler = qmc.Sobol if method == "sobol" else qmc.LatinHypercube
    sizes = (len(part) for part in np.array_split(np.empty(samples), REPLICATES))
    points = np.concatenate([sampler(width, rng=rng).random(size) for size in sizes])
    # The quantile at 0 of an unbounded distribution is infinite.
    return np.clip(points, 2.0**-53, 1.0 - 2.0**-53, out=points)


def correlated(uncertainty: Uncertainty, points: Floats) -> Floats:
    """Return points of the unit cube, shape (n, inputs), with the correlations of a Gaussian copula."""
    if not uncertainty.correlation:
        return points
    factor = np.linalg.cholesky(correlation_matrix(list(uncertainty.inputs()), uncertainty.correlation))
    return ndtr(ndtri(points) @ factor.T)


def columns_of(uncertainty: Uncertainty, values: Mapping[str, float], points: Floats) -> dict[str, Floats]:
    """Return values of the uncertain inputs, shape (n,), at points of the unit cube, shape (n, inputs).

    They are correlated.  `values` are those of the scenario by name of input.
    """
    parts = zip(uncertainty.inputs().items(), correlated(uncertainty, points).T, strict=True)
    return {name: quantiles(distribution, chances, values[name]) for (name, distribution), chances in parts}


def quantiles(distribution: Distribution, probabilities: ArrayLike, value: float) -> Floats:
    """Return quantiles of a truncated distribution, in the shape of `probabilities`.

    `value` is the scenario's value of the input, which is the mean before truncation if none is given.  If it cannot
    be a mean, such as the thickness 0 of an absent layer, all quantiles are equal to it.
    """
    if distribution.mean_problem(value):
        return np.full(np.shape(probabilities), value)
    parts, ends = np.asarray(probabilities), np.array(distribution.ends)
    if distribution.distribution == "uniform":
        return ends[0] + (ends[1] - ends[0]) * parts
    centre, width = centre_and_width(distribution, value)
    if distribution.distribution == "lognormal":
        with np.errstate(divide="ignore"):
            ends = np.log(ends.clip(min=0.0))
    if np.isinf(ends).all():
        scores = ndtri(parts)
    else:
        from scipy.stats import truncnorm  # slow to import

        scores = truncnorm.ppf(parts, *(ends - centre) / width)
    values = centre + width * scores
    return np.clip(np.exp(values) if distribution.distribution == "lognormal" else values, *distribution.ends)


def moved_mean(distribution: Distribution, value: float) -> tuple[float, float] | None:
    """Return the mean before and after truncation; None if they differ by less than a tenth of the deviation."""
    if distribution.distribution == "uniform" or np.isinf(distribution.ends).all():
        return None
    before, deviation = distribution.moments(value)
    after = float(quantiles(distribution, MIDDLES, value).mean())
    return (before, after) if abs(after - before) > MOVED * deviation else None


def centre_and_width(distribution: Distribution, value: float) -> tuple[float, float]:
    """Return mean and standard deviation before truncation; of a lognormal distribution, those of the logarithm."""
    mean, deviation = distribution.moments(value)
    if distribution.distribution != "lognormal":
        return mean, deviation
    return log(mean / hypot(1.0, deviation / mean)), sqrt(log1p((deviation / mean) ** 2))
