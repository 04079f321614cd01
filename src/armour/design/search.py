"""Choose from a table of designs: the best or, if none is known to pass, the nearest to passing; the Pareto front."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

import numpy as np

from armour.analysis.variants import Floats, Ints
from armour.design.catalogue import COST_COLUMN, MARGIN_COLUMN, Catalogue
from armour.design.designs import FAILS, NOT_KNOWN, PASSES, Designs
from armour.evidence.caveats import is_limit_too_low

# Most designs to compare in the search for the nearest design.
MOST_COMPARED = 20_000
# Least differences that matter on a Pareto front, by criterion: kg/m², mm and, for costs, a fraction of the lowest.
RESOLUTION = {"areal_density_kg_m2": 0.01, "thickness_mm": 0.01, COST_COLUMN: 0.001}


def best_place(designs: Designs) -> tuple[int, int]:
    """Return the place of the best design of a table or, without one, of the nearest, and the verdict that it reaches.

    The verdict is PASSES or NOT_KNOWN or, of the nearest, FAILS, and the design may have a better one.  Designs whose
    model error is known come before the others.  One with a ceramic that lacks sources, or on a back plate that may be
    no metal, is never the best.
    """
    for least, unsourced in ((PASSES, False), (NOT_KNOWN, False), (NOT_KNOWN, True)):
        where = designs.offered[designs.unsourced[designs.offered] == unsourced]
        if (place := designs.first(designs.known_first(where), least)) is not None:
            return place, least
    return nearest(designs, np.arange(len(designs.values))), FAILS


def nearest(designs: Designs, where: Ints, most: int = MOST_COMPARED) -> int:
    """Return the place of the design, among those at `where`, that is nearest to passing.

    Only designs that exceed the limits on areal density, thickness and cost the least are compared, if possible those
    that keep them.  The nearest is one of which it is not known whether it passes, if there is one: the
    limit is known to be too low or, last, the back plate may be no metal.  Otherwise, its shortfall is the smallest,
    the greatest of those against the threats; ceramics that lack sources come last.  If there are more than `most`
    designs, only the thickest ceramic of each pair on each back plate is compared.
    """
    columns, unsourced, catalogue = designs.columns, designs.unsourced, designs.catalogue
    violations = catalogue.violations(columns)
    least = violations[where][unsourced[where] == unsourced[where].min()].min()
    where = where[violations[where] <= least]
    if len(where) > most:
        where = where[np.lexsort((-columns.ceramic_mm[where], columns.backing_mm[where], columns.pair[where]))]
        layers = np.column_stack([columns.pair[where], columns.backing_mm[where]])
        where = where[np.unique(layers, axis=0, return_index=True)[1]]
    is_metal = catalogue.metal[columns.pair[where]]
    slack = designs.slack_m_s(where)
    too_low = is_limit_too_low(designs.rows(where).armours.parameters).reshape(slack.shape)
    short = np.where(is_metal, -slack.min(axis=1), 0.0)
    not_known = (~is_metal | (too_low | (slack >= 0.0)).all(axis=1)) & (violations[where] <= 0.0)
    return int(where[np.lexsort((designs.values[where], short, unsourced[where], ~is_metal, ~not_known))[0]])


def undominated(costs: Floats) -> Ints:
    """Return the indices of the rows of `costs`, (n, 2) or (n, 3), that no other row dominates.

    Of equal rows, the first counts.  A row dominates another if it is at most equal to the other in every column and
    less in one.
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
    """Return a front without the rows that another one matches; the best row of each column always stays.

    `front` has indices of rows of `costs`, (n, columns), and `resolutions` is (columns,).  A row matches another if in
    no column it exceeds the other by more than the resolution of that column.
    """
    rows = np.sort(front)
    distinct_rows: list[int] = []
    for row in [*rows[costs[rows].argmin(axis=0)], *rows] if len(rows) else []:
        if not (costs[distinct_rows] <= costs[row] + resolutions).all(axis=1).any():
            distinct_rows.append(row)
    return front[np.isin(front, distinct_rows)]


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
    """Return the least difference that matters in each criterion, (criteria,), in the units of `costs`, (n, criteria).

    For the margin, it is the tolerance of ballistic limits.
    """
    resolutions = {**RESOLUTION, MARGIN_COLUMN: catalogue.scenario.ballistic_limit.tolerance_m_s}
    scales = (costs[:, i].min(initial=np.inf) if name == COST_COLUMN else 1.0 for i, name in enumerate(criteria))
    return np.array([resolutions[name] * scale for name, scale in zip(criteria, scales, strict=True)])
