"""Compute one impact of a scenario: its outcome, its stages with their losses and, on request, its history."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import ceil, floor, inf
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from armour.analysis.results import TableResult, by_column, same_columns
from armour.core import equations, stages
from armour.core.rk4 import state_within
from armour.core.run import Instant, Run, run
from armour.core.state import Outcome, Parameters
from armour.errors import InputError, Note, mistake
from armour.evidence.tests import armours_of, far_from_tests, scenario_warnings
from armour.scenario.checked import checked
from armour.scenario.scenario import Scenario
from armour.units import KN, MM, US, G

# Least number of instants of a history.
INSTANTS = 100


@dataclass(frozen=True)
class StageRecord:
    """A stage of an impact and the projectile's losses in it.

    Attributes
    ----------
    stage : str
        Name of the stage in the paper: "i", "ii.1" ... "iii.5".
    start_us, end_us : float
        Start and end, time since impact, µs.
    velocity_lost_m_s, length_lost_mm : float
        Loss of velocity, m/s, and of length, mm, of the projectile's rigid part.
    energy_lost_J : float
        Loss of kinetic energy of the rigid part, J, including the energy of the eroded material.
    """

    stage: str
    start_us: float
    end_us: float
    velocity_lost_m_s: float
    length_lost_mm: float
    energy_lost_J: float


@dataclass(frozen=True, repr=False)
class History(TableResult):
    """Quantities of an impact over time, one array each, all of the same length.

    A change of stage, or armour ahead that starts or stops moving, gives two entries at one time, before and after it.

    Attributes
    ----------
    time_us : array
        Time since impact, µs.
    depth_mm : array
        Depth of the projectile's front below the original front face, mm.
    length_mm, velocity_m_s : array
        Length, mm, and velocity, m/s, of the projectile's rigid part.
    penetration_velocity_m_s : array
        Velocity of the projectile's front, m/s.
    target_velocity_m_s : array
        Velocity of the armour ahead of the projectile, m/s.
    bulge_height_mm : array
        Height of the bulge on the back face, mm.
    ceramic_ahead_mm, backing_ahead_mm : array
        Ceramic and back plate ahead of the projectile's front, mm.
    interface_force_kN, shear_force_kN : array
        Force between projectile and armour, and force that shears the back plate, kN.
    stage : array of str
        Name of the stage in the paper: "i", "ii.1" ... "iii.5".
    """

    time_us: NDArray[np.float64]
    depth_mm: NDArray[np.float64]
    length_mm: NDArray[np.float64]
    velocity_m_s: NDArray[np.float64]
    penetration_velocity_m_s: NDArray[np.float64]
    target_velocity_m_s: NDArray[np.float64]
    bulge_height_mm: NDArray[np.float64]
    ceramic_ahead_mm: NDArray[np.float64]
    backing_ahead_mm: NDArray[np.float64]
    interface_force_kN: NDArray[np.float64]
    shear_force_kN: NDArray[np.float64]
    stage: NDArray[np.str_]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, History) and same_columns(self._columns(), other._columns())

    def to_dict(self) -> dict[str, Any]:
        """Return the quantities as lists, by name."""
        return {name: values.tolist() for name, values in self._columns().items()}

    def _columns(self) -> dict[str, Any]:
        return {item.name: getattr(self, item.name) for item in fields(self)}


@dataclass(frozen=True, repr=False)
class ImpactResult(TableResult):
    """Result of an impact.

    Attributes
    ----------
    outcome : {"perforated", "stopped"}
    impact_velocity_m_s : float
        Impact velocity, m/s.
    residual_velocity_m_s : float
        Velocity of the projectile after perforation, m/s; 0 if stopped.
    residual_mass_g, residual_length_mm : float
        Mass, g, and length, mm, of the penetrator at the end of the impact.
    penetration_depth_mm : float
        Depth of the projectile's front below the original front face, mm.
    bulge_height_mm : float
        Height of the bulge on the back face, mm.
    plug_velocity_m_s : float
        Velocity of the back plate's plug after perforation, m/s; 0 if stopped.
    duration_us : float
        Time from impact to perforation or arrest, µs.
    areal_density_kg_m2, whole_areal_density_kg_m2 : float
        Areal density of the armour without and with a back plate that exists already, kg/m².
    time_step_us : float or None
        Time step, µs, if the scenario gives one; None where the estimated error chooses each step.
    stages : tuple of StageRecord
        Stages of the impact, in order.
    notes : tuple of Note
        Ways in which the scenario lies outside the validated range.
    history : History or None
        Quantities over time, if requested.
    far_from_tests : tuple of str
        What of the armour or the threat is far from the tests.
    """

    outcome: Literal["perforated", "stopped"]
    impact_velocity_m_s: float
    residual_velocity_m_s: float
    residual_mass_g: float
    residual_length_mm: float
    penetration_depth_mm: float
    bulge_height_mm: float
    plug_velocity_m_s: float
    duration_us: float
    areal_density_kg_m2: float
    time_step_us: float | None
    stages: tuple[StageRecord, ...]
    notes: tuple[Note, ...]
    history: History | None = None
    whole_areal_density_kg_m2: float = 0.0
    far_from_tests: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the result, without its history, as plain data."""
        data = super().to_dict()
        del data["history"]
        return data

    def _columns(self) -> dict[str, Any]:
        return by_column(vars(stage) for stage in self.stages)


