"""Probability that an armour is perforated, over its uncertain inputs and the model error."""

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np

from armour.analysis.estimates import Estimate, mean_of_replicates, proportion_of_replicates
from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.samples import (
    REPLICATES,
    by_laws,
    columns_of,
    own_errors,
    own_values,
    points_of,
    sampled,
    section_at,
)
from armour.analysis.variants import Floats, Variants, limits_anywhere, perforated
from armour.errors import Note
from armour.evidence.model_error import ErrorRows
from armour.scenario.inputs import CERAMIC
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Distribution, Uncertainty

# Samples of each replicate at first, and the factor by which they grow until the estimate decides.
FIRST_SAMPLES, GROWTH = 1, 4
# Half the width of an interval that needs no more samples, and how many half widths away from a bound decide before.
PRECISE, CLEARLY = 5e-4, 3.0
# Samples computed at a time, to bound the memory.
SAMPLES_OF_ONE_PASS = 2**12


def probability_of_perforation(
    scenario: Scenario,
    bound: float | None = None,
    layers: Mapping[str, float] | None = None,
    points: Floats | None = None,
    on_progress: OnProgress = ignore_progress,
    *,
    quick: bool = False,
) -> Estimate:
    """Estimate the probability that the armour of a scenario is perforated, with its 95 % interval.

    The inputs are sampled.  The model error, if it is known, is integrated for each sample: few are needed then.  They
    are added until the interval is narrow and does not contain the bound.

    Parameters
    ----------
    scenario : Scenario
        Its section ``uncertainty`` gives the distributions and the greatest number of samples.
    bound : float, optional
        Greatest probability that is allowed.
    layers : mapping of str to float, optional
        Thicknesses of the layers, mm, by name of input, in place of the scenario's.
    points : array, (samples, inputs), optional
        Points of `points_within`, where they have been made already.
    on_progress : callable, optional
        Called with the number of samples computed since the last call, and None, as their total is not known.
    quick : bool, default False
        Whether an estimate that is far from the bound need not be narrow.
    """
    layers = dict(layers or {})
    values, errors = own_values(scenario) | layers, own_errors(scenario, layers)
    is_known = bool(errors.known.all())
    section_at(scenario, values, with_error=is_known)  # checks the distributions
    section = scenario.uncertainty or Uncertainty()
    replicates = np.array_split(points_within(section) if points is None else points, REPLICATES)
    chances = [np.empty(0)] * REPLICATES
    while True:
        start = len(chances[0])
        parts = [part[start : max(FIRST_SAMPLES, GROWTH * start)] for part in replicates]
        count = sum(map(len, parts))
        columns = columns_of(section, values, np.concatenate(parts))
        if layers.get(CERAMIC) == 0.0:
            columns.pop(CERAMIC, None)  # an absent layer has no thickness to vary
        rows = sampled(scenario, {**{key: np.full(count, mm) for key, mm in layers.items()}, **columns}, count).variants
        added = [_chances(rows.at(part), errors) for part in portions(count, SAMPLES_OF_ONE_PASS)]
        on_progress(count, None)
        ends = np.cumsum([len(part) for part in parts])[:-1]
        added = np.split(np.concatenate(added), ends)
        chances = [np.append(*each) for each in zip(chances, added, strict=True)]
        estimate = _estimate(chances, is_smooth=is_known)
        if len(chances[0]) == len(replicates[0]) or _decides(estimate, bound, quick=quick):
            return estimate


def is_sampled(scenario: Scenario, layers: Mapping[str, float] | None = None) -> bool:
    """Return whether samples tell how probable perforation is: the model error is known or excluded."""
    return scenario.excludes_error() or bool(own_errors(scenario, layers).known.all())


def points_within(section: Uncertainty) -> Floats:
    """Return the points of the unit cube at which a section is sampled, (samples, inputs)."""
    return points_of(section) if section.inputs() else np.empty((section.samples, 0))


def misplaced(distributions: Mapping[str, Distribution], scenario: Scenario, answer: Scenario) -> tuple[Note, ...]:
    """Return a warning for each distribution of a scenario that is about a value other than that of one made of it."""
    scenario_values, values = scenario.inputs(), answer.inputs()
    notes = []
    for name in filter(values.__contains__, distributions):
        distribution, value = distributions[name], values[name]
        if (distribution.placed and scenario_values.get(name) != value) or not distribution.contains(value):
            words = f"is given for a value other than {value:g}, which the armour and threat reported have"
            notes.append(Note(f"{words}; inputs are taken as exact in their probability", f"uncertainty.{name}"))
    return tuple(notes)


def _chances(rows: Variants, errors: ErrorRows) -> Floats:
    """Return the probabilities that samples are perforated, (n,), given the error of their armour; 0 or 1 without."""
    if not errors.known.all():
        return perforated(rows).astype(np.float64)
    stopping = np.zeros(len(rows.velocities))
    for law, [weight] in enumerate(errors.ratio.weights.tolist()):
        if weight > 0.0:
            limits = limits_anywhere(by_laws(rows, errors, np.full(len(stopping), law)))
            stopping += weight * errors.of_law(law).times(limits).probability_above(rows.velocities)
    return 1.0 - stopping


def _estimate(chances: Sequence[Floats], *, is_smooth: bool) -> Estimate:
    """Estimate the mean of chances in replicates: of probabilities, if they are smooth, or else of hits."""
    if not is_smooth:
        return proportion_of_replicates([int(part.sum()) for part in chances], [len(part) for part in chances])
    mean = mean_of_replicates(np.array([part.mean() for part in chances]))
    return Estimate(*(min(max(end, 0.0), 1.0) for end in (mean.value, mean.low, mean.high)))


def _decides(estimate: Estimate, bound: float | None, *, quick: bool) -> bool:
    """Return whether an estimate needs no more samples."""
    half = max(estimate.high - estimate.value, estimate.value - estimate.low)
    away = inf if bound is None else abs(estimate.value - bound)
    return (half <= PRECISE and away > half) or (quick and away > CLEARLY * half)
