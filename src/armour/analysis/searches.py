"""Ballistic limits and least thicknesses of many variants of a scenario at once."""

from collections.abc import Callable

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints, Variants, check_resolved, perforated, with_thicknesses
from armour.core.search import SCAN_POINTS
from armour.engine import batch
from armour.units import MM

# Width, mm, to which a least thickness is bisected.
THICKNESS_TOLERANCE_MM = 1e-6

# Whether a condition holds at values of some rows: (values, rows) -> holds.
Condition = Callable[[Floats, Ints], Bools]


def ballistic_limits(variants: Variants, threads: int | None = None, *, tolerance: float | None = None) -> Floats:
    """Return the ballistic limit of each row, m/s, to a tolerance, m/s, by default that of the section; NaN for none.

    It is, to the last bit, the number that `armour.analysis.ballistic_limit.ballistic_limit` finds.
    """
    section = variants.settings.ballistic_limit
    tolerance = section.tolerance_m_s if tolerance is None else tolerance
    found = limit_brackets(variants, section.velocity_min_m_s, section.velocity_max_m_s, tolerance, threads)
    return np.where(found.bounded, found.perforated, np.nan)


def limit_brackets(
    variants: Variants,
    low: float,
    high: float,
    tolerance: float,
    threads: int | None = None,
    points: int = SCAN_POINTS,
) -> batch.Brackets:
    """Return brackets of the ballistic limit of each row that a scan of points from low to high, m/s, sees."""
    options = variants.settings.options(threads)
    found = batch.ballistic_limits(variants.parameters, low, high, tolerance, options, points)
    check_resolved(found.resolved, variants._replace(velocities=found.perforated))
    return found


def bisect_rows(
    holds: Condition,
    tolerance: float,
    low: Floats,
    high: Floats,
    below: Floats | None = None,
    above: Floats | None = None,
) -> Floats:
    """Return the upper ends of brackets (low, high) after bisection; a condition holds there and not at the lower ends.

    Narrower brackets (below, above) that are known to contain the change save evaluations, but do not alter the result.
    """
    low, high = low.copy(), high.copy()
    below, above = low if below is None else below, high if above is None else above
    while True:
        middle = 0.5 * (low + high)
        rows = np.flatnonzero((high - low > tolerance) & (low < middle) & (middle < high))
        if not len(rows):
            return high
        values = middle[rows]
        good = values >= above[rows]
        unknown = ~good & (values > below[rows])
        good[unknown] = holds(values[unknown], rows[unknown])
        high[rows[good]] = values[good]
        low[rows[~good]] = values[~good]


def least_ceramics_mm(variants: Variants, threads: int | None = None) -> Floats:
    """Return the least ceramic thickness of the grid's range that defeats each impact, mm; NaN where none does."""
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    low, high = grid.ceramic_thickness_mm.min, grid.ceramic_thickness_mm.max
    found = batch.least_thicknesses(
        variants.parameters,
        variants.velocities,
        low * MM,
        high * MM,
        THICKNESS_TOLERANCE_MM * MM,
        variants.settings.options(threads),
    )
    check_resolved(found.resolved, variants)
    # The perforated end of a bracket of thicknesses is the lower one.
    below, above = found.perforated / MM, found.defeated / MM
    least = np.where(np.isfinite(above) & ~np.isfinite(below), low, np.nan)
    where = np.flatnonzero(np.isfinite(above) & np.isfinite(below))
    bounded = variants.at(where)

    def defeated(values: Floats, rows: Ints) -> Bools:
        return ~perforated(with_thicknesses(bounded.at(rows), ceramic_mm=values), threads)

    ends = np.full(len(where), low), np.full(len(where), high)
    least[where] = bisect_rows(defeated, THICKNESS_TOLERANCE_MM, *ends, below[where], above[where])
    return least


def least_backings_mm(variants: Variants, threads: int | None = None) -> Floats:
    """Return the least back plate thickness of the grid's range that defeats each impact, mm; NaN where none does."""
    grid = variants.settings.grid
    assert grid is not None, "checked before"

    def defeated(values: Floats, rows: Ints) -> Bools:
        return ~perforated(with_thicknesses(variants.at(rows), backing_mm=values), threads)

    count, backing = len(variants.velocities), grid.backing_thickness_mm
    return least_values_mm(defeated, np.full(count, backing.min), np.full(count, backing.max))


def least_totals_mm(variants: Variants, threads: int | None = None) -> Floats:
    """Return the least thickness of both layers together that defeats each impact, mm; NaN where none does.

    The layers keep their proportion and are within the grid's ranges.
    """
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    ceramics, backings = variants.ceramics_mm, variants.backings_mm
    totals = ceramics + backings
    low, high = grid.backing_thickness_mm.min / backings, grid.backing_thickness_mm.max / backings
    layered = ceramics > 0.0
    low[layered] = np.maximum(low[layered], grid.ceramic_thickness_mm.min / ceramics[layered])
    high[layered] = np.minimum(high[layered], grid.ceramic_thickness_mm.max / ceramics[layered])
    where = np.flatnonzero(low <= high)

    def scaled(values: Floats, rows: Ints) -> Variants:
        some = where[rows]
        ceramic_mm, backing_mm = (values * layer[some] / totals[some] for layer in (ceramics, backings))
        return with_thicknesses(variants.at(some), ceramic_mm=ceramic_mm, backing_mm=backing_mm)

    least = np.full(len(totals), np.nan)
    least[where] = least_values_mm(
        lambda values, rows: ~perforated(scaled(values, rows), threads),
        low[where] * totals[where],
        high[where] * totals[where],
    )
    return least


def least_values_mm(defeated: Condition, low: Floats, high: Floats) -> Floats:
    """Return the least thickness from low to high, mm, that defeats the threat in each row; NaN where high does not."""
    rows = np.arange(len(low))
    least = np.where(defeated(low, rows), low, np.nan)
    rest = rows[np.isnan(least)]
    rest = rest[defeated(high[rest], rest)]
    least[rest] = bisect_rows(
        lambda values, some: defeated(values, rest[some]), THICKNESS_TOLERANCE_MM, low[rest], high[rest]
    )
    return least
