"""The lightest design of a grid that defeats the threat."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, Any

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.least_thickness import Design, defeats_threat, design, grid, least_ceramics_mm
from armour.errors import NoDesignError, NoLimitError
from armour.scenario.applicability import warnings_of
from armour.scenario.loading import Scenario
from armour.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# Ceramic thicknesses of a column that are tried before it is bisected.
PROBES = 9
# Tolerance of the continuous optimum's backing, mm.
BACKING_TOLERANCE_MM = 1e-3
# How many times closer together the backings of one round of that search are than those of the last.
CLOSER = 10


@dataclass(frozen=True)
class BestDesign(Design):
    """The lightest design, with its ballistic limit; None where that lies outside the range of its search."""

    ballistic_limit_m_s: float | None


@dataclass(frozen=True)
class Column:
    """What one backing thickness of the grid needs.

    Attributes
    ----------
    design : Design or None
        The thinnest ceramic of the grid that defeats the threat; None where none does.
    monotonic : bool
        Whether every thicker ceramic that was tried defeats it too.
    runs : int
        Impacts that were computed.
    """

    design: Design | None
    monotonic: bool
    runs: int


# Told of every column as it is done, and how many there are in all.
OnColumn = Callable[[Column, int], None]


@dataclass(frozen=True)
class OptimumResult:
    """The lightest design, and what each backing needs.

    Attributes
    ----------
    best : BestDesign
        Lightest design of the grid.
    frontier : tuple of Design
        For each backing thickness the thinnest ceramic that defeats the threat.
    refined : BestDesign or None
        Lightest design between and beside the grid's values, where it was asked for.
    runs : int
        Impacts that were computed for the frontier.
    not_monotonic_mm : tuple of float
        Backing thicknesses at which a thicker ceramic was found to be perforated, mm.
    warnings : tuple of str
        What of the lightest design is outside the data that the model was tested on.
    """

    best: BestDesign
    frontier: tuple[Design, ...]
    refined: BestDesign | None
    runs: int
    not_monotonic_mm: tuple[float, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data; ``refined`` only where it was asked for."""
        data = asdict(self)
        if self.refined is None:
            del data["refined"]
        return data


def optimise(
    scenario: Scenario,
    *,
    full_grid: bool = False,
    refine: bool = False,
    on_column: OnColumn | None = None,
) -> OptimumResult:
    """Find the lightest design that defeats the scenario's impact.

    Parameters
    ----------
    scenario : Scenario
        Its section ``optimise`` gives the grid, its impact the threat.
    full_grid : bool
        Compute every design, instead of bisecting where defeat is monotonic in ceramic thickness.
    refine : bool
        Also find the optimum of continuous thicknesses within the grid's range.
    on_column : callable, optional
        Called with each column as it is done, and the number of columns in all.

    Raises
    ------
    InputError
        If the scenario has no grid, or a ceramic thickness but no ceramic.
    NoDesignError
        If no design of the grid defeats the threat.
    """
    backings = grid(scenario).backing_thickness_mm.values()
    columns = []
    for column in frontier_columns(scenario, full_grid=full_grid):
        columns.append(column)
        if on_column is not None:
            on_column(column, len(backings))
    frontier = frontier_of(columns)
    if not frontier:
        raise NoDesignError(no_design(scenario))
    best = lightest(frontier)
    return OptimumResult(
        best=with_limit(scenario, best),
        frontier=frontier,
        refined=with_limit(scenario, refined(scenario, frontier)) if refine else None,
        runs=sum(column.runs for column in columns),
        not_monotonic_mm=tuple(
            thickness for thickness, column in zip(backings, columns, strict=True) if not column.monotonic
        ),
        warnings=warnings_of(with_thicknesses(scenario, best), scenario.impact.velocity_m_s),
    )


def frontier_columns(scenario: Scenario, *, full_grid: bool = False) -> Iterator[Column]:
    """What each backing thickness of the grid needs, in their order."""
    section = grid(scenario)
    ceramics = section.ceramic_thickness_mm.values()
    search = sweep_thinnest if full_grid else bisect_thinnest
    for backing in section.backing_thickness_mm.values():
        tried: dict[float, bool] = {}

        def defeats(ceramic: float, backing: float = backing, tried: dict[float, bool] = tried) -> bool:
            if ceramic not in tried:
                tried[ceramic] = defeats_threat(scenario, ceramic, backing)
            return tried[ceramic]

        thinnest = search(defeats, ceramics)
        yield Column(
            design=None if thinnest is None else design(scenario, thinnest, backing),
            monotonic=is_monotonic([tried[ceramic] for ceramic in sorted(tried)]),
            runs=len(tried),
        )


def frontier_of(columns: Sequence[Column]) -> tuple[Design, ...]:
    """The designs of the columns that have one."""
    return tuple(column.design for column in columns if column.design is not None)


