"""Simpler formulas to compare with the model: Florence's ballistic limit, an areal density rule, residual velocities.

Symbols are those of Florence's formula, in SI units.  The index 1 is the ceramic and 2 the back plate: density rho,
thickness h, and of the back plate the ultimate tensile strength sigma2 and the strain to fracture eps2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np
import scipy  # imports its parts on first use; Florence's limit does not need them

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.results import OnProgress
from armour.analysis.variants import Floats
from armour.errors import NoLimitError, Problem
from armour.scenario.inputs import LAYERS
from armour.scenario.keys import key_name
from armour.scenario.scenario import Scenario
from armour.units import MM, MPA, G

# Range in which the exponent of Lambert and Jonas is fitted.
EXPONENTS = (1.0, 20.0)
# Largest ratio of residual to impact velocity far above the limit; a larger one would create energy.
MAX_VELOCITY_RATIO = 1.0
# Largest exponent of the areal density that is fitted.
MAX_POWER = 4.0


class Plates(NamedTuple):
    """An armour in the symbols of Florence's formula: densities, thicknesses, strength and strain, in SI units."""

    rho1: float
    h1: float
    rho2: float
    h2: float
    sigma2: float
    eps2: float


def conoid_radius(r: float, h1: float) -> float:
    """Return the radius of the loaded area of the back plate, m: a = r + 2 h1, with the projectile's radius r, m."""
    return r + 2.0 * h1


def florence_limit(m: float, r: float, plates: Plates) -> float:
    """Compute Florence's ballistic limit, m/s [Florence1969], in the form of [Hetherington1991].

    The projectile has the mass m, kg, and the radius r, m.
    """
    area = pi * conoid_radius(r, plates.h1) ** 2
    areal_density = plates.rho1 * plates.h1 + plates.rho2 * plates.h2
    f = m / ((m + areal_density * area) * area)
    return sqrt(plates.eps2 * plates.sigma2 * plates.h2 / (0.91 * m * f))


def florence_split(m: float, r: float, rho1: float, rho2: float, areal_density: float) -> tuple[float, float]:
    """Compute the thicknesses with the highest Florence limit at a given areal density.

    They satisfy ``rho1/(rho2 h2) = (4/a) (1 + pi a^2 A/(m + pi a^2 A))``, with the areal density A, kg/m², and a from
    `conoid_radius`.  The left side falls with h2 and the right side rises, so there is at most one solution.  A very
    thin armour has none, and a bare plate is best.  Return h1 and h2, m.
    """

    def ceramic(h2: float) -> float:
        return (areal_density - rho2 * h2) / rho1

    def excess(h2: float) -> float:
        a = conoid_radius(r, ceramic(h2))
        loaded = pi * a * a * areal_density
        return rho1 / (rho2 * h2) - 4.0 / a * (1.0 + loaded / (m + loaded))

    bare = areal_density / rho2
    if excess(bare) >= 0.0:
        return 0.0, bare
    h2 = float(scipy.optimize.brentq(excess, 1e-9 * bare, bare, xtol=1e-15))
    return ceramic(h2), h2


class ArealDensityRule(NamedTuple):
    """The rule limit = k A^p for the ballistic limit, m/s, and the areal density A, kg/m²."""

    k: float
    p: float

    def limit(self, areal_density: float) -> float:
        """Return the ballistic limit at an areal density, kg/m², m/s."""
        return float(self.k * areal_density**self.p)


def fit_areal_density_rule(areal_densities: Floats, limits: Floats, p: float | None = None) -> ArealDensityRule:
    """Fit the rule ``limit = k A^p`` to measured ballistic limits by least squares of the relative errors.

    For a given p, the factor is ``k = sum(s) / sum(s^2)`` with ``s = A^p / limit``.  The fitted p minimises the sum of
    squares that remains, ``n - sum(s)^2 / sum(s^2)``.

    Parameters
    ----------
    areal_densities : (n,) array
        Areal densities of the armours, kg/m²; at least two that differ if p is fitted.
    limits : (n,) array
        Their ballistic limits, m/s.
    p : float, optional
        Exponent; by default it is fitted, between 0 and 4.

    Returns
    -------
    ArealDensityRule
    """
    # Divided by their geometric mean, so that powers of the areal densities do not overflow.
    middle = float(np.exp(np.mean(np.log(areal_densities))))
    ratios = areal_densities / middle

    def remainder(p: float) -> float:
        s = ratios**p / limits
        return -float(s.sum() ** 2 / (s @ s))

    if p is None:
        minimise = scipy.optimize.minimize_scalar
        p = float(minimise(remainder, bounds=(0.0, MAX_POWER), method="bounded", options={"xatol": 1e-8}).x)
    s = ratios**p / limits
    return ArealDensityRule(float(s.sum() / (s @ s)) / middle**p, p)


