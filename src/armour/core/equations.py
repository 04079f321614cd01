"""The paper's equations, one relation per function, its numbers beside them.

SI units and the symbols of `armour.core.state` throughout.  ``Y`` and ``rho`` are the strength and the density
of the medium ahead of the projectile, whichever it is.
"""

from math import pi, sqrt


def cross_section(D0: float) -> float:
    """Cross-section A0 of the projectile."""
    return pi * D0 * D0 / 4.0


def crack_velocity(Ec: float, rho_c: float) -> float:
    """Velocity of the crack front through the ceramic, a fifth of the bar's speed of sound (7)."""
    return sqrt(Ec / rho_c) / 5.0


def fragmented_strength(Yc0: float, V: float, W: float, Vs1: float) -> float:
    """Flow stress Yc of fragmented ceramic (9)."""
    v = (V - W) / Vs1
    return Yc0 * v * v


def projectile_pressure(Yp: float, rho_p: float, V: float, U: float) -> float:
    """Pressure that an eroding projectile exerts on the interface: left side of (5), (8), (20)."""
    return Yp + rho_p * V * (V - U)


def target_pressure(Y: float, rho: float, U: float, W: float) -> float:
    """Pressure with which a penetrated medium resists: right side of (5), (8), (20)."""
    return Y + rho * U * (U - W)


def penetration_velocity(Y: float, rho: float, Yp: float, rho_p: float, V: float, W: float) -> float:
    """Penetration velocity U* at which both sides yield under equal pressure (6), (10), (21)."""
    mu = rho / rho_p
    b = V - mu * W
    c = V * V - (Y - Yp) / rho_p
    # A trial stage far past an event can have no solution; the step is then shortened.
    root = sqrt(max(b * b + 4.0 * mu * c, 0.0))
    # The root of the smaller magnitude, in the form that does not cancel.
    return 2.0 * c / (root + b) if b > 0.0 else (root - b) / (2.0 * mu)


def target_excess(Y: float, Yp: float, rho_p: float, V: float, W: float) -> float:
    """Pressure by which the target would have to exceed its strength to keep up; it yields where > 0."""
    return Yp + rho_p * V * (V - W) - Y


def projectile_excess(Y: float, rho: float, Yp: float, V: float, W: float) -> float:
    """Pressure by which the projectile would have to exceed its strength; it yields where > 0."""
    return Y + rho * V * (V - W) - Yp


def erosion_rate(V: float, U: float) -> float:
    """dL/dt of an eroding projectile (2)."""
    return -(V - U)


def deceleration(pressure: float, rho_p: float, L: float) -> float:
    """dV/dt under the pressure at the end of the rigid part.

    Yp where the projectile erodes (3), the target's where it is rigid (18), (29).  Neither (18), in which the
    cross-section divides out, nor (29), which prints the plate's density, is meant as printed.
    """
    return -pressure / (rho_p * L)


def carried_deceleration(
    F: float, A0: float, rho_p: float, L: float, rho_c: float, Hc: float, rho_B: float, Hbc: float
) -> float:
    """dV/dt = dW/dt of a rigid projectile and all that is ahead of it (31), (33)."""
    return -F / ((rho_p * L + rho_c * Hc + rho_B * Hbc) * A0)


def target_acceleration(drive: float, F: float, M: float) -> float:
    """dW/dt of the material ahead under the projectile's drive (12), (15), (23), (26)."""
    return (drive - F) / M


def mass_behind_ceramic(rho_B: float, Hb: float, rho_c: float, Hc: float, A0: float) -> float:
    """Mass moved while the projectile is in fragmented ceramic (12b)."""
    return (rho_B * Hb + rho_c * Hc) * A0


def mass_in_plate(rho_B: float, Hbc: float, A0: float) -> float:
    """Mass moved while the projectile is in the plate (23b)."""
    return rho_B * A0 * Hbc


def conoid_diameter(D0: float, Hc0: float) -> float:
    """Diameter of the base of the fractured conoid: the projectile's and four ceramic thicknesses."""
    return D0 + 4.0 * Hc0


def shear_force_whole_plate(D: float, tau: float, Hb: float) -> float:
    """Shear force F on the whole plate round a diameter D (12a)."""
    return pi * D * tau * Hb


def shear_force_plug(D0: float, tau: float, Hb: float, Hc0: float, h: float, Z: float) -> float:
    """Shear force F round the projectile on what is left of the plate (23a)."""
    return pi * D0 * tau * (Hb + Hc0 + h - Z)


def remaining_ceramic(Hc0: float, Z: float, h: float) -> float:
    """Ceramic Hc that remains ahead of the projectile."""
    return Hc0 - Z + h


def remaining_plate(Hb: float, Hc0: float, Z: float, h: float, h_s: float) -> float:
    """Back plate Hbc that remains ahead of a projectile in the plate (22)."""
    return Hb + Hc0 - Z + h - h_s
