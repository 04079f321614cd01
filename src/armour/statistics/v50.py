"""V50 from firing results, by the rule of MIL-STD-662F and by maximum likelihood."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from math import exp, inf, isfinite, log, pi, sqrt
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.special import expit, log_expit, log_ndtr, ndtr
from scipy.stats import chi2

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.errors import InputError, NoAnswerError, Problem
from armour.scenario.loading import Scenario
from armour.statistics.csv_table import read_rows

# Number of shots of each kind in the mean, and the greatest span of their velocities, m/s: 125, 90 and 60 ft/s.
SPANS_M_S = {5: 38.1, 3: 27.4, 2: 18.3}
# Range of velocities, m/s; it catches values in a wrong unit.
MIN_VELOCITY_M_S, MAX_VELOCITY_M_S = 1.0, 1e4
Link = Literal["probit", "logit"]
# Logarithm of the distribution function, by link.
LINKS: dict[Link, Callable[[Floats], Floats]] = {"probit": log_ndtr, "logit": log_expit}
# Smallest scale, and greatest distance of a bound, in standard deviations of the velocities.
MIN_SCALE = 1e-7
MAX_DISTANCE = 1e3


@dataclass(frozen=True)
class Shots:
    """Firing results.

    Attributes
    ----------
    velocities_m_s : tuple of float
    complete : tuple of bool
        Whether each was a complete penetration.
    file : str
    """

    velocities_m_s: tuple[float, ...]
    complete: tuple[bool, ...]
    file: str = "shots"

    def of(self, *, complete: bool) -> list[float]:
        """Return the velocities of the complete or of the partial penetrations, m/s, in ascending order."""
        pairs = zip(self.velocities_m_s, self.complete, strict=True)
        return sorted(velocity for velocity, found in pairs if found == complete)


@dataclass(frozen=True)
class MeanV50:
    """V50 as the mean of equal numbers of highest partial and lowest complete penetrations.

    Attributes
    ----------
    v50_m_s : float
        Mean velocity, m/s.
    pairs : int
        Number of shots of each kind.
    span_m_s, span_allowed_m_s : float
        Difference between the fastest and the slowest of these shots, m/s, and its greatest allowed value.
    """

    v50_m_s: float
    pairs: int
    span_m_s: float
    span_allowed_m_s: float


@dataclass(frozen=True)
class FittedCurve:
    """Probability of complete penetration over velocity, fitted by maximum likelihood.

    Attributes
    ----------
    curve : {"probit", "logit"}
        Normal or logistic distribution.
    v50_m_s : float
        Velocity of probability one half, m/s; the middle of the gap where the shots separate.
    v50_interval_m_s : tuple of float or None
        Profile-likelihood interval, m/s; None for an end that the shots do not bound.
    scale_m_s : float
        Standard deviation of the normal, scale of the logistic distribution, m/s; 0 where the shots separate.
    scale_interval_m_s : tuple of float or None
        Profile-likelihood interval, m/s; None for an upper end that the shots do not bound.
    log_likelihood : float
    """

    curve: Link
    v50_m_s: float
    v50_interval_m_s: tuple[float | None, float | None]
    scale_m_s: float
    scale_interval_m_s: tuple[float, float | None]
    log_likelihood: float

    def probability(self, velocity_m_s: float) -> float:
        """Return the probability of complete penetration at a velocity, m/s."""
        if self.scale_m_s == 0.0:
            return 0.5 * (1.0 + (velocity_m_s > self.v50_m_s) - (velocity_m_s < self.v50_m_s))
        z = (velocity_m_s - self.v50_m_s) / self.scale_m_s
        return float(ndtr(z) if self.curve == "probit" else expit(z))


@dataclass(frozen=True)
class FiringResult:
    """V50 estimated from firing results.

    Attributes
    ----------
    shots, complete : int
        Number of shots and of complete penetrations.
    highest_partial_m_s, lowest_complete_m_s : float
        Highest velocity of a partial and lowest velocity of a complete penetration, m/s.
    separated : bool
        Whether every complete penetration was faster than every partial one.
    mean : MeanV50 or None
        None where the shots do not meet the rule.
    fits : tuple of FittedCurve
    confidence : float
        Confidence level of the intervals.
    model_ballistic_limit_m_s : float or None
        Ballistic limit of the scenario, m/s, where one is given.  The model is deterministic: the limit has no scatter.
    """

    shots: int
    complete: int
    highest_partial_m_s: float
    lowest_complete_m_s: float
    separated: bool
    mean: MeanV50 | None
    fits: tuple[FittedCurve, ...]
    confidence: float
    model_ballistic_limit_m_s: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        return asdict(self)


def read_shots(path: Path) -> Shots:
    """Read firing results from a CSV file.

    Parameters
    ----------
    path : Path
        File with the columns ``velocity_m_s``, ``result`` ("partial" or "complete") and, optionally, ``shot``.

    Raises
    ------
    InputError
        With every mistake in the file.
    """
    rows = read_rows(path, numbers=("velocity_m_s",), texts=("result", "shot"), needed=("velocity_m_s", "result"))
    velocities = [row.numbers.get("velocity_m_s", 0.0) for row in rows]
    results = [row.texts.get("result", "") for row in rows]
    problems = []
    for row, velocity, result in zip(rows, velocities, results, strict=True):
        if not MIN_VELOCITY_M_S <= velocity <= MAX_VELOCITY_M_S:
            message = f"must be at least {MIN_VELOCITY_M_S:g} and at most {MAX_VELOCITY_M_S:g}"
            problems.append(Problem(str(path), f"{row.place}: velocity_m_s", message))
        if result not in ("partial", "complete"):
            message = f'must be "partial" or "complete", found "{result}"'
            problems.append(Problem(str(path), f"{row.place}: result", message))
    if not problems and len(set(results)) == 1:
        message = f"must have at least one partial and one complete penetration, found only {results[0]} ones"
        problems.append(Problem(str(path), "result", message))
    if problems:
        raise InputError(problems)
    return Shots(tuple(velocities), tuple(result == "complete" for result in results), str(path))


def v50(
    shots: Shots,
    scenario: Scenario | None = None,
    *,
    pairs: int | None = None,
    span_m_s: float | None = None,
    confidence: float = CONFIDENCE,
) -> FiringResult:
    """Estimate V50 from firing results.

    Parameters
    ----------
    shots : Shots
        At least one partial and one complete penetration.
    scenario : Scenario, optional
        Scenario with the same armour and projectile, for its ballistic limit.
    pairs : int, optional
        Number of shots of each kind in the mean; by default the greatest of 5, 3 and 2 whose span is allowed.
    span_m_s : float, optional
        Greatest span of their velocities, m/s; by default that of MIL-STD-662F for this number of shots.
    confidence : float
        Confidence level of the intervals.

    Raises
    ------
    NoAnswerError
        If the complete penetrations were no faster on average than the partial ones, or the scenario has no ballistic
        limit.
    """
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    return FiringResult(
        shots=len(shots.complete),
        complete=len(complete),
        highest_partial_m_s=partial[-1],
        lowest_complete_m_s=complete[0],
        separated=partial[-1] < complete[0],
        mean=mean_v50(shots, pairs, span_m_s),
        fits=tuple(fit_curve(shots, link, confidence) for link in LINKS),
        confidence=confidence,
        model_ballistic_limit_m_s=None if scenario is None else ballistic_limit(scenario).ballistic_limit_m_s,
    )


def mean_v50(shots: Shots, pairs: int | None = None, span_m_s: float | None = None) -> MeanV50 | None:
    """Compute V50 by the rule of MIL-STD-662F; None where the shots do not meet it."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    for count in SPANS_M_S if pairs is None else (pairs,):
        if count > min(len(partial), len(complete)):
            continue
        used = [*partial[-count:], *complete[:count]]
        allowed = SPANS_M_S.get(count, SPANS_M_S[5]) if span_m_s is None else span_m_s
        span = max(used) - min(used)
        if span <= allowed + 1e-9:
            return MeanV50(sum(used) / len(used), count, span, allowed)
    return None