@dataclass(frozen=True)
class ResidualVelocityFit:
    """Fit of ``ratio (V^exponent - limit^exponent)^(1/exponent)`` to residual velocities.

    Attributes
    ----------
    name : str
        Name of the formula.
    ratio, exponent : float
    rms_m_s : float
        Root mean square of the residuals, m/s.
    """

    name: str
    ratio: float
    exponent: float
    rms_m_s: float


def residual_velocity(V: float, limit: float, ratio: float, exponent: float) -> float:
    """Compute the residual velocity after [Lambert1976], m/s; exponent 2 gives the formula of [Recht1963]."""
    if limit >= V:
        return 0.0
    # Dividing by V keeps the powers from overflowing.
    return float(ratio * V * (1.0 - (limit / V) ** exponent) ** (1.0 / exponent))


def fit_lambert_jonas(impact: Sequence[float], residual: Sequence[float], limit: float) -> ResidualVelocityFit:
    """Fit ratio and exponent of Lambert and Jonas to impact and residual velocities, m/s, by least squares.

    `limit` is the ballistic limit, m/s.
    """

    def fit(exponent: float) -> ResidualVelocityFit:
        return _fit_ratio("Lambert-Jonas", impact, residual, limit, exponent)

    minimise = scipy.optimize.minimize_scalar
    best = minimise(lambda exponent: fit(exponent).rms_m_s, bounds=EXPONENTS, method="bounded", options={"xatol": 1e-6})
    return fit(float(best.x))


def fit_recht_ipson(impact: Sequence[float], residual: Sequence[float], limit: float) -> ResidualVelocityFit:
    """Fit the ratio of Recht and Ipson to impact and residual velocities, m/s, by least squares; the exponent is 2."""
    return _fit_ratio("Recht-Ipson", impact, residual, limit, 2.0)


def _fit_ratio(
    name: str, impact: Sequence[float], residual: Sequence[float], limit: float, exponent: float
) -> ResidualVelocityFit:
    """Fit the ratio of `residual_velocity` to impact and residual velocities, m/s, by least squares."""
    at_ratio_1 = [residual_velocity(V, limit, 1.0, exponent) for V in impact]
    ratio = sum(s * v for s, v in zip(at_ratio_1, residual, strict=True)) / sum(s * s for s in at_ratio_1)
    ratio = min(max(ratio, 0.0), MAX_VELOCITY_RATIO)
    squares = sum((ratio * s - v) ** 2 for s, v in zip(at_ratio_1, residual, strict=True))
    return ResidualVelocityFit(name, ratio, exponent, sqrt(squares / len(at_ratio_1)))


Body = Literal["penetrator", "whole projectile"]
# Bodies that Florence's formula can take as the projectile, with the keys of their mass and diameter.
BODIES: dict[Body, tuple[str, str]] = {
    "penetrator": ("penetrator_mass_g", "penetrator_diameter_mm"),
    "whole projectile": ("projectile_mass_g", "caliber_mm"),
}
# Keys of a metal that only Florence's formula needs: tensile strength and strain to fracture.
TENSILE = ("ultimate_tensile_strength_MPa", "strain_to_fracture")


