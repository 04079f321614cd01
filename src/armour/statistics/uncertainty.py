"""Propagation of input uncertainty to the outcome and the ballistic limit."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain
from math import log2
from typing import Any

import numpy as np
from scipy.stats import beta, qmc, quantile_test, sobol_indices

from armour.analysis.estimates import CONFIDENCE, Estimate, proportion
from armour.analysis.results import Result
from armour.analysis.searches import ballistic_limits
from armour.analysis.uncertain_inputs import sampled, section_of
from armour.analysis.variants import (
    Floats,
    Ints,
    OnProgress,
    Variants,
    ignore_progress,
    perforated,
    portions,
    variants_of,
)
from armour.errors import NoLimitError
from armour.scenario.applicability import warnings_of
from armour.scenario.distributions import Distribution, Uncertainty
from armour.scenario.loading import Scenario
from armour.scenario.parameters import VELOCITY, inputs_of
from armour.scenario.sampling import columns_of, points_of, quantiles

# Quantiles of the ballistic limit.
QUANTILES = {"V05": 0.05, "V50": 0.5, "V95": 0.95}
# Points of the curve of the probability of perforation.
CURVE_POINTS = 121
# Samples for one set of Sobol' indices: a fraction of those for the probability, within bounds.  More than the most
# would take longer than the probability itself, and give the indices no further digit.
INDEX_DIVISOR, MIN_INDEX_SAMPLES, MAX_INDEX_SAMPLES = 4, 256, 2**16
# Samples that are computed at a time, which bounds the memory.
SAMPLES_AT_A_TIME = 2**12
BOOTSTRAP_RESAMPLES = 499


@dataclass(frozen=True)
class Index:
    """Influence of an input on the ballistic limit."""

    input: str
    # First-order and total Sobol' indices; None where inputs are correlated.
    first: Estimate | None
    total: Estimate | None
    # With the input at the 5 % and the 95 % quantile of its distribution, the others at the scenario's values.
    limits_m_s: tuple[float, float]


@dataclass(frozen=True)
class ProbabilityCurve:
    """Probability of perforation over impact velocity, with pointwise confidence intervals, from low to high."""

    velocity_m_s: tuple[float, ...]
    probability: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True)
class UncertaintyResult(Result):
    """Input uncertainty propagated to the outcome and the ballistic limit.

    Attributes
    ----------
    samples, seed : int
    method : str
        Sampling method.
    confidence : float
        Confidence level of the intervals.
    probability_of_perforation : Estimate
        At the impact velocity, its own distribution included.
    ballistic_limit_m_s : mapping of str to Estimate
        Quantiles of the ballistic limit, m/s: "V05", "V50" and "V95" are the 5 %, 50 % and 95 % quantiles.
    mean_m_s, standard_deviation_m_s : float
        Mean and standard deviation of the ballistic limit, m/s.
    deterministic_m_s : float
        Ballistic limit with the scenario's own values, m/s.
    curve : ProbabilityCurve
    inputs : tuple of Index
        In descending order of influence.
    warnings : tuple of str
        Ways in which the scenario lies outside the validated range.
    """

    samples: int
    seed: int
    method: str
    confidence: float
    probability_of_perforation: Estimate
    ballistic_limit_m_s: Mapping[str, Estimate]
    mean_m_s: float
    standard_deviation_m_s: float
    deterministic_m_s: float
    curve: ProbabilityCurve
    inputs: tuple[Index, ...]
    warnings: tuple[str, ...]


def uncertainty(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> UncertaintyResult:
    """Propagate input uncertainty to the outcome and the ballistic limit.

    Parameters
    ----------
    scenario : Scenario
        Its section ``uncertainty`` gives the distributions of the inputs.
    on_progress : callable, optional
        Called with the number of samples computed since the last call, and the number of all.

    Returns
    -------
    UncertaintyResult

    Raises
    ------
    InputError
        If the section is missing, a distribution reaches values that are not allowed, or a run does not end.
    NoLimitError
        If a sample has no ballistic limit in the range of the search.
    """
    section = section_of(scenario)
    points, own = points_of(section), inputs_of(scenario)
    total = section.samples + index_samples(section) * (len(_ranked(section)) + 2)
    hits, limits = 0, np.empty(section.samples)
    for part in portions(section.samples, SAMPLES_AT_A_TIME):
        columns = columns_of(section, own, points[part])
        samples = sampled(scenario, columns, part.stop - part.start)
        hits += int(perforated(samples).sum())
        limits[part] = sample_limits(samples)
        on_progress(part.stop - part.start, total)
    limits.sort()
    deterministic = float(sample_limits(variants_of(scenario, {}, 1))[0])
    return UncertaintyResult(
        samples=section.samples,
        seed=section.seed,
        method=section.method,
        confidence=CONFIDENCE,
        probability_of_perforation=proportion(hits, section.samples),
        ballistic_limit_m_s={name: quantile(limits, probability) for name, probability in QUANTILES.items()},
        mean_m_s=float(limits.mean()),
        standard_deviation_m_s=float(limits.std(ddof=1)),
        deterministic_m_s=deterministic,
        curve=probability_curve(limits),
        inputs=influence_indices(scenario, section, lambda count: on_progress(count, total)),
        warnings=(*_elsewhere(section, own), *warnings_of(scenario, deterministic)),
    )


def _elsewhere(section: Uncertainty, own: Mapping[str, float]) -> tuple[str, ...]:
    """Return a warning for each distribution that does not contain the scenario's own value, which is not used."""
    return tuple(
        f"uncertainty.{name}: is about a value of its own, not the scenario's {own[name]:g}"
        for name, distribution in section.inputs().items()
        if name in own and not distribution.contains(own[name])
    )


