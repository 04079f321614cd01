"""Probability of complete penetration over velocity, fitted to shots by maximum likelihood."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, inf, log, pi, sqrt
from typing import Any, Literal

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.special import erfcx, expit, log_expit, log_ndtr, logit, ndtr, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.errors import NoAnswerError

Link = Literal["probit", "logit"]
Interval = tuple[float | None, float | None]
Method = Literal["maximum likelihood", "penalised likelihood"]
# Logarithm of the distribution function, by link: the normal and the logistic distribution.
LINKS: dict[Link, Callable[[Floats], Floats]] = {"probit": log_ndtr, "logit": log_expit}
# Argument of the distribution function at probability 0.95.
Z95: dict[Link, float] = {"probit": float(ndtri(0.95)), "logit": float(logit(0.95))}
CDFS: dict[Link, Callable[[Any], Any]] = {"probit": ndtr, "logit": expit}
# Smallest scale, and greatest distance of a bound, in standard deviations of the velocities.
MIN_SCALE = 1e-7
MAX_DISTANCE = 1e3


@dataclass(frozen=True)
class FittedCurve:
    """Probability of complete penetration over velocity, with profile-likelihood intervals.

    Attributes
    ----------
    curve : str
        "probit", a normal distribution of the velocities that perforate, or "logit", a logistic one.
    v50_m_s : float
        Velocity of probability one half, m/s; of maximum likelihood the middle of the gap of separated shots.
    v50_interval_m_s : tuple of float or None
        Confidence interval of V50, m/s; None for an end that the shots do not bound.
    scale_m_s : float
        Standard deviation of the normal or scale of the logistic distribution, m/s; of maximum likelihood 0 where the
        shots are separated.
    scale_interval_m_s : tuple of float or None
        Confidence interval of the scale, m/s; None for an upper end that the shots do not bound.
    log_likelihood : float
        Logarithm of the likelihood, without the penalty.
    v05_m_s, v95_m_s : float or None
        Velocities of probability 0.05 and 0.95, m/s; None where the scale is 0 or the velocity is not positive.
    method : str
        "maximum likelihood" or "penalised likelihood".
    v05_interval_m_s, v95_interval_m_s : tuple of float or None, or None
        Their confidence intervals, m/s; None for other curves than those of penalised likelihood.
    """

    curve: Link
    v50_m_s: float
    v50_interval_m_s: Interval
    scale_m_s: float
    scale_interval_m_s: tuple[float, float | None]
    log_likelihood: float
    v05_m_s: float | None = None
    v95_m_s: float | None = None
    method: Method = "maximum likelihood"
    v05_interval_m_s: Interval | None = None
    v95_interval_m_s: Interval | None = None

    def probability(self, velocity_m_s: float) -> float:
        """Return the probability of complete penetration at a velocity, m/s."""
        if self.scale_m_s == 0.0:
            return 0.5 * (1.0 + (velocity_m_s > self.v50_m_s) - (velocity_m_s < self.v50_m_s))
        return float(CDFS[self.curve]((velocity_m_s - self.v50_m_s) / self.scale_m_s))


def standardised(partial: Sequence[float], complete: Sequence[float]) -> tuple[float, float, Floats, Floats]:
    """Return mean and standard deviation of the velocities of shots, m/s, the velocities standardised, and signs.

    The sign of a partial penetration is -1, that of a complete one +1.
    """
    if np.mean(complete) <= np.mean(partial):
        raise NoAnswerError(
            f"no V50: the complete penetrations were no faster on average ({np.mean(complete):.1f} m/s) than the "
            f"partial ones ({np.mean(partial):.1f} m/s)"
        )
    velocities = np.array([*partial, *complete])
    mean, deviation = float(velocities.mean()), float(velocities.std())
    signs = np.repeat([-1.0, 1.0], [len(partial), len(complete)])
    return mean, deviation, (velocities - mean) / deviation, signs


def fit_curve(
    partial: Sequence[float], complete: Sequence[float], link: Link, confidence: float = CONFIDENCE
) -> FittedCurve:
    """Fit a curve to the velocities of partial and complete penetrations, m/s, by maximum likelihood.

    The likelihood is that of P = F(slope x - intercept), where x is the standardised velocity; its logarithm is concave
    in both parameters.  Where the shots separate it is greatest at an infinite slope, with any probability at a
    velocity that a partial and a complete penetration share.  Each point of a profile is the maximum along a line,
    which exists, at an infinite slope if need be, whether the shots separate or not.
    """
    mean, deviation, x, signs = standardised(partial, complete)

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
    lowest, highest = float(x[signs < 0.0].max()), float(x[signs > 0.0].min())
    separated = lowest <= highest
    if separated:
        location, scale, maximum = 0.5 * (lowest + highest), 0.0, 0.0
        if lowest == highest:
            tied = [int((x[signs == sign] == location).sum()) for sign in (-1.0, 1.0)]
            maximum = sum(n * log(n / sum(tied)) for n in tied)
    else:
        location, scale, maximum = _maximum_likelihood(link, signs, x)
        lowest = highest = location
    root = float(ndtri(0.5 + 0.5 * confidence))

    def excess(profile: float) -> float:
        """Return the root of the deviance, which is nearly linear in the quantity, less that at the ends."""
        return sqrt(2.0 * max(maximum - profile, 0.0)) - root

    def location_excess(location: float) -> float:
        return excess(profile_of_location(location))

    def scale_excess(log_scale: float) -> float:
        return excess(profile_of_scale(exp(log_scale)))

    low, high = _profile_bound(location_excess, lowest, -1.0), _profile_bound(location_excess, highest, 1.0)
    narrowest = -inf if separated else _profile_bound(scale_excess, log(scale), -1.0)
    widest = _profile_bound(scale_excess, log(scale or MIN_SCALE), 1.0)
    v50_m_s, scale_m_s = mean + deviation * location, deviation * scale
    return FittedCurve(
        curve=link,
        v50_m_s=v50_m_s,
        v50_interval_m_s=(bounded(mean + deviation * low), bounded(mean + deviation * high)),
        scale_m_s=scale_m_s,
        scale_interval_m_s=(deviation * exp(narrowest), bounded(deviation * exp(widest))),
        log_likelihood=maximum,
        v05_m_s=bounded(v50_m_s - Z95[link] * scale_m_s) if scale else None,
        v95_m_s=bounded(v50_m_s + Z95[link] * scale_m_s) if scale else None,
    )


def bounded(value: float) -> float | None:
    """Return a velocity or scale, m/s, or None if it is none: infinite, or a velocity below 0."""
    return value if 0.0 < value < inf else None


def _minimum(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the minimum of a unimodal function between two ends."""
    return float(minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-8}).fun)


def _maximum_likelihood(link: Link, signs: Floats, x: Floats) -> tuple[float, float, float]:
    """Return location, scale and logarithm of the maximum likelihood of shots that overlap."""
    log_cdf = LINKS[link]

    def lost(p: Floats) -> tuple[float, Floats]:
        z = signs * (p[0] * x - p[1])
        slopes = signs * (expit(-z) if link == "logit" else sqrt(2.0 / pi) / erfcx(-z * sqrt(0.5)))
        return -float(log_cdf(z).sum()), np.array([-(slopes * x).sum(), slopes.sum()])

    found = minimize(lost, np.array([1.0, 0.0]), jac=True, method="BFGS", options={"gtol": 1e-9})
    slope, intercept = found.x
    return float(intercept / slope), float(1.0 / slope), -float(found.fun)


def _profile_bound(excess: Callable[[float], float], start: float, direction: float) -> float:
    """Return the root of a profile's excess over the threshold, from a start in a direction; infinite if none."""
    step, near = 1e-3, start
    while step < MAX_DISTANCE:
        far = start + direction * step
        if excess(far) > 0.0:
            return float(brentq(excess, near, far, xtol=1e-9)) if excess(near) < 0.0 else near
        near, step = far, 2.0 * step
    return direction * inf
