"""Ballistic limit: the lowest impact velocity that perforates, by a scan of velocities and bisection."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from armour.analysis.impact import ImpactResult, impact_at, perforates
from armour.analysis.results import Result
from armour.errors import NoLimitError
from armour.scenario.applicability import warnings_of
from armour.scenario.loading import Scenario

# Number of velocities of the coarse scan, evenly spaced on a logarithmic scale.
SCAN_POINTS = 33
# Number of intervals above the limit in a plotted curve.
CURVE_POINTS = 60


@dataclass(frozen=True)
class Crossing:
    """A velocity at which the outcome changes.

    Attributes
    ----------
    bracket_m_s : tuple of float
        Velocities just below and just above the change, m/s.
    above : {"perforated", "defeated"}
        Outcome above the change.
    """

    bracket_m_s: tuple[float, float]
    above: Literal["perforated", "defeated"]


@dataclass(frozen=True)
class LimitResult(Result):
    """Ballistic limit of an armour.

    Attributes
    ----------
    ballistic_limit_m_s : float
        Lowest velocity found to perforate, m/s: the upper end of the bracket.
    bracket_m_s : tuple of float
        Highest velocity found to be defeated and lowest found to perforate, m/s.
    runs : int
        Number of impacts computed.
    areal_density_kg_m2 : float
        Areal density of the armour, kg/m².
    monotonic : bool
        Whether every scanned velocity above the limit perforates.
    crossings : tuple of Crossing
        All changes of the outcome found by the scan; the first is the ballistic limit.
    warnings : tuple of str
        Ways in which the armour, or its ballistic limit, lies outside the validated range.
    """

    ballistic_limit_m_s: float
    bracket_m_s: tuple[float, float]
    runs: int
    areal_density_kg_m2: float
    monotonic: bool
    crossings: tuple[Crossing, ...]
    warnings: tuple[str, ...]


def ballistic_limit(scenario: Scenario) -> LimitResult:
    """Compute the ballistic limit of a scenario's armour.

    Parameters
    ----------
    scenario : Scenario
        Its section ``ballistic_limit`` gives the range of velocities and the tolerance; its impact velocity is not
        used.

    Returns
    -------
    LimitResult

    Raises
    ------
    NoLimitError
        If no velocity of the range perforates, or if its lowest velocity does.
    InputError
        If a run does not end within the maximum number of steps.
    """
    search = scenario.ballistic_limit
    armour = scenario.core_armour()
    runs = 0

    def counted(velocity: float) -> bool:
        nonlocal runs
        runs += 1
        return perforates(scenario, armour, velocity)

    low, high = search.velocity_min_m_s, search.velocity_max_m_s
    crossings = find_crossings(counted, low, high, search.tolerance_m_s)
    if not crossings or crossings[0].above == "defeated":
        raise NoLimitError(_no_limit(crossings, counted(low), low, high))
    return LimitResult(
        ballistic_limit_m_s=crossings[0].bracket_m_s[1],
        bracket_m_s=crossings[0].bracket_m_s,
        runs=runs,
        areal_density_kg_m2=scenario.areal_density_kg_m2(),
        monotonic=len(crossings) == 1,
        crossings=crossings,
        warnings=warnings_of(scenario, crossings[0].bracket_m_s[1]),
    )


def find_crossings(
    perforates: Callable[[float], bool], low: float, high: float, tolerance: float
) -> tuple[Crossing, ...]:
    """Find the velocities, m/s, at which the outcome changes, by a coarse scan and a bisection of each change."""
    velocities = scan(low, high, SCAN_POINTS)
    outcomes = [(velocity, perforates(velocity)) for velocity in velocities]
    return tuple(
        Crossing(
            bisect(lambda v, above=above: perforates(v) == above, below, beyond, tolerance),  # type: ignore[misc]
            "perforated" if above else "defeated",
        )
        for (below, under), (beyond, above) in pairwise(outcomes)
        if under != above
    )


def residual_velocity_curve(scenario: Scenario, velocities: Sequence[float]) -> tuple[ImpactResult, ...]:
    """Compute the impacts of a scenario at several impact velocities, m/s."""
    return tuple(impact_at(scenario, velocity) for velocity in velocities)


def curve_velocities(limit: LimitResult, scenario: Scenario) -> list[float]:
    """Return the impact velocities of a curve of residual velocity, m/s: below, at and well above the limit.

    They are dense just above the limit, where the residual velocity rises as a square root, and extend beyond the
    last crossing.
    """
    search = scenario.ballistic_limit
    found = limit.ballistic_limit_m_s
    low = max(search.velocity_min_m_s, 0.7 * found)
    last = limit.crossings[-1].bracket_m_s[1]
    high = min(search.velocity_max_m_s, max(1.6 * found, 1.1 * last))
    rising = [found + (high - found) * (i / CURVE_POINTS) ** 2 for i in range(CURVE_POINTS + 1)]
    return [low, limit.bracket_m_s[0], *rising]


def scan(low: float, high: float, count: int) -> list[float]:
    """Return `count` values from `low` to `high`, both included, evenly spaced on a logarithmic scale."""
    ratio = high / low
    return [low, *(low * ratio ** (i / (count - 1)) for i in range(1, count - 1)), high]


def bisect(holds: Callable[[float], bool], low: float, high: float, tolerance: float) -> tuple[float, float]:
    """Narrow a bracket to a tolerance by bisection; a condition holds at its upper end and not at its lower."""
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if holds(middle):
            high = middle
        else:
            low = middle
    return low, high


def _no_limit(crossings: tuple[Crossing, ...], lowest_perforates: bool, low: float, high: float) -> str:
    """Return why the range contains no ballistic limit."""
    if not lowest_perforates:
        return (
            f"no ballistic limit: no velocity from {low:g} to {high:g} m/s perforates; "
            "raise ballistic_limit.velocity_max_m_s"
        )
    if not crossings:
        return (
            f"no ballistic limit: every velocity from {low:g} to {high:g} m/s perforates; "
            "lower ballistic_limit.velocity_min_m_s"
        )
    changes = ", ".join(f"{c.above} above {c.bracket_m_s[1]:.2f} m/s" for c in crossings)
    return (
        f"no ballistic limit: the lowest velocity, {low:g} m/s, perforates, but some higher velocities do not "
        f"({changes}); lower ballistic_limit.velocity_min_m_s"
    )
