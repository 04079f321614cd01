"""One impact of a scenario: how it ends, the stages it passes through and, where asked for, its history."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

from armour.core import search, stages
from armour.core.equations import cross_section
from armour.core.run import Instant, Run, run
from armour.core.state import Outcome, Parameters
from armour.errors import InputError, Problem
from armour.scenario.applicability import warnings_of
from armour.scenario.loading import Scenario
from armour.scenario.schema import Solver
from armour.units import KN, MM, US, G

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# Steps after which a run is given up; one with the default step takes a few hundred.
MAX_STEPS = 500_000


@dataclass(frozen=True)
class StageRecord:
    """A stage that the run passed through, and what it took from the projectile.

    Attributes
    ----------
    stage : str
        The paper's name: "i", "ii.1" ... "iii.5".
    start_us, end_us : float
        Times since impact, us.
    velocity_lost_m_s, length_lost_mm, energy_lost_J : float
        Losses of the projectile's rigid part; the energy is kinetic, that of eroded material included.
    """

    stage: str
    start_us: float
    end_us: float
    velocity_lost_m_s: float
    length_lost_mm: float
    energy_lost_J: float


@dataclass(frozen=True)
class History:
    """A run over time, one array per quantity, all of the same length.

    A change of stage leaves two instants at the same time, before and after it.
    """

    time_us: "NDArray[np.float64]"
    depth_mm: "NDArray[np.float64]"
    length_mm: "NDArray[np.float64]"
    velocity_m_s: "NDArray[np.float64]"
    penetration_velocity_m_s: "NDArray[np.float64]"
    target_velocity_m_s: "NDArray[np.float64]"
    bulge_height_mm: "NDArray[np.float64]"
    ceramic_ahead_mm: "NDArray[np.float64]"
    backing_ahead_mm: "NDArray[np.float64]"
    interface_force_kN: "NDArray[np.float64]"
    shear_force_kN: "NDArray[np.float64]"
    stage: "NDArray[np.str_]"


@dataclass(frozen=True)
class ImpactResult:
    """How an impact ended.

    Attributes
    ----------
    outcome : {"perforated", "defeated"}
    impact_velocity_m_s : float
    residual_velocity_m_s : float
        Velocity of the projectile after perforation, m/s; 0 when defeated.
    residual_mass_g, residual_length_mm : float
        What erosion has left of the penetrator.
    penetration_depth_mm : float
        Depth of the projectile's front below the original front face, mm.
    bulge_height_mm : float
        Bulge of the back face, mm.
    plug_velocity_m_s : float
        Velocity of the plate's plug after perforation, m/s; 0 when defeated.
    duration_us : float
        Time from impact to perforation or arrest, us.
    areal_density_kg_m2 : float
        Mass of the armour per area, kg/m^2.
    time_step_us : float
        Time step taken, us.
    stages : tuple of StageRecord
        Stages passed through, in order.
    warnings : tuple of str
        What of the scenario is outside the data that the model was tested on.
    history : History or None
        The run over time, where it was asked for.
    """

    outcome: Literal["perforated", "defeated"]
    impact_velocity_m_s: float
    residual_velocity_m_s: float
    residual_mass_g: float
    residual_length_mm: float
    penetration_depth_mm: float
    bulge_height_mm: float
    plug_velocity_m_s: float
    duration_us: float
    areal_density_kg_m2: float
    time_step_us: float
    stages: tuple[StageRecord, ...]
    warnings: tuple[str, ...]
    history: History | None = None

    def to_dict(self) -> dict[str, Any]:
        """The result without its history as plain data."""
        data = asdict(self)
        del data["history"]
        data["stages"] = list(data["stages"])
        return data


def simulate(scenario: Scenario, *, history: bool = False) -> ImpactResult:
    """Run the impact of a scenario.

    Parameters
    ----------
    scenario : Scenario
    history : bool
        Whether to keep the run over time.

    Raises
    ------
    InputError
        If the time step given is too short for the run to end.
    """
    return impact_at(scenario, scenario.impact.velocity_m_s, history=history)


def impact_at(scenario: Scenario, velocity: float, *, history: bool = False) -> ImpactResult:
    """Run the impact of a scenario at another velocity, m/s.

    Raises
    ------
    InputError
        If the time step given is too short for the run to end.
    """
    armour = scenario.core_armour()
    trace: list[Instant] = []
    end = run_impact(scenario, armour, velocity, trace)
    perforated = end.outcome == Outcome.PERFORATED
    return ImpactResult(
        outcome="perforated" if perforated else "defeated",
        impact_velocity_m_s=velocity,
        residual_velocity_m_s=end.y.V if perforated else 0.0,
        residual_mass_g=armour.rho_p * cross_section(armour.D0) * end.y.L / G,
        residual_length_mm=end.y.L / MM,
        penetration_depth_mm=end.y.Z / MM,
        bulge_height_mm=end.y.h / MM,
        plug_velocity_m_s=end.y.W if perforated else 0.0,
        duration_us=end.t / US,
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        time_step_us=time_step(scenario, armour, velocity) / US,
        stages=stage_records(trace, armour),
        warnings=warnings_of(scenario, velocity),
        history=history_of(trace, armour) if history else None,
    )


def perforates(scenario: Scenario, armour: Parameters, velocity: float) -> bool:
    """Whether the armour is perforated at the velocity, m/s.

    Raises
    ------
    InputError
        If the time step given is too short for the run to end.
    """
    return run_impact(scenario, armour, velocity).outcome == Outcome.PERFORATED


def run_impact(scenario: Scenario, armour: Parameters, velocity: float, trace: list[Instant] | None = None) -> Run:
    """Run the core with the scenario's solver.

    Raises
    ------
    InputError
        If the time step given is too short for the run to end.
    """
    dt = time_step(scenario, armour, velocity)
    end = run(armour, velocity, dt, scenario.solver.arrest_velocity_m_s, MAX_STEPS, trace)
    if end.outcome == Outcome.UNRESOLVED:
        raise unresolved(scenario.solver, scenario.file, velocity)
    return end


def unresolved(solver: Solver, file: str, velocity: float) -> InputError:
    """Error of a run that does not end within the steps allowed, naming the key at fault."""
    key = "arrest_velocity_m_s" if solver.time_step_us is None else "time_step_us"
    value = getattr(solver, key)
    message = f"must let the run at {velocity:g} m/s end within {MAX_STEPS} steps, found {value:.3g}; raise it"
    return InputError([Problem(file, f"solver.{key}", message)])


def time_step(scenario: Scenario, armour: Parameters, velocity: float) -> float:
    """Time step for an impact at the velocity, s: the scenario's, or the default."""
    return search.time_step(armour, velocity, scenario.solver.time_step)