def fit_curve(shots: Shots, link: Link, confidence: float = CONFIDENCE) -> FittedCurve:
    """Fit a curve of probability by maximum likelihood, with profile-likelihood intervals.

    The likelihood is that of P = F(slope x - intercept), where x is the standardised velocity; its logarithm is concave
    in both parameters.  Where the shots separate it is greatest at an infinite slope, with any probability at a
    velocity that a partial and a complete penetration share.  Each point of a profile is the maximum along a line,
    which exists, at an infinite slope if need be, whether the shots separate or not.
    """
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if np.mean(complete) <= np.mean(partial):
        raise NoAnswerError(
            f"no V50: the complete penetrations were no faster on average ({np.mean(complete):.1f} m/s) than the "
            f"partial ones ({np.mean(partial):.1f} m/s)"
        )
    velocities = np.array([*partial, *complete])
    signs = np.repeat([-1.0, 1.0], [len(partial), len(complete)])
    mean, deviation = float(velocities.mean()), float(velocities.std())
    x = (velocities - mean) / deviation

    def log_likelihood(slope: float, intercept: float) -> float:
        return float(LINKS[link](signs * (slope * x - intercept)).sum())

    def profile_of_location(location: float) -> float:
        """Return the maximum over all curves with probability one half at a location."""

        def lost(part: float) -> float:
            slope = part / (1.0 - part)
            return -log_likelihood(slope, location * slope)

        steepest = log_likelihood(1.0 / MIN_SCALE, location / MIN_SCALE)
        return max(-_minimum(lost, 0.0, 1.0 - MIN_SCALE), steepest, log_likelihood(0.0, 0.0))

    def profile_of_scale(scale: float) -> float:
        """Return the maximum over all curves with a scale."""
        low, high = x.min() / scale - 9.0, x.max() / scale + 9.0
        return -_minimum(lambda intercept: -log_likelihood(1.0 / scale, intercept), low, high)

    # Where the shots separate, every location between them has the same likelihood.
    lowest, highest = float(x[len(partial) - 1]), float(x[len(partial)])
    separated = lowest <= highest
    if separated:
        location, scale, maximum = 0.5 * (lowest + highest), 0.0, 0.0
        if lowest == highest:
            tied = [int((x[signs == sign] == location).sum()) for sign in (-1.0, 1.0)]
            maximum = sum(n * log(n / sum(tied)) for n in tied)
    else:
        location, scale, maximum = _maximum_likelihood(link, signs, x)
        lowest = highest = location
    threshold = maximum - 0.5 * float(chi2.ppf(confidence, 1))

    def location_excess(location: float) -> float:
        return profile_of_location(location) - threshold

    def scale_excess(log_scale: float) -> float:
        return profile_of_scale(exp(log_scale)) - threshold

    low, high = _profile_bound(location_excess, lowest, -1.0), _profile_bound(location_excess, highest, 1.0)
    narrowest = -inf if separated else _profile_bound(scale_excess, log(scale), -1.0)
    widest = _profile_bound(scale_excess, log(scale or MIN_SCALE), 1.0)
    return FittedCurve(
        curve=link,
        v50_m_s=mean + deviation * location,
        v50_interval_m_s=(_finite(mean + deviation * low), _finite(mean + deviation * high)),
        scale_m_s=deviation * scale,
        scale_interval_m_s=(deviation * exp(narrowest), _finite(deviation * exp(widest))),
        log_likelihood=maximum,
    )


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _minimum(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the minimum of a unimodal function between two ends."""
    return float(minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-10}).fun)


def _maximum_likelihood(link: Link, signs: Floats, x: Floats) -> tuple[float, float, float]:
    """Return location, scale and logarithm of the maximum likelihood of shots that overlap."""
    log_cdf = LINKS[link]

    def lost(p: Floats) -> tuple[float, Floats]:
        z = signs * (p[0] * x - p[1])
        slopes = signs * (expit(-z) if link == "logit" else np.exp(-0.5 * z * z - log_cdf(z)) / sqrt(2.0 * pi))
        return -float(log_cdf(z).sum()), np.array([-(slopes * x).sum(), slopes.sum()])

    found = minimize(lost, np.array([1.0, 0.0]), jac=True, method="BFGS", options={"gtol": 1e-9})
    slope, intercept = found.x
    return float(intercept / slope), float(1.0 / slope), -float(found.fun)


def _profile_bound(excess: Callable[[float], float], start: float, direction: float) -> float:
    """Return the root of a profile's excess over the threshold, from a start in a direction; infinite if none."""
    step, near = 1e-3, start
    while step < MAX_DISTANCE:
        far = start + direction * step
        if excess(far) < 0.0:
            return float(brentq(excess, near, far, xtol=1e-9)) if excess(near) > 0.0 else near
        near, step = far, 2.0 * step
    return direction * inf
