"""Search for the designs of a catalogue that pass: the requirement, and the designs in the order of the objective.

The candidates are all combinations of the given thicknesses and, of a free thickness, the least value that passes.
"""

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from armour.analysis.estimates import Estimate
from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.variants import (
    Bools,
    Floats,
    Ints,
    Least,
    Variants,
    ballistic_limits,
    least_values_mm,
    limits_anywhere,
    perforated,
    unusual,
)
from armour.core.search import DENSE_SCAN_POINTS, SCAN_POINTS
from armour.design.catalogue import COST, MARGIN, CandidateDesigns, Catalogue, first_backings
from armour.design.reliability import Reliability
from armour.scenario.schema import FASTEST_M_S, SLOWEST_M_S, FreeRange, Range

# Numbers of designs and of limits to compute at a time, in a few tenths of a second.
IMPACTS_AT_A_TIME = 10_000
LIMITS_AT_A_TIME = 2_000
# Number of designs up to which all threats are computed together.  If there are more, those that one threat perforates
# are not tried against the next, which saves more than the additional calls of the engine cost.
FEW_DESIGNS = 100
# Most designs to try at a time until one passes; those after it are tried in vain.
FIRST_AT_A_TIME = 500
# Most back plates of a frontier, besides the best: a square grid of the most designs has as many.
MOST_BACKINGS = 1000
# Differences of criteria that matter on a Pareto front: kg/m², mm and, for costs, as a fraction of the lowest.
RESOLUTION = {"areal_density_kg_m2": 0.01, "thickness_mm": 0.01, COST: 0.001}
# Largest distance of the back plate thicknesses of the last round, mm.
BACKING_TOLERANCE_MM = 1e-3
# Ratio of the distances of the back plate thicknesses of one round and the next.
CLOSER = 10
# Number of parts into which a Pareto front divides the excess margin of the thickest design.
MARGIN_PARTS = 10


