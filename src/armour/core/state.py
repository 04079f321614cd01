"""The symbols of the model: what is given (`Armour`), what changes (`State`) and what holds (`Stage`)."""

from enum import IntEnum
from typing import NamedTuple


class Medium(IntEnum):
    """What the projectile's front is in."""

    INTACT = 0  # ceramic that the crack has not crossed yet
    FRAGMENTED = 1  # ceramic reduced to rubble
    PLATE = 2


class Outcome(IntEnum):
    """How a run stands or ended."""

    RUNNING = 0
    PERFORATED = 1
    DEFEATED = 2
    UNRESOLVED = 3  # the allowed number of steps was used up


class Parameters(NamedTuple):
    """A projectile and the armour that it strikes: all that stays constant in a run."""

    # projectile
    L0: float  # length at impact, m
    D0: float  # diameter, m
    rho_p: float  # density, kg/m^3
    Yp: float  # flow stress, Pa
    # ceramic
    Hc0: float  # thickness, m; 0 for a bare plate
    rho_c: float  # density, kg/m^3
    Ec: float  # Young's modulus, Pa
    Yc0: float  # flow stress while intact, Pa
    # back plate
    Hb: float  # thickness, m
    rho_B: float  # density, kg/m^3
    YB: float  # constrained flow stress, Pa
    tau: float  # ultimate shear strength, Pa
    # reading of (12a)
    conoid: bool  # sheared round the base of the fractured conoid, else round the projectile


class State(NamedTuple):
    """The five unknowns; also their rates of change, each per second."""

    Z: float  # depth of the projectile's front below the original front face, m
    L: float  # length of the projectile's rigid part, m
    V: float  # velocity of the projectile's rigid part, m/s
    W: float  # velocity of the material carried ahead of the projectile, m/s
    h: float  # bulge height of the plate's back face, m


class Stage(NamedTuple):
    """What holds between two events: the medium ahead, who yields, and what is remembered."""

    medium: int  # a Medium
    eroding: bool  # the projectile yields: V > U; else it is rigid: U = V
    penetrated: bool  # the material ahead yields: U > W; else it is carried along: U = W
    moving: bool  # the material ahead moves, else it is held: W = 0
    Vs1: float  # V when the ceramic had fragmented, m/s (9)
    h_s: float  # h when the projectile entered the plate, m (22)
