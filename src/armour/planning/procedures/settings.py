"""What the procedures of a firing share: their settings, and the velocity that they choose with the reason."""

from typing import NamedTuple

from armour.statistics.firing_posterior import FiringPrior


class ShotSettings(NamedTuple):
    """Settings of a procedure; velocities in m/s."""

    estimate_m_s: float  # of V50: the model's ballistic limit
    scatter_m_s: float  # guess of the standard deviation of the response curve
    limits_m_s: tuple[float, float] | None = None  # of V50; for Langlie's and Neyer's procedures
    half_width_m_s: float | None = (
        None  # of the interval of V50 at which the firing ends; None: the procedure's own rule
    )
    confidence: float = 0.95
    requirement_m_s: float | None = None
    requirement_fraction: float = 0.5  # part of shots that may perforate at the requirement
    prior: FiringPrior | None = None


class Aim(NamedTuple):
    """Velocity of the next shot, m/s, and why."""

    velocity_m_s: float
    why: str
