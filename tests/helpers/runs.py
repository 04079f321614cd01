"""Runs of the core, stage by stage, and random armours."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from armour.core.equations import INTERFACE, STRENGTH
from armour.core.run import Instant, Run, run
from armour.core.state import Outcome, Parameters
from armour.scenario.schema import SHEAR_LAWS
from tests.helpers.cases import armour


def traced(p: Parameters, velocity: float, dt: float = 0.0) -> tuple[Run, list[Instant]]:
    """A run with all its instants."""
    trace: list[Instant] = []
    return run(p, velocity, dt, 1.0, 200_000, trace), trace


def crossing_time(p: Parameters, velocity: float) -> float:
    """The time in which the projectile crosses its diameter, or the armour if that is thinner, s."""
    return min(p.D0, p.Hc0 + p.Hb) / velocity


def perforates(p: Parameters, velocity: float, part: float = 0.0) -> bool:
    """Whether an impact perforates, by plain Python, with steps of a part of `crossing_time` unless it is 0."""
    dt = part * crossing_time(p, velocity)
    return run(p, velocity, dt, 1.0, 5_000_000).outcome == Outcome.PERFORATED


def path(trace: list[Instant]) -> list[str]:
    """The stages of a run, as letters: medium, projectile, material ahead, motion."""
    names: list[str] = []
    for instant in trace:
        s = instant.s
        name = "IFP"[s.medium] + "re"[s.eroding] + "cp"[s.penetrated] + "hm"[s.moving]
        if not names or names[-1] != name:
            names.append(name)
    return names


class StagePath(NamedTuple):
    """An impact, and the stages that it passes through, in the letters of `path`."""

    parameters: Callable[[], Parameters]
    velocity: float
    stages: list[str]


STAGE_PATHS = {
    "dwell, then moving plate": StagePath(
        lambda: armour("25 mm APDS", "AD99.5", "7075-T6", 4.0, 16.0, perimeter="projectile"),
        600.0,
        ["Iech", "Fecm", "Fepm", "Prpm", "Prcm"],
    ),
    "dwell on rubble that moves": StagePath(
        lambda: armour("25 mm APDS", "Al-N", "6061-T6", 10.0, 15.0, perimeter="projectile"),
        700.0,
        ["Iech", "Fecm", "Fepm", "Frpm", "Prpm"],
    ),
    "dwell begins late, plate stops": StagePath(
        lambda: armour("25 mm APDS", "AD99.5", "6061-T6", 12.6, 11.6),
        720.0,
        ["Ieph", "Iech", "Fecm", "Fepm", "Feph", "Prpm", "Prcm"],
    ),
    "plate moves, stops and moves": StagePath(armour, 800.0, ["Ieph", "Fepm", "Feph", "Prpm", "Prcm"]),
    "rigid in rubble": StagePath(
        lambda: armour("25 mm APDS", "AD85", "6061-T6", 25.5, 5.0),
        700.0,
        ["Ieph", "Fepm", "Feph", "Frph", "Prpm", "Prcm"],
    ),
    "rod erodes in the plate": StagePath(
        lambda: armour("7.62 mm AP", "Al-N", "7075-T6", 3.0, 20.0),
        1220.0,
        ["Ieph", "Feph", "Peph", "Pepm", "Prpm", "Prcm"],
    ),
    "plate carried by an eroding rod": StagePath(
        lambda: armour("25 mm APDS", "AD85", "6061-T6", 6.0, 8.0)._replace(YB=12e9),
        900.0,
        ["Ieph", "Fepm", "Pecm", "Prcm"],
    ),
}


@cache
def random_designs(count: int) -> tuple[Parameters, ...]:
    """Random armours of the paper's projectiles and materials; the plate of every third is driven by the interface."""
    rng = np.random.default_rng(20)
    designs = []
    for i in range(count):
        projectile, diameter = [("7.62 mm AP", 6.5), ("25 mm APDS", 14.25)][rng.integers(2)]
        designs.append(
            armour(
                projectile,
                str(rng.choice(["AD85", "AD99.5", "Al-N"])),
                str(rng.choice(["6061-T6", "7075-T6", "5083-H3"])),
                diameter * float(rng.uniform(0.2, 3.0)) * float(rng.random() > 0.1),
                diameter * float(rng.uniform(0.3, 2.5)),
                perimeter=str(rng.choice([*SHEAR_LAWS])),
            )._replace(drive_law=STRENGTH if i % 3 else INTERFACE)
        )
    return tuple(designs)
