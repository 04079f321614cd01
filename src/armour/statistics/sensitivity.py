"""What an answer gains when an input grows: elasticities, by the compiled engine."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isnan, log
from typing import TYPE_CHECKING, Any

from armour.analysis.least_thickness import solver_options
from armour.core.state import Outcome
from armour.design.optimisation import lightest_of_rows
from armour.errors import NoAnswerError
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, VELOCITY, inputs_of, rows_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# An input is made this part larger and smaller.
CHANGE = 0.005
# Tolerance of the ballistic limits that are subtracted, m/s.
LIMIT_TOLERANCE_M_S = 1e-7

LIMIT, RESIDUAL, OPTIMUM = "ballistic_limit_m_s", "residual_velocity_m_s", "least_areal_density_kg_m2"
# Inputs that an answer does not have: they are searched for.
FREE = {LIMIT: (VELOCITY,), RESIDUAL: (), OPTIMUM: (CERAMIC, BACKING)}


@dataclass(frozen=True)
class Elasticity:
    """By how many per cent each answer changes when an input grows by one.

    Attributes
    ----------
    input : str
    value : float
        In the unit of the input's name.
    elasticities : mapping of str to float or None
        By answer; None where it does not have the input, or no value.
    """

    input: str
    value: float
    elasticities: Mapping[str, float | None]


@dataclass(frozen=True)
class SensitivityResult:
    """Elasticities of a scenario's answers.

    Attributes
    ----------
    answers : mapping of str to float or None
        Ballistic limit, residual velocity and, where the scenario has a grid, least areal density of continuous
        thicknesses; None where there is none.
    inputs : tuple of Elasticity
        The largest for the ballistic limit first.
    """

    answers: Mapping[str, float | None]
    inputs: tuple[Elasticity, ...]

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


def sensitivity(scenario: Scenario) -> SensitivityResult:
    """Find by how many per cent a scenario's answers change when an input grows by one.

    Each is the quotient of the logarithms of two values, of the input half a per cent up and down.  Strengths of a
    metal that follow from its yield strength follow it here too.

    Raises
    ------
    NoAnswerError
        If there is no ballistic limit in the range of its search, no residual velocity and no design.
    InputError
        If the scenario has a grid, and a ceramic thickness in it, but no ceramic.
    """
    import numpy as np

    own = {name: value for name, value in inputs_of(scenario).items() if value > 0.0}
    # Of each input alone, so that what follows from it follows it.
    changes: list[dict[str, Floats]] = [{}]
    changes += (
        {name: np.array([value * part])} for name, value in own.items() for part in (1.0 + CHANGE, 1.0 - CHANGE)
    )
    rows, velocities = zip(*(rows_of(scenario, change, 1) for change in changes), strict=True)
    answers = _answers(scenario, np.concatenate(rows), np.concatenate(velocities))
    if all(isnan(values[0]) for values in answers.values()):
        raise NoAnswerError(
            "nothing to compare: no ballistic limit in the range of its search, no residual velocity and no design"
        )
    inputs = [
        Elasticity(
            name,
            value,
            {
                answer: None if name in FREE[answer] else _elasticity(values[2 * index + 1], values[2 * index + 2])
                for answer, values in answers.items()
            },
        )
        for index, (name, value) in enumerate(own.items())
    ]
    return SensitivityResult(
        answers={answer: _or_none(values[0]) for answer, values in answers.items()},
        inputs=tuple(sorted(inputs, key=lambda item: -abs(item.elasticities[LIMIT] or 0.0))),
    )


def _answers(scenario: Scenario, rows: "Floats", velocities: "Floats") -> dict[str, "Floats"]:
    """The answers of every row; NaN where there is none."""
    import numpy as np

    from armour.engine import batch

    search, told = scenario.ballistic_limit, solver_options(scenario)
    places = batch.ballistic_limits(rows, search.velocity_min_m_s, search.velocity_max_m_s, LIMIT_TOLERANCE_M_S, told)
    ends = batch.impacts(rows, velocities, told)
    answers = {
        LIMIT: np.where(places.bounded, places.perforated, np.nan),
        RESIDUAL: np.where(ends.outcome == Outcome.PERFORATED, ends.V, np.nan),
    }
    if scenario.optimise is not None:
        answers[OPTIMUM] = lightest_of_rows(scenario, rows, velocities)[2]
    return answers


def _elasticity(above: float, below: float) -> float | None:
    """Change of an answer between two values of an input, both as logarithms."""
    if isnan(above) or isnan(below):
        return None
    return log(above / below) / log((1.0 + CHANGE) / (1.0 - CHANGE))


def _or_none(value: float) -> float | None:
    return None if isnan(value) else float(value)
