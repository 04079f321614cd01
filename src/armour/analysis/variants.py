"""Variants of a scenario as rows for the compiled engine, and the engine's answers to them."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.analysis.ballistic_limit import SCAN_POINTS, scan
from armour.analysis.impact import MAX_STEPS, unresolved_error
from armour.core.state import Outcome
from armour.engine import batch
from armour.errors import InputError, Problem
from armour.scenario.library import DEFAULTS, length_mm
from armour.scenario.loading import Scenario
from armour.scenario.parameters import FIELDS, ROD, VELOCITY, YIELD, entry_of, inputs_of
from armour.scenario.schema import BallisticLimitSection, Optimise, Solver
from armour.units import MM

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

# Width, mm, to which a least thickness is bisected.
THICKNESS_TOLERANCE_MM = 1e-6


class Settings(NamedTuple):
    """What the answers depend on besides parameters and velocities."""

    file: str  # for messages
    solver: Solver
    ballistic_limit: BallisticLimitSection
    grid: Optimise | None


class Variants(NamedTuple):
    """Variants of a scenario, a row each."""

    parameters: Floats  # (n, 13), see `armour.engine.batch.packed`
    velocities: Floats  # impact velocities, m/s, (n,)
    settings: Settings

    def at(self, where: Ints | Bools) -> "Variants":
        """Some of the rows."""
        return Variants(self.parameters[where], self.velocities[where], self.settings)

    @property
    def ceramics_mm(self) -> Floats:
        """Ceramic thicknesses, mm."""
        found: Floats = batch.fields(self.parameters).Hc0 / MM
        return found

    @property
    def backings_mm(self) -> Floats:
        """Back plate thicknesses, mm."""
        found: Floats = batch.fields(self.parameters).Hb / MM
        return found


def variants_of(scenario: Scenario, columns: Mapping[str, Floats], count: int) -> Variants:
    """Variants of a scenario whose named inputs differ from row to row.

    Each row is what `armour.scenario.parameters.with_inputs` makes of its values.

    Parameters
    ----------
    scenario : Scenario
    columns : mapping of str to array, (count,)
        Values by name of input; the others are the scenario's own.
    count : int
        Number of rows.
    """
    rows = np.tile(batch.packed([scenario.core_armour()]), (count, 1))
    field = batch.fields(rows)
    for name, values in columns.items():
        target = FIELDS[name]
        if target is not None:
            getattr(field, target[0])[:] = values * target[1]
    rod = {key: f"projectile.{key}" for key in ROD}
    if any(name in columns for name in rod.values()):
        own = inputs_of(scenario)
        field.L0[:] = length_mm(*(columns.get(name, own[name]) for name in rod.values())) * MM
    if YIELD in columns:
        entry = entry_of(scenario, "backing")
        assert entry is not None
        for key in entry.derived:
            target = FIELDS[f"backing.{key}"]
            if f"backing.{key}" not in columns and target is not None:
                getattr(field, target[0])[:] = DEFAULTS[key][0] * columns[YIELD] * target[1]
    velocities = np.array(np.broadcast_to(columns.get(VELOCITY, scenario.impact.velocity_m_s), count), dtype=np.float64)
    return Variants(rows, velocities, settings_of(scenario))


def concatenated(parts: Sequence[Variants]) -> Variants:
    """Concatenate variants with equal settings.

    Raises
    ------
    ValueError
        If their settings differ.
    """
    if any(part.settings != parts[0].settings for part in parts):
        raise ValueError("variants with different settings cannot be concatenated")
    parameters = np.concatenate([part.parameters for part in parts])
    return Variants(parameters, np.concatenate([part.velocities for part in parts]), parts[0].settings)


def grid_of(scenario: Scenario) -> Optimise:
    """Grid of designs of a scenario.

    Raises
    ------
    InputError
        If there is none, or it has a ceramic thickness but the scenario no ceramic.
    """
    section = scenario.optimise
    if section is None:
        problem = Problem(scenario.file, "optimise", "is missing and must be given: the grid of designs")
        raise InputError([problem])
    if scenario.armour.ceramic is None and section.ceramic_thickness_mm.max > 0.0:
        message = "must name a ceramic of the library where optimise.ceramic_thickness_mm is above 0, found none"
        raise InputError([Problem(scenario.file, "armour.ceramic", message)])
    return section


def settings_of(scenario: Scenario) -> Settings:
    """Settings of a scenario."""
    return Settings(scenario.file, scenario.solver, scenario.ballistic_limit, scenario.optimise)


def solver_options(solver: Solver, threads: int | None = None) -> batch.SolverOptions:
    """Options of the engine for a scenario's solver."""
    return batch.SolverOptions(solver.arrest_velocity_m_s, solver.time_step, MAX_STEPS, threads)


def impacts(variants: Variants, threads: int | None = None) -> batch.Impacts:
    """Simulate the impact of every row.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    options = solver_options(variants.settings.solver, threads)
    found = batch.impacts(variants.parameters, variants.velocities, options)
    _check_resolved(found.outcome != Outcome.UNRESOLVED, variants)
    return found


def perforated(variants: Variants, threads: int | None = None) -> Bools:
    """Whether the impact of each row perforates.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    found: Bools = impacts(variants, threads).outcome == Outcome.PERFORATED
    return found


