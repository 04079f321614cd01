"""Designs far from any armour: those whose outcome changes more than once with the velocity, and random ones."""

from typing import Any

import numpy as np

from armour.scenario.scenario import Scenario
from armour.scenario.schema import SHEAR_LAWS
from tests.helpers.cases import library, scenario

WIDE = {"velocity_min_m_s": 1.0, "velocity_max_m_s": 10000.0}


def design(
    projectile: tuple[float, float, float, float],
    ceramic: tuple[float, float, float],
    metal: tuple[float, float, float],
    thicknesses: tuple[float, float],
    perimeter: str,
) -> Scenario:
    """A design of a projectile, a ceramic and a metal as in `tests.helpers.cases.library`, 1 to 10,000 m/s."""
    sections: dict[str, Any] = {"library": library(projectile, ceramic, metal), "ballistic_limit": WIDE}
    return scenario("x", "c", "b", *thicknesses, velocity=500.0, perimeter=perimeter, **sections)


def changing_designs() -> dict[str, Scenario]:
    """Designs whose outcome changes more than once."""
    return {
        "stopped again": design(
            (3.161358162274126, 0.03987796574983686, 1054.0258661048758, 0.12524031762256457),
            (9876.261858364302, 182.97734306294535, 0.10891464904522903),
            (4845.660157101533, 7.560650668912438, 22.932029641592116),
            (0.756981622307491, 2.204735987614351),
            "projectile",
        ),
        "stopped in between": design(
            (5.990328129301915, 10.648232708240746, 11663.043046915018, 0.8895151408385952),
            (15540.93221065577, 114.68647691193237, 33.650102367242305),
            (1000.8444063868789, 0.03658275035142869, 613.5952716376286),
            (18.591609259770856, 0.8576115715942456),
            "projectile",
        ),
        "perforated between scanned velocities": design(
            (9.941830226613662, 4.826732637535887, 2786.838908799542, 0.2793148956715217),
            (4308.363724701605, 189.10785864030288, 2.698688446378748),
            (6490.311259057459, 2.7997789487120457, 28.0143292741021),
            (19.296629656010097, 5.0877408601900616),
            "conoid",
        ),
        "perforated at a maximum of depth": design(
            (3.954, 3.958, 7831.0, 0.3649),
            (19760.0, 114.4, 0.5551),
            (3226.0, 8.016, 817.9),
            (0.5861, 0.367),
            "projectile",
        ),
        "perforated in narrow ranges": narrow_ranges(),
    }


def narrow_ranges(**optimise: Any) -> Scenario:
    """A design that is perforated at 253 to 292, 323 to 329 and from 381 m/s, with the grid of [optimise] given.

    At 359.086 m/s, ceramics of 9.546 to 11.4 mm and from 12.908 mm stop the projectile on this back plate; all below
    12.908 mm have a lower limit.
    """
    of = design(
        (2.85693238445, 1.75600193977, 8256.92009144, 0.341668735899),
        (4002.77413664, 506.552779197, 1.55021271811),
        (2129.35430237, 0.483368800199, 114.784708593),
        (10.75, 0.345424597),
        "conoid",
    )
    grid = {
        "ceramic_thickness_mm": {"min": 0.5, "max": 60.0, "step": 0.1},
        "backing_thickness_mm": {"min": 0.345424597, "max": 0.345424597, "step": 1.0},
    }
    return of.replaced({"impact.velocity_m_s": 359.086, "optimise": {**grid, **optimise}})


def random_wide_designs(count: int, seed: int) -> list[Scenario]:
    """Designs with values spread over decades."""
    rng = np.random.default_rng(seed)

    def wide(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    found = []
    for _ in range(count):
        diameter, density = wide(3.0, 15.0), wide(1000.0, 20000.0)
        mass = density * np.pi / 4.0 * diameter**3 * wide(0.5, 20.0) * 1e-6
        found.append(
            design(
                (diameter, mass, density, wide(0.1, 5.0)),
                (wide(1000.0, 20000.0), wide(50.0, 600.0), wide(0.1, 40.0)),
                (wide(1000.0, 20000.0), wide(0.03, 10.0), wide(20.0, 3000.0)),
                (diameter * wide(0.05, 4.0), diameter * wide(0.05, 4.0)),
                str(rng.choice([*SHEAR_LAWS])),
            )
        )
    return found
