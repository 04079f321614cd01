"""Probability of complete penetration over velocity, fitted to shots by Firth's penalised maximum likelihood.

The likelihood of P = F(a + b x) is multiplied by the Jeffreys prior, the square root of the determinant of the Fisher
information of a and b [Firth1993], [Heinze2002].  Its maximum is finite where the shots separate, too.  The intervals
are those of the profile of the penalised likelihood.
"""

from collections.abc import Callable, Sequence
from math import copysign, exp, inf, log, pi, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import erfcx, log_expit, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.statistics.response_curve import (
    CDFS,
    MAX_DISTANCE,
    Z95,
    FittedCurve,
    Link,
    bounded,
    standardised,
)

# Slopes at which the search for the maximum starts, per standard deviation of the velocities.
STARTS = (0.5, 2.0, 8.0, 32.0, 128.0)
# The penalised likelihood of few shots can have several maxima along a line: a climb starts from the best of some
# points, for lines of all slopes from one of these slopes.
FEW = 60
SLOPES = np.geomspace(0.05, 5e3, 40)
# Greatest change of the argument of F in a step of a climb, the gain at which a climb ends, and its most steps.
MAX_CHANGE, MIN_GAIN, MAX_STEPS = 5.0, 1e-8, 200
# Velocities at which a band is computed, between which it is interpolated, and the greatest argument of F at its ends.
BAND_NODES, FARTHEST = 13, 40.0
# Argument of F above which, and determinant of the relative information below which, a curve is too steep.
MAX_ARGUMENT, MIN_DETERMINANT = 1e8, 1e-200
# Shots evaluated at once, so that the arrays stay in the processor's cache.
BLOCK = 8192


class _Point(NamedTuple):
    """Logarithm of the penalised likelihood, and that without the penalty, at an intercept and a slope."""

    at: Floats
    value: float
    log_likelihood: float
    gradient: Floats  # (2,)
    hessian: Floats  # (2, 2)


