"""Propagation of input uncertainty to the outcome and the ballistic limit, and Sobol' indices of its inputs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import log2
from typing import Any

import numpy as np
from numpy.polynomial.hermite_e import hermevander
from numpy.polynomial.legendre import legvander
from scipy.special import ndtri

from armour.analysis import samples as sampling
from armour.analysis.ballistic_limit import model_error
from armour.analysis.estimates import CONFIDENCE, Estimate, jackknife, mean_of_replicates, proportion_of_replicates
from armour.analysis.results import OnProgress, TableResult, ignore_progress, portions
from armour.analysis.samples import Samples, columns_of, sampled
from armour.analysis.variants import Bools, Floats, ballistic_limits
from armour.errors import NoLimitError, Note
from armour.evidence.model_error import ErrorRows, ModelError
from armour.evidence.tests import scenario_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import ERROR, VELOCITY
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Uncertainty

# Degree of the polynomials of one input.
DEGREE = 8
# Probability of each tail of the model error that its indices leave out: the logarithm has Student's t distribution, so
# with the whole tails the variance would be infinite.
LEFT_OUT_TAIL = 1e-4
# Probabilities whose quantiles give the moments of the model error between its tails.
SHARE_CHANCES = LEFT_OUT_TAIL + (1.0 - 2.0 * LEFT_OUT_TAIL) * (np.arange(100_000) + 0.5) / 100_000


def first_order_indices(section: Uncertainty, points: Floats, values: Floats) -> list[Estimate]:
    """Estimate the first-order Sobol' index of each input, correlated or not.

    `points`, (n, inputs), are in the unit cube, and `values`, (n,), are the results at them.  The index of an input is
    the share of the variance of the results that a polynomial of the input's score explains.  The score is uniform for
    a uniform distribution and normal for any other one, so that the results are nearly linear in it.
    """
    uniform = [distribution.distribution == "uniform" for distribution in section.inputs().values()]
    scaled_values = (values - values.mean()) / values.std()
    replicates = zip(
        np.array_split(points, sampling.REPLICATES), np.array_split(scaled_values, sampling.REPLICATES), strict=True
    )
    moments = [
        [_moments(*column, scaled) for column in zip(sampling.correlated(section, part).T, uniform, strict=True)]
        for part, scaled in replicates
    ]
    return [jackknife(_explained, by_replicate) for by_replicate in np.array(moments).swapaxes(0, 1)]


def _moments(chances: Floats, uniform: bool, values: Floats) -> Floats:
    """Return the moments, (DEGREE + 2, DEGREE + 2), of the polynomials of an input's score and, last, of the value.

    A moment is a sum of products of two of them over n samples.  `chances`, (n,), are the probabilities of the input.
    """
    polynomials = legvander(2.0 * chances - 1.0, DEGREE) if uniform else hermevander(ndtri(chances), DEGREE)
    columns = np.column_stack([polynomials, values])
    return columns.T @ columns


def _explained(moments: Floats) -> Floats:
    """Return the share of the variance that a regression on the polynomials explains, (m,), given m sets of moments."""
    basis, products, squares = moments[:, :-1, :-1], moments[:, :-1, -1], moments[:, -1, -1]
    fitted = np.einsum("ni,ni->n", products, np.linalg.solve(basis, products[..., None])[..., 0])
    mean = products[:, 0] ** 2 / basis[:, 0, 0]
    return (fitted - mean) / (squares - mean)


def total_indices(
    function: Callable[[Floats], Floats], places: Sequence[int], inputs: int, samples: int, seed: int
) -> list[Estimate]:
    """Estimate the total Sobol' index of each input at the indices `places` by the estimator of [Jansen1999].

    The inputs are independent.  `function` maps points in the unit cube, (n, inputs), to values, (n,); `inputs` is the
    number of inputs, and `samples` that of samples, a power of 2.
    """
    points, resampled = np.split(sampling.replicated_points("sobol", 2 * inputs, samples, seed), 2, axis=1)
    values = function(points)
    sums = [_sums(values**0), _sums(values - values[0]), _sums((values - values[0]) ** 2)]
    indices = []
    for place in places:
        mixed = points.copy()
        mixed[:, place] = resampled[:, place]
        changes = _sums(0.5 * (function(mixed) - values) ** 2)
        indices.append(jackknife(_changed, np.column_stack([*sums, changes])))
    return indices


def _changed(sums: Floats) -> Floats:
    """Return total indices, (m,), given sums, (m, 4): of 1, values, their squares, and half their squared changes."""
    count, values, squares, changes = sums.T
    return changes / (squares - values**2 / count)


def _sums(values: Floats) -> Floats:
    """Return the sum of values, (n,), over each replicate, (replicates,)."""
    return np.array([part.sum() for part in np.array_split(values, sampling.REPLICATES)])


# Quantiles of the ballistic limit.
V_P = {"V05": 0.05, "V50": 0.5, "V95": 0.95}
# Probabilities of the quantiles between which an input is varied alone.
ENDS = (0.05, 0.95)
# Points of the curve of the probability of perforation.
PROBABILITY_POINTS = 121
# Samples computed at a time, to bound the memory.
SAMPLES_AT_A_TIME = 2**12

ERROR_UNKNOWN = Note("the model error is not known for such an armour, and not included", "uncertainty.model")


@dataclass(frozen=True)
class Influence:
    """Influence of an input on the ballistic limit.

    Attributes
    ----------
    input : str
        Name of the input, such as ``"ceramic.flow_stress_GPa"``.
    first : Estimate or None
        First-order Sobol' index: the share of the variance of the ballistic limit, 0 to 1, explained by the input
        alone. None if the ballistic limit does not vary.
    total : Estimate or None
        Total Sobol' index, interactions included. None if the ballistic limit does not vary, and where inputs are
        correlated.
    limits_m_s : tuple of float
        Ballistic limits, m/s, with the input at the 5 % and the 95 % quantile of its distribution and the others at
        the scenario's values.
    """

    input: str
    first: Estimate | None
    total: Estimate | None
    limits_m_s: tuple[float, float]


@dataclass(frozen=True)
class ProbabilityCurve:
    """Probability of perforation over impact velocity.

    Attributes
    ----------
    velocity_m_s : tuple of float
        Impact velocities, m/s.
    probability : tuple of float
        Probability of perforation, 0 to 1, at each velocity.
    low, high : tuple of float
        Ends of its pointwise confidence interval.
    """

    velocity_m_s: tuple[float, ...]
    probability: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, repr=False)
class UncertaintyResult(TableResult):
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
    mean_interval_m_s : tuple of float
        Confidence interval of the mean, m/s.
    deterministic_m_s : float
        Ballistic limit with the scenario's own values, m/s.
    curve : ProbabilityCurve
    inputs : tuple of Influence
        In descending order of influence.
    model_error : ModelError or None
        Model error, which is one of the inputs; None if it is not known or not included.
    notes : tuple of Note
        Distributions that do not contain the scenario's values, and ways in which the scenario lies outside the
        validated range.
    """

    samples: int
    seed: int
    method: str
    confidence: float
    probability_of_perforation: Estimate
    ballistic_limit_m_s: Mapping[str, Estimate]
    mean_m_s: float
    mean_interval_m_s: tuple[float, float]
    standard_deviation_m_s: float
    deterministic_m_s: float
    curve: ProbabilityCurve
    inputs: tuple[Influence, ...]
    notes: tuple[Note, ...]
    model_error: ModelError | None = None

    def _columns(self) -> dict[str, Any]:
        return asdict(self.curve)


