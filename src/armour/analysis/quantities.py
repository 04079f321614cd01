"""The numbers that a scenario answers, by name: one entry each."""

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from armour.analysis import searches
from armour.analysis import variants as rows
from armour.analysis.variants import Bools, Floats, Variants
from armour.core.equations import cross_section
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from armour.units import MM, US, G, words_and_unit


class Answers:
    """What the engine answers about variants of a scenario; each computation is done once, when it is first needed.

    Parameters
    ----------
    variants : Variants
    threads : int, optional
        By default one per core.
    """

    def __init__(self, variants: Variants, threads: int | None = None) -> None:
        self.variants, self.threads = variants, threads

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model, an array each."""
        found: Parameters = batch.fields(self.variants.parameters)
        return found

    @cached_property
    def impacts(self) -> batch.Impacts:
        """Ends of the impacts."""
        return rows.impacts(self.variants, self.threads)

    @cached_property
    def perforated(self) -> Bools:
        """Whether each impact perforates."""
        found: Bools = self.impacts.outcome == Outcome.PERFORATED
        return found

    @cached_property
    def residual_velocities(self) -> Floats:
        """Residual velocities, m/s; 0 where the impact is defeated."""
        return np.where(self.perforated, self.impacts.V, 0.0)

    @cached_property
    def ballistic_limits(self) -> Floats:
        """Ballistic limits, m/s; NaN where there is none in the range of the search."""
        return searches.ballistic_limits(self.variants, self.threads)

    @cached_property
    def with_least_ceramic(self) -> Variants:
        """The variants with the least ceramic that defeats the impact; of NaN where none does."""
        return rows.with_thicknesses(self.variants, ceramic_mm=searches.least_ceramics_mm(self.variants, self.threads))

    @cached_property
    def with_least_backing(self) -> Variants:
        """The variants with the least back plate that defeats the impact; of NaN where none does."""
        return rows.with_thicknesses(self.variants, backing_mm=searches.least_backings_mm(self.variants, self.threads))

    @cached_property
    def in_proportion(self) -> Variants:
        """The variants made as thin, in proportion, as defeats the impact; of NaN where none does."""
        return searches.least_in_proportion(self.variants, self.threads)


class Quantity(NamedTuple):
    """A number, or the outcome, that a scenario answers."""

    label: str
    unit: str
    column: Callable[[Answers], Any]  # an entry a row; NaN where the question has no answer
    on_grid: bool = False  # needs the range of thicknesses of the section ``optimise``


def _lost_percent(before: Any, after: Any) -> Any:
    return 100.0 * (1.0 - after / before)


def _total_mm(variants: Variants) -> Floats:
    p = batch.fields(variants.parameters)
    found: Floats = (p.Hc0 + p.Hb) / MM
    return found


QUANTITIES: dict[str, Quantity] = {
    "outcome": Quantity("outcome", "", lambda a: np.where(a.perforated, "perforated", "defeated")),
    "residual_velocity_m_s": Quantity("residual velocity", "m/s", lambda a: a.residual_velocities),
    "residual_mass_g": Quantity(
        "residual mass", "g", lambda a: a.parameters.rho_p * cross_section(a.parameters.D0) * a.impacts.L / G
    ),
    "residual_length_mm": Quantity("residual length", "mm", lambda a: a.impacts.L / MM),
    "velocity_lost_percent": Quantity(
        "velocity lost", "%", lambda a: _lost_percent(a.variants.velocities, a.residual_velocities)
    ),
    "mass_lost_percent": Quantity("mass lost", "%", lambda a: _lost_percent(a.parameters.L0 / MM, a.impacts.L / MM)),
    "penetration_depth_mm": Quantity("penetration depth", "mm", lambda a: a.impacts.Z / MM),
    "bulge_height_mm": Quantity("bulge height", "mm", lambda a: a.impacts.h / MM),
    "plug_velocity_m_s": Quantity("plug velocity", "m/s", lambda a: np.where(a.perforated, a.impacts.W, 0.0)),
    "duration_us": Quantity("duration", "µs", lambda a: a.impacts.t / US),
    "areal_density_kg_m2": Quantity("areal density", "kg/m²", lambda a: a.variants.areal_densities_kg_m2),
    "ballistic_limit_m_s": Quantity("ballistic limit", "m/s", lambda a: a.ballistic_limits),
    "required_ceramic_thickness_mm": Quantity(
        "required ceramic thickness", "mm", lambda a: a.with_least_ceramic.ceramics_mm, on_grid=True
    ),
    "required_backing_thickness_mm": Quantity(
        "required back plate thickness", "mm", lambda a: a.with_least_backing.backings_mm, on_grid=True
    ),
    "required_total_thickness_mm": Quantity(
        "required thickness of both layers in proportion", "mm", lambda a: _total_mm(a.in_proportion), on_grid=True
    ),
    "required_areal_density_kg_m2": Quantity(
        "areal density with the required ceramic",
        "kg/m²",
        lambda a: a.with_least_ceramic.areal_densities_kg_m2,
        on_grid=True,
    ),
}


def label_and_unit(name: str) -> tuple[str, str]:
    """Return the label and the unit of a quantity, or of a key or an input of a scenario, by its name."""
    if name in QUANTITIES:
        return QUANTITIES[name].label, QUANTITIES[name].unit
    return words_and_unit(name)


def heading(name: str) -> str:
    """Return the label of a quantity, key or input with its unit, such as "ceramic thickness, mm"."""
    return ", ".join(part for part in label_and_unit(name) if part)