@checked
def simulate(scenario: Scenario, *, history: bool = False) -> ImpactResult:
    """Compute the impact of a scenario.

    Parameters
    ----------
    scenario : Scenario
    history : bool, default False
        Whether to record the quantities over time.

    Returns
    -------
    ImpactResult

    Raises
    ------
    InputError
        If the run does not end within the maximum number of steps.
    """
    return impact_at(scenario, scenario.impact.velocity_m_s, history=history).of(scenario=scenario)


def impact_at(scenario: Scenario, velocity: float, *, history: bool = False) -> ImpactResult:
    """Compute the impact of a scenario at `velocity`, m/s, in place of its own impact velocity."""
    end, trace, armour = run_impact(scenario, velocity)
    spacing = min(scenario.solver.time_step or inf, end.t / INSTANTS)
    perforated = end.outcome == Outcome.PERFORATED
    return ImpactResult(
        outcome="perforated" if perforated else "stopped",
        impact_velocity_m_s=velocity,
        residual_velocity_m_s=end.y.V if perforated else 0.0,
        residual_mass_g=armour.rho_p * equations.cross_section(armour.D0) * end.y.L / G,
        residual_length_mm=end.y.L / MM,
        penetration_depth_mm=end.y.Z / MM,
        bulge_height_mm=end.y.h / MM,
        plug_velocity_m_s=end.y.W if perforated else 0.0,
        duration_us=end.t / US,
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        whole_areal_density_kg_m2=scenario.areal_density_kg_m2(whole=True),
        time_step_us=scenario.solver.time_step_us,
        stages=stage_records(trace, armour),
        notes=scenario_warnings(scenario, said=True),
        history=history_of(trace, armour, spacing) if history else None,
        far_from_tests=tuple(map(str, far_from_tests(scenario, armours_of(scenario)))),
    )


def run_impact(scenario: Scenario, velocity: float) -> tuple[Run, list[Instant], Parameters]:
    """Compute an impact at a velocity, m/s; return its end, all instants, and the parameters that it is computed with.

    In these parameters, the strength of the intact ceramic is that by the law of the flow stress.
    """
    armour, solver = stages.with_intact_strength(scenario.core_armour()), scenario.solver
    trace: list[Instant] = []
    end = run(armour, velocity, solver.time_step, solver.arrest_velocity_m_s, solver.max_steps, trace)
    if end.outcome == Outcome.UNRESOLVED:
        raise unresolved_error(scenario, velocity)
    return end, trace, armour


