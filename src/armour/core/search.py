"""Search for the ballistic limit.

The outcome may change more than once with the impact velocity: the ballistic limit is the lowest change that a scan of
velocities sees.  A change is narrowed by the energy that the projectile has left, or lacks, which is nearly linear in
the square of the impact velocity.

The scan starts where the projectile may have the energy to perforate.  Let T be the kinetic energy of projectile and
moving target per cross-section, J/m^2.  By the equations of motion it falls by at least ``Y`` for each metre of the
target that is penetrated, and by the shear force over the cross-section for each metre that it is displaced, as long as
an eroding rod loses more energy than it transfers: V^2 <= 2 Yp/rho_p.  docs/numerics.md derives the bound.
"""

from collections.abc import Sequence
from math import exp, inf, log, sqrt
from typing import NamedTuple

from armour.core import equations as eq
from armour.core.roots import MOST_TRIALS, bracket, narrowed, next_point
from armour.core.run import TOLERANCE, Run, run
from armour.core.stages import with_intact_strength
from armour.core.state import Outcome, Parameters

# Error of an integration that the bound allows for, as a fraction of the least energy that perforates.
ALLOWANCE = 0.01


def may_perforate(p: Parameters, V: float) -> bool:
    """Return whether a projectile of the velocity V, m/s, may have the energy to perforate."""
    if 2.0 * p.Yp / p.rho_p < V * V:
        return True
    return 0.5 * p.rho_p * p.L0 * V * V * (1.0 + ALLOWANCE) > least_energy(with_intact_strength(p), V)


def least_energy(p: Parameters, V: float) -> float:
    """Return a lower bound on the energy per cross-section, J/m^2, that perforates at an impact velocity V, m/s.

    Where ceramic is ahead, T falls for each metre by at least ``Yc0 (V/Vs1)^2`` (9), in which V^2 is at least
    2 T/(areal mass of projectile and target) and Vs1 at most the impact velocity, or by the work of the displacement.
    """
    plate = least_energy_of_plate(p)
    if p.Hc0 <= 0.0:
        return plate
    areal_mass = p.rho_p * p.L0 + p.rho_B * p.Hb + p.rho_c * p.Hc0
    rate = 2.0 * p.Yc0 / (areal_mass * V * V)
    D = eq.sheared_diameter(p.shear_law, p.D0, p.Hc0)
    A0 = eq.cross_section(p.D0)
    # A mixture of penetration and displacement takes at least a third of the work of displacement.
    greatest = min(eq.shear_force_whole_plate(D, p.tau, p.Hb) / 3.0, eq.shear_force_whole_plate(p.D0, p.tau, p.Hb)) / A0
    knee = greatest / rate
    if plate >= knee:
        return plate + greatest * p.Hc0
    depth = log(knee / plate) / rate
    if depth >= p.Hc0:
        return plate * exp(rate * p.Hc0)
    return knee + greatest * (p.Hc0 - depth)


def least_energy_of_plate(p: Parameters) -> float:
    """Return the least energy per cross-section, J/m^2, that perforates the plate.

    Penetration takes YB for each metre and displacement 4 tau/D0 times the plate ahead (23a); the two add up to Hb.
    The least energy is that of penetration first, until a plug of the thickness YB D0/(8 tau) remains.
    """
    plug = min(p.Hb, p.YB * p.D0 / (8.0 * p.tau))
    return p.YB * (p.Hb - plug) + 4.0 * p.tau / p.D0 * plug * plug


# Rough runs: their tolerance, the fraction of a limit by which they may miss it, which the usual runs check, and the
# width, m/s, to which they narrow it.
ROUGH, ROUGH_ERROR, ROUGH_WIDTH = 1e-4, 1e-3, 1.0
# Least energy that a stopped projectile lacks, as a fraction of its own, so that the sign is that of the outcome.
LEAST_SHORTFALL = 1e-14
# Number of velocities of a scan.
SCAN_POINTS = 33
# Number of velocities where the outcome is likely to change more than once.
DENSE_SCAN_POINTS = 1025


class RunSettings(NamedTuple):
    """Settings of a run, see `armour.core.run.run`."""

    V_arrest: float
    dt: float
    max_steps: int
    tolerance: float = TOLERANCE


class Trial(NamedTuple):
    """An impact and its outcome."""

    V: float  # impact velocity, m/s
    perforated: bool
    resolved: bool  # the run ended within the maximum number of steps
    f: float  # residual energy, see `residual_energy`, m^2/s^2


class SearchResult(NamedTuple):
    """Result of a search."""

    low: float  # highest point that is stopped; -inf if there is none
    high: float  # lowest point that perforates; inf if there is none
    runs: int
    resolved: bool  # every run ended within the maximum number of steps


def scan(low: float, high: float, points: int = SCAN_POINTS) -> list[float]:
    """Return the velocities of a scan from `low` to `high`, both included, evenly spaced on a logarithmic scale."""
    ratio, last = high / low, points - 1
    return [low, *(low * ratio ** (i / last) for i in range(1, last)), high]


