"""Bayesian procedure: the velocity whose shot is expected to tell most, given the model's limit and its error.

What it is to tell is V50 or, with a requirement, whether the velocity at which a small part of shots perforates exceeds
the required one.  A shot's gain is the expected reduction of the variance of this target by its result,
Cov(target, result)^2 / Var(result) over the posterior.
"""

import numpy as np
from numpy.typing import NDArray

from armour.analysis.variants import Floats
from armour.planning.procedures import Aim, ShotSettings, narrow_enough
from armour.statistics.posterior import Grid, Posterior, is_above, posterior_of
from armour.statistics.v50 import MAX_VELOCITY_M_S, MIN_VELOCITY_M_S, Shots

Booleans = NDArray[np.bool_]

# Velocities that are examined, and those around the best of them; their range is that of V50 but for a probability at
# each end, the wide one where the scatter is implausible, and some scatters more.
CANDIDATES, TAIL, WIDE_TAIL, SCATTERS = 101, 1e-3, 0.025, 2.0
# Continuations of the firing that are simulated to tell how many shots are still to be expected, the nodes of their
# grid, their velocities and the most shots of each.
FUTURES, FUTURE_NODES, FUTURE_CANDIDATES, MOST_SHOTS = 40, (101, 11), 61, 100


def posterior(shots: Shots, settings: ShotSettings) -> Posterior:
    """Return the posterior given the shots; the settings must have a prior."""
    assert settings.prior is not None
    return posterior_of(settings.prior, shots.velocities_m_s, shots.complete)


