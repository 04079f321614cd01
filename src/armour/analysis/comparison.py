"""A scenario's armour by the model and by the closed forms of others, side by side."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, residual_curve, velocities_round
from armour.analysis.closed_forms import (
    Plates,
    ResidualFit,
    fit_lambert_jonas,
    fit_recht_ipson,
    florence_limit,
    florence_split,
)
from armour.analysis.impact import ImpactResult
from armour.errors import InputError, NoLimitError, Problem
from armour.scenario.loading import Scenario
from armour.units import MM, MPA, G

Body = Literal["penetrator", "whole projectile"]
# What Florence's formula is given as the projectile: keys of its mass and diameter.
BODIES: dict[Body, tuple[str, str]] = {
    "penetrator": ("penetrator_mass_g", "penetrator_diameter_mm"),
    "whole projectile": ("projectile_mass_g", "caliber_mm"),
}
TENSILE = ("ultimate_tensile_strength_MPa", "strain_to_fracture")


@dataclass(frozen=True)
class FlorenceResult:
    """Florence's limit of an armour, and the split of its areal density that this formula holds for best.

    Attributes
    ----------
    projectile : {"penetrator", "whole projectile"}
        What is taken as the projectile.
    mass_g, diameter_mm : float
    ballistic_limit_m_s : float
    best_ceramic_thickness_mm, best_backing_thickness_mm, best_thickness_ratio : float
        Thicknesses at the same areal density that the formula holds for best, and ceramic over backing.
    best_ballistic_limit_m_s : float
        Florence's limit of that armour.
    model_ballistic_limit_m_s : float or None
        The model's limit of that armour; None where it has none in the scenario's range.
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


@dataclass(frozen=True)
class Fit:
    """A closed form fitted to the model's residual velocities.

    Attributes
    ----------
    name : str
    ratio, exponent : float
        Of ``ratio (V^exponent - limit^exponent)^(1/exponent)``, with the model's limit.
    rms_m_s : float
        Root mean square of what the fit leaves, m/s.
    """

    name: str
    ratio: float
    exponent: float
    rms_m_s: float


@dataclass(frozen=True)
class Comparison:
    """The model's ballistic limit and residual velocities, and what closed forms make of them.

    Attributes
    ----------
    areal_density_kg_m2 : float
    limit : LimitResult
        The model's.
    florence : tuple of FlorenceResult
        One per body whose mass and diameter the library knows.
    fits : tuple of Fit
        Lambert and Jonas, Recht and Ipson.
    fitted_m_s : tuple of float
        Lowest and highest impact velocity of the fits, m/s.
    curve : tuple of ImpactResult
        The model's impacts around and above the limit.
    """

    areal_density_kg_m2: float
    limit: LimitResult
    florence: tuple[FlorenceResult, ...]
    fits: tuple[Fit, ...]
    fitted_m_s: tuple[float, float]
    curve: tuple[ImpactResult, ...]

    def to_dict(self) -> dict[str, Any]:
        """The comparison without the curve as plain data."""
        return {
            "areal_density_kg_m2": self.areal_density_kg_m2,
            "ballistic_limit_m_s": self.limit.ballistic_limit_m_s,
            "florence": [asdict(result) for result in self.florence],
            "fits": [asdict(fit) for fit in self.fits],
            "fitted_m_s": self.fitted_m_s,
            "warnings": self.limit.warnings,
        }


def compare(scenario: Scenario) -> Comparison:
    """Put the model's answers for a scenario's armour next to those of closed forms.

    Raises
    ------
    InputError
        If the armour has no ceramic, or its metal no tensile strength or strain to fracture.
    NoLimitError
        If the model has no ballistic limit in the scenario's range.
    """
    problems = missing_for_florence(scenario)
    if problems:
        raise InputError(problems)
    limit = ballistic_limit(scenario)
    curve = residual_curve(scenario, velocities_round(limit, scenario))
    above = [impact for impact in curve if impact.impact_velocity_m_s > limit.ballistic_limit_m_s]
    return Comparison(
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        limit=limit,
        florence=tuple(florence_result(scenario, body) for body in bodies_of(scenario)),
        fits=fits_of(above, limit.ballistic_limit_m_s),
        fitted_m_s=(above[0].impact_velocity_m_s, above[-1].impact_velocity_m_s),
        curve=curve,
    )


