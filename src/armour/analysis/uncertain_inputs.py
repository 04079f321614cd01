"""The uncertain inputs of a scenario, checked before they are sampled."""

from collections.abc import Mapping

from armour.analysis.variants import Floats, Variants, variants_of
from armour.errors import InputError, Problem, refuse
from armour.scenario.distributions import Uncertainty
from armour.scenario.loading import Scenario
from armour.scenario.parameters import check_names, inputs_of, wrong_rows


def section_of(scenario: Scenario) -> Uncertainty:
    """Return the distributions of a scenario."""
    section = scenario.uncertainty
    if section is None or not section.inputs():
        example = '{ distribution = "normal", standard_deviation_percent = 5 }'
        message = f"is missing and must be given: distributions of inputs, such as ceramic.flow_stress_GPa = {example}"
        raise InputError([Problem(scenario.file, "uncertainty", message)])
    check_names(section.inputs(), scenario, scenario.file, "uncertainty")
    own = inputs_of(scenario)
    problems = [
        Problem(scenario.file, f"uncertainty.{name}", lacking)
        for name, distribution in section.inputs().items()
        if (lacking := distribution.mean_problem(own[name]))
    ]
    refuse(problems)
    return section


def sampled(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Variants:
    """Return n samples as variants of the scenario, which must allow every sampled value."""
    problems = []
    for name, _, found in wrong_rows(scenario, columns):
        message = f"must not reach values that are not allowed: {found[0].message}; give it a min or max"
        problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    refuse(problems)
    return variants_of(scenario, columns, count)
