"""Candidate designs: all combinations of the given thicknesses; of a free thickness, the least value that passes."""

from collections.abc import Callable
from functools import partial

import numpy as np

from armour.analysis.searches import least_values_mm
from armour.analysis.variants import Bools, Floats, Ints
from armour.design.catalogue import Candidates
from armour.design.free import minimise_over_backings
from armour.design.requirement import Requirement
from armour.design.search import Search
from armour.scenario.schema import FreeRange, Range

# Back plate thicknesses of the first round of a search in which both layers are free.
FIRST_VALUES = 41


def candidates_of(requirement: Requirement, *, refine: bool = False) -> Candidates:
    """Return the candidate designs that meet the constraints, in the order of the objective.

    With ``refine`` all ranges are free between their values.
    """
    catalogue = requirement.catalogue
    parts = [_of_pair(requirement, pair, refine=refine) for pair in range(len(catalogue.offers))]
    found = Candidates(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    found = found.at(catalogue.violations(found) <= 0.0)
    return found.at(catalogue.objective(found).argsort(kind="stable"))


def _of_pair(requirement: Requirement, pair: int, *, refine: bool) -> Candidates:
    """Return the candidate designs of a pair; a free thickness is NaN where no value of it passes."""
    catalogue, offer = requirement.catalogue, requirement.catalogue.offers[pair]
    ceramic, backing = (layer.free_range(refine=refine) for layer in (offer.ceramic, offer.backing))
    ceramics, backings = (np.array(layer.thicknesses()) for layer in (offer.ceramic, offer.backing))
    of_ceramics = partial(catalogue.candidates, pair)

    def of_backings(backings: Floats, ceramics: Floats) -> Candidates:
        return of_ceramics(ceramics, backings)

    if ceramic is None and backing is None:
        return of_ceramics(np.repeat(ceramics, len(backings)), np.tile(backings, len(ceramics)))
    if ceramic is None:
        assert backing is not None
        return of_backings(_least(requirement, backing, of_backings, ceramics), ceramics)
    if backing is None:
        return of_ceramics(_least(requirement, ceramic, of_ceramics, backings), backings)

    # Both are free: each round has back plate thicknesses closer together around the best design of the round before.
    found: list[Candidates] = []
    if isinstance(backing, Range):
        width = backing.step
    else:
        backings, width = np.linspace(backing.min, backing.max, FIRST_VALUES, retstep=True)

    def values_of(backings: Floats) -> Floats:
        [row] = backings
        designs = of_ceramics(_least(requirement, ceramic, of_ceramics, row), row)
        found.append(designs)
        violations = catalogue.violations(designs)
        if (violations > 0.0).all():
            return violations[None]  # towards the design that violates its constraints least
        return np.where(violations > 0.0, np.inf, catalogue.objective(designs))[None]

    minimise_over_backings(values_of, backings[None], backing.min, backing.max, float(width))
    return Candidates(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def _least(
    requirement: Requirement, free: Range | FreeRange, designs: Callable[[Floats, Floats], Candidates], other: Floats
) -> Floats:
    """Return the least thickness of a free layer, mm, that passes with each thickness of the other; NaN for none.

    Bisects on the outcome at the velocities required, and where a ballistic limit lies below them, on the limit.
    """

    def defeats(values: Floats, rows: Ints) -> Bools:
        return requirement.defeats(designs(values, other[rows]))

    def passes(values: Floats, rows: Ints) -> Bools:
        return Search(requirement, designs(values, other[rows])).passes(np.arange(len(rows)))

    low, high = np.full(len(other), free.min), np.full(len(other), free.max)
    least = least_values_mm(defeats, low, high)
    found = np.flatnonzero(~np.isnan(least))
    rest = found[~passes(least[found], found)]
    least[rest] = least_values_mm(lambda values, rows: passes(values, rest[rows]), least[rest], high[rest])
    return least
