"""Florence's ballistic limit of a scenario's armour."""

from dataclasses import dataclass
from typing import Literal

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.closed_forms import Plates, florence_limit, florence_split
from armour.analysis.progress import OnProgress, ignore_progress
from armour.errors import NoLimitError, Problem
from armour.scenario.keys import key_name
from armour.scenario.scenario import Scenario
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
    """Florence's limit of an armour, and the best armour of the same areal density according to this formula.

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
        Ballistic limit of the best armour by the model, m/s; None where the scenario's range contains none.
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
    """Return the bodies of the projectile with a known mass and diameter."""
    values = scenario.entry("projectile", scenario.impact.projectile).values
    return [body for body, keys in BODIES.items() if all(key in values for key in keys)]


def florence_ballistic_limit(scenario: Scenario, body: Body = "penetrator") -> float:
    """Compute Florence's limit of a scenario's armour, m/s."""
    mass_g, diameter_mm = _body(scenario, body)
    return florence_limit(mass_g * G, diameter_mm * MM / 2.0, _plates(scenario))


def florence_result(scenario: Scenario, body: Body, on_progress: OnProgress = ignore_progress) -> FlorenceResult:
    """Compute Florence's limit and the best armour of the same areal density according to it."""
    mass_g, diameter_mm = _body(scenario, body)
    m, r, plates = mass_g * G, diameter_mm * MM / 2.0, _plates(scenario)
    h1, h2 = florence_split(m, r, plates.rho1, plates.rho2, scenario.areal_density_kg_m2())
    best = scenario.replaced({"armour.ceramic_thickness_mm": h1 / MM, "armour.backing_thickness_mm": h2 / MM})
    try:
        model = ballistic_limit(best, on_progress=on_progress).ballistic_limit_m_s
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