@checked
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
    section = sampling.section_of(scenario)
    points = sampling.points_of(section)
    ranked = _ranked(section)
    total = section.samples + index_samples(section) * (len([name for name in ranked if name != ERROR]) + 1)
    if ERROR in ranked and len(ranked) > 1:
        total += _index_size(section) * len(_laws(sampling.own_errors(scenario)))

    def on_samples(count: int) -> None:
        on_progress(count, total)

    limits = np.concatenate([sample_limits(samples) for samples in _in_portions(scenario, points, on_samples)])
    exact = sampled(scenario, {}, 1)
    deterministic = float(sample_limits(exact)[0])
    error = model_error(exact.variants, deterministic)
    mean = mean_of_replicates(np.array([part.mean() for part in np.array_split(limits, sampling.REPLICATES)]))
    return UncertaintyResult(
        samples=section.samples,
        seed=section.seed,
        method=section.method,
        confidence=CONFIDENCE,
        probability_of_perforation=sampling.probability_of_perforation(scenario),
        ballistic_limit_m_s={name: quantile(limits, probability) for name, probability in V_P.items()},
        mean_m_s=mean.value,
        mean_interval_m_s=(mean.low, mean.high),
        # Exactly 0 if all limits are equal, although their mean may be rounded.
        standard_deviation_m_s=float((limits - limits[0]).std(ddof=1)),
        deterministic_m_s=deterministic,
        curve=probability_curve(limits),
        inputs=influences(scenario, points, limits, error, on_samples),
        notes=(
            *_misplaced(section, scenario.inputs()),
            *([] if error or scenario.excludes_error() else [ERROR_UNKNOWN]),
            *scenario_warnings(scenario, deterministic, "ballistic_limit"),
        ),
        model_error=error,
    ).of(scenario.subject(), scenario=scenario)


