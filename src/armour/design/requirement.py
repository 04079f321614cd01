"""What a design must withstand: its lowest ballistic limit must reach the velocity and the margin of every threat."""

import numpy as np

from armour.analysis import variants as rows
from armour.analysis.searches import lowest_limits
from armour.analysis.variants import Bools, Floats, Ints
from armour.design.catalogue import Catalogue
from armour.scenario.schema import FASTEST_M_S

# Velocity, m/s, from which a ballistic limit is searched for below the range of the section ``ballistic_limit``.
SLOWEST_M_S = 20.0


class Requirement:
    """The threats of a catalogue as a condition on designs; counts the impacts that it computes.

    Designs are given by arrays of the same length: index of the pair, ceramic and back plate thickness, mm.
    """

    def __init__(self, catalogue: Catalogue) -> None:
        self.catalogue = catalogue
        self.runs = 0

    def defeats(self, pair: Ints, ceramic_mm: Floats, backing_mm: Floats, threat: int | None = None) -> Bools:
        """Compute whether designs defeat all threats, or one, at the velocities required.

        Raises
        ------
        InputError
            If a run does not end, naming the key at fault.
        """
        threats = range(len(self.catalogue.threats)) if threat is None else [threat]
        alive = np.arange(len(pair))
        for each in threats:
            variants = self.catalogue.variants(pair[alive], ceramic_mm[alive], backing_mm[alive], each)
            self.runs += len(alive)
            alive = alive[~rows.perforated(variants)]
        defeated = np.zeros(len(pair), dtype=bool)
        defeated[alive] = True
        return defeated

    def lowest_limits(self, pair: Ints, ceramic_mm: Floats, backing_mm: Floats) -> Floats:
        """Find the lowest ballistic limits of designs against each threat, m/s, (designs, threats).

        Outside the range of the section ``ballistic_limit`` the search goes on from 20 to 10,000 m/s; beyond those the
        nearest of the two stands for the limit.

        Raises
        ------
        InputError
            If a run does not end, naming the key at fault.
        """
        section = self.catalogue.settings.ballistic_limit
        slowest, fastest = min(section.velocity_min_m_s, SLOWEST_M_S), FASTEST_M_S
        ranges = (
            (-np.inf, slowest, section.velocity_min_m_s),
            (np.inf, section.velocity_max_m_s, fastest),
        )
        limits = np.empty((len(pair), len(self.catalogue.threats)))
        for threat in range(limits.shape[1]):
            variants = self.catalogue.variants(pair, ceramic_mm, backing_mm, threat)
            found = self._searched(variants, section.velocity_min_m_s, section.velocity_max_m_s)
            for outside, low, high in ranges:
                where = np.flatnonzero(found == outside)
                if len(where) and low < high:
                    found[where] = self._searched(variants.at(where), low, high)
            limits[:, threat] = found.clip(slowest, fastest)
        return limits

    def passes(self, pair: Ints, ceramic_mm: Floats, backing_mm: Floats) -> Bools:
        """Compute whether designs defeat every threat at the velocity required and have no ballistic limit below it.

        Raises
        ------
        InputError
            If a run does not end, naming the key at fault.
        """
        passed = self.defeats(pair, ceramic_mm, backing_mm)
        limits = self.lowest_limits(pair[passed], ceramic_mm[passed], backing_mm[passed])
        passed[passed] = (limits >= self.catalogue.required_m_s).all(axis=1)
        return passed

    def _searched(self, variants: rows.Variants, low: float, high: float) -> Floats:
        limits, runs = lowest_limits(variants, low, high)
        self.runs += runs
        return limits
