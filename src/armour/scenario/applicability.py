"""How far a scenario is from the data that the model was tested on."""

from typing import TYPE_CHECKING, NamedTuple

from armour.scenario.library import penetrator_length_mm

if TYPE_CHECKING:
    from armour.scenario.loading import Scenario


class DataRange(NamedTuple):
    """Where there are tests or published results."""

    key: str
    words: str
    low: float
    high: float
    unit: str


# The paper's cases and Wilkins' tests, as suites/paper.toml has them, to two digits outwards.
VELOCITY = DataRange("impact.velocity_m_s", "velocities", 620.0, 1300.0, "m/s")
CERAMIC = DataRange("armour.ceramic_thickness_mm", "ceramics", 0.61, 4.1, "penetrator diameters thick")
BACKING = DataRange("armour.backing_thickness_mm", "back plates", 0.66, 3.0, "penetrator diameters thick")
# Mean and largest error of the ballistic limit on Wilkins' 13 tests, per cent; the tests hold it to the suite.
MODEL_ERROR_PERCENT = 5.1, 11.3
SLENDERNESS = DataRange("impact.projectile", "penetrators", 3.2, 5.4, "diameters long")


def warnings_of(scenario: "Scenario", velocity: float) -> tuple[str, ...]:
    """What of a scenario is outside the data, in the form ``key: what the data cover, what was found``.

    Parameters
    ----------
    scenario : Scenario
    velocity : float
        Impact velocity, or ballistic limit, in question, m/s.
    """
    projectile = scenario.entry("projectile", scenario.impact.projectile)
    diameter = projectile["penetrator_diameter_mm"]
    found = (
        (VELOCITY, velocity),
        (CERAMIC, scenario.armour.ceramic_thickness_mm / diameter),
        (BACKING, scenario.armour.backing_thickness_mm / diameter),
        (SLENDERNESS, penetrator_length_mm(projectile) / diameter),
    )
    return tuple(
        f"{r.key}: the model was tested on {r.words} {_from(r)}, found {value:.3g}"
        for r, value in found
        if not r.low <= value <= r.high
    )


def _from(r: DataRange) -> str:
    return f"from {r.low:g} to {r.high:g} {r.unit}"