def _misplaced(section: Uncertainty, values: Mapping[str, float]) -> Iterator[Note]:
    """Yield a warning for each distribution without the scenario's value, or with a mean that truncation moves."""
    for name, distribution in section.inputs().items():
        if name in values:
            if not distribution.contains(values[name]):
                yield Note(f"does not contain the scenario's value, {values[name]:g}", f"uncertainty.{name}")
            if means := sampling.moved_mean(distribution, values[name]):
                yield Note(f"truncation moves its mean from {means[0]:g} to {means[1]:.4g}", f"uncertainty.{name}")


def _in_portions(
    scenario: Scenario, points: Floats, on_samples: Callable[[int], None], *, with_error: bool = True
) -> Iterator[Samples]:
    """Yield the samples at points in the unit cube, (n, inputs), in portions.

    `on_samples` is called with the number of samples in each portion after this is computed.  Without `with_error`, the
    samples have no model error.
    """
    section, values = sampling.section_of(scenario), sampling.own_values(scenario)
    for portion in portions(len(points), SAMPLES_AT_A_TIME):
        columns, count = columns_of(section, values, points[portion]), portion.stop - portion.start
        if not with_error:
            del columns[ERROR]
        yield sampled(scenario, columns, count)
        on_samples(count)


def sample_limits(samples: Samples) -> Floats:
    """Return the ballistic limit of each sample, m/s; every sample must have one in the range of the search."""
    limits: Floats = ballistic_limits(samples.variants) * samples.factor
    if np.isinf(limits).any():
        search = samples.variants.scenario.ballistic_limit
        raise NoLimitError(
            f"no ballistic limit of some samples from {search.velocity_min_m_s:g} to {search.velocity_max_m_s:g} m/s; "
            "widen the range of the section ballistic_limit, or truncate the distributions"
        )
    return limits


def _share(hits: Bools) -> Estimate:
    """Estimate the probability of a hit from replicates; `hits`, (samples,), tells which samples are hits."""
    parts = np.array_split(hits, sampling.REPLICATES)
    return proportion_of_replicates([int(part.sum()) for part in parts], [len(part) for part in parts])


def quantile(limits: Floats, probability: float) -> Estimate:
    """Estimate the quantile of `limits`, (samples,), at a probability, with the interval of Woodruff.

    The probability of limits up to the quantile is estimated first: unlike a quantile, it has no bias in small
    replicates.  The quantiles at the ends of its interval are the ends of the interval of the quantile.
    """
    value = float(np.quantile(limits, probability))
    below = _share(limits <= value)
    ends = np.array([below.low, below.high]) - below.value + probability
    low, high = np.quantile(limits, np.clip(ends, 0.0, 1.0)).tolist()
    return Estimate(value, low, high)


def probability_curve(limits: Floats) -> ProbabilityCurve:
    """Estimate the probability of perforation over velocity, with pointwise intervals, from limits, m/s, (samples,)."""
    lowest, highest = limits.min(), limits.max()
    margin = 0.05 * (highest - lowest) + 1.0
    velocities = np.linspace(lowest - margin, highest + margin, PROBABILITY_POINTS)
    estimates = [_share(limits <= velocity) for velocity in velocities]
    rows = ([getattr(estimate, key) for estimate in estimates] for key in ("value", "low", "high"))
    return ProbabilityCurve(tuple(velocities.tolist()), *map(tuple, rows))


def _ranked(section: Uncertainty) -> list[str]:
    """Return the inputs that influence the ballistic limit: all but the impact velocity."""
    return [name for name in section.inputs() if name != VELOCITY]


def index_samples(section: Uncertainty) -> int:
    """Return the number of samples in each set for total indices; 0 if these are not estimated."""
    return 0 if section.correlation or len(_ranked(section)) < 2 else _index_size(section)


