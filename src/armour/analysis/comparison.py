"""Comparison of the model with closed forms for a scenario's armour."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit, curve_velocities, residual_velocity_curve
from armour.analysis.closed_forms import (
    Plates,
    ResidualVelocityFit,
    fit_lambert_jonas,
    fit_recht_ipson,
    florence_limit,
    florence_split,
)
from armour.analysis.impact import ImpactResult
from armour.errors import NoAnswerError, NoLimitError, Problem, refuse
from armour.scenario.loading import Scenario
from armour.scenario.messages import key_name
from armour.units import MM, MPA, G

Body = Literal["penetrator", "whole projectile"]
# Bodies that Florence's formula can take as the projectile: keys of mass and diameter.
BODIES: dict[Body, tuple[str, str]] = {
    "penetrator": ("penetrator_mass_g", "penetrator_diameter_mm"),
    "whole projectile": ("projectile_mass_g", "caliber_mm"),
}
# Keys of the metal that only Florence's formula needs.
TENSILE = ("ultimate_tensile_strength_MPa", "strain_to_fracture")


@dataclass(frozen=True)
class FlorenceResult:
    """Florence's limit of an armour, and the best armour of the same areal density according to this formula."""

    projectile: Body  # body taken as the projectile
    mass_g: float  # of that body
    diameter_mm: float
    ballistic_limit_m_s: float  # Florence's limit
    # Thicknesses with the highest Florence limit at the same areal density, and their ratio, ceramic to back plate.
    best_ceramic_thickness_mm: float
    best_backing_thickness_mm: float
    best_thickness_ratio: float
    best_ballistic_limit_m_s: float  # Florence's limit of the best armour
    model_ballistic_limit_m_s: float | None  # the model's limit of it; None if the scenario's range contains none


@dataclass(frozen=True)
class Comparison:
    """Ballistic limit and residual velocities by the model and by closed forms.

    Attributes
    ----------
    areal_density_kg_m2 : float
        Areal density of the armour, kg/m².
    limit : LimitResult
        Ballistic limit by the model.
    florence : tuple of FlorenceResult
        One per body with a known mass and diameter.
    fits : tuple of ResidualVelocityFit
        Fits of Lambert and Jonas and of Recht and Ipson to the model's residual velocities.
    fitted_m_s : tuple of float
        Lowest and highest impact velocity of the fits, m/s.
    curve : tuple of ImpactResult
        Impacts by the model around and above the limit.
    """

    areal_density_kg_m2: float
    limit: LimitResult
    florence: tuple[FlorenceResult, ...]
    fits: tuple[ResidualVelocityFit, ...]
    fitted_m_s: tuple[float, float]
    curve: tuple[ImpactResult, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison, without the curve, as plain data."""
        return {
            "areal_density_kg_m2": self.areal_density_kg_m2,
            "ballistic_limit_m_s": self.limit.ballistic_limit_m_s,
            "florence": [asdict(result) for result in self.florence],
            "fits": [asdict(fit) for fit in self.fits],
            "fitted_m_s": self.fitted_m_s,
            "warnings": self.limit.warnings,
        }


def compare(scenario: Scenario) -> Comparison:
    """Compare the model with closed forms for a scenario's armour.

    Parameters
    ----------
    scenario : Scenario
        Its impact velocity is not used.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        If the armour has no ceramic, or its metal no tensile strength or strain to fracture.
    NoLimitError
        If the scenario's range contains no ballistic limit.
    NoAnswerError
        If the range contains no velocities above the limit.
    """
    problems = missing_for_florence(scenario)
    refuse(problems)
    limit = ballistic_limit(scenario)
    highest = scenario.ballistic_limit.velocity_max_m_s
    if highest <= limit.ballistic_limit_m_s * (1.0 + 1e-9):
        raise NoAnswerError(
            f"no fit: the range of velocities ends at the ballistic limit, {highest:g} m/s; "
            "raise ballistic_limit.velocity_max_m_s"
        )
    curve = residual_velocity_curve(scenario, curve_velocities(limit, scenario))
    above = [impact for impact in curve if impact.impact_velocity_m_s > limit.ballistic_limit_m_s]
    velocities = [impact.impact_velocity_m_s for impact in above]
    residuals = [impact.residual_velocity_m_s for impact in above]
    return Comparison(
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        limit=limit,
        florence=tuple(florence_result(scenario, body) for body in bodies_of(scenario)),
        fits=(
            fit_lambert_jonas(velocities, residuals, limit.ballistic_limit_m_s),
            fit_recht_ipson(velocities, residuals, limit.ballistic_limit_m_s),
        ),
        fitted_m_s=(velocities[0], velocities[-1]),
        curve=curve,
    )


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
    """Return the bodies of the projectile with a known mass and diameter."""
    values = scenario.entry("projectile", scenario.impact.projectile).values
    return [body for body, keys in BODIES.items() if all(key in values for key in keys)]


def florence_ballistic_limit(scenario: Scenario, body: Body = "penetrator") -> float:
    """Compute Florence's limit of a scenario's armour, m/s."""
    mass_g, diameter_mm = _body(scenario, body)
    return florence_limit(mass_g * G, diameter_mm * MM / 2.0, _plates(scenario))


def florence_result(scenario: Scenario, body: Body) -> FlorenceResult:
    """Compute Florence's limit and the best armour of the same areal density according to it."""
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


def _body(scenario: Scenario, body: Body) -> tuple[float, float]:
    """Return mass, g, and diameter, mm, of a body."""
    mass, diameter = BODIES[body]
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    return projectile[mass], projectile[diameter]


def _plates(scenario: Scenario) -> Plates:
    """Return the scenario's armour in the symbols of Florence's formula."""
    armour = scenario.core_armour()
    metal = scenario.entry("metal", scenario.armour.backing)
    strength, strain = TENSILE
    return Plates(armour.rho_c, armour.Hc0, armour.rho_B, armour.Hb, metal[strength] * MPA, metal[strain])