def sample_limits(samples: Variants) -> Floats:
    """Return the ballistic limit of each sample, m/s; every sample must have one in the range of the search."""
    limits = ballistic_limits(samples)
    missing = int(np.isnan(limits).sum())
    if missing:
        search = samples.settings.ballistic_limit
        raise NoLimitError(
            f"no ballistic limit of {missing} of {len(limits)} samples from {search.velocity_min_m_s:g} to "
            f"{search.velocity_max_m_s:g} m/s; widen the range of the section ballistic_limit, or truncate the "
            "distributions"
        )
    return limits


def quantile(ordered: Floats, probability: float) -> Estimate:
    """Estimate a quantile from ordered samples, with a distribution-free confidence interval."""
    interval: Any = quantile_test(ordered, p=probability).confidence_interval(CONFIDENCE)
    return Estimate(float(np.quantile(ordered, probability)), float(interval.low), float(interval.high))


def probability_curve(ordered: Floats) -> ProbabilityCurve:
    """Estimate the probability of perforation over velocity, with Clopper-Pearson intervals, from ordered limits."""
    margin = 0.05 * (ordered[-1] - ordered[0]) + 1.0
    velocities = np.linspace(ordered[0] - margin, ordered[-1] + margin, CURVE_POINTS)
    hits, count = np.searchsorted(ordered, velocities, side="right"), len(ordered)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low = np.where(hits > 0, beta.ppf(tail, np.maximum(hits, 1), count - hits + 1), 0.0)
    high = np.where(hits < count, beta.ppf(1.0 - tail, hits + 1, np.maximum(count - hits, 1)), 1.0)
    return ProbabilityCurve(*(tuple(values.tolist()) for values in (velocities, hits / count, low, high)))


def _ranked(section: Uncertainty) -> dict[str, Distribution]:
    """Return the inputs that have an influence on the ballistic limit; the impact velocity has none."""
    return {name: found for name, found in section.inputs().items() if name != VELOCITY}


def index_samples(section: Uncertainty) -> int:
    """Return the samples of each set for Sobol' indices; 0 where there is nothing to estimate."""
    if section.correlation or len(_ranked(section)) < 2:
        return 0
    part: int = 2 ** int(log2(section.samples // INDEX_DIVISOR))
    return min(max(MIN_INDEX_SAMPLES, part), MAX_INDEX_SAMPLES)


def influence_indices(scenario: Scenario, section: Uncertainty, on_samples: Callable[[int], None]) -> tuple[Index, ...]:
    """Estimate the influence of each input on the ballistic limit."""
    own, distributions = inputs_of(scenario), _ranked(section)
    names = list(distributions)
    if not names:
        return ()

    def limits(columns: Mapping[str, Floats]) -> Floats:
        return sample_limits(sampled(scenario, columns, len(columns[names[0]])))

    def limits_at(points: Floats) -> Floats:
        found = np.empty(points.shape[1])
        for part in portions(len(found), SAMPLES_AT_A_TIME):
            some = points[:, part]
            found[part] = limits(
                {name: quantiles(distributions[name], some[i], own[name]) for i, name in enumerate(names)}
            )
            on_samples(part.stop - part.start)
        return found

    ends = {name: np.full(2 * len(names), own[name]) for name in names}
    for i, (name, distribution) in enumerate(distributions.items()):
        ends[name][2 * i : 2 * i + 2] = quantiles(distribution, np.array([0.05, 0.95]), own[name])
    limits_at_ends = limits(ends).reshape(-1, 2).tolist()
    pairs: list[tuple[Estimate | None, Estimate | None]] = [(None, None)] * len(names)
    if not section.correlation:
        pairs = [*sobol(limits_at, len(names), index_samples(section), section.seed)]
    found = [
        Index(name, *pair, (low, high)) for name, pair, (low, high) in zip(names, pairs, limits_at_ends, strict=True)
    ]
    return tuple(sorted(found, key=_influence, reverse=True))


def _influence(index: Index) -> float:
    """Return the total index or, without one, the difference of the ballistic limits, m/s."""
    low, high = index.limits_m_s
    return abs(high - low) if index.total is None else index.total.value


def sobol(function: Callable[[Floats], Floats], inputs: int, count: int, seed: int) -> list[tuple[Estimate, Estimate]]:
    """Estimate the first-order and total Sobol' index of each input, with bootstrap intervals.

    The function maps points of the unit cube, (inputs, n), to values, (n,); the number of samples is a power of 2.
    """
    if inputs == 1:
        # The one input has all of the variance.
        return [(Estimate(1.0, 1.0, 1.0), Estimate(1.0, 1.0, 1.0))]
    rng = np.random.default_rng(seed)
    both = qmc.Sobol(2 * inputs, rng=rng).random(count).T
    a, b = both[:inputs], both[inputs:]
    mixed = (np.where(np.arange(inputs)[:, None] == i, b, a) for i in range(inputs))
    values = np.array([function(points) for points in chain((a, b), mixed)])

    def indices(rows: Ints | slice) -> Floats:
        v = values[:, None, rows]
        found = sobol_indices(func={"f_A": v[0], "f_B": v[1], "f_AB": v[2:]}, n=count)
        return np.array([np.ravel(found.first_order), np.ravel(found.total_order)])

    best = indices(slice(None))
    resampled = np.array([indices(rng.integers(count, size=count)) for _ in range(BOOTSTRAP_RESAMPLES)])
    low, high = np.quantile(resampled, [0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)], axis=0)
    first, total = np.stack([best, low, high], axis=-1).tolist()
    return [(Estimate(*one), Estimate(*other)) for one, other in zip(first, total, strict=True)]
