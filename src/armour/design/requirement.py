"""Condition on a design: its lowest ballistic limit must reach the velocity plus margin of every threat."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from armour.analysis.results import FIRST_IMPACTS, OnProgress, ignore_progress, portions
from armour.analysis.searches import limit_brackets
from armour.analysis.variants import Bools, Floats, Variants, perforated
from armour.core.search import DENSE_SCAN_POINTS, SCAN_POINTS
from armour.design.catalogue import Candidates, Catalogue
from armour.scenario.schema import FASTEST_M_S

# Velocity, m/s, from which a ballistic limit is searched for below the range of the section ``ballistic_limit``.
SLOWEST_M_S = 20.0
# Impacts and limits that are computed at a time, which bounds the memory.
IMPACTS_AT_A_TIME = 50_000
LIMITS_AT_A_TIME = 10_000
# Designs up to which one pass of the engine has all threats.  Of more, those that one threat perforates are not tried
# with the next, which saves more than the passes cost.
FEW_DESIGNS = 100


@dataclass
class Requirement:
    """The threats of a catalogue as a condition on designs; counts the impacts that it computes."""

    catalogue: Catalogue
    on_progress: OnProgress = ignore_progress  # called with impacts
    runs: int = 0
    # By pair and free layer: thicknesses of the other layer, mm, with which a thicker one is perforated at a velocity
    # that a thinner one stops.
    changing: defaultdict[tuple[int, str], set[float]] = field(default_factory=lambda: defaultdict(set))

    def defeats(self, candidates: Candidates, threat: int | None = None) -> Bools:
        """Return whether designs defeat all threats, or one, at the velocities required."""
        defeated = np.ones(len(candidates.pair), dtype=bool)
        threats = [*range(len(self.catalogue.threats))] if threat is None else [threat]
        passes = [threats] if len(defeated) <= FEW_DESIGNS else [[each] for each in threats]
        for part in portions(len(defeated), IMPACTS_AT_A_TIME, FIRST_IMPACTS):
            left = np.arange(part.start, part.stop)
            for some in passes:
                variants = self.catalogue.against_each(candidates.at(left), some)
                possible = (variants.velocities <= FASTEST_M_S).reshape(-1, len(some)).all(axis=1)
                defeated[left] = possible
                left = left[possible]
                hits = perforated(variants.at(np.repeat(possible, len(some))))
                self._count(len(hits))
                defeated[left] = ~hits.reshape(-1, len(some)).any(axis=1)
                left = left[defeated[left]]
        return defeated

    def _count(self, runs: int) -> None:
        self.runs += runs
        self.on_progress(runs, None)

    def lowest_limits(self, candidates: Candidates) -> Floats:
        """Return the lowest ballistic limits of designs against each threat, m/s, (designs, threats).

        The search extends beyond the range of the section ``ballistic_limit`` to 20 m/s and 10,000 m/s; a limit beyond
        these is set to the nearer one.  Where it reaches the velocity required, velocities are scanned more densely;
        the limit is then that of the lowest change.
        """
        return self._against_all(candidates, self._lowest_limits)

    def quick_limits(self, candidates: Candidates) -> Floats:
        """Return the ballistic limits of designs against each threat, m/s, (designs, threats); NaN for none."""
        section = self.catalogue.scenario.ballistic_limit
        ends = section.velocity_min_m_s, section.velocity_max_m_s

        def limits_of(variants: Variants) -> Floats:
            found = limit_brackets(variants, *ends, section.tolerance_m_s)
            self.on_progress(int(found.runs.sum()), None)
            return np.where(found.bounded, found.perforated, np.nan)

        return self._against_all(candidates, limits_of)

    def _against_all(self, candidates: Candidates, limits_of: Callable[[Variants], Floats]) -> Floats:
        """Return limits of designs against each threat, (designs, threats), of which many rows are searched at once."""
        limits = np.empty((len(candidates.pair), len(self.catalogue.threats)))
        for part in portions(len(limits), max(LIMITS_AT_A_TIME // limits.shape[1], 1)):
            rows = self.catalogue.against_each(candidates.at(part), range(limits.shape[1]))
            limits[part] = limits_of(rows).reshape(-1, limits.shape[1])
        return limits

    def _lowest_limits(self, variants: Variants) -> Floats:
        section = self.catalogue.scenario.ballistic_limit
        slowest = min(section.velocity_min_m_s, SLOWEST_M_S)
        found = self._counted(variants, section.velocity_min_m_s, section.velocity_max_m_s)
        for outside, low, high in (
            (-np.inf, slowest, section.velocity_min_m_s),
            (np.inf, section.velocity_max_m_s, FASTEST_M_S),
        ):
            where = np.flatnonzero(found == outside)
            if len(where) and low < high:
                found[where] = self._counted(variants.at(where), low, high)
        found = found.clip(slowest, FASTEST_M_S)
        where = np.flatnonzero(found >= variants.velocities)
        if len(where):
            lowest = self._counted(variants.at(where), slowest, FASTEST_M_S, DENSE_SCAN_POINTS).clip(slowest)
            # Two limits of one change are within the tolerance of each other.
            missed = lowest < found[where] - section.tolerance_m_s
            found[where[missed]] = lowest[missed]
        return found

    def _counted(self, variants: Variants, low: float, high: float, points: int = SCAN_POINTS) -> Floats:
        """Return lowest limits, m/s; -inf where the lowest velocity perforates, inf where none is seen to."""
        tolerance = variants.settings.ballistic_limit.tolerance_m_s
        found = limit_brackets(variants, low, high, tolerance, points=points)
        self._count(int(found.runs.sum()))
        return np.where(np.isneginf(found.defeated), -np.inf, found.perforated)
