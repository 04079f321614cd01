"""Answer the questions that cases of a suite ask about a scenario, or about replacing one of its materials."""

from collections.abc import Callable
from functools import cached_property

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import COMPUTED, QuantityValues, groups_of
from armour.analysis.quantities import DESIGNS, OF_GRID, QUANTITIES
from armour.analysis.variants import Floats, Variants, grid_of
from armour.design.catalogue import catalogue_of
from armour.design.check import check_of
from armour.design.optimise import BestDesign, armour_in_words, optimise
from armour.errors import NoAnswerError, mistake
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES


class Subject:
    """What a question is about: a scenario and, for some, the same with a material replaced; keeps what it computes."""

    def __init__(self, scenario: Scenario, replacement: Scenario | None = None) -> None:
        self.scenario, self.replacement = scenario, replacement

    @cached_property
    def answers(self) -> QuantityValues:
        """Values of the quantities for the scenario, computed when needed, in arrays of one row."""
        return QuantityValues(groups_of(self.scenario, {})[0].variants)

    @cached_property
    def best(self) -> BestDesign:
        """The best design of the scenario; raise NoAnswerError, with the reason, if there is none."""
        result = optimise(self.scenario)
        if result.best is None:
            nearest, verdict = armour_in_words(result.shown), result.shown.check.verdict
            raise NoAnswerError(f"no design is known to pass; {nearest}, the nearest: {verdict}")
        return result.best

    @cached_property
    def required(self) -> tuple[Variants, Variants]:
        """The armours with the original material and with its replacement.

        In each, the layer of this material has the least thickness that stops the projectile.
        """
        assert self.replacement is not None, "a suite gives replaced_by with SAVINGS"
        before, after = self.answers, Subject(self.replacement).answers
        if self.scenario.armour.ceramic != self.replacement.armour.ceramic:
            return before.with_least_ceramic, after.with_least_ceramic
        return before.with_least_backing, after.with_least_backing


# Questions about the best design: "optimum_" and an attribute of the design.
OPTIMUM = "optimum_"
BEST = tuple(OPTIMUM + name for name in ("ceramic_thickness_mm", "backing_thickness_mm", *OBJECTIVES))
# Questions about replacing a material: the reduction of this quantity, in per cent of its value before.
SAVINGS: dict[str, Callable[[Variants], Floats]] = {
    "thickness_saved_percent": lambda armours: armours.ceramics_mm + armours.backings_mm,
    "weight_saved_percent": lambda armours: armours.areal_densities_kg_m2(),
}
# All questions that a suite may ask, with the sections and keys that each depends on; see `armour.scenario.effect`.
QUESTIONS: dict[str, tuple[str, ...]] = {
    **{name: quantity.reads for name, quantity in QUANTITIES.items()},
    **dict.fromkeys(BEST, DESIGNS),
    **dict.fromkeys(SAVINGS, OF_GRID),
}


def answer(name: str, subject: Subject) -> float | str:
    """Answer a question of `QUESTIONS`, in its unit; raise NoAnswerError, with the reason, if it has no answer."""
    value: float | str
    if name in BEST:
        value = getattr(subject.best, name.removeprefix(OPTIMUM))
        if value is None:
            raise NoAnswerError("no cost: each material and each layer of armour.layer must have one")
    elif name in SAVINGS:
        before, after = (float(SAVINGS[name](armours)[0]) for armours in subject.required)
        value = 100.0 * (1.0 - after / before)
    elif name in COMPUTED:
        value = COMPUTED[name](subject.answers)[0].item()
    else:
        value = check_of(subject.scenario, changes=False, needed=False).verdict
    if value == value:  # not NaN
        return value
    if "optimise" not in QUESTIONS[name]:
        ballistic_limit(subject.scenario)  # raises, with the reason, if there is none
        raise NoAnswerError(f"not known: {subject.answers.variants.why_error_unknown()}")
    velocity = subject.scenario.impact.velocity_m_s
    raise NoAnswerError(
        f"no design: no thickness of the range stops the projectile at {velocity:g} m/s; "
        "raise the max of optimise.ceramic_thickness_mm or of optimise.backing_thickness_mm"
    )


def check_answerable(name: str, scenario: Scenario, replacement: Scenario | None) -> None:
    """Raise an error if a scenario lacks the designs that a question needs, or if not exactly one material is replaced.

    `replacement` is the scenario with a material replaced; None for most questions.
    """
    if name in BEST:
        catalogue_of(scenario)
    elif "optimise" in QUESTIONS[name]:
        grid_of(scenario)
    if replacement is not None:
        before, after = scenario.armour, replacement.armour
        if (before.ceramic != after.ceramic) == (before.backing != after.backing):
            raise mistake(scenario.file, "replaced_by", "must name another ceramic or another backing, and not both")