def ballistic_limits(variants: Variants, tolerance: float | None = None, threads: int | None = None) -> Floats:
    """Ballistic limit of each row, m/s; NaN where it is outside the range of the search.

    Where the outcome changes once in that range, this is the upper end of the very bracket at which
    `armour.analysis.ballistic_limit.ballistic_limit` arrives.

    Parameters
    ----------
    variants : Variants
    tolerance : float, optional
        Width of the brackets, m/s, in place of the scenario's.
    threads : int, optional

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    section = variants.settings.ballistic_limit
    tolerance = section.tolerance_m_s if tolerance is None else tolerance
    options = solver_options(variants.settings.solver, threads)
    low, high = section.velocity_min_m_s, section.velocity_max_m_s
    found = batch.ballistic_limits(variants.parameters, low, high, tolerance, options)
    _check_resolved(found.resolved, variants)
    limits = np.full(len(variants.velocities), np.nan)
    where = np.flatnonzero(found.bounded)
    if len(where):
        bounded = variants.at(where)

        def holds(velocities: Floats, rows: Ints) -> Bools:
            return perforated(bounded.at(rows)._replace(velocities=velocities), threads)

        below, above = found.defeated[where], found.perforated[where]
        velocities = np.array(scan(low, high, SCAN_POINTS))
        starts, ends, below, above = _scan_interval(holds, velocities, below, above)
        limits[where] = bisect_rows(holds, starts, ends, tolerance, below, above)
    return limits


class Limits(NamedTuple):
    """Ballistic limits and what they took to find."""

    values: Floats  # m/s, (n,)
    runs: int  # impacts computed


def lowest_limits(variants: Variants, low: float, high: float, threads: int | None = None) -> Limits:
    """Find the lowest ballistic limit of each row between two velocities by scan and bisection.

    Nothing is taken for monotonic: these are the numbers, to the last bit, of
    `armour.analysis.ballistic_limit.ballistic_limit` with this range.

    Parameters
    ----------
    variants : Variants
    low, high : float
        Range of velocities, m/s.
    threads : int, optional

    Returns
    -------
    Limits
        -inf where already the lowest velocity perforates, inf where none does.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    velocities = np.array(scan(low, high, SCAN_POINTS))
    count = len(variants.velocities)
    scanned = variants.at(np.repeat(np.arange(count), len(velocities)))
    scanned = scanned._replace(velocities=np.tile(velocities, count))
    outcomes = perforated(scanned, threads).reshape(count, len(velocities))
    runs = outcomes.size

    limits = np.where(outcomes[:, 0], -np.inf, np.inf)
    where = np.flatnonzero(outcomes.any(axis=1) & ~outcomes[:, 0])
    bounded = variants.at(where)

    def holds(values: Floats, rows: Ints) -> Bools:
        nonlocal runs
        runs += len(values)
        return perforated(bounded.at(rows)._replace(velocities=values), threads)

    first = outcomes[where].argmax(axis=1)
    tolerance = variants.settings.ballistic_limit.tolerance_m_s
    limits[where] = bisect_rows(holds, velocities[first - 1], velocities[first], tolerance)
    return Limits(limits, runs)


