"""Sample uncertain inputs, by quantiles and a Gaussian copula, and estimate the probability of perforation."""

from collections.abc import Mapping, Sequence
from math import hypot, inf, log, log1p, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from armour.analysis.estimates import Estimate, mean_of_replicates, proportion_of_replicates
from armour.analysis.results import OnProgress, ignore_progress, portions
from armour.analysis.variants import Floats, Ints, Variants, variants_of
from armour.engine import batch
from armour.errors import Note, Problem, mistake, refuse
from armour.evidence.model_error import LAW_FIELDS, ErrorRows
from armour.scenario.inputs import CERAMIC, ERROR
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Distribution, Uncertainty, correlation_matrix

# Least ratio of the armour's ballistic limit to that of the model.
LEAST_RATIO = 0.01
# Number of independent replicates into which the samples are divided; their scatter gives the confidence intervals.
# With more, each would be smaller, and the samples as a whole would converge more slowly.
REPLICATES = 16
# Samples of each replicate at first, and the factor by which their number grows until the estimate is good enough.
FIRST_SAMPLES, GROWTH = 1, 4
# Half the width of an interval that is narrow enough; and the distance from the bound, in half widths, that is enough
# for a quick estimate.
PRECISE, CLEARLY = 5e-4, 3.0
# Samples computed at a time, to bound the memory.
SAMPLES_OF_ONE_PASS = 2**12


class Samples(NamedTuple):
    """n samples of the uncertain inputs, as variants of the scenario, with the model error of each."""

    variants: Variants  # velocities are divided by `of_shots`: the model perforates if a shot perforates the armour
    factor: Any  # ballistic limit of the armour divided by that of the model, (n,) or a number
    of_shots: Any = 1.0  # velocity below which a shot is stopped divided by that limit


def own_errors(scenario: Scenario, layers: Mapping[str, float] | None = None) -> ErrorRows:
    """Return the model error of a scenario's own armour, in one row; `layers` may replace thicknesses, mm, by input."""
    columns = {name: np.array([value]) for name, value in (layers or {}).items()}
    return variants_of(scenario, columns, 1).errors


def section_of(scenario: Scenario) -> Uncertainty:
    """Return the section ``uncertainty`` of a scenario, with that of the model error added if it is known."""
    return section_at(scenario, scenario.inputs(), with_error=bool(own_errors(scenario).known.all()))


def section_at(scenario: Scenario, values: Mapping[str, float], *, with_error: bool) -> Uncertainty:
    """Return the section ``uncertainty`` of a scenario, with the distribution of the model error if `with_error`.

    Raise an InputError if there are none, or if a distribution cannot have the value of its input, in `values`, as its
    mean.
    """
    section = scenario.uncertainty
    if section is None or not (section.inputs() or with_error):
        example = '{ distribution = "normal", standard_deviation_percent = 5 }'
        message = f"is missing and must be given: distributions of inputs, such as ceramic.flow_stress_GPa = {example}"
        raise mistake(scenario.file, "uncertainty", message)
    scenario.check_names(section.inputs(), scenario.file, "uncertainty")
    problems = [
        Problem(scenario.file, f"uncertainty.{name}", lacking)
        for name, distribution in section.inputs().items()
        if not _is_absent(name, values) and (lacking := distribution.mean_problem(values[name]))
    ]
    refuse(problems)
    return section.with_error() if with_error else section


def _is_absent(name: str, values: Mapping[str, float]) -> bool:
    """Return whether an input is the thickness of a ceramic that is left out, which does not vary."""
    return name == CERAMIC and values[name] == 0.0


def own_values(scenario: Scenario) -> dict[str, float]:
    """Return the scenario's own values of the inputs, by name, with the model error at its median."""
    return {**scenario.inputs(), ERROR: 0.5}


