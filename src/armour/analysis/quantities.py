"""Quantities that can be computed for a scenario, by name; `armour.analysis.answers` computes them."""

from collections.abc import Iterable
from typing import NamedTuple

from armour.scenario.evidence import ERROR
from armour.units import words_and_unit

DEFEAT = "probability of defeating the threat"
# What the quantities on the grid are.
REQUIRED = (
    "the least thickness in its range of [optimise] that defeats the impact with the scenario's other layer (total: "
    "both in proportion; areal density: of that ceramic on the scenario's back plate); none where no thickness does"
)


class Quantity(NamedTuple):
    """A number, or the outcome, that can be computed for a scenario."""

    label: str
    unit: str
    on_grid: bool = False  # needs the range of thicknesses of the section ``optimise``

    @property
    def reads(self) -> tuple[str, ...]:
        """What it depends on besides projectile, armour, model and solver, see `armour.scenario.reach`."""
        if self.label == "areal density":
            return ()
        if self.label == "ballistic limit":
            return ("ballistic_limit",)
        if self.label == DEFEAT:
            return ("impact", "ballistic_limit", "uncertainty.model")
        return ("impact", "optimise") if self.on_grid else ("impact",)


QUANTITIES: dict[str, Quantity] = {
    "outcome": Quantity("outcome", ""),
    "residual_velocity_m_s": Quantity("residual velocity", "m/s"),
    "residual_mass_g": Quantity("residual mass", "g"),
    "residual_length_mm": Quantity("residual length", "mm"),
    "velocity_lost_percent": Quantity("velocity lost", "%"),
    "mass_lost_percent": Quantity("mass lost", "%"),
    "penetration_depth_mm": Quantity("penetration depth", "mm"),
    "bulge_height_mm": Quantity("bulge height", "mm"),
    "plug_velocity_m_s": Quantity("plug velocity", "m/s"),
    "duration_us": Quantity("duration", "µs"),
    "areal_density_kg_m2": Quantity("areal density", "kg/m²"),
    "ballistic_limit_m_s": Quantity("ballistic limit", "m/s"),
    "probability_of_defeat": Quantity(DEFEAT, ""),
    "required_ceramic_thickness_mm": Quantity("required ceramic thickness", "mm", on_grid=True),
    "required_backing_thickness_mm": Quantity("required back plate thickness", "mm", on_grid=True),
    "required_total_thickness_mm": Quantity("required thickness of both layers in proportion", "mm", on_grid=True),
    "required_areal_density_kg_m2": Quantity("areal density with the required ceramic", "kg/m²", on_grid=True),
}


def reads_of(names: Iterable[str]) -> set[str]:
    """Return what any of some quantities depends on, see `Quantity.reads`."""
    return {read for name in names for read in QUANTITIES[name].reads}


def label_and_unit(name: str) -> tuple[str, str]:
    """Return the label and the unit of a quantity, or of a key or an input of a scenario, by its name."""
    if name in QUANTITIES:
        return QUANTITIES[name].label, QUANTITIES[name].unit
    return ("error of the model", "%") if name == ERROR else words_and_unit(name)
