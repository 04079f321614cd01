"""The order of convergence across stage changes."""

from itertools import pairwise

import pytest

from armour.core.run import run
from armour.core.state import Parameters
from tests.cases import armour, path, traced

# Armour, impact velocity, and the path the run takes: medium, projectile, target ahead, motion, a letter each.
PATHS = {
    "dwell, then moving plate": (
        armour("25 mm APDS", "AD99.5", "7075-T6", 4.0, 16.0, perimeter="projectile"),
        600.0,
        ["Iech", "Fecm", "Fepm", "Prpm", "Prcm"],
    ),
    "dwell on rubble that moves": (
        armour("25 mm APDS", "Al-N", "6061-T6", 10.0, 15.0, perimeter="projectile"),
        700.0,
        ["Iech", "Fecm", "Fepm", "Frpm", "Prpm"],
    ),
    "dwell begins late, plate stops": (
        armour("25 mm APDS", "AD99.5", "6061-T6", 12.6, 11.6),
        720.0,
        ["Ieph", "Iech", "Fecm", "Fepm", "Feph", "Prpm", "Prcm"],
    ),
    "plate moves, stops and moves": (
        armour(),
        800.0,
        ["Ieph", "Fepm", "Feph", "Prpm", "Prcm"],
    ),
    "rigid in rubble": (
        armour("25 mm APDS", "AD85", "6061-T6", 25.5, 5.0),
        700.0,
        ["Ieph", "Fepm", "Feph", "Frph", "Prpm", "Prcm"],
    ),
    "rod erodes in the plate": (
        armour("7.62 mm AP", "Al-N", "7075-T6", 3.0, 20.0),
        1220.0,
        ["Ieph", "Feph", "Peph", "Pepm", "Prpm", "Prcm"],
    ),
    "plate carried by an eroding rod": (
        armour("25 mm APDS", "AD85", "6061-T6", 6.0, 8.0)._replace(YB=12e9),
        900.0,
        ["Ieph", "Fepm", "Pecm", "Prcm"],
    ),
}
LONGEST = 0.5e-6
HALVINGS = 6
# Below this the error is rounding: a few hundred steps, each good to about 1e-13 m/s.
ROUNDING = 2e-10


def residual(a: Parameters, velocity: float, dt: float) -> float:
    return run(a, velocity, dt, 1.0, 1_000_000).y.V


@pytest.mark.parametrize("name", PATHS)
def test_the_error_falls_by_sixteen_with_every_halving_of_the_step(name: str):
    a, velocity, stages = PATHS[name]
    assert path(traced(a, velocity)[1]) == stages
    exact = residual(a, velocity, LONGEST / 256)
    errors = [abs(residual(a, velocity, LONGEST / 2**k) - exact) for k in range(HALVINGS)]
    seen = [(coarse, fine) for coarse, fine in pairwise(errors) if fine > ROUNDING]
    assert len(seen) >= 3
    for coarse, fine in seen:
        assert 12.0 < coarse / fine < 20.0
    assert errors[-1] < 1e-8


def test_most_paths_cross_four_changes_of_stage():
    assert sum(len(stages) > 4 for _, _, stages in PATHS.values()) >= 6
