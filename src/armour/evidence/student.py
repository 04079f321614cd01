"""Student's t distribution: by quadrature for one armour, as scipy is slow to import, and by scipy for many."""

from math import lgamma

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Quadrature, exact to 1e-12 for two and a half degrees of freedom or more, and the standard deviations it covers.
_OFF_DIAGONAL = np.arange(1.0, 64.0) / np.sqrt(4.0 * np.arange(1.0, 64.0) ** 2 - 1.0)
# Gauss-Legendre by Golub and Welsch: numpy's own function would import all of numpy.polynomial.
NODES, _VECTORS = np.linalg.eigh(np.diag(_OFF_DIAGONAL, 1) + np.diag(_OFF_DIAGONAL, -1))
WEIGHTS = 2.0 * _VECTORS[0] ** 2
COVERED = 9.0
# Tolerance of an angle, and the most steps to it; ten are usual.
TOLERANCE, MOST_STEPS = 1e-14, 100
# Least density to divide by, far beyond any probability of use.
LEAST_DENSITY = 1e-300


def probability_below(freedom: Floats, t: Floats, *, many: bool) -> Floats:
    """Return the probability of less than t, with the broadcast shape."""
    freedom, t = np.broadcast_arrays(freedom, t)
    if many:
        from scipy.special import stdtr  # slow to import

        return np.asarray(stdtr(freedom, t))
    return _below(freedom, _constants(freedom), np.arctan(t / np.sqrt(freedom)))


def quantile(freedom: Floats, probabilities: Floats, *, many: bool) -> Floats:
    """Return the values that are not exceeded with given probabilities, with the broadcast shape."""
    freedom, probabilities = np.broadcast_arrays(freedom, probabilities)
    if many:
        from scipy.special import stdtrit  # slow to import

        values = stdtrit(freedom, probabilities)
    else:
        constants, angle = _constants(freedom), np.zeros(freedom.shape)
        # Newton's method does not pass the root: the function bends one way on each side of 0.
        for _ in range(MOST_STEPS):
            density = np.maximum(constants * np.cos(angle) ** (freedom - 1.0), LEAST_DENSITY)
            step = (probabilities - _below(freedom, constants, angle)) / density
            angle = (angle + step).clip(-0.5 * np.pi, 0.5 * np.pi)
            if not (np.abs(step) > TOLERANCE).any():
                break
        values = np.sqrt(freedom) * np.tan(angle)
    # Versions of scipy give different results at 0 and 1.
    ends = [np.isnan(probabilities), probabilities == 0.0, probabilities == 1.0]
    return np.select(ends, [np.nan, -np.inf, np.inf], values)


def _below(freedom: Floats, constants: Floats, angle: Floats) -> Floats:
    """Return the probability of less than the square root of the freedom times the tangent of an angle.

    The density over the angle is a constant times the power freedom - 1 of its cosine.
    """
    reach = np.minimum(np.abs(angle), COVERED / np.sqrt(freedom))[..., None]
    log_cosines = 0.5 * np.log1p(-(np.sin(0.5 * reach * (1.0 + NODES)) ** 2))
    integral = (0.5 * reach * WEIGHTS * np.exp((freedom[..., None] - 1.0) * log_cosines)).sum(axis=-1)
    return 0.5 + np.sign(angle) * constants * integral


def density_at_0(freedom: Floats) -> Floats:
    """Return the density at t = 0."""
    return _constants(freedom) / np.sqrt(freedom)


def _constants(freedom: Floats) -> Floats:
    """Return the density at an angle of 0: Gamma((freedom + 1) / 2) / (Gamma(freedom / 2) sqrt(pi))."""
    half = 0.5 * freedom
    series = 1.0 - 1.0 / (8.0 * half) + 1.0 / (128.0 * half**2) + 5.0 / (1024.0 * half**3) - 21.0 / (32768.0 * half**4)
    few = [np.exp(lgamma(x + 0.5) - lgamma(x)) if x < 100.0 else np.nan for x in half.ravel().tolist()]
    return np.where(half < 100.0, np.reshape(few, half.shape), np.sqrt(half) * series) / np.sqrt(np.pi)
