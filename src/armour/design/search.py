"""Candidate designs of a catalogue, and their Pareto front.

The candidates are all combinations of the given thicknesses; of a free thickness, only the least value that passes.
"""

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints, Thinnest, Variants, least_values_mm
from armour.core.search import SCAN_POINTS
from armour.design.catalogue import COST_COLUMN, MARGIN_COLUMN, CandidateDesigns, Catalogue, first_backings
from armour.design.designs import FAILS, PASSES, Designs, Runs, measured, verdicts_of
from armour.scenario.schema import FreeRange

# Least differences that matter on a Pareto front, by criterion: kg/m², mm and, for costs, a fraction of the lowest.
RESOLUTION = {"areal_density_kg_m2": 0.01, "thickness_mm": 0.01, COST_COLUMN: 0.001}
# Largest distance of the back plate thicknesses in the last round of a search, mm.
BACKING_TOLERANCE_MM = 1e-3
# Ratio of the distances of the back plate thicknesses of one round and the next.
CLOSER = 10
# Number of parts into which a Pareto front divides the excess margin of the thickest design.
MARGIN_PARTS = 10


@dataclass
class FreeThicknesses:
    """Search for free thicknesses in a catalogue, and what it has found."""

    catalogue: Catalogue
    runs: Runs
    least: int = PASSES  # verdict that a design must reach
    # By pair and free layer: thicknesses of the other layer, mm, with which a thicker one is perforated at a velocity
    # that a thinner one stops.
    changing: defaultdict[tuple[int, str], set[float]] = field(default_factory=lambda: defaultdict(set))


def undominated(costs: Floats) -> Ints:
    """Return the indices of the rows, of two or three columns, that no other row dominates; the first of equal rows.

    A row dominates another if it is at most equal to the other in every column and less in one.
    """
    order = np.lexsort(costs.T[::-1])
    front = []
    # Second and third column of the undominated rows so far; the second column rises, the third falls.
    seconds: list[float] = []
    thirds: list[float] = []
    for row, (_, second, *rest) in zip(order.tolist(), costs[order].tolist(), strict=True):
        third = rest[0] if rest else 0.0
        place = bisect_right(seconds, second)
        if place and thirds[place - 1] <= third:
            continue
        front.append(row)
        first, last = bisect_left(seconds, second), place
        while last < len(thirds) and thirds[last] >= third:
            last += 1
        seconds[first:last], thirds[first:last] = [second], [third]
    return np.array(front, dtype=np.int64)


def distinct(costs: Floats, front: Ints, resolutions: Floats) -> Ints:
    """Drop each row of a front that another row matches, but keep the best row of each column.

    `front` has indices of rows of `costs`.  A row matches another if in no column it exceeds the other by more than the
    resolution of that column.
    """
    rows = np.sort(front)
    distinct_rows: list[int] = []
    for row in [*rows[costs[rows].argmin(axis=0)], *rows] if len(rows) else []:
        if not (costs[distinct_rows] <= costs[row] + resolutions).all(axis=1).any():
            distinct_rows.append(row)
    return front[np.isin(front, distinct_rows)]


def candidates_of(search: FreeThicknesses, criteria: Sequence[str] = ()) -> CandidateDesigns:
    """Return the candidate designs of a catalogue.

    Free thicknesses are refined by the objective and by each of the criteria of a Pareto front.  If the margin is a
    criterion, there are also designs with greater margins.
    """
    catalogue = search.catalogue
    columns = [name for name in dict.fromkeys((catalogue.section.minimise, *criteria)) if name != MARGIN_COLUMN]
    pairs = range(len(catalogue.offers))
    parts = [_of_pair(search, pair, columns) for pair in pairs]
    if not criteria:  # a front has designs that differ by less
        parts = [_rounded_up(search, pair, part) for pair, part in enumerate(parts)]
    if MARGIN_COLUMN in criteria:
        parts += [part for pair in pairs for part in _with_more_margin(search, pair, columns)]
    return CandidateDesigns.joined(parts)


