"""The numbers that a scenario answers, by name; each is computed when it is first asked for."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple

from armour.analysis.ballistic_limit import LimitResult, ballistic_limit
from armour.analysis.impact import ImpactResult, simulate
from armour.analysis.least_thickness import Design, grid, least_backing, least_ceramic, least_in_proportion
from armour.design.optimisation import OptimumResult, no_design, optimise
from armour.errors import InputError, NoDesignError, Problem
from armour.scenario.loading import Scenario
from armour.units import MM


class Answers:
    """What a scenario answers; every computation is done once.

    Parameters
    ----------
    scenario : Scenario
    replacement : Scenario, optional
        The scenario with one material replaced by another, for what that saves.
    """

    def __init__(self, scenario: Scenario, replacement: Scenario | None = None) -> None:
        self.scenario = scenario
        self.replacement = replacement

    @cached_property
    def impact(self) -> ImpactResult:
        """The scenario's impact."""
        return simulate(self.scenario)

    @cached_property
    def limit(self) -> LimitResult:
        """The ballistic limit of its armour."""
        return ballistic_limit(self.scenario)

    @cached_property
    def optimum(self) -> OptimumResult:
        """The lightest design of its grid."""
        return optimise(self.scenario)

    @cached_property
    def with_least_ceramic(self) -> Design:
        """Its armour with the least ceramic that defeats the impact."""
        return self._found(least_ceramic(self.scenario, self.scenario.armour.backing_thickness_mm))

    @cached_property
    def with_least_backing(self) -> Design:
        """Its armour with the least backing that defeats the impact."""
        return self._found(least_backing(self.scenario, self.scenario.armour.ceramic_thickness_mm))

    @cached_property
    def in_proportion(self) -> Design:
        """Its armour made as thin as defeats the impact, in proportion."""
        return self._found(least_in_proportion(self.scenario))

    @cached_property
    def replaced(self) -> tuple[Design, Design]:
        """The least of the layer whose material is replaced, before and after; the other layer stays."""
        assert self.replacement is not None, "checked by answerable"
        after = Answers(self.replacement)
        if self.scenario.armour.ceramic != self.replacement.armour.ceramic:
            return self.with_least_ceramic, after.with_least_ceramic
        return self.with_least_backing, after.with_least_backing

    def _found(self, design: Design | None) -> Design:
        if design is None:
            raise NoDesignError(no_design(self.scenario))
        return design


def answers_of(known: dict[str, Answers], scenario: Scenario, replacement: Scenario | None = None) -> Answers:
    """What a scenario answers, from those that are known already or added to them."""
    key = "\n".join(text for s in (scenario, replacement) if s is not None for text in (s.file, s.to_toml()))
    return known.setdefault(key, Answers(scenario, replacement))


class Quantity(NamedTuple):
    """A number, or the outcome, that a scenario answers."""

    words: str
    unit: str
    of: Callable[[Answers], float | str]
    on_grid: bool = False  # looked for on the scenario's grid of designs
    of_two: bool = False  # compares the scenario with its replacement


def _lost_percent(before: float, after: float) -> float:
    return 100.0 * (1.0 - after / before)


def _length_lost_percent(a: Answers) -> float:
    return _lost_percent(a.scenario.core_armour().L0 / MM, a.impact.residual_length_mm)


def _saved_percent(a: Answers, amount: Callable[[Design], float]) -> float:
    before, after = a.replaced
    return _lost_percent(amount(before), amount(after))


def _areal_density(design: Design) -> float:
    return design.areal_density_kg_m2


def _total(design: Design) -> float:
    return design.ceramic_thickness_mm + design.backing_thickness_mm


def answerable(name: str, scenario: Scenario, replacement: Scenario | None = None) -> None:
    """Make sure that a scenario has what a quantity needs.

    Raises
    ------
    InputError
        If the grid is missing, or not exactly one material is replaced.
    """
    quantity = QUANTITIES[name]
    if quantity.on_grid:
        grid(scenario)
    if quantity.of_two:
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


QUANTITIES: Mapping[str, Quantity] = {
    "outcome": Quantity("outcome", "", lambda a: a.impact.outcome),
    "residual_velocity_m_s": Quantity("residual velocity", "m/s", lambda a: a.impact.residual_velocity_m_s),
    "residual_mass_g": Quantity("residual mass", "g", lambda a: a.impact.residual_mass_g),
    "residual_length_mm": Quantity("residual length", "mm", lambda a: a.impact.residual_length_mm),
    "velocity_lost_percent": Quantity(
        "velocity lost", "%", lambda a: _lost_percent(a.impact.impact_velocity_m_s, a.impact.residual_velocity_m_s)
    ),
    "mass_lost_percent": Quantity("mass lost", "%", _length_lost_percent),
    "penetration_depth_mm": Quantity("penetration depth", "mm", lambda a: a.impact.penetration_depth_mm),
    "bulge_height_mm": Quantity("bulge height", "mm", lambda a: a.impact.bulge_height_mm),
    "plug_velocity_m_s": Quantity("plug velocity", "m/s", lambda a: a.impact.plug_velocity_m_s),
    "duration_us": Quantity("duration", "us", lambda a: a.impact.duration_us),
    "areal_density_kg_m2": Quantity("areal density", "kg/m²", lambda a: a.scenario.areal_density_kg_m2()),
    "ballistic_limit_m_s": Quantity("ballistic limit", "m/s", lambda a: a.limit.ballistic_limit_m_s),
    "required_ceramic_thickness_mm": Quantity(
        "required ceramic thickness", "mm", lambda a: a.with_least_ceramic.ceramic_thickness_mm, on_grid=True
    ),
    "required_backing_thickness_mm": Quantity(
        "required backing thickness", "mm", lambda a: a.with_least_backing.backing_thickness_mm, on_grid=True
    ),
    "required_total_thickness_mm": Quantity(
        "required thickness of both layers in proportion", "mm", lambda a: _total(a.in_proportion), on_grid=True
    ),
    "required_areal_density_kg_m2": Quantity(
        "areal density with the required ceramic",
        "kg/m²",
        lambda a: a.with_least_ceramic.areal_density_kg_m2,
        on_grid=True,
    ),
    "optimum_ceramic_thickness_mm": Quantity(
        "ceramic of the lightest design", "mm", lambda a: a.optimum.best.ceramic_thickness_mm, on_grid=True
    ),
    "optimum_backing_thickness_mm": Quantity(
        "backing of the lightest design", "mm", lambda a: a.optimum.best.backing_thickness_mm, on_grid=True
    ),
    "optimum_areal_density_kg_m2": Quantity(
        "least areal density", "kg/m²", lambda a: a.optimum.best.areal_density_kg_m2, on_grid=True
    ),
    "thickness_saved_percent": Quantity(
        "thickness saved", "%", lambda a: _saved_percent(a, _total), on_grid=True, of_two=True
    ),
    "weight_saved_percent": Quantity(
        "weight saved", "%", lambda a: _saved_percent(a, _areal_density), on_grid=True, of_two=True
    ),
}
