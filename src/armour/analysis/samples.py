"""Samples of uncertain inputs, checked before they are drawn, and numbers estimated from samples."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field
from scipy.special import betaincinv, stdtrit

from armour.analysis.variants import Floats, Variants, variants_of
from armour.errors import InputError, Problem, refuse
from armour.scenario.evidence import ERROR, ModelError
from armour.scenario.sampling import truncation_problem
from armour.scenario.scenario import Scenario
from armour.scenario.schema import ErrorDistribution, Uncertainty

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
    misses = samples - hits
    low = float(betaincinv(hits, misses + 1, TAIL)) if hits else 0.0
    high = float(betaincinv(hits + 1, misses, 1.0 - TAIL)) if misses else 1.0
    return Estimate(hits / samples, low, high)


def mean_of_replicates(values: Floats) -> Estimate:
    """Estimate the mean of values of independent replicates, (replicates,), with the t interval."""
    mean, count = float(values.mean()), len(values)
    half = float(stdtrit(count - 1, 1.0 - TAIL) * values.std(ddof=1)) / sqrt(count)
    return Estimate(mean, mean - half, mean + half)


def proportion_of_replicates(hits: Sequence[int], sizes: Sequence[int]) -> Estimate:
    """Estimate a proportion from the hits in independent replicates, given their sizes, with the t interval.

    Where there are fewer hits, or misses, than replicates, the interval is that of Clopper and Pearson.
    """
    samples = sum(sizes)
    plain = proportion(sum(hits), samples)
    if min(sum(hits), samples - sum(hits)) < len(sizes):
        return plain
    found = mean_of_replicates(np.divide(hits, sizes))
    # Replicates may agree to the last hit; one hit in all of them is then still beyond what they tell.
    half = max(found.high - found.value, -log(TAIL) / samples)
    return Estimate(plain.value, max(0.0, plain.value - half), min(1.0, plain.value + half))


def jackknife(statistic: Callable[[Floats], Floats], sums: Floats) -> Estimate:
    """Estimate a statistic of sums over independent replicates, (replicates, ...), with the t interval.

    The statistic maps stacked sums, (n, ...), to values, (n,).  Leaving out one replicate at a time also removes its
    bias, which is inversely proportional to the number of samples.
    """
    whole = sums.sum(axis=0)
    values = statistic(np.concatenate([whole[None], whole - sums]))
    return mean_of_replicates(len(sums) * values[0] - (len(sums) - 1) * values[1:])


# Error at which the distribution of the model's error ends, %: a ballistic limit is above 0.
LEAST_ERROR_PERCENT = -99.0


class Samples(NamedTuple):
    """n samples of the uncertain inputs."""

    variants: Variants  # at the velocities at which the model perforates where the armour is perforated
    factor: Any  # ballistic limit of the armour over that of the model, (n,) or a number


def section_of(scenario: Scenario) -> Uncertainty:
    """Return the distributions of a scenario, with that of the error of the model where it is known."""
    return section_at(scenario, scenario.inputs(), scenario.model_error())


def section_at(scenario: Scenario, own: Mapping[str, float], error: ModelError | None) -> Uncertainty:
    """Return the distributions of a scenario with other values of its inputs, given its error of the model."""
    section = scenario.uncertainty
    if section is None or not (section.inputs() or error):
        example = '{ distribution = "normal", standard_deviation_percent = 5 }'
        message = f"is missing and must be given: distributions of inputs, such as ceramic.flow_stress_GPa = {example}"
        raise InputError([Problem(scenario.file, "uncertainty", message)])
    scenario.check_names(section.inputs(), scenario.file, "uncertainty")
    problems = [
        Problem(scenario.file, f"uncertainty.{name}", lacking)
        for name, distribution in section.inputs().items()
        if (lacking := distribution.mean_problem(own[name]) or truncation_problem(distribution, own[name]))
    ]
    refuse(problems)
    if error is None:
        return section
    distribution = ErrorDistribution(
        mean=error.mean_percent,
        standard_deviation=error.scale_percent,
        degrees_of_freedom=error.degrees_of_freedom,
        min=LEAST_ERROR_PERCENT,
    )
    return section.with_error(distribution)


def own_values(scenario: Scenario) -> dict[str, float]:
    """Return the scenario's own values of the inputs; the model's own error is 0."""
    return {**scenario.inputs(), ERROR: 0.0}


def sampled(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Samples:
    """Return n samples of values, which the scenario must allow.

    An armour whose ballistic limit is that of the model times a factor is perforated where the model perforates at the
    impact velocity divided by the factor.
    """
    problems = []
    inputs = {name: values for name, values in columns.items() if name != ERROR}
    for name, _, found in scenario.wrong_rows(inputs):
        message = f"must not reach values that are not allowed: {found[0].message}; give it a min or max"
        problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    refuse(problems)
    variants = variants_of(scenario, inputs, count)
    factor = 1.0 + columns.get(ERROR, 0.0) / 100.0
    return Samples(variants._replace(velocities=variants.velocities / factor), factor)
