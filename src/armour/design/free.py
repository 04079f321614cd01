"""Minimum over designs with both thicknesses free."""

from collections.abc import Callable

import numpy as np

from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.searches import least_ceramics_mm
from armour.analysis.variants import Floats, Variants, with_thicknesses

# Largest distance of the back plate thicknesses of the last round, mm.
BACKING_TOLERANCE_MM = 1e-3
# Ratio of the distances of the back plate thicknesses of one round and the next.
CLOSER = 10
# Searches for a ceramic thickness that are done at a time, which bounds the memory.
SEARCHES_AT_A_TIME = 10_000


def searches_of(variants: Variants) -> int:
    """Return the greatest number of searches for a ceramic that `least_areal_densities` takes."""
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    width, each = grid.backing_thickness_mm.step, len(grid.backing_thickness_mm.values())
    while width > BACKING_TOLERANCE_MM:
        width /= CLOSER
        each += 2 * CLOSER + 1
    return each * len(variants.velocities)


def least_areal_densities(variants: Variants, on_progress: OnProgress = ignore_progress) -> Floats:
    """Return the least areal density that defeats each impact, kg/m², (n,); NaN where no design does.

    Both thicknesses are free within the ranges of the grid.  `on_progress` is called with searches for a ceramic.
    """
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    count = len(variants.velocities)

    def values_of(backings: Floats) -> Floats:
        values = np.empty(backings.size)
        for part in portions(backings.size, SEARCHES_AT_A_TIME):
            many = variants.at(np.arange(part.start, part.stop) // backings.shape[1])
            many = with_thicknesses(many, backing_mm=backings.ravel()[part])
            many = with_thicknesses(many, ceramic_mm=least_ceramics_mm(many).mm)
            values[part] = np.nan_to_num(many.areal_densities_kg_m2, nan=np.inf)
            on_progress(part.stop - part.start, None)
        return values.reshape(backings.shape)

    section = grid.backing_thickness_mm
    first = np.tile(section.values(), (count, 1))
    least = minimise_over_backings(values_of, first, section.min, section.max, section.step)
    return np.where(np.isfinite(least), least, np.nan)


def minimise_over_backings(
    values_of: Callable[[Floats], Floats], first: Floats, low: float, high: float, width: float
) -> Floats:
    """Return the minimum of a function of the back plate thickness in each row, (n,); inf where it has no value.

    The function returns values, (n, k), at thicknesses, (n, k), mm.  The first round has the thicknesses given, at a
    distance of ``width``; each further round has thicknesses from low to high closer together around the best.
    """
    backings, rows = first, np.arange(len(first))
    while True:
        values = values_of(backings)
        best = values.argmin(axis=1)
        centre, least = backings[rows, best], values.min(axis=1)
        if width <= BACKING_TOLERANCE_MM or not np.isfinite(least).any():
            return least
        closer = np.linspace(np.maximum(centre - width, low), np.minimum(centre + width, high), 2 * CLOSER, axis=1)
        backings = np.concatenate([centre[:, None], closer], axis=1)
        width /= CLOSER