def next_velocity(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot."""
    return aim(posterior(shots, settings), settings)


def aim(known: Posterior, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot, given the posterior."""
    wanted = target(known.grid, settings)
    velocities = candidates(known, settings, CANDIDATES)
    step = velocities[1] - velocities[0]
    for _ in range(2):
        gained = gains(known.weights[None], wanted, known.grid.response(velocities))[0]
        best = float(velocities[np.argmax(gained)])
        velocities = np.clip(np.linspace(best - step, best + step, 21), MIN_VELOCITY_M_S, MAX_VELOCITY_M_S)
    before = known.variance(wanted)
    after = max(before - float(gained.max()), 0.0)
    if settings.requirement_m_s is None:
        reason = (
            f"expected to narrow the standard deviation of V50 most, from {before**0.5:.1f} to {after**0.5:.1f} m/s"
        )
    else:
        reason = "expected to tell most about whether the requirement is met"
    return Aim(best, reason)


def stopped(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    return ended(posterior(shots, settings), settings)


def ended(known: Posterior, settings: ShotSettings) -> str:
    """Return why the firing ends, given the posterior; "" if it goes on."""
    if settings.requirement_m_s is None:
        return narrow_enough(known.estimate(settings.confidence).v50_interval_m_s, settings)
    met = known.probability_above(settings.requirement_m_s, settings.requirement_fraction)
    if 1.0 - settings.confidence < met < settings.confidence:
        return ""
    answer = "met" if met > 0.5 else "not met"
    return f"the requirement is {answer} with a probability of {100.0 * settings.confidence:g} % or more"


def target(grid: Grid, settings: ShotSettings) -> Floats:
    """Return what is to become known, at the points of a grid."""
    if settings.requirement_m_s is None:
        return grid.v50_m_s
    return is_above(grid, settings.requirement_m_s, settings.requirement_fraction)


def gains(weights: Floats, target: Floats, response: Floats) -> Floats:
    """Return the reduction of the variance of a target, (points,), that shots at m velocities are expected to give.

    The weights of n distributions, (n, points), and the response at the velocities, (m, points), give (n, m).
    """
    probability = _product(weights, response).clip(1e-12, 1.0 - 1e-12)
    mean = weights @ target
    covariance = _product(weights * (target - mean[:, None]), response)
    gained: Floats = covariance**2 / (probability * (1.0 - probability))
    return gained


def _product(weights: Floats, response: Floats) -> Floats:
    """Return the sums over the points, (n, m)."""
    # On a busy machine the threads of the linear algebra cost more than few distributions are worth.
    few = len(weights) <= FUTURES
    product: Floats = np.einsum("np,mp->nm", weights, response) if few else weights @ response.T
    return product


def candidates(known: Posterior, settings: ShotSettings, count: int) -> Floats:
    """Return velocities to choose from, evenly spaced, m/s."""
    assert settings.prior is not None
    scatter, greatest = float(known.weights @ known.grid.scatter_m_s), settings.prior.greatest_scatter_m_s()
    # Shots that contradict each other give a scatter beyond the prior, which is no reason to aim far away.
    tail = TAIL if scatter <= greatest else WIDE_TAIL
    low, high = known.grid.v50_quantiles(known.weights, (tail, 1.0 - tail))[0]
    scatter = SCATTERS * min(scatter, greatest)
    return np.linspace(max(low - scatter, MIN_VELOCITY_M_S), min(high + scatter, MAX_VELOCITY_M_S), count)


class Firings:
    """Many firings at once, each with a posterior over the points of one grid."""

    def __init__(self, known: Posterior, settings: ShotSettings, count: int, velocities: int) -> None:
        self.settings, self.grid = settings, known.grid
        self.weights = np.tile(known.weights, (count, 1))
        self.velocities = candidates(known, settings, velocities)
        self.response = known.grid.response(self.velocities)
        self.target = target(known.grid, settings)

    def aims(self) -> Floats:
        """Return the next velocity of each firing."""
        best: Floats = self.velocities[gains(self.weights, self.target, self.response).argmax(axis=1)]
        return best

    def add(self, velocities: Floats, complete: Booleans) -> None:
        """Add a shot to each firing."""
        response = self.grid.response(velocities)
        self.weights *= np.where(complete[:, None], response, 1.0 - response)
        self.weights /= self.weights.sum(axis=1, keepdims=True)

    def intervals(self) -> Floats:
        """Return the ends of the interval of V50 of each firing, (n, 2)."""
        half = 0.5 * self.settings.confidence
        return self.grid.v50_quantiles(self.weights, (0.5 - half, 0.5 + half))

    def ended(self) -> Booleans:
        """Return whether each firing ends."""
        if self.settings.requirement_m_s is None:
            low, high = self.intervals().T
            half = self.settings.half_width_m_s
            return np.asarray(0.5 * (high - low) <= (np.inf if half is None else half))
        met, sure = self.weights @ self.target, self.settings.confidence
        return np.asarray((met >= sure) | (met <= 1.0 - sure))

    def keep(self, which: Booleans) -> None:
        """Keep some of the firings."""
        self.weights = self.weights[which]


def expected_shots(shots: Shots, settings: ShotSettings) -> float | None:
    """Return the median number of further shots in simulated continuations; None where it exceeds the most."""
    assert settings.prior is not None
    known = posterior_of(settings.prior, shots.velocities_m_s, shots.complete, FUTURE_NODES)
    dice = np.random.default_rng(0)
    truths = dice.choice(len(known.weights), FUTURES, p=known.weights)
    v50, scatter = known.grid.v50_m_s[truths], known.grid.scatter_m_s[truths]
    firings, needed = Firings(known, settings, FUTURES, FUTURE_CANDIDATES), np.full(FUTURES, np.inf)
    going = np.arange(FUTURES)
    for number in range(MOST_SHOTS + 1):
        over = firings.ended()
        needed[going[over]] = number
        # More than half of them tell the median.
        going = going[~over]
        if len(going) < FUTURES / 2:
            break
        firings.keep(~over)
        velocities = firings.aims()
        firings.add(velocities, dice.normal(v50[going], scatter[going]) < velocities)
    median = float(np.median(needed))
    return median if np.isfinite(median) else None
