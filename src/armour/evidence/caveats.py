"""Caveats: sentences on what the model cannot do for an armour, which are shown with its answer."""

from collections.abc import Iterable, Iterator
from math import floor, sqrt
from typing import Any

import numpy as np

from armour.core import equations
from armour.core.state import Parameters
from armour.errors import Note
from armour.scenario.library import NOT_MODELLED, LibraryEntry

# A back plate does not count as a metal below the first density, where magnesium begins, and surely is one from the
# second on, kg/m³.  Laminates of aramid and carbon fibre have 1,350 to 1,600, as magnesium-lithium alloys; of glass, up
# to 2,000.
LEAST_METAL_KG_M3, SURELY_METAL_KG_M3 = 1740.0, 2100.0
# Length over diameter from which on a penetrator is a long rod: the cores of bullets have up to 6; and the density from
# which on rods and plates are at least as dense as steel, kg/m³.
LONG_ROD, DENSE_KG_M3 = 8.0, 7000.0


def is_no_metal(density_kg_m3: Any) -> Any:
    """Return whether back plates, given their densities, do not count as a metal; a bool or an array."""
    return density_kg_m3 < LEAST_METAL_KG_M3


def no_metal(density_kg_m3: float) -> str:
    """Return the caveat, in words, that a back plate does not count as a metal, which the model may not describe."""
    return (
        f"a back plate of {floor(density_kg_m3):,} kg/m³ may be no metal: {NOT_MODELLED} (below "
        f"{LEAST_METAL_KG_M3:,.0f}, the density does not tell a laminate from a magnesium-lithium alloy)"
    )


def is_long_rod(armour: Parameters) -> Any:
    """Return whether the projectiles of armours are long rods; a bool or an array."""
    return armour.L0 / armour.D0 >= LONG_ROD


def is_limit_too_low(armour: Parameters) -> Any:
    """Return whether ballistic limits by the model are known to be too low: bare steel against dense long rods."""
    is_dense = (armour.rho_p >= DENSE_KG_M3) & (armour.rho_B >= DENSE_KG_M3)
    return is_long_rod(armour) & is_dense & (armour.Hc0 == 0.0)


def caveats(armour: Parameters, metals: Iterable[LibraryEntry]) -> Iterator[tuple[Note, Any]]:
    """Yield what the model cannot do for n armours, and which of their metals have doubtful values.

    The parameters of `armour` are arrays, (n,).  Each caveat comes with a mask of the armours that it is about, (n,).
    """
    density, key = np.atleast_1d(armour.rho_B), "backing.density_kg_m3"
    unlike = is_no_metal(density)
    if unlike.any():
        least = float(density[unlike].min())
        yield Note(no_metal(least), key, said="not known", about=("no metal", least)), unlike
    doubted = ~unlike & (density < SURELY_METAL_KG_M3)
    if doubted.any():
        least = float(density[doubted].min())
        question = (
            f"is a back plate of {floor(least):,} kg/m³ a metal? {NOT_MODELLED} (glass laminates reach 2,000 kg/m³, "
            f"magnesium begins at {LEAST_METAL_KG_M3:,.0f})"
        )
        yield Note(question, key, said="caveat", about=("doubted metal", least)), doubted
    long, too_low = ~unlike & is_long_rod(armour), np.atleast_1d(is_limit_too_low(armour))
    for rows, more, kind in ((long & too_low, "; the limit is too low", "too low"), (long & ~too_low, "", "caveat")):
        if rows.any():
            place = int(np.argmax(np.where(rows, armour.L0 / armour.D0, 0.0)))  # of the longest rod
            numbers = [float(np.atleast_1d(each)[place]) for each in (armour.L0 / armour.D0, density, armour.rho_p)]
            about: tuple[str | float, ...] = (f"long rod{more}", *numbers)
            yield Note(long_rod(*numbers) + more, "projectile", said=kind, about=about), rows
    for name, reason in {metal.name: metal.doubtful for metal in metals if metal.doubtful}.items():
        words = f"the values of {name} are doubtful: {reason}"
        yield Note(words, "armour.backing", said="caveat", about=("doubtful values", name)), ~unlike


def long_rod(slenderness: float, plate_kg_m3: float, rod_kg_m3: float) -> str:
    """Return the caveat, in words, about a long rod: how far the paper's equations drive it into a plate, if fast.

    `slenderness` is length over diameter; the densities are in kg/m³.
    """
    # Without strengths, as those of a fast rod and its plate do not matter.
    speed = equations.penetration_velocity(0.0, plate_kg_m3, 0.0, rod_kg_m3, 1.0, 0.0)
    depth, hydrodynamic = speed / (1.0 - speed), sqrt(rod_kg_m3 / plate_kg_m3)
    return (
        f"a long rod, {slenderness:.3g} diameters: these equations drive a fast one {depth:.1f} times its length into "
        f"this plate, {depth / hydrodynamic:.1f} times the hydrodynamic depth"
    )
