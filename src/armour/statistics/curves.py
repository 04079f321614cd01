"""Fit the probability of complete penetration over velocity to shots, by plain or penalised maximum likelihood.

A curve is P = F(z) with z = a + b x.  F is the normal or the logistic distribution function, a the intercept and b the
slope; x is the standardised velocity: relative to the mean of the shots' velocities, in their standard deviations.

The penalised likelihood is the likelihood of the shots multiplied by the Jeffreys prior, the square root of the
determinant of the Fisher information of a and b [Firth1993], [Heinze2002].  If the shots are separated, every complete
penetration faster than every partial one, the plain likelihood is greatest at an infinite slope, the penalised one at a
finite slope.  Intervals are of profile likelihood: they contain the values with a deviance, 2 times the loss of
log-likelihood from the maximum, up to a threshold.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import copysign, exp, inf, log, pi, sqrt
from operator import attrgetter
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import expit, log_expit, log_ndtr, logit, ndtr, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.variants import Floats
from armour.errors import NoAnswerError
from armour.scenario.checked import checked

Link = Literal["probit", "logit"]
Velocities = Sequence[float]
Interval = tuple[float | None, float | None]
# Distribution functions F by link, the normal and the logistic one, and their inverses.
CDFS: dict[Link, Callable[[Any], Any]] = {"probit": ndtr, "logit": expit}
INVERSE_CDFS: dict[Link, Callable[[float], Any]] = {"probit": ndtri, "logit": logit}
# Logarithm of F(z), and of the Fisher information of a shot about z.
LOG_CDFS: dict[Link, Callable[[Floats], Floats]] = {"probit": log_ndtr, "logit": log_expit}
LOG_INFORMATION: dict[Link, Callable[[Floats], Floats]] = {
    "probit": lambda z: -z * z - log(2.0 * pi) - log_ndtr(z) - log_ndtr(-z),
    "logit": lambda z: log_expit(z) + log_expit(-z),
}
# z at a probability of 0.95.
Z95: dict[Link, float] = {link: float(quantile(0.95)) for link, quantile in INVERSE_CDFS.items()}
# Slopes to search, and the slope that stands for an infinite one.
SLOPES, STEEP = np.geomspace(1e-6, 5e3, 81), 2.0**20
# Slopes to start from in search of all maxima: flatter curves than the first all fit alike.
STARTS = np.geomspace(1e-2, 5e3, 97)
# Intercepts to search: from z = -BEYOND at the fastest shot to z = BEYOND at the slowest, and their number.
BEYOND, INTERCEPTS = 8.0, 61
# A search is repeated NARROWINGS times between the neighbours of the likeliest point, each time with NODES points.
NARROWINGS, NODES = 4, 21
# Number of velocities at which a band is computed.
BAND_NODES = 13
# In the penalty, velocities are clipped to the middle range of the shots, which leaves out one in OUTER at either end,
# and FAR times this range to either side.  Otherwise a nearly flat curve would gain information with the distance of a
# single far shot.
FAR, OUTER = 2.0, 8


@dataclass(frozen=True)
class FittedCurve:
    """Probability of complete penetration over velocity, with profile-likelihood intervals.

    Attributes
    ----------
    curve : str
        "probit", a normal distribution of the velocities that perforate, or "logit", a logistic one.
    v50_m_s : float
        Velocity of probability one half, m/s.  For separated shots, maximum likelihood gives the middle of their gap.
    v50_interval_m_s : tuple of float or None
        Confidence interval of V50, m/s; None for an end that the shots do not bound.
    scale_m_s : float
        Standard deviation of the normal or scale of the logistic distribution, m/s.  For separated shots, maximum
        likelihood gives 0.
    scale_interval_m_s : tuple of float or None
        Confidence interval of the scale, m/s; None for an upper end that the shots do not bound.
    log_likelihood : float
        Logarithm of the likelihood, without the penalty.
    v05_m_s, v95_m_s : float or None
        Velocities of probability 0.05 and 0.95, m/s; None if the scale is 0 or the velocity is not positive.
    method : str
        "maximum likelihood" or "penalised likelihood".
    v05_interval_m_s, v95_interval_m_s : tuple of float or None, or None
        Confidence intervals of V05 and V95, m/s; None for curves of maximum likelihood.
    v50_lower_m_s, v05_lower_m_s : float or None
        One-sided lower confidence bounds of V50 and V05, m/s, at the confidence level of the intervals; None if the
        shots do not bound them, and for curves of maximum likelihood.
    """

    curve: Link
    v50_m_s: float
    v50_interval_m_s: Interval
    scale_m_s: float
    scale_interval_m_s: tuple[float, float | None]
    log_likelihood: float
    v05_m_s: float | None = None
    v95_m_s: float | None = None
    method: Literal["maximum likelihood", "penalised likelihood"] = "maximum likelihood"
    v05_interval_m_s: Interval | None = None
    v95_interval_m_s: Interval | None = None
    v50_lower_m_s: float | None = None
    v05_lower_m_s: float | None = None

    @checked
    def probability(self, velocity_m_s: float) -> float:
        """Return the probability of complete penetration at a velocity, m/s."""
        if self.scale_m_s == 0.0:
            return 0.5 * (1.0 + (velocity_m_s > self.v50_m_s) - (velocity_m_s < self.v50_m_s))
        return float(CDFS[self.curve]((velocity_m_s - self.v50_m_s) / self.scale_m_s))


def profile_end(
    deviance: Callable[[float], float], estimate: float, farthest: float, root: float, step: float, tolerance: float
) -> float | None:
    """Return the end of the profile-likelihood interval of a quantity on one side of its estimate.

    The side is that of `farthest`; the end is None if the interval reaches beyond it.

    Parameters
    ----------
    deviance : callable
        Deviance of a value of the quantity: 2 times the greatest log-likelihood minus that with the value held.
    estimate, farthest : float
    root : float
        Square root of the deviance at the end.  This root is nearly linear in the quantity.
    step : float
        The first step from the estimate; each further one is twice as long.
    tolerance : float
        Tolerance of the end, in the unit of the quantity.
    """

    @cache
    def excess(value: float) -> float:
        """Return by how much the square root of the deviance of a value exceeds that at the end."""
        return (0.0 if value == estimate else sqrt(max(deviance(value), 0.0))) - root

    near, step = estimate, copysign(step, farthest - estimate)
    while near != farthest:
        far = near + step if abs(step) < abs(farthest - near) else farthest
        if excess(far) > 0.0:
            return float(brentq(excess, near, far, xtol=tolerance))
        near, step = far, 2.0 * step
    return None


class Curve(NamedTuple):
    """The curve F(intercept + slope * x), and its log-likelihood."""

    intercept: float
    slope: float
    value: float  # log-likelihood, with the penalty if there is one


VALUE = attrgetter("value")


def has_curve(partial: Velocities, complete: Velocities) -> bool:
    """Return whether a rising curve fits shots, m/s: of both kinds, the complete penetrations faster on average."""
    return len(partial) > 0 and len(complete) > 0 and bool(np.mean(complete) > np.mean(partial))


class ShotLikelihood:
    """Likelihood of curves given the velocities of partial and complete penetrations, m/s.

    `link` chooses F, and `penalised` multiplies the likelihood by the Jeffreys prior.  In its methods, `z` is an
    argument of F and `x` a standardised velocity, as in the module's docstring; `root` is the square root of the
    deviance at the end of an interval.
    """

    def __init__(self, partial: Velocities, complete: Velocities, link: Link, *, penalised: bool = False) -> None:
        if not has_curve(partial, complete):
            raise NoAnswerError(
                f"no V50: the complete penetrations were no faster on average ({np.mean(complete):.1f} m/s) than the "
                f"partial ones ({np.mean(partial):.1f} m/s); are the results swapped?"
            )
        velocities = np.array([*partial, *complete])
        self.mean, self.deviation = float(velocities.mean()), float(velocities.std())
        x = (velocities - self.mean) / self.deviation
        signs = np.repeat([-1.0, 1.0], [len(partial), len(complete)])
        self.x, self.signs = x, signs
        self.link, self.penalised = link, penalised
        # For any slope, V50 is near a shot or between two neighbours.
        ordered = np.unique(x)
        between = ordered[:-1] + np.array([[0.25], [0.5], [0.75]]) * np.diff(ordered)
        lowest, highest = float(x[signs < 0.0].max()), float(x[signs > 0.0].min())
        self.middle, self.separated = 0.5 * (lowest + highest), lowest <= highest and not penalised
        # With few shots, V50 is searched for between any two: the penalised likelihood can have several maxima.
        self.v50_places = np.append(ordered, between) if len(x) <= 60 else np.array([self.middle])
        low, high = np.sort(x)[[len(x) // OUTER, -1 - len(x) // OUTER]]
        self.nearby = low - FAR * (high - low), high + FAR * (high - low)
        if self.separated:
            # All V50s in the gap are equally likely.  If both kinds share a velocity in place of a gap, the probability
            # at it is that of its complete penetrations.
            share = (signs[x == lowest] > 0.0).mean() if lowest == highest else 0.5
            self.mode = self._curve(np.array([INVERSE_CDFS[link](share) - STEEP * self.middle, STEEP]))
        else:
            self.mode = self._likeliest()
        self.flat = self.with_slope(0.0)  # the maximum at a constant probability

    def _likeliest(self) -> Curve:
        """Return the likeliest curve of all.

        Each maximum over a grid of slopes is refined: the penalised likelihood can have several.
        """
        lines = [_points_with_slope(self._intercepts(slope), slope) for slope in STARTS]
        values = [self._penalised(points) for points in lines]
        profile = np.array([each.max() for each in values])
        return max((self._likeliest_near(lines[i][values[i].argmax()]) for i in _maxima(profile)), key=VALUE)

    def _likeliest_near(self, start: Floats) -> Curve:
        """Return the curve at the maximum of the likelihood near a point, an intercept and a slope, (2,)."""
        simplex = start + np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.1 * max(start[1], 0.1)]])
        options: Any = {"initial_simplex": simplex, "xatol": 1e-9, "fatol": 1e-13}
        return self._curve(minimize(self._loss, start, method="Nelder-Mead", options=options).x)

    def log_likelihoods(self, z: Floats) -> Floats:
        """Return the log-likelihood of all n shots for each of m curves, (m,).

        `z`, (m, n), is intercept + slope * x of each curve at each shot.
        """
        return LOG_CDFS[self.link](self.signs * z).sum(axis=1)

    def _penalised(self, points: Floats) -> Floats:
        """Return the log-likelihoods of m curves, (m,), with the penalty if the likelihood is penalised.

        `points`, (m, 2), are their intercepts and slopes.
        """
        z = points[:, :1] + points[:, 1:] * self.x
        values = self.log_likelihoods(z)
        if self.penalised:
            greatest, total, spread = self.information(points)
            values = values + greatest + 0.5 * np.log(np.maximum(total * spread, 1e-200))
        return values

    def information(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the Fisher information of the shots on m curves, given by intercepts and slopes, (m, 2).

        These are, (m,) each, the logarithm of the greatest information of a shot and, relative to it, the information
        on the intercept, and that on the slope about the mean velocity, weighted by the information.  The determinant
        is the product of the last two.
        """
        # Information relative to the greatest of a shot, and velocities relative to their centre, keep the
        # determinant exact for any steepness of the curves.
        x = self.x if self.nearby[0] == self.nearby[1] else self.x.clip(*self.nearby)
        log_weights = LOG_INFORMATION[self.link](points[:, :1] + points[:, 1:] * x)
        greatest = log_weights.max(axis=1)
        weights = np.exp(log_weights - greatest[:, None])
        total = weights.sum(axis=1)
        centre = weights @ x / total
        spread = (weights * (x - centre[:, None]) ** 2).sum(axis=1)
        return greatest, total, spread

    def _loss(self, point: Floats) -> float:
        """Return minus the log-likelihood of a curve, with the penalty if there is one, at a point, (2,)."""
        return -float(self._penalised(point[None])[0])

    def _curve(self, point: Floats) -> Curve:
        """Return the curve of a point, an intercept and a slope, (2,), with its log-likelihood."""
        return Curve(float(point[0]), float(point[1]), -self._loss(point))

    def _likeliest_of(self, family: Callable[[Floats], Floats], nodes: Floats) -> Curve:
        """Return the likeliest curve of a family with one parameter, by refining each maximum on a grid of it.

        `family` returns the intercepts and slopes, (m, 2), of the curves with m values of the parameter; `nodes` are
        the first values, ascending.
        """
        return max((self._narrowed(family, nodes, i) for i in _maxima(self._penalised(family(nodes)))), key=VALUE)

    def _narrowed(self, family: Callable[[Floats], Floats], nodes: Floats, best: int) -> Curve:
        """Return the likeliest curve of a family near that of the node at the index `best`."""
        for _ in range(NARROWINGS):
            nodes = np.linspace(nodes[max(best - 1, 0)], nodes[min(best + 1, len(nodes) - 1)], NODES)
            points = family(nodes)
            best = int(self._penalised(points).argmax())
        return self._curve(points[best])

    def with_value(self, z: float, x: float) -> Curve:
        """Return the likeliest of the curves through a point: the probability F(z) at the standardised velocity `x`."""
        return self._likeliest_of(lambda slopes: np.column_stack([z - slopes * x, slopes]), SLOPES)

    def with_slope(self, slope: float) -> Curve:
        """Return the likeliest of the curves that have this slope."""
        return self._likeliest_of(lambda intercepts: _points_with_slope(intercepts, slope), self._intercepts(slope))

    def _intercepts(self, slope: float) -> Floats:
        """Return ascending intercepts to try with a slope, (n,); the likeliest one is near one of them."""
        ends = -BEYOND - slope * self.x.max(), BEYOND - slope * self.x.min()
        return np.unique(np.append(np.linspace(*ends, INTERCEPTS), -slope * self.v50_places).round(9))

    def holds(self, curve: Curve, root: float) -> bool:
        """Return whether a curve is in the confidence region: its deviance is at most `root` squared."""
        return 2.0 * (self.mode.value - curve.value) <= root**2

    def bound(self, profile: Callable[[float], Curve], start: float, direction: float, root: float) -> float:
        """Return the end of the interval of a quantity on one side of its estimate, `start`; infinite without an end.

        `profile` returns the likeliest curve with a given value of the quantity.  `direction` is -1 for the lower end
        and 1 for the upper one; `root` is the square root of the deviance at the end.
        """

        def deviance(value: float) -> float:
            """Return the deviance of a value of the quantity."""
            return 2.0 * (self.mode.value - profile(value).value)

        end = profile_end(deviance, start, start + direction * 1e3, root, step=0.3, tolerance=1e-9)
        return direction * inf if end is None else end

    def quantile_end(self, z: float, direction: float, root: float) -> float:
        """Return an end of the confidence interval of the standardised velocity at which the probability is F(z).

        `direction` is -1 for the lower end and 1 for the upper one.  `root` is the square root of the deviance that
        bounds the interval.  The end is infinite if the interval has none on this side.
        """
        # As the velocity goes to infinity, the likeliest curve with the probability F(z) there becomes flat: the best
        # constant probability of at most F(z) for the upper end, of at least F(z) for the lower one.  If the confidence
        # region contains this curve, the interval has no end on this side.
        is_allowed = direction * (z - self.flat.intercept) >= 0.0
        curve_at_infinity = self.flat if is_allowed else self._curve(np.array([z, 0.0]))
        if self.holds(curve_at_infinity, root):
            return direction * inf
        estimate = (z - self.mode.intercept) / self.mode.slope
        return self.bound(lambda location: self.with_value(z, location), estimate, direction, root)

    def velocity_interval(self, z: float, confidence: float) -> Interval:
        """Return the confidence interval of the velocity, m/s, at which shots perforate with the probability F(z)."""
        root = float(ndtri(0.5 + 0.5 * confidence))
        low, high = (bounded(self.mean + self.deviation * self.quantile_end(z, side, root)) for side in (-1.0, 1.0))
        return low, high

    def lower_bound(self, z: float, confidence: float) -> float | None:
        """Return the one-sided lower bound of the velocity, m/s, at which shots perforate with the probability F(z)."""
        return bounded(self.mean + self.deviation * self.quantile_end(z, -1.0, float(ndtri(confidence))))

    def probability_interval(self, velocity_m_s: float, confidence: float) -> tuple[float, float]:
        """Return the confidence interval of the probability of complete penetration at a velocity, m/s."""
        x, root = (velocity_m_s - self.mean) / self.deviation, float(ndtri(0.5 + 0.5 * confidence))
        low, high = (float(CDFS[self.link](end)) for end in self.argument_interval(x, root))
        return low, high

    def chance_below(self, z: float, velocity_m_s: float) -> float:
        """Return the risk of taking the velocity of the probability F(z) to be above `velocity_m_s`, m/s.

        It is 1 minus the confidence at which `lower_bound` is this velocity.
        """
        x = (velocity_m_s - self.mean) / self.deviation
        deviance = 2.0 * max(self.mode.value - self.with_value(z, x).value, 0.0)
        return float(ndtr(copysign(sqrt(deviance), x - (z - self.mode.intercept) / self.mode.slope)))

    @property
    def flat_deviance(self) -> float:
        """Deviance of a constant probability: an interval of V50 is bounded if the deviance at its ends is smaller."""
        return 2.0 * (self.mode.value - self.flat.value)

    def scale_interval(self, root: float) -> tuple[float, float]:
        """Return the ends of the interval of the scale, 1 / slope of the standardised velocity, 0 or infinite if open.

        `root` is the square root of the deviance at the ends.
        """

        def end(direction: float) -> float:
            """Return the lower (-1) or upper (1) end, which is searched for on a logarithmic axis."""
            estimate = -log(self.mode.slope)
            return exp(self.bound(lambda log_scale: self.with_slope(exp(-log_scale)), estimate, direction, root))

        return 0.0 if self.separated else end(-1.0), inf if self.holds(self.flat, root) else end(1.0)

    def argument_interval(self, x: float, root: float) -> tuple[float, float]:
        """Return the ends of the interval of z, the argument of F, at the standardised velocity `x`.

        `root` is the square root of the deviance at the ends.
        """
        start = self.mode.intercept + self.mode.slope * x
        low, high = (self.bound(lambda z: self.with_value(z, x), start, side, root) for side in (-1.0, 1.0))
        return low, high


