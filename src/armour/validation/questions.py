"""Questions a suite may ask: any quantity, the lightest design, and what replacing one material saves."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

from armour.analysis.answers import COLUMNS, Answers
from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import groups_of
from armour.analysis.quantities import QUANTITIES
from armour.analysis.variants import Variants, grid_of
from armour.design.optimise import DesignResult, optimise
from armour.errors import InputError, NoDesignError, Problem
from armour.scenario.loading import Scenario


class Asked:
    """A scenario that is asked; each computation is done once, when it is first needed.

    Parameters
    ----------
    scenario : Scenario
    replacement : Scenario, optional
        The scenario with one material replaced by another, for what that saves.
    """

    def __init__(self, scenario: Scenario, replacement: Scenario | None = None) -> None:
        self.scenario, self.replacement = scenario, replacement

    @cached_property
    def answers(self) -> Answers:
        """The engine's answers about the scenario: one row."""
        return Answers(groups_of(self.scenario, {})[0].variants)

    @cached_property
    def lightest(self) -> DesignResult:
        """The lightest design of the scenario's grid."""
        return optimise(self.scenario)

    @cached_property
    def required(self) -> tuple[Variants, Variants]:
        """Armours with the least of the layer whose material is replaced, before and after the replacement."""
        assert self.replacement is not None, "checked by check_answerable"
        before, after = self.answers, Asked(self.replacement).answers
        if self.scenario.armour.ceramic != self.replacement.armour.ceramic:
            return before.with_least_ceramic, after.with_least_ceramic
        return before.with_least_backing, after.with_least_backing


class Question(NamedTuple):
    """A number, or the outcome, that a suite may ask."""

    label: str
    unit: str
    answer: Callable[[Asked], float | str]
    on_grid: bool = False  # needs the scenario's grid of designs
    of_two: bool = False  # compares the scenario with its replacement


def _of_quantity(name: str) -> Callable[[Asked], float | str]:
    def answer(asked: Asked) -> float | str:
        value: float | str = COLUMNS[name](asked.answers)[0].item()
        return value

    return answer


def _saved_percent(before: float, after: float) -> float:
    return 100.0 * (1.0 - after / before)


def _thickness_saved(asked: Asked) -> float:
    before, after = (float((found.ceramics_mm + found.backings_mm)[0]) for found in asked.required)
    return _saved_percent(before, after)


def _weight_saved(asked: Asked) -> float:
    before, after = (float(found.areal_densities_kg_m2[0]) for found in asked.required)
    return _saved_percent(before, after)


QUESTIONS: dict[str, Question] = {
    **{name: Question(q.label, q.unit, _of_quantity(name), q.on_grid) for name, q in QUANTITIES.items()},
    "optimum_ceramic_thickness_mm": Question(
        "ceramic thickness of the lightest design", "mm", lambda a: a.lightest.best.ceramic_thickness_mm, on_grid=True
    ),
    "optimum_backing_thickness_mm": Question(
        "back plate thickness of the lightest design",
        "mm",
        lambda a: a.lightest.best.backing_thickness_mm,
        on_grid=True,
    ),
    "optimum_areal_density_kg_m2": Question(
        "least areal density", "kg/m²", lambda a: a.lightest.best.areal_density_kg_m2, on_grid=True
    ),
    "thickness_saved_percent": Question("thickness saved", "%", _thickness_saved, on_grid=True, of_two=True),
    "weight_saved_percent": Question("weight saved", "%", _weight_saved, on_grid=True, of_two=True),
}


def answer(name: str, asked: Asked) -> float | str:
    """Answer a question.

    Raises
    ------
    NoAnswerError
        If the question has no answer in the scenario's range.
    """
    found = QUESTIONS[name].answer(asked)
    if found == found:
        return found
    if not QUESTIONS[name].on_grid:
        ballistic_limit(asked.scenario)  # raises, and says why
    velocity = asked.scenario.impact.velocity_m_s
    raise NoDesignError(
        f"no design: no thickness of the range defeats the impact at {velocity:g} m/s; "
        "raise the max of optimise.ceramic_thickness_mm or of optimise.backing_thickness_mm"
    )


def check_answerable(name: str, scenario: Scenario, replacement: Scenario | None = None) -> None:
    """Make sure that a scenario has what a question needs.

    Raises
    ------
    InputError
        If the grid is missing, or not exactly one material is replaced.
    """
    question = QUESTIONS[name]
    if question.on_grid:
        grid_of(scenario)
    if question.of_two:
        pairs = (
            []
            if replacement is None
            else [
                (scenario.armour.ceramic, replacement.armour.ceramic),
                (scenario.armour.backing, replacement.armour.backing),
            ]
        )
        if sum(before != after for before, after in pairs) != 1:
            message = "must name another ceramic or another backing, and not both"
            raise InputError([Problem(scenario.file, "replaced_by", message)])
