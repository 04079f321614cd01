"""Ballistic limits, and velocities stopped with given probabilities, for designs of a pair on a grid of thicknesses."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.results import OnProgress, ignore_progress
from armour.analysis.variants import Floats
from armour.design.catalogue import CandidateDesigns, Catalogue

# Number of thicknesses along an axis that are tried to find where the model error becomes known or unknown; width to
# which such an edge is bisected, mm.
EDGE_POINTS, EDGE_MM = 101, 1e-6


class DesignMap(NamedTuple):
    """Designs of a pair of materials on a grid of thicknesses, (ceramics, back plates), against each threat."""

    pair: int
    ceramic_mm: Floats
    backing_mm: Floats
    candidates: CandidateDesigns  # the ceramics in turn, each on every back plate
    limits_m_s: Floats  # lowest ballistic limits by the model, (ceramics, back plates, threats)
    probabilities: tuple[float, ...]
    # Velocities that are stopped with each of the probabilities, however far the design is from the tests, m/s,
    # (ceramics, back plates, threats, probabilities); NaN if the model error is not known.
    untruncated_m_s: Floats
    # Greatest probabilities of stopping that may be stated so far from the tests, (ceramics, back plates, threats).
    greatest_probability: Floats

    @property
    def stopped_m_s(self) -> Floats:
        """Velocities as in `untruncated_m_s`, but NaN too far from the tests to state the probability."""
        return np.where(self.greatest_probability[..., None] >= self.probabilities, self.untruncated_m_s, np.nan)

    def stopped_with(self, probability: float) -> Floats:
        """Return `stopped_m_s` for one of the `probabilities`, (ceramics, back plates, threats)."""
        return np.asarray(self.stopped_m_s[..., self.probabilities.index(probability)])


def design_map(
    catalogue: Catalogue,
    pair: int,
    ceramic_mm: Sequence[float] | Floats,
    backing_mm: Sequence[float] | Floats,
    probabilities: tuple[float, ...],
    on_progress: OnProgress = ignore_progress,
) -> DesignMap:
    """Compute ballistic limits, and velocities stopped with given probabilities, for all combinations of thicknesses.

    `pair` is the index of a pair in the catalogue; the thicknesses of its layers are in mm.
    """
    ceramics, backings = np.array(ceramic_mm, dtype=np.float64), np.array(backing_mm, dtype=np.float64)
    shape = len(ceramics), len(backings), len(catalogue.threats)
    candidates = catalogue.combinations(pair, ceramics, backings)
    rows = catalogue.against_each(candidates)
    limits = rows.limits_anywhere(on_progress)
    # The velocity of shots that are stopped with a probability p is the quantile at 1 - p.
    tails = 1.0 - np.array(probabilities)
    untruncated_m_s = rows.shot_distributions(limits).quantile(tails[None]).reshape(*shape, len(tails))
    grid = pair, ceramics, backings, candidates
    return DesignMap(*grid, limits.reshape(shape), probabilities, untruncated_m_s, rows.errors.greatest.reshape(shape))


def with_known_edges(catalogue: Catalogue, pair: int, ceramic_mm: Floats, backing_mm: Floats) -> tuple[Floats, Floats]:
    """Return the axes of a grid, mm, with points added on both sides of where the model error becomes known or unknown.

    A map then shows these edges where they are.  The given thicknesses, `ceramic_mm` and `backing_mm`, rise.
    """
    grids = [ceramic_mm, backing_mm]
    scans = [np.linspace(mm[0], mm[-1], EDGE_POINTS) if len(mm) > 1 else mm for mm in grids]

    def is_known(*thicknesses: Any) -> Any:
        """Return whether the model error is known, or left out, against all threats; two arrays, mm, broadcast."""
        ceramics, backings = np.broadcast_arrays(*map(np.atleast_1d, thicknesses))
        known = catalogue.against_each(catalogue.candidates(pair, ceramics.ravel(), backings.ravel())).errors.known
        return known.reshape(*ceramics.shape, -1).all(axis=-1) | catalogue.scenario.excludes_error()

    tested = is_known(scans[0][:, None], scans[1][None])
    for axis, values in enumerate(scans):
        changes = np.diff(tested.astype(int), axis=axis).astype(bool)
        for place in np.flatnonzero(changes.any(axis=1 - axis)):
            other_place = int(np.argmax(np.moveaxis(changes, axis, 0)[place]))
            low, high = values[place : place + 2]
            while high - low > EDGE_MM:
                middle = 0.5 * (low + high)
                at = (middle, scans[1][other_place]) if axis == 0 else (scans[0][other_place], middle)
                is_as_low = is_known(*at)[0] == np.moveaxis(tested, axis, 0)[place, other_place]
                low, high = (middle, high) if is_as_low else (low, middle)
            grids[axis] = np.union1d(grids[axis], [low, high])
    return grids[0], grids[1]
