"""Quantities that can be computed for a scenario, by name, and labels of quantities, inputs and keys.

The help of the command line lists them, so this module imports nothing that is slow to import;
`armour.analysis.evaluate` computes the quantities.
"""

from collections.abc import Iterable
from typing import NamedTuple

from armour.scenario.inputs import ERROR, OF_ERROR, ROLES, ROUND_AND_ARMOUR, YIELD
from armour.scenario.keys import parts_of
from armour.units import words_and_unit

# Description of the quantities on the grid.
REQUIRED_QUANTITIES = (
    "the least thickness in its range of [optimise] that stops the projectile with the scenario's other layer (total: "
    "both in proportion; areal density: of that ceramic on the scenario's back plate); none if no thickness does"
)
# What a quantity depends on besides projectile, armour, model and solver, see `armour.scenario.effect`.
OF_IMPACT, OF_LIMIT, OF_GRID = ("impact",), ("ballistic_limit",), ("impact", "optimise")
OF_STOPPING = ("impact", "ballistic_limit", *OF_ERROR)
OF_WEIGHT = ("design.existing",)
DESIGNS = (*OF_GRID, *OF_LIMIT, "threat", "armour.ceramic", "armour.backing", "armour.layer", "design", "uncertainty")

# Name of the quantity that is the verdict of `check`.
VERDICT = "verdict"
# Keys of [design] that a check reads: requirements, what is added to the armour, and materials with their costs.
OF_CHECK = (
    *("design.probability_of_stopping", "design.thickness_tolerance_mm"),
    *("design.areal_density_max_kg_m2", "design.thickness_max_mm", "design.cost_max_per_m2"),
    *("design.existing", "design.ceramic", "design.backing"),
)


class Answer(NamedTuple):
    """What a command computes, in words for messages, and the sections and keys that it depends on or shows."""

    computed: str
    reads: tuple[str, ...]


_IMPACT = (*OF_IMPACT, "armour", *OF_LIMIT)
_WITH_ERROR = (*_IMPACT, *OF_ERROR, *OF_WEIGHT)
_LIMIT = Answer("the ballistic limit", (*ROUND_AND_ARMOUR, *OF_LIMIT, *OF_ERROR, *OF_WEIGHT))
_CHECK = (*_WITH_ERROR, "threat", "uncertainty", *OF_CHECK)
_BYLINE = ("author", "project", "date")
# By command.  What a sweep depends on follows from its quantities.
ANSWERS = {
    "simulate": Answer("the simulated impact", _WITH_ERROR),
    "ballistic_limit": _LIMIT,
    "compare": _LIMIT,
    "check": Answer("the check", _CHECK),
    "optimise": Answer("the design", DESIGNS),
    "report": Answer("the report", (*_BYLINE, "armour", *DESIGNS)),
    "report --as-is": Answer("the report", (*_BYLINE, "optimise", *_CHECK)),
    "uncertainty": Answer("the answer", (*_IMPACT, "uncertainty", *OF_ERROR)),
    "sensitivity": Answer("the answer", _IMPACT),
    "calibrate": Answer("the answer", _IMPACT),
    "v50": _LIMIT,
    "plan_shots": _LIMIT._replace(computed="the answer"),
}


class Quantity(NamedTuple):
    """A number, or a word such as the outcome, that can be computed for a scenario."""

    label: str
    unit: str
    spec: str  # format specification in tables; those of a sweep show six digits
    reads: tuple[str, ...]  # sections and keys that it depends on besides projectile, armour, model and solver
    least: str = ""  # layer whose least thickness this quantity is, or is computed from

    @property
    def on_grid(self) -> bool:
        """Whether the quantity needs the ranges of thicknesses of the section ``optimise``."""
        return "optimise" in self.reads


