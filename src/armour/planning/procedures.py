"""Rules for the next velocity of a V50 firing and for its end: up and down, Langlie's, Neyer's and the Bayesian one.

The Bayesian procedure fires the shot that is expected to be most informative, given the model's limit and its error.
The target is V50 or, with a requirement, whether the velocity at which a small part of shots perforates exceeds the
required one.  A shot's gain is the expected reduction of the variance of this target by its result,
Cov(target, result)^2 / Var(result) over the posterior.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import copysign, inf, isfinite
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr, ndtri

from armour.analysis.variants import Bools, Floats, Ints
from armour.errors import NoAnswerError
from armour.planning.acceptance import Demand, demand_of
from armour.statistics.curves import FittedCurve, ShotLikelihood, fit_curve
from armour.statistics.posterior import (
    NODES,
    PLAUSIBLE,
    SCATTER_FACTOR,
    FiringPrior,
    Posterior,
    V50Grid,
    expected,
    is_above,
    posterior_of,
)
from armour.statistics.v50 import MAX_VELOCITY_M_S, MIN_VELOCITY_M_S, SPANS_M_S, MeanV50, Shots, mean_v50


class ShotSettings(NamedTuple):
    """Settings of a procedure; velocities in m/s."""

    estimate_m_s: float  # of V50: the model's ballistic limit
    scatter_m_s: float  # guess of the standard deviation of the response curve
    limits_m_s: tuple[float, float] = (-inf, inf)  # of V50; for Langlie's and Neyer's procedures
    half_width_m_s: float | None = None  # of the interval of V50 at which the firing ends; None: the rule's own end
    confidence: float = 0.95
    requirement_m_s: float | None = None
    requirement_fraction: float = 0.5  # part of shots that may perforate at the requirement
    scatter_factor: float = SCATTER_FACTOR  # by which the scatter may differ from the guess
    prior: FiringPrior | None = None  # for the Bayesian procedure
    by_prior: bool = False  # whether the prior takes part in the decision on a requirement

    def demand(self) -> Demand | None:
        """Return the requirement on which the shots alone decide; None if there is none."""
        if self.requirement_m_s is None or self.by_prior:
            return None
        return demand_of(self.requirement_m_s, self.requirement_fraction, self.scatter_m_s, self.scatter_factor)


class Aim(NamedTuple):
    """Velocity of the next shot, m/s, and why."""

    velocity_m_s: float
    why: str


def recommended_fit(shots: Shots, confidence: float) -> FittedCurve | None:
    """Return the probit curve of the penalised likelihood; None if the shots have none."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if not partial or not complete:
        return None
    try:
        return fit_curve(partial, complete, "probit", confidence, penalised=True)
    except NoAnswerError:
        return None


def narrow_enough(interval: tuple[float | None, float | None], settings: ShotSettings) -> str:
    """Return that an interval of V50 is as narrow as required; "" if it is not."""
    low, high = interval
    if settings.half_width_m_s is None or low is None or high is None or 0.5 * (high - low) > settings.half_width_m_s:
        return ""
    return f"the interval of V50 is within ± {settings.half_width_m_s:g} m/s"


