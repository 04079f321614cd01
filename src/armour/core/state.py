"""Symbols of the model: constants (`Parameters`), unknowns (`State`) and conditions (`Stage`), in SI units."""

from enum import IntEnum
from typing import NamedTuple


class Medium(IntEnum):
    """Medium ahead of the projectile's front."""

    INTACT = 0  # ceramic that the crack has not crossed
    FRAGMENTED = 1  # ceramic behind the crack front
    PLATE = 2  # back plate


class Outcome(IntEnum):
    """Outcome of a run."""

    RUNNING = 0
    PERFORATED = 1
    STOPPED = 2
    UNRESOLVED = 3  # the maximum number of steps was reached


class Parameters(NamedTuple):
    """Projectile and armour: all that stays constant during an impact."""

    # projectile
    L0: float  # length at impact, m
    D0: float  # diameter, m
    rho_p: float  # density, kg/m^3
    Yp: float  # flow stress, Pa
    # ceramic
    Hc0: float  # thickness, m; 0 for a bare plate
    rho_c: float  # density, kg/m^3
    Ec: float  # Young's modulus, Pa
    Yc0: float  # flow stress of the intact ceramic, Pa; by a law, where both layers are D0 thick
    # law of its flow stress, see `armour.core.equations.intact_strength`; all 0 for the paper's constant
    n_B: float  # exponent of Hb/D0
    n_cB: float  # exponent of Hc0 Hb/D0^2
    a_c: float  # slope by Hc0/D0
    a_B: float  # slope by Hb/D0
    # back plate
    Hb: float  # thickness, m
    rho_B: float  # density, kg/m^3
    YB: float  # constrained flow stress, Pa
    tau: float  # ultimate shear strength, Pa
    # readings of (12a) and (23)
    shear_law: int  # diameter of the shear perimeter in (12a), see `armour.core.equations.sheared_diameter`
    drive_law: int  # force of a rigid projectile on the plate in (23), see `armour.core.stages.drive_force`


class State(NamedTuple):
    """The five unknowns; also their rates of change, per second."""

    Z: float  # depth of the projectile's front below the original front face, m
    L: float  # length of the projectile's rigid part, m
    V: float  # velocity of the projectile's rigid part, m/s
    W: float  # velocity of the material ahead of the projectile, m/s
    h: float  # bulge height of the plate's back face, m


class Stage(NamedTuple):
    """Conditions that stay constant between two events."""

    medium: int  # a Medium
    eroding: bool  # the projectile yields, V > U; else it is rigid, U = V
    penetrated: bool  # the material ahead yields, U > W; else it is carried, U = W
    moving: bool  # the material ahead moves; else it is held, W = 0
    Vs1: float  # V at the end of intact ceramic, m/s (9)
    h_s: float  # h on entering the plate, m (22)
