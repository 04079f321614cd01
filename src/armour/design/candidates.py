"""Candidate designs: all combinations of the given thicknesses; of a free thickness, the least value that passes."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from armour.analysis.searches import Least, least_values_mm
from armour.analysis.variants import Bools, Floats, Ints, unusual
from armour.core.search import SCAN_POINTS
from armour.design.catalogue import MARGIN, CandidateDesigns, first_backings
from armour.design.search import Requirement, Search
from armour.scenario.schema import FreeRange, Range

# Largest distance of the back plate thicknesses of the last round, mm.
BACKING_TOLERANCE_MM = 1e-3
# Ratio of the distances of the back plate thicknesses of one round and the next.
CLOSER = 10
# Number of parts into which a Pareto front divides the excess margin of the thickest design.
MARGIN_PARTS = 10


def candidates_of(requirement: Requirement, criteria: Sequence[str] = (), *, refine: bool = False) -> CandidateDesigns:
    """Return the candidate designs that meet the constraints, in the order of the objective.

    With ``refine`` all ranges are free between their values.  For the criteria of a Pareto front, free thicknesses are
    refined by each of them; if one is the margin, there are also designs with more margin, up to the thickest.
    """
    catalogue = requirement.catalogue
    columns = [name for name in dict.fromkeys((catalogue.section.minimise, *criteria)) if name != MARGIN]
    pairs = range(len(catalogue.offers))
    parts = [_of_pair(requirement, pair, columns, refine=refine) for pair in pairs]
    if MARGIN in criteria:
        parts += [part for pair in pairs for part in _with_more_margin(requirement, pair, columns)]
    return catalogue.in_order(joined(parts))


def joined(parts: Sequence[CandidateDesigns]) -> CandidateDesigns:
    """Concatenate candidates."""
    return CandidateDesigns(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _with_more_margin(requirement: Requirement, pair: int, columns: Sequence[str]) -> list[CandidateDesigns]:
    """Return designs of a pair with free thicknesses: the thickest, and the thinnest for margins up to its own."""
    catalogue = requirement.catalogue
    layers = catalogue.offers[pair][:2]
    if not any(layer.free_range() for layer in layers):
        return []
    greatest = (layer.thicknesses()[-1:] if layer.free_range() else layer.thicknesses() for layer in layers)
    thickest = catalogue.combinations(pair, *greatest)
    spare = float((requirement.limits(thickest) - catalogue.required_m_s(thickest)).min(axis=1).max())
    parts = [thickest]
    for margin in np.linspace(0.0, max(spare, 0.0), MARGIN_PARTS + 1)[1:-1].tolist():
        raised = replace(requirement, catalogue=replace(catalogue, more_margin_m_s=margin), runs=0)
        parts.append(_of_pair(raised, pair, columns, refine=False, verify=False))
        requirement.runs += raised.runs
    return parts


def _of_pair(
    requirement: Requirement, pair: int, columns: Sequence[str], *, refine: bool, verify: bool = True
) -> CandidateDesigns:
    """Return the candidate designs of a pair; a free thickness is NaN if no value of it passes.

    Where both thicknesses are free, they are refined around the best by each of some columns.
    """
    catalogue, offer = requirement.catalogue, requirement.catalogue.offers[pair]
    ceramic, backing = (layer.free_range(refine=refine) for layer in (offer.ceramic, offer.backing))
    ceramics, backings = (np.array(layer.thicknesses()) for layer in (offer.ceramic, offer.backing))

    def least(layer: str, free_range: Range | FreeRange, other_mm: Floats) -> CandidateDesigns:
        """Return the designs with the least thickness of a free layer on each thickness of the other."""

        def designs(values: Floats, other_mm: Floats) -> CandidateDesigns:
            return catalogue.candidates(pair, *((values, other_mm) if layer == "ceramic" else (other_mm, values)))

        thicknesses = _least(requirement, free_range, designs, other_mm, verify=verify)
        requirement.changing[pair, layer].update(other_mm[thicknesses.changes_again].tolist())
        return designs(thicknesses.mm, other_mm)

    if ceramic is None:
        if backing is None:
            return catalogue.combinations(pair, ceramics, backings)
        return least("back plate", backing, ceramics)
    if backing is None:
        return least("ceramic", ceramic, backings)

    # Both are free: in each round, the back plate thicknesses are closer together around the best of the round before.
    rounds: list[CandidateDesigns] = []
    backings, width = first_backings(backing)

    def values_of(backings: Floats) -> Floats:
        thicknesses, place = np.unique(backings, return_inverse=True)
        designs = least("ceramic", ceramic, thicknesses)
        rounds.append(designs)
        violations = catalogue.violations(designs)
        if (violations > 0.0).all():
            values = np.tile(violations, (len(columns), 1))  # towards the design that violates its constraints least
        else:
            values = np.array([np.where(violations > 0.0, np.inf, getattr(designs, name)) for name in columns])
        return np.take_along_axis(values, place.reshape(backings.shape), axis=1)

    first = np.tile(backings, (len(columns), 1))
    minimise_over_backings(values_of, first, backing.min, backing.max, width)
    designs = joined(rounds)
    return designs.at(np.unique(designs.backing_mm, return_index=True)[1])


def _least(
    requirement: Requirement,
    free_range: Range | FreeRange,
    designs: Callable[[Floats, Floats], CandidateDesigns],
    other_mm: Floats,
    *,
    verify: bool,
) -> Least:
    """Return the least thickness of a free layer that passes with each thickness of the other.

    The search is by the outcome at the velocities required and, to verify, by the limit if one lies below them.
    """

    def stops(values: Floats, rows: Ints) -> Bools:
        return requirement.stops(designs(values, other_mm[rows]))

    def passes(values: Floats, rows: Ints) -> Bools:
        return Search(requirement, designs(values, other_mm[rows])).passes(np.arange(len(rows)))

    def scanned(values: Floats, rows: Ints) -> Bools:
        variants, *_ = requirement.catalogue.against_each(designs(values, other_mm[rows]))
        # If a probability is bounded, the thickest may lie beyond the tests while thinner ones do not.
        return unusual(variants).reshape(-1, len(requirement.catalogue.threats)).any(axis=1) | (
            np.isnan(values) & requirement.catalogue.bounded
        )

    low, high = np.full(len(other_mm), free_range.min), np.full(len(other_mm), free_range.max)
    least = least_values_mm(stops, scanned, low, high)
    if not verify:
        return least
    stopping = np.flatnonzero(~np.isnan(least.mm))
    failing = stopping[~passes(least.mm[stopping], stopping)]
    by_limit = least_values_mm(
        lambda values, rows: passes(values, failing[rows]),
        lambda values, rows: scanned(values, failing[rows]),
        *(least.mm[failing], high[failing]),
        points=SCAN_POINTS,  # each a limit, with velocities scanned densely
    )
    least.mm[failing] = by_limit.mm
    least.changes_again[failing] |= by_limit.changes_again
    return least


def minimise_over_backings(
    values_of: Callable[[Floats], Floats], first: Floats, low: float, high: float, width: float
) -> Floats:
    """Return the minimum of a function of the back plate thickness in each row, (n,); inf if it has no value.

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