QUANTITIES = {
    "outcome": Quantity("outcome by the model", "", "", OF_IMPACT),
    "residual_velocity_m_s": Quantity("residual velocity", "m/s", ".0f", OF_IMPACT),
    "residual_mass_g": Quantity("residual mass", "g", ".2f", OF_IMPACT),
    "residual_length_mm": Quantity("residual length", "mm", ".1f", OF_IMPACT),
    "velocity_lost_percent": Quantity("velocity lost", "%", ".1f", OF_IMPACT),
    "mass_lost_percent": Quantity("mass lost", "%", ".1f", OF_IMPACT),
    "penetration_depth_mm": Quantity("penetration depth", "mm", ".1f", OF_IMPACT),
    "bulge_height_mm": Quantity("bulge height", "mm", ".1f", OF_IMPACT),
    "plug_velocity_m_s": Quantity("plug velocity", "m/s", ".0f", OF_IMPACT),
    "duration_us": Quantity("duration", "µs", ".0f", OF_IMPACT),
    "areal_density_kg_m2": Quantity("areal density", "kg/m²", ".1f", OF_WEIGHT),
    "whole_areal_density_kg_m2": Quantity("areal density of the whole armour", "kg/m²", ".1f", OF_WEIGHT),
    "ballistic_limit_m_s": Quantity("ballistic limit", "m/s", ".0f", OF_LIMIT),
    "expected_limit_m_s": Quantity("expected limit", "m/s", ".0f", (*OF_LIMIT, *OF_ERROR)),
    "probability_of_stopping": Quantity("probability of stopping a shot", "", ".2f", OF_STOPPING),
    VERDICT: Quantity("verdict", "", "", _CHECK),
    "required_ceramic_thickness_mm": Quantity("required tile thickness", "mm", ".3f", OF_GRID, "ceramic"),
    "required_backing_thickness_mm": Quantity("required plate thickness", "mm", ".3f", OF_GRID, "back plate"),
    "required_total_thickness_mm": Quantity(
        "required thickness of both layers in proportion", "mm", ".3f", OF_GRID, "armour"
    ),
    "required_areal_density_kg_m2": Quantity(
        "areal density with the required ceramic", "kg/m²", ".2f", (*OF_GRID, *OF_WEIGHT), "ceramic"
    ),
}

# Quantities that are words, with an article for messages.
WORDS = {"outcome": "an outcome", VERDICT: "a verdict"}
# Words of keys that people read in another spelling.
SPELLING = {"backing": "plate", "caliber": "calibre", "m2": "m²", "youngs": "Young's"}


def reads_of(names: Iterable[str]) -> set[str]:
    """Return the sections and keys of a scenario that the named quantities depend on, see `Quantity.reads`."""
    return {read for name in names for read in QUANTITIES[name].reads}


def with_round(reads: Iterable[str]) -> set[str]:
    """Return all that a quantity depends on, given its `reads`: also projectile and armour, unless it reads threats.

    Threats replace the projectile, and a quantity that reads them names the keys of the armour itself.
    """
    reads = {*reads}
    return reads if "threat" in reads else {*ROUND_AND_ARMOUR, *reads}


def label_and_unit(name: str) -> tuple[str, str]:
    """Return the label and the unit of a quantity, an input, a key of a scenario or an attribute of a result."""
    if name in QUANTITIES:
        return QUANTITIES[name].label, QUANTITIES[name].unit
    if name == ERROR:
        return "model error", "%"
    words, unit = words_and_unit(name)
    words = "yield strength" if name == YIELD else _spelt(words)  # static where no dynamic one is known
    words = words.replace("ceramic thickness", "tile thickness")
    if "." in name:
        *sections, _ = parts_of(name)
        if len(sections) > 1:
            # A value of the library has the name of its entry.
            words = f"{sections[-1]} {words}"
        elif {*sections} & {"impact", *ROLES} and not words.startswith(("penetrator", "projectile")):
            words = f"{_spelt(sections[0].replace('projectile', 'penetrator'))} {words}"
    return words, unit


def _spelt(words: str) -> str:
    """Return the words of a key as people read them: "backing thickness" as "plate thickness"."""
    return " ".join(SPELLING.get(word, word) for word in words.split(" "))
