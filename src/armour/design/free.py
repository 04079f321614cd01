"""Free thicknesses: the least of one layer that the other needs, and the best of both."""

from collections.abc import Callable

import numpy as np

from armour.analysis.searches import least_ceramics_mm, least_values_mm
from armour.analysis.variants import Bools, Floats, Ints, Variants, with_thicknesses
from armour.design.requirement import Requirement
from armour.scenario.schema import Layer, Range

# Back plate thicknesses of the first round of a search of which both layers are free.
FIRST_VALUES = 41
# Distance of the back plate thicknesses of its last round, mm, at most.
BACKING_TOLERANCE_MM = 1e-3
# How many times closer together the back plate thicknesses of a round are than those of the round before.
CLOSER = 10


def is_free(layer: Layer, *, refine: bool = False) -> bool:
    """Return whether any thickness of a layer's range may be chosen; ``refine`` includes ranges with a step."""
    low, high = _ends(layer)
    return low < high and (layer.free or (refine and isinstance(layer.thickness_mm, Range)))


def free_designs(requirement: Requirement, pair: int, *, refine: bool = False) -> tuple[Floats, Floats]:
    """Find designs of a pair of which a layer is free: the least of it that each thickness of the other needs.

    Where both are free, the back plate thicknesses are chosen ever closer together round the best design.

    Parameters
    ----------
    requirement : Requirement
    pair : int
    refine : bool
        Whether layers with evenly spaced thicknesses are free between them.

    Returns
    -------
    ceramics, backings : array
        Thicknesses of designs that pass, mm.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    offer = requirement.catalogue.offers[pair]
    if not is_free(offer.backing, refine=refine):
        backing = np.array(offer.backing.thicknesses())
        return _kept(_least(requirement, pair, offer.ceramic, backing), backing)
    if not is_free(offer.ceramic, refine=refine):
        ceramic = np.array(offer.ceramic.thicknesses())
        return _kept(_least(requirement, pair, offer.backing, ceramic), ceramic)[::-1]

    found: list[tuple[Floats, Floats]] = []
    low, high = _ends(offer.backing)
    if isinstance(offer.backing.thickness_mm, Range):
        first, width = np.array(offer.backing.thicknesses()), offer.backing.thickness_mm.step
    else:
        first, width = np.linspace(low, high, FIRST_VALUES), (high - low) / (FIRST_VALUES - 1)

    def values_of(backings: Floats) -> Floats:
        backing = backings[0]
        ceramic = _least(requirement, pair, offer.ceramic, backing)
        found.append(_kept(ceramic, backing))
        designs = requirement.catalogue.candidates(pair, ceramic, backing)
        violations = np.where(np.isnan(ceramic), np.inf, requirement.catalogue.violations(designs))
        kept = violations <= 0.0
        if not kept.any():
            return violations[None]  # towards the design that violates its constraints least
        return np.where(kept, getattr(designs, requirement.catalogue.section.minimise), np.inf)[None]

    _minimise(values_of, first[None], low, high, width)
    ceramics, backings = (np.concatenate(columns) for columns in zip(*found, strict=True))
    return ceramics, backings


def least_areal_densities(variants: Variants) -> Floats:
    """Find the areal density, kg/m^2, of the lightest design of each row that defeats its impact.

    Both layers are free within the ranges of the grid; those of the rows themselves do not count.

    Returns
    -------
    array, (n,)
        NaN where no design defeats the impact.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    count = len(variants.velocities)

    def values_of(backings: Floats) -> Floats:
        many = variants.at(np.repeat(np.arange(count), backings.shape[1]))
        many = with_thicknesses(many, backing_mm=backings.ravel())
        many = with_thicknesses(many, ceramic_mm=least_ceramics_mm(many))
        return np.nan_to_num(many.areal_densities_kg_m2, nan=np.inf).reshape(backings.shape)

    section = grid.backing_thickness_mm
    least = _minimise(values_of, np.tile(section.values(), (count, 1)), section.min, section.max, section.step)
    return np.where(np.isfinite(least), least, np.nan)


def _minimise(values_of: Callable[[Floats], Floats], first: Floats, low: float, high: float, width: float) -> Floats:
    """Minimise a function of the back plate thickness in each row, with ever closer thicknesses round the best.

    Parameters
    ----------
    values_of : callable
        Values at thicknesses, (n, k) to (n, k); inf where there is none.
    first : array, (n, k)
        Thicknesses of the first round, mm.
    low, high : float
        Range of the thickness, mm.
    width : float
        Distance of the thicknesses of the first round, mm.

    Returns
    -------
    array, (n,)
        Least values found; inf where there is none.
    """
    backings, rows = first, np.arange(len(first))
    while True:
        values = values_of(backings)
        best = values.argmin(axis=1)
        centre, least = backings[rows, best], values.min(axis=1)
        if width <= BACKING_TOLERANCE_MM or not np.isfinite(least).any():
            found: Floats = least
            return found
        closer = np.linspace(np.maximum(centre - width, low), np.minimum(centre + width, high), 2 * CLOSER, axis=1)
        backings = np.concatenate([centre[:, None], closer], axis=1)
        width /= CLOSER


def _least(requirement: Requirement, pair: int, layer: Layer, other: Floats) -> Floats:
    """Find the least thickness of a free layer, mm, with which each thickness of the other passes; NaN where none does.

    It is bisected on the outcome at the velocity required; only where a ballistic limit lies below that, on the limit.
    """
    ceramic = layer is requirement.catalogue.offers[pair].ceramic

    def holds(condition: Callable[[Ints, Floats, Floats], Bools]) -> Callable[[Floats, Ints], Bools]:
        def at(values: Floats, rows: Ints) -> Bools:
            layers = (values, other[rows]) if ceramic else (other[rows], values)
            return condition(np.full(len(rows), pair), *layers)

        return at

    passes = holds(requirement.passes)
    low, high = (np.full(len(other), end) for end in _ends(layer))
    least = least_values_mm(holds(requirement.defeats), low, high)
    found = np.flatnonzero(~np.isnan(least))
    rest = found[~passes(least[found], found)]
    least[rest] = least_values_mm(lambda values, rows: passes(values, rest[rows]), least[rest], high[rest])
    return least


def _ends(layer: Layer) -> tuple[float, float]:
    """Return the least and the greatest thickness of a layer, mm."""
    if isinstance(layer.thickness_mm, list):
        return min(layer.thickness_mm), max(layer.thickness_mm)
    return layer.thickness_mm.min, layer.thickness_mm.max


def _kept(least: Floats, other: Floats) -> tuple[Floats, Floats]:
    """Return the designs of which the free layer has a thickness that passes."""
    there = ~np.isnan(least)
    return least[there], other[there]