def missing_for_florence(scenario: Scenario) -> list[Problem]:
    """What Florence's formula needs and the scenario does not have."""
    problems = []
    if not scenario.armour.ceramic_thickness_mm > 0.0:
        message = "must be greater than 0 for Florence's limit, found 0"
        problems.append(Problem(scenario.file, "armour.ceramic_thickness_mm", message))
    backing = scenario.armour.backing
    for key in TENSILE:
        if key not in scenario.entry("metal", backing).values:
            message = f'must name a metal with {key}, found "{backing}"; add one that is based on it'
            problems.append(Problem(scenario.file, "armour.backing", message))
    return problems


def bodies_of(scenario: Scenario) -> list[Body]:
    """What of the projectile can be given to Florence's formula."""
    values = scenario.entry("projectile", scenario.impact.projectile).values
    return [body for body, keys in BODIES.items() if all(key in values for key in keys)]


def florence_ballistic_limit(scenario: Scenario, body: Body = "penetrator") -> float:
    """Florence's limit of the scenario's armour, m/s."""
    mass_g, diameter_mm = _body(scenario, body)
    return florence_limit(mass_g * G, diameter_mm * MM / 2.0, _plates(scenario))


def florence_result(scenario: Scenario, body: Body) -> FlorenceResult:
    """Florence's limit, and the thicknesses that it holds for best at the same areal density."""
    mass_g, diameter_mm = _body(scenario, body)
    m, r, plates = mass_g * G, diameter_mm * MM / 2.0, _plates(scenario)
    h1, h2 = florence_split(m, r, plates.rho1, plates.rho2, scenario.areal_density_kg_m2())
    best = scenario.replaced({"armour.ceramic_thickness_mm": h1 / MM, "armour.backing_thickness_mm": h2 / MM})
    try:
        model = ballistic_limit(best).ballistic_limit_m_s
    except NoLimitError:
        model = None
    return FlorenceResult(
        projectile=body,
        mass_g=mass_g,
        diameter_mm=diameter_mm,
        ballistic_limit_m_s=florence_limit(m, r, plates),
        best_ceramic_thickness_mm=h1 / MM,
        best_backing_thickness_mm=h2 / MM,
        best_thickness_ratio=h1 / h2,
        best_ballistic_limit_m_s=florence_limit(m, r, plates._replace(h1=h1, h2=h2)),
        model_ballistic_limit_m_s=model,
    )


def fits_of(impacts: Sequence[ImpactResult], limit: float) -> tuple[Fit, ...]:
    """Closed forms fitted to impacts above the limit, m/s."""
    velocities = [impact.impact_velocity_m_s for impact in impacts]
    residuals = [impact.residual_velocity_m_s for impact in impacts]

    def named(name: str, fit: ResidualFit) -> Fit:
        return Fit(name, fit.ratio, fit.exponent, fit.rms)

    return (
        named("Lambert-Jonas", fit_lambert_jonas(velocities, residuals, limit)),
        named("Recht-Ipson", fit_recht_ipson(velocities, residuals, limit)),
    )


def _body(scenario: Scenario, body: Body) -> tuple[float, float]:
    """Mass, g, and diameter, mm."""
    mass, diameter = BODIES[body]
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    return projectile[mass], projectile[diameter]


def _plates(scenario: Scenario) -> Plates:
    armour = scenario.core_armour()
    metal = scenario.entry("metal", scenario.armour.backing)
    strength, strain = TENSILE
    return Plates(armour.rho_c, armour.Hc0, armour.rho_B, armour.Hb, metal[strength] * MPA, metal[strain])
