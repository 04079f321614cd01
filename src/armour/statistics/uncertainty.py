"""Propagation of input uncertainty to the outcome and the ballistic limit, and the effect of each input."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from armour.analysis import samples as sampling
from armour.analysis.ballistic_limit import model_error
from armour.analysis.estimates import CONFIDENCE, Estimate, mean_of_replicates, proportion_of_replicates
from armour.analysis.results import OnProgress, TableResult, ignore_progress, portions
from armour.analysis.samples import Samples, columns_of, sampled
from armour.analysis.variants import Bools, Floats, ballistic_limits
from armour.errors import NoLimitError, Note
from armour.evidence.model_error import ModelError
from armour.evidence.tests import scenario_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import ERROR, VELOCITY
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Uncertainty

# Probabilities of the quantiles of the ballistic limit that are given.
QUANTILES = (0.05, 0.5, 0.95)
# Probabilities of the quantiles between which an input is varied alone.
ENDS = (0.05, 0.95)
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
    limits_m_s : tuple of float
        Ballistic limits, m/s, with the input at the 5 % and the 95 % quantile of its distribution and the others at
        the scenario's values.
    """

    input: str
    limits_m_s: tuple[float, float]


@dataclass(frozen=True)
class ProbabilityCurve:
    """Probability of perforation over impact velocity.

    Attributes
    ----------
    velocity_m_s : tuple of float
        Impact velocities, m/s.
    probability : tuple of float or None
        Probability that a shot perforates, 0 to 1, at each velocity; None if it is not known.
    by_distributions : tuple of float or None
        If it is not known, the share of the samples that the model perforates, by the given distributions alone.
    low, high : tuple of float
        Ends of the pointwise confidence interval of the one that is given.
    """

    velocity_m_s: tuple[float, ...]
    probability: tuple[float, ...] | None
    by_distributions: tuple[float, ...] | None
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, repr=False)
class UncertaintyResult(TableResult):
    """Input uncertainty propagated to the outcome and the ballistic limit.

    Attributes
    ----------
    samples, seed : int
    confidence : float
        Confidence level of the intervals.
    probability_of_perforation : Estimate or None
        Of a shot at the impact velocity, its own distribution included; None if it is not known.
    limit_quantiles_m_s : mapping of str to Estimate
        Quantiles of the ballistic limit, m/s, by probability: "0.05", "0.5" and "0.95".
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
    perforated_by_distributions : Estimate or None
        If the probability is not known, the share of the samples that the model perforates, by the given distributions
        alone.
    notes : tuple of Note
        Distributions that do not contain the scenario's values, and ways in which the scenario lies outside the
        validated range.
    """

    samples: int
    seed: int
    confidence: float
    probability_of_perforation: Estimate | None
    limit_quantiles_m_s: Mapping[str, Estimate]
    mean_m_s: float
    mean_interval_m_s: tuple[float, float]
    standard_deviation_m_s: float
    deterministic_m_s: float
    curve: ProbabilityCurve
    inputs: tuple[Influence, ...]
    notes: tuple[Note, ...]
    model_error: ModelError | None = None
    perforated_by_distributions: Estimate | None = None

    def _columns(self) -> dict[str, Any]:
        """Return the columns of the table: the curve of the probability over velocity."""
        return {name: column for name, column in asdict(self.curve).items() if column is not None}


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
    limits, of_shots = _sampled_limits(scenario, section, on_progress)
    exact = sampled(scenario, {}, 1)
    deterministic = float(sample_limits(exact)[0])
    error = model_error(exact.variants, deterministic)
    perforated = sampling.probability_of_perforation(scenario)
    mean = mean_of_replicates(np.array([part.mean() for part in np.array_split(limits, sampling.REPLICATES)]))
    return UncertaintyResult(
        samples=section.samples,
        seed=section.seed,
        confidence=CONFIDENCE,
        probability_of_perforation=None if error is None else perforated.at_least(1.0 - error.greatest_probability),
        limit_quantiles_m_s={str(probability): quantile(limits, probability) for probability in QUANTILES},
        mean_m_s=mean.value,
        mean_interval_m_s=(mean.low, mean.high),
        # Exactly 0 if all limits are equal, although their mean may be rounded.
        standard_deviation_m_s=float((limits - limits[0]).std(ddof=1)),
        deterministic_m_s=deterministic,
        curve=probability_curve(of_shots, None if error is None else error.greatest_probability),
        inputs=tuple(_influences(scenario, section, deterministic, error)),
        notes=(
            *_distribution_notes(section, scenario.inputs()),
            *([] if error or scenario.excludes_error() else [ERROR_UNKNOWN]),
            *scenario_warnings(scenario),
        ),
        model_error=error,
        perforated_by_distributions=perforated if error is None else None,
    ).of(scenario.subject(), scenario=scenario)


