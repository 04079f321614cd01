"""Table of the designs of a catalogue, with questions to it such as which is the first design that passes.

Verdicts, ballistic limits and sampled probabilities are computed only for the designs that a question needs.
"""

from collections.abc import Iterator
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np

from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.samples import is_sampled, points_of, probability_of_perforation
from armour.analysis.variants import Bools, Floats, Ints, Variants
from armour.design.catalogue import Catalogue
from armour.design.requirements import EVEN, Verdict, verdict_of, verdict_of_samples
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.schema import FASTEST_M_S, Uncertainty

# Verdicts of a search on designs, from the worst to the best; UNJUDGED is none yet.  A design of NOT_KNOWN is stopped
# by the model, but no probability is known or stated; one of PASSES has the required probability or, where none is
# required, 0.5.
UNJUDGED, FAILS, NOT_KNOWN, PASSES = range(-1, 3)
# Numbers of impacts and of limits to compute at a time, in a few tenths of a second.
IMPACTS_AT_A_TIME = 10_000
LIMITS_AT_A_TIME = 2_000
# Most designs to try at a time until one passes; those tried with it that come after it are tried in vain.
FIRST_AT_A_TIME = 500
# Most back plate thicknesses of a frontier, besides that of the best design.  A square grid with the greatest number of
# designs has as many.
MOST_BACKINGS = 1000
# Most scenarios, each of a pair of materials against a threat, to keep in memory.
MOST_SCENARIOS = 1000


class Runs:
    """Counter of the impacts computed; call it with the number of new ones, which it adds and reports as progress."""

    def __init__(self, on_progress: OnProgress = ignore_progress) -> None:
        self.count, self.on_progress = 0, on_progress

    def __call__(self, runs: int, _total: int | None = None) -> None:
        """Add `runs` impacts to the count, and report them."""
        self.count += runs
        self.on_progress(runs, None)


class Required(NamedTuple):
    """What is required of n impacts, each of a design against a threat; arrays, (n,)."""

    limits_m_s: Floats  # least limits by the model; 0 where the model error is known
    expected_m_s: Floats  # least expected limits; 0 where the model error is not known, or no margin is required
    bounds: Floats  # greatest probabilities of perforation; 1 where the model error is not known
    unknown: Bools  # whether the probability is not known or not stated, or a layer is between tile and plate


def required_of(catalogue: Catalogue, rows: Variants) -> Required:
    """Return what is required of designs against each threat, given the rows of `Catalogue.against_each`.

    Where the model error is known, this is a probability, and an expected limit if there is a margin; elsewhere, it is
    a limit by the model of at least the velocity plus the margin.
    """
    count, errors = len(rows.velocities) // len(catalogue.threats), rows.errors
    of_threats = catalogue.exact_bounds, catalogue.bounds, catalogue.margins_m_s
    bounds, stated, margins = np.tile(of_threats, count)
    known, needed = errors.known, rows.velocities + margins
    return Required(
        np.where(known, 0.0, needed),
        np.where(known & (margins > 0.0), needed, 0.0),
        np.where(known, bounds, 1.0),
        ~known | (1.0 - stated > errors.greatest) | (catalogue.scenario.interlayers > 0),
    )


