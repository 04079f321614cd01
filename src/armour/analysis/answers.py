"""Quantities of variants of a scenario, computed by the engine when they are first needed."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from armour.analysis import searches
from armour.analysis import variants as rows
from armour.analysis.quantities import QUANTITIES
from armour.analysis.variants import Bools, Floats, Variants
from armour.core.equations import cross_section
from armour.core.state import Outcome
from armour.engine import batch
from armour.units import MM, G

AGAIN = "the outcome changes more than once with the impact velocity, and the lowest change is taken"
THICKER = "a thicker {} is perforated at a velocity that a thinner one stops"
# Searches of least thicknesses by layer; both in proportion for the armour.
LEAST = {
    "ceramic": searches.least_ceramics_mm,
    "back plate": searches.least_backings_mm,
    "armour": searches.least_totals_mm,
}


class Answers:
    """Answers about n variants, arrays of shape (n,); NaN where a question has no answer.

    Each computation is done once, when it is first needed.
    """

    def __init__(self, variants: Variants, threads: int | None = None) -> None:
        self.variants, self.threads = variants, threads
        self._least: dict[str, searches.Least] = {}

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

    def least(self, layer: str) -> searches.Least:
        """Return the least thicknesses of a layer, a key of `LEAST`, that defeat the impacts."""
        if layer not in self._least:
            self._least[layer] = LEAST[layer](self.variants, self.threads)
        return self._least[layer]

    @cached_property
    def with_least_ceramic(self) -> Variants:
        """The variants with the least ceramic thickness that defeats the impact."""
        return rows.with_thicknesses(self.variants, ceramic_mm=self.least("ceramic").mm)

    @cached_property
    def with_least_backing(self) -> Variants:
        """The variants with the least back plate thickness that defeats the impact."""
        return rows.with_thicknesses(self.variants, backing_mm=self.least("back plate").mm)

    @cached_property
    def residual_velocities(self) -> Floats:
        """Residual velocities, m/s; 0 where the impact is defeated."""
        return np.where(self.perforated, self.impacts.V, 0.0)

    @cached_property
    def residual_masses(self) -> Floats:
        """Residual masses of the penetrators, g."""
        found: Floats = self.fields.rho_p * cross_section(self.fields.D0) * self.impacts.L / G
        return found

    @property
    def fields(self) -> Any:
        """Parameters of the variants, a column each."""
        return batch.fields(self.variants.parameters)

    @property
    def outcomes(self) -> Any:
        """Outcomes of the impacts, in words."""
        return np.where(self.perforated, "perforated", "defeated")

    @property
    def velocities_lost(self) -> Floats:
        """Velocities lost, %."""
        return 100.0 * (1.0 - self.residual_velocities / self.variants.velocities)

    @property
    def masses_lost(self) -> Floats:
        """Masses lost, %."""
        found: Floats = 100.0 * (1.0 - (self.impacts.L / MM) / (self.fields.L0 / MM))
        return found

    @property
    def plug_velocities(self) -> Floats:
        """Velocities of the plugs, m/s; 0 where the impact is defeated."""
        return np.where(self.perforated, self.impacts.W, 0.0)

    @property
    def probabilities_of_defeat(self) -> Floats:
        """Probabilities of defeating the threats, given the error of the model."""
        found: Floats = self.variants.errors.probability_of_defeat(self.ballistic_limits, self.variants.velocities)
        return found

    def changes(self, quantities: Sequence[str]) -> dict[str, int]:
        """Return ways in which quantities are not all of the answer, in words, each with its number of rows."""
        found: dict[str, Bools] = {}
        if limits := [name for name in quantities if "ballistic_limit" in QUANTITIES[name].reads]:
            found[f"{', '.join(limits)}: {AGAIN}"] = searches.changes_above(
                self.variants, self.ballistic_limits, self.threads
            )
        for name in quantities:
            if layer := QUANTITIES[name].least:
                found[f"{name}: {THICKER.format(layer)}"] = self.least(layer).changes_again
        return {words: int(np.count_nonzero(rows)) for words, rows in found.items() if rows.any()}
