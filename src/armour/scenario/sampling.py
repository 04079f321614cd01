"""Samples of uncertain inputs: points of the unit cube, quantiles of the distributions and a Gaussian copula."""

from collections.abc import Mapping
from math import hypot, log1p, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from armour.scenario.distributions import Distribution, Uncertainty, correlation_matrix

Floats = NDArray[np.float64]


def points_of(uncertainty: Uncertainty) -> Floats:
    """Return points within the unit cube, shape (samples, inputs): a scrambled Sobol' sequence or a Latin hypercube."""
    width = len(uncertainty.inputs())
    rng = np.random.default_rng(uncertainty.seed)
    if uncertainty.method == "sobol":
        points = qmc.Sobol(width, rng=rng).random_base2((uncertainty.samples - 1).bit_length())
    else:
        points = qmc.LatinHypercube(width, rng=rng).random(uncertainty.samples)
    # The quantile at 0 of an unbounded distribution is infinite.
    return np.clip(points, 2.0**-53, 1.0 - 2.0**-53, out=points)


def columns_of(uncertainty: Uncertainty, own: Mapping[str, float], points: Floats) -> dict[str, Floats]:
    """Return values of the uncertain inputs, shape (n,), at points of the unit cube, shape (n, inputs).

    A Gaussian copula correlates them.  `own` are the scenario's own values by name of input.
    """
    inputs = uncertainty.inputs()
    if uncertainty.correlation:
        factor = np.linalg.cholesky(correlation_matrix(list(inputs), uncertainty.correlation))
        points = ndtr(ndtri(points) @ factor.T)
    return {
        name: quantiles(distribution, points[:, i], own[name]) for i, (name, distribution) in enumerate(inputs.items())
    }


def quantiles(distribution: Distribution, probabilities: ArrayLike, own: float) -> Floats:
    """Return quantiles of a truncated distribution, in the shape of `probabilities`.

    `own` is the scenario's own value of the input, which is the mean if none is given.  If it cannot be a mean, such as
    the thickness 0 of an absent layer, all quantiles are equal to it.
    """
    if distribution.mean_problem(own):
        return np.full(np.shape(probabilities), own)
    whole = _untruncated(distribution, own)
    low = -np.inf if distribution.min is None else distribution.min
    high = np.inf if distribution.max is None else distribution.max
    below, above = float(whole.cdf(low)), float(whole.cdf(high))
    found: Floats = np.clip(whole.ppf(below + np.asarray(probabilities) * (above - below)), low, high)
    return found


def _untruncated(distribution: Distribution, own: float) -> Any:
    """Return the distribution of scipy, without truncation."""
    if distribution.distribution == "uniform":
        assert distribution.min is not None
        assert distribution.max is not None
        return stats.uniform(distribution.min, distribution.max - distribution.min)
    mean = own if distribution.mean is None else distribution.mean
    percent = distribution.standard_deviation_percent
    deviation = abs(mean) * percent / 100.0 if percent is not None else distribution.standard_deviation
    assert deviation is not None
    if distribution.distribution == "normal":
        return stats.norm(mean, deviation)
    shape = sqrt(log1p((deviation / mean) ** 2))
    return stats.lognorm(shape, scale=mean / hypot(1.0, deviation / mean))
