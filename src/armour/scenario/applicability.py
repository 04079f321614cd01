"""Validated range of the model: the data that it was tested on."""

from typing import TYPE_CHECKING, NamedTuple

from armour.scenario.library import penetrator_length_mm

if TYPE_CHECKING:
    from armour.scenario.loading import Scenario


class DataRange(NamedTuple):
    """Range of a quantity within which the model was tested."""

    key: str  # key of the scenario that the quantity depends on
    words: str  # what was tested, in the plural
    low: float
    high: float
    unit: str  # unit of the ends, or what they are relative to


# Ranges of the paper's cases and of Wilkins' tests in suites/paper.toml, rounded outwards to two digits.
VELOCITY = DataRange("impact.velocity_m_s", "velocities", 620.0, 1300.0, "m/s")
CERAMIC = DataRange("armour.ceramic_thickness_mm", "ceramics", 0.61, 4.1, "penetrator diameters thick")
BACKING = DataRange("armour.backing_thickness_mm", "back plates", 0.66, 3.0, "penetrator diameters thick")
# Mean and greatest error of the ballistic limit on Wilkins' 13 tests, per cent; a test compares it with the suite.
MODEL_ERROR_PERCENT = 5.1, 11.3
SLENDERNESS = DataRange("impact.projectile", "penetrators", 3.2, 5.4, "diameters long")


def warnings_of(scenario: "Scenario", velocity: float) -> tuple[str, ...]:
    """Return the ways in which a scenario lies outside the validated range, as "key: range of the tests, value found".

    `velocity` is the impact velocity or the ballistic limit, m/s.
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
        f"{r.key}: the model was tested on {r.words} from {r.low:g} to {r.high:g} {r.unit}, found {value:.3g}"
        for r, value in found
        if not r.low <= value <= r.high
    )
