"""Quantities of variants of a scenario, computed by the engine when they are first needed."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from armour.analysis import searches
from armour.analysis import variants as rows
from armour.analysis.variants import Bools, Floats, Variants
from armour.core.equations import cross_section
from armour.core.state import Outcome
from armour.engine import batch
from armour.units import MM, US, G

AGAIN = "the outcome changes more than once with the impact velocity, and the lowest change is taken"
THICKER = "a thicker {} is perforated at a velocity that a thinner one stops"


class Answers:
    """Answers about n variants, arrays of shape (n,); NaN where a question has no answer.

    Each computation is done once, when it is first needed.
    """

    def __init__(self, variants: Variants, threads: int | None = None) -> None:
        self.variants, self.threads = variants, threads

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
    def ballistic_limits(self) -> Floats:
        """Ballistic limits, m/s."""
        return searches.ballistic_limits(self.variants, self.threads)

    @cached_property
    def least_ceramics(self) -> searches.Least:
        """Least ceramic thicknesses that defeat the impacts, mm."""
        return searches.least_ceramics_mm(self.variants, self.threads)

    @cached_property
    def least_backings(self) -> searches.Least:
        """Least back plate thicknesses that defeat the impacts, mm."""
        return searches.least_backings_mm(self.variants, self.threads)

    @cached_property
    def least_totals(self) -> searches.Least:
        """Least thicknesses of both layers in proportion that defeat the impacts, mm."""
        return searches.least_totals_mm(self.variants, self.threads)

    @cached_property
    def with_least_ceramic(self) -> Variants:
        """The variants with the least ceramic thickness that defeats the impact."""
        return rows.with_thicknesses(self.variants, ceramic_mm=self.least_ceramics.mm)

    @cached_property
    def with_least_backing(self) -> Variants:
        """The variants with the least back plate thickness that defeats the impact."""
        return rows.with_thicknesses(self.variants, backing_mm=self.least_backings.mm)

    @cached_property
    def residual_velocities(self) -> Floats:
        """Residual velocities, m/s; 0 where the impact is defeated."""
        return np.where(self.perforated, self.impacts.V, 0.0)

    @cached_property
    def residual_masses(self) -> Floats:
        """Residual masses of the penetrators, g."""
        p: Any = batch.fields(self.variants.parameters)
        found: Floats = p.rho_p * cross_section(p.D0) * self.impacts.L / G
        return found

    def changes(self, quantities: Sequence[str]) -> dict[str, int]:
        """Return ways in which quantities are not all of the answer, in words, each with its number of rows."""
        found: dict[str, Bools] = {}
        if limits := [name for name in quantities if name in LIMITS]:
            found[f"{', '.join(limits)}: {AGAIN}"] = searches.changes_above(
                self.variants, self.ballistic_limits, self.threads
            )
        for name in quantities:
            if name in LEAST:
                least, layer = LEAST[name]
                found[f"{name}: {THICKER.format(layer)}"] = least(self).changes_again
        return {words: int(np.count_nonzero(rows)) for words, rows in found.items() if rows.any()}


COLUMNS: dict[str, Callable[[Answers], Any]] = {
    "outcome": lambda a: np.where(a.perforated, "perforated", "defeated"),
    "residual_velocity_m_s": lambda a: a.residual_velocities,
    "residual_mass_g": lambda a: a.residual_masses,
    "residual_length_mm": lambda a: a.impacts.L / MM,
    "velocity_lost_percent": lambda a: 100.0 * (1.0 - a.residual_velocities / a.variants.velocities),
    "mass_lost_percent": lambda a: 100.0 * (1.0 - (a.impacts.L / MM) / (batch.fields(a.variants.parameters).L0 / MM)),
    "penetration_depth_mm": lambda a: a.impacts.Z / MM,
    "bulge_height_mm": lambda a: a.impacts.h / MM,
    "plug_velocity_m_s": lambda a: np.where(a.perforated, a.impacts.W, 0.0),
    "duration_us": lambda a: a.impacts.t / US,
    "areal_density_kg_m2": lambda a: a.variants.areal_densities_kg_m2,
    "ballistic_limit_m_s": lambda a: a.ballistic_limits,
    "probability_of_defeat": lambda a: a.variants.errors.probability_of_defeat(
        a.ballistic_limits, a.variants.velocities
    ),
    "required_ceramic_thickness_mm": lambda a: a.with_least_ceramic.ceramics_mm,
    "required_backing_thickness_mm": lambda a: a.with_least_backing.backings_mm,
    "required_total_thickness_mm": lambda a: a.least_totals.mm,
    "required_areal_density_kg_m2": lambda a: a.with_least_ceramic.areal_densities_kg_m2,
}

# Quantities that follow from the ballistic limit, and those that are a least thickness, with the layer.
LIMITS = "ballistic_limit_m_s", "probability_of_defeat"
LEAST: dict[str, tuple[Callable[[Answers], searches.Least], str]] = {
    "required_ceramic_thickness_mm": (lambda a: a.least_ceramics, "ceramic"),
    "required_backing_thickness_mm": (lambda a: a.least_backings, "back plate"),
    "required_total_thickness_mm": (lambda a: a.least_totals, "armour"),
    "required_areal_density_kg_m2": (lambda a: a.least_ceramics, "ceramic"),
}
