"""Variants of a scenario as rows for the compiled engine, their ballistic limits and their least thicknesses."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.analysis.impact import unresolved_error
from armour.analysis.results import OnProgress, ignore_progress
from armour.core.search import DENSE_SCAN_POINTS, SCAN_POINTS, RunSettings, scan
from armour.core.state import Outcome
from armour.engine import batch
from armour.errors import mistake
from armour.evidence.mixture import Mixture
from armour.evidence.model_error import LAW_FIELDS, ErrorRows, errors_of, why_unknown
from armour.evidence.tests import Armours, Materials, is_unusual, limits_of_model, materials_of
from armour.scenario.inputs import OBLIQUITY, VELOCITY, YIELD, cosine_of, fields_of
from armour.scenario.library import DEFAULTS, strength_notes
from armour.scenario.scenario import Scenario
from armour.scenario.schema import FASTEST_M_S, SLOWEST_M_S, Optimise
from armour.units import MM

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
# Width, mm, to which a least thickness is bisected.
THICKNESS_TOLERANCE_MM = 1e-6
# Number of rows that are scanned at a time, to bound the memory.
SCANS_AT_A_TIME = 250
# Condition on m rows: a function of thicknesses, mm, (m,), and of the indices of the rows, (m,), that returns whether
# it holds, (m,).
RowCondition = Callable[[Floats, Ints], Bools]


class Thinnest(NamedTuple):
    """Least thicknesses of a layer that stop the impacts of n rows; arrays, (n,)."""

    mm: Floats  # NaN where none is found
    # Whether a thicker layer is known to be perforated; only rows that are unlike every test are searched for this.
    changes_again: Bools


class _Rows(NamedTuple):
    """Columns of `Variants`, which adds the methods: a named tuple cannot have cached properties."""

    parameters: Floats  # (n, fields), see `armour.engine.batch.packed`; thicknesses along the line of fire
    velocities: Floats  # impact velocities, m/s, (n,)
    cosines: Floats  # of the obliquities, (n,)
    material_of_row: Ints  # index of the materials of each row, (n,)
    scenario: Scenario  # gives the settings, and the values that the rows do not replace
    materials: tuple[Materials, ...]
    own_strength: bool = True  # whether the back plates have the strength of the library
    threads: int | None = None  # on which the engine computes; None for one per core


class Variants(_Rows):
    """n variants of a scenario, as arrays with a row for each: its impact, and the settings that all share."""

    def at(self, where: Ints | Bools | slice) -> "Variants":
        """Return some of the variants, given their indices, a mask or a slice."""
        return Variants._make([*(column[where] for column in self[:4]), *self[4:]])

    @property
    def settings(self) -> RunSettings:
        """Settings of the solver for every run."""
        solver = self.scenario.solver
        return RunSettings(solver.arrest_velocity_m_s, solver.time_step, solver.max_steps)

    @cached_property
    def errors(self) -> ErrorRows:
        """Distributions of the model error, actual over computed ballistic limit, of each row."""
        return errors_of(self.scenario, self.armours)

    @cached_property
    def armours(self) -> Armours:
        """The armours of the rows, for what the evidence says of them."""
        return Armours(batch.fields(self.parameters), self.cosines, self.material_of_row, self.materials)

    def by_law(self, law: int, errors: ErrorRows) -> "Variants":
        """Return the variants with the parameters by one of the laws in `errors`, given its index; 0 is their own."""
        return self.with_fields(dict(zip(LAW_FIELDS, errors.parameters[law], strict=True)))

    def with_fields(self, columns: Mapping[str, Floats | float]) -> "Variants":
        """Return the variants with other parameters: values in SI units, (n,) or a number, by field of the core."""
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

    def areal_densities_kg_m2(self, *, whole: bool = False) -> Floats:
        """Return areal densities, kg/m², (n,); a back plate that exists already counts only if `whole`."""
        p, counts = batch.fields(self.parameters), whole or self.scenario.counts_backing
        return (p.rho_c * p.Hc0 + p.rho_B * p.Hb * counts) * self.cosines + self.scenario.inert("areal_density_kg_m2")

    def is_unusual(self) -> Bools:
        """Return which rows are unlike every test that the model was compared with, (n,); see `is_unusual`."""
        return is_unusual(batch.fields(self.parameters))

    def impacts(self) -> batch.ImpactBatch:
        """Compute the impact of each row; raise an InputError if one does not end."""
        ends = batch.impacts(self.parameters, self.velocities, self.settings, self.threads)
        check_resolved(ends.outcome != Outcome.UNRESOLVED, self)
        return ends

    def perforated(self) -> Bools:
        """Return whether the impact of each row perforates, (n,)."""
        return self.impacts().outcome == Outcome.PERFORATED

    def with_thicknesses(
        self, *, ceramic_mm: Floats | float | None = None, backing_mm: Floats | float | None = None
    ) -> "Variants":
        """Return the variants with other thicknesses, mm, (n,) or a number; None leaves a layer as it is."""
        layers = {"Hc0": ceramic_mm, "Hb": backing_mm}
        return self.with_fields({key: mm / self.cosines * MM for key, mm in layers.items() if mm is not None})

    def limits_anywhere(self, on_progress: OnProgress = ignore_progress) -> Floats:
        """Return the ballistic limit of each row, m/s, (n,), also outside the range of the section.

        Rows without a limit in that range are searched from 20 to 10,000 m/s; a limit beyond is replaced by the nearer
        end.
        """
        slowest = min(self.scenario.ballistic_limit.velocity_min_m_s, SLOWEST_M_S)
        limits = ballistic_limits(self, on_progress=on_progress)
        outside = np.flatnonzero(np.isinf(limits))
        if len(outside):
            limits[outside] = ballistic_limits(self.at(outside), (slowest, FASTEST_M_S), on_progress=on_progress)
        return limits.clip(slowest, FASTEST_M_S)

    def lowest_limits(self, limits: Floats, on_progress: OnProgress = ignore_progress) -> Floats:
        """Return the given ballistic limits of the rows, m/s, (n,), or lower ones where a denser scan finds them."""
        section = self.scenario.ballistic_limit
        range_m_s = min(section.velocity_min_m_s, SLOWEST_M_S), FASTEST_M_S
        dense = ballistic_limits(self, range_m_s, points=DENSE_SCAN_POINTS, on_progress=on_progress)
        # Two limits of one change are within the tolerance of each other.
        return np.where(dense < limits - section.tolerance_m_s, dense.clip(range_m_s[0]), limits)

    def why_error_unknown(self) -> str:
        """Return why the model error is not known or not included, in words; the variants must be a single row."""
        if self.scenario.excludes_error():
            return "uncertainty.model excludes the model error"
        return why_unknown(self.scenario, self.armours)

    def shot_distributions(self, limits: Floats) -> Mixture:
        """Return the distributions of the velocities below which n armours stop a shot, given limits by the model, m/s.

        Their probabilities may be higher than the greatest ones that are stated, `ErrorRows.greatest`.
        """
        errors = self.errors
        return errors.of_shots.ratio.times(self.limits_by_law(errors, limits))

    def caveats(self) -> Iterator[tuple[str, int]]:
        """Yield the caveats about the rows, and on doubtful strengths of their metals, each with its number of rows."""
        metals = [materials.backing for materials in self.materials] if self.own_strength else []
        for note, rows in limits_of_model(self.armours, metals):
            yield str(note), int(np.count_nonzero(rows))
        armour = batch.fields(self.parameters)
        for bare in (False, True):
            if count := int(np.count_nonzero((armour.Hc0 == 0.0) == bare)):
                yield from ((str(note), count) for note in strength_notes(metals, bare=bare))

    def limits_by_law(self, errors: ErrorRows, own_limits: Floats) -> Floats:
        """Return the ballistic limits by each law in `errors`, m/s, (laws, n).

        Law 0 is the rows' own and has the given limits, (n,).  Limits by the others may lie outside the range of the
        section.  A row whose own limit is NaN has NaN for all laws.
        """
        limits = np.tile(own_limits, (len(errors.ratio.weights), 1))
        has_law = (errors.ratio.weights > 0.0) & ~np.isnan(own_limits)
        has_law[0] = False
        laws, rows = np.nonzero(has_law)
        parameters = zip(LAW_FIELDS, errors.parameters[laws, :, rows].T, strict=True)
        limits[laws, rows] = self.at(rows).with_fields(dict(parameters)).limits_anywhere()
        return limits

    def stops_again_above(self, limits: Floats) -> Bools:
        """Return which rows that are unlike every test stop a faster impact than their ballistic limit, m/s, (n,).

        A scan finds them; other rows (`is_unusual` is False) are not scanned, and are False.
        """
        section, changes_again = self.scenario.ballistic_limit, np.zeros(len(limits), dtype=bool)
        velocities = np.array(scan(section.velocity_min_m_s, section.velocity_max_m_s, DENSE_SCAN_POINTS))
        where = np.flatnonzero(self.is_unusual() & np.isfinite(limits))
        for start in range(0, len(where), SCANS_AT_A_TIME):
            part = where[start : start + SCANS_AT_A_TIME]
            row, place = np.nonzero(velocities > limits[part, None])
            faster = self.at(part[row])._replace(velocities=velocities[place])
            changes_again[part[row[~faster.perforated()]]] = True
        return changes_again

    def least_thicknesses(self, layer: str) -> Thinnest:
        """Return the least thickness of a layer, within its range of the section ``optimise``, that stops each impact.

        `layer` is "ceramic", "back plate" or "armour": both layers together, which keep their proportion and lie within
        their ranges.
        """
        grid, count = grid_of(self.scenario), len(self.velocities)
        ranges = {"ceramic_mm": grid.ceramic_thickness_mm, "backing_mm": grid.backing_thickness_mm}
        ceramics, backings = self.ceramics_mm, self.backings_mm
        total = ceramics + backings
        # Part of the thickness sought that each layer gets, (n,), by name.
        shares = {
            "ceramic": {"ceramic_mm": np.ones(count)},
            "back plate": {"backing_mm": np.ones(count)},
            "armour": {"ceramic_mm": ceramics / total, "backing_mm": backings / total},
        }[layer]
        low, high = np.zeros(count), np.full(count, np.inf)
        for name, share in shares.items():
            has_layer = share > 0.0
            low[has_layer] = np.maximum(low[has_layer], ranges[name].min / share[has_layer])
            high[has_layer] = np.minimum(high[has_layer], ranges[name].max / share[has_layer])
        where = np.flatnonzero(low <= high)

        def with_layer(values: Floats, rows: Ints) -> Variants:
            """Return the rows with these indices in `where`, with the thickness sought set to values, mm."""
            places = where[rows]
            return self.at(places).with_thicknesses(**{name: values * share[places] for name, share in shares.items()})

        least = Thinnest(np.full(count, np.nan), np.zeros(count, dtype=bool))
        least.mm[where], least.changes_again[where] = least_values_mm(
            lambda *at: ~with_layer(*at).perforated(), lambda *at: with_layer(*at).is_unusual(), low[where], high[where]
        )
        return least


def variants_of(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Variants:
    """Return `count` variants of a scenario; `columns` has their values, (count,), by name of input.

    Each row equals the scenario that `Scenario.with_inputs` returns for its values.
    """
    inputs: dict[str, Any] = scenario.inputs()
    if YIELD in columns:
        # The library derives these from the yield strength, which each row now gives.
        derived = scenario.entry("metal", scenario.armour.backing).derived
        inputs |= {f"backing.{key}": DEFAULTS[key][0] * columns[YIELD] for key in derived}
    inputs |= columns
    cosines = np.full(count, scenario.cosine())
    if OBLIQUITY in columns:
        # NumPy's cosine may differ from that of a single scenario in the last digit.
        cosines[:] = [cosine_of(obliquity) for obliquity in columns[OBLIQUITY].tolist()]
    rows = np.tile(batch.packed([scenario.core_armour()]), (count, 1))
    views = batch.fields(rows)
    for name, values in fields_of(inputs, cosines).items():
        getattr(views, name)[:] = values
    velocities = np.array(np.broadcast_to(inputs[VELOCITY], count), dtype=np.float64)
    own_strength = columns.keys().isdisjoint((YIELD, "backing.flow_stress_GPa"))
    material_of_row = np.zeros(count, dtype=np.int64)
    return Variants(rows, velocities, cosines, material_of_row, scenario, (materials_of(scenario),), own_strength)


def row_of(scenario: Scenario) -> Variants:
    """Return a scenario itself as a single row."""
    return variants_of(scenario, {}, 1)


def concatenated(parts: Sequence[Variants]) -> Variants:
    """Return variants of the same scenario and materials as one."""
    columns = (np.concatenate(column) for column in zip(*(part[:4] for part in parts), strict=True))
    return Variants._make([*columns, *parts[0][4:]])


def grid_of(scenario: Scenario) -> Optimise:
    """Return the section ``optimise`` of a scenario, which gives the ranges of thicknesses of the grid of designs.

    Raise an InputError if it is missing, or if it has ceramic thicknesses and the scenario no ceramic.
    """
    section = scenario.optimise
    if section is None:
        example = "ceramic_thickness_mm = { min = 4, max = 16, step = 0.5 } and backing_thickness_mm"
        message = f"is missing and must be given: the grid of designs, such as {example}"
        raise mistake(scenario.file, "optimise", message)
    if scenario.armour.ceramic is None and section.ceramic_thickness_mm.max > 0.0:
        message = "must name a ceramic of the library if optimise.ceramic_thickness_mm is above 0, found none"
        raise mistake(scenario.file, "armour.ceramic", message)
    return section


def check_resolved(resolved: Bools, variants: Variants) -> None:
    """Raise an InputError unless the runs of all rows ended; `resolved`, (n,), tells which did.

    The message is on the first run that did not end, and names the key at fault.
    """
    if not resolved.all():
        raise unresolved_error(variants.scenario, float(variants.velocities[int(np.argmin(resolved))]))


def ballistic_limits(
    variants: Variants,
    range_m_s: tuple[float, float] | None = None,
    *,
    tolerance: float | None = None,
    points: int | None = None,
    on_progress: OnProgress = ignore_progress,
) -> Floats:
    """Return the ballistic limit of each row, m/s; -inf where the lowest velocity perforates, inf where none does.

    Raise an InputError if a run does not end.  The limit equals that of
    `armour.analysis.ballistic_limit.ballistic_limit` to the last bit.  The range of velocities and the tolerance, m/s,
    are by default those of the section.  By default the scan has the usual number of points, or the dense one for
    unusual rows.
    """
    section = variants.scenario.ballistic_limit
    low, high = range_m_s or (section.velocity_min_m_s, section.velocity_max_m_s)
    tolerance = section.tolerance_m_s if tolerance is None else tolerance
    limits = np.empty(len(variants.velocities))
    dense = variants.is_unusual() if points is None else np.zeros(len(limits), dtype=bool)
    for rows, number in ((~dense, points or SCAN_POINTS), (dense, DENSE_SCAN_POINTS)):
        if rows.any():
            how = variants.settings, number, variants.threads
            brackets = batch.ballistic_limits(variants.parameters[rows], low, high, tolerance, *how)
            check_resolved(brackets.resolved, variants.at(rows)._replace(velocities=brackets.perforated))
            limits[rows] = np.where(np.isneginf(brackets.stopped), -np.inf, brackets.perforated)
            on_progress(int(brackets.runs.sum()), None)
    return limits


def bisect_rows(holds: RowCondition, rows: Ints, low: Floats, high: Floats) -> Floats:
    """Return the least thicknesses, mm, (m,), from which a condition holds, by bisection from `low` to `high`.

    `rows` are the indices of the rows.  The condition `holds` at the upper ends and not at the lower ones;
    the results are upper ends of narrow brackets.
    """
    low, high = low.copy(), high.copy()
    while True:
        middle = 0.5 * (low + high)
        places = np.flatnonzero((high - low > THICKNESS_TOLERANCE_MM) & (low < middle) & (middle < high))
        if not len(places):
            return high
        values = middle[places]
        is_met = holds(values, rows[places])
        high[places[is_met]] = values[is_met]
        low[places[~is_met]] = values[~is_met]


def least_values_mm(stops: RowCondition, is_unusual: RowCondition, low: Floats, high: Floats) -> Thinnest:
    """Return the least thickness from `low` to `high`, mm, (n,), that stops the impact of each row, if there is one.

    Bisection assumes that the outcome changes once at most.  Rows that are unusual, at the thickness found or by their
    other quantities if none is found, are scanned at many thicknesses instead.
    """
    rows = np.arange(len(low))
    least = np.where(stops(low, rows), low, np.nan)
    rest = rows[np.isnan(least)]
    rest = rest[stops(high[rest], rest)]
    least[rest] = bisect_rows(stops, rest, low[rest], high[rest])
    changes_again = np.zeros(len(least), dtype=bool)
    where = np.flatnonzero(is_unusual(least, np.arange(len(least))))
    for start in range(0, len(where), SCANS_AT_A_TIME):
        rows = where[start : start + SCANS_AT_A_TIME]
        values = np.linspace(low[rows], high[rows], DENSE_SCAN_POINTS, axis=1)
        stopped = stops(values.ravel(), np.repeat(rows, DENSE_SCAN_POINTS)).reshape(values.shape)
        first, numbers = stopped.argmax(axis=1), np.arange(len(rows))
        upper = bisect_rows(stops, rows, values[numbers, np.maximum(first - 1, 0)], values[numbers, first])
        least[rows] = np.where(stopped.any(axis=1), upper, np.nan)
        changes_again[rows] = (stopped[:, :-1] & ~stopped[:, 1:]).any(axis=1)
    return Thinnest(least, changes_again)
