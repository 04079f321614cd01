"""Choose the velocities of a V50 firing and end it: up and down, Langlie's, Neyer's and the Bayesian procedure.

Whether a requirement is met is decided from the shots alone, at stated risks.

The Bayesian procedure fires the shot that is expected to say most about V50, given the model's limit and its error.
The gain of a shot is the expected reduction of the variance of V50 by its result, Cov(V50, result)^2 / Var(result) over
the posterior.  With a requirement, that the velocity at which a given fraction of shots perforate exceeds the required
velocity, it is the expected increase of the logarithm of the likelihood ratio that decides.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import copysign, inf, isfinite, log
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from armour.analysis.variants import Bools, Floats, Ints
from armour.statistics.curves import LOG_INFORMATION, FittedCurve, ShotLikelihood, fit_curve, has_curve
from armour.statistics.posterior import GRID_NODES, FiringPrior, Posterior, V50Grid, expected, normalised, posterior_of
from armour.statistics.v50 import MAX_VELOCITY_M_S, MIN_VELOCITY_M_S, SPANS_M_S, MeanV50, Shots, mean_v50
from armour.units import FT

# The velocity in question is that at which the given fraction of shots perforate.  Numbers of nodes of the grid: of its
# distance from the required velocity, and of the scatter.  The distance, in scatters, is the hyperbolic sine of a
# normal variable with the standard deviation SPREAD, up to FARTHEST; the scatter is log-normal, up to
# SCATTER_DEVIATIONS.
REQUIREMENT_NODES, SPREAD, FARTHEST, SCATTER_DEVIATIONS = (30, 7), 1.6, 4.2, 2.4
# Curves that just meet the requirement: number of nodes of their scatter, range of their scatter in units of the
# required velocity, and weight of each curve, negligible in averages.
EDGE_NODES, EDGE_SCATTERS, EDGE_WEIGHT = 41, (1e-3, 0.5), 1e-12


class RequirementCurves(NamedTuple):
    """Grid of response curves that meet a requirement, do not meet it, or just meet it ("edge"), with weights.

    The requirement is that the velocity at which a fraction of shots perforate exceeds the required velocity.  The
    evidence that it is met is a ratio: the likelihood of the shots averaged over curves that meet the requirement,
    divided by the greatest likelihood of a curve that does not meet it.  If the requirement is not met, this ratio ever
    exceeds 1/risk with a probability of at most `risk`, whatever rule chooses the velocities and ends the firing
    [Wasserman2020].  The same holds with the sides exchanged.

    The log-likelihood of normal curves is concave in intercept and slope, and the curves of each side are a convex set
    of intercepts and slopes.  Where the ratio exceeds 1, the likeliest curve of the other side therefore just meets the
    requirement.
    """

    grid: V50Grid
    log_weights: Floats  # of the curves in averages, (points,)
    met: Floats  # 1 for curves that meet the requirement, 0 for those that do not, 0.5 for the edge, (points,)

    def posterior(self, velocities_m_s: Sequence[float], complete: Sequence[bool]) -> Posterior:
        """Return the probability of each curve given shots, m/s; `complete` is true for complete penetrations."""
        return Posterior(self.grid, normalised(self.log_weights + self.grid.log_likelihood(velocities_m_s, complete)))

    def ratios(self, weights: Floats) -> Floats:
        """Return the evidence for and against the requirement, (n, 2), as likelihood ratios.

        `weights`, (n, points), are n distributions over the curves: their probabilities given the shots of n firings.
        """
        edge = weights[:, self.met == 0.5].max(axis=1) / EDGE_WEIGHT
        sides = np.column_stack([weights @ (self.met == 1.0), weights @ (self.met == 0.0)])
        return 2.0 * sides / np.maximum(edge, 1e-290)[:, None]

    def decisions(self, weights: Floats, confidence: float) -> Ints:
        """Return 1 where the requirement is met, -1 where it is not and 0 where this is undecided, (n,).

        `weights` are those of `ratios`; the risk of either wrong decision is at most 1 minus `confidence`.
        """
        accepted, rejected = (self.ratios(weights) * (1.0 - confidence) >= 1.0).T
        return accepted.astype(int) - rejected

    def gains(self, weights: Floats, response: Floats) -> Floats:
        """Return how much a shot at each of m velocities is expected to help the decision in each of n firings, (n, m).

        It is the expected increase of the logarithm of the evidence for the side that is true, up to a constant.
        `weights`, (n, points), are those of `ratios`; `response`, (m, points), is the probability of complete
        penetration at each velocity by each curve.
        """
        # `met` of a curve is 1, 0 or, where it just meets the requirement, 0.5: the evidence for a side is the chance
        # of the shots by its curves over the greatest by one that just meets.
        gained = np.zeros((len(weights), len(response)))
        for chance in (response, 1.0 - response):
            edge = (weights[:, None, self.met == 0.5] * chance[:, self.met == 0.5]).max(axis=2)
            for side in (self.met == 1.0, self.met == 0.0):
                together = np.vecdot(weights[:, None, side], chance[:, side]).clip(1e-290)
                alone = weights[:, side].sum(axis=1).clip(1e-290)
                gained += together * np.log(together / alone[:, None] / edge.clip(1e-290))
        return gained


def requirement_curves(required_m_s: float, fraction: float, scatter_m_s: float, factor: float) -> RequirementCurves:
    """Return a grid of response curves that meet, miss or just meet (edge) a requirement.

    The requirement is that the velocity which perforates `fraction` of the shots exceeds `required_m_s`.  The
    expected scatter, m/s, and the `factor` by which it may differ weight the curves: they affect how many shots are
    needed, not the risks.
    """
    # The distance is that velocity minus the required one, in scatters.
    arsinh_distance = np.linspace(-FARTHEST, FARTHEST, REQUIREMENT_NODES[0])
    scatter_deviation = np.linspace(-SCATTER_DEVIATIONS, SCATTER_DEVIATIONS, REQUIREMENT_NODES[1])
    distance = np.append(np.repeat(np.sinh(arsinh_distance), REQUIREMENT_NODES[1]), np.zeros(EDGE_NODES))
    edge_scatters = required_m_s * np.geomspace(*EDGE_SCATTERS, EDGE_NODES)
    scatters = scatter_m_s * np.exp(log(factor) * scatter_deviation)
    scatter = np.append(np.tile(scatters, REQUIREMENT_NODES[0]), edge_scatters)
    weights = np.exp(-0.5 * np.add.outer((arsinh_distance / SPREAD) ** 2, scatter_deviation**2)).ravel()
    weights = np.append(weights / weights.sum(), np.full(EDGE_NODES, EDGE_WEIGHT))
    grid = V50Grid(required_m_s + (distance - float(ndtri(fraction))) * scatter, scatter, (1, len(scatter)))
    return RequirementCurves(grid, np.log(weights), 0.5 + 0.5 * np.sign(distance))


class ShotSettings(NamedTuple):
    """Settings of a procedure; velocities in m/s."""

    prior: FiringPrior  # of V50 and the scatter; its medians are the first estimates in the other procedures
    limits_m_s: tuple[float, float] = (-inf, inf)  # of V50, for Langlie's and Neyer's procedures
    half_width_m_s: float | None = None  # of the interval of V50 that ends the firing; None if the rule has another end
    confidence: float = 0.95
    requirement_m_s: float | None = None
    requirement_fraction: float = 0.5  # of shots that may perforate at the required velocity

    @property
    def scatter_m_s(self) -> float:
        """Expected scatter, the standard deviation of the response curve, m/s."""
        return self.prior.limit_m_s * self.prior.scatter_percent / 100.0

    def requirement_curves(self) -> RequirementCurves | None:
        """Return the grid of response curves that decides the requirement; None without a requirement."""
        required, fraction, factor = self.requirement_m_s, self.requirement_fraction, self.prior.scatter_factor
        return None if required is None else requirement_curves(required, fraction, self.scatter_m_s, factor)


class Aim(NamedTuple):
    """Velocity of the next shot, m/s, and the reason for it."""

    velocity_m_s: float
    why: str


def recommended_fit(shots: Shots, confidence: float) -> FittedCurve | None:
    """Fit a probit curve to shots by penalised likelihood; return None if no rising curve fits them."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if not has_curve(partial, complete):
        return None
    return fit_curve(partial, complete, "probit", confidence, penalised=True)


