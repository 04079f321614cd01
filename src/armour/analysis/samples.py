"""Samples of uncertain inputs, checked before they are drawn."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from armour.analysis.variants import Floats, Variants, variants_of
from armour.errors import InputError, Problem, refuse
from armour.scenario.evidence import ERROR, ModelError
from armour.scenario.sampling import truncation_problem
from armour.scenario.scenario import Scenario
from armour.scenario.schema import ErrorDistribution, Uncertainty

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