def _with_more_margin(search: FreeThicknesses, pair: int, columns: Sequence[str]) -> list[CandidateDesigns]:
    """Return designs with free thicknesses of a pair: the thickest, and the thinnest for some margins up to its margin.

    A pair without a free thickness has none.
    """
    catalogue = search.catalogue
    layers = catalogue.offers[pair][:2]
    if not any(layer.free_range() for layer in layers):
        return []
    greatest = (layer.thicknesses()[-1:] if layer.free_range() else layer.thicknesses() for layer in layers)
    thickest = catalogue.combinations(pair, *greatest)
    rows = catalogue.against_each(thickest)
    shown = measured(catalogue, rows, search.runs)[1]
    spare = float((shown - catalogue.velocities_m_s - catalogue.margins_m_s).min(axis=1).max())
    parts = [thickest]
    for margin in np.linspace(0.0, max(spare, 0.0), MARGIN_PARTS + 1)[1:-1].tolist():
        raised = replace(catalogue, margins_m_s=catalogue.margins_m_s + margin)
        parts.append(_of_pair(replace(search, catalogue=raised), pair, columns, verify=False))
    return parts


def _rounded_up(search: FreeThicknesses, pair: int, designs: CandidateDesigns) -> CandidateDesigns:
    """Round the free thicknesses of designs of a pair up to 0.01 mm where the design still passes."""
    catalogue, layers = search.catalogue, search.catalogue.offers[pair][:2]
    where = np.flatnonzero(~np.isnan(designs.thickness_mm))
    if not len(where) or not any(layer.free_range() for layer in layers):
        return designs
    raised = [
        np.minimum(np.ceil(mm[where] * 100.0 - 1e-6) / 100.0, layer.thicknesses()[-1])
        if layer.free_range()
        else mm[where]
        for mm, layer in zip((designs.ceramic_mm, designs.backing_mm), layers, strict=True)
    ]
    rounded = catalogue.candidates(pair, *raised)
    rows = catalogue.against_each(rounded)
    passes = verdicts_of(catalogue, rows, search.runs) >= search.least
    passes &= (measured(catalogue, rows, search.runs)[-1] >= 0.0).all(axis=1)
    columns = [column.copy() for column in designs]
    for column, values in zip(columns, rounded, strict=True):
        column[where[passes]] = values[passes]
    return CandidateDesigns._make(columns)


def _of_pair(search: FreeThicknesses, pair: int, columns: Sequence[str], *, verify: bool = True) -> CandidateDesigns:
    """Return the candidate designs of a pair; a free thickness is NaN if no value of it passes.

    If both thicknesses are free, they are refined around the best design by each of the named columns.  `verify` is
    explained at `_least`.
    """
    catalogue, offer = search.catalogue, search.catalogue.offers[pair]
    ceramic, backing = (layer.free_range() for layer in (offer.ceramic, offer.backing))
    ceramics, backings = (np.array(layer.thicknesses()) for layer in (offer.ceramic, offer.backing))

    def least(layer: str, free_range: FreeRange, other_mm: Floats) -> CandidateDesigns:
        """Return the designs with the least thickness of a free layer for each thickness of the other layer, mm."""

        def designs(values: Floats, other_mm: Floats) -> CandidateDesigns:
            return catalogue.candidates(pair, *((values, other_mm) if layer == "ceramic" else (other_mm, values)))

        thicknesses = _least(search, free_range, designs, other_mm, verify=verify)
        search.changing[pair, layer].update(other_mm[thicknesses.changes_again].tolist())
        return designs(thicknesses.mm, other_mm)

    if ceramic is None:
        if backing is None:
            return catalogue.combinations(pair, ceramics, backings)
        return least("back plate", backing, ceramics)
    if backing is None:
        return least("ceramic", ceramic, backings)

    # Both are free.  Each round has back plate thicknesses around the best of the round before, closer together.
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

    minimise_over_backings(values_of, np.tile(backings, (len(columns), 1)), backing.min, backing.max, width)
    designs = CandidateDesigns.joined(rounds)
    return designs.at(np.unique(designs.backing_mm, return_index=True)[1])