def impact(p: Parameters, V: float, solver: RunSettings) -> Trial:
    """Compute the impact at a velocity, m/s."""
    end = run(p, V, solver.dt, solver.V_arrest, solver.max_steps, None, solver.tolerance)
    perforated, resolved = end.outcome == Outcome.PERFORATED, end.outcome != Outcome.UNRESOLVED
    return Trial(V, perforated, resolved, residual_energy(end, p, V, solver.V_arrest))


def residual_energy(end: Run, p: Parameters, V: float, V_arrest: float) -> float:
    """Return the square of the residual velocity less that of the arrest velocity, m^2/s^2; negative if it stops.

    A projectile that stops together with all material ahead, at a constant deceleration (33), would have perforated
    with more energy, in proportion to the armour that remains: this continues the function below the limit without a
    kink.  For other projectiles the fraction of the armour that remains only gives the sign.
    """
    f = end.y.V * end.y.V - V_arrest * V_arrest
    remaining = p.Hc0 + p.Hb - end.y.Z
    if end.outcome == Outcome.PERFORATED:
        return max(f, 0.0)
    if end.constant_dV < 0.0:
        return min(f + 2.0 * end.constant_dV * remaining, -LEAST_SHORTFALL * V * V)
    return -V * V * max(remaining / (p.Hc0 + p.Hb), 1e-3)


def first_scanned(p: Parameters, velocities: Sequence[float]) -> int:
    """Return the index of the highest velocity of a scan that lacks the energy to perforate, or 0.

    It is 0 where the bound on the energy is not proved: where the interface drives the plate.
    """
    i = 0
    if p.drive_law != eq.STRENGTH:
        return i
    while i + 1 < len(velocities) and not may_perforate(p, velocities[i + 1]):
        i += 1
    return i


def find_ballistic_limit(
    p: Parameters, velocities: Sequence[float], tolerance: float, V_arrest: float, dt: float, max_steps: int
) -> SearchResult:
    """Find the ballistic limit: the lowest change of the outcome that a scan of velocities, m/s, sees.

    There is no limit if the lowest velocity perforates.  ``tolerance`` is the width of the final bracket, m/s; ``dt``
    is that of `armour.core.run.run`.  The velocity of an unresolved run is both ends of the bracket.  Rough runs locate
    the limit; the usual ones narrow it from there, or scan again if they contradict the rough ones.
    """
    solver = RunSettings(V_arrest, dt, max_steps, TOLERANCE)
    rough = scanned_limit(p, velocities, ROUGH_WIDTH, RunSettings(V_arrest, dt, max_steps, ROUGH))
    if rough.resolved and -inf < rough.low and rough.high < inf:
        below = impact(p, rough.low * (1.0 - ROUGH_ERROR), solver)
        above = impact(p, rough.high * (1.0 + ROUGH_ERROR), solver)
        if below.resolved and above.resolved and above.perforated and not below.perforated:
            return narrowed_change(p, below, above, tolerance, solver, rough.runs + 2)
        return scanned_limit(p, velocities, tolerance, solver, rough.runs + 2)
    return scanned_limit(p, velocities, tolerance, solver, rough.runs)


def scanned_limit(
    p: Parameters, velocities: Sequence[float], tolerance: float, solver: RunSettings, runs: int = 0
) -> SearchResult:
    """Find the ballistic limit by runs of one kind, see `find_ballistic_limit`, after some runs."""
    first = first_scanned(p, velocities)
    below = impact(p, float(velocities[first]), solver)  # Python's own number, of an array too
    if below.perforated and first > 0:  # the bound on the energy does not hold for equations that were edited
        first, below = 0, impact(p, float(velocities[0]), solver)
    if below.perforated or not below.resolved:
        return SearchResult(-inf if below.resolved else below.V, below.V, runs + 1, below.resolved)
    for i in range(first + 1, len(velocities)):
        above = impact(p, float(velocities[i]), solver)
        if not above.resolved:
            return SearchResult(above.V, above.V, runs + i - first + 1, False)
        if above.perforated:
            return narrowed_change(p, below, above, tolerance, solver, runs + i - first + 1)
        below = above
    return SearchResult(below.V, inf, runs + len(velocities) - first, True)


def narrowed_change(
    p: Parameters, below: Trial, above: Trial, tolerance: float, solver: RunSettings, runs: int = 0
) -> SearchResult:
    """Narrow a change of the outcome between two impacts to a tolerance, m/s, after some runs."""
    b = bracket(above.V * above.V, above.f, below.V * below.V, below.f)
    for _ in range(MOST_TRIALS):
        if abs(b.x2 - b.x1) <= 2.0 * below.V * tolerance:
            break
        trial = impact(p, sqrt(next_point(b, 1.9 * below.V * tolerance)), solver)
        runs += 1
        if not trial.resolved:
            return SearchResult(trial.V, trial.V, runs, False)
        b = narrowed(b, trial.V * trial.V, trial.f)
    return SearchResult(sqrt(min(b.x1, b.x2)), sqrt(max(b.x1, b.x2)), runs, True)
