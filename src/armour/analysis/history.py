"""The history of an impact: the state of projectile and armour over time."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import ceil, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from armour.analysis.results import TableResult, same_columns
from armour.core import stages
from armour.core.rk4 import state_within
from armour.core.run import Instant
from armour.core.state import Parameters
from armour.units import KN, MM, US


@dataclass(frozen=True, repr=False)
class History(TableResult):
    """Quantities of an impact over time, one array each, all of the same length.

    A change of stage, or armour ahead that starts or stops moving, gives two entries at one time, before and after it.

    Attributes
    ----------
    time_us : array
        Time since impact, µs.
    depth_mm : array
        Depth of the projectile's front below the original front face, mm.
    length_mm, velocity_m_s : array
        Length, mm, and velocity, m/s, of the projectile's rigid part.
    penetration_velocity_m_s : array
        Velocity of the projectile's front, m/s.
    target_velocity_m_s : array
        Velocity of the armour ahead of the projectile, m/s.
    bulge_height_mm : array
        Height of the bulge on the back face, mm.
    ceramic_ahead_mm, backing_ahead_mm : array
        Ceramic and back plate ahead of the projectile's front, mm.
    interface_force_kN, shear_force_kN : array
        Force between projectile and armour, and force that shears the back plate, kN.
    stage : array of str
        Name of the stage in the paper: "i", "ii.1" ... "iii.5".
    """

    time_us: NDArray[np.float64]
    depth_mm: NDArray[np.float64]
    length_mm: NDArray[np.float64]
    velocity_m_s: NDArray[np.float64]
    penetration_velocity_m_s: NDArray[np.float64]
    target_velocity_m_s: NDArray[np.float64]
    bulge_height_mm: NDArray[np.float64]
    ceramic_ahead_mm: NDArray[np.float64]
    backing_ahead_mm: NDArray[np.float64]
    interface_force_kN: NDArray[np.float64]
    shear_force_kN: NDArray[np.float64]
    stage: NDArray[np.str_]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, History) and same_columns(self._columns(), other._columns())

    def to_dict(self) -> dict[str, Any]:
        """Return the quantities as lists by name."""
        return {name: values.tolist() for name, values in self._columns().items()}

    def _words(self) -> str:
        return f"{len(self.time_us)} instants from 0 to {self.time_us[-1]:.2f} µs"

    def _columns(self) -> dict[str, Any]:
        return {item.name: getattr(self, item.name) for item in fields(self)}


def history_of(trace: Sequence[Instant], armour: Parameters, spacing: float) -> History:
    """Return the history of a traced run, in the units of the result, with instants at most a spacing, s, apart."""
    trace = refined(trace, armour, spacing)

    def column(values: Sequence[float], unit: float = 1.0) -> NDArray[np.float64]:
        return np.array(values) / unit

    return History(
        time_us=column([i.t for i in trace], US),
        depth_mm=column([i.y.Z for i in trace], MM),
        length_mm=column([i.y.L for i in trace], MM),
        velocity_m_s=column([i.y.V for i in trace]),
        penetration_velocity_m_s=column([stages.front_velocity(i.y, i.s, armour) for i in trace]),
        target_velocity_m_s=column([i.y.W for i in trace]),
        bulge_height_mm=column([i.y.h for i in trace], MM),
        ceramic_ahead_mm=column([stages.ceramic_ahead(i.y, i.s, armour) for i in trace], MM),
        backing_ahead_mm=column([stages.plate_ahead(i.y, i.s, armour) for i in trace], MM),
        interface_force_kN=column([stages.interface_force(i.y, i.s, armour) for i in trace], KN),
        shear_force_kN=column([stages.shear_force(i.y, i.s, armour) for i in trace], KN),
        stage=np.array([stages.stage_name(i.s) for i in trace]),
    )


def refined(trace: Sequence[Instant], armour: Parameters, spacing: float) -> list[Instant]:
    """Return a trace with added instants at the multiples of a spacing, s, on the cubics through its steps."""
    instants = [trace[0]]
    for before, after in pairwise(trace):
        dt = after.t - before.t
        inside = range(floor(before.t / spacing) + 1, ceil(after.t / spacing)) if dt > 0.0 else ()
        if inside:
            k0, k1 = (stages.rates(instant.y, after.s, armour) for instant in (before, after))
            times = [spacing * i for i in inside]
            states = [state_within(before.y, k0, after.y, k1, dt, (t - before.t) / dt) for t in times]
            # A bulge never recedes, but that of the cubic may, by its error, just after the plate starts to move.
            grown = [y._replace(h=max(y.h, before.y.h)) for y in states]
            instants += [Instant(t, y, after.s) for t, y in zip(times, grown, strict=True)]
        instants.append(after)
    return instants