def _least(
    search: FreeThicknesses,
    free_range: FreeRange,
    designs: Callable[[Floats, Floats], CandidateDesigns],
    other_mm: Floats,
    *,
    verify: bool,
) -> Thinnest:
    """Return the least thickness of a free layer that passes with each thickness of the other layer, mm.

    `designs` returns the designs for thicknesses of the free and of the other layer, mm.  The search computes outcomes
    at the required velocities.  If `verify`, thicknesses that fail by their lowest ballistic limit are searched again.
    """
    catalogue = search.catalogue

    def against(values: Floats, rows: Ints) -> Variants:
        return catalogue.against_each(designs(values, other_mm[rows]))

    def stops(values: Floats, rows: Ints) -> Bools:
        return verdicts_of(catalogue, against(values, rows), search.runs) >= search.least

    def fails(values: Floats, rows: Ints) -> Bools:
        return verdicts_of(catalogue, against(values, rows), search.runs) == FAILS

    def passes(values: Floats, rows: Ints) -> Bools:
        slack_m_s = measured(catalogue, against(values, rows), search.runs)[-1]
        return stops(values, rows) & (slack_m_s >= 0.0).all(axis=1)

    def scanned(values: Floats, rows: Ints) -> Bools:
        variants = against(values, rows)
        # The thickest layer may lie beyond the tests while thinner ones do not.
        beyond = np.isnan(values) & (search.least == PASSES)
        return variants.is_unusual().reshape(-1, len(catalogue.threats)).any(axis=1) | beyond

    low, high = np.full(len(other_mm), free_range.min), np.full(len(other_mm), free_range.max)
    least = least_values_mm(stops, scanned, low, high, fails=fails)
    if not verify:
        return least
    stopping = np.flatnonzero(~np.isnan(least.mm))
    failing = stopping[~passes(least.mm[stopping], stopping)]
    by_limit = least_values_mm(
        lambda values, rows: passes(values, failing[rows]),
        lambda values, rows: scanned(values, failing[rows]),
        *(least.mm[failing], high[failing]),
        points=SCAN_POINTS,  # each a limit, with velocities scanned densely
        fails=lambda values, rows: fails(values, failing[rows]),
    )
    least.mm[failing] = by_limit.mm
    least.changes_again[failing] |= by_limit.changes_again
    return least


def pareto(designs: Designs, criteria: Sequence[str], least: int) -> Ints:
    """Return the places of the designs on the Pareto front of those with at least the verdict `least`.

    Designs that another one matches within the resolutions of the criteria are left out.  Only the lowest limits of the
    designs on the front are computed; the margins of the others come from the usual scan.
    """
    remaining = designs.offered[designs.verdicts(designs.offered) >= least]
    columns = designs.columns._asdict()
    margins = np.zeros(len(designs.values))
    if MARGIN_COLUMN in criteria:
        margins[remaining] = designs.quick_margins_m_s(remaining).min(axis=1)
    while True:
        columns[MARGIN_COLUMN] = -margins
        costs = np.column_stack([columns[name][remaining] for name in criteria])
        front = remaining[distinct(costs, undominated(costs), _resolutions(designs.catalogue, costs, criteria))]
        passing = [place for place in front[designs.passes(front, least)] if designs.sampled(place) >= least]
        verified = designs.margins_m_s(front).min(axis=1)
        if len(passing) == len(front) and (MARGIN_COLUMN not in criteria or np.array_equal(margins[front], verified)):
            return front
        margins[front] = verified
        remaining = np.setdiff1d(remaining, np.setdiff1d(front, passing))


def _resolutions(catalogue: Catalogue, costs: Floats, criteria: Sequence[str]) -> Floats:
    """Return the least difference of each criterion that matters; for the margin, the tolerance of ballistic limits."""
    resolutions = {**RESOLUTION, MARGIN_COLUMN: catalogue.scenario.ballistic_limit.tolerance_m_s}
    scales = (costs[:, i].min(initial=np.inf) if name == COST_COLUMN else 1.0 for i, name in enumerate(criteria))
    return np.array([resolutions[name] * scale for name, scale in zip(criteria, scales, strict=True)])


def minimise_over_backings(
    values_of: Callable[[Floats], Floats], first: Floats, low: float, high: float, width: float
) -> Floats:
    """Return the minimum of each of n functions of the back plate thickness, (n,); inf if it has no value.

    ``values_of`` returns values, (n, k), at thicknesses, (n, k), mm.  The first round has the thicknesses ``first``, at
    a distance of ``width``, mm.  Each further round has closer thicknesses around the best of the round before, between
    ``low`` and ``high``, mm.
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