class _Likelihood:
    """Penalised likelihood of shots, with its maximum and its confidence region."""

    def __init__(self, link: Link, x: Floats, signs: Floats, confidence: float) -> None:
        """Take the standardised velocities of shots, and +1 for complete, -1 for partial penetrations."""
        self.link, self.x, self.signs = link, x, signs
        self.root = float(ndtri(0.5 + 0.5 * confidence))
        # Where the slope is given, V50 is near a shot or between two neighbours.
        self.few, ordered = len(x) <= FEW, np.unique(x)
        parts = np.array([[0.25], [0.5], [0.75]])
        self.places = np.append(ordered, ordered[:-1] + parts * np.diff(ordered))
        self.mode = max((self._climbed(slope) for slope in STARTS), key=lambda found: found.value)
        self.flat = self.climb(np.zeros(2), (1.0, 0.0))  # the maximum at a constant probability
        self.variance = np.linalg.inv(-self.mode.hessian)

    def at(self, point: Floats) -> _Point:
        """Evaluate the likelihood at an intercept and a slope.

        The Fisher information of a shot, its weight, is greatest for the shot nearest to V50.  Weights relative to this
        one, and velocities relative to its velocity, keep the determinant exact for curves however steep.
        """
        z = point[0] + point[1] * self.x
        if not np.abs(z).max() < MAX_ARGUMENT:
            return _Point(point, -inf, -inf, np.zeros(2), np.zeros((2, 2)))
        nearest = int(np.argmin(np.abs(z)))
        centre, greatest = self.x[nearest], _terms(self.link, z[nearest : nearest + 1], np.ones(1))[1][0]
        moments, log_likelihood = np.zeros((5, 5)), 0.0
        for start in range(0, len(z), BLOCK):
            block = slice(start, start + BLOCK)
            likelihoods, log_weights, slope, bend, first, second = _terms(self.link, z[block], self.signs[block])
            log_likelihood += float(likelihoods.sum())
            weights = np.exp(log_weights - greatest)
            powers = np.vander(self.x[block] - centre, 5, increasing=True)
            sums = (slope, bend, weights, weights * first, weights * (second + first * first))
            moments += np.stack(sums) @ powers
        slope, bend, w, f, g = moments
        determinant = w[0] * w[2] - w[1] * w[1]
        if determinant < MIN_DETERMINANT:
            return _Point(point, -inf, log_likelihood, np.zeros(2), np.zeros((2, 2)))
        by = (f[:2] * w[2] + w[0] * f[2:4] - 2.0 * w[1] * f[1:3]) / determinant
        order = np.add.outer((0, 1), (0, 1))
        cross = np.outer(f[:2], f[2:4])
        bys = g[order] * w[2] + w[0] * g[2 + order] - 2.0 * w[1] * g[1 + order]
        bys += cross + cross.T - 2.0 * np.outer(f[1:3], f[1:3])
        gradient = slope[:2] + 0.5 * by
        hessian = bend[order] + 0.5 * (bys / determinant - np.outer(by, by))
        shift = np.array([[1.0, 0.0], [centre, 1.0]])
        value = log_likelihood + greatest + 0.5 * log(determinant)
        return _Point(point, value, log_likelihood, shift @ gradient, shift @ hessian @ shift.T)

    def _climbed(self, slope: float) -> _Point:
        """Return the maximum found from a slope, with V50 between the highest partial and the lowest complete."""
        middle = 0.5 * float(self.x[self.signs < 0.0].max() + self.x[self.signs > 0.0].min())

        def lost(at: Floats) -> tuple[float, Floats]:
            point = self.at(at)
            return -point.value, -point.gradient

        tolerance = 1e-9 * len(self.x)
        return self.at(
            minimize(lost, np.array([-slope * middle, slope]), jac=True, method="BFGS", options={"gtol": tolerance}).x
        )

    def _values(self, points: Floats) -> Floats:
        """Return the logarithm of the penalised likelihood of few shots at points, (m, 2) -> (m,)."""
        likelihoods, log_weights, *_ = _terms(self.link, points[:, :1] + points[:, 1:] * self.x, self.signs)
        greatest = log_weights.max(axis=1)
        weights = np.exp(log_weights - greatest[:, None])
        total = weights.sum(axis=1)
        centre = weights @ self.x / total
        determinants = total * (weights * (self.x - centre[:, None]) ** 2).sum(axis=1)
        found: Floats = likelihoods.sum(axis=1) + greatest + 0.5 * np.log(np.maximum(determinants, MIN_DETERMINANT))
        return found

    def with_value(self, z: float, x: float, near: Floats) -> _Point:
        """Return the maximum over the curves whose argument of F has a value at a velocity."""
        slopes = np.append(near[1], SLOPES if self.few else [])
        return self._highest(np.column_stack([z - slopes * x, slopes]), (-x, 1.0))

    def with_slope(self, slope: float, near: Floats) -> _Point:
        """Return the maximum over the curves of a slope."""
        places = np.append(-near[0] / near[1], self.places if self.few else [])
        return self._highest(np.column_stack([-slope * places, np.full(len(places), slope)]), (1.0, 0.0))

    def _highest(self, starts: Floats, direction: tuple[float, float]) -> _Point:
        """Return the maximum along a line, from the best of some starts."""
        return self.climb(starts[np.argmax(self._values(starts))] if len(starts) > 1 else starts[0], direction)

    def climb(self, start: Floats, direction: tuple[float, float]) -> _Point:
        """Return the maximum along a line by Newton's method; the slope is kept from falling below 0."""
        point, along = self.at(start), np.array(direction)
        reach = MAX_CHANGE / max(abs(direction[0] + direction[1] * x) for x in (self.x.min(), self.x.max()))
        for _ in range(MAX_STEPS):
            first, second = float(point.gradient @ along), float(along @ point.hessian @ along)
            step = min(max(first / -second if second < 0.0 else copysign(inf, first), -reach), reach)
            if direction[1]:
                step = max(step, -float(point.at[1]))
            beyond = point
            while abs(first * step) > MIN_GAIN and beyond.value <= point.value:
                beyond = self.at(point.at + step * along)
                step *= 0.5
            if beyond.value <= point.value:
                break
            point = beyond
        return point

    def holds(self, point: _Point) -> bool:
        """Return whether a point is in the confidence region."""
        return 2.0 * (self.mode.value - point.value) <= self.root**2

    def bound(self, profile: "_Profile", start: float, gradient: Sequence[float], direction: float) -> float:
        """Return the end of the interval of a quantity, from its estimate in a direction; infinite if there is none.

        The profile gives the maximum for a value of the quantity, from a point near it; the gradient of the quantity by
        intercept and slope gives the first step.
        """
        step = direction * 1.1 * self.root * sqrt(float(np.array(gradient) @ self.variance @ np.array(gradient)))
        near, known = self.mode.at, {start: -self.root}

        def excess(value: float) -> float:
            """Return the root of the deviance, which is nearly linear in the quantity, less that at the end."""
            nonlocal near
            if value not in known:
                found = profile(value, near)
                near = near if found.value == -inf else found.at
                deviance = 2.0 * max(self.mode.value - found.value, 0.0)
                known[value] = min(sqrt(deviance), MAX_DISTANCE) - self.root
            return known[value]

        inner, end = start, start + step
        while abs(end - start) < MAX_DISTANCE:
            if excess(end) > 0.0:
                return float(brentq(excess, inner, end, xtol=1e-6 * abs(step)))
            step *= 2.0
            inner, end = end, end + step
        return direction * inf

    def quantile_interval(self, z: float) -> tuple[float, float]:
        """Return the ends of the interval of the velocity at which the argument of F has a value."""
        (a, b), flat = self.mode.at, self.flat
        location = (z - a) / b

        def profile(location: float, near: Floats) -> _Point:
            return self.with_value(z, location, near)

        def end(direction: float) -> float:
            # Far away the slope is 0 and the probability constant: at most that of the quantile above, else at least.
            farthest = flat if direction * (z - flat.at[0]) >= 0.0 else self.at(np.array([z, 0.0]))
            if self.holds(farthest):
                return direction * inf
            return self.bound(profile, location, (-1.0 / b, -location / b), direction)

        return end(-1.0), end(1.0)

    def scale_interval(self) -> tuple[float, float]:
        """Return the ends of the interval of the scale, the inverse of the slope."""
        b = float(self.mode.at[1])

        def profile(log_scale: float, near: Floats) -> _Point:
            return self.with_slope(exp(-log_scale), near)

        def end(direction: float) -> float:
            return exp(self.bound(profile, -log(b), (0.0, 1.0 / b), direction))

        return end(-1.0), inf if self.holds(self.flat) else end(1.0)

    def argument_interval(self, x: float) -> tuple[float, float]:
        """Return the ends of the interval of the argument of F at a velocity."""
        a, b = self.mode.at

        def profile(z: float, near: Floats) -> _Point:
            return self.with_value(z, x, near)

        low, high = (self.bound(profile, a + b * x, (1.0, x), direction) for direction in (-1.0, 1.0))
        return low, high


