"""Samples of uncertain inputs, checked before they are drawn."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.variants import Floats, Ints, Variants, variants_of
from armour.engine import batch
from armour.errors import Problem, mistake, refuse
from armour.evidence.model_error import LAW_FIELDS, Errors
from armour.scenario.inputs import ERROR
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Uncertainty

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