@dataclass
class Requirement:
    """The threats of a catalogue as a condition on designs; counts the impacts that it computes."""

    catalogue: Catalogue
    on_progress: OnProgress = ignore_progress  # called with impacts
    runs: int = 0
    # By pair and free layer: thicknesses of the other layer, mm, with which a thicker one is perforated at a velocity
    # that a thinner one stops.
    changing: defaultdict[tuple[int, str], set[float]] = field(default_factory=lambda: defaultdict(set))

    def stops(self, candidates: CandidateDesigns) -> Bools:
        """Return whether designs stop all threats at the velocities required."""
        stops_threats = np.ones(len(candidates.pair), dtype=bool)
        threats = range(len(self.catalogue.threats))
        groups = [threats] if len(stops_threats) <= FEW_DESIGNS else [threats[i : i + 1] for i in threats]
        for part in portions(len(stops_threats), IMPACTS_AT_A_TIME):
            remaining = np.arange(part.start, part.stop)
            for group in groups:
                rows, required, bounds = self.catalogue.against_each(candidates.at(remaining), group)
                stopped = self._stopped(rows._replace(velocities=required))
                bounded = np.flatnonzero(stopped & (bounds < 1.0))
                if len(bounded):
                    stopped[bounded] = self.within_bounds(rows.at(bounded), bounds[bounded])
                stops_threats[remaining] = stopped.reshape(-1, len(group)).all(axis=1)
                remaining = remaining[stops_threats[remaining]]
        return stops_threats

    def tested(self, candidates: CandidateDesigns) -> Bools:
        """Return whether the model error is known, or left out, for designs against every threat, (designs,)."""
        tested = np.ones(len(candidates.pair), dtype=bool)
        if not self.catalogue.scenario.excludes_error():
            for part in portions(len(tested), IMPACTS_AT_A_TIME):
                rows, *_ = self.catalogue.against_each(candidates.at(part))
                tested[part] = rows.errors.known.reshape(-1, len(self.catalogue.threats)).all(axis=1)
        return tested

    def _stopped(self, rows: Variants) -> Bools:
        """Return whether rows stop the projectile at their velocities; not if these are too high to compute."""
        stopped = rows.velocities <= FASTEST_M_S
        possible = np.flatnonzero(stopped & (rows.velocities > 0.0))
        stopped[possible] = ~perforated(rows.at(possible))
        self._count(len(possible))
        return stopped

    def within_bounds(self, rows: Variants, bounds: Floats) -> Bools:
        """Return whether rows keep to bounds on the probability of perforation at their velocities.

        Most rows do so by every law of the flow stress or by none, as one impact by each law shows.  The others do if
        they stop the projectile at the least ballistic limit that keeps to the bound.
        """
        errors = rows.errors
        by_any, by_all = np.zeros(len(bounds), dtype=bool), np.ones(len(bounds), dtype=bool)
        for law, weights in enumerate(errors.ratio.weights):
            with np.errstate(divide="ignore"):
                required = rows.velocities / errors.of_law(law).quantile(bounds).clip(min=0.0)
            by_law = rows.by_law(law, errors) if law else rows
            used = np.flatnonzero(weights > 0.0)
            required += self.catalogue.more_margin_m_s
            stopped = self._stopped(by_law._replace(velocities=required).at(used))
            by_any[used] |= stopped
            by_all[used] &= stopped
        within, undecided = by_any & by_all, np.flatnonzero(by_any & ~by_all)
        required = self.catalogue.bounded_m_s(rows.at(undecided), bounds[undecided])
        within[undecided] = self._stopped(rows.at(undecided)._replace(velocities=required))
        return within

    def _count(self, runs: int, _total: int | None = None) -> None:
        self.runs += runs
        self.on_progress(runs, None)

    def limits(self, candidates: CandidateDesigns, *, lowest: bool = True) -> Floats:
        """Return the ballistic limits of designs against each threat, m/s, (designs, threats).

        The search extends beyond the range of the section ``ballistic_limit``, see `limits_anywhere`.  With ``lowest``,
        velocities are scanned more densely where the limit is at least the velocity required.
        """
        limits = np.empty((len(candidates.pair), len(self.catalogue.threats)))
        for part in portions(len(limits), max(LIMITS_AT_A_TIME // limits.shape[1], 1)):
            rows, required, _ = self.catalogue.against_each(candidates.at(part))
            row_limits = limits_anywhere(rows, self._count)
            if lowest:
                reaching = np.flatnonzero(row_limits >= required)
                row_limits[reaching] = self._lowest(rows.at(reaching), row_limits[reaching])
            limits[part] = row_limits.reshape(-1, limits.shape[1])
        return limits

    def _lowest(self, variants: Variants, limits: Floats) -> Floats:
        """Return the ballistic limits of rows, m/s, or lower ones that a denser scan finds."""
        section = variants.scenario.ballistic_limit
        slowest = min(section.velocity_min_m_s, SLOWEST_M_S)
        range_m_s = slowest, FASTEST_M_S
        dense = ballistic_limits(variants, range_m_s, points=DENSE_SCAN_POINTS, on_progress=self._count).clip(slowest)
        # Two limits of one change are within the tolerance of each other.
        return np.where(dense < limits - section.tolerance_m_s, dense, limits)


class Search:
    """Search among candidate designs; each limit and probability is computed once, when it is first needed.

    Designs are given by their indices among the candidates, which are in the order of the objective.
    """

    def __init__(
        self, requirement: Requirement, candidates: CandidateDesigns, reliability: Reliability | None = None
    ) -> None:
        self.requirement, self.candidates, self.reliability = requirement, candidates, reliability
        self.catalogue = requirement.catalogue
        self.values = self.catalogue.objective(candidates)
        self.stopping = requirement.stops(candidates)
        self._limits = np.full((len(self.values), len(self.catalogue.threats)), np.nan)
        self._probabilities: dict[int, dict[str, Estimate] | None] = {}

    def of_pairs(self, pairs: int | Sequence[int]) -> Ints:
        """Return the designs of one or several pairs, in the order of the objective."""
        return np.flatnonzero(np.isin(self.candidates.pair, pairs))

    def limits(self, where: Ints) -> Floats:
        """Return the lowest ballistic limits of designs against each threat, m/s, (designs, threats)."""
        missing = where[np.isnan(self._limits[where, 0])]
        self._limits[missing] = self.requirement.limits(self.candidates.at(missing))
        return self._limits[where]

    def passes(self, where: Ints) -> Bools:
        """Return whether designs stop every threat at the velocity required and have no ballistic limit below it."""
        passed = self.stopping[where]
        passed[passed] = (self.excess_m_s(where[passed]) >= 0.0).all(axis=1)
        return passed

    def excess_m_s(self, where: Ints) -> Floats:
        """Return by how much lowest ballistic limits exceed the velocities required, m/s, (designs, threats)."""
        return self.limits(where) - self.catalogue.required_m_s(self.candidates.at(where))

    def probabilities(self, place: int) -> dict[str, Estimate] | None:
        """Return the probabilities of perforation of a design, by threat that bounds it; None if one is too high."""
        if self.reliability is None:
            return {}
        if place not in self._probabilities:
            self._probabilities[place] = self.reliability.probabilities(self.candidates, place)
        return self._probabilities[place]

    def first(self, where: Ints) -> int | None:
        """Return the first of some designs that passes, bounds on probabilities included."""
        remaining = where[self.stopping[where]]
        size = 1
        while len(remaining):
            batch, remaining, size = remaining[:size], remaining[size:], min(2 * size, FIRST_AT_A_TIME)
            for place in batch[self.passes(batch)].tolist():
                if self.probabilities(place) is not None:
                    return place
        return None

    def frontier_backings(self, best: int) -> Floats:
        """Return the thicknesses of the back plates of the frontier of the best design's pair, mm.

        They are those tried first if both layers are free, otherwise all; of very many, every second, third, and so on.
        That of the best design is always among them.
        """
        pair = int(self.candidates.pair[best])
        ceramic, backing = (layer.free_range() for layer in self.catalogue.offers[pair][:2])
        backings = np.unique(self.candidates.backing_mm[self.of_pairs(pair)])
        if ceramic is not None and backing is not None:
            backings = first_backings(backing)[0]
        return np.append(backings[:: -(-len(backings) // MOST_BACKINGS)], self.candidates.backing_mm[best])

    def frontier(self, best: int) -> Ints:
        """Return for each back plate of `frontier_backings` the thinnest ceramic that passes.

        Bounds on the probability hold too: beyond the thinnest ceramic that passes, bisection finds the least that
        keeps to them, assuming that every thicker one does.
        """
        ceramics, backings = self.candidates.ceramic_mm, self.candidates.backing_mm
        stopping = self.of_pairs(int(self.candidates.pair[best]))
        stopping = stopping[self.stopping[stopping] & np.isin(backings[stopping], self.frontier_backings(best))]
        stopping = stopping[np.lexsort((ceramics[stopping], backings[stopping]))]
        remaining, frontier = stopping, stopping[:0]
        while len(remaining):
            _, first = np.unique(backings[remaining], return_index=True)
            thinnest = remaining[first]
            frontier = np.concatenate([frontier, thinnest[self.passes(thinnest)]])
            remaining = np.delete(remaining, first)
            remaining = remaining[~np.isin(backings[remaining], backings[frontier])]
        frontier = frontier[np.argsort(backings[frontier])]
        if self.reliability is None:
            return frontier

        def passes(place: int) -> bool:
            return self.first(np.array([place])) is not None

        within_bounds = []
        for place in frontier.tolist():
            thicker = (backings[stopping] == backings[place]) & (ceramics[stopping] >= ceramics[place])
            column = stopping[thicker].tolist()
            index = column.index(best) if best in column else bisect_left(column, True, key=passes)
            within_bounds += column[index : index + 1]
        return np.array(within_bounds, dtype=np.int64)

    def changing(self) -> Iterator[tuple[int, str, float]]:
        """Yield each pair and layer of which a thicker one is perforated at a velocity that a thinner one stops.

        The third value is the thickness of the other layer, mm.
        """
        pairs, ceramics, backings = self.candidates[:3]
        for name, layer, other_layer in (("ceramic", ceramics, backings), ("back plate", backings, ceramics)):
            order = np.lexsort((layer, other_layer, pairs))
            thin, thick = order[:-1], order[1:]
            changes = (pairs[thin] == pairs[thick]) & (other_layer[thin] == other_layer[thick])
            changes &= self.stopping[thin] & ~self.stopping[thick]
            thin, thick = thin[changes], thick[changes]
            required = (self.catalogue.required_m_s(self.candidates.at(places)) for places in (thin, thick))
            for place in thin[np.greater_equal(*required).all(axis=1)]:
                yield int(pairs[place]), name, float(other_layer[place])

    def not_monotonic_mm(self, frontier: Ints) -> tuple[float, ...]:
        """Return the back plate thicknesses of a frontier at which a thicker ceramic is known not to pass, mm."""
        ceramics, backings = self.candidates.ceramic_mm, self.candidates.backing_mm
        designs = self.of_pairs(int(self.candidates.pair[frontier[0]]))
        with_limits = designs[self.stopping[designs] & ~np.isnan(self._limits[designs]).any(axis=1)]
        required = self.catalogue.required_m_s(self.candidates.at(with_limits))
        failing = designs[~self.stopping[designs]]
        if self.catalogue.bounded:
            failing = failing[self.requirement.tested(self.candidates.at(failing))]
        failing = np.union1d(failing, with_limits[(self._limits[with_limits] < required).any(axis=1)])
        failing = failing[np.isin(backings[failing], backings[frontier])]
        # The frontier is in the order of its back plates.
        thickest = np.zeros(len(frontier))
        np.maximum.at(thickest, np.searchsorted(backings[frontier], backings[failing]), ceramics[failing])
        return tuple(backings[frontier][thickest > ceramics[frontier]].tolist())

    def pareto(self, criteria: Sequence[str]) -> Ints:
        """Return the Pareto front of the designs that pass, bounds on probabilities included.

        One design stands for all that do not differ from it by the resolution of a criterion.  Only the members of the
        front are verified, by a scan; the margins of the others come from the quick search.
        """
        remaining = np.flatnonzero(self.stopping)
        limits = self._limits.copy()
        if MARGIN in criteria:
            limits[remaining] = self.requirement.limits(self.candidates.at(remaining), lowest=False)
        while True:
            columns = {**self.candidates._asdict(), MARGIN: -self.margins(limits).min(axis=1)}
            costs = np.column_stack([columns[name][remaining] for name in criteria])
            front = remaining[distinct(costs, undominated(costs), self._resolutions(costs, criteria))]
            passing = [place for place in front[self.passes(front)].tolist() if self.probabilities(place) is not None]
            verified = MARGIN not in criteria or np.array_equal(limits[front], self.limits(front))
            if verified and len(passing) == len(front):
                return front
            limits[front] = self.limits(front)
            remaining = np.setdiff1d(remaining, np.setdiff1d(front, passing))

    def margins(self, limits: Floats) -> Floats:
        """Return ballistic limits, (designs, threats), less the velocities of the threats, m/s."""
        return limits - self.catalogue.velocities_m_s

    def _resolutions(self, costs: Floats, criteria: Sequence[str]) -> Floats:
        """Return the least difference of each criterion that matters; that of limits is their tolerance."""
        resolutions = {**RESOLUTION, MARGIN: self.catalogue.scenario.ballistic_limit.tolerance_m_s}
        scales = (costs[:, i].min(initial=np.inf) if name == COST else 1.0 for i, name in enumerate(criteria))
        return np.array([resolutions[name] * scale for name, scale in zip(criteria, scales, strict=True)])


def undominated(costs: Floats) -> Ints:
    """Return the rows, of two or three columns, that no other row dominates; the first of equal rows.

    A row dominates another if it is at most equal to it in every column and less in one.
    """
    order = np.lexsort(costs.T[::-1])
    front = []
    # Second and third columns of the rows so far that none of the others dominates; the second rises, the third falls.
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
    """Return the rows of a front without those that another matches in every column; keep the best of each column.

    A row matches another if no column exceeds the other's by more than its resolution.
    """
    rows = np.sort(front)
    distinct_rows: list[int] = []
    for row in [*rows[costs[rows].argmin(axis=0)], *rows] if len(rows) else []:
        if not (costs[distinct_rows] <= costs[row] + resolutions).all(axis=1).any():
            distinct_rows.append(row)
    return front[np.isin(front, distinct_rows)]


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

    minimise_over_backings(values_of, np.tile(backings, (len(columns), 1)), backing.min, backing.max, width)
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