def _index_size(section: Uncertainty) -> int:
    """Return the number of samples in a set for indices: a power of 2, up to a quarter of those for the probability.

    It is 256 at least and 65,536 at most: more samples would give no further digit of the indices.
    """
    fraction: int = 2 ** int(log2(section.samples // 4))
    return min(max(256, fraction), 2**16)


def influences(
    scenario: Scenario, points: Floats, limits: Floats, error: ModelError | None, on_samples: Callable[[int], None]
) -> tuple[Influence, ...]:
    """Estimate the influence of each input on the ballistic limit.

    `limits`, m/s, (n,), are those at `points` in the unit cube, (n, inputs).  Further samples are computed for the
    total indices, and limits without the model error for the indices of this error.
    """
    section, values = sampling.section_of(scenario), sampling.own_values(scenario)
    names, inputs = _ranked(section), list(section.inputs())
    if not names:
        return ()

    def limits_at(points: Floats) -> Floats:
        return np.concatenate([sample_limits(samples) for samples in _in_portions(scenario, points, on_samples)])

    varied = [name for name in names if name != ERROR]
    values_at_ends = {name: np.full(2 * len(varied), values[name]) for name in varied}
    for i, name in enumerate(varied):
        values_at_ends[name][2 * i : 2 * i + 2] = sampling.quantiles(section.inputs()[name], ENDS, values[name])
    pairs = sample_limits(sampled(scenario, values_at_ends, 2 * len(varied))).reshape(-1, 2).tolist()
    limits_at_ends = {name: (float(low), float(high)) for name, (low, high) in zip(varied, pairs, strict=True)}
    if error is not None:
        [nominal] = sample_limits(sampled(scenario, {}, 1))
        limits_at_ends[ERROR] = error.interval(nominal, ENDS[0])
    first: dict[str, Estimate] = {}
    total: dict[str, Estimate] = {}
    if len(names) == 1:
        # The only input explains all of the variance.
        first = total = {names[0]: Estimate(1.0, 1.0, 1.0)}
    elif np.ptp(limits) > 0.0:
        first = dict(zip(inputs, first_order_indices(section, points, limits), strict=True))
        if not section.correlation:
            places = [inputs.index(name) for name in varied]
            totals = total_indices(limits_at, places, len(inputs), index_samples(section), section.seed)
            total = dict(zip(varied, totals, strict=True))
        if error is not None:
            first[ERROR], total_of_error = error_indices(scenario, section, on_samples)
            if not section.correlation:
                total[ERROR] = total_of_error
    total = {name: _at_least(first[name], estimate) for name, estimate in total.items()}
    result = [Influence(name, first.get(name), total.get(name), limits_at_ends[name]) for name in names]
    none = Estimate(0.0, 0.0, 0.0)
    return tuple(sorted(result, key=lambda influence: (influence.total or influence.first or none).value, reverse=True))


def _at_least(first: Estimate, total: Estimate) -> Estimate:
    """Return a total index and its interval, each number raised to at least that of the first-order index."""
    ends = zip((first.value, first.low, first.high), (total.value, total.low, total.high), strict=True)
    return Estimate(*map(max, ends))


def _laws(errors: ErrorRows) -> list[int]:
    """Return the indices of the laws of the flow stress of which the model error of an armour is a mixture."""
    return np.flatnonzero((errors.ratio.weights > 0.0).all(axis=1)).tolist()


def error_indices(
    scenario: Scenario, section: Uncertainty, on_samples: Callable[[int], None]
) -> tuple[Estimate, Estimate]:
    """Return the first-order and the total index of the model error.

    The armour's ballistic limit is the model's limit, by one law of the flow stress, times an independent ratio.  The
    moments of the ratio are known; only those of the model's limits by each law are estimated.
    """
    errors = sampling.own_errors(scenario)
    means, squares = _ratio_moments(errors)
    points = sampling.replicated_points("sobol", len(section.inputs()), _index_size(section), section.seed)
    limits = np.zeros((len(means), len(points)))
    for law in _laws(errors):
        samples = _in_portions(scenario, points, on_samples, with_error=False)
        variants = (sampling.by_laws(s.variants, errors, np.full(len(s.variants.velocities), law)) for s in samples)
        limits[law] = np.concatenate([sample_limits(Samples(rows, 1.0)) for rows in variants])
    parts = np.array_split(limits, sampling.REPLICATES, axis=1)
    sums = np.array(
        [[part.shape[1], *part.sum(axis=1), *(part**2).sum(axis=1), ((means @ part) ** 2).sum()] for part in parts]
    )

    def shares(sums: Floats) -> tuple[Floats, Floats]:
        """Return the share of the variance that the error explains alone, and the share left if all else is known."""
        count, by_law, squared, mean_squared = np.split(sums, np.cumsum([1, len(means), len(means)]), axis=1)
        mean, mean_square = by_law @ means / count[:, 0], squared @ squares / count[:, 0]
        variance = mean_square - mean**2
        by_error = (by_law / count) ** 2 @ squares - mean**2
        return by_error / variance, (mean_square - mean_squared[:, 0] / count[:, 0]) / variance

    return jackknife(lambda sums: shares(sums)[0], sums), jackknife(lambda sums: shares(sums)[1], sums)


def _ratio_moments(errors: ErrorRows) -> Floats:
    """Return the probability of each law times the mean of its ratio, and times the mean square, (2, laws).

    A ratio is that of the armour's limit to the model's; its tails are left out.
    """
    moments = np.zeros((2, len(errors.ratio.weights)))
    for law in _laws(errors):
        ratios = errors.of_law(law).one().quantile(SHARE_CHANCES)
        moments[:, law] = errors.ratio.weights[law].sum() * np.array([ratios.mean(), (ratios**2).mean()])
    return moments
