"""Variants of a scenario as rows for the compiled engine."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.analysis.impact import unresolved_error
from armour.core.state import Outcome
from armour.engine import batch
from armour.errors import mistake
from armour.evidence.model_error import LAW_FIELDS, Errors, errors_of
from armour.evidence.tests import Armours, Materials, armours_of, is_unusual, limits_outside
from armour.scenario.inputs import LAYERS, OBLIQUITY, VELOCITY, YIELD, cosine_of, fields_of
from armour.scenario.library import DEFAULTS, ROD, length_mm, strength_notes
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Optimise
from armour.units import MM

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Variants(NamedTuple):
    """n variants of a scenario."""

    parameters: Floats  # (n, fields), see `armour.engine.batch.packed`; thicknesses along the line of fire
    velocities: Floats  # impact velocities, m/s, (n,)
    cosines: Floats  # of the obliquities, (n,)
    material_of_row: Ints  # index of the materials of each row, (n,)
    scenario: Scenario  # gives the settings, and the values that the rows do not replace
    materials: tuple[Materials, ...]
    own_strength: bool = True  # whether the back plates have the strength of the library
    threads: int | None = None  # on which the engine computes; None for one per core

    def at(self, where: Ints | Bools | slice) -> "Variants":
        """Return the rows at some places."""
        return Variants._make([*(column[where] for column in self[:4]), *self[4:]])

    @property
    def options(self) -> batch.SolverOptions:
        """Options of the engine."""
        solver = self.scenario.solver
        return batch.SolverOptions(solver.arrest_velocity_m_s, solver.time_step, solver.max_steps, self.threads)

    @property
    def grid(self) -> Optimise:
        """Ranges of thicknesses; `grid_of` checks that the scenario has them."""
        assert self.scenario.optimise is not None, "checked before"
        return self.scenario.optimise

    @property
    def errors(self) -> Errors:
        """Errors of the model."""
        return errors_of(self.scenario, self.armours)

    @property
    def armours(self) -> Armours:
        """The armours of the rows."""
        return Armours(batch.fields(self.parameters), self.cosines, self.material_of_row, self.materials)

    def by_law(self, law: int, errors: Errors) -> "Variants":
        """Return the variants with the parameters of a law of their errors."""
        return self.with_fields(dict(zip(LAW_FIELDS, errors.parameters[law], strict=True)))

    def with_fields(self, columns: Mapping[str, Floats | float]) -> "Variants":
        """Return the variants with other parameters of the core, by field."""
        parameters = self.parameters.copy()
        for field, values in columns.items():
            getattr(batch.fields(parameters), field)[:] = values
        return self._replace(parameters=parameters)

    @property
    def ceramics_mm(self) -> Floats:
        """Ceramic thicknesses, mm, (n,)."""
        return batch.fields(self.parameters).Hc0 / MM * self.cosines

    @property
    def backings_mm(self) -> Floats:
        """Back plate thicknesses, mm, (n,)."""
        return batch.fields(self.parameters).Hb / MM * self.cosines

    @property
    def areal_densities_kg_m2(self) -> Floats:
        """Areal densities, kg/m², (n,)."""
        p = batch.fields(self.parameters)
        return (p.rho_c * p.Hc0 + p.rho_B * p.Hb) * self.cosines


def variants_of(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Variants:
    """Return n variants of a scenario with given values, (n,), of some of its named inputs.

    Each row equals the scenario that `Scenario.with_inputs` makes of its values.
    """
    rows = np.tile(batch.packed([scenario.core_armour()]), (count, 1))
    cosines = np.full(count, scenario.cosine())
    if OBLIQUITY in columns:
        # NumPy's cosine may differ from that of a single scenario in the last digit.
        cosines[:] = [cosine_of(obliquity) for obliquity in columns[OBLIQUITY].tolist()]
        inputs = scenario.inputs()
        columns = {**{name: np.full(count, inputs[name]) for name in LAYERS if name in inputs}, **columns}
    if YIELD in columns:
        derived = scenario.entry("metal", scenario.armour.backing).derived
        columns = {**{f"backing.{key}": DEFAULTS[key][0] * columns[YIELD] for key in derived}, **columns}
    field = batch.fields(rows)
    for name, values in fields_of(columns, cosines).items():
        getattr(field, name)[:] = values
    rod = [f"projectile.{key}" for key in ROD]
    if any(name in columns for name in rod):
        inputs = scenario.inputs()
        field.L0[:] = length_mm(*(columns.get(name, inputs[name]) for name in rod)) * MM
    velocities = np.array(np.broadcast_to(columns.get(VELOCITY, scenario.impact.velocity_m_s), count), dtype=np.float64)
    own_strength = columns.keys().isdisjoint((YIELD, "backing.flow_stress_GPa"))
    materials = armours_of(scenario).materials
    return Variants(
        rows, velocities, cosines, np.zeros(count, dtype=np.int64), scenario, tuple(materials), own_strength
    )


def concatenated(parts: Sequence[Variants]) -> Variants:
    """Concatenate variants of a scenario."""
    columns = (np.concatenate(column) for column in zip(*(part[:4] for part in parts), strict=True))
    return Variants._make([*columns, *parts[0][4:]])


def outside_limits(variants: Variants, *, velocities: bool = True) -> Iterator[tuple[str, int]]:
    """Yield the limits of the tested range that some rows lie outside, and the number of these rows."""
    speeds = variants.velocities if velocities else np.full_like(variants.velocities, np.nan)
    for limit in limits_outside(variants.armours, speeds):
        yield f"{limit.key}: {limit.words}", len(limit.rows)
    armour = batch.fields(variants.parameters)
    for bare in (False, True):
        if count := int(np.count_nonzero((armour.Hc0 == 0.0) == bare)):
            metals = [variants.scenario.entry("metal", variants.scenario.armour.backing)] * variants.own_strength
            yield from ((note, count) for note in strength_notes(metals, bare=bare))


def unusual(variants: Variants) -> Bools:
    """Return which rows are far from all tests that the model was compared with."""
    return is_unusual(batch.fields(variants.parameters))


def grid_of(scenario: Scenario) -> Optimise:
    """Return the grid of designs of a scenario; it must have one, and a ceramic if the grid has."""
    section = scenario.optimise
    if section is None:
        example = "ceramic_thickness_mm = { min = 4, max = 16, step = 0.5 } and backing_thickness_mm"
        message = f"is missing and must be given: the grid of designs, such as {example}"
        raise mistake(scenario.file, "optimise", message)
    if scenario.armour.ceramic is None and section.ceramic_thickness_mm.max > 0.0:
        message = "must name a ceramic of the library if optimise.ceramic_thickness_mm is above 0, found none"
        raise mistake(scenario.file, "armour.ceramic", message)
    return section


def impacts(variants: Variants) -> batch.Impacts:
    """Simulate the impact of each row."""
    ends = batch.impacts(variants.parameters, variants.velocities, variants.options)
    check_resolved(ends.outcome != Outcome.UNRESOLVED, variants)
    return ends


def perforated(variants: Variants) -> Bools:
    """Return whether the impact of each row perforates."""
    return impacts(variants).outcome == Outcome.PERFORATED


def check_resolved(resolved: Bools, variants: Variants) -> None:
    """Raise an InputError that names the key at fault if the run of a row does not end."""
    if not resolved.all():
        first = int(np.argmin(resolved))
        raise unresolved_error(variants.scenario, float(variants.velocities[first]))


def with_thicknesses(
    variants: Variants, *, ceramic_mm: Floats | float | None = None, backing_mm: Floats | float | None = None
) -> Variants:
    """Return the variants with other thicknesses, mm."""
    layers = {"Hc0": ceramic_mm, "Hb": backing_mm}
    return variants.with_fields({key: mm / variants.cosines * MM for key, mm in layers.items() if mm is not None})
