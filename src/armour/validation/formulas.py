"""Simpler formulas to compare with the model: Florence's ballistic limit, and an areal density rule.

Symbols are those of Florence's formula, in SI units.  The index 1 is the ceramic and 2 the back plate: density rho,
thickness h, and of the back plate the ultimate tensile strength sigma2 and the strain to fracture eps2.
"""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np
import scipy  # imports its parts on first use; Florence's limit does not need them

from armour.analysis.variants import Floats
from armour.errors import Problem
from armour.scenario.keys import key_name
from armour.scenario.scenario import Scenario
from armour.units import MM, MPA, G

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


def florence_limit(m: float, r: float, plates: Plates) -> float:
    """Compute Florence's ballistic limit, m/s [Florence1969], in the form of [Hetherington1991].

    The projectile has the mass m, kg, and the radius r, m; it loads the back plate over the radius r + 2 h1.
    """
    area = pi * (r + 2.0 * plates.h1) ** 2
    areal_density = plates.rho1 * plates.h1 + plates.rho2 * plates.h2
    f = m / ((m + areal_density * area) * area)
    return sqrt(plates.eps2 * plates.sigma2 * plates.h2 / (0.91 * m * f))


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
    """Florence's ballistic limit of an armour.

    Attributes
    ----------
    projectile : {"penetrator", "whole projectile"}
        Body that is taken as the projectile.
    mass_g, diameter_mm : float
        Mass, g, and diameter, mm, of that body.
    ballistic_limit_m_s : float
        Florence's limit, m/s.
    """

    projectile: Body
    mass_g: float
    diameter_mm: float
    ballistic_limit_m_s: float


def florence_name(result: FlorenceResult) -> str:
    """Return the name of a result of Florence's formula, with the projectile it takes."""
    return f"Florence, {result.projectile} ({result.mass_g:g} g, {result.diameter_mm:g} mm)"


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


def florence_results(scenario: Scenario) -> tuple[FlorenceResult, ...]:
    """Compute Florence's limits of a scenario's armour: for each body of the projectile with known mass and diameter.

    Thicknesses are along the line of fire.  The scenario must lack nothing of `missing_for_florence`.
    """
    armour, metal = scenario.core_armour(), scenario.entry("metal", scenario.armour.backing)
    strength, strain = (metal[key] for key in TENSILE)
    plates = Plates(armour.rho_c, armour.Hc0, armour.rho_B, armour.Hb, strength * MPA, strain)
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    results = []
    for body, keys in BODIES.items():
        if {*keys} <= projectile.values.keys():
            mass_g, diameter_mm = (projectile[key] for key in keys)
            limit = florence_limit(mass_g * G, diameter_mm * MM / 2.0, plates)
            results.append(FlorenceResult(body, mass_g, diameter_mm, limit))
    return tuple(results)


def along_fire_kg_m2(scenario: Scenario) -> float:
    """Return the areal density of tile and back plate along the line of fire, kg/m²."""
    armour = scenario.core_armour()
    return armour.rho_c * armour.Hc0 + armour.rho_B * armour.Hb
