"""A plain loop over every design of a catalogue, which the tests of the design search compare it with."""

from collections.abc import Callable, Iterator
from math import cos, radians
from typing import Any

import numpy as np

from armour.core.search import scan
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from armour.scenario.scenario import Scenario
from tests.helpers.bisection import bisect

CRITERIA = ["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]


def posed(case: Scenario, ceramic: Any, backing: Any, hc: float, hb: float, threat: Any) -> Scenario:
    """A design of a catalogue against a threat: thickened along the line of fire, at normal incidence."""
    cosine = cos(radians(threat.obliquity_deg))
    return case.replaced(
        {
            "armour.ceramic": ceramic.material,
            "armour.backing": backing.material,
            "armour.ceramic_thickness_mm": hc / cosine,
            "armour.backing_thickness_mm": hb / cosine,
            "impact.projectile": threat.projectile,
        }
    )


def perforates(armour: Parameters, *velocities: float) -> bool:
    """Whether the projectile perforates an armour at any of the impact velocities, m/s, by the engine row by row."""
    rows = np.tile(batch.packed([armour]), (len(velocities), 1))
    return bool((batch.impacts(rows, np.array(velocities)).outcome == Outcome.PERFORATED).any())


def stops(own: Scenario, required: float) -> bool:
    """Whether an armour stops an impact."""
    return not perforates(own.core_armour(), required)


def passes(own: Scenario, required: float) -> bool:
    """Whether an armour has no ballistic limit below a velocity, by the scan and by a denser one."""
    section, armour = own.ballistic_limit, own.core_armour()
    velocities = scan(section.velocity_min_m_s, section.velocity_max_m_s)
    below = [velocity for velocity in velocities if velocity < required]
    if perforates(armour, required, *below):
        return False
    above = velocities[len(below)]
    if perforates(armour, above):
        limit = bisect(lambda v: perforates(armour, v), below[-1], above, section.tolerance_m_s)[1]
        if limit < required:
            return False
    return withstands_below(own, required, 513)


def withstands_below(own: Scenario, required: float, count: int) -> bool:
    """Whether an armour is perforated at no velocity from 20 m/s to the one required."""
    return not perforates(own.core_armour(), *np.geomspace(20.0, required, count)[:-1])


def designs(
    case: Scenario, condition: Callable[[Scenario, float], bool]
) -> Iterator[tuple[tuple[str, str, float, float], dict[str, float]]]:
    """Names and thicknesses of the designs of a catalogue for which a condition holds, with their criteria."""
    assert case.design is not None
    for ceramic in case.design.ceramic:
        for backing in case.design.backing:
            for hc in ceramic.thicknesses():
                for hb in backing.thicknesses():
                    against = [
                        (posed(case, ceramic, backing, hc, hb, threat), threat.required_m_s) for threat in case.threat
                    ]
                    if not all(condition(*each) for each in against):
                        continue
                    armour = against[0][0].core_armour()
                    masses = armour.rho_c * hc / 1000.0, armour.rho_B * hb / 1000.0
                    cost = ceramic.cost_per_kg * masses[0] + backing.cost_per_kg * masses[1]
                    cost += ceramic.cost_per_m2 * (hc > 0.0) + backing.cost_per_m2
                    values = dict(zip(CRITERIA, (sum(masses), hc + hb, cost), strict=True))
                    yield (ceramic.material, backing.material, hc, hb), values
