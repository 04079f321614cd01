"""Ends of intervals of profile likelihood."""

from collections.abc import Callable
from functools import cache
from math import copysign, sqrt

from scipy.optimize import brentq


def profile_end(
    deviance: Callable[[float], float], estimate: float, farthest: float, root: float, step: float, tolerance: float
) -> float | None:
    """Return the end of the interval of a quantity between its estimate and a farthest value; None if there is none.

    Parameters
    ----------
    deviance : callable
        -2 times the logarithm of the greatest likelihood with a value of the quantity over that with any.
    estimate, farthest : float
    root : float
        Root of the deviance at the end.  The root is nearly linear in the quantity.
    step : float
        The first step from the estimate; each further one is twice as long.
    tolerance : float
        Of the end.
    """

    @cache
    def excess(value: float) -> float:
        return (0.0 if value == estimate else sqrt(max(deviance(value), 0.0))) - root

    near, step = estimate, copysign(step, farthest - estimate)
    while near != farthest:
        far = near + step if abs(step) < abs(farthest - near) else farthest
        if excess(far) > 0.0:
            return float(brentq(excess, near, far, xtol=tolerance))
        near, step = far, 2.0 * step
    return None
