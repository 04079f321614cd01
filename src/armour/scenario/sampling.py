"""Samples of uncertain inputs: points of the unit cube, quantiles of the distributions and a Gaussian copula."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from math import exp, hypot, log, log1p, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from armour.scenario.schema import Distribution, Uncertainty, correlation_matrix

Floats = NDArray[np.float64]

# Independent replicates into which samples are divided; their differences give the intervals.  `np.array_split` into as
# many parts finds them again.  More of them would be smaller, and converge slower as a whole.
REPLICATES = 16
# Probability that truncation must leave: less has lost its digits.
LEAST_PROBABILITY = 1e-300
# Part of the standard deviation by which truncation may move the mean unsaid, and probabilities that give the mean.
MOVED = 0.1
MIDDLES = (np.arange(1000) + 0.5) / 1000


def points_of(uncertainty: Uncertainty) -> Floats:
    """Return points within the unit cube, shape (samples, inputs)."""
    return replicated_points(uncertainty.method, len(uncertainty.inputs()), uncertainty.samples, uncertainty.seed)


def replicated_points(method: str, width: int, samples: int, seed: int) -> Floats:
    """Return points within the unit cube, shape (samples, width): scrambled Sobol' sequences or Latin hypercubes."""
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


def columns_of(uncertainty: Uncertainty, own: Mapping[str, float], points: Floats) -> dict[str, Floats]:
    """Return values of the uncertain inputs, shape (n,), at points of the unit cube, shape (n, inputs).

    They are correlated.  `own` are the scenario's own values by name of input.
    """
    chances = correlated(uncertainty, points).T
    return {
        name: quantiles(distribution, chances[i], own[name])
        for i, (name, distribution) in enumerate(uncertainty.inputs().items())
    }


def quantiles(distribution: Distribution, probabilities: ArrayLike, own: float) -> Floats:
    """Return quantiles of a truncated distribution, in the shape of `probabilities`.

    `own` is the scenario's own value of the input, which is the mean before truncation if none is given.  If it cannot
    be a mean, such as the thickness 0 of an absent layer, all quantiles are equal to it.
    """
    if distribution.mean_problem(own):
        return np.full(np.shape(probabilities), own)
    value, start, end = _truncated(distribution, own)
    parts = np.asarray(probabilities)
    return np.clip(value((1.0 - parts) * start + parts * end), *distribution.ends)


@lru_cache(maxsize=64)
def truncation_problem(distribution: Distribution, own: float) -> str:
    """Return why a distribution has no values between its min and max; "" if it has."""
    whole = _untruncated(distribution, own)
    low, high = distribution.ends
    if max(whole.cdf(high) - whole.cdf(low), whole.sf(low) - whole.sf(high)) > LEAST_PROBABILITY:
        return ""
    ends = " and ".join(f"{key} {end:g}" for key, end in (("min", low), ("max", high)) if np.isfinite(end))
    return (
        f"must leave values between min and max: nearer to its mean, {whole.mean():g} with a standard deviation of "
        f"{whole.std():g}, found {ends}"
    )


def moved_mean(distribution: Distribution, own: float) -> tuple[float, float] | None:
    """Return the mean before and after truncation; None if they differ by less than a tenth of the deviation."""
    if np.isinf(distribution.ends).all():
        return None
    whole = _untruncated(distribution, own)
    before, after = float(whole.mean()), float(quantiles(distribution, MIDDLES, own).mean())
    return (before, after) if abs(after - before) > MOVED * whole.std() else None


# Designs are sampled one after the other, and scipy takes long to make a distribution and to ask it.
@lru_cache(maxsize=64)
def _truncated(distribution: Distribution, own: float) -> tuple[Callable[[Floats], Any], float, float]:
    """Return the inverse of a distribution function or, for an upper tail, of its complement, and both their ends."""
    whole = _untruncated(distribution, own)
    low, high = distribution.ends
    # A distribution function that is near 1 has no digits left for the upper tail.
    upper = whole.cdf(low) > 0.5
    chance, value = (whole.sf, whole.isf) if upper else (whole.cdf, whole.ppf)
    return value, chance(low), chance(high)


@lru_cache(maxsize=64)
def _untruncated(distribution: Distribution, own: float) -> Any:
    """Return the distribution of scipy, without truncation."""
    if distribution.distribution == "uniform":
        low, high = distribution.ends
        return stats.uniform(low, high - low)
    centre, width = centre_and_width(distribution, own)
    if distribution.distribution == "normal":
        return stats.norm(centre, width)
    return stats.lognorm(width, scale=exp(centre))


def centre_and_width(distribution: Distribution, own: float) -> tuple[float, float]:
    """Return mean and standard deviation before truncation; of a lognormal distribution, those of the logarithm."""
    mean, deviation = distribution.moments(own)
    if distribution.distribution != "lognormal":
        return mean, deviation
    return log(mean / hypot(1.0, deviation / mean)), sqrt(log1p((deviation / mean) ** 2))