def unresolved_error(scenario: Scenario, velocity: float) -> InputError:
    """Return the InputError for an impact at `velocity`, m/s, that does not end within the allowed steps.

    It blames the scenario's time step if one is set, else the arrest velocity.
    """
    solver = scenario.solver
    if solver.time_step_us is not None:
        key, value, advice = "time_step_us", f"{solver.time_step_us:g}", "raise it or leave it out"
    else:
        key, value, advice = "arrest_velocity_m_s", f"{solver.arrest_velocity_m_s:g}", "raise it"
        value += "" if key in solver.model_fields_set else ", the default"
    message = f"must let the run at {velocity:g} m/s end within {solver.max_steps:,} steps, found {value}; {advice}"
    return mistake(scenario.file, f"solver.{key}", message)


def stage_records(trace: Sequence[Instant], armour: Parameters) -> tuple[StageRecord, ...]:
    """Return the stages of an impact, given its instants, with their losses; those of no duration are left out."""
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
            energy_lost_J=kinetic_energy(start, armour) - kinetic_energy(end, armour),
        )
        for start, end in pairwise([*starts, trace[-1]])
        if end.t > start.t
    )


def kinetic_energy(instant: Instant, armour: Parameters) -> float:
    """Return the kinetic energy of the projectile's rigid part at an instant, J."""
    mass = armour.rho_p * equations.cross_section(armour.D0) * instant.y.L
    return mass * instant.y.V**2 / 2.0


def history_of(trace: Sequence[Instant], armour: Parameters, spacing: float) -> History:
    """Return the history of an impact, given its instants; added ones make them at most `spacing`, s, apart."""
    trace = refined(trace, armour, spacing)

    def column(values: Sequence[float], unit: float = 1.0) -> NDArray[np.float64]:
        return np.array(values) / unit

    return History(
        time_us=column([i.t for i in trace], US),
        depth_mm=column([i.y.Z for i in trace], MM),
        length_mm=column([i.y.L for i in trace], MM),
        velocity_m_s=column([i.y.V for i in trace]),
        penetration_velocity_m_s=column([stages.front_velocity(i.y, i.s, armour) for i in trace]),
        target_velocity_m_s=column([i.y.W for i in trace]),
        bulge_height_mm=column([i.y.h for i in trace], MM),
        ceramic_ahead_mm=column([stages.ceramic_ahead(i.y, i.s, armour) for i in trace], MM),
        backing_ahead_mm=column([stages.plate_ahead(i.y, i.s, armour) for i in trace], MM),
        interface_force_kN=column([stages.interface_force(i.y, i.s, armour) for i in trace], KN),
        shear_force_kN=column([stages.shear_force(i.y, i.s, armour) for i in trace], KN),
        stage=np.array([stages.stage_name(i.s) for i in trace]),
    )


def refined(trace: Sequence[Instant], armour: Parameters, spacing: float) -> list[Instant]:
    """Return the instants of an impact, with more added at the multiples of `spacing`, s, by cubic interpolation."""
    instants = [trace[0]]
    for before, after in pairwise(trace):
        dt = after.t - before.t
        inside = range(floor(before.t / spacing) + 1, ceil(after.t / spacing)) if dt > 0.0 else ()
        if inside:
            k0, k1 = (stages.rates(instant.y, after.s, armour) for instant in (before, after))
            times = [spacing * i for i in inside]
            states = [state_within(before.y, k0, after.y, k1, dt, (t - before.t) / dt) for t in times]
            # A bulge never recedes, but the interpolated one may, by its error, just after the plate starts to move.
            grown = [y._replace(h=max(y.h, before.y.h)) for y in states]
            instants += [Instant(t, y, after.s) for t, y in zip(times, grown, strict=True)]
        instants.append(after)
    return instants
