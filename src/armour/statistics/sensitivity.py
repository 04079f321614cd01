"""Sensitivity of a scenario's answers to its inputs: elasticities by central differences."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isnan, log, nan
from typing import Any

import numpy as np

from armour.analysis.evaluate import QuantityValues
from armour.analysis.results import OnProgress, TableResult, by_column, ignore_progress
from armour.analysis.variants import ballistic_limits, concatenated, variants_of
from armour.errors import NoAnswerError, Note
from armour.evidence.tests import scenario_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import VELOCITY
from armour.scenario.scenario import Scenario
from armour.statistics.measured import LIMIT, RESIDUAL

# Relative change of an input in either direction.
CHANGE = 0.005


@dataclass(frozen=True)
class Elasticity:
    """Elasticities with respect to an input: relative change of each answer per relative change of the input.

    Attributes
    ----------
    input : str
        Name of the input, such as ``"ceramic.flow_stress_GPa"``.
    value : float
        Its value, in the unit of its name.
    elasticities : mapping of str to float or None
        Elasticity of each answer; None if the answer does not depend on the input or has no value.
    """

    input: str
    value: float
    elasticities: Mapping[str, float | None]


@dataclass(frozen=True, repr=False)
class SensitivityResult(TableResult):
    """Elasticities of a scenario's answers.

    Attributes
    ----------
    answers : mapping of str to float or None
        Ballistic limit and residual velocity, m/s; None for one that there is not.
    inputs : tuple of Elasticity
        In descending order of the elasticity of the ballistic limit, without its sign.
    notes : tuple of Note
        Ways in which the scenario is unlike what the model was compared with.
    """

    answers: Mapping[str, float | None]
    inputs: tuple[Elasticity, ...]
    notes: tuple[Note, ...] = ()

    def _columns(self) -> dict[str, Any]:
        """Return the columns of the table: an input in each row, with its value and its elasticities."""
        return by_column({"input": item.input, "value": item.value, **item.elasticities} for item in self.inputs)


@checked
def sensitivity(scenario: Scenario, *, on_progress: OnProgress = ignore_progress) -> SensitivityResult:
    """Compute the elasticities of a scenario's answers.

    An elasticity is the change of the logarithm of an answer divided by that of an input, while the input changes from
    0.5 % below to 0.5 % above its value.  Strengths of a metal that are derived from its yield strength change with it.

    Parameters
    ----------
    scenario : Scenario
    on_progress : callable, optional
        Called with the number of limits computed since the last call, and the number of all.

    Returns
    -------
    SensitivityResult

    Raises
    ------
    NoAnswerError
        If there is no ballistic limit in the range of the search and no residual velocity.
    InputError
        If a run does not end.
    """
    inputs = {name: value for name, value in scenario.inputs().items() if value != 0.0}
    # Each input is changed in variants of its own, so that values derived from it change with it.
    changed = [
        variants_of(scenario, {name: np.array([value * (1.0 + CHANGE), value * (1.0 - CHANGE)])}, 2)
        for name, value in inputs.items()
    ]
    variants = concatenated([variants_of(scenario, {}, 1), *changed])
    # Limits that are subtracted are computed more accurately than the scenario's own.
    impacts, limits = QuantityValues(variants), ballistic_limits(variants, tolerance=1e-7)
    limits[:1] = ballistic_limits(variants.at(np.arange(1)))
    limits[np.isinf(limits)] = np.nan
    on_progress(len(limits), len(limits))
    answers = {LIMIT: limits, RESIDUAL: np.where(impacts.perforated, impacts.residual_velocities, np.nan)}
    if all(isnan(values[0]) for values in answers.values()):
        bounds = "ballistic_limit.velocity_min_m_s and velocity_max_m_s"
        raise NoAnswerError(f"nothing to rank: there is no ballistic limit between {bounds}, and no residual velocity")
    step = log((1.0 + CHANGE) / (1.0 - CHANGE))
    elasticities = {answer: np.log(values[1::2] / values[2::2]) / step for answer, values in answers.items()}
    # The ballistic limit does not depend on the velocity, over which it is searched for.
    elasticities[LIMIT][[*inputs].index(VELOCITY)] = nan
    by_input = [
        Elasticity(name, value, {answer: _number(column[index]) for answer, column in elasticities.items()})
        for index, (name, value) in enumerate(inputs.items())
    ]
    return SensitivityResult(
        answers={answer: _number(values[0]) for answer, values in answers.items()},
        inputs=tuple(sorted(by_input, key=lambda item: -abs(item.elasticities[LIMIT] or 0.0))),
        notes=scenario_warnings(scenario),
    ).of(scenario.subject(), scenario=scenario)


def _number(value: float) -> float | None:
    """Return a value as Python's own number, None in place of NaN."""
    return None if isnan(value) else float(value)
