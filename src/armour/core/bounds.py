"""A velocity below which no projectile has the energy to perforate.

Let T be the kinetic energy of projectile and moving target per cross-section, J/m^2.  By the equations of motion it
falls by at least ``Y`` for each metre of the target that is penetrated, and by the shear force over the cross-section
for each metre that it is displaced, as long as an eroding rod loses more energy than it transfers: V^2 <= 2 Yp/rho_p.
docs/design.md derives the bound under "Bound on the energy".
"""

from math import exp, log

from armour.core import equations as eq
from armour.core.stages import with_intact_strength
from armour.core.state import Parameters

# Error of an integration that the bound allows for, as a fraction of the least energy that perforates.
ALLOWANCE = 0.01


def may_perforate(p: Parameters, V: float) -> bool:
    """Return whether a projectile of the velocity V, m/s, may have the energy to perforate."""
    if 2.0 * p.Yp / p.rho_p < V * V:
        return True
    return 0.5 * p.rho_p * p.L0 * V * V * (1.0 + ALLOWANCE) > least_energy(with_intact_strength(p), V)


def least_energy(p: Parameters, V: float) -> float:
    """Return a lower bound on the energy per cross-section, J/m^2, that perforates at an impact velocity V, m/s.

    Where ceramic is ahead, T falls for each metre by at least ``Yc0 (V/Vs1)^2`` (9), in which V^2 is at least
    2 T/(areal mass of projectile and target) and Vs1 at most the impact velocity, or by the work of the displacement.
    """
    plate = least_energy_of_plate(p)
    if p.Hc0 <= 0.0:
        return plate
    areal_mass = p.rho_p * p.L0 + p.rho_B * p.Hb + p.rho_c * p.Hc0
    rate = 2.0 * p.Yc0 / (areal_mass * V * V)
    D = eq.sheared_diameter(p.shear_law, p.D0, p.Hc0)
    A0 = eq.cross_section(p.D0)
    # A mixture of penetration and displacement takes at least a third of the work of displacement.
    greatest = min(eq.shear_force_whole_plate(D, p.tau, p.Hb) / 3.0, eq.shear_force_whole_plate(p.D0, p.tau, p.Hb)) / A0
    knee = greatest / rate
    if plate >= knee:
        return plate + greatest * p.Hc0
    depth = log(knee / plate) / rate
    if depth >= p.Hc0:
        return plate * exp(rate * p.Hc0)
    return knee + greatest * (p.Hc0 - depth)


def least_energy_of_plate(p: Parameters) -> float:
    """Return the least energy per cross-section, J/m^2, that perforates the plate.

    Penetration takes YB for each metre and displacement 4 tau/D0 times the plate ahead (23a); the two add up to Hb.
    The least energy is that of penetration first, until a plug of the thickness YB D0/(8 tau) remains.
    """
    plug = min(p.Hb, p.YB * p.D0 / (8.0 * p.tau))
    return p.YB * (p.Hb - plug) + 4.0 * p.tau / p.D0 * plug * plug
