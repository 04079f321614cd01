"""Closed forms that a designer would otherwise use: Florence's ballistic limit and fits of residual velocities.

SI units.  ``1`` is the ceramic, ``2`` the back plate: densities rho, thicknesses h, and the plate's ultimate tensile
strength sigma2 and strain to failure eps2.

References
----------
A. L. Florence, Interaction of projectiles and composite armor, Stanford Research Institute, 1969.
J. G. Hetherington and B. P. Rajagopalan, An investigation into the energy absorbed during ballistic perforation of
composite armours, International Journal of Impact Engineering 11 (1991).
J. P. Lambert and G. H. Jonas, Towards standardization in terminal ballistics testing, BRL report 1852, 1976.
R. F. Recht and T. W. Ipson, Ballistic perforation dynamics, Journal of Applied Mechanics 30 (1963).
"""

from collections.abc import Sequence
from math import pi, sqrt
from typing import NamedTuple

# Exponents among which that of Lambert and Jonas is looked for.
EXPONENTS = (1.0, 20.0)
# Largest ratio of residual to impact velocity far above the limit; more than 1 would be energy from nowhere.
LARGEST_RATIO = 1.0


class Plates(NamedTuple):
    """An armour as Florence's formula sees it."""

    rho1: float
    h1: float
    rho2: float
    h2: float
    sigma2: float
    eps2: float


def conoid_radius(r: float, h1: float) -> float:
    """Radius a of the back plate's area that takes the load: the projectile's and two ceramic thicknesses."""
    return r + 2.0 * h1


def florence_limit(m: float, r: float, plates: Plates) -> float:
    """Ballistic limit after Florence in the form of Hetherington and Rajagopalan, m/s.

    Parameters
    ----------
    m, r : float
        Mass, kg, and radius, m, of the projectile.
    plates : Plates
        The armour.
    """
    area = pi * conoid_radius(r, plates.h1) ** 2
    areal_density = plates.rho1 * plates.h1 + plates.rho2 * plates.h2
    f = m / ((m + areal_density * area) * area)
    return sqrt(plates.eps2 * plates.sigma2 * plates.h2 / (0.91 * m * f))


def florence_split(m: float, r: float, rho1: float, rho2: float, areal_density: float) -> tuple[float, float]:
    """Thicknesses h1 and h2, m, of the highest Florence limit at an areal density, kg/m^2.

    Where ``rho1/(rho2 h2) = (4/a) (1 + pi a^2 A/(m + pi a^2 A))``.  The left side falls with h2 and the right side
    rises, so that there is one solution; none with a positive h1 where the armour is very thin: then a bare plate.
    """
    from scipy.optimize import brentq

    def ceramic(h2: float) -> float:
        return (areal_density - rho2 * h2) / rho1

    def excess(h2: float) -> float:
        a = conoid_radius(r, ceramic(h2))
        loaded = pi * a * a * areal_density
        return rho1 / (rho2 * h2) - 4.0 / a * (1.0 + loaded / (m + loaded))

    whole = areal_density / rho2
    if excess(whole) >= 0.0:
        return 0.0, whole
    h2 = float(brentq(excess, 1e-9 * whole, whole, xtol=1e-15))
    return ceramic(h2), h2


class ResidualFit(NamedTuple):
    """Residual velocity as ratio (V^exponent - limit^exponent)^(1/exponent)."""

    ratio: float
    exponent: float
    rms: float  # m/s


def residual_velocity(V: float, limit: float, ratio: float, exponent: float) -> float:
    """Residual velocity after Lambert and Jonas, m/s; exponent 2 is Recht and Ipson's."""
    if limit >= V:
        return 0.0
    # With V taken out of the bracket no power overflows.
    return float(ratio * V * (1.0 - (limit / V) ** exponent) ** (1.0 / exponent))


def fit_lambert_jonas(impact: Sequence[float], residual: Sequence[float], limit: float) -> ResidualFit:
    """Ratio and exponent of the least squares to residual velocities, m/s, of impacts above the limit."""
    from scipy.optimize import minimize_scalar

    best = minimize_scalar(
        lambda exponent: _fit_ratio(impact, residual, limit, exponent).rms,
        bounds=EXPONENTS,
        method="bounded",
        options={"xatol": 1e-6},
    )
    return _fit_ratio(impact, residual, limit, float(best.x))


def fit_recht_ipson(impact: Sequence[float], residual: Sequence[float], limit: float) -> ResidualFit:
    """Ratio of the least squares to residual velocities, m/s, of impacts above the limit; the exponent is 2."""
    return _fit_ratio(impact, residual, limit, 2.0)


def _fit_ratio(impact: Sequence[float], residual: Sequence[float], limit: float, exponent: float) -> ResidualFit:
    """The best ratio for an exponent."""
    shape = [residual_velocity(V, limit, 1.0, exponent) for V in impact]
    ratio = sum(s * v for s, v in zip(shape, residual, strict=True)) / sum(s * s for s in shape)
    ratio = min(max(ratio, 0.0), LARGEST_RATIO)
    squares = sum((ratio * s - v) ** 2 for s, v in zip(shape, residual, strict=True))
    return ResidualFit(ratio, exponent, sqrt(squares / len(shape)))
