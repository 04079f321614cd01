"""What defeats the threat: designs, and the least thickness of a layer that does."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from armour.analysis.ballistic_limit import bisect
from armour.analysis.impact import MAX_STEPS, unresolved_error
from armour.core.state import Outcome
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.scenario.schema import Optimise
from armour.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from armour.engine.batch import SolverOptions

    Floats = NDArray[np.float64]

# Width, mm, to which a least thickness is bisected.
THICKNESS_TOLERANCE_MM = 1e-6


@dataclass(frozen=True)
class Design:
    """A pair of thicknesses that defeats the threat."""

    ceramic_thickness_mm: float
    backing_thickness_mm: float
    areal_density_kg_m2: float


def grid(scenario: Scenario) -> Optimise:
    """The scenario's grid.

    Raises
    ------
    InputError
        If it has none, or a ceramic thickness but no ceramic.
    """
    section = scenario.optimise
    if section is None:
        problem = Problem(scenario.file, "optimise", "is missing and must be given: the grid of designs")
        raise InputError([problem])
    if scenario.armour.ceramic is None and section.ceramic_thickness_mm.max > 0.0:
        message = "must name a ceramic of the library where optimise.ceramic_thickness_mm is above 0, found none"
        raise InputError([Problem(scenario.file, "armour.ceramic", message)])
    return section


def defeats_threat(scenario: Scenario, ceramic_thickness_mm: float, backing_thickness_mm: float) -> bool:
    """Whether the scenario's armour, with these thicknesses, defeats its impact; by the compiled engine.

    Raises
    ------
    InputError
        If the time step given is too short for the run to end.
    """
    import numpy as np

    from armour.engine import batch

    armour, velocity = scenario.core_armour(ceramic_thickness_mm, backing_thickness_mm), scenario.impact.velocity_m_s
    outcome = batch.impacts(batch.packed([armour]), np.array([velocity]), solver_options(scenario)).outcome[0]
    if outcome == Outcome.UNRESOLVED:
        raise unresolved_error(scenario.solver, scenario.file, velocity)
    return bool(outcome == Outcome.DEFEATED)


def solver_options(scenario: Scenario) -> "SolverOptions":
    """What the engine is told of the scenario's solver."""
    from armour.engine.batch import SolverOptions

    return SolverOptions(scenario.solver.arrest_velocity_m_s, scenario.solver.time_step, MAX_STEPS)


def least_ceramics_mm(scenario: Scenario, rows: "Floats", velocities: "Floats", backings_mm: "Floats") -> "Floats":
    """The least ceramic of the grid's range that each row with each of its backings needs; NaN where none is enough.

    Parameters
    ----------
    scenario : Scenario
        For its grid and its solver.
    rows, velocities : array, (n, 13) and (n,)
        Armours as `armour.engine.batch.packed` has them, and impact velocities, m/s.
    backings_mm : array, (n, k)
    """
    import numpy as np

    from armour.engine import batch

    section = grid(scenario).ceramic_thickness_mm
    each = backings_mm.shape[1]
    many = np.repeat(rows, each, axis=0)
    batch.fields(many).Hb[:] = backings_mm.ravel() * MM
    thin, thick, tolerance = section.min * MM, section.max * MM, THICKNESS_TOLERANCE_MM * MM
    found = batch.least_thicknesses(
        many, np.repeat(velocities, each), thin, thick, tolerance, solver_options(scenario)
    ).defeated
    return np.where(np.isfinite(found), found / MM, np.nan).reshape(backings_mm.shape)


def design(scenario: Scenario, ceramic_thickness_mm: float, backing_thickness_mm: float) -> Design:
    """The design with its areal density."""
    areal_density = scenario.areal_density_kg_m2(ceramic_thickness_mm, backing_thickness_mm)
    return Design(ceramic_thickness_mm, backing_thickness_mm, areal_density)


def least_ceramic(scenario: Scenario, backing_thickness_mm: float) -> Design | None:
    """The design with the least ceramic of the grid's range that the backing needs; None where none is enough."""
    section = grid(scenario).ceramic_thickness_mm
    ceramic = _least(lambda ceramic: defeats_threat(scenario, ceramic, backing_thickness_mm), section.min, section.max)
    return None if ceramic is None else design(scenario, ceramic, backing_thickness_mm)


def least_backing(scenario: Scenario, ceramic_thickness_mm: float) -> Design | None:
    """The design with the least backing of the grid's range that the ceramic needs; None where none is enough."""
    section = grid(scenario).backing_thickness_mm
    backing = _least(lambda backing: defeats_threat(scenario, ceramic_thickness_mm, backing), section.min, section.max)
    return None if backing is None else design(scenario, ceramic_thickness_mm, backing)


def least_in_proportion(scenario: Scenario) -> Design | None:
    """The thinnest design with the proportions of the scenario's own, both layers within the grid's ranges."""
    section, own = grid(scenario), scenario.armour
    ceramic, backing = own.ceramic_thickness_mm, own.backing_thickness_mm
    ranges = [(section.backing_thickness_mm, backing)]
    if ceramic > 0.0:
        ranges.append((section.ceramic_thickness_mm, ceramic))
    low = max(range_.min / thickness for range_, thickness in ranges)
    high = min(range_.max / thickness for range_, thickness in ranges)
    if low > high:
        return None
    total = ceramic + backing

    def layers(thickness: float) -> tuple[float, float]:
        return thickness * ceramic / total, thickness * backing / total

    least = _least(lambda thickness: defeats_threat(scenario, *layers(thickness)), low * total, high * total)
    return None if least is None else design(scenario, *layers(least))


def _least(defeats: Callable[[float], bool], low: float, high: float) -> float | None:
    """The least value of the range that defeats the threat, to the tolerance; None where the greatest does not."""
    if defeats(low):
        return low
    if not defeats(high):
        return None
    return bisect(defeats, low, high, THICKNESS_TOLERANCE_MM)[1]
