"""Compare the V50s of two lots: their difference, with an interval and a p value, if both lots have one scatter."""

from dataclasses import dataclass
from math import exp, inf, log, sqrt

import numpy as np
from scipy.optimize import minimize
from scipy.special import ndtr, ndtri

from armour.analysis.variants import Floats
from armour.statistics.curves import STARTS, Interval, ShotLikelihood, profile_end

# The farthest difference that is tried, and the widest scale, in standard deviations of the velocities of a lot.
FARTHEST, WIDEST = 1e3, 1e6


@dataclass(frozen=True)
class V50Difference:
    """Difference of the V50s of two lots that have one scatter, by penalised profile likelihood.

    Attributes
    ----------
    difference_m_s : float
        V50 of the second lot minus that of the first, m/s.
    interval_m_s : tuple of float or None
        Confidence interval of the difference, m/s; None for an end that the shots do not bound.
    confidence : float
        Confidence level of the interval.
    p_value : float
        Probability of a deviance as large as that of no difference, if there is none; of several comparisons,
        multiplied by their number, at most 1.
    scatter_m_s : float
        The common scatter, m/s.
    """

    difference_m_s: float
    interval_m_s: Interval
    confidence: float
    p_value: float
    scatter_m_s: float


class TwoLots:
    """Likelihood of two curves with one scale, times the Jeffreys prior of their three parameters.

    A point, (3,), has the intercepts of both curves and the logarithm of the scale, m/s.
    """

    def __init__(self, first: ShotLikelihood, second: ShotLikelihood) -> None:
        # `apart` is the difference of the mean velocities, m/s, and `unit` the greater standard deviation, m/s.
        self.lots, self.apart = (first, second), second.mean - first.mean
        self.unit = max(first.deviation, second.deviation)
        self.log_scales = log(self.unit / WIDEST), log(self.unit * WIDEST)
        intercepts = [lot.mode.intercept for lot in self.lots]
        scales = [lot.deviation / max(lot.mode.slope, STARTS[0]) for lot in self.lots]
        starts = [np.array([*intercepts, log(scale)]) for scale in (*scales, sqrt(scales[0] * scales[1]))]
        self.mode = min((self._likeliest_near(start) for start in starts), key=self._loss)
        self.difference = float(self.apart + exp(self.mode[2]) * (self.mode[0] - self.mode[1]))

    def _loss(self, point: Floats) -> float:
        """Return minus the penalised log-likelihood of both curves at a point, (3,)."""
        scale, loss, spread = exp(point[2]), 0.0, -inf
        for lot, intercept in zip(self.lots, point, strict=False):
            curve = np.array([[intercept, lot.deviation / scale]])
            [greatest], [total], [on_slope] = lot.information(curve)
            loss -= float(lot.log_likelihoods(curve[:, :1] + curve[:, 1:] * lot.x)[0] + 0.5 * (greatest + log(total)))
            spread = np.logaddexp(spread, greatest + log(max(on_slope, 1e-200) * lot.deviation**2))
        return float(loss - 0.5 * spread)

    def _likeliest_near(self, start: Floats, difference: float | None = None) -> Floats:
        """Return the likeliest point, (3,), near `start`; the `difference` of the V50s, m/s, is held if it is given."""

        def point(free: Floats) -> Floats:
            """Return the point of the parameters that are not held; its scale stays within `log_scales`."""
            log_scale = free[-1].clip(*self.log_scales)
            second = free[1] if difference is None else free[0] + (self.apart - difference) * exp(-log_scale)
            return np.array([free[0], second, log_scale])

        def loss(free: Floats) -> float:
            """Return minus the log-likelihood of the parameters that are not held."""
            return self._loss(point(free))

        free = start if difference is None else start[[0, 2]]
        return point(minimize(loss, free, method="BFGS", options={"gtol": 1e-4}).x)

    def end(self, direction: float, root: float) -> float | None:
        """Return an end of the interval of the difference, m/s: the upper (1) or lower (-1) one; None if it is open.

        `root` is the square root of the deviance at the end.
        """
        last = self.mode

        def deviance(difference: float) -> float:
            """Return the deviance of a difference of the V50s, m/s, near the last one that was tried."""
            nonlocal last
            last = min((self._likeliest_near(start, difference) for start in (last, self.mode)), key=self._loss)
            return 2.0 * (self._loss(last) - self._loss(self.mode))

        farthest = self.difference + direction * FARTHEST * self.unit
        return profile_end(deviance, self.difference, farthest, root, step=0.3 * self.unit, tolerance=1e-4)

    @property
    def p_value(self) -> float:
        """P value of equal V50s: the probability of a deviance as large as that of no difference, if there is none."""
        deviance = 2.0 * (self._loss(self._likeliest_near(self.mode, 0.0)) - self._loss(self.mode))
        return float(2.0 * ndtr(-sqrt(max(deviance, 0.0))))


def difference_of(first: ShotLikelihood, second: ShotLikelihood, confidence: float) -> V50Difference:
    """Return V50 of the second lot minus that of the first, given their penalised likelihoods, with an interval.

    `confidence` is the level of the interval.
    """
    lots, root = TwoLots(first, second), float(ndtri(0.5 + 0.5 * confidence))
    ends = lots.end(-1.0, root), lots.end(1.0, root)
    return V50Difference(lots.difference, ends, confidence, lots.p_value, exp(lots.mode[2]))