def verdicts_of(catalogue: Catalogue, rows: Variants, runs: Runs) -> Ints:
    """Return the verdict on each of n designs, FAILS, NOT_KNOWN or PASSES, (n,), from impacts at required velocities.

    `rows` has each design against each threat, (n * threats,), as `Catalogue.against_each` returns it.
    """
    required, threats = required_of(catalogue, rows), len(catalogue.threats)
    remaining = np.arange(len(rows.velocities) // threats)
    # A design that one threat perforates fails, and need not be tried against the next.
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
    """Return whether each row stops the projectile at its velocity, (n,); False above the greatest velocity allowed."""
    is_stopped = rows.velocities <= FASTEST_M_S
    possible = np.flatnonzero(is_stopped & (rows.velocities > 0.0))
    is_stopped[possible] = ~rows.at(possible).perforated()
    runs(len(possible))
    return is_stopped


def within_bounds(rows: Variants, bounds: Floats, runs: Runs) -> Bools:
    """Return whether the probability of perforation of each of n rows is at most its bound, (n,).

    The model errors of the rows must be known.  One impact by each law of the flow stress decides if the laws agree,
    which is usual.  For the other rows, the probability is computed from the ballistic limits by the laws.
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
    """Return how much is left of what is required, the slack, and the limits that answers show, m/s, (n,) each.

    `limits` are those by the model.  The slack is negative if the rows do not meet what is required.  It is the
    difference of limit by the model and the one required or, where the model error is known, the smaller of two:
    velocity stopped with the required probability minus velocity of the threat, and expected limit minus the one
    required.  The limits shown are the expected ones or, where the model error is not known, those by the model.
    """
    required, distributions = required_of(catalogue, rows), rows.shot_distributions(limits)
    expected = distributions.quantile(0.5)
    slack = np.where(required.limits_m_s > 0.0, limits - required.limits_m_s, np.inf)
    slack = np.where(required.expected_m_s > 0.0, expected - required.expected_m_s, slack)
    if (required.bounds < 1.0).any():
        slack = np.fmin(slack, distributions.quantile(required.bounds) - rows.velocities)
    return slack, np.where(np.isnan(expected), limits, expected)


def measured(catalogue: Catalogue, rows: Variants, runs: Runs, *, lowest: bool = True) -> tuple[Floats, Floats, Floats]:
    """Return the limits by the model, the limits that answers show, and the slack, see `slack_m_s`, m/s.

    Each is of designs against each threat, (designs, threats).  The search extends beyond the range of the section
    ``ballistic_limit``.  If a limit is high enough, a denser scan looks for a lower one, unless `lowest` is False.
    """
    limits = rows.limits_anywhere(runs)
    slack, shown = slack_m_s(catalogue, rows, limits)
    high = np.flatnonzero(slack >= 0.0)
    if lowest and len(high):
        found = rows.at(high).lowest_limits(limits[high], runs)
        if (found < limits[high]).any():
            limits[high] = found
            slack, shown = slack_m_s(catalogue, rows, limits)
    shape = -1, len(catalogue.threats)
    return limits.reshape(shape), shown.reshape(shape), slack.reshape(shape)


class Designs:
    """Table of all designs of a catalogue, those with the least objective first.

    Designs are given by their places, which are indices in the table, and `where` is an array of places.  What has been
    computed for a design is kept.

    Attributes
    ----------
    columns : CandidateDesigns
        Materials and dimensions of the designs.
    values : array
        Objectives of the designs.
    offered : array of int
        Places of the designs within the limits of the section ``design``, on back plates that may be a metal.
    unsourced : array of bool
        Whether the ceramic of each design has neither tests nor two sources of its flow stress; such a design is never
        the best.
    """

    def __init__(self, catalogue: Catalogue, runs: Runs) -> None:
        columns = catalogue.every()
        self.columns = columns.at(catalogue.objective(columns).argsort(kind="stable"))
        self.catalogue, self.runs = catalogue, runs
        # Many designs have the same materials, and making a scenario is slow.
        self.against = lru_cache(MOST_SCENARIOS)(catalogue.against)
        self.values = catalogue.objective(self.columns)
        is_within = catalogue.violations(self.columns) <= 0.0
        self.offered = np.flatnonzero(is_within & catalogue.metal[self.columns.pair])
        self.unsourced = catalogue.lacks_sources[self.columns.pair] & (self.columns.ceramic_mm > 0.0)
        count = len(self.values)
        # Verdicts, and whether the model error is known against every threat.
        self._verdicts, self._known = np.full(count, UNJUDGED), np.zeros(count, dtype=bool)
        # Limits by the model, limits shown and slack, m/s; NaN until they are computed.
        self._measured = np.full((3, count, len(catalogue.threats)), np.nan)
        self._sampled: dict[int, int] = {}  # verdicts by samples, by place

    def rows(self, where: Ints) -> Variants:
        """Return one impact for each design and threat, (designs * threats,), see `Catalogue.against_each`."""
        return self.catalogue.against_each(self.columns.at(where))

    def verdicts(self, where: Ints) -> Ints:
        """Return FAILS, NOT_KNOWN or PASSES for designs, by impacts alone; lowest limits and samples may give worse."""
        missing, threats = where[self._verdicts[where] == UNJUDGED], len(self.catalogue.threats)
        for part in portions(len(missing), max(IMPACTS_AT_A_TIME // threats, 1)):
            rows = self.rows(missing[part])
            self._verdicts[missing[part]] = verdicts_of(self.catalogue, rows, self.runs)
            self._known[missing[part]] = rows.errors.known.reshape(-1, threats).all(axis=1)
        return self._verdicts[where]

    def known(self, where: Ints) -> Bools:
        """Return whether the model error of each design is known against every threat, (designs,)."""
        self.verdicts(where)
        return self._known[where]

    def measured(self, where: Ints) -> Floats:
        """Return limits by the model, limits that answers show, and slack of designs, m/s, (3, designs, threats).

        The function `measured` computes them.
        """
        missing = where[np.isnan(self._measured[0, where, 0])]
        for part in portions(len(missing), max(LIMITS_AT_A_TIME // len(self.catalogue.threats), 1)):
            places = missing[part]
            self._measured[:, places] = measured(self.catalogue, self.rows(places), self.runs)
        return self._measured[:, where]

    def slack_m_s(self, where: Ints) -> Floats:
        """Return the slack of designs against each threat, see the function `slack_m_s`, m/s, (designs, threats)."""
        return self.measured(where)[2]

    def margins_m_s(self, where: Ints) -> Floats:
        """Return the limits shown minus the velocities of the threats, m/s, (designs, threats)."""
        return self.measured(where)[1] - self.catalogue.velocities_m_s

    def quick_margins_m_s(self, where: Ints) -> Floats:
        """Return the margins as `margins_m_s` does, but by the usual scan alone, which may miss lower limits."""
        margins = np.empty((len(where), len(self.catalogue.threats)))
        for part in portions(len(where), max(LIMITS_AT_A_TIME // margins.shape[1], 1)):
            shown = measured(self.catalogue, self.rows(where[part]), self.runs, lowest=False)[1]
            margins[part] = shown - self.catalogue.velocities_m_s
        return margins

    def passes(self, where: Ints, least: int = PASSES) -> Bools:
        """Return whether designs have at least the verdict `least` by impacts and lowest limits, not by samples."""
        passed = self.verdicts(where) >= least
        passed[passed] = (self.slack_m_s(where[passed]) >= 0.0).all(axis=1)
        return passed

    @cached_property
    def points(self) -> Floats:
        """Points of the unit cube at which uncertain inputs are sampled, the same for all designs; see `points_of`."""
        return points_of(self.catalogue.scenario.uncertainty or Uncertainty())

    def sampled(self, place: int) -> int:
        """Return the verdict on a design by its sampled probabilities of perforation; PASSES if none is sampled."""
        if self.catalogue.sampled and place not in self._sampled:
            verdict = verdict_of(map(partial(self._sampled_verdict, place), np.flatnonzero(self.catalogue.required)))
            self._sampled[place] = {"fails": FAILS, "not known": NOT_KNOWN}.get(verdict, PASSES)
        return self._sampled.get(place, PASSES)

    def _sampled_verdict(self, place: int, threat: int) -> Verdict:
        """Return the verdict on a design by samples against one threat; "passes" if no probability is known."""
        scenario = self.against(int(self.columns.pair[place]), int(threat))
        thicknesses = {CERAMIC: float(self.columns.ceramic_mm[place]), BACKING: float(self.columns.backing_mm[place])}
        layers = {key: thicknesses[key] for key in thicknesses if key in scenario.inputs()}
        if not is_sampled(scenario, layers):
            return "passes"
        bound = float(self.catalogue.bounds[threat])
        found = probability_of_perforation(scenario, bound, layers, self.points, self.runs.on_progress, quick=True)
        return verdict_of_samples(found, bound)

    def first(self, where: Ints, least: int = PASSES) -> int | None:
        """Return the place of the first of some designs that has at least the verdict `least`; None if there is none.

        The lowest limits count, and so do the sampled probabilities.
        """
        remaining = where[self.verdicts(where) >= least]
        size = 1
        while len(remaining):
            batch, remaining, size = remaining[:size], remaining[size:], min(2 * size, FIRST_AT_A_TIME)
            for place in batch[self.passes(batch, least)].tolist():
                if self.sampled(place) >= least:
                    return int(place)
        return None

    def known_first(self, where: Ints) -> Ints:
        """Return places sorted so that designs whose model error is known come first; otherwise the order is kept."""
        return where[np.argsort(~self.known(where), kind="stable")]

    def of_pair(self, pair: int) -> Ints:
        """Return the places of the designs on offer of a pair, given its index, in the order of the objective."""
        return self.offered[self.columns.pair[self.offered] == pair]

    def frontier(self, best: int, least: int) -> Ints:
        """Return for each back plate the place of the design with the thinnest ceramic that reaches `least`.

        The back plates are all that the pair of the design at place `best` has; of very many, only every second, third,
        and so on is taken, and that of the design.  One without such a ceramic is left out.  The lowest limits count,
        and so do the sampled probabilities.
        """
        ceramics, backings = self.columns.ceramic_mm, self.columns.backing_mm
        remaining = self.of_pair(int(self.columns.pair[best]))
        every = np.unique(backings[remaining])
        taken = np.append(every[:: -(-len(every) // MOST_BACKINGS)], backings[best])
        remaining = remaining[np.isin(backings[remaining], taken)]
        remaining = remaining[self.verdicts(remaining) >= least]
        remaining = remaining[np.lexsort((ceramics[remaining], backings[remaining]))]
        frontier = remaining[:0]
        while len(remaining):
            _, first = np.unique(backings[remaining], return_index=True)
            thinnest = remaining[first]
            passing = [place for place in thinnest[self.passes(thinnest, least)] if self.sampled(place) >= least]
            frontier = np.append(frontier, np.array(passing, dtype=np.int64))
            remaining = np.delete(remaining, first)
            remaining = remaining[~np.isin(backings[remaining], backings[frontier])]
        return frontier[np.argsort(backings[frontier])]

    def thicker_failures(self) -> Iterator[tuple[int, str, float]]:
        """Yield where a thicker layer is perforated at a velocity that a thinner one stops, of designs on offer.

        Each is the index of the pair, the layer, "ceramic" or "back plate", and the thickness of the other layer, mm.
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
            limits = [self.measured(self.offered[places])[0] for places in (thick, thin)]
            thin = thin[np.less(*limits).any(axis=1) | ~self.known(self.offered[thick])]
            for place in thin:
                yield int(pairs[place]), name, float(other_layer[place])