def _maxima(values: Floats) -> list[int]:
    """Return the indices of the local maxima of values, (n,); of equal neighbours, that of the first."""
    values = values.round(9)  # beyond which log-likelihoods differ by rounding alone
    return np.flatnonzero((values > np.append(-inf, values[:-1])) & (values >= np.append(values[1:], -inf))).tolist()


def _points_with_slope(intercepts: Floats, slope: float) -> Floats:
    """Return m curves that have one slope, as intercepts and slopes, (m, 2)."""
    return np.column_stack([intercepts, np.full(len(intercepts), slope)])


def fit_curve(
    partial: Velocities, complete: Velocities, link: Link, confidence: float = CONFIDENCE, *, penalised: bool = False
) -> FittedCurve | None:
    """Fit a curve to the velocities of partial and complete penetrations, m/s, by maximum likelihood, or penalised.

    `link` chooses the curve; `confidence` is the level of its intervals.  Return None if the penalised likelihood is
    greatest for a curve that does not rise, or whose V50 is not positive.
    """
    return curve_of(ShotLikelihood(partial, complete, link, penalised=penalised), confidence)


def curve_of(shots: ShotLikelihood, confidence: float) -> FittedCurve | None:
    """Return the likeliest curve with its intervals, given the likelihood of the shots; None as in `fit_curve`."""
    (a, b, _), mean, deviation, z95 = shots.mode, shots.mean, shots.deviation, Z95[shots.link]
    penalised, v50 = shots.penalised, mean + deviation * (shots.middle if shots.separated else -a / b)
    if penalised and (b <= 0.0 or v50 <= 0.0):
        return None
    scale = 0.0 if shots.separated else deviation / b
    narrowest, widest = shots.scale_interval(float(ndtri(0.5 + 0.5 * confidence)))
    return FittedCurve(
        curve=shots.link,
        v50_m_s=v50,
        v50_interval_m_s=shots.velocity_interval(0.0, confidence),
        scale_m_s=scale,
        scale_interval_m_s=(deviation * narrowest, bounded(deviation * widest)),
        log_likelihood=float(shots.log_likelihoods((a + b * shots.x)[None])[0]),
        v05_m_s=bounded(v50 - z95 * scale) if scale else None,
        v95_m_s=bounded(v50 + z95 * scale) if scale else None,
        method="penalised likelihood" if penalised else "maximum likelihood",
        v05_interval_m_s=shots.velocity_interval(-z95, confidence) if penalised else None,
        v95_interval_m_s=shots.velocity_interval(z95, confidence) if penalised else None,
        v50_lower_m_s=shots.lower_bound(0.0, confidence) if penalised else None,
        v05_lower_m_s=shots.lower_bound(-z95, confidence) if penalised else None,
    )


