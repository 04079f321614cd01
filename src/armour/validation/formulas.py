"""Simpler formulas to compare with the model: Florence's ballistic limit, and an areal density rule.

Symbols are those of Florence's formula, in SI units.  The index 1 is the ceramic and 2 the back plate: density rho,
thickness h, and of the back plate the ultimate tensile strength sigma2 and the strain to fracture eps2.
"""

from math import pi, sqrt

from armour.analysis.variants import Floats
from armour.errors import Problem
from armour.scenario.keys import key_name
from armour.scenario.scenario import Scenario
from armour.units import MM, MPA, G

# Bodies that Florence's formula can take as the projectile, with the keys of their mass and diameter.
BODIES = {
    "penetrator": ("penetrator_mass_g", "penetrator_diameter_mm"),
    "whole projectile": ("projectile_mass_g", "caliber_mm"),
}
# Keys of a metal that only Florence's formula needs: tensile strength and strain to fracture.
TENSILE = ("ultimate_tensile_strength_MPa", "strain_to_fracture")


def florence_limit(
    m: float, r: float, rho1: float, h1: float, rho2: float, h2: float, sigma2: float, eps2: float
) -> float:
    """Compute Florence's ballistic limit, m/s [Florence1969], in the form of [Hetherington1991].

    The projectile has the mass `m`, kg, and the radius `r`, m; the module names the other symbols.  It loads the back
    plate over the radius r + 2 h1.
    """
    area = pi * (r + 2.0 * h1) ** 2
    areal_density = rho1 * h1 + rho2 * h2
    f = m / ((m + areal_density * area) * area)
    return sqrt(eps2 * sigma2 * h2 / (0.91 * m * f))


def fitted_factor(areal_densities: Floats, limits: Floats) -> float:
    """Fit the rule ``limit = k (areal density)`` to n measured limits, m/s, by least squares of the relative errors.

    Parameters
    ----------
    areal_densities : (n,) array
        Areal densities of the armours, kg/m².
    limits : (n,) array
        Their ballistic limits, m/s.

    Returns
    -------
    float
        The factor ``k = sum(s) / sum(s^2)`` with ``s = (areal density) / limit``, m/s per kg/m².
    """
    s = areal_densities / limits
    return float(s.sum() / (s @ s))


def missing_for_florence(scenario: Scenario) -> list[Problem]:
    """Return a problem for each key that Florence's formula needs and the scenario or its metal lacks."""
    problems = []
    if not scenario.armour.ceramic_thickness_mm > 0.0:
        message = "must be greater than 0 for Florence's limit, found 0"
        problems.append(Problem(scenario.file, "armour.ceramic_thickness_mm", message))
    backing = scenario.armour.backing
    missing = [key for key in TENSILE if key not in scenario.entry("metal", backing).values]
    message = "is missing and must be given for Florence's limit; add it to the entry"
    problems += [Problem(scenario.file, key_name(["library", "metal", backing, key]), message) for key in missing]
    return problems


def florence_limits(scenario: Scenario) -> dict[str, float]:
    """Compute Florence's limits of a scenario's armour, m/s, by body of the projectile, see `BODIES`.

    Bodies without a known mass and diameter are left out.
    Thicknesses are along the line of fire.  The scenario must lack nothing of `missing_for_florence`.
    """
    armour, metal = scenario.core_armour(), scenario.entry("metal", scenario.armour.backing)
    strength, strain = (metal[key] for key in TENSILE)
    plates = armour.rho_c, armour.Hc0, armour.rho_B, armour.Hb, strength * MPA, strain
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    known = {body: keys for body, keys in BODIES.items() if {*keys} <= projectile.values.keys()}
    return {
        body: florence_limit(projectile[mass_g] * G, projectile[diameter_mm] * MM / 2.0, *plates)
        for body, (mass_g, diameter_mm) in known.items()
    }


def along_fire_kg_m2(scenario: Scenario) -> float:
    """Return the areal density of tile and back plate along the line of fire, kg/m²."""
    armour = scenario.core_armour()
    return armour.rho_c * armour.Hc0 + armour.rho_B * armour.Hb
