"""Probability of complete penetration over velocity, fitted to shots by maximum likelihood, plain or penalised.

The likelihood of P = F(a + b x), x a standardised velocity, is that of the shots alone or, penalised, multiplied by the
Jeffreys prior, the square root of the determinant of the Fisher information of a and b [Firth1993], [Heinze2002].
Where the shots separate, the plain likelihood is greatest at an infinite slope, the penalised one at a finite one.  The
intervals are those of the profile of the likelihood.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import copysign, exp, inf, log, pi, sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import erfcx, expit, log_expit, logit, ndtr, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.errors import NoAnswerError

Link = Literal["probit", "logit"]
Interval = tuple[float | None, float | None]
Method = Literal["maximum likelihood", "penalised likelihood"]
# Distribution functions of the links, the normal and the logistic one, and their inverses.
CDFS: dict[Link, Callable[[Any], Any]] = {"probit": ndtr, "logit": expit}
QUANTILES: dict[Link, Callable[[float], Any]] = {"probit": ndtri, "logit": logit}
# Argument of the distribution function at probability 0.95.
Z95: dict[Link, float] = {link: float(quantile(0.95)) for link, quantile in QUANTILES.items()}
# Slopes, per standard deviation of the velocities, at which the search for the maximum starts, and one for infinity.
STARTS, STEEP = (0.5, 2.0, 8.0, 32.0, 128.0), 2.0**20
# The penalised likelihood of few shots can have several maxima along a line: a climb then starts from the best of some
# points, for lines of all slopes from one of these slopes.
FEW = 60
SLOPES = np.geomspace(0.05, 5e3, 40)
# Greatest change of the argument of F in a step of a climb, the gain at which a climb ends, and its most steps.
MAX_CHANGE, MIN_GAIN, MAX_STEPS = 5.0, 1e-8, 200
# First step in search of the end of an interval, and the distance beyond which there is none.
FIRST_STEP, MAX_DISTANCE = 0.3, 1e3
# Velocities at which a band is computed, between which it is interpolated, and the greatest argument of F at its ends.
BAND_NODES, FARTHEST = 13, 40.0
# Argument of F above which, and determinant of the relative information below which, a curve is too steep.
MAX_ARGUMENT, MIN_DETERMINANT = 1e9, 1e-200


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
        Standard deviation of the normal or scale of the logistic distribution, m/s; of maximum likelihood 0 if the
        shots are separated.
    scale_interval_m_s : tuple of float or None
        Confidence interval of the scale, m/s; None for an upper end that the shots do not bound.
    log_likelihood : float
        Logarithm of the likelihood, without the penalty.
    v05_m_s, v95_m_s : float or None
        Velocities of probability 0.05 and 0.95, m/s; None if the scale is 0 or the velocity is not positive.
    method : str
        "maximum likelihood" or "penalised likelihood".
    v05_interval_m_s, v95_interval_m_s : tuple of float or None, or None
        Their confidence intervals, m/s; None for other curves than those of penalised likelihood.
    v50_lower_m_s, v05_lower_m_s : float or None
        One-sided lower confidence bounds of V50 and V05, m/s, at the confidence level of the intervals; None if the
        shots do not bound them, and for other curves than those of penalised likelihood.
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
    v50_lower_m_s: float | None = None
    v05_lower_m_s: float | None = None

    def probability(self, velocity_m_s: float) -> float:
        """Return the probability of complete penetration at a velocity, m/s."""
        if self.scale_m_s == 0.0:
            return 0.5 * (1.0 + (velocity_m_s > self.v50_m_s) - (velocity_m_s < self.v50_m_s))
        return float(CDFS[self.curve]((velocity_m_s - self.v50_m_s) / self.scale_m_s))


class _Point(NamedTuple):
    """Logarithm of the likelihood, with and without the penalty, at an intercept and a slope."""

    at: Floats
    value: float
    log_likelihood: float
    gradient: Floats  # (2,)
    hessian: Floats  # (2, 2)


class Likelihood:
    """Likelihood of the velocities of partial and complete penetrations, with its maximum and confidence region."""

    def __init__(
        self,
        partial: Sequence[float],
        complete: Sequence[float],
        link: Link,
        confidence: float = CONFIDENCE,
        *,
        penalised: bool = False,
    ) -> None:
        if np.mean(complete) <= np.mean(partial):
            raise NoAnswerError(
                f"no V50: the complete penetrations were no faster on average ({np.mean(complete):.1f} m/s) than the "
                f"partial ones ({np.mean(partial):.1f} m/s)"
            )
        velocities = np.array([*partial, *complete])
        self.mean, self.deviation = float(velocities.mean()), float(velocities.std())
        self.x = x = (velocities - self.mean) / self.deviation
        self.signs = np.repeat([-1.0, 1.0], [len(partial), len(complete)])
        self.link, self.penalised = link, penalised
        self.root = float(ndtri(0.5 + 0.5 * confidence))
        # Where the slope is given, V50 is near a shot or between two neighbours.
        self.few, ordered = penalised and len(x) <= FEW, np.unique(x)
        parts = np.array([[0.25], [0.5], [0.75]])
        self.places = np.append(ordered, ordered[:-1] + parts * np.diff(ordered))
        lowest, highest = float(x[self.signs < 0.0].max()), float(x[self.signs > 0.0].min())
        self.middle, self.separated = 0.5 * (lowest + highest), lowest <= highest and not penalised
        if self.separated:
            # Any velocity in the gap is as likely, and any probability at a velocity that both kinds share.
            share = (self.signs[x == lowest] > 0.0).mean() if lowest == highest else 0.5
            self.mode = self.at(np.array([QUANTILES[link](share) - STEEP * self.middle, STEEP]))
        else:
            self.mode = max((self._climbed(slope) for slope in STARTS), key=lambda point: point.value)
        self.flat = self.climb(np.zeros(2), (1.0, 0.0))  # the maximum at a constant probability

    def at(self, point: Floats) -> _Point:
        """Evaluate the likelihood at an intercept and a slope.

        The Fisher information of a shot, its weight, is greatest for the shot nearest to V50.  Weights relative to this
        one, and velocities relative to its velocity, keep the determinant exact for curves however steep.
        """
        z = point[0] + point[1] * self.x
        if not np.abs(z).max() < MAX_ARGUMENT:
            return _Point(point, -inf, -inf, np.zeros(2), np.zeros((2, 2)))
        likelihoods, log_weights, slope, bend, first, second = _terms(self.link, z, self.signs)
        log_likelihood, nearest = float(likelihoods.sum(initial=0.0)), int(np.argmin(np.abs(z)))
        centre, greatest = self.x[nearest], log_weights[nearest]
        weights = np.exp(log_weights - greatest)
        sums = np.stack((slope, bend, weights, weights * first, weights * (second + first * first)))
        slope, bend, w, f, g = sums @ np.vander(self.x - centre, 5, increasing=True)
        order = np.add.outer((0, 1), (0, 1))
        value, gradient, hessian = log_likelihood, slope[:2], bend[order]
        if self.penalised:
            determinant = w[0] * w[2] - w[1] * w[1]
            if determinant < MIN_DETERMINANT:
                return _Point(point, -inf, log_likelihood, np.zeros(2), np.zeros((2, 2)))
            by = (f[:2] * w[2] + w[0] * f[2:4] - 2.0 * w[1] * f[1:3]) / determinant
            cross = np.outer(f[:2], f[2:4])
            bys = g[order] * w[2] + w[0] * g[2 + order] - 2.0 * w[1] * g[1 + order]
            bys += cross + cross.T - 2.0 * np.outer(f[1:3], f[1:3])
            value += greatest + 0.5 * log(determinant)
            gradient = gradient + 0.5 * by
            hessian = hessian + 0.5 * (bys / determinant - np.outer(by, by))
        shift = np.array([[1.0, 0.0], [centre, 1.0]])
        return _Point(point, value, log_likelihood, shift @ gradient, shift @ hessian @ shift.T)

    def _climbed(self, slope: float) -> _Point:
        """Return the maximum found from a slope, with V50 between the highest partial and the lowest complete."""

        def lost(at: Floats) -> tuple[float, Floats]:
            point = self.at(at)
            return -point.value, -point.gradient

        start = np.array([-slope * self.middle, slope])
        return self.at(minimize(lost, start, jac=True, method="BFGS", options={"gtol": 1e-9 * len(self.x)}).x)

    def _values(self, points: Floats) -> Floats:
        """Return the logarithm of the likelihood of few shots at points, (m, 2) -> (m,)."""
        likelihoods, log_weights, *_ = _terms(self.link, points[:, :1] + points[:, 1:] * self.x, self.signs)
        values: Floats = likelihoods.sum(axis=1)
        if self.penalised:
            greatest = log_weights.max(axis=1)
            weights = np.exp(log_weights - greatest[:, None])
            total = weights.sum(axis=1)
            centre = weights @ self.x / total
            determinants = total * (weights * (self.x - centre[:, None]) ** 2).sum(axis=1)
            values += greatest + 0.5 * np.log(np.maximum(determinants, MIN_DETERMINANT))
        return values

    def with_value(self, z: float, x: float) -> _Point:
        """Return the maximum over the curves whose argument of F has a value at a velocity."""
        slopes = np.append(1.0 if self.separated else self.mode.at[1], SLOPES if self.few else [])
        return self._highest(np.column_stack([z - slopes * x, slopes]), (-x, 1.0))

    def with_slope(self, slope: float) -> _Point:
        """Return the maximum over the curves of a slope."""
        places = np.append(-self.mode.at[0] / self.mode.at[1], self.places if self.few else [])
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

    def holds(self, point: _Point, root: float) -> bool:
        """Return whether a point is in the confidence region."""
        return 2.0 * (self.mode.value - point.value) <= root**2

    def bound(self, profile: Callable[[float], _Point], start: float, direction: float, root: float) -> float:
        """Return the end of the interval of a quantity, from its estimate in a direction; infinite if there is none.

        The profile gives the maximum for a value of the quantity.  The root is that of the deviance at the end.
        """

        @cache
        def excess(value: float) -> float:
            """Return the root of the deviance, which is nearly linear in the quantity, less that at the end."""
            deviance = 0.0 if value == start else 2.0 * max(self.mode.value - profile(value).value, 0.0)
            return min(sqrt(deviance), MAX_DISTANCE) - root

        step = direction * FIRST_STEP
        inner, end = start, start + step
        while abs(end - start) < MAX_DISTANCE:
            if excess(end) > 0.0:
                return float(brentq(excess, inner, end, xtol=1e-9))
            step *= 2.0
            inner, end = end, end + step
        return direction * inf

    def quantile_end(self, z: float, direction: float, root: float) -> float:
        """Return an end of the interval of the velocity at which the argument of F has a value."""
        a, b = self.mode.at
        # Far away the slope is 0 and the probability constant: at most that of the quantile above, else at least.
        far = self.flat if direction * (z - self.flat.at[0]) >= 0.0 else self.at(np.array([z, 0.0]))
        if self.holds(far, root):
            return direction * inf
        return self.bound(lambda location: self.with_value(z, location), (z - a) / b, direction, root)

    def chance_below(self, velocity_m_s: float) -> float:
        """Return 1 minus the confidence of the one-sided lower bound of V50 that lies at a velocity."""
        x, (a, b) = (velocity_m_s - self.mean) / self.deviation, self.mode.at
        deviance = 2.0 * max(self.mode.value - self.with_value(0.0, x).value, 0.0)
        return float(ndtr(copysign(sqrt(deviance), x + a / b)))

    def scale_interval(self) -> tuple[float, float]:
        """Return the ends of the interval of the scale, the inverse of the slope."""

        def end(direction: float) -> float:
            start = -log(self.mode.at[1])
            return exp(self.bound(lambda log_scale: self.with_slope(exp(-log_scale)), start, direction, self.root))

        return 0.0 if self.separated else end(-1.0), inf if self.holds(self.flat, self.root) else end(1.0)

    def argument_interval(self, x: float) -> tuple[float, float]:
        """Return the ends of the interval of the argument of F at a velocity."""
        start = float(self.mode.at @ (1.0, x))
        low, high = (self.bound(lambda z: self.with_value(z, x), start, side, self.root) for side in (-1.0, 1.0))
        return low, high


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


def fit_curve(
    partial: Sequence[float],
    complete: Sequence[float],
    link: Link,
    confidence: float = CONFIDENCE,
    *,
    penalised: bool = False,
) -> FittedCurve | None:
    """Fit a curve to the velocities of partial and complete penetrations, m/s, by maximum likelihood.

    None if the penalised likelihood is greatest for a curve that does not rise, or whose V50 is not positive.
    """
    shots = Likelihood(partial, complete, link, confidence, penalised=penalised)
    (a, b), mean, deviation, z = shots.mode.at.tolist(), shots.mean, shots.deviation, Z95[link]
    v50 = mean + deviation * (shots.middle if shots.separated else -a / b)
    if penalised and (b <= 0.0 or v50 <= 0.0):
        return None
    scale = 0.0 if shots.separated else deviation / b

    def interval(z: float) -> Interval:
        low, high = (bounded(mean + deviation * shots.quantile_end(z, side, shots.root)) for side in (-1.0, 1.0))
        return low, high

    def lower(z: float) -> float | None:
        return bounded(mean + deviation * shots.quantile_end(z, -1.0, float(ndtri(confidence)))) if penalised else None

    narrowest, widest = shots.scale_interval()
    return FittedCurve(
        curve=link,
        v50_m_s=v50,
        v50_interval_m_s=interval(0.0),
        scale_m_s=scale,
        scale_interval_m_s=(deviation * narrowest, bounded(deviation * widest)),
        log_likelihood=shots.mode.log_likelihood,
        v05_m_s=bounded(v50 - z * scale) if scale else None,
        v95_m_s=bounded(v50 + z * scale) if scale else None,
        method="penalised likelihood" if penalised else "maximum likelihood",
        v05_interval_m_s=interval(-z) if penalised else None,
        v95_interval_m_s=interval(z) if penalised else None,
        v50_lower_m_s=lower(0.0),
        v05_lower_m_s=lower(-z),
    )


def bounded(value: float) -> float | None:
    """Return a velocity or scale, m/s, or None if it is none: infinite, or a velocity below 0."""
    return value if 0.0 < value < inf else None


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

    shots = Likelihood(partial, complete, link, confidence, penalised=True)
    wanted = (np.array(velocities_m_s) - shots.mean) / shots.deviation
    nodes = np.linspace(wanted[0], wanted[-1], BAND_NODES)
    ends = np.array([shots.argument_interval(float(node)) for node in nodes])
    low, high = CDFS[link](PchipInterpolator(nodes, ends.clip(-FARTHEST, FARTHEST))(wanted)).T
    return low, high
