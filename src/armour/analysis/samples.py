"""Samples of uncertain inputs, checked before they are drawn, and numbers estimated from samples."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from armour.analysis.variants import Floats, Ints, Variants, variants_of
from armour.engine import batch
from armour.errors import Problem, mistake, refuse
from armour.evidence.model_error import LAW_FIELDS, Errors
from armour.scenario.inputs import ERROR
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Uncertainty

CONFIDENCE = 0.95
Confidence = Annotated[float, Field(ge=0.5, le=0.9999)]
# Probability beyond each end of an interval.
TAIL = 0.5 * (1.0 - CONFIDENCE)


@dataclass(frozen=True)
class Estimate:
    """A number estimated from samples, with its confidence interval.

    Attributes
    ----------
    value : float
    low, high : float
        Ends of the interval.
    """

    value: float
    low: float
    high: float


def proportion(hits: int, samples: int) -> Estimate:
    """Estimate a proportion, with the Clopper-Pearson confidence interval [Clopper1934]."""
    from scipy.special import betaincinv  # slow to import

    misses = samples - hits
    low = float(betaincinv(hits, misses + 1, TAIL)) if hits else 0.0
    high = float(betaincinv(hits + 1, misses, 1.0 - TAIL)) if misses else 1.0
    return Estimate(hits / samples, low, high)


def mean_of_replicates(values: Floats) -> Estimate:
    """Estimate the mean of values of independent replicates, (replicates,), with the t interval."""
    from scipy.special import stdtrit  # slow to import

    mean, count = float(values.mean()), len(values)
    half = float(stdtrit(count - 1, 1.0 - TAIL) * values.std(ddof=1)) / sqrt(count)
    return Estimate(mean, mean - half, mean + half)


def proportion_of_replicates(hits: Sequence[int], sizes: Sequence[int]) -> Estimate:
    """Estimate a proportion from the hits in independent replicates, given their sizes, with the t interval.

    If there are fewer hits, or misses, than replicates, the interval is the Clopper-Pearson one.
    """
    samples = sum(sizes)
    plain = proportion(sum(hits), samples)
    if min(sum(hits), samples - sum(hits)) < len(sizes):
        return plain
    mean = mean_of_replicates(np.divide(hits, sizes))
    # Replicates may agree to the last hit; their spread does not resolve less than one hit in all of them.
    half = max(mean.high - mean.value, -log(TAIL) / samples)
    return Estimate(plain.value, max(0.0, plain.value - half), min(1.0, plain.value + half))


def jackknife(statistic: Callable[[Floats], Floats], sums: Floats) -> Estimate:
    """Estimate a statistic of sums over independent replicates, (replicates, ...), with the t interval.

    The statistic maps stacked sums, (n, ...), to values, (n,).  Leaving out one replicate at a time also removes its
    bias, which is inversely proportional to the number of samples.
    """
    whole = sums.sum(axis=0)
    values = statistic(np.concatenate([whole[None], whole - sums]))
    return mean_of_replicates(len(sums) * values[0] - (len(sums) - 1) * values[1:])


# Least ratio of the armour's ballistic limit to that of the model.
LEAST_RATIO = 0.01


class Samples(NamedTuple):
    """n samples of the uncertain inputs."""

    variants: Variants  # at velocities at which the model perforates if the armour is perforated
    factor: Any  # ballistic limit of the armour divided by that of the model, (n,) or a number


def own_errors(scenario: Scenario, layers: Mapping[str, float] | None = None) -> Errors:
    """Return the model error for a scenario's armour, with other thicknesses of its layers by name of input."""
    columns = {name: np.array([value]) for name, value in (layers or {}).items()}
    return variants_of(scenario, columns, 1).errors


def section_of(scenario: Scenario) -> Uncertainty:
    """Return the distributions of a scenario, including that of the model error if it is known."""
    return section_at(scenario, scenario.inputs(), with_error=bool(own_errors(scenario).known.all()))


def section_at(scenario: Scenario, values: Mapping[str, float], *, with_error: bool) -> Uncertainty:
    """Return the distributions of a scenario at other values of its inputs, with or without the model error."""
    section = scenario.uncertainty
    if section is None or not (section.inputs() or with_error):
        example = '{ distribution = "normal", standard_deviation_percent = 5 }'
        message = f"is missing and must be given: distributions of inputs, such as ceramic.flow_stress_GPa = {example}"
        raise mistake(scenario.file, "uncertainty", message)
    scenario.check_names(section.inputs(), scenario.file, "uncertainty")
    problems = [
        Problem(scenario.file, f"uncertainty.{name}", lacking)
        for name, distribution in section.inputs().items()
        if (lacking := distribution.mean_problem(values[name]))
    ]
    refuse(problems)
    return section.with_error() if with_error else section


def own_values(scenario: Scenario) -> dict[str, float]:
    """Return the scenario's own values of the inputs, with the model error at its median."""
    return {**scenario.inputs(), ERROR: 0.5}


def sampled(scenario: Scenario, columns: Mapping[str, Floats], count: int, errors: Errors | None = None) -> Samples:
    """Return n samples of values, which the scenario must allow.

    An armour whose ballistic limit is the model's times a factor is perforated if the model perforates at the impact
    velocity divided by the factor.  The model error, by default that of the scenario's armour, is the quantile at the
    probabilities in its column; each sample has the law of the flow stress that its error is drawn from.
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
    errors = own_errors(scenario) if errors is None else errors
    law, factor = errors.ratio.one().drawn(columns[ERROR])
    factor = factor.clip(min=LEAST_RATIO)
    variants = by_laws(variants, errors, law)
    return Samples(variants._replace(velocities=variants.velocities / factor), factor)


def by_laws(variants: Variants, errors: Errors, laws: Ints) -> Variants:
    """Return samples, each with one of the laws of the error of their armour; the errors have one row.

    The first law is the samples' own.  Parameters by the others are scaled in proportion to the samples' own.
    """
    parameters = variants.parameters.copy()
    fields = batch.fields(parameters)
    for law in np.unique(laws[laws > 0]):
        rows = laws == law
        for name, (value,), (first_value,) in zip(
            LAW_FIELDS, errors.parameters[law], errors.parameters[0], strict=True
        ):
            column = getattr(fields, name)
            column[rows] = column[rows] * value / first_value if first_value else value
    return variants._replace(parameters=parameters)
