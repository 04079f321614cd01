"""Equations of the paper [Paper], one relation per function; numbers in parentheses are the paper's.

All quantities are in SI units and in the symbols of `armour.core.state`.  ``Y`` and ``rho`` are the strength, Pa,
and the density, kg/m^3, of the medium ahead of the projectile.
"""

from math import pi, sqrt

# Shear laws of the whole plate, see `sheared_diameter`.
PROJECTILE, CONOID = 0, 1
# Laws of the force that drives the plate, see `drive_force` of `armour.core.stages`.
STRENGTH, INTERFACE = 0, 1
# Least and greatest factor of a law of the ceramic's flow stress.
MIN_FACTOR, MAX_FACTOR = 0.05, 20.0
# Least ceramic thickness over the diameter in such a law: keeps its powers finite in a search.
THINNEST_CERAMIC = 1e-15


def cross_section(D0: float) -> float:
    """Return the cross-section A0 of the projectile, m^2."""
    return pi * D0 * D0 / 4.0


def crack_velocity(Ec: float, rho_c: float) -> float:
    """Return the velocity of the crack front in the ceramic, a fifth of the bar wave's, m/s (7)."""
    return sqrt(Ec / rho_c) / 5.0


def intact_strength(
    Yc0: float, D0: float, Hc0: float, Hb: float, n_B: float, n_cB: float, a_c: float, a_B: float
) -> float:
    """Return the flow stress of intact ceramic, Hc0 > 0, by a law of both thicknesses over the diameter, Pa.

    This extends the paper, which takes the flow stress as constant but suggests that it depends on the thicknesses.
    """
    c, b = max(Hc0 / D0, THINNEST_CERAMIC), Hb / D0
    factor: float = b**n_B * (c * b) ** n_cB * (1.0 + a_c * (c - 1.0) + a_B * (b - 1.0))
    return Yc0 * min(max(factor, MIN_FACTOR), MAX_FACTOR)


def fragmented_strength(Yc0: float, V: float, W: float, Vs1: float) -> float:
    """Return the flow stress Yc of fragmented ceramic, Pa (9)."""
    v = V - W
    return Yc0 / (Vs1 * Vs1) * (v * v)


def projectile_pressure(Yp: float, rho_p: float, V: float, U: float) -> float:
    """Return the pressure of an eroding projectile on the interface, Pa: left side of (5), (8), (20)."""
    return Yp + rho_p * V * (V - U)


def target_pressure(Y: float, rho: float, U: float, W: float) -> float:
    """Return the pressure of a penetrated medium on the interface, Pa: right side of (5), (8), (20)."""
    return Y + rho * U * (U - W)


def penetration_velocity(Y: float, rho: float, Yp: float, rho_p: float, V: float, W: float) -> float:
    """Return the penetration velocity U at which both sides yield under equal pressure, m/s (6), (10), (21)."""
    mu = rho / rho_p
    b = V - mu * W
    c = V * V - (Y - Yp) * (1.0 / rho_p)
    # A trial state far past an event may have no solution; its step is then shortened.
    root = sqrt(max(b * b + 4.0 * mu * c, 0.0))
    # The root of smaller magnitude, in the form without cancellation.
    return (root - b) * (0.5 / mu)


def target_excess(Y: float, Yp: float, rho_p: float, V: float, W: float) -> float:
    """Return the projectile's pressure at U = W less the target's strength, Pa; the target yields where > 0."""
    return Yp + rho_p * V * (V - W) - Y


def projectile_excess(Y: float, rho: float, Yp: float, V: float, W: float) -> float:
    """Return the target's pressure at U = V less the projectile's strength, Pa; the projectile yields where > 0."""
    return Y + rho * V * (V - W) - Yp


def erosion_rate(V: float, U: float) -> float:
    """Return dL/dt of an eroding projectile, m/s (2)."""
    return -(V - U)


def deceleration(pressure: float, rho_p: float, L: float) -> float:
    """Return dV/dt under a pressure on the end of the rigid part, m/s^2 (3), (18), (29).

    The pressure is Yp where the projectile erodes (3) and the target's where it is rigid (18), (29).  Equation (18)
    is read with a bracket that is missing in print, so that the cross-section cancels, and (29) with rho_p for the
    printed rho_B.
    """
    return -pressure / (rho_p * L)


def carried_deceleration(
    F: float, A0: float, rho_p: float, L: float, rho_c: float, Hc: float, rho_B: float, Hbc: float
) -> float:
    """Return dV/dt = dW/dt of a rigid projectile and all material ahead of it, m/s^2 (31), (33)."""
    return -F / ((rho_p * L + rho_c * Hc + rho_B * Hbc) * A0)


def target_acceleration(drive: float, F: float, M: float) -> float:
    """Return dW/dt of the material ahead under the drive force, m/s^2 (12), (15), (23), (26)."""
    return (drive - F) / M


def mass_behind_ceramic(rho_B: float, Hb: float, rho_c: float, Hc: float, A0: float) -> float:
    """Return the moving mass while the projectile is in fragmented ceramic, kg (12b)."""
    return (rho_B * Hb + rho_c * Hc) * A0


def mass_in_plate(rho_B: float, Hbc: float, A0: float) -> float:
    """Return the moving mass while the projectile is in the plate, kg (23b)."""
    return rho_B * A0 * Hbc


def sheared_diameter(law: int, D0: float, Hc0: float) -> float:
    """Return the diameter D round which the whole plate is sheared, m (12a).

    The base of the fractured conoid, D0 + 4 Hc0, as the paper's text assumes, or the projectile, as (12a) is printed.
    """
    if law == CONOID:
        return D0 + 4.0 * Hc0
    return D0


def shear_force_whole_plate(D: float, tau: float, Hb: float) -> float:
    """Return the shear force F on the whole plate round a diameter D, N (12a)."""
    return pi * D * tau * Hb


def shear_force_plug(D0: float, tau: float, Hb: float, Hc0: float, h: float, Z: float) -> float:
    """Return the shear force F round the projectile on the remaining plate, N (23a)."""
    return pi * D0 * tau * (Hb + Hc0 + h - Z)


def remaining_ceramic(Hc0: float, Z: float, h: float) -> float:
    """Return the ceramic Hc that remains ahead of the projectile, m."""
    return Hc0 - Z + h


def remaining_plate(Hb: float, Hc0: float, Z: float, h: float, h_s: float) -> float:
    """Return the back plate Hbc that remains ahead of a projectile in the plate, m (22)."""
    return Hb + Hc0 - Z + h - h_s
