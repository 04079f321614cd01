"""Which designs of a catalogue pass, in the order of the objective."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from armour.analysis.searches import ballistic_limits
from armour.analysis.variants import Bools, Floats, Ints
from armour.design.catalogue import Candidates
from armour.design.free import free_designs, is_free
from armour.design.pareto import verified_front
from armour.design.requirement import Requirement

if TYPE_CHECKING:
    from armour.analysis.estimates import Estimate
    from armour.design.reliability import Reliability

# Designs of which the outcome at the velocities required is computed at a time.
CHUNK = 4096
# Designs of which the ballistic limits are searched for at a time, at most.
BATCH = 64
# Criterion that is not a column of the candidates.
MARGIN = "margin_m_s"


def candidates_of(requirement: Requirement, *, refine: bool = False) -> Candidates:
    """Return the designs on offer that meet the constraints, in the order of the objective.

    Of a free thickness, and with ``refine`` of every range, it is what the other layer needs.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    catalogue = requirement.catalogue
    parts = []
    for pair, offer in enumerate(catalogue.offers):
        if is_free(offer.ceramic, refine=refine) or is_free(offer.backing, refine=refine):
            ceramic, backing = free_designs(requirement, pair, refine=refine)
        else:
            thicknesses = np.meshgrid(offer.ceramic.thicknesses(), offer.backing.thicknesses(), indexing="ij")
            ceramic, backing = (values.ravel() for values in thicknesses)
        parts.append(catalogue.candidates(pair, ceramic, backing))
    found = Candidates(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    found = found.at(catalogue.violations(found) <= 0.0)
    order = getattr(found, catalogue.section.minimise).argsort(kind="stable")
    return found.at(order)


class Search:
    """Which of the candidate designs pass; each outcome and limit is computed once, when it is first needed.

    Designs are given by their places among the candidates.

    Parameters
    ----------
    requirement : Requirement
    candidates : Candidates
        In the order of the objective.
    reliability : Reliability, optional
        Bounds on the probability of perforation.
    """

    def __init__(
        self, requirement: Requirement, candidates: Candidates, reliability: "Reliability | None" = None
    ) -> None:
        self.requirement, self.candidates, self.reliability = requirement, candidates, reliability
        self.catalogue = requirement.catalogue
        self.values: Floats = getattr(candidates, self.catalogue.section.minimise)
        self.examined = np.zeros(len(candidates.pair), dtype=bool)
        self.defeating = np.zeros(len(candidates.pair), dtype=bool)  # at the velocities required
        self._limits: dict[int, Floats] = {}
        self._probabilities: dict[int, dict[str, Estimate] | None] = {}

    def of_pair(self, pair: int) -> Ints:
        """Return the designs of a pair."""
        return np.flatnonzero(self.candidates.pair == pair)

    def examine(self, where: Ints) -> Ints:
        """Return those of some designs that defeat every threat at the velocity required."""
        unknown = where[~self.examined[where]]
        self.defeating[unknown] = self.requirement.defeats(*self._designs(unknown))
        self.examined[unknown] = True
        return where[self.defeating[where]]

    def defeats(self, where: Ints, threat: int) -> Bools:
        """Return whether designs defeat one threat at the velocity required."""
        return self.requirement.defeats(*self._designs(where), threat)

    def limits(self, where: Ints) -> Floats:
        """Return the lowest ballistic limits of designs against each threat, m/s, (designs, threats)."""
        unknown = np.array([place for place in where.tolist() if place not in self._limits], dtype=np.int64)
        found = self.requirement.lowest_limits(*self._designs(unknown))
        self._limits.update(zip(unknown.tolist(), found, strict=True))
        return np.array([self._limits[place] for place in where.tolist()]).reshape(-1, len(self.catalogue.threats))

    def reaches(self, where: Ints) -> Bools:
        """Return whether the lowest ballistic limits of designs reach what each threat requires, (designs, threats)."""
        reached: Bools = self.limits(where) >= self.catalogue.required_m_s
        return reached

    def passes(self, where: Ints) -> Bools:
        """Return whether designs defeat every threat at the velocity required and have no ballistic limit below it."""
        self.examine(where)
        passed = self.defeating[where]
        passed[passed] = self.reaches(where[passed]).all(axis=1)
        return passed

    def passing(self, where: Ints) -> Iterator[int]:
        """Iterate over those of some designs that pass, bounds on probabilities included, in their order."""
        for start in range(0, len(where), CHUNK):
            left = self.examine(where[start : start + CHUNK])
            size = 1
            while len(left):
                batch, left = left[:size], left[size:]
                for place in batch[self.passes(batch)].tolist():
                    if self.probabilities(place) is not None:
                        yield place
                size = min(2 * size, BATCH)

    def first(self, where: Ints) -> int | None:
        """Return the first of some designs that passes."""
        return next(self.passing(where), None)

    def probabilities(self, place: int) -> "dict[str, Estimate] | None":
        """Return the probabilities of perforation of a design, by threat that bounds it; None where one is too high."""
        if self.reliability is None:
            return {}
        if place not in self._probabilities:
            pair, ceramic, backing = self._designs(np.array([place]))
            self._probabilities[place] = self.reliability.probabilities(
                int(pair[0]), float(ceramic[0]), float(backing[0])
            )
        return self._probabilities[place]

    def frontier(self, pair: int) -> Ints:
        """Return for each back plate of a pair the thinnest ceramic that passes, bounds on probabilities aside."""
        ceramics, backings = self.candidates.ceramic_mm, self.candidates.backing_mm
        own = self.examine(self.of_pair(pair))
        left = own[np.lexsort((ceramics[own], backings[own]))]
        found = left[:0]
        while len(left):
            _, first = np.unique(backings[left], return_index=True)
            thinnest = left[first]
            found = np.concatenate([found, thinnest[self.passes(thinnest)]])
            left = np.delete(left, first)
            left = left[~np.isin(backings[left], backings[found])]
        return found[np.argsort(backings[found])]

    def not_monotonic_mm(self, frontier: Ints) -> tuple[float, ...]:
        """Return the back plate thicknesses of a frontier at which a thicker ceramic is known not to pass, mm."""
        ceramics, backings = self.candidates.ceramic_mm, self.candidates.backing_mm
        failing = self.examined & ~self.defeating
        for place, limits in self._limits.items():
            failing[place] |= (limits < self.catalogue.required_m_s).any()
        failing &= self.candidates.pair == self.candidates.pair[frontier[0]]
        return tuple(
            float(backings[place])
            for place in frontier.tolist()
            if (failing & (backings == backings[place]) & (ceramics > ceramics[place])).any()
        )

    def pareto(self, criteria: Sequence[str]) -> Ints:
        """Return the Pareto front of the designs that pass, bounds on probabilities included.

        All designs that defeat the threats at the velocities required are compared, with margins by the quick search
        for a ballistic limit; those of the front are verified by scan, and left out where they do not pass.
        """
        good = self.examine(np.arange(len(self.examined)))
        quick = self._quick_limits(good) if MARGIN in criteria else None

        def verify(some: Ints) -> tuple[Bools, Floats]:
            where = good[some]
            counts = self.passes(where)
            counts[counts] = [self.probabilities(place) is not None for place in where[counts].tolist()]
            return counts, self._costs(where, criteria, self.limits(where))

        return good[verified_front(self._costs(good, criteria, quick), verify)]

    def margins(self, limits: Floats) -> Floats:
        """Return ballistic limits, (designs, threats), less the velocities of the threats, m/s."""
        found: Floats = limits - np.array([threat.velocity_m_s for threat in self.catalogue.threats])
        return found

    def _quick_limits(self, where: Ints) -> Floats:
        """Return the ballistic limits of designs, from the scan only where the quick search finds none or a low one."""
        count = len(self.catalogue.threats)
        limits = np.array([ballistic_limits(self.catalogue.variants(*self._designs(where), i)) for i in range(count)]).T
        doubtful = ~(limits >= self.catalogue.required_m_s).all(axis=1)
        limits[doubtful] = self.limits(where[doubtful])
        return limits

    def _costs(self, where: Ints, criteria: Sequence[str], limits: Floats | None) -> Floats:
        """Return the criteria of designs to minimise, (designs, criteria)."""
        columns = {name: getattr(self.candidates, name)[where] for name in criteria if name != MARGIN}
        if limits is not None:
            columns[MARGIN] = -self.margins(limits).min(axis=1)
        return np.column_stack([columns[name] for name in criteria])

    def _designs(self, where: Ints) -> tuple[Ints, Floats, Floats]:
        some = self.candidates
        return some.pair[where], some.ceramic_mm[where], some.backing_mm[where]
