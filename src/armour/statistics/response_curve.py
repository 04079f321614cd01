"""Probability of complete penetration over velocity, fitted to shots by maximum likelihood."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, inf, isfinite, log, pi, sqrt
from typing import Literal

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.special import expit, log_expit, log_ndtr, ndtr
from scipy.stats import chi2

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.errors import NoAnswerError

Link = Literal["probit", "logit"]
# Logarithm of the distribution function, by link: the normal and the logistic distribution.
LINKS: dict[Link, Callable[[Floats], Floats]] = {"probit": log_ndtr, "logit": log_expit}
# Smallest scale, and greatest distance of a bound, in standard deviations of the velocities.
MIN_SCALE = 1e-7
MAX_DISTANCE = 1e3


@dataclass(frozen=True)
class FittedCurve:
    """Probability of complete penetration over velocity, with profile-likelihood intervals."""

    curve: Link
    v50_m_s: float  # velocity of probability one half; the middle of the gap where the shots separate
    v50_interval_m_s: tuple[float | None, float | None]  # None for an end that the shots do not bound
    scale_m_s: float  # standard deviation of the normal, scale of the logistic; 0 where the shots separate
    scale_interval_m_s: tuple[float, float | None]
    log_likelihood: float

    def probability(self, velocity_m_s: float) -> float:
        """Return the probability of complete penetration at a velocity, m/s."""
        if self.scale_m_s == 0.0:
            return 0.5 * (1.0 + (velocity_m_s > self.v50_m_s) - (velocity_m_s < self.v50_m_s))
        z = (velocity_m_s - self.v50_m_s) / self.scale_m_s
        return float(ndtr(z) if self.curve == "probit" else expit(z))


def fit_curve(
    partial: Sequence[float], complete: Sequence[float], link: Link, confidence: float = CONFIDENCE
) -> FittedCurve:
    """Fit a curve to the velocities of partial and complete penetrations, m/s, by maximum likelihood.

    The likelihood is that of P = F(slope x - intercept), where x is the standardised velocity; its logarithm is concave
    in both parameters.  Where the shots separate it is greatest at an infinite slope, with any probability at a
    velocity that a partial and a complete penetration share.  Each point of a profile is the maximum along a line,
    which exists, at an infinite slope if need be, whether the shots separate or not.
    """
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
