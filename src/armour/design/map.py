"""Ballistic limits of the designs of a pair of materials over both thicknesses, and how surely they are reached."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates

from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.variants import Floats
from armour.design.catalogue import Candidates, Catalogue
from armour.design.optimise import Design
from armour.design.search import Requirement
from armour.evidence.model_error import given_error

# Interpolation between the nodes of a map of 25 by 25 designs is right to within this, m/s.
NEAR_M_S = 25.0
# Designs that are tried at a time until one stops the threats.
TRIED_AT_A_TIME = 64


class DesignMap(NamedTuple):
    """Designs of a pair of materials on a grid of thicknesses, (ceramics, back plates), against each threat."""

    pair: int
    ceramic_mm: Floats
    backing_mm: Floats
    candidates: Candidates  # the ceramics in turn, each on every back plate
    limits_m_s: Floats  # lowest ballistic limits by the model, (ceramics, back plates, threats)
    probabilities: tuple[float, ...]
    # Velocities that are stopped with each of the probabilities, (ceramics, back plates, threats, probabilities), NaN
    # if the model error is not known.
    stopped_m_s: Floats

    def on_grid(self, values: Floats) -> Floats:
        """Return a quantity of the candidates, (ceramics, back plates)."""
        return values.reshape(len(self.ceramic_mm), len(self.backing_mm))

    def stopped_with(self, probability: float) -> Floats:
        """Return velocities that are stopped with one of the probabilities, m/s, (ceramics, back plates, threats)."""
        return np.asarray(self.stopped_m_s[..., self.probabilities.index(probability)])


def design_map(
    catalogue: Catalogue,
    pair: int,
    ceramic_mm: Sequence[float] | Floats,
    backing_mm: Sequence[float] | Floats,
    probabilities: tuple[float, ...],
    on_progress: OnProgress = ignore_progress,
) -> DesignMap:
    """Compute the designs of a pair of materials with all combinations of some thicknesses, mm."""
    ceramics, backings = np.array(ceramic_mm, dtype=np.float64), np.array(backing_mm, dtype=np.float64)
    shape = len(ceramics), len(backings), len(catalogue.threats)
    candidates = catalogue.combinations(pair, ceramics, backings)
    limits = _limits(Requirement(catalogue, on_progress), candidates)
    # A velocity that is stopped with a probability is the quantile of the limit at its complement.
    tails = 1.0 - np.array(probabilities)
    distributions = catalogue.distributions(candidates, limits)
    known = np.flatnonzero(~np.isnan(distributions.weights).any(axis=0))
    stopped = np.full((limits.size, len(tails)), np.nan)
    stopped[known] = distributions.mapped(lambda array: array[:, known]).quantile(tails[None])
    by_probability = stopped.reshape(*shape, len(tails))
    return DesignMap(pair, ceramics, backings, candidates, limits.reshape(shape), probabilities, by_probability)


def _limits(requirement: Requirement, candidates: Candidates) -> Floats:
    """Return the ballistic limits of designs, also outside the range searched, m/s, (designs, threats)."""
    limits = requirement.quick_limits(candidates)
    outside = np.flatnonzero(np.isnan(limits).any(axis=1))
    limits[outside] = requirement.lowest_limits(candidates.at(outside))
    return limits


def lightest(catalogue: Catalogue, near: DesignMap, probability: float) -> Design | None:
    """Return the best design on offer of a pair that stops each threat with a probability; None if there is none.

    No margin is asked for, and the inputs are taken as exact.  Designs are tried that a map of the pair shows to be
    near the probability or above; if any thickness is on offer, there is none.
    """
    layers = catalogue.offers[near.pair][:2]
    if any(layer.free_range() for layer in layers):
        return None
    offered = catalogue.combinations(near.pair, *(layer.thicknesses() for layer in layers))
    offered = offered.at(catalogue.violations(offered) <= 0.0)
    offered = offered.at(catalogue.objective(offered).argsort(kind="stable"))
    above = (near.stopped_with(probability) - catalogue.velocities_m_s).min(axis=-1)
    axes = (offered.ceramic_mm, near.ceramic_mm), (offered.backing_mm, near.backing_mm)
    places = [np.interp(values, nodes, np.arange(len(nodes))) for values, nodes in axes]
    guess = map_coordinates(above, places, order=1, mode="nearest")
    tried = offered.at(guess > -NEAR_M_S)
    for some in portions(len(tried.pair), TRIED_AT_A_TIME):
        candidates = tried.at(some)
        limits = _limits(Requirement(catalogue), candidates)
        distributions = catalogue.distributions(candidates, limits)
        chances = distributions.probability_above(np.tile(catalogue.velocities_m_s, len(candidates.pair)))
        stopping = np.flatnonzero((chances.reshape(limits.shape) >= probability).all(axis=1))
        if len(stopping):
            numbers: list[Any] = [*(float(column[stopping[0]]) for column in candidates[1:]), None]
            return Design(layers[0].material, layers[1].material, *numbers)
    return None


def thicknesses_tested(catalogue: Catalogue, pair: int, threat: int) -> dict[str, tuple[float, float]]:
    """Return the thicknesses, mm, of the tests that the model error is estimated from; none if it is not known.

    The keys are "ceramic" and "backing".
    """
    offer = catalogue.offers[pair]
    middle = [np.array([np.mean(layer.thicknesses())]) for layer in offer[:2]]
    rows, *_ = catalogue.against_each(catalogue.candidates(pair, *middle), [threat])
    [(evidence, _)] = rows.armours.by_evidence()
    if given_error(catalogue.scenario) or not rows.errors.known.all():
        return {}
    of = float(rows.armours.quantities()["rod_diameter_mm"][0] * rows.cosines[0])
    names = {"ceramic_thickness_ratio": "ceramic", "backing_thickness_ratio": "backing"}
    return {names[x.name]: (x.low * of, x.high * of) for x in evidence.measured if x.name in names}