def sweep_thinnest(defeats: Callable[[float], bool], ceramics: Sequence[float]) -> float | None:
    """Thinnest ceramic that defeats the threat, by trying every one."""
    outcomes = [defeats(ceramic) for ceramic in ceramics]
    return ceramics[outcomes.index(True)] if any(outcomes) else None


def bisect_thinnest(defeats: Callable[[float], bool], ceramics: Sequence[float]) -> float | None:
    """Thinnest ceramic that defeats the threat, by bisection where a few probes show defeat to be monotonic."""
    last = len(ceramics) - 1
    probes = sorted({round(i * last / (PROBES - 1)) for i in range(PROBES)})
    outcomes = [defeats(ceramics[i]) for i in probes]
    if not is_monotonic(outcomes):
        return sweep_thinnest(defeats, ceramics)
    if not outcomes[-1]:
        return None
    high = probes[outcomes.index(True)]
    low = probes[outcomes.index(True) - 1] if high > 0 else -1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if defeats(ceramics[middle]) else (middle, high)
    return ceramics[high]


def is_monotonic(outcomes: Sequence[bool]) -> bool:
    """Whether no defeat is followed by a perforation."""
    return all(thicker or not thinner for thinner, thicker in pairwise(outcomes))


def lightest(designs: Sequence[Design]) -> Design:
    """The design of the smallest areal density; the first of several."""
    return min(designs, key=lambda design: design.areal_density_kg_m2)


def with_thicknesses(scenario: Scenario, design: Design) -> Scenario:
    """The scenario with the thicknesses of the design."""
    return scenario.replaced(
        {
            "armour.ceramic_thickness_mm": design.ceramic_thickness_mm,
            "armour.backing_thickness_mm": design.backing_thickness_mm,
        }
    )


def with_limit(scenario: Scenario, design: Design) -> BestDesign:
    """The design with its ballistic limit."""
    try:
        limit = ballistic_limit(with_thicknesses(scenario, design)).ballistic_limit_m_s
    except NoLimitError:
        limit = None
    return BestDesign(**asdict(design), ballistic_limit_m_s=limit)


def refined(scenario: Scenario, frontier: Sequence[Design]) -> Design:
    """Lightest design of continuous thicknesses within the grid's range."""
    import numpy as np

    from armour.engine import batch

    rows, velocities = batch.packed([scenario.core_armour()]), np.array([scenario.impact.velocity_m_s])
    ceramics, backings, areal_densities = lightest_of_rows(scenario, rows, velocities)
    best = lightest(frontier)
    if not areal_densities[0] < best.areal_density_kg_m2:
        return best
    return design(scenario, float(ceramics[0]), float(backings[0]))


def lightest_of_rows(scenario: Scenario, rows: "Floats", velocities: "Floats") -> tuple["Floats", "Floats", "Floats"]:
    """Lightest designs of continuous thicknesses within the grid's range, of several armours and threats.

    Each backing of the grid gets the ceramic it needs and no more; round the one that does best with it the search is
    repeated ever closer.

    Parameters
    ----------
    scenario : Scenario
        For its grid and its solver.
    rows, velocities : array, (n, 13) and (n,)
        Armours as `armour.engine.batch.packed` has them, of which the thicknesses do not count, and impact velocities.

    Returns
    -------
    ceramics, backings, areal_densities : array, (n,)
        mm and kg/m^2; NaN where no design defeats the threat.
    """
    import numpy as np

    from armour.engine import batch

    section = grid(scenario).backing_thickness_mm
    a = batch.fields(rows)
    rho_c, rho_B = a.rho_c[:, None] * MM, a.rho_B[:, None] * MM
    here = np.arange(len(rows))
    backings = np.tile(np.array(section.values()), (len(rows), 1))
    width = section.step
    while True:
        ceramics = least_ceramics_mm(scenario, rows, velocities, backings)
        areal = np.where(np.isnan(ceramics), inf, rho_c * ceramics + rho_B * backings)
        least = areal.argmin(axis=1)
        centre, ceramic, areal_density = backings[here, least], ceramics[here, least], areal[here, least]
        if width <= BACKING_TOLERANCE_MM:
            return ceramic, centre, np.where(np.isfinite(areal_density), areal_density, np.nan)
        low, high = np.maximum(centre - width, section.min), np.minimum(centre + width, section.max)
        closer = np.linspace(low, high, 2 * CLOSER, axis=1)
        backings = np.concatenate([centre[:, None], closer], axis=1)
        width /= CLOSER


def no_design(scenario: Scenario) -> str:
    """What to say where no design of the grid defeats the threat."""
    section = grid(scenario)
    ceramic, backing = section.ceramic_thickness_mm, section.backing_thickness_mm
    return (
        f"no design: up to {ceramic.max:g} mm of ceramic on {backing.max:g} mm of backing, all of the grid is "
        f"perforated at {scenario.impact.velocity_m_s:g} m/s; raise the max of optimise.ceramic_thickness_mm "
        "or of optimise.backing_thickness_mm"
    )
