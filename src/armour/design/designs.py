"""The designs of a catalogue as one table, of which answers are queries.

Columns are computed for the designs that a query asks for: a verdict from impacts, limits, and sampled probabilities.
"""

from bisect import bisect_left
from collections.abc import Iterator
from functools import lru_cache
from math import ceil, log, log1p
from typing import NamedTuple

import numpy as np

from armour.analysis.estimates import INTERVAL_TAIL, Estimate, proportion
from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.samples import is_sampled, points_of, probability_of_perforation, section_of
from armour.analysis.variants import Bools, Floats, Ints, Variants
from armour.design.catalogue import NO_BOUND, CandidateDesigns, Catalogue, first_backings
from armour.design.requirements import verdict_of, verdict_of_samples
from armour.errors import Problem, refuse
from armour.evidence.tests import outside_tests
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.schema import FASTEST_M_S, MAX_SAMPLES, Uncertainty

# Verdicts on designs, from the worst; UNJUDGED is none yet.
UNJUDGED, FAILS, NOT_KNOWN, PASSES = range(-1, 3)
# Numbers of impacts and of limits to compute at a time, in a few tenths of a second.
IMPACTS_AT_A_TIME = 10_000
LIMITS_AT_A_TIME = 2_000
# Most designs to try at a time until one passes; those after it are tried in vain.
FIRST_AT_A_TIME = 500
# Most back plates of a frontier, besides the best: a square grid of the most designs has as many.
MOST_BACKINGS = 1000
# Scenarios of pairs of materials and threats that are kept.
MOST_SCENARIOS = 1000


class Runs:
    """Counter of impacts, which reports them."""

    def __init__(self, on_progress: OnProgress = ignore_progress) -> None:
        self.count, self.on_progress = 0, on_progress

    def __call__(self, runs: int, _total: int | None = None) -> None:
        """Count impacts."""
        self.count += runs
        self.on_progress(runs, None)


class Required(NamedTuple):
    """What decides on n rows of designs against threats."""

    limits_m_s: Floats  # least ballistic limits by the model; 0 where a probability alone decides
    bounds: Floats  # greatest probabilities of perforation, given the model error; 1 where none is required, or known
    unknown: Bools  # whether a probability is required that is not known, or a layer lies between tile and plate


def required_of(catalogue: Catalogue, rows: Variants) -> Required:
    """Return what is required of designs against each threat, (designs times threats).

    A margin is, where one is given, and a probability.  Where none is required or known, the limit decides.
    """
    count = len(rows.velocities) // len(catalogue.threats)
    bounded = np.tile(catalogue.bounds < NO_BOUND, count)
    bounds, margins = np.tile(catalogue.exact_bounds, count), np.tile(catalogue.margins_m_s, count)
    known = bounded.copy()
    if catalogue.bounded:
        known &= rows.errors.known
    limits = np.where(known & (margins == 0.0), 0.0, rows.velocities + margins)
    by_samples = catalogue.sampled and catalogue.scenario.excludes_error()
    unknown = np.zeros_like(known) if by_samples else bounded & ~known
    unknown |= catalogue.scenario.interlayers > 0
    return Required(limits, np.where(known, bounds, 1.0), unknown)


