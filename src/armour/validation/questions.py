"""Questions a suite may ask: any quantity, the lightest design, and what replacing one material saves."""

from collections.abc import Callable, Collection
from functools import cached_property, partial
from typing import NamedTuple

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import Answers, groups_of
from armour.analysis.quantities import DESIGNS, QUANTITIES
from armour.analysis.variants import Floats, Variants, grid_of
from armour.design.optimise import BestDesign, optimise
from armour.errors import InputError, NoDesignError, Problem
from armour.scenario.scenario import Scenario


class Asked:
    """A scenario, and the one with a material replaced where there is one; what is computed is computed once."""

    def __init__(self, scenario: Scenario, replacement: Scenario | None = None) -> None:
        self.scenario, self.replacement = scenario, replacement

    @cached_property
    def answers(self) -> Answers:
        """The engine's answers about the scenario: one row."""
        return Answers(groups_of(self.scenario, {})[0].variants)

    @cached_property
    def lightest(self) -> BestDesign:
        """The lightest design of the scenario's grid."""
        return optimise(self.scenario).best

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

    answer: Callable[[Asked], float | str]
    on_grid: bool = True  # needs the scenario's grid of designs
    of_two: bool = False  # compares the scenario with its replacement
    reads: Collection[str] = ("impact", "optimise")  # see `armour.scenario.reach`


def _quantity(name: str, asked: Asked) -> float | str:
    return QUANTITIES[name].compute(asked.answers)[0].item()


def _saved_percent(amount: Callable[[Variants], Floats], asked: Asked) -> float:
    before, after = (float(amount(armours)[0]) for armours in asked.required)
    return 100.0 * (1.0 - after / before)


QUESTIONS: dict[str, Question] = {
    **{
        name: Question(partial(_quantity, name), quantity.on_grid, reads=quantity.reads)
        for name, quantity in QUANTITIES.items()
    },
    "optimum_ceramic_thickness_mm": Question(lambda asked: asked.lightest.ceramic_thickness_mm, reads=DESIGNS),
    "optimum_backing_thickness_mm": Question(lambda asked: asked.lightest.backing_thickness_mm, reads=DESIGNS),
    "optimum_areal_density_kg_m2": Question(lambda asked: asked.lightest.areal_density_kg_m2, reads=DESIGNS),
    "thickness_saved_percent": Question(
        partial(_saved_percent, lambda armours: armours.ceramics_mm + armours.backings_mm), of_two=True
    ),
    "weight_saved_percent": Question(
        partial(_saved_percent, lambda armours: armours.areal_densities_kg_m2), of_two=True
    ),
}


def answer(name: str, asked: Asked) -> float | str:
    """Answer a question; raise NoAnswerError if it has no answer in the scenario's range."""
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
    """Check that a scenario has the grid that a question needs, and that exactly one material is replaced."""
    question = QUESTIONS[name]
    if question.on_grid:
        grid_of(scenario)
    if question.of_two:
        before, after = scenario.armour, (replacement or scenario).armour
        if (before.ceramic != after.ceramic) == (before.backing != after.backing):
            message = "must name another ceramic or another backing, and not both"
            raise InputError([Problem(scenario.file, "replaced_by", message)])