def _scan_interval(
    holds: Callable[[Floats, Ints], Bools], values: Floats, below: Floats, above: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Interval of the scanned values in which the condition starts to hold, and the bracket within it."""
    index = np.searchsorted(values, above).clip(1)
    below, above = below.copy(), above.copy()
    while len(rows := np.flatnonzero((below < values[index - 1]) & (index > 1))):
        start = values[index[rows] - 1]
        beyond = holds(start, rows)
        above[rows[beyond]] = start[beyond]
        index[rows[beyond]] -= 1
        below[rows[~beyond]] = start[~beyond]
    return values[index - 1], values[index], below, above


def bisect_rows(
    holds: Callable[[Floats, Ints], Bools],
    low: Floats,
    high: Floats,
    tolerance: float,
    below: Floats | None = None,
    above: Floats | None = None,
) -> Floats:
    """Bisect many brackets at once, at whose upper ends alone a condition holds; return the upper ends.

    Parameters
    ----------
    holds : callable
        Whether the condition holds at values of some rows: ``holds(values, rows)``.
    low, high : array, (n,)
        Brackets.
    tolerance : float
        Width to which the brackets are narrowed.
    below, above : array, (n,), optional
        Narrower brackets known to contain the change: values outside them are not asked for.
    """
    low, high = low.copy(), high.copy()
    below, above = low if below is None else below, high if above is None else above
    while True:
        middle = 0.5 * (low + high)
        rows = np.flatnonzero((high - low > tolerance) & (low < middle) & (middle < high))
        if not len(rows):
            return high
        values = middle[rows]
        good = values >= above[rows]
        unknown = ~good & (values > below[rows])
        good[unknown] = holds(values[unknown], rows[unknown])
        high[rows[good]] = values[good]
        low[rows[~good]] = values[~good]


def least_ceramics_mm(variants: Variants, threads: int | None = None) -> Floats:
    """Least ceramic thickness of the grid's range that defeats the impact of each row, mm; NaN where none does.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    assert variants.settings.grid is not None, "checked before"
    section = variants.settings.grid.ceramic_thickness_mm
    options = solver_options(variants.settings.solver, threads)
    tolerance = THICKNESS_TOLERANCE_MM * MM
    found = batch.least_thicknesses(
        variants.parameters, variants.velocities, section.min * MM, section.max * MM, tolerance, options
    )
    _check_resolved(found.resolved, variants)

    # Of a thickness the perforated end of the bracket is the lower one.
    below, above = found.perforated / MM, found.defeated / MM
    least = np.where(np.isfinite(above) & ~np.isfinite(below), section.min, np.nan)
    where = np.flatnonzero(np.isfinite(above) & np.isfinite(below))
    bounded = variants.at(where)

    def defeated(values: Floats, rows: Ints) -> Bools:
        return ~perforated(with_thicknesses(bounded.at(rows), ceramic_mm=values), threads)

    low, high = np.full(len(where), section.min), np.full(len(where), section.max)
    least[where] = bisect_rows(defeated, low, high, THICKNESS_TOLERANCE_MM, below[where], above[where])
    return least


def least_backings_mm(variants: Variants, threads: int | None = None) -> Floats:
    """Least back plate thickness of the grid's range that defeats the impact of each row, mm; NaN where none does.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    assert variants.settings.grid is not None, "checked before"
    section = variants.settings.grid.backing_thickness_mm

    def defeated(values: Floats, rows: Ints) -> Bools:
        return ~perforated(with_thicknesses(variants.at(rows), backing_mm=values), threads)

    count = len(variants.velocities)
    return least_values_mm(defeated, np.full(count, section.min), np.full(count, section.max))


def least_in_proportion(variants: Variants, threads: int | None = None) -> Variants:
    """The variants made as thin, in proportion, as defeats the impact, both layers within the grid's ranges.

    Rows of which no thickness of these proportions defeats the impact have NaN thicknesses.

    Raises
    ------
    InputError
        If a run does not end, naming the key at fault.
    """
    grid = variants.settings.grid
    assert grid is not None, "checked before"
    ceramics, backings = variants.ceramics_mm, variants.backings_mm
    totals = ceramics + backings
    low, high = grid.backing_thickness_mm.min / backings, grid.backing_thickness_mm.max / backings
    layered = ceramics > 0.0
    low[layered] = np.maximum(low[layered], grid.ceramic_thickness_mm.min / ceramics[layered])
    high[layered] = np.minimum(high[layered], grid.ceramic_thickness_mm.max / ceramics[layered])
    where = np.flatnonzero(low <= high)

    def scaled(values: Floats, rows: Ints) -> Variants:
        some = where[rows]
        return with_thicknesses(
            variants.at(some),
            ceramic_mm=values * ceramics[some] / totals[some],
            backing_mm=values * backings[some] / totals[some],
        )

    least = least_values_mm(
        lambda values, rows: ~perforated(scaled(values, rows), threads),
        low[where] * totals[where],
        high[where] * totals[where],
    )
    found = with_thicknesses(variants, ceramic_mm=np.nan, backing_mm=np.nan)
    found.parameters[where] = scaled(least, np.arange(len(where))).parameters
    return found


def least_values_mm(defeated: Callable[[Floats, Ints], Bools], low: Floats, high: Floats) -> Floats:
    """Least thickness between two that defeats the threat in each row, mm; NaN where the largest does not.

    Parameters
    ----------
    defeated : callable
        Whether thicknesses of some rows defeat the threat: ``defeated(values, rows)``.
    low, high : array, (n,)
        Ranges of thicknesses, mm.
    """
    rows = np.arange(len(low))
    least = np.where(defeated(low, rows), low, np.nan)
    rest = rows[np.isnan(least)]
    rest = rest[defeated(high[rest], rest)]
    least[rest] = bisect_rows(
        lambda values, some: defeated(values, rest[some]), low[rest], high[rest], THICKNESS_TOLERANCE_MM
    )
    return least


def with_thicknesses(
    variants: Variants, *, ceramic_mm: Floats | float | None = None, backing_mm: Floats | float | None = None
) -> Variants:
    """The variants with other thicknesses, mm."""
    parameters = variants.parameters.copy()
    field = batch.fields(parameters)
    if ceramic_mm is not None:
        field.Hc0[:] = np.asarray(ceramic_mm) * MM
    if backing_mm is not None:
        field.Hb[:] = np.asarray(backing_mm) * MM
    return variants._replace(parameters=parameters)


def areal_densities_kg_m2(variants: Variants) -> Floats:
    """Areal density of each row, kg/m^2."""
    p = batch.fields(variants.parameters)
    found: Floats = p.rho_c * p.Hc0 + p.rho_B * p.Hb
    return found


def _check_resolved(resolved: Bools, variants: Variants) -> None:
    if not resolved.all():
        first = int(np.argmin(resolved))
        raise unresolved_error(variants.settings.solver, variants.settings.file, float(variants.velocities[first]))