def stage_records(trace: Sequence[Instant], armour: Parameters) -> tuple[StageRecord, ...]:
    """Stages of a run, those that last no time left out."""
    starts = [trace[0]]
    for before, after in pairwise(trace):
        if stages.stage_name(before.s) != stages.stage_name(after.s):
            starts.append(after)
    return tuple(
        StageRecord(
            stage=stages.stage_name(start.s),
            start_us=start.t / US,
            end_us=end.t / US,
            velocity_lost_m_s=start.y.V - end.y.V,
            length_lost_mm=(start.y.L - end.y.L) / MM,
            energy_lost_J=_energy(start, armour) - _energy(end, armour),
        )
        for start, end in pairwise([*starts, trace[-1]])
        if end.t > start.t
    )


def _energy(instant: Instant, armour: Parameters) -> float:
    """Kinetic energy of the projectile's rigid part, J."""
    mass = armour.rho_p * cross_section(armour.D0) * instant.y.L
    return mass * instant.y.V**2 / 2.0


def history_of(trace: Sequence[Instant], armour: Parameters) -> History:
    """The run over time, in the units of people."""
    import numpy as np

    def column(values: Sequence[float], unit: float = 1.0) -> "NDArray[np.float64]":
        return np.array(values) / unit

    a = armour
    return History(
        time_us=column([i.t for i in trace], US),
        depth_mm=column([i.y.Z for i in trace], MM),
        length_mm=column([i.y.L for i in trace], MM),
        velocity_m_s=column([i.y.V for i in trace]),
        penetration_velocity_m_s=column([stages.front_velocity(i.y, i.s, a) for i in trace]),
        target_velocity_m_s=column([i.y.W for i in trace]),
        bulge_height_mm=column([i.y.h for i in trace], MM),
        ceramic_ahead_mm=column([stages.ceramic_ahead(i.y, i.s, a) for i in trace], MM),
        backing_ahead_mm=column([stages.plate_ahead(i.y, i.s, a) for i in trace], MM),
        interface_force_kN=column([stages.interface_force(i.y, i.s, a) for i in trace], KN),
        shear_force_kN=column([stages.shear_force(i.y, i.s, a) for i in trace], KN),
        stage=np.array([stages.stage_name(i.s) for i in trace]),
    )
