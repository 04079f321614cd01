"""Decide from shots alone, at stated risks, whether a requirement is met.

The requirement is that the velocity at which a fraction of shots perforates exceeds the required one.  The evidence
that it is met is the likelihood of the shots averaged over curves that meet it, divided by the greatest likelihood of a
curve that does not.  If the requirement is not met, this ratio ever exceeds 1/risk with a probability of at most
`risk`, whatever rule chooses the velocities and ends the firing [Wasserman2020].  The same holds with the sides
exchanged.

The logarithm of the likelihood of normal curves is concave in intercept and slope, in which each side is convex.
Wherever the ratio exceeds 1, the likeliest curve of the other side is therefore one that just meets the requirement.
"""

from collections.abc import Sequence
from functools import lru_cache
from math import log
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from armour.analysis.variants import Floats
from armour.statistics.posterior import Posterior, V50Grid, normalised

# Nodes of the distance between the velocity in question and the required one, and of the scatter.  The distance, in
# scatters, is the hyperbolic sine of a normal variable with the standard deviation SPREAD, up to FARTHEST; the scatter
# is log-normal, up to DEVIATIONS.
NODES, SPREAD, FARTHEST, DEVIATIONS = (30, 7), 1.6, 4.2, 2.4
# Curves that just meet the requirement: nodes of their scatter, its range in units of the required velocity, and the
# weight of each curve, negligible in the average.
EDGE_NODES, EDGE_SCATTERS, EDGE_WEIGHT = 41, (1e-3, 0.5), 1e-12


class Demand(NamedTuple):
    """Curves that meet a requirement, do not meet it, or just meet it; the last count half on either side."""

    grid: V50Grid
    log_weights: Floats  # (points,)
    met: Floats  # (points,): 1 where a curve meets it, 0 where it does not, 0.5 where it just does

    def posterior(self, velocities_m_s: Sequence[float], complete: Sequence[bool]) -> Posterior:
        """Return the curves with their weights given shots, of which there may be none."""
        return Posterior(self.grid, normalised(self.log_weights + self.grid.log_likelihood(velocities_m_s, complete)))

    def ratios(self, weights: Floats) -> Floats:
        """Return the evidence for and against the requirement by n distributions, (n, points) -> (n, 2)."""
        edge = weights[:, self.met == 0.5].max(axis=1) / EDGE_WEIGHT
        sides = np.column_stack([weights @ (self.met == 1.0), weights @ (self.met == 0.0)])
        return 2.0 * sides / np.maximum(edge, 1e-290)[:, None]


@lru_cache(maxsize=4)
def demand_of(requirement_m_s: float, fraction: float, scatter_m_s: float, scatter_factor: float) -> Demand:
    """Return the curves for a requirement; the expected scatter affects only how many shots are needed."""
    position = np.linspace(-FARTHEST, FARTHEST, NODES[0])
    deviation = np.linspace(-DEVIATIONS, DEVIATIONS, NODES[1])
    distance = np.append(np.repeat(np.sinh(position), NODES[1]), np.zeros(EDGE_NODES))
    edge_scatters = requirement_m_s * np.geomspace(*EDGE_SCATTERS, EDGE_NODES)
    scatter = np.append(np.tile(scatter_m_s * np.exp(log(scatter_factor) * deviation), NODES[0]), edge_scatters)
    weights = np.exp(-0.5 * np.add.outer((position / SPREAD) ** 2, deviation**2)).ravel()
    weights = np.append(weights / weights.sum(), np.full(EDGE_NODES, EDGE_WEIGHT))
    grid = V50Grid(requirement_m_s + (distance - float(ndtri(fraction))) * scatter, scatter, (1, len(scatter)))
    return Demand(grid, np.log(weights), 0.5 + 0.5 * np.sign(distance))