def bounded(value: float) -> float | None:
    """Return a velocity or scale, m/s, or None in place of one that is infinite or not positive."""
    return value if 0.0 < value < inf else None


def penalised_band(
    partial: Velocities, complete: Velocities, link: Link, velocities_m_s: Velocities, confidence: float = CONFIDENCE
) -> tuple[Floats, Floats]:
    """Return the lower and upper ends, (n,), of the pointwise confidence intervals of the probability at n velocities.

    They are those of the penalised curve of a link, fitted to `partial` and `complete` penetrations; all velocities are
    in m/s.  For more than BAND_NODES different ones, the intervals are interpolated.
    """
    shots = ShotLikelihood(partial, complete, link, penalised=True)
    root = float(ndtri(0.5 + 0.5 * confidence))
    standardised = (np.array(velocities_m_s) - shots.mean) / shots.deviation
    different, places = np.unique(standardised, return_inverse=True)
    nodes = np.linspace(different[0], different[-1], BAND_NODES) if len(different) > BAND_NODES else different
    ends = np.array([shots.argument_interval(float(node), root) for node in nodes]).clip(-40.0, 40.0)
    if len(different) > BAND_NODES:
        # Slow to import, and only charts need it.
        from scipy.interpolate import PchipInterpolator

        ends = PchipInterpolator(nodes, ends)(different)
    low, high = CDFS[link](ends[places]).T
    return low, high
