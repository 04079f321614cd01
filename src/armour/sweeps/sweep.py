"""Sweeps: any numeric keys of a scenario over grids, or a table of cases, by the compiled engine, chunk by chunk."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from armour.analysis.least_thickness import THICKNESS_TOLERANCE_MM, solver_options
from armour.analysis.quantities import QUANTITIES
from armour.core.equations import cross_section
from armour.core.state import Outcome
from armour.errors import InputError, Problem, suggestion
from armour.files import reason
from armour.scenario.assignments import changes_of_values
from armour.scenario.loading import Scenario
from armour.scenario.parameters import INPUTS, check_ranges, rows_of
from armour.scenario.schema import MAX_VALUES, Range
from armour.sweeps.checkpoint import Store
from armour.units import MM, US, G, words_and_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from armour.engine.batch import SolverOptions

    Floats = NDArray[np.float64]

# Rows that are computed, written and, on a cluster, sent at a time.
CHUNK = 50_000

IMPACT_QUANTITIES = (
    "outcome",
    "residual_velocity_m_s",
    "residual_mass_g",
    "residual_length_mm",
    "velocity_lost_percent",
    "mass_lost_percent",
    "penetration_depth_mm",
    "bulge_height_mm",
    "plug_velocity_m_s",
    "duration_us",
)
THICKNESS_QUANTITIES = ("required_ceramic_thickness_mm", "required_areal_density_kg_m2")
SWEPT = (*IMPACT_QUANTITIES, "areal_density_kg_m2", "ballistic_limit_m_s", *THICKNESS_QUANTITIES)


class Settings(NamedTuple):
    """What the engine is told beside armours and velocities, SI."""

    told: "SolverOptions"
    limit_low: float
    limit_high: float
    limit_tolerance: float
    thin: float
    thick: float


class Group(NamedTuple):
    """Rows with the same settings: all that a worker needs."""

    where: "NDArray[np.int64]"  # their places in the chunk
    armours: "Floats"  # as `armour.engine.batch.packed` has them
    velocities: "Floats"
    settings: Settings


@dataclass(frozen=True)
class Axis:
    """A key and the values that it takes."""

    key: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Grid:
    """Every combination of the values of some axes; the last one changes fastest."""

    axes: tuple[Axis, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the axes."""
        return tuple(axis.key for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of combinations."""
        return prod(len(axis.values) for axis in self.axes)

    def chunks(self, size: int) -> Iterator[dict[str, "Floats"]]:
        """The combinations, so many at a time."""
        import numpy as np

        shape = [len(axis.values) for axis in self.axes]
        values = [np.array(axis.values) for axis in self.axes]
        for start in range(0, self.count, size):
            places = np.unravel_index(np.arange(start, min(start + size, self.count)), shape)
            yield {axis.key: v[i] for axis, v, i in zip(self.axes, values, places, strict=True)}


class Cases:
    """The rows of a CSV file whose header names keys of the scenario.

    Raises
    ------
    InputError
        If the file cannot be read or is no table of numbers.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.count = 0
        for batch in self._batches():
            self.keys = tuple(batch.schema.names)
            self.count += batch.num_rows
        if not self.count:
            raise InputError([Problem(str(path), "", "must have a header of keys and at least one row of numbers")])

    def chunks(self, size: int) -> Iterator[dict[str, "Floats"]]:
        """The rows, so many at a time."""
        import numpy as np

        kept: dict[str, Floats] = {}
        for batch in self._batches():
            columns = {name: batch.column(name).to_numpy(zero_copy_only=False) for name in self.keys}
            kept = {key: np.concatenate([kept[key], column]) if kept else column for key, column in columns.items()}
            while len(kept[self.keys[0]]) >= size:
                yield {key: column[:size] for key, column in kept.items()}
                kept = {key: column[size:] for key, column in kept.items()}
        if len(kept[self.keys[0]]):
            yield kept

    def _batches(self) -> Iterator[Any]:
        """Batches of the file, every column as numbers."""
        import pyarrow as pa
        from pyarrow import csv

        try:
            with csv.open_csv(self.path) as first:
                types = {name: pa.float64() for name in first.schema.names}
            options = csv.ConvertOptions(column_types=types, strings_can_be_null=False)
            with csv.open_csv(self.path, convert_options=options) as reader:
                for batch in reader:
                    for name in batch.schema.names:
                        if batch.column(name).null_count:
                            raise pa.ArrowInvalid(f"column {name} has empty values")
                    yield batch
        except pa.ArrowInvalid as error:
            message = f"must be a table of numbers below a header of keys: {error}"
            raise InputError([Problem(str(self.path), "", message)]) from None
        except OSError as error:
            raise InputError([Problem(str(self.path), "", f"cannot be read: {reason(error)}")]) from None


# Where the rows of a sweep come from.
Source = Grid | Cases


def axis_of(text: str) -> Axis:
    """An axis from ``KEY=MIN:MAX:STEP`` or ``KEY=VALUE,VALUE,...``.

    Raises
    ------
    InputError
        If the text is neither.
    """
    key, _, values = text.rpartition("=")
    key = key.strip()
    try:
        if ":" in values:
            low, high, step = (float(part) for part in values.split(":"))
            found = Range.model_validate({"min": low, "max": high, "step": step}).values()
        else:
            found = tuple(float(part) for part in values.split(","))
        if key and len(found) <= MAX_VALUES:
            return Axis(key, found)
    except ValueError:
        pass
    message = f'must be KEY=MIN:MAX:STEP or KEY=VALUE,VALUE,... of at most {MAX_VALUES} numbers, found "{text}"'
    raise InputError([Problem("sweep", "--over", message)])


def check_sweep(scenario: Scenario, source: Source, quantities: Sequence[str]) -> None:
    """Make sure, before long work, that keys and quantities are known.

    Raises
    ------
    InputError
        With everything that is wrong.
    """
    problems = []
    for name in quantities:
        if name not in SWEPT:
            hint = suggestion(name, SWEPT) or f"; there are {', '.join(SWEPT)}"
            problems.append(Problem("sweep", "--quantities", f'must be of quantities, found "{name}"{hint}'))
    if len(set(source.keys)) != len(source.keys):
        problems.append(Problem("sweep", "--over", "must not name a key twice"))
    if scenario.optimise is None and any(name in THICKNESS_QUANTITIES for name in quantities):
        message = "is missing and must be given: the range of required thicknesses"
        problems.append(Problem(scenario.file, "optimise", message))
    if problems:
        raise InputError(problems)


def groups_of(scenario: Scenario, columns: Mapping[str, "Floats"]) -> list[Group]:
    """What the engine is to compute for the rows of a chunk.

    Raises
    ------
    InputError
        If a value is not allowed.
    """
    import numpy as np

    count = len(next(iter(columns.values())))
    # Inputs go straight into the engine's arrays; another key makes a scenario of each of its values.
    slow = [key for key in columns if key not in INPUTS]
    quick = {key: columns[key] for key in columns if key in INPUTS}
    check_ranges(scenario, quick)
    if slow:
        table = np.column_stack([columns[key] for key in slow])
        _, first, which = np.unique(table, axis=0, return_index=True, return_inverse=True)
        kinds = [dict(zip(slow, table[i].tolist(), strict=True)) for i in first]
        places = [np.flatnonzero(which.reshape(-1) == i) for i in range(len(kinds))]
    else:
        kinds, places = [{}], [np.arange(count)]
    groups = []
    for kind, where in zip(kinds, places, strict=True):
        changed = scenario.replaced(changes_of_values(kind)) if kind else scenario
        armours, velocities = rows_of(changed, {key: quick[key][where] for key in quick}, len(where))
        groups.append(Group(where, armours, velocities, settings_of(changed)))
    return groups


def settings_of(scenario: Scenario) -> Settings:
    """What the engine is told beside armours and velocities."""
    limit, grid = scenario.ballistic_limit, scenario.optimise
    return Settings(
        told=solver_options(scenario),
        limit_low=limit.velocity_min_m_s,
        limit_high=limit.velocity_max_m_s,
        limit_tolerance=limit.tolerance_m_s,
        thin=grid.ceramic_thickness_mm.min * MM if grid else 0.0,
        thick=grid.ceramic_thickness_mm.max * MM if grid else 0.0,
    )


def computed(groups: Sequence[Group], quantities: Sequence[str], threads: int | None = None) -> dict[str, Any]:
    """The quantities of a chunk's rows; NaN, or an empty text, where a question has no answer."""
    import numpy as np

    count = sum(len(group.where) for group in groups)
    columns = {
        name: np.full(count, "", dtype=object) if name == "outcome" else np.full(count, np.nan) for name in quantities
    }
    for group in groups:
        for name, values in _of_group(group, quantities, threads).items():
            columns[name][group.where] = values
    return columns


def _of_group(group: Group, quantities: Sequence[str], threads: int | None) -> dict[str, Any]:
    """The quantities of rows with the same settings."""
    import numpy as np

    from armour.engine import batch

    a = batch.fields(group.armours)
    found: dict[str, Any] = {}
    s = group.settings
    told = s.told._replace(threads=threads)
    if "areal_density_kg_m2" in quantities:
        found["areal_density_kg_m2"] = a.rho_c * a.Hc0 + a.rho_B * a.Hb
    if any(name in IMPACT_QUANTITIES for name in quantities):
        end = batch.impacts(group.armours, group.velocities, told)
        perforated, resolved = end.outcome == Outcome.PERFORATED, end.outcome != Outcome.UNRESOLVED
        residual = np.where(perforated, end.V, 0.0)
        everything = {
            "residual_velocity_m_s": residual,
            "residual_mass_g": a.rho_p * cross_section(a.D0) * end.L / G,
            "residual_length_mm": end.L / MM,
            "velocity_lost_percent": 100.0 * (1.0 - residual / group.velocities),
            "mass_lost_percent": 100.0 * (1.0 - end.L / a.L0),
            "penetration_depth_mm": end.Z / MM,
            "bulge_height_mm": end.h / MM,
            "plug_velocity_m_s": np.where(perforated, end.W, 0.0),
            "duration_us": end.t / US,
        }
        found |= {name: np.where(resolved, values, np.nan) for name, values in everything.items() if name in quantities}
        if "outcome" in quantities:
            found["outcome"] = np.where(resolved, np.where(perforated, "perforated", "defeated"), "")
    if "ballistic_limit_m_s" in quantities:
        places = batch.ballistic_limits(group.armours, s.limit_low, s.limit_high, s.limit_tolerance, told)
        found["ballistic_limit_m_s"] = np.where(places.bounded, places.perforated, np.nan)
    if any(name in THICKNESS_QUANTITIES for name in quantities):
        tolerance = THICKNESS_TOLERANCE_MM * MM
        places = batch.least_thicknesses(group.armours, group.velocities, s.thin, s.thick, tolerance, told)
        least = np.where(np.isfinite(places.defeated), places.defeated, np.nan)
        if "required_ceramic_thickness_mm" in quantities:
            found["required_ceramic_thickness_mm"] = least / MM
        if "required_areal_density_kg_m2" in quantities:
            found["required_areal_density_kg_m2"] = a.rho_c * least + a.rho_B * a.Hb
    return found


def words_of(name: str) -> str:
    """A key or a quantity in words, with its unit."""
    if name in QUANTITIES:
        quantity = QUANTITIES[name]
        return f"{quantity.words}, {quantity.unit}" if quantity.unit else quantity.words
    words, unit = words_and_unit(name)
    return f"{words}, {unit}" if unit else words


# Computes chunks, given by their number and groups, in whatever order.
Compute = Callable[[Iterator[tuple[int, list[Group]]], Sequence[str]], Iterator[tuple[int, dict[str, Any]]]]
# Told of the rows of every chunk as it is done, and whether it was there before.
OnChunk = Callable[[int, bool], None]


def here(threads: int | None = None) -> Compute:
    """Compute chunks in this process, one after the other, each on all threads."""

    def compute(
        chunks: Iterator[tuple[int, list[Group]]], quantities: Sequence[str]
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        for index, groups in chunks:
            yield index, computed(groups, quantities, threads)

    return compute


def job_of(scenario: Scenario, source: Source, quantities: Sequence[str], size: int) -> str:
    """What tells a sweep from any other: all that its numbers depend on."""
    rows = source.axes if isinstance(source, Grid) else sha256(source.path.read_bytes()).hexdigest()
    from armour.engine import compiled

    told = (compiled.digest(), repr(scenario), repr(scenario.core_armour()), rows, tuple(quantities), size)
    return sha256(repr(told).encode()).hexdigest()


def sweep(
    scenario: Scenario,
    source: Source,
    quantities: Sequence[str],
    output: Path,
    *,
    compute: Compute | None = None,
    size: int = CHUNK,
    on_chunk: OnChunk | None = None,
) -> int:
    """Compute quantities of a scenario for every row of a source, and write them to a table.

    Chunks are written as they are done; the same call goes on where an interrupted one stopped.

    Parameters
    ----------
    scenario : Scenario
    source : Grid or Cases
        Which values its keys take.
    quantities : sequence of str
        Of `SWEPT`.
    output : Path
        CSV or Parquet, by its ending.
    compute : callable, optional
        How chunks are computed; by default `here`.
    size : int
        Rows of a chunk.
    on_chunk : callable, optional
        Told of the rows of every chunk, and whether it was there before.

    Returns
    -------
    int
        The number of rows.

    Raises
    ------
    InputError
        If a key, a value or a quantity is not allowed, or the output cannot be written.
    """
    check_sweep(scenario, source, quantities)
    store = Store(output, job_of(scenario, source, quantities, size))
    waiting: dict[int, Mapping[str, Floats]] = {}
    told = on_chunk or (lambda _rows, _before: None)
    number = 0

    def to_do() -> Iterator[tuple[int, list[Group]]]:
        nonlocal number
        for index, columns in enumerate(source.chunks(size)):
            number = index + 1
            if store.has(index):
                told(len(columns[source.keys[0]]), True)
            else:
                waiting[index] = columns
                yield index, groups_of(scenario, columns)

    for index, results in (compute or here())(to_do(), quantities):
        columns = waiting.pop(index)
        store.save(index, {**columns, **results})
        told(len(columns[source.keys[0]]), False)
    store.finish(number)
    return source.count