@dataclass(frozen=True)
class FlorenceResult:
    """Florence's ballistic limit of an armour, and the best armour of the same areal density by this formula.

    Attributes
    ----------
    projectile : {"penetrator", "whole projectile"}
        Body that is taken as the projectile.
    mass_g, diameter_mm : float
        Mass, g, and diameter, mm, of that body.
    ballistic_limit_m_s : float
        Florence's limit, m/s.
    best_ceramic_thickness_mm, best_backing_thickness_mm : float
        Thicknesses with the highest Florence limit at the same areal density, mm.
    best_thickness_ratio : float
        Their ratio, ceramic to back plate.
    best_ballistic_limit_m_s : float
        Florence's limit of the best armour, m/s.
    model_ballistic_limit_m_s : float or None
        Ballistic limit of the best armour by the model, m/s; None if the scenario's range contains none.
    """

    projectile: Body
    mass_g: float
    diameter_mm: float
    ballistic_limit_m_s: float
    best_ceramic_thickness_mm: float
    best_backing_thickness_mm: float
    best_thickness_ratio: float
    best_ballistic_limit_m_s: float
    model_ballistic_limit_m_s: float | None


def missing_for_florence(scenario: Scenario) -> list[Problem]:
    """Return a problem for each quantity that Florence's formula needs and the scenario lacks."""
    problems = []
    if not scenario.armour.ceramic_thickness_mm > 0.0:
        message = "must be greater than 0 for Florence's limit, found 0"
        problems.append(Problem(scenario.file, "armour.ceramic_thickness_mm", message))
    backing = scenario.armour.backing
    missing = [key for key in TENSILE if key not in scenario.entry("metal", backing).values]
    message = "is missing and must be given for Florence's limit; add it to the entry"
    problems += [Problem(scenario.file, key_name(["library", "metal", backing, key]), message) for key in missing]
    return problems


def bodies_of(scenario: Scenario) -> list[Body]:
    """Return the bodies of the projectile whose mass and diameter are known."""
    values = scenario.entry("projectile", scenario.impact.projectile).values
    return [body for body, keys in BODIES.items() if all(key in values for key in keys)]


def mass_and_diameter(scenario: Scenario, body: Body) -> tuple[float, float]:
    """Return mass, g, and diameter, mm, of a body of the projectile."""
    mass, diameter = BODIES[body]
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    return projectile[mass], projectile[diameter]


def along_fire_kg_m2(scenario: Scenario) -> float:
    """Return the areal density of tile and back plate along the line of fire, kg/m²."""
    armour = scenario.core_armour()
    return armour.rho_c * armour.Hc0 + armour.rho_B * armour.Hb


def florence_ballistic_limit(scenario: Scenario, body: Body = "penetrator") -> float:
    """Compute Florence's limit of a scenario's armour, m/s, with a body taken as the projectile."""
    return florence_limit(*_in_symbols(scenario, body))


def florence_result(scenario: Scenario, body: Body, on_progress: OnProgress) -> FlorenceResult:
    """Compute Florence's limit of a scenario's armour, and by this formula the best armour of its areal density."""
    mass_g, diameter_mm = mass_and_diameter(scenario, body)
    m, r, plates = _in_symbols(scenario, body)
    cosine = scenario.cosine()
    h1, h2 = florence_split(m, r, plates.rho1, plates.rho2, along_fire_kg_m2(scenario))
    best_mm = h1 * cosine / MM, h2 * cosine / MM
    best = scenario.replaced(dict(zip(LAYERS, best_mm, strict=True)))
    try:
        model = ballistic_limit(best, on_progress=on_progress).ballistic_limit_m_s
    except NoLimitError:
        model = None
    return FlorenceResult(
        projectile=body,
        mass_g=mass_g,
        diameter_mm=diameter_mm,
        ballistic_limit_m_s=florence_limit(m, r, plates),
        best_ceramic_thickness_mm=best_mm[0],
        best_backing_thickness_mm=best_mm[1],
        best_thickness_ratio=h1 / h2,
        best_ballistic_limit_m_s=florence_limit(m, r, plates._replace(h1=h1, h2=h2)),
        model_ballistic_limit_m_s=model,
    )


def _in_symbols(scenario: Scenario, body: Body) -> tuple[float, float, Plates]:
    """Return the arguments of `florence_limit` for a scenario: mass, kg, radius, m, and the layers.

    Thicknesses are along the line of fire.
    """
    mass_g, diameter_mm = mass_and_diameter(scenario, body)
    armour, metal = scenario.core_armour(), scenario.entry("metal", scenario.armour.backing)
    strength, strain = TENSILE
    plates = Plates(armour.rho_c, armour.Hc0, armour.rho_B, armour.Hb, metal[strength] * MPA, metal[strain])
    return mass_g * G, diameter_mm * MM / 2.0, plates