def sampled(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Samples:
    """Return `count` samples of the uncertain inputs; raise an InputError if the scenario does not allow a value.

    `columns` has an array, (count,), by name of input.  If it has a column `ERROR` of probabilities, each of these
    draws a model error for its sample: a law of the flow stress, and a factor, which is the armour's ballistic limit
    over the model's by this law.  It also draws the velocity below which a shot is stopped.
    """
    problems = []
    inputs = {name: values for name, values in columns.items() if name != ERROR}
    for name, _, row_problems in scenario.wrong_rows(inputs):
        message = f"must not include values that are not allowed: {row_problems[0].message}; give it a min or max"
        problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    refuse(problems)
    variants = variants_of(scenario, inputs, count)
    if ERROR not in columns:
        return Samples(variants, 1.0)
    errors = own_errors(scenario)
    law, factor = errors.ratio.one().drawn(columns[ERROR])
    _, of_shots = errors.of_shots.ratio.one().drawn(columns[ERROR])
    factor, of_shots = factor.clip(min=LEAST_RATIO), of_shots.clip(min=LEAST_RATIO)
    variants = by_laws(variants, errors, law)
    return Samples(variants._replace(velocities=variants.velocities / of_shots), factor, of_shots)


def by_laws(variants: Variants, errors: ErrorRows, laws: Ints) -> Variants:
    """Return n samples with other laws of the flow stress: each with that whose index in `errors` is in `laws`, (n,).

    `errors` has one row.  The given samples follow law 0.  For another law, each of their parameters `LAW_FIELDS` is
    multiplied by its value in that law over its value in law 0.
    """
    parameters = variants.parameters.copy()
    fields = batch.fields(parameters)
    for law in np.unique(laws[laws > 0]):
        rows = laws == law
        for name, (value,), (first_value,) in zip(LAW_FIELDS, *errors.parameters[[law, 0]], strict=True):
            column = getattr(fields, name)
            column[rows] = column[rows] * value / first_value if first_value else value
    return variants._replace(parameters=parameters)


def points_of(uncertainty: Uncertainty) -> Floats:
    """Return points within the unit cube, (samples, inputs), a scrambled Sobol' sequence for each replicate."""
    if not uncertainty.inputs():
        return np.empty((uncertainty.samples, 0))
    from scipy.stats import qmc  # slow to import

    rng, width = np.random.default_rng(uncertainty.seed), len(uncertainty.inputs())
    sizes = (len(part) for part in np.array_split(np.empty(uncertainty.samples), REPLICATES))
    points = np.concatenate([qmc.Sobol(width, rng=rng).random(size) for size in sizes])
    # The quantile at 0 of an unbounded distribution is infinite.
    return np.clip(points, 2.0**-53, 1.0 - 2.0**-53, out=points)


def correlated(uncertainty: Uncertainty, points: Floats) -> Floats:
    """Correlate points of the unit cube, (n, inputs), by the Gaussian copula of a section; return the new points."""
    if not uncertainty.correlation:
        return points
    from scipy.special import ndtr, ndtri  # slow to import

    factor = np.linalg.cholesky(correlation_matrix(list(uncertainty.inputs()), uncertainty.correlation))
    return ndtr(ndtri(points) @ factor.T)


def columns_of(uncertainty: Uncertainty, values: Mapping[str, float], points: Floats) -> dict[str, Floats]:
    """Return correlated values of the uncertain inputs, (n,) by name, at points of the unit cube, (n, inputs).

    `values` has the scenario's own values by name of input.
    """
    parts = zip(uncertainty.inputs().items(), correlated(uncertainty, points).T, strict=True)
    return {name: quantiles(distribution, chances, values[name]) for (name, distribution), chances in parts}


def quantiles(distribution: Distribution, probabilities: ArrayLike, value: float) -> Floats:
    """Return quantiles of a truncated distribution, in the shape of `probabilities`.

    `value` is the scenario's value of the input: the mean before truncation, unless the distribution gives one.  If
    `value` cannot be a mean, such as the thickness 0 of an absent layer, all quantiles are equal to it.
    """
    if distribution.mean_problem(value):
        return np.full(np.shape(probabilities), value)
    parts, ends = np.asarray(probabilities), np.array(distribution.ends)
    if distribution.distribution == "uniform":
        return ends[0] + (ends[1] - ends[0]) * parts
    centre, width = distribution.moments(value)
    if is_lognormal := distribution.distribution == "lognormal":
        centre, width = log(centre / hypot(1.0, width / centre)), sqrt(log1p((width / centre) ** 2))
        with np.errstate(divide="ignore"):
            ends = np.log(ends.clip(min=0.0))
    from scipy.stats import truncnorm  # slow to import

    values = truncnorm.ppf(parts, *(ends - centre) / width, loc=centre, scale=width)
    return np.clip(np.exp(values) if is_lognormal else values, *distribution.ends)


def moved_mean(distribution: Distribution, value: float) -> tuple[float, float] | None:
    """Return the means before and after truncation of the distribution of an input, whose own value is `value`.

    Return None if they differ by at most 0.1 standard deviations.
    """
    if distribution.distribution == "uniform" or np.isinf(distribution.ends).all():
        return None
    before, deviation = distribution.moments(value)
    after = float(quantiles(distribution, (np.arange(1000) + 0.5) / 1000, value).mean())
    return (before, after) if abs(after - before) > 0.1 * deviation else None


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

    The inputs are sampled.  If the model error is known, each sample has a probability of perforation given this error,
    and few samples are needed.  Samples are added until the interval is narrow and does not contain the bound.

    Parameters
    ----------
    scenario : Scenario
        Its section ``uncertainty`` gives the distributions and the greatest number of samples.
    bound : float, optional
        Greatest probability that is allowed.
    layers : mapping of str to float, optional
        Thicknesses of the layers, mm, by name of input, in place of the scenario's.
    points : array, (samples, inputs), optional
        Result of `points_of`, if it is known already.
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
    replicates = np.array_split(points_of(section) if points is None else points, REPLICATES)
    chances = [np.empty(0)] * REPLICATES
    while True:
        start = len(chances[0])
        parts = [part[start : max(FIRST_SAMPLES, GROWTH * start)] for part in replicates]
        count = sum(map(len, parts))
        columns = columns_of(section, values, np.concatenate(parts))
        columns = {name: column for name, column in columns.items() if not _is_absent(name, values)}
        rows = sampled(scenario, {**{key: np.full(count, mm) for key, mm in layers.items()}, **columns}, count).variants
        added = [_perforation_probabilities(rows.at(part), errors) for part in portions(count, SAMPLES_OF_ONE_PASS)]
        on_progress(count, None)
        ends = np.cumsum([len(part) for part in parts])[:-1]
        added = np.split(np.concatenate(added), ends)
        chances = [np.append(*each) for each in zip(chances, added, strict=True)]
        estimate = _estimated_mean(chances, is_smooth=is_known)
        if len(chances[0]) == len(replicates[0]) or _is_enough(estimate, bound, quick=quick):
            return estimate


def is_sampled(scenario: Scenario, layers: Mapping[str, float] | None = None) -> bool:
    """Return whether samples can give the probability of perforation: the model error must be known.

    `layers` as in `own_errors`.
    """
    return bool(own_errors(scenario, layers).known.all())


def misplaced(distributions: Mapping[str, Distribution], scenario: Scenario, answer: Scenario) -> tuple[Note, ...]:
    """Return a warning for each distribution of `scenario` that does not apply to `answer`, a scenario made from it.

    A distribution does not apply if it does not contain the value that its input has in `answer`, or if it gives a
    mean, min or max and this value is not the one in `scenario`.
    """
    scenario_values, values = scenario.inputs(), answer.inputs()
    notes = []
    for name in filter(values.__contains__, distributions):
        distribution, value = distributions[name], values[name]
        if (distribution.placed and scenario_values.get(name) != value) or not distribution.contains(value):
            words = f"is the distribution of another value than {value:g}, that of the armour and threat reported"
            notes.append(Note(f"{words}; inputs are taken as exact in their probability", f"uncertainty.{name}"))
    return tuple(notes)


def _perforation_probabilities(rows: Variants, errors: ErrorRows) -> Floats:
    """Return the probability that each of n samples is perforated, (n,), given the model error; 0 or 1 if unknown."""
    if not errors.known.all():
        return rows.perforated().astype(np.float64)
    stopping = np.zeros(len(rows.velocities))
    for law, [weight] in enumerate(errors.ratio.weights.tolist()):
        if weight > 0.0:
            limits = by_laws(rows, errors, np.full(len(stopping), law)).limits_anywhere()
            stopping += weight * errors.of_shots.of_law(law).times(limits).probability_above(rows.velocities)
    return 1.0 - stopping


def _estimated_mean(chances: Sequence[Floats], *, is_smooth: bool) -> Estimate:
    """Estimate a probability of perforation from those of the samples, `chances`, an array for each replicate.

    They are probabilities if `is_smooth`, otherwise each is 0 or 1.
    """
    if not is_smooth:
        return proportion_of_replicates([int(part.sum()) for part in chances], [len(part) for part in chances])
    mean = mean_of_replicates(np.array([part.mean() for part in chances]))
    return Estimate(*(min(max(end, 0.0), 1.0) for end in (mean.value, mean.low, mean.high)))


def _is_enough(estimate: Estimate, bound: float | None, *, quick: bool) -> bool:
    """Return whether an estimate needs no more samples, see `probability_of_perforation`."""
    half = max(estimate.high - estimate.value, estimate.value - estimate.low)
    away = inf if bound is None else abs(estimate.value - bound)
    return (half <= PRECISE and away > half) or (quick and away > CLEARLY * half)