def verdicts_of(catalogue: Catalogue, rows: Variants, runs: Runs) -> Ints:
    """Return the verdicts on designs, (n,), from impacts at the velocities required, given their rows."""
    required, threats = required_of(catalogue, rows), len(catalogue.threats)
    remaining = np.arange(len(rows.velocities) // threats)
    # Designs that one threat perforates are not tried against the next.
    for threat in range(threats):
        places = remaining * threats + threat
        stops = stopped(rows.at(places)._replace(velocities=required.limits_m_s[places]), runs)
        bounded = np.flatnonzero(stops & (required.bounds[places] < 1.0))
        if len(bounded):
            stops[bounded] = within_bounds(rows.at(places[bounded]), required.bounds[places[bounded]], runs)
        remaining = remaining[stops]
    verdicts = np.full(len(required.unknown) // threats, FAILS)
    is_unknown: Bools = required.unknown.reshape(-1, threats).max(axis=1)
    verdicts[remaining] = np.where(is_unknown[remaining], NOT_KNOWN, PASSES)
    return verdicts


def stopped(rows: Variants, runs: Runs) -> Bools:
    """Return whether rows stop the projectile at their velocities; not if these are too high to compute."""
    is_stopped = rows.velocities <= FASTEST_M_S
    possible = np.flatnonzero(is_stopped & (rows.velocities > 0.0))
    is_stopped[possible] = ~rows.at(possible).perforated()
    runs(len(possible))
    return is_stopped


def within_bounds(rows: Variants, bounds: Floats, runs: Runs) -> Bools:
    """Return whether the probabilities of perforation of rows, which are known, are at most bounds.

    Most rows keep to them by every law of the flow stress or by none, as one impact by each law shows.  The
    probabilities of the others follow from their limits.
    """
    errors = rows.errors
    by_any, by_all = np.zeros(len(bounds), dtype=bool), np.ones(len(bounds), dtype=bool)
    for law, weights in enumerate(errors.ratio.weights):
        used = np.flatnonzero(weights > 0.0)
        with np.errstate(divide="ignore"):
            velocities = rows.velocities / errors.of_law(law).quantile(bounds).clip(min=0.0)
        by_law = rows.by_law(law, errors) if law else rows
        is_stopped = stopped(by_law._replace(velocities=velocities).at(used), runs)
        by_any[used] |= is_stopped
        by_all[used] &= is_stopped
    within, undecided = by_any & by_all, np.flatnonzero(by_any & ~by_all)
    rows = rows.at(undecided)
    of_limits = rows.limit_distributions(rows.limits_anywhere(runs))
    within[undecided] = of_limits.probability_above(rows.velocities) >= 1.0 - bounds[undecided]
    return within


def slack_m_s(catalogue: Catalogue, rows: Variants, limits: Floats) -> Floats:
    """Return by how much rows exceed what is required, m/s, given their limits; below 0 for what they lack.

    It is what the limit has above the one required or, if this is less, what the velocity that is stopped with the
    required probability has above that of the threat.
    """
    required = required_of(catalogue, rows)
    slack = np.where(required.limits_m_s > 0.0, limits - required.limits_m_s, np.inf)
    bounded = np.flatnonzero(required.bounds < 1.0)
    if len(bounded):
        of_limits = rows.at(bounded).limit_distributions(limits[bounded])
        surely = of_limits.quantile(required.bounds[bounded]) - rows.velocities[bounded]
        slack[bounded] = np.minimum(slack[bounded], surely)
    return slack


def measured(catalogue: Catalogue, rows: Variants, runs: Runs) -> tuple[Floats, Floats]:
    """Return the lowest ballistic limits of designs against each threat, m/s, (designs, threats), and their slack.

    The search extends beyond the range of the section ``ballistic_limit``.  Where the limit is high enough, velocities
    are scanned more densely, for lower limits.
    """
    shape = -1, len(catalogue.threats)
    limits = rows.limits_anywhere(runs)
    slack = slack_m_s(catalogue, rows, limits)
    high = np.flatnonzero(slack >= 0.0)
    lowest = rows.at(high).lowest_limits(limits[high], runs)
    if (lowest < limits[high]).any():
        limits[high] = lowest
        slack = slack_m_s(catalogue, rows, limits)
    return limits.reshape(shape), slack.reshape(shape)


class Reliability:
    """Probabilities of perforation of the designs of a catalogue, with the samples to estimate them."""

    def __init__(self, catalogue: Catalogue, on_progress: OnProgress = ignore_progress) -> None:
        self.catalogue, self.on_progress = catalogue, on_progress
        # Many designs have the same materials, and making a scenario is slow.
        self.against = lru_cache(MOST_SCENARIOS)(catalogue.against)
        _check(catalogue, section_of(self.against(0, 0)))
        self.points = points_of(catalogue.scenario.uncertainty or Uncertainty())

    def probabilities(self, candidates: CandidateDesigns, place: int, *, quick: bool) -> dict[str, Estimate]:
        """Estimate the probabilities of perforation of a design, by threat that bounds it, where they are known."""
        thicknesses = {CERAMIC: float(candidates.ceramic_mm[place]), BACKING: float(candidates.backing_mm[place])}
        estimates = {}
        for threat, (title, bound) in enumerate(zip(self.catalogue.titles, self.catalogue.bounds, strict=True)):
            if bound < NO_BOUND:
                scenario = self.against(int(candidates.pair[place]), threat)
                layers = {key: thicknesses[key] for key in thicknesses if key in scenario.inputs()}
                if is_sampled(scenario, layers):
                    estimates[title] = probability_of_perforation(
                        scenario, float(bound), layers, self.points, self.on_progress, quick=quick
                    )
        return estimates


def _check(catalogue: Catalogue, section: Uncertainty) -> None:
    """Check that the distributions apply to every design, material and threat, and that there are enough samples."""
    file = catalogue.scenario.file
    problems = []
    for name, distribution in section.inputs().items():
        if distribution.placed and name in catalogue.varying:
            message = (
                "must be centred on the value of each design or threat: normal or lognormal, without mean, min and "
                'max, such as { distribution = "normal", standard_deviation_percent = 1.0 }'
            )
            problems.append(Problem(file, f"uncertainty.{name}", message))
    bound = float(catalogue.bounds.min())
    if catalogue.scenario.excludes_error() and proportion(0, section.samples).high > bound:
        # Without a perforation, the upper end of the Clopper-Pearson interval is 1 - (tail)^(1/n).
        needed = ceil(log(INTERVAL_TAIL) / log1p(-bound))
        message = f"must be at least {needed} to show a probability of perforation of {bound:g}"
        too_many = f" (at most {MAX_SAMPLES} are allowed: raise the bound)" if needed > MAX_SAMPLES else ""
        problems.append(Problem(file, "uncertainty.samples", f"{message}{too_many}, found {section.samples}"))
    refuse(problems)


class Designs:
    """The designs on offer, in the order of the objective; queries give them by their places.

    Attributes
    ----------
    columns : CandidateDesigns
    within, offered : array of int
        Places of the designs within the limits of the section ``design``; of those on back plates that may be a metal.
    one_source : array of bool
        Whether a single source gives the flow stress of the ceramic of each design; such a design is never the best.
    """

    def __init__(
        self, catalogue: Catalogue, columns: CandidateDesigns, runs: Runs, reliability: Reliability | None = None
    ) -> None:
        # A free thickness of which no value passes is NaN; back plates that are no metal count only where all are none.
        is_metal = catalogue.metal if catalogue.metal.any() else ~catalogue.metal
        columns = columns.at(~np.isnan(columns.thickness_mm) & is_metal[columns.pair])
        self.columns = columns.at(catalogue.objective(columns).argsort(kind="stable"))
        self.catalogue, self.runs, self.reliability = catalogue, runs, reliability
        self.values = catalogue.objective(self.columns)
        self.within = np.flatnonzero(catalogue.violations(self.columns) <= 0.0)
        self.offered = self.within[catalogue.metal[self.columns.pair[self.within]]]
        self.one_source = catalogue.one_source[self.columns.pair] & (self.columns.ceramic_mm > 0.0)
        count = len(self.values)
        self._verdicts, self._known = np.full(count, UNJUDGED), np.zeros(count, dtype=bool)
        self._limits, self._slack = np.full((2, count, len(catalogue.threats)), np.nan)
        self._sampled: dict[int, int] = {}
        self._shown: dict[int, Variants] = {}
        self._outside: dict[int, dict[str, float]] = {}

    def rows(self, where: Ints) -> Variants:
        """Return designs against each threat, (designs times threats)."""
        return self.catalogue.against_each(self.columns.at(where))

    def rows_of(self, place: int) -> Variants:
        """Return a design that is shown against each threat, (threats,)."""
        if place not in self._shown:
            self._shown[place] = self.rows(np.array([place]))
        return self._shown[place]

    def outside_tests(self, where: Ints) -> list[dict[str, float]]:
        """Return by how much designs lie outside the tests, by quantity, against the threat farthest from them."""
        missing = [place for place in dict.fromkeys(where.tolist()) if place not in self._outside]
        rows = self.rows_of(missing[0]) if len(missing) == 1 else self.rows(np.array(missing, dtype=np.int64))
        found = outside_tests(rows.armours, rows.velocities, len(self.catalogue.threats))
        self._outside.update(zip(missing, found, strict=True))
        return [self._outside[place] for place in where.tolist()]

    def verdicts(self, where: Ints) -> Ints:
        """Return the verdicts on designs by impacts alone: lower limits and samples may be worse."""
        missing, threats = where[self._verdicts[where] == UNJUDGED], len(self.catalogue.threats)
        for part in portions(len(missing), max(IMPACTS_AT_A_TIME // threats, 1)):
            rows = self.rows(missing[part])
            self._verdicts[missing[part]] = verdicts_of(self.catalogue, rows, self.runs)
            self._known[missing[part]] = rows.errors.known.reshape(-1, threats).all(axis=1)
        return self._verdicts[where]

    def known(self, where: Ints) -> Bools:
        """Return whether the model error is known, or left out, for designs against every threat."""
        self.verdicts(where)
        return self._known[where] | self.catalogue.scenario.excludes_error()

    def measure(self, where: Ints) -> None:
        """Compute limits and slack of designs that have none yet."""
        missing = where[np.isnan(self._limits[where, 0])]
        for part in portions(len(missing), max(LIMITS_AT_A_TIME // len(self.catalogue.threats), 1)):
            places = missing[part]
            self._limits[places], self._slack[places] = measured(self.catalogue, self.rows(places), self.runs)

    def limits_m_s(self, where: Ints) -> Floats:
        """Return the lowest ballistic limits of designs against each threat, m/s, (designs, threats)."""
        self.measure(where)
        return self._limits[where]

    def slack_m_s(self, where: Ints) -> Floats:
        """Return by how much designs exceed what is required against each threat, m/s, (designs, threats)."""
        self.measure(where)
        return self._slack[where]

    def margins_m_s(self, where: Ints) -> Floats:
        """Return what limits of designs have above the velocities of the threats, m/s, (designs, threats)."""
        return self.limits_m_s(where) - self.catalogue.velocities_m_s

    def quick_margins_m_s(self, where: Ints) -> Floats:
        """Return the same by the quick search, which may miss lower limits."""
        margins = np.empty((len(where), len(self.catalogue.threats)))
        for part in portions(len(where), max(LIMITS_AT_A_TIME // margins.shape[1], 1)):
            rows = self.rows(where[part])
            margins[part] = (rows.limits_anywhere(self.runs) - rows.velocities).reshape(-1, margins.shape[1])
        return margins

    def passes(self, where: Ints, least: int = PASSES) -> Bools:
        """Return whether the verdicts on designs are at least a given one, and no limit is lower; without samples."""
        passed = self.verdicts(where) >= least
        passed[passed] = (self.slack_m_s(where[passed]) >= 0.0).all(axis=1)
        return passed

    def sampled(self, place: int) -> int:
        """Return the verdict on a design by its sampled probabilities of perforation."""
        if self.reliability is None:
            return PASSES
        if place not in self._sampled:
            estimates = self.reliability.probabilities(self.columns, place, quick=True)
            bounds = dict(zip(self.catalogue.titles, self.catalogue.bounds.tolist(), strict=True))
            verdict = verdict_of(verdict_of_samples(found, bounds[threat]) for threat, found in estimates.items())
            self._sampled[place] = {"fails": FAILS, "not known": NOT_KNOWN, "passes": PASSES}[verdict]
        return self._sampled[place]

    def first(self, where: Ints, least: int = PASSES, *, by_samples: bool = True) -> int | None:
        """Return the first of some designs whose verdict is at least a given one, by default that of samples too."""
        remaining = where[self.verdicts(where) >= least]
        size = 1
        while len(remaining):
            batch, remaining, size = remaining[:size], remaining[size:], min(2 * size, FIRST_AT_A_TIME)
            for place in batch[self.passes(batch, least)].tolist():
                if not by_samples or self.sampled(place) >= least:
                    return int(place)
        return None

    def ranked(self, where: Ints) -> Ints:
        """Return designs whose model error is known before the others."""
        return where[np.argsort(~self.known(where), kind="stable")]

    def of_pair(self, pair: int) -> Ints:
        """Return the designs on offer of a pair of materials, in the order of the objective."""
        return self.offered[self.columns.pair[self.offered] == pair]

    def frontier_backings(self, best: int) -> Floats:
        """Return the thicknesses of the back plates of the frontier of the best design's pair, mm.

        They are those tried first if both layers are free, otherwise all; of very many, every second, third, and so on.
        That of the best design is always among them.
        """
        pair = int(self.columns.pair[best])
        ceramic, backing = (layer.free_range() for layer in self.catalogue.offers[pair][:2])
        backings = np.unique(self.columns.backing_mm[self.of_pair(pair)])
        if ceramic is not None and backing is not None:
            backings = first_backings(backing)[0]
        return np.append(backings[:: -(-len(backings) // MOST_BACKINGS)], self.columns.backing_mm[best])

    def frontier(self, best: int, least: int) -> Ints:
        """Return for each back plate of `frontier_backings` the thinnest ceramic whose verdict is at least a given one.

        Sampled probabilities count too: beyond the thinnest ceramic that passes without, bisection finds the least that
        passes, assuming that every thicker one does.
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
        """Yield each pair and layer of which a thicker one is perforated at a velocity that a thinner one stops.

        The third value is the thickness of the other layer, mm.
        """
        pairs, ceramics, backings = (column[self.offered] for column in self.columns[:3])
        verdicts = self.verdicts(self.offered)
        for name, layer, other_layer in (("ceramic", ceramics, backings), ("back plate", backings, ceramics)):
            order = np.lexsort((layer, other_layer, pairs))
            thin, thick = order[:-1], order[1:]
            changes = (pairs[thin] == pairs[thick]) & (other_layer[thin] == other_layer[thick])
            changes &= (verdicts[thin] > FAILS) & (verdicts[thick] == FAILS)
            thin, thick = thin[changes], thick[changes]
            if self.catalogue.bounded:  # the model error may be greater for the thicker one
                limits = [self.limits_m_s(self.offered[places]) for places in (thick, thin)]
                thin = thin[np.less(*limits).any(axis=1)]
            for place in thin:
                yield int(pairs[place]), name, float(other_layer[place])

    def not_monotonic_mm(self, frontier: Ints) -> tuple[float, ...]:
        """Return the back plate thicknesses of a frontier at which a thicker ceramic is known not to pass, mm."""
        ceramics, backings = self.columns.ceramic_mm, self.columns.backing_mm
        designs = self.of_pair(int(self.columns.pair[frontier[0]]))
        designs = designs[np.isin(backings[designs], backings[frontier])]
        if self.catalogue.bounded:
            designs = designs[self.known(designs)]
        failing = designs[(self.verdicts(designs) == FAILS) | (self._slack[designs] < 0.0).any(axis=1)]
        # The frontier is in the order of its back plates.
        thickest = np.zeros(len(frontier))
        np.maximum.at(thickest, np.searchsorted(backings[frontier], backings[failing]), ceramics[failing])
        return tuple(backings[frontier][thickest > ceramics[frontier]].tolist())