def narrow_enough(interval: tuple[float | None, float | None], settings: ShotSettings) -> str:
    """Return in words that the firing ends, as an interval of V50, m/s, is narrow enough; "" if it is not."""
    low, high = interval
    if settings.half_width_m_s is None or low is None or high is None or 0.5 * (high - low) > settings.half_width_m_s:
        return ""
    return f"the interval of V50 is within ± {settings.half_width_m_s:g} m/s"


def stopped(shots: Shots, settings: ShotSettings) -> str:
    """Return why a firing by Langlie's or Neyer's procedure ends: V50 of the fitted curve is known well; "" if not."""
    fit = recommended_fit(shots, settings.confidence)
    return "" if fit is None else narrow_enough(fit.v50_interval_m_s, settings)


ABOVE_M_S, FIRST_STEP_M_S, STEP_M_S = 75.0 * FT, 100.0 * FT, 50.0 * FT
# Shots of each kind in the mean that ends the firing.
OF_EACH_KIND = 3


def next_up_and_down(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by the up-and-down rule of MIL-STD-662F [DoD1997].

    The first shot is at the estimated V50 or, with a requirement, 75 ft/s above the required velocity.  Each further
    shot is slower than the last shot after a complete penetration and faster after a partial one: by 100 ft/s until
    there are both kinds, then by 50 ft/s.
    """
    if not shots.complete:
        if settings.requirement_m_s is None:
            return Aim(settings.prior.limit_m_s, "the first shot is at the estimated V50")
        return Aim(settings.requirement_m_s + ABOVE_M_S, f"the first shot is {ABOVE_M_S:.1f} m/s above the requirement")
    step, last = STEP_M_S if len(set(shots.complete)) == 2 else FIRST_STEP_M_S, shots.velocities_m_s[-1]
    if shots.complete[-1]:
        return Aim(last - step, f"{step:.1f} m/s below the last shot, a complete penetration")
    return Aim(last + step, f"{step:.1f} m/s above the last shot, a partial penetration")


def stopped_up_and_down(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends: a mean by MIL-STD-662F or, if asked for, a narrow interval; "" if it continues."""
    if settings.half_width_m_s is not None:
        return stopped(shots, settings)
    if mean_of(shots) is None:
        return ""
    return f"{OF_EACH_KIND} partial and {OF_EACH_KIND} complete penetrations lie within {SPANS_M_S[OF_EACH_KIND]:g} m/s"


def mean_of(shots: Shots) -> MeanV50 | None:
    """Return the mean of MIL-STD-662F that ends the firing: of three shots of each kind, if within the usual span."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    return mean_v50(partial, complete, OF_EACH_KIND) if partial and complete else None


def next_by_langlie(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by Langlie's one-shot test [Langlie1962].

    The first shot is midway between the limits.  Each further shot is midway between the last shot and an earlier one:
    the latest from which on as many penetrations were complete as partial.  Without such a shot, it is midway between
    the last shot and a limit: the lower limit after a complete penetration, the upper limit after a partial one.
    """
    lower, upper = settings.limits_m_s
    if not shots.complete:
        return Aim(0.5 * (lower + upper), "the first shot is midway between the limits")
    velocities, last = shots.velocities_m_s, shots.velocities_m_s[-1]
    excess = 0  # of complete over partial penetrations
    for number in range(len(velocities), 0, -1):
        excess += 1 if shots.complete[number - 1] else -1
        if excess == 0:
            reason = f"midway between the last shot and shot {number}, from which on half of the penetrations are "
            return Aim(0.5 * (last + velocities[number - 1]), f"{reason}complete")
    end, name = (lower, "lower") if shots.complete[-1] else (upper, "upper")
    return Aim(0.5 * (last + end), f"midway between the last shot and the {name} limit, {end:.1f} m/s")


# Velocities at which the gain in information is computed, in scatters above V50.
ARGUMENTS = np.arange(-4000, 4001) / 1000.0
# The best of them if a constant probability, that of an infinite scatter, fits the shots best.
FLAT = 1.31525757633905


def next_by_neyer(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by Neyer's D-optimal test [Neyer1994].

    1. A binary search finds shots of both kinds, until the lowest complete penetration is less than the guessed scatter
       above the highest partial one.
    2. Until the two kinds overlap, so that V50 and scatter have unique maximum-likelihood estimates, V50 is taken
       midway between these two shots, and the guessed scatter is multiplied by 0.8 after each shot.
    3. Then V50 and scatter are estimated by maximum likelihood: V50 within the range of the shots, and the scatter at
       most as large as this range.

    In parts 2 and 3 the next velocity maximises the determinant of the Fisher information.
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
            guess *= 0.8
    partials, completes = shots.of(complete=False), shots.of(complete=True)
    middle, span = 0.5 * (partials[-1] + completes[0]), fastest - slowest
    if gaps[-1] > guess:
        return Aim(middle, "binary search: midway between the highest partial and the lowest complete penetration")
    if gaps[-1] >= 0.0:
        scatter = min(guess, span) or guess  # a shot of each kind at one velocity has no span
        return Aim(_d_optimal(velocities, middle, scatter), f"D-optimal for a guessed scatter of {scatter:.1f} m/s")
    if not has_curve(partials, completes):
        v50 = min(max(middle, slowest), fastest)
        return Aim(v50 + copysign(FLAT * span, -1.0 if complete[-1] else 1.0), "the shots have no rising curve")
    curve = ShotLikelihood(partials, completes, "probit")
    intercept, slope, _ = curve.mode
    v50 = min(max(curve.mean - curve.deviation * intercept / slope, slowest), fastest)
    scatter = min(curve.deviation / slope, span)
    reason = f"D-optimal for the estimates of maximum likelihood, V50 {v50:.1f} and scatter {scatter:.1f} m/s"
    return Aim(_d_optimal(velocities, v50, scatter), reason)


def _gaps(shots: Shots) -> list[float]:
    """Return the gap after each shot, m/s: the lowest complete minus the highest partial velocity so far.

    Shots before there are both kinds have none; the gap is negative where the kinds overlap.
    """
    lowest, highest, gaps = np.inf, -np.inf, []
    for velocity, complete in zip(shots.velocities_m_s, shots.complete, strict=True):
        lowest, highest = (min(lowest, velocity), highest) if complete else (lowest, max(highest, velocity))
        gaps.append(round(float(lowest - highest), 9))
    return [gap for gap in gaps if gap < np.inf]


def _d_optimal(velocities: Sequence[float], v50: float, scatter: float) -> float:
    """Return the next velocity, m/s, at which a shot, with those at `velocities`, says most about V50 and the scatter.

    It maximises the determinant of their Fisher information if V50 and the scatter are those given, m/s.
    """
    z = (np.array(velocities) - v50) / scatter
    weights, gained = (np.exp(LOG_INFORMATION["probit"](arguments)) for arguments in (z, ARGUMENTS))
    gain = gained * (weights.sum() * ARGUMENTS**2 - 2.0 * (weights @ z) * ARGUMENTS + weights @ (z * z))
    return v50 + scatter * float(ARGUMENTS[np.argmax(gain)])


# Number of velocities examined.  Their range is that of V50, without the probability TAIL at each end, or WIDE_TAIL if
# the scatter is implausible, and SCATTERS scatters more; or AROUND scatters on either side of a requirement.
CANDIDATES, TAIL, WIDE_TAIL, SCATTERS, AROUND = 101, 1e-3, 0.025, 2.0, 4.0
# Simulated continuations of the firing, to estimate the number of further shots: number of continuations, nodes of
# their grid, number of velocities examined, and greatest number of shots in each.
FUTURES, FUTURE_NODES, FUTURE_CANDIDATES, MOST_SHOTS = 40, (401, 11), 61, 100
# Operating characteristic: simulated firings at each of its armours, and the distances, in scatters, of the velocity in
# question from the required velocity.
FIRINGS, DISTANCES = 100, (-3.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0)


def posterior(shots: Shots, settings: ShotSettings, nodes: tuple[int, int] = GRID_NODES) -> Posterior:
    """Return the posterior of V50 and the scatter given the shots, on a grid of `nodes` of each.

    With a requirement, it is that of the curves which decide the requirement, without the prior.
    """
    if curves := settings.requirement_curves():
        return curves.posterior(shots.velocities_m_s, shots.complete)
    return posterior_of(settings.prior, shots.velocities_m_s, shots.complete, nodes)


def next_bayesian(shots: Shots, settings: ShotSettings) -> Aim:
    """Return the velocity of the next shot by the Bayesian procedure."""
    current = posterior(shots, settings)
    velocities = candidates(current, settings, CANDIDATES)
    step = velocities[1] - velocities[0]
    for _ in range(2):
        velocity_gains = gains(current.weights[None], current.grid, settings, current.grid.response(velocities))[0]
        best = float(velocities[np.argmax(velocity_gains)])
        velocities = np.clip(np.linspace(best - step, best + step, 21), MIN_VELOCITY_M_S, MAX_VELOCITY_M_S)
    if settings.requirement_m_s is not None:
        return Aim(best, "expected to be most informative about whether the requirement is met")
    variance = current.variance(current.grid.v50_m_s)
    expected_variance = max(variance - float(velocity_gains.max()), 0.0)
    change = f"from {variance**0.5:.1f} to {expected_variance**0.5:.1f} m/s"
    return Aim(best, f"expected to narrow the standard deviation of V50 most, {change}")


def stopped_bayesian(shots: Shots, settings: ShotSettings) -> str:
    """Return why a Bayesian firing ends: a decided requirement or a narrow interval of V50; "" if it continues."""
    current, curves = posterior(shots, settings), settings.requirement_curves()
    if curves is None:
        return narrow_enough(current.estimate(settings.confidence).v50_interval_m_s, settings)
    [decision] = curves.decisions(current.weights[None], settings.confidence)
    if decision == 0:
        return ""
    answer, side = ("met", "consumer") if decision > 0 else ("not met", "producer")
    return f"the requirement is {answer}, at a {side}'s risk of at most {100.0 * (1.0 - settings.confidence):.4g} %"


def gains(weights: Floats, grid: V50Grid, settings: ShotSettings, response: Floats) -> Floats:
    """Return how much a shot at each of m velocities is expected to say about V50 or the requirement, (n, m).

    It is the expected reduction of the variance of V50, (m/s)², or, with a requirement, `RequirementCurves.gains`.
    `weights`, (n, points), are the posteriors of n firings over the points of the grid; `response`, (m, points), is the
    probability of complete penetration at each velocity by each point.
    """
    if curves := settings.requirement_curves():
        return curves.gains(weights, response)
    # Unlike matrix products, these do not depend on the number of threads, as no grid has more than 10,000 points.
    probability = np.vecdot(weights[:, None], response).clip(1e-12, 1.0 - 1e-12)
    mean = expected(grid.v50_m_s, weights)
    covariance = np.vecdot((weights * (grid.v50_m_s - mean[:, None]))[:, None], response)
    return covariance**2 / (probability * (1.0 - probability))


def candidates(current: Posterior, settings: ShotSettings, count: int) -> Floats:
    """Return `count` evenly spaced velocities from which to choose that of the next shot, m/s, (count,).

    They lie around V50 by the posterior `current` or, with a requirement, around the required velocity.
    """
    plausible_scatter = settings.scatter_m_s * settings.prior.plausible_factor
    scatter = float(expected(current.grid.scatter_m_s, current.weights))
    if settings.requirement_m_s is not None:
        low = high = settings.requirement_m_s
        reach = AROUND * min(scatter, plausible_scatter)
    else:
        # Contradictory shots imply a scatter beyond the prior, which is no reason to aim far away.
        tail = TAIL if scatter <= plausible_scatter else WIDE_TAIL
        low, high = current.grid.v50_quantiles(current.weights, (tail, 1.0 - tail))[0]
        reach = SCATTERS * min(scatter, plausible_scatter)
    low, high = np.clip([low - reach, high + reach], MIN_VELOCITY_M_S, MAX_VELOCITY_M_S)
    return np.linspace(low, high, count)


class Firings:
    """Simulated firings, each a series of shots, with their posteriors on a common grid of V50 and scatter.

    `weights` has those of its points, (count, points).  All `count` firings start from the posterior `current`, follow
    the Bayesian procedure with the same settings, and aim at one of `velocities` evenly spaced velocities.
    """

    def __init__(self, current: Posterior, settings: ShotSettings, count: int, velocities: int) -> None:
        self.settings, self.grid = settings, current.grid
        self.weights = np.tile(current.weights, (count, 1))
        self.velocities = candidates(current, settings, velocities)
        self.response = current.grid.response(self.velocities)

    def aims(self) -> Floats:
        """Return the next velocity of each firing, m/s, (n,)."""
        return self.velocities[gains(self.weights, self.grid, self.settings, self.response).argmax(axis=1)]

    def add(self, velocities: Floats, complete: Bools) -> None:
        """Add a shot to each firing, given its velocity, m/s, (n,), and whether it was complete, (n,)."""
        response = self.grid.response(velocities)
        self.weights *= np.where(complete[:, None], response, 1.0 - response)
        self.weights /= self.weights.sum(axis=1, keepdims=True)

    def intervals(self, confidence: float) -> Floats:
        """Return the ends of the interval of V50 of each firing, m/s, (n, 2)."""
        return self.grid.v50_quantiles(self.weights, (0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence))

    def ended(self) -> Ints:
        """Return how each firing has ended, (n,): 1, -1, or 0 if it has not.

        1 is the end with the requirement met or with a narrow interval of V50, -1 that with the requirement not met.
        """
        settings = self.settings
        if curves := settings.requirement_curves():
            return curves.decisions(self.weights, settings.confidence)
        low, high = self.intervals(settings.confidence).T
        return (0.5 * (high - low) <= (settings.half_width_m_s or 0.0)).astype(int)


def fire(
    firings: Firings, v50_m_s: Floats, scatter_m_s: Floats, dice: np.random.Generator, least: int = 1
) -> tuple[Floats, Ints]:
    """Simulate `firings`, one at each of n armours with a true V50 and scatter, m/s, (n,); `dice` draws the results.

    Return the number of shots of each firing, (n,), infinite without an end, and how it ended, (n,), as by
    `Firings.ended`.  The simulation stops when fewer than `least` firings continue.
    """
    shots = np.full(len(v50_m_s), inf)
    ended = np.zeros(len(v50_m_s), dtype=int)
    active = np.arange(len(v50_m_s))
    for number in range(MOST_SHOTS + 1):
        ended[active] = firings.ended()
        shots[active[ended[active] != 0]] = number
        continues = ended[active] == 0
        active = active[continues]
        if len(active) < least:
            break
        firings.weights = firings.weights[continues]
        velocities = firings.aims()
        firings.add(velocities, dice.normal(v50_m_s[active], scatter_m_s[active]) < velocities)
    return shots, ended


def expected_shots(shots: Shots, settings: ShotSettings) -> float | None:
    """Return the median number of further shots in simulated continuations of a firing; None if above MOST_SHOTS."""
    current = posterior(shots, settings, FUTURE_NODES)
    # Even if the decision does not use the prior, the prior predicts the number of shots.
    prediction = posterior(shots, settings._replace(requirement_m_s=None), FUTURE_NODES)
    dice = np.random.default_rng(0)
    points = dice.choice(len(prediction.weights), FUTURES, p=prediction.weights)
    v50, scatter = prediction.grid.v50_m_s[points], prediction.grid.scatter_m_s[points]
    # The median is known once half of the firings have ended.
    firings = Firings(current, settings, FUTURES, FUTURE_CANDIDATES)
    further, _ = fire(firings, v50, scatter, dice, least=FUTURES // 2)
    return _median(further)


def _median(shots: Floats) -> float | None:
    """Return the median of numbers of shots, (n,); None if it is infinite."""
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
    """Return the outcomes of simulated firings at armours from below to above the requirement.

    All armours have the expected scatter; the distances of their V50 are DISTANCES.
    """
    assert settings.requirement_m_s is not None
    current, scatter = posterior(Shots((), ()), settings, FUTURE_NODES), settings.scatter_m_s
    v50_at_edge = settings.requirement_m_s - float(ndtri(settings.requirement_fraction)) * scatter
    true_v50 = v50_at_edge + scatter * np.array(DISTANCES)
    armours = np.repeat(true_v50, FIRINGS)
    firings = Firings(current, settings, len(armours), FUTURE_CANDIDATES)
    shots, ended = fire(firings, armours, np.full(len(armours), scatter), np.random.default_rng(0))
    outcomes = zip(true_v50.tolist(), shots.reshape(-1, FIRINGS), ended.reshape(-1, FIRINGS), strict=True)
    return tuple(
        OperatingPoint(v50, scatter, float((ends > 0).mean()), float((ends < 0).mean()), _median(numbers))
        for v50, numbers, ends in outcomes
    )


# For each procedure, functions of the shots so far: the next velocity, and why the firing has ended, "" if it has not.
PROCEDURES: Mapping[str, tuple[Callable[[Shots, ShotSettings], Aim], Callable[[Shots, ShotSettings], str]]] = {
    "bayesian": (next_bayesian, stopped_bayesian),
    "neyer": (next_by_neyer, stopped),
    "langlie": (next_by_langlie, stopped),
    "up-and-down": (next_up_and_down, stopped_up_and_down),
}
