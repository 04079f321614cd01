"""Table of the designs of a catalogue, with queries such as the first design that passes.

Verdicts, ballistic limits and sampled probabilities are computed only for the designs that a query needs.
"""

from bisect import bisect_left
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from armour.analysis.estimates import Estimate
from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.samples import is_sampled, points_of, probability_of_perforation, section_of
from armour.analysis.variants import Bools, Floats, Ints, Variants
from armour.design.catalogue import CandidateDesigns, Catalogue, first_backings
from armour.design.requirements import EVEN, verdict_of, verdict_of_samples
from armour.errors import Problem, refuse
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.schema import FASTEST_M_S, Uncertainty

# What impacts tell of designs, from the worst; UNJUDGED is nothing yet.  A design of NOT_KNOWN is stopped by the model,
# but no probability is known or stated; one of PASSES has the required probability or, where none is required, 0.5.
UNJUDGED, FAILS, NOT_KNOWN, PASSES = range(-1, 3)
# Numbers of impacts and of limits to compute at a time, in a few tenths of a second.
IMPACTS_AT_A_TIME = 10_000
LIMITS_AT_A_TIME = 2_000
# Most designs to try at a time until one passes; all designs tried after that one are in vain.
FIRST_AT_A_TIME = 500
# Most back plate thicknesses of a frontier, besides that of the best design.  A square grid with the greatest number of
# designs has as many.
MOST_BACKINGS = 1000
# Most scenarios, each of a pair of materials against a threat, to keep in memory.
MOST_SCENARIOS = 1000


class Runs:
    """Counter of the impacts computed, which also reports them."""

    def __init__(self, on_progress: OnProgress = ignore_progress) -> None:
        self.count, self.on_progress = 0, on_progress

    def __call__(self, runs: int, _total: int | None = None) -> None:
        """Count impacts."""
        self.count += runs
        self.on_progress(runs, None)


class Required(NamedTuple):
    """What is required of n rows, each a design against a threat."""

    limits_m_s: Floats  # least limits by the model; 0 where the model error is known
    expected_m_s: Floats  # least expected limits; 0 where the model error is not known, or no margin is required
    bounds: Floats  # greatest probabilities of perforation; 1 where the model error is not known
    unknown: Bools  # whether the probability is not known or not stated, or a layer is between tile and plate


def required_of(catalogue: Catalogue, rows: Variants) -> Required:
    """Return what is required of rows, each a design against a threat, (designs * threats,).

    Where the model error is known, this is a probability, and an expected limit if there is a margin; elsewhere, it is
    a limit by the model of at least the velocity plus the margin.
    """
    count, errors = len(rows.velocities) // len(catalogue.threats), rows.errors
    bounds, stated, margins = (
        np.tile(values, count) for values in (catalogue.exact_bounds, catalogue.bounds, catalogue.margins_m_s)
    )
    known, needed = errors.known, rows.velocities + margins
    return Required(
        np.where(known, 0.0, needed),
        np.where(known & (margins > 0.0), needed, 0.0),
        np.where(known, bounds, 1.0),
        ~known | (1.0 - stated > errors.greatest) | (catalogue.scenario.interlayers > 0),
    )