def stopped(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    fit = None if settings.half_width_m_s is None else recommended_fit(shots, settings.confidence)
    return "" if fit is None else narrow_enough(fit.v50_interval_m_s, settings)


FEET_M = 0.3048
ABOVE_M_S, FIRST_STEP_M_S, STEP_M_S = 75.0 * FEET_M, 100.0 * FEET_M, 50.0 * FEET_M
# Shots of each kind in the mean that ends the firing.
PAIRS = 3


def next_up_and_down(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by the up-and-down rule of MIL-STD-662F [DoD1997].

    The first shot is at the estimated V50 or, where a velocity is required, 75 ft/s above it.  After a complete
    penetration the next shot is slower than this one was, after a partial penetration faster: by 100 ft/s until there
    is a shot of each kind, then by 50 ft/s.  It ends with as many shots of each kind as the mean needs, within its
    usual span.
    """
    if not shots.complete:
        if settings.requirement_m_s is None:
            return Aim(settings.estimate_m_s, "the first shot is at the estimated V50")
        return Aim(settings.requirement_m_s + ABOVE_M_S, f"the first shot is {ABOVE_M_S:.1f} m/s above the requirement")
    step = STEP_M_S if len(set(shots.complete)) == 2 else FIRST_STEP_M_S
    last, complete = shots.velocities_m_s[-1], shots.complete[-1]
    way, kind = ("below", "complete") if complete else ("above", "partial")
    reason = f"{step:.1f} m/s {way} the last shot, a {kind} penetration"
    return Aim(last - step if complete else last + step, reason)


def stopped_up_and_down(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    if settings.half_width_m_s is not None:
        return stopped(shots, settings)
    if mean_of(shots) is None:
        return ""
    return f"{PAIRS} partial and {PAIRS} complete penetrations lie within {SPANS_M_S[PAIRS]:g} m/s"


def mean_of(shots: Shots) -> MeanV50 | None:
    """Return the mean of MIL-STD-662F that ends the firing; None without such shots within its span."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    return mean_v50(partial, complete, PAIRS) if partial and complete else None


# This many last shots of one kind, the next within this part of the limits of one of them, leave it in doubt.
ALIKE, NEAR = 5, 0.02


def next_by_langlie(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by Langlie's one-shot test [Langlie1962].

    The first shot is midway between the limits.  Each further one is midway between the last shot and the latest shot
    from which on as many penetrations were complete as partial; where there is none, midway between the last shot and
    the lower limit after a complete, the upper limit after a partial penetration.
    """
    lower, upper = settings.limits_m_s
    if not shots.complete:
        return Aim(0.5 * (lower + upper), "the first shot is midway between the limits")
    velocities, last = shots.velocities_m_s, shots.velocities_m_s[-1]
    excess = 0  # of complete over partial penetrations
    for number in range(len(velocities), 0, -1):
        excess += 1 if shots.complete[number - 1] else -1
        if excess == 0:
            reason = (
                f"midway between the last shot and shot {number}, from which on half of the penetrations are complete"
            )
            return Aim(0.5 * (last + velocities[number - 1]), reason)
    end, name = (lower, "lower") if shots.complete[-1] else (upper, "upper")
    return Aim(0.5 * (last + end), f"midway between the last shot and the {name} limit, {end:.1f} m/s")


def langlie_doubts(shots: Shots, settings: ShotSettings) -> Iterator[str]:
    """Give a warning if the shots leave the limits or stay at one."""
    lower, upper = settings.limits_m_s
    velocity, last = next_by_langlie(shots, settings).velocity_m_s, shots.complete[-ALIKE:]
    if not lower <= velocity <= upper:
        yield f"the next velocity, {velocity:.1f} m/s, is outside the limits, {lower:.1f} to {upper:.1f} m/s"
    end, name = (lower, "lower") if shots.complete and last[-1] else (upper, "upper")
    if len(last) == ALIKE and len({*last}) == 1 and abs(velocity - end) < NEAR * (upper - lower):
        kind = "complete" if last[-1] else "partial"
        yield (
            f"the last {ALIKE} shots, all {kind}, have reached the {name} limit, {end:.1f} m/s: V50 may lie beyond it; "
            "give other limits"
        )


REDUCTION = 0.8
# Arguments of the normal distribution function at which the gain in information is examined.
ARGUMENTS = np.arange(-4000, 4001) / 1000.0
# The best argument if a constant probability, an infinite scatter, fits the shots best.
FLAT = 1.31525757633905


def _weights(z: Floats) -> Floats:
    """Return the Fisher information of shots on the argument of the normal distribution function."""
    return np.exp(-z * z - np.log(2.0 * np.pi) - log_ndtr(z) - log_ndtr(-z))


INFORMATION = _weights(ARGUMENTS)


def next_by_neyer(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by Neyer's D-optimal test [Neyer1994].

    1. A binary search finds shots of both kinds, and brings their velocities within the guess of the scatter.
    2. Until shots of the two kinds overlap, so that V50 and scatter have unique estimates of maximum likelihood, V50 is
       taken midway between the kinds; the guess of the scatter is reduced by a factor of 0.8 with each shot.
    3. The estimates are those of maximum likelihood, V50 within and the scatter no more than the range of the shots.

    In parts 2 and 3 the next velocity is the one that makes the determinant of the Fisher information greatest.
    """
    lower, upper = settings.limits_m_s
    velocities, complete = shots.velocities_m_s, shots.complete
    if not complete:
        return Aim(0.5 * (lower + upper), "binary search: the first shot is midway between the limits")
    guess = settings.scatter_m_s
    slowest, fastest = min(velocities), max(velocities)
    if len(set(complete)) == 1:
        reason = "binary search: no shot of the other kind yet"
        if complete[0]:
            return Aim(min(0.5 * (lower + slowest), slowest - 2.0 * guess, 2.0 * slowest - fastest), reason)
        return Aim(max(0.5 * (upper + fastest), fastest + 2.0 * guess, 2.0 * fastest - slowest), reason)
    gaps = _gaps(shots)
    # Each earlier shot of part 2 has reduced the guess.
    for gap in gaps[:-1]:
        if 0.0 <= gap <= guess:
            guess *= REDUCTION
    highest, lowest = shots.of(complete=False)[-1], shots.of(complete=True)[0]
    middle, span = 0.5 * (highest + lowest), fastest - slowest
    if gaps[-1] > guess:
        return Aim(middle, "binary search: midway between the highest partial and the lowest complete penetration")
    if gaps[-1] >= 0.0:
        scatter = min(guess, span) or guess  # a shot of each kind at one velocity has no span
        return Aim(_best(velocities, middle, scatter), f"D-optimal for a guessed scatter of {scatter:.1f} m/s")
    partial, completes = shots.of(complete=False), shots.of(complete=True)
    if np.mean(completes) <= np.mean(partial):
        v50 = min(max(middle, slowest), fastest)
        return Aim(v50 + copysign(FLAT * span, -1.0 if complete[-1] else 1.0), "the shots have no rising curve")
    curve = ShotLikelihood(partial, completes, "probit")
    intercept, slope, _ = curve.mode
    v50 = min(max(curve.mean - curve.deviation * intercept / slope, slowest), fastest)
    scatter = min(curve.deviation / slope, span)
    reason = f"D-optimal for the estimates of maximum likelihood, V50 {v50:.1f} and scatter {scatter:.1f} m/s"
    return Aim(_best(velocities, v50, scatter), reason)


def _gaps(shots: Shots) -> list[float]:
    """Return lowest complete less highest partial after each shot from the first of the second kind on, m/s."""
    lowest, highest, gaps = np.inf, -np.inf, []
    for velocity, complete in zip(shots.velocities_m_s, shots.complete, strict=True):
        lowest, highest = (min(lowest, velocity), highest) if complete else (lowest, max(highest, velocity))
        gaps.append(round(float(lowest - highest), 9))
    return [gap for gap in gaps if gap < np.inf]


def _best(velocities: Sequence[float], v50: float, scatter: float) -> float:
    """Return the velocity whose shot makes the determinant of the information on V50 and scatter greatest, m/s."""
    z = (np.array(velocities) - v50) / scatter
    weights = _weights(z)
    zero, one, two = weights.sum(), weights @ z, weights @ (z * z)
    gain = INFORMATION * (zero * ARGUMENTS**2 - 2.0 * one * ARGUMENTS + two)
    return v50 + scatter * float(ARGUMENTS[np.argmax(gain)])


# Number of velocities that are examined; they extend over V50, up to a probability at each end, greater if the scatter
# is implausible, and some scatters more, or over some scatters around a requirement.
CANDIDATES, TAIL, WIDE_TAIL, SCATTERS, AROUND = 101, 1e-3, 0.025, 2.0, 4.0
# Continuations of the firing that are simulated to estimate the number of further shots, the nodes of their grid, the
# number of their velocities and the most shots of each.
FUTURES, FUTURE_NODES, FUTURE_CANDIDATES, MOST_SHOTS = 40, (401, 11), 61, 100
# Multiplications of a product of matrices that is not worth a thread.
SMALL = 2**17
# Another confidence for which the number of shots is estimated.
SOONER = 0.9
# Simulated firings for each point of an operating characteristic, and where these are: the distance of the velocity in
# question from the required one, in scatters.
FIRINGS, DISTANCES = 100, (-3.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0)


def posterior(shots: Shots, settings: ShotSettings, nodes: tuple[int, int] = NODES) -> Posterior:
    """Return the posterior given the shots: without the prior if the requirement is decided without it."""
    if demand := settings.demand():
        return demand.posterior(shots.velocities_m_s, shots.complete)
    assert settings.prior is not None
    return posterior_of(settings.prior, shots.velocities_m_s, shots.complete, nodes)


def next_bayesian(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by the Bayesian procedure."""
    current = posterior(shots, settings)
    quantity = target(current.grid, settings)
    velocities = candidates(current, settings, CANDIDATES)
    step = velocities[1] - velocities[0]
    for _ in range(2):
        gained = gains(current.weights[None], quantity, current.grid.response(velocities))[0]
        best = float(velocities[np.argmax(gained)])
        velocities = np.clip(np.linspace(best - step, best + step, 21), MIN_VELOCITY_M_S, MAX_VELOCITY_M_S)
    if settings.requirement_m_s is not None:
        return Aim(best, "expected to be most informative about whether the requirement is met")
    before = current.variance(quantity)
    after = max(before - float(gained.max()), 0.0)
    change = f"from {before**0.5:.1f} to {after**0.5:.1f} m/s"
    return Aim(best, f"expected to narrow the standard deviation of V50 most, {change}")


def stopped_bayesian(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    current = posterior(shots, settings)
    if settings.requirement_m_s is None:
        return narrow_enough(current.estimate(settings.confidence).v50_interval_m_s, settings)
    [decision] = decisions(current.weights[None], current.grid, settings)
    if decision == 0:
        return ""
    answer = f"the requirement is {'met' if decision > 0 else 'not met'}"
    if settings.by_prior:
        return f"{answer} with a probability of {100.0 * settings.confidence:g} % or more"
    side = "consumer" if decision > 0 else "producer"
    return f"{answer}, at a {side}'s risk of at most {100.0 * (1.0 - settings.confidence):.4g} %"


def decisions(weights: Floats, grid: V50Grid, settings: ShotSettings) -> Ints:
    """Return 1 where a requirement is met, -1 where it is not and 0 where it is open, by n distributions, (n,)."""
    if demand := settings.demand():
        for_it, against = (demand.ratios(weights) * (1.0 - settings.confidence) >= 1.0).T
    else:
        met = expected(target(grid, settings), weights)
        for_it, against = met >= settings.confidence, met <= 1.0 - settings.confidence
    return for_it.astype(int) - against


def target(grid: V50Grid, settings: ShotSettings) -> Floats:
    """Return what is to become known, at the points of a grid."""
    if settings.requirement_m_s is None:
        return grid.v50_m_s
    if demand := settings.demand():
        return demand.met
    return is_above(grid, settings.requirement_m_s, settings.requirement_fraction)


def gains(weights: Floats, target: Floats, response: Floats) -> Floats:
    """Return the reduction of the variance of a target, (points,), that shots at m velocities are expected to give.

    The weights of n distributions, (n, points), and the response at the velocities, (m, points), give (n, m).
    """
    probability = _product(weights, response).clip(1e-12, 1.0 - 1e-12)
    mean = expected(target, weights)
    covariance = _product(weights * (target - mean[:, None]), response)
    return covariance**2 / (probability * (1.0 - probability))


def _product(weights: Floats, response: Floats) -> Floats:
    """Return the sums over the points, (n, m)."""
    if len(weights) > FUTURES:
        return weights @ response.T
    # On a busy machine the threads of the linear algebra cost more than few distributions are worth.
    size = SMALL // (len(weights) * len(response))
    sums = np.zeros((len(weights), len(response)))
    for start in range(0, weights.shape[1], size):
        sums += weights[:, start : start + size] @ response[:, start : start + size].T
    return sums


def candidates(current: Posterior, settings: ShotSettings, count: int) -> Floats:
    """Return velocities to choose from, evenly spaced, m/s."""
    greatest = settings.scatter_m_s * settings.scatter_factor ** float(ndtri(0.5 + 0.5 * PLAUSIBLE))
    scatter = float(expected(current.grid.scatter_m_s, current.weights))
    if settings.demand():
        low = high = settings.requirement_m_s
        reach = AROUND * min(scatter, greatest)
    else:
        # Shots that contradict each other imply a scatter beyond the prior, which is no reason to aim far away.
        tail = TAIL if scatter <= greatest else WIDE_TAIL
        low, high = current.grid.v50_quantiles(current.weights, (tail, 1.0 - tail))[0]
        reach = SCATTERS * min(scatter, greatest)
    return np.linspace(max(low - reach, MIN_VELOCITY_M_S), min(high + reach, MAX_VELOCITY_M_S), count)


class Firings:
    """Many firings at once, each with a posterior over the points of one grid."""

    def __init__(self, current: Posterior, settings: ShotSettings, count: int, velocities: int) -> None:
        self.settings, self.grid = settings, current.grid
        self.weights = np.tile(current.weights, (count, 1))
        self.velocities = candidates(current, settings, velocities)
        self.response = current.grid.response(self.velocities)
        self.target = target(current.grid, settings)

    def aims(self) -> Floats:
        """Return the next velocity of each firing."""
        return self.velocities[gains(self.weights, self.target, self.response).argmax(axis=1)]

    def add(self, velocities: Floats, complete: Bools) -> None:
        """Add a shot to each firing."""
        aims, place = np.unique(velocities, return_inverse=True)
        response = self.grid.response(aims)[place]
        self.weights *= np.where(complete[:, None], response, 1.0 - response)
        self.weights /= self.weights.sum(axis=1, keepdims=True)

    def intervals(self, confidence: float) -> Floats:
        """Return the ends of the interval of V50 of each firing, (n, 2)."""
        return self.grid.v50_quantiles(self.weights, (0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence))

    def ended(self, confidence: float) -> Ints:
        """Return which firings end: 1 if the requirement is met or the interval is narrow, -1 if it is not met.

        Firings that go on have 0.
        """
        settings = self.settings._replace(confidence=confidence)
        if settings.requirement_m_s is not None:
            return decisions(self.weights, self.grid, settings)
        low, high = self.intervals(confidence).T
        return (0.5 * (high - low) <= (settings.half_width_m_s or 0.0)).astype(int)

    def keep(self, which: Bools) -> None:
        """Keep some of the firings."""
        self.weights = self.weights[which]


def fire(
    firings: Firings, v50_m_s: Floats, scatter_m_s: Floats, dice: np.random.Generator, least: int = 1
) -> tuple[Floats, Ints, Floats]:
    """Simulate firings of armours, (n,) each, while at least a number of them go on.

    Return for each the number of shots at which it ended, infinite if it did not, its result, see `Firings.ended`, and
    the number at which it would have ended with a confidence of 90 %.
    """
    shots, sooner = np.full((2, len(v50_m_s)), inf)
    ended = np.zeros(len(v50_m_s), dtype=int)
    going = np.arange(len(v50_m_s))
    for number in range(MOST_SHOTS + 1):
        ended[going] = firings.ended(firings.settings.confidence)
        shots[going[ended[going] != 0]] = number
        early = going[firings.ended(SOONER) != 0]
        sooner[early] = np.minimum(sooner[early], number)
        keep = ended[going] == 0
        going = going[keep]
        if len(going) < least:
            break
        firings.keep(keep)
        velocities = firings.aims()
        firings.add(velocities, dice.normal(v50_m_s[going], scatter_m_s[going]) < velocities)
    return shots, ended, sooner


def expected_shots(shots: Shots, settings: ShotSettings) -> tuple[float | None, float | None]:
    """Return the median number of further shots in simulated continuations, and that with a confidence of 90 %.

    It is None if it exceeds the maximum.
    """
    current = posterior(shots, settings, FUTURE_NODES)
    # A prior that the decision does not use still predicts how long it takes.
    truth = posterior(shots, settings._replace(requirement_m_s=None), FUTURE_NODES) if settings.prior else current
    dice = np.random.default_rng(0)
    truths = dice.choice(len(truth.weights), FUTURES, p=truth.weights)
    v50, scatter = truth.grid.v50_m_s[truths], truth.grid.scatter_m_s[truths]
    # The median is known once half of them have ended.
    firings = Firings(current, settings, FUTURES, FUTURE_CANDIDATES)
    needed, _, sooner = fire(firings, v50, scatter, dice, least=FUTURES // 2)
    return _median(needed), _median(sooner)


def _median(shots: Floats) -> float | None:
    """Return the median of numbers of shots; None if it is infinite."""
    median = float(np.median(shots))
    return median if isfinite(median) else None


@dataclass(frozen=True)
class OperatingPoint:
    """Outcome of simulated firings at an armour.

    Attributes
    ----------
    v50_m_s, scatter_m_s : float
        V50 of the armour and its scatter, m/s.
    met, not_met : float
        Fractions of firings that end with the requirement met, and not met; the others do not end within 100 shots.
    shots : float or None
        Median number of shots; None if it exceeds 100.
    """

    v50_m_s: float
    scatter_m_s: float
    met: float
    not_met: float
    shots: float | None


def operating_characteristic(settings: ShotSettings) -> tuple[OperatingPoint, ...]:
    """Simulate firings at armours around a requirement, whose scatter is the expected one."""
    assert settings.requirement_m_s is not None
    current, scatter = posterior(Shots((), ()), settings, FUTURE_NODES), settings.scatter_m_s
    edge = settings.requirement_m_s - float(ndtri(settings.requirement_fraction)) * scatter
    points = edge + scatter * np.array(DISTANCES)
    armours = np.repeat(points, FIRINGS)
    firings = Firings(current, settings, len(armours), FUTURE_CANDIDATES)
    shots, ended, _ = fire(firings, armours, np.full(len(armours), scatter), np.random.default_rng(0))
    return tuple(
        OperatingPoint(
            v50_m_s=v50,
            scatter_m_s=scatter,
            met=float((ends > 0).mean()),
            not_met=float((ends < 0).mean()),
            shots=_median(needed),
        )
        for v50, needed, ends in zip(
            points.tolist(), shots.reshape(-1, FIRINGS), ended.reshape(-1, FIRINGS), strict=True
        )
    )


class Rule(NamedTuple):
    """Functions of the shots so far: the next velocity, and why the firing has ended, "" if it goes on."""

    aim: Callable[[Shots, ShotSettings], Aim]
    ended: Callable[[Shots, ShotSettings], str]


PROCEDURES: Mapping[str, Rule] = {
    "bayesian": Rule(next_bayesian, stopped_bayesian),
    "neyer": Rule(next_by_neyer, stopped),
    "langlie": Rule(next_by_langlie, stopped),
    "up-and-down": Rule(next_up_and_down, stopped_up_and_down),
}