def _distribution_notes(section: Uncertainty, values: Mapping[str, float]) -> Iterator[Note]:
    """Yield a warning for each distribution that does not contain the scenario's value, or whose mean truncation moves.

    `values` are those of the scenario's inputs, by name.
    """
    for name, distribution in section.inputs().items():
        if name in values:
            if not distribution.contains(values[name]):
                yield Note(f"does not contain the scenario's value, {values[name]:g}", f"uncertainty.{name}")
            if means := sampling.moved_mean(distribution, values[name]):
                yield Note(f"truncation moves its mean from {means[0]:g} to {means[1]:.4g}", f"uncertainty.{name}")


def _sampled_limits(scenario: Scenario, section: Uncertainty, on_progress: OnProgress) -> Floats:
    """Return for each sample the ballistic limit and the velocity below which its single shot is stopped, m/s.

    The array is (2, samples): limits, and limits with the scatter of shots.  The inputs are sampled from the
    distributions of the section ``uncertainty``; `on_progress` gets the number of samples computed, and of all.
    """
    points, values = sampling.points_of(section), sampling.own_values(scenario)
    limits = np.empty((2, len(points)))
    for portion in portions(len(points), SAMPLES_AT_A_TIME):
        columns, count = columns_of(section, values, points[portion]), portion.stop - portion.start
        samples = sampled(scenario, columns, count)
        limits[0, portion] = sample_limits(samples)
        limits[1, portion] = limits[0, portion] * (samples.of_shots / samples.factor)
        on_progress(count, len(points))
    return limits


def sample_limits(samples: Samples) -> Floats:
    """Return the ballistic limit of each sample, m/s, (samples,); raise a NoLimitError if one has none."""
    limits: Floats = ballistic_limits(samples.variants) * samples.factor
    if np.isinf(limits).any():
        search = samples.variants.scenario.ballistic_limit
        ends = f"between {search.velocity_min_m_s:g} and {search.velocity_max_m_s:g} m/s"
        way_on = "widen velocity_min_m_s to velocity_max_m_s in [ballistic_limit], or truncate the distributions"
        raise NoLimitError(f"some samples have no ballistic limit {ends}; {way_on}")
    return limits


def _probability_of(hits: Bools) -> Estimate:
    """Estimate the probability of an event, with its interval; `hits`, (samples,), tells in which samples it happens.

    The samples are split into replicates of the random points, whose spread gives the interval.
    """
    parts = np.array_split(hits, sampling.REPLICATES)
    return proportion_of_replicates([int(part.sum()) for part in parts], [len(part) for part in parts])


def quantile(limits: Floats, probability: float) -> Estimate:
    """Estimate the quantile of limits, m/s, (samples,), at a probability, with the interval of Woodruff.

    The probability of limits up to the quantile is estimated first: unlike a quantile, it has no bias in small
    replicates.  The quantiles at the ends of its interval are the ends of the interval of the quantile.
    """
    value = float(np.quantile(limits, probability))
    below = _probability_of(limits <= value)
    ends = np.array([below.low, below.high]) - below.value + probability
    low, high = np.quantile(limits, np.clip(ends, 0.0, 1.0)).tolist()
    return Estimate(value, low, high)


def probability_curve(limits: Floats, greatest_probability: float | None) -> ProbabilityCurve:
    """Estimate the probability of perforation over velocity, with pointwise intervals, from limits of shots, m/s.

    `limits`, (samples,), are the velocities below which the sampled shots are stopped; `greatest_probability` is the
    greatest probability of stopping that is stated, None if no probability is known.
    """
    lowest, highest = limits.min(), limits.max()
    margin = 0.05 * (highest - lowest) + 1.0
    velocities = np.linspace(lowest - margin, highest + margin, 121)
    least_probability = 0.0 if greatest_probability is None else 1.0 - greatest_probability
    estimates = [_probability_of(limits <= velocity).at_least(least_probability) for velocity in velocities]
    value, low, high = (tuple(getattr(each, key) for each in estimates) for key in ("value", "low", "high"))
    known, alone = (None, value) if greatest_probability is None else (value, None)
    return ProbabilityCurve(tuple(velocities.tolist()), known, alone, low, high)


def _influences(
    scenario: Scenario, section: Uncertainty, deterministic: float, error: ModelError | None
) -> list[Influence]:
    """Return the ballistic limits, m/s, with each uncertain input in turn at two quantiles; the widest range is first.

    `deterministic` is the limit with the scenario's own values, m/s; `error` is another input, unless it is None.
    """
    values, found = scenario.inputs(), list[Influence]()
    for name, distribution in section.inputs().items():
        if name not in (VELOCITY, ERROR):
            ends = sampling.quantiles(distribution, ENDS, values[name])
            low, high = sample_limits(sampled(scenario, {name: ends}, 2)).tolist()
            found.append(Influence(name, (low, high)))
    if error is not None:
        found.append(Influence(ERROR, error.interval(deterministic, ENDS[0])))
    return sorted(found, key=lambda influence: -abs(influence.limits_m_s[1] - influence.limits_m_s[0]))