def verdicts_of(catalogue: Catalogue, rows: Variants, runs: Runs) -> Ints:
    """Return the verdicts on n designs, (n,), from impacts at the required velocities.

    `rows` has each design against each threat, (n * threats,).
    """
    required, threats = required_of(catalogue, rows), len(catalogue.threats)
    remaining = np.arange(len(rows.velocities) // threats)
    # Designs that one threat perforates are not tried against the next.
    for threat in range(threats):
        places = remaining * threats + threat
        stops = stopped(rows.at(places)._replace(velocities=required.limits_m_s[places]), runs)
        for bounds, velocities in (
            (required.bounds, rows.velocities),
            (np.where(required.expected_m_s > 0.0, EVEN, 1.0), required.expected_m_s),
        ):
            bounded = places[stops & (bounds[places] < 1.0)]
            if len(bounded):
                at_velocity = rows.at(bounded)._replace(velocities=velocities[bounded])
                stops[np.isin(places, bounded)] = within_bounds(at_velocity, bounds[bounded], runs)
        remaining = remaining[stops]
    verdicts = np.full(len(required.unknown) // threats, FAILS)
    is_unknown: Bools = required.unknown.reshape(-1, threats).max(axis=1)
    verdicts[remaining] = np.where(is_unknown[remaining], NOT_KNOWN, PASSES)
    return verdicts


def stopped(rows: Variants, runs: Runs) -> Bools:
    """Return whether rows stop the projectile at their velocities; False above the greatest velocity allowed."""
    is_stopped = rows.velocities <= FASTEST_M_S
    possible = np.flatnonzero(is_stopped & (rows.velocities > 0.0))
    is_stopped[possible] = ~rows.at(possible).perforated()
    runs(len(possible))
    return is_stopped


def within_bounds(rows: Variants, bounds: Floats, runs: Runs) -> Bools:
    """Return whether the probability of perforation of each row, which must be known, is at most its bound.

    One impact by each law of the flow stress decides if the laws agree, which is usual.  For the other rows, the
    probability is computed from the ballistic limits by the laws.
    """
    errors = rows.errors
    by_any, by_all = np.zeros(len(bounds), dtype=bool), np.ones(len(bounds), dtype=bool)
    for law, weights in enumerate(errors.ratio.weights):
        used = np.flatnonzero(weights > 0.0)
        with np.errstate(divide="ignore"):
            velocities = rows.velocities / errors.of_shots.of_law(law).quantile(bounds).clip(min=0.0)
        by_law = rows.by_law(law, errors) if law else rows
        is_stopped = stopped(by_law._replace(velocities=velocities).at(used), runs)
        by_any[used] |= is_stopped
        by_all[used] &= is_stopped
    within, undecided = by_any & by_all, np.flatnonzero(by_any & ~by_all)
    rows = rows.at(undecided)
    distributions = rows.shot_distributions(rows.limits_anywhere(runs))
    within[undecided] = distributions.probability_above(rows.velocities) >= 1.0 - bounds[undecided]
    return within


def slack_m_s(catalogue: Catalogue, rows: Variants, limits: Floats) -> tuple[Floats, Floats]:
    """Return the slack of rows, m/s, given their limits by the model, and their expected limits, m/s, NaN for none.

    The slack is negative if the rows do not meet what is required.  It is the difference of limit by the model and the
    one required or, where the model error is known, the smaller of two: velocity stopped with the required probability
    minus velocity of the threat, and expected limit minus the one required.
    """
    required, expected = required_of(catalogue, rows), rows.expected_limits(limits)
    slack = np.where(required.limits_m_s > 0.0, limits - required.limits_m_s, np.inf)
    slack = np.where(required.expected_m_s > 0.0, expected - required.expected_m_s, slack)
    bounded = np.flatnonzero(required.bounds < 1.0)
    if len(bounded):
        distributions = rows.at(bounded).shot_distributions(limits[bounded])
        slack_by_error = distributions.quantile(required.bounds[bounded]) - rows.velocities[bounded]
        slack[bounded] = np.minimum(slack[bounded], slack_by_error)
    return slack, expected


def measured(catalogue: Catalogue, rows: Variants, runs: Runs) -> tuple[Floats, Floats, Floats]:
    """Return the lowest limits by the model of designs against each threat, those shown, and the slack, m/s.

    Each is (designs, threats).  The limits shown are the expected ones or, where the model error is not known, those by
    the model.

    The search extends beyond the range of the section ``ballistic_limit``.  If a limit is high enough, a denser scan
    looks for a lower one.
    """
    shape = -1, len(catalogue.threats)
    limits = rows.limits_anywhere(runs)
    slack, expected = slack_m_s(catalogue, rows, limits)
    high = np.flatnonzero(slack >= 0.0)
    lowest = rows.at(high).lowest_limits(limits[high], runs)
    if (lowest < limits[high]).any():
        limits[high] = lowest
        slack, expected = slack_m_s(catalogue, rows, limits)
    shown = np.where(np.isnan(expected), limits, expected)
    return limits.reshape(shape), shown.reshape(shape), slack.reshape(shape)


class Reliability:
    """Estimates the probabilities of perforation of designs of a catalogue, all at the same samples of the inputs."""

    def __init__(self, catalogue: Catalogue, on_progress: OnProgress = ignore_progress) -> None:
        self.catalogue, self.on_progress = catalogue, on_progress
        # Many designs have the same materials, and making a scenario is slow.
        self.against = lru_cache(MOST_SCENARIOS)(catalogue.against)
        _check(catalogue, section_of(self.against(0, 0)))
        self.points = points_of(catalogue.scenario.uncertainty or Uncertainty())

    def probabilities(self, candidates: CandidateDesigns, place: int, *, quick: bool) -> dict[str, Estimate]:
        """Estimate the probability of perforation of a design, by title of each threat that sets a bound on it.

        Threats for which the probability is not known are left out; `quick` as in `probability_of_perforation`.
        """
        thicknesses = {CERAMIC: float(candidates.ceramic_mm[place]), BACKING: float(candidates.backing_mm[place])}
        estimates = {}
        for threat in np.flatnonzero(self.catalogue.required).tolist():
            scenario = self.against(int(candidates.pair[place]), threat)
            layers = {key: thicknesses[key] for key in thicknesses if key in scenario.inputs()}
            if is_sampled(scenario, layers):
                estimates[self.catalogue.titles[threat]] = probability_of_perforation(
                    scenario, float(self.catalogue.bounds[threat]), layers, self.points, self.on_progress, quick=quick
                )
        return estimates


def _check(catalogue: Catalogue, section: Uncertainty) -> None:
    """Check that the distributions apply to every design, material and threat."""
    file = catalogue.scenario.file
    problems = []
    for name, distribution in section.inputs().items():
        if distribution.placed and name in catalogue.varying:
            message = (
                "must be centred on the value of each design or threat: normal or lognormal, without mean, min and "
                'max, such as { distribution = "normal", standard_deviation_percent = 1.0 }'
            )
            problems.append(Problem(file, f"uncertainty.{name}", message))
    refuse(problems)


class Designs:
    """Table of the designs on offer, the best by the objective first; a place is the index of a design in it.

    Attributes
    ----------
    columns : CandidateDesigns
    within, offered : array of int
        Places of the designs within the limits of the section ``design``, and of those of them on back plates that may
        be a metal.
    unsourced : array of bool
        Whether the ceramic of each design has neither tests nor two sources of its flow stress; such a design is never
        the best.
    """

    def __init__(
        self, catalogue: Catalogue, columns: CandidateDesigns, runs: Runs, reliability: Reliability | None = None
    ) -> None:
        columns = columns.at(~np.isnan(columns.thickness_mm))  # a free thickness is NaN if no value passes
        self.columns = columns.at(catalogue.objective(columns).argsort(kind="stable"))
        self.catalogue, self.runs, self.reliability = catalogue, runs, reliability
        self.values = catalogue.objective(self.columns)
        self.within = np.flatnonzero(catalogue.violations(self.columns) <= 0.0)
        self.offered = self.within[catalogue.metal[self.columns.pair[self.within]]]
        self.unsourced = catalogue.lacks_sources[self.columns.pair] & (self.columns.ceramic_mm > 0.0)
        count = len(self.values)
        self._verdicts, self._known = np.full(count, UNJUDGED), np.zeros(count, dtype=bool)
        self._limits, self._shown_limits, self._slack = np.full((3, count, len(catalogue.threats)), np.nan)
        self._sampled: dict[int, int] = {}
        self._shown: dict[int, Variants] = {}

    def rows(self, where: Ints) -> Variants:
        """Return the rows of designs against each threat, (designs * threats,)."""
        return self.catalogue.against_each(self.columns.at(where))

    def rows_of(self, place: int) -> Variants:
        """Return the rows of a single design against each threat, (threats,), and keep them."""
        if place not in self._shown:
            self._shown[place] = self.rows(np.array([place]))
        return self._shown[place]

    def verdicts(self, where: Ints) -> Ints:
        """Return the verdicts on designs by impacts alone; the lowest limits, and samples, may give worse ones."""
        missing, threats = where[self._verdicts[where] == UNJUDGED], len(self.catalogue.threats)
        for part in portions(len(missing), max(IMPACTS_AT_A_TIME // threats, 1)):
            rows = self.rows(missing[part])
            self._verdicts[missing[part]] = verdicts_of(self.catalogue, rows, self.runs)
            self._known[missing[part]] = rows.errors.known.reshape(-1, threats).all(axis=1)
        return self._verdicts[where]

    def known(self, where: Ints) -> Bools:
        """Return whether the model error of each design is known against every threat."""
        self.verdicts(where)
        return self._known[where]

    def measure(self, where: Ints) -> None:
        """Compute and keep the ballistic limits and slack of those designs for which they are not known yet."""
        missing = where[np.isnan(self._limits[where, 0])]
        for part in portions(len(missing), max(LIMITS_AT_A_TIME // len(self.catalogue.threats), 1)):
            places = missing[part]
            found = measured(self.catalogue, self.rows(places), self.runs)
            self._limits[places], self._shown_limits[places], self._slack[places] = found

    def limits_m_s(self, where: Ints) -> Floats:
        """Return the lowest limits by the model of designs against each threat, m/s, (designs, threats)."""
        self.measure(where)
        return self._limits[where]

    def slack_m_s(self, where: Ints) -> Floats:
        """Return the slack of designs against each threat, see the function `slack_m_s`, m/s, (designs, threats)."""
        self.measure(where)
        return self._slack[where]

    def margins_m_s(self, where: Ints) -> Floats:
        """Return the limits shown, see `measured`, minus the velocities of the threats, m/s, (designs, threats)."""
        self.measure(where)
        return self._shown_limits[where] - self.catalogue.velocities_m_s

    def quick_margins_m_s(self, where: Ints) -> Floats:
        """Return the margins, m/s, (designs, threats), by the usual scan, which may miss lower limits."""
        margins = np.empty((len(where), len(self.catalogue.threats)))
        for part in portions(len(where), max(LIMITS_AT_A_TIME // margins.shape[1], 1)):
            rows = self.rows(where[part])
            limits = rows.limits_anywhere(self.runs)
            expected = rows.expected_limits(limits)
            shown = np.where(np.isnan(expected), limits, expected)
            margins[part] = (shown - rows.velocities).reshape(-1, margins.shape[1])
        return margins

    def passes(self, where: Ints, least: int = PASSES) -> Bools:
        """Return whether designs have at least the verdict `least`, also by their lowest limits; without samples."""
        passed = self.verdicts(where) >= least
        passed[passed] = (self.slack_m_s(where[passed]) >= 0.0).all(axis=1)
        return passed

    def sampled(self, place: int) -> int:
        """Return the verdict on a design by its sampled probabilities of perforation; passes if none are sampled."""
        if self.reliability is None:
            return PASSES
        if place not in self._sampled:
            estimates = self.reliability.probabilities(self.columns, place, quick=True)
            bounds = dict(zip(self.catalogue.titles, self.catalogue.bounds.tolist(), strict=True))
            verdict = verdict_of(verdict_of_samples(value, bounds[threat]) for threat, value in estimates.items())
            self._sampled[place] = {"fails": FAILS, "not known": NOT_KNOWN}.get(verdict, PASSES)
        return self._sampled[place]

    def first(self, where: Ints, least: int = PASSES, *, by_samples: bool = True) -> int | None:
        """Return the first of some designs with at least the verdict `least`; None if there is none.

        The lowest limits count and, unless `by_samples` is False, so do the sampled probabilities.
        """
        remaining = where[self.verdicts(where) >= least]
        size = 1
        while len(remaining):
            batch, remaining, size = remaining[:size], remaining[size:], min(2 * size, FIRST_AT_A_TIME)
            for place in batch[self.passes(batch, least)].tolist():
                if not by_samples or self.sampled(place) >= least:
                    return int(place)
        return None

    def ranked(self, where: Ints) -> Ints:
        """Sort designs: those whose model error is known come first; otherwise the order is kept."""
        return where[np.argsort(~self.known(where), kind="stable")]

    def of_pair(self, pair: int) -> Ints:
        """Return the designs on offer of a pair of materials, in the order of the objective."""
        return self.offered[self.columns.pair[self.offered] == pair]

    def frontier_backings(self, best: int) -> Floats:
        """Return the back plate thicknesses for the frontier of the pair of the design at place `best`, mm.

        If both layers are free, the search starts with these thicknesses; otherwise they are all that the pair has.  Of
        very many, only every second, third, and so on is taken.  The thickness of the best design is always included.
        """
        pair = int(self.columns.pair[best])
        ceramic, backing = (layer.free_range() for layer in self.catalogue.offers[pair][:2])
        backings = np.unique(self.columns.backing_mm[self.of_pair(pair)])
        if ceramic is not None and backing is not None:
            backings = first_backings(backing)[0]
        return np.append(backings[:: -(-len(backings) // MOST_BACKINGS)], self.columns.backing_mm[best])

    def frontier(self, best: int, least: int) -> Ints:
        """Return for each back plate of `frontier_backings` the thinnest ceramic with at least the verdict `least`.

        If probabilities are sampled, bisection finds the thinnest ceramic that also passes by samples, assuming that
        every thicker ceramic passes, too.
        """
        ceramics, backings = self.columns.ceramic_mm, self.columns.backing_mm
        stopping = self.of_pair(int(self.columns.pair[best]))
        stopping = stopping[np.isin(backings[stopping], self.frontier_backings(best))]
        stopping = stopping[self.verdicts(stopping) >= least]
        stopping = stopping[np.lexsort((ceramics[stopping], backings[stopping]))]
        remaining, frontier = stopping, stopping[:0]
        while len(remaining):
            _, first = np.unique(backings[remaining], return_index=True)
            thinnest = remaining[first]
            frontier = np.concatenate([frontier, thinnest[self.passes(thinnest, least)]])
            remaining = np.delete(remaining, first)
            remaining = remaining[~np.isin(backings[remaining], backings[frontier])]
        frontier = frontier[np.argsort(backings[frontier])]
        if self.reliability is None:
            return frontier

        def passes(place: int) -> bool:
            return self.first(np.array([place]), least) is not None

        within_bounds = []
        for place in frontier.tolist():
            thicker = (backings[stopping] == backings[place]) & (ceramics[stopping] >= ceramics[place])
            column = stopping[thicker].tolist()
            index = column.index(best) if best in column else bisect_left(column, True, key=passes)
            within_bounds += column[index : index + 1]
        return np.array(within_bounds, dtype=np.int64)

    def changing(self) -> Iterator[tuple[int, str, float]]:
        """Yield each case of a thicker layer that is perforated at a velocity that a thinner one stops.

        The values are the index of the pair, the name of the layer, and the thickness of the other layer, mm.
        """
        pairs, ceramics, backings = (column[self.offered] for column in self.columns[:3])
        verdicts = self.verdicts(self.offered)
        for name, layer, other_layer in (("ceramic", ceramics, backings), ("back plate", backings, ceramics)):
            order = np.lexsort((layer, other_layer, pairs))
            thin, thick = order[:-1], order[1:]
            changes = (pairs[thin] == pairs[thick]) & (other_layer[thin] == other_layer[thick])
            changes &= (verdicts[thin] > FAILS) & (verdicts[thick] == FAILS)
            thin, thick = thin[changes], thick[changes]
            # Where it is known, the model error may be greater for the thicker one.
            limits = [self.limits_m_s(self.offered[places]) for places in (thick, thin)]
            thin = thin[np.less(*limits).any(axis=1) | ~self.known(self.offered[thick])]
            for place in thin:
                yield int(pairs[place]), name, float(other_layer[place])

    def not_monotonic_mm(self, frontier: Ints) -> tuple[float, ...]:
        """Return the back plate thicknesses of a frontier at which a thicker ceramic is known not to pass, mm."""
        ceramics, backings = self.columns.ceramic_mm, self.columns.backing_mm
        designs = self.of_pair(int(self.columns.pair[frontier[0]]))
        designs = designs[np.isin(backings[designs], backings[frontier])]
        designs = designs[self.known(designs) == self.known(frontier[:1])]
        failing = designs[(self.verdicts(designs) == FAILS) | (self._slack[designs] < 0.0).any(axis=1)]
        # The frontier is in the order of its back plates.
        thickest = np.zeros(len(frontier))
        np.maximum.at(thickest, np.searchsorted(backings[frontier], backings[failing]), ceramics[failing])
        return tuple(backings[frontier][thickest > ceramics[frontier]].tolist())