_Profile = Callable[[float, Floats], _Point]


def _terms(link: Link, z: Floats, signs: Floats) -> tuple[Floats, ...]:
    """Return the terms of shots at arguments of F.

    These are the log-likelihood, the logarithm of the Fisher information, and the first and the second derivative by
    the argument, of the former and of the latter.
    """
    # Density over F and over 1 - F, and the derivatives of the logarithm of the density.
    if link == "probit":
        # The hazard of the tail beyond |z| has no cancellation.
        hazard, log_density = sqrt(2.0 / pi) / erfcx(np.abs(z) * sqrt(0.5)), -0.5 * z * z - 0.5 * log(2.0 * pi)
        log_tail = log_density - np.log(hazard)
        log_rest = np.log1p(-np.exp(log_tail))
        rest, left = np.exp(log_density - log_rest), z < 0.0
        log_f, log_s = np.where(left, log_tail, log_rest), np.where(left, log_rest, log_tail)
        up, down = np.where(left, hazard, rest), np.where(left, rest, hazard)
        log_weights, slope, bend = log_density + np.log(hazard) - log_rest, -z, -np.ones_like(z)
    else:
        log_f, log_s = log_expit(z), log_expit(-z)
        up, down, log_weights = np.exp(log_s), np.exp(log_f), log_f + log_s
        slope, bend = up - down, -2.0 * up * down
    up_slope, down_slope = up * (slope - up), down * (slope + down)
    complete = signs > 0.0
    return (
        np.where(complete, log_f, log_s),
        log_weights,
        np.where(complete, up, -down),
        np.where(complete, up_slope, -down_slope),
        2.0 * slope - up + down,
        2.0 * bend - up_slope + down_slope,
    )


def fit_penalised(
    partial: Sequence[float], complete: Sequence[float], link: Link, confidence: float = CONFIDENCE
) -> FittedCurve | None:
    """Fit a curve to the velocities of partial and complete penetrations, m/s, by penalised maximum likelihood.

    None where the penalised likelihood is greatest for a curve that does not rise.
    """
    mean, deviation, x, signs = standardised(partial, complete)
    shots = _Likelihood(link, x, signs, confidence)
    a, b = shots.mode.at.tolist()
    if b <= 0.0:
        return None
    location, scale, z = mean - deviation * a / b, deviation / b, Z95[link]
    if location <= 0.0:
        return None
    v05, v50, v95 = (
        (bounded(mean + deviation * low), bounded(mean + deviation * high))
        for low, high in (shots.quantile_interval(each) for each in (-z, 0.0, z))
    )
    narrowest, widest = shots.scale_interval()
    return FittedCurve(
        curve=link,
        v50_m_s=location,
        v50_interval_m_s=v50,
        scale_m_s=scale,
        scale_interval_m_s=(deviation * narrowest, bounded(deviation * widest)),
        log_likelihood=shots.mode.log_likelihood,
        v05_m_s=bounded(location - z * scale),
        v95_m_s=location + z * scale,
        method="penalised likelihood",
        v05_interval_m_s=v05,
        v95_interval_m_s=v95,
    )


def penalised_band(
    partial: Sequence[float],
    complete: Sequence[float],
    link: Link,
    velocities_m_s: Sequence[float],
    confidence: float = CONFIDENCE,
) -> tuple[Floats, Floats]:
    """Return the pointwise confidence interval of the probability at ascending velocities, m/s, from low to high."""
    # Slow to import, and only charts need it.
    from scipy.interpolate import PchipInterpolator

    mean, deviation, x, signs = standardised(partial, complete)
    shots = _Likelihood(link, x, signs, confidence)
    wanted = (np.array(velocities_m_s) - mean) / deviation
    nodes = np.linspace(wanted[0], wanted[-1], BAND_NODES)
    ends = np.array([shots.argument_interval(float(node)) for node in nodes])
    low, high = CDFS[link](PchipInterpolator(nodes, ends.clip(-FARTHEST, FARTHEST))(wanted)).T
    return low, high
