"""Posterior of V50 and of the scatter from firing results, given the model's ballistic limit and its error.

The probability of complete penetration at a velocity V is F((V - V50)/scatter), F the normal distribution function.
The prior of V50 is the model's limit with the distribution of its error, cut off below 1 % of the limit.  The ratio of
the scatter to V50 has a log-normal prior, independent of V50.  Integrals are sums over a grid, not random samples.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import log
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import log_ndtr, ndtr, ndtri

from armour.analysis.variants import Floats
from armour.evidence.model_error import SCATTER_FACTOR, SCATTER_PERCENT, ModelError

# Probability of V50 beyond each end of the first grid, and the multiples of the limit that bound its ends.
GRID_TAIL, LEAST_MULTIPLE, GREATEST_MULTIPLE = 1e-9, 0.01, 10.0
# Factor by which the first grid reaches beyond the shots.
GRID_BEYOND = 2.0
# A posterior median outside the prior's interval with this probability contradicts the prior.
PLAUSIBLE = 0.99
# Reach of the first grid of the logarithm of the scatter to either side, in its standard deviations.
SCATTER_ENDS = 7.0
# Nodes of V50 and of the scatter.  The grid is narrowed, at most GRID_NARROWINGS times, to the nodes where the
# logarithm of the posterior is within DEPTH of its maximum, until these are at least the fraction ENOUGH of its nodes.
GRID_NODES, GRID_NARROWINGS, DEPTH, ENOUGH = (201, 31), 6, 12.0, 0.75


def _normal_quantiles(probabilities: Floats) -> Floats:
    """Return standard normal quantiles, of probabilities clipped so that all are finite."""
    return ndtri(probabilities.clip(1e-15, 1.0 - 1e-15))


@dataclass(frozen=True)
class FiringEstimate:
    """V50 and the scatter of a prior or posterior.

    Attributes
    ----------
    v50_m_s : float
        Median of V50, m/s.
    v50_interval_m_s : tuple of float
        Equal-tailed interval of V50, m/s.
    standard_deviation_m_s : float
        Standard deviation of the distribution of V50, m/s.
    scatter_m_s : float
        Median of the scatter, the standard deviation of the response curve, m/s.
    scatter_interval_m_s : tuple of float
        Equal-tailed interval of the scatter, m/s.
    """

    v50_m_s: float
    v50_interval_m_s: tuple[float, float]
    standard_deviation_m_s: float
    scatter_m_s: float
    scatter_interval_m_s: tuple[float, float]


class FiringPrior(NamedTuple):
    """Prior of V50 and of the scatter."""

    limit_m_s: float  # ballistic limit by the model
    error: ModelError
    scatter_percent: float = SCATTER_PERCENT
    scatter_factor: float = SCATTER_FACTOR

    @property
    def plausible_factor(self) -> float:
        """Greatest factor by which the scatter may exceed the expected one without contradicting the prior."""
        return self.scatter_factor ** float(ndtri(0.5 + 0.5 * PLAUSIBLE))

    def log_density(self, v50: Floats, log_ratio: Floats) -> Floats:
        """Return the log-density, up to a constant, at n V50s, m/s, and n logarithms of scatter / V50, (n,)."""
        z = (log_ratio - log(self.scatter_percent / 100.0)) / log(self.scatter_factor)
        return self.error.ratio.log_density(v50 / self.limit_m_s) - 0.5 * z * z


def normalised(log_weights: Floats) -> Floats:
    """Return weights, (points,), that add up to 1, given their logarithms up to a constant."""
    weights = np.exp(log_weights - log_weights.max())
    return weights / weights.sum()


def expected(values: Floats, weights: Floats) -> Any:
    """Return the mean of values at the points of a grid, (points,), under each of n distributions, as (n,).

    `weights`, (n, points), are the probabilities of the points; for one distribution, (points,), the mean is a number.
    Values may differ from distribution to distribution, (n, points).

    Unlike in matrix products, the sums do not depend on the number of threads.
    """
    return np.einsum("...p,...p->...", values, weights)


class V50Grid(NamedTuple):
    """Points of V50 and scatter, m/s, on a grid, each a response curve; the scatter varies fastest."""

    v50_m_s: Floats  # (points,)
    scatter_m_s: Floats  # (points,)
    shape: tuple[int, int]  # nodes of V50 and of the scatter

    def log_likelihood(self, velocities_m_s: Sequence[float], complete: Sequence[bool]) -> Floats:
        """Return the log-likelihood of shots, m/s, by each point, (points,).

        `complete` is true for complete penetrations.
        """
        log_likelihood = np.zeros(len(self.v50_m_s))
        for velocity, result in zip(velocities_m_s, complete, strict=True):
            argument = (velocity - self.v50_m_s) / self.scatter_m_s
            log_likelihood += log_ndtr(argument if result else -argument)
        return log_likelihood

    def response(self, velocities_m_s: Floats) -> Floats:
        """Return the probability of complete penetration at m velocities by each point, (m, points)."""
        return ndtr((velocities_m_s[:, None] - self.v50_m_s) / self.scatter_m_s)

    def v50_quantiles(self, weights: Floats, probabilities: Sequence[float]) -> Floats:
        """Return the quantiles of V50, m/s, at k probabilities under each of n distributions, (n, k).

        `weights`, (n, points) or (points,), are the probabilities of the points.
        """
        nodes = self.v50_m_s[:: self.shape[1]]
        node_weights = weights.reshape(-1, *self.shape).sum(axis=2)
        # On the scale of the normal distribution, a cumulative probability is nearly linear even between few nodes.
        middles = _normal_quantiles(np.cumsum(node_weights, axis=1) - 0.5 * node_weights)
        return np.array([np.interp(ndtri(probabilities), scores, nodes) for scores in middles])


class Posterior(NamedTuple):
    """Distribution of V50 and the scatter: a grid with the probability of each point."""

    grid: V50Grid
    weights: Floats  # (points,)

    def estimate(self, confidence: float) -> FiringEstimate:
        """Return medians and intervals of V50 and the scatter, and the standard deviation of V50, m/s."""
        probabilities = (0.5, 0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence)
        v50, slowest, fastest = self.grid.v50_quantiles(self.weights, probabilities)[0].tolist()
        scatter, least, greatest = self._scatter_quantiles(probabilities)
        deviation = self.variance(self.grid.v50_m_s) ** 0.5
        return FiringEstimate(v50, (slowest, fastest), deviation, scatter, (least, greatest))

    def _scatter_quantiles(self, probabilities: Sequence[float]) -> list[float]:
        """Return quantiles of the scatter, m/s; each point represents the scatters up to midway to the next ones."""
        logs = np.log(self.grid.scatter_m_s)
        step = logs[1] - logs[0]
        log_scatters = np.linspace(logs.min() - 0.5 * step, logs.max() + 0.5 * step, 2 * self.grid.shape[1])
        shares = np.clip(0.5 + (log_scatters[:, None] - logs) / step, 0.0, 1.0)
        below = np.array([expected(share, self.weights) for share in shares])
        return np.exp(np.interp(ndtri(probabilities), _normal_quantiles(below), log_scatters)).tolist()

    def variance(self, target: Floats) -> float:
        """Return the variance of a quantity whose values at the points are `target`, (points,)."""
        return float(expected((target - expected(target, self.weights)) ** 2, self.weights))

    def density(self, velocities_m_s: Floats) -> Floats:
        """Return the probability density of V50 at velocities, m/s, (n,), in s/m; it is 0 beyond the grid."""
        nodes = self.grid.v50_m_s[:: self.grid.shape[1]]
        node_weights = self.weights.reshape(self.grid.shape).sum(axis=1)
        return np.interp(velocities_m_s, nodes, node_weights / (nodes[1] - nodes[0]), left=0.0, right=0.0)

    def probability_above(self, velocity_m_s: float, fraction: float) -> float:
        """Return the probability that the velocity at which `fraction` of shots perforate exceeds `velocity_m_s`."""
        excess = self.grid.v50_m_s + float(ndtri(fraction)) * self.grid.scatter_m_s - velocity_m_s
        step = np.diff(self.grid.v50_m_s[:: self.grid.shape[1]]).mean()
        # Near the velocity, the share of a point changes linearly over the distance of two neighbouring V50s.
        return float(expected(np.clip(0.5 + excess / step, 0.0, 1.0), self.weights))


def posterior_of(
    prior: FiringPrior, velocities_m_s: Sequence[float], complete: Sequence[bool], nodes: tuple[int, int] = GRID_NODES
) -> Posterior:
    """Return the posterior of V50 and the scatter given shots, of which there may be none.

    The shots have `velocities_m_s`, and `complete` is true for complete penetrations; `nodes` are the numbers of V50s
    and of scatters in the grid.
    """
    limit, velocities = prior.limit_m_s, np.array(velocities_m_s)
    low, high = prior.error.interval(limit, GRID_TAIL)
    # The first range of V50 includes shots far from the prior.
    low = max((velocities / GRID_BEYOND).min(initial=low), LEAST_MULTIPLE * limit)
    high = (velocities * GRID_BEYOND).max(initial=min(high, GREATEST_MULTIPLE * limit))
    reach, middle = SCATTER_ENDS * log(prior.scatter_factor), log(prior.scatter_percent / 100.0)
    ranges = [(low, high), (middle - reach, middle + reach)]
    for _ in range(GRID_NARROWINGS):
        v50, log_ratio = (np.linspace(*ends, count) for ends, count in zip(ranges, nodes, strict=True))
        grid = V50Grid(np.repeat(v50, nodes[1]), np.outer(v50, np.exp(log_ratio)).ravel(), nodes)
        log_weights = prior.log_density(grid.v50_m_s, np.tile(log_ratio, nodes[0]))
        log_weights += grid.log_likelihood(velocities_m_s, complete)
        kept = (log_weights > log_weights.max() - DEPTH).reshape(nodes)
        kept_v50, kept_scatter = kept.any(axis=1), kept.any(axis=0)
        # With nodes of V50 too far apart, the scatter seems large: its range is narrowed only after that of V50.
        if kept_v50.mean() < ENOUGH:
            ranges[0] = narrowed(v50, kept_v50)
        elif kept_scatter.mean() < ENOUGH:
            ranges[1] = narrowed(log_ratio, kept_scatter)
        else:
            break
    return Posterior(grid, normalised(log_weights))


def narrowed(axis: Floats, kept: ArrayLike) -> tuple[float, float]:
    """Return the range of nodes, (n,), ascending, from one before the first `kept`, (n,), to one after the last."""
    indices = np.flatnonzero(kept)
    return float(axis[max(indices[0] - 1, 0)]), float(axis[min(indices[-1] + 1, len(axis) - 1)])


def learned(
    prior: Posterior, posterior: Posterior, confidence: float
) -> tuple[FiringEstimate, FiringEstimate, float, tuple[str, ...]]:
    """Return the estimates by prior and posterior, the prior's share in the precision of V50, 0 to 1, and warnings.

    The precision is the inverse of the variance.  There is a warning for each quantity in which the shots contradict
    the prior.  `confidence` is the level of the intervals.
    """
    before, after = prior.estimate(confidence), posterior.estimate(confidence)
    share = min(1.0, (after.standard_deviation_m_s / before.standard_deviation_m_s) ** 2)
    return before, after, share, tuple(_contradictions(prior, posterior))


def _contradictions(prior: Posterior, posterior: Posterior) -> Iterator[str]:
    """Yield a warning if the posterior median of V50 or of the scatter lies outside the prior's plausible interval."""
    before, after = prior.estimate(PLAUSIBLE), posterior.estimate(PLAUSIBLE)
    v50, scatter = (after.v50_m_s, before.v50_interval_m_s), (after.scatter_m_s, before.scatter_interval_m_s)
    for name, (value, (low, high)) in {"V50": v50, "scatter": scatter}.items():
        if not low <= value <= high:
            yield (
                f"the shots contradict the prior: with them the {name} is {value:.1f} m/s, beyond its "
                f"{100.0 * PLAUSIBLE:g} % interval by the prior, {low:.1f} to {high:.1f} m/s; "
                "check their velocities, unit and results, and the armour and projectile"
            )
