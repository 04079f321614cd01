"""Searches for the ballistic limit and the least ceramic thickness.

The outcome may change more than once with the impact velocity.  The ballistic limit is the lowest change that a scan of
velocities sees.  Perforation, or defeat, between two scanned velocities is searched for where their neighbours hint at
it: at a maximum of the penetration depth, at a minimum of the residual velocity, and where defeated projectiles stop at
one velocity and are used up at the next.

Just above the ballistic limit the square of the residual velocity is linear in the impact velocity, and in the ceramic
thickness.  Within a bracket, each run is therefore placed just on the perforated side of the root of a polynomial
through the last perforations, or at the middle of the bracket where that root lies outside it.
"""

from collections.abc import Sequence
from math import inf, sqrt
from typing import NamedTuple

from armour.core.events import ERODED_FRACTION
from armour.core.run import run
from armour.core.state import Outcome, Parameters
from armour.core.stepping import time_step

# Residual energy of the first perforation as a fraction of the impact energy above the limit's; an estimate.
ENERGY_LEFT = 0.85
# Runs of a search after which it continues by bisection.
MAX_INTERPOLATED_RUNS = 30
# Number of velocities of a scan.
SCAN_POINTS = 33
# Runs of a search between scanned velocities.
HIDDEN_RUNS = 10
# Part of the larger interval at which a search of a maximum by golden section places its next run.
GOLDEN = (3.0 - sqrt(5.0)) / 2.0


class Solver(NamedTuple):
    """Settings of a run, see `armour.core.run.run`."""

    V_arrest: float
    given: float  # time step, s, as in `armour.core.stepping.time_step`
    max_steps: int


class Impact(NamedTuple):
    """An impact and its outcome."""

    V: float  # impact velocity, m/s
    perforated: bool
    eroded: bool  # the projectile was used up
    resolved: bool  # the run ended within the maximum number of steps
    # How near it is to the other outcome: the penetration depth, m, or if perforated the square of the arrest velocity
    # less that of the residual velocity, m^2/s^2.
    nearness: float


class Change(NamedTuple):
    """Two impacts between which the outcome changes; the outcome is the same at both if no change is seen."""

    below: Impact
    above: Impact
    runs: int


class Bracket(NamedTuple):
    """Interval that contains the root, and the points of the interpolation.

    A run at ``low`` is defeated if ``low_known``; a run at ``high`` perforates if ``high_known``.  The function ``f``
    is the square of the residual velocity less that of the arrest velocity, m^2/s^2.
    """

    low: float
    high: float
    low_known: bool
    high_known: bool
    points: int  # number of perforations that the estimate uses, at most 3
    x1: float  # last perforation
    f1: float
    x2: float  # the one before it
    f2: float
    estimate: float  # estimate of the root
    error: float  # error of the estimate
    runs: int


class SearchResult(NamedTuple):
    """Result of a search."""

    low: float  # highest point found that is defeated; -inf if none
    high: float  # lowest point found that perforates; inf if none
    runs: int
    resolved: bool  # every run ended within the maximum number of steps


def initial_bracket(low: float, high: float) -> Bracket:
    """Return a bracket before the first run."""
    return Bracket(low, high, False, False, 0, 0.0, 0.0, 0.0, 0.0, 0.0, inf, 0)


def after_defeat(b: Bracket, x: float) -> Bracket:
    """Return the bracket after a defeated run at x."""
    return Bracket(x, b.high, True, b.high_known, b.points, b.x1, b.f1, b.x2, b.f2, b.estimate, b.error, b.runs + 1)


def after_perforation(b: Bracket, x: float, f: float, first_estimate: float) -> Bracket:
    """Return the bracket after a perforated run at x; ``first_estimate`` of the root is used if it is the first."""
    if b.points == 0:
        estimate, error = first_estimate, 0.25 * abs(x - first_estimate)
    else:
        estimate = extrapolated_root(b.points, x, f, b.x1, b.f1, b.x2, b.f2)
        error = abs(estimate - b.estimate)
    points = min(b.points + 1, 3)
    return Bracket(b.low, x, b.low_known, True, points, x, f, b.x1, b.f1, estimate, error, b.runs + 1)


def extrapolated_root(earlier: int, x1: float, f1: float, x2: float, f2: float, x3: float, f3: float) -> float:
    """Return the root of x as a polynomial of f through a point and one or two earlier ones, by Neville's scheme."""
    if f1 == f2:
        return x1
    line = x1 - f1 * (x2 - x1) / (f2 - f1)
    if earlier == 1 or f2 == f3 or f1 == f3:
        return line
    other = x2 - f2 * (x3 - x2) / (f3 - f2)
    return line - f1 * (other - line) / (f3 - f1)


def is_converged(b: Bracket, tolerance: float) -> bool:
    """Return whether the bracket is as narrow as the tolerance or as floating-point numbers allow."""
    if not (b.low_known and b.high_known):
        return False
    middle = 0.5 * (b.low + b.high)
    return b.high - b.low <= tolerance or not b.low < middle < b.high


def next_point(b: Bracket, tolerance: float) -> float:
    """Return the point of the next run in a bracket whose upper end perforates."""
    middle = 0.5 * (b.low + b.high)
    if b.runs > MAX_INTERPOLATED_RUNS:
        return middle
    away = b.high - b.estimate
    if away <= 0.7 * tolerance:
        x = b.high - 0.9 * tolerance
    else:
        margin = (0.0, 0.2 * away, 0.03 * away, 0.02 * b.error)[b.points]
        x = b.estimate + max(margin, tolerance / 3.0)
        if x <= b.low:
            x = b.low + 4.0 * max(margin, b.low - b.estimate)
    return x if b.low < x < b.high else middle


def scan(low: float, high: float) -> list[float]:
    """Return the velocities of a scan from `low` to `high`, both included, evenly spaced on a logarithmic scale."""
    ratio, last = high / low, SCAN_POINTS - 1
    return [low, *(low * ratio ** (i / last) for i in range(1, last)), high]


def impact(p: Parameters, V: float, solver: Solver) -> Impact:
    """Compute the impact at a velocity, m/s."""
    end = run(p, V, time_step(p, V, solver.given), solver.V_arrest, solver.max_steps)
    resolved = end.outcome != Outcome.UNRESOLVED
    if end.outcome == Outcome.PERFORATED:
        return Impact(V, True, False, resolved, solver.V_arrest * solver.V_arrest - end.y.V * end.y.V)
    return Impact(V, False, end.y.L < ERODED_FRACTION * p.L0, resolved, end.y.Z)


def find_ballistic_limit(
    p: Parameters, velocities: Sequence[float], tolerance: float, V_arrest: float, given: float, max_steps: int
) -> SearchResult:
    """Find the ballistic limit: the lowest change of the outcome that a scan of velocities, m/s, sees.

    It is none if the lowest velocity perforates.  ``tolerance`` is the width of the final bracket, m/s, and ``given``
    the time step, s, as in `armour.core.stepping.time_step`.  An unresolved run is both ends of the bracket.
    """
    solver = Solver(V_arrest, given, max_steps)
    start = impact(p, velocities[0], solver)
    if not start.resolved:
        return SearchResult(start.V, start.V, 1, False)
    if start.perforated:
        return SearchResult(-inf, start.V, 1, True)
    change = next_change(p, start, velocities, solver)
    runs = change.runs + 1
    if not change.above.resolved:
        return SearchResult(change.above.V, change.above.V, runs, False)
    if not change.above.perforated:
        return SearchResult(change.above.V, inf, runs, True)
    found = narrowed(p, change, tolerance, solver)
    return SearchResult(found.low, found.high, found.runs + runs, found.resolved)


def next_change(p: Parameters, start: Impact, velocities: Sequence[float], solver: Solver) -> Change:
    """Return the lowest change of the outcome above an impact that a scan of velocities, m/s, sees.

    The search ends at an unresolved run, which is then the impact above.
    """
    before, last, runs = start, start, 0
    for V in velocities:
        if V <= start.V:
            continue
        end = impact(p, V, solver)
        runs += 1
        if not end.resolved or end.perforated != last.perforated:
            return Change(last, end, runs)
        hidden = Change(last, last, 0)
        if end.eroded != last.eroded:
            hidden = change_between_causes(p, last, end, solver)
        elif before.eroded == last.eroded and before.nearness < last.nearness > end.nearness:
            hidden = change_at_peak(p, before, last, end, solver)
        runs += hidden.runs
        if not hidden.above.resolved or hidden.above.perforated != last.perforated:
            return Change(hidden.below, hidden.above, runs)
        before, last = last, end
    return Change(last, last, runs)


def change_at_peak(p: Parameters, below: Impact, peak: Impact, above: Impact, solver: Solver) -> Change:
    """Search around the nearest of three impacts to the other outcome for an impact of that outcome."""
    for i in range(HIDDEN_RUNS):
        upper = above.V - peak.V > peak.V - below.V
        V = peak.V + GOLDEN * (above.V - peak.V if upper else below.V - peak.V)
        tried = impact(p, V, solver)
        if not tried.resolved or tried.perforated != peak.perforated:
            return Change(peak if upper else below, tried, i + 1)
        if tried.nearness > peak.nearness:
            below, peak, above = (peak, tried, above) if upper else (below, tried, peak)
        elif upper:
            above = tried
        else:
            below = tried
    return Change(peak, peak, HIDDEN_RUNS)


def change_between_causes(p: Parameters, below: Impact, above: Impact, solver: Solver) -> Change:
    """Search between a projectile that stops and one that is used up for one that perforates, by bisection."""
    for i in range(HIDDEN_RUNS):
        tried = impact(p, 0.5 * (below.V + above.V), solver)
        if not tried.resolved or tried.perforated:
            return Change(below, tried, i + 1)
        if tried.eroded == below.eroded:
            below = tried
        else:
            above = tried
    return Change(below, below, HIDDEN_RUNS)


def narrowed(p: Parameters, change: Change, tolerance: float, solver: Solver) -> SearchResult:
    """Narrow a change of the outcome to the bracket that bisection to a tolerance, m/s, finds, in fewer runs.

    The bracket is in ascending order of velocity.
    """
    # The upper end of a bracket perforates: velocities are negative where the outcome above the change is defeat.
    sign = 1.0 if change.above.perforated else -1.0
    first, other = (change.above, change.below) if change.above.perforated else (change.below, change.above)
    low, high = sign * other.V, sign * first.V
    b = after_defeat(initial_bracket(low, high), low)
    b = after_perforation(b, high, -first.nearness, sign * sqrt(max(first.V**2 + first.nearness / ENERGY_LEFT, 0.0)))
    start, end = bisected(low, low, high, tolerance)
    while not is_converged(b, tolerance):
        under, over = bisected(next_point(b, end - start), low, high, tolerance)
        x = over if over < b.high else under
        tried = impact(p, sign * x, solver)
        if not tried.resolved:
            return SearchResult(tried.V, tried.V, b.runs - 1, False)
        b = after_perforation(b, x, -tried.nearness, 0.0) if tried.perforated else after_defeat(b, x)
    runs = b.runs - 2  # less the two ends of the change
    if sign < 0.0:
        return SearchResult(-b.high, -b.low, runs, True)
    return SearchResult(b.low, b.high, runs, True)


def bisected(x: float, low: float, high: float, tolerance: float) -> tuple[float, float]:
    """Return the interval that contains x of those into which bisection divides an interval, down to a tolerance."""
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if x < middle:
            high = middle
        else:
            low = middle
    return low, high


def find_least_ceramic_thickness(
    p: Parameters, Vi: float, thin: float, thick: float, tolerance: float, V_arrest: float, given: float, max_steps: int
) -> SearchResult:
    """Find the least ceramic thickness between two, m, that defeats an impact; the outcome changes once between them.

    The result brackets the negative thickness, -Hc0, m, so that its upper end perforates.  ``p.Hc0`` is not used;
    ``tolerance`` is the width of the final bracket, m, and ``given`` the time step, s, as in `find_ballistic_limit`.
    """
    b = initial_bracket(-thick, -thin)
    Hc0 = thin
    while True:
        tried = p._replace(Hc0=Hc0)
        end = run(tried, Vi, time_step(tried, Vi, given), V_arrest, max_steps)
        if end.outcome == Outcome.UNRESOLVED:
            return SearchResult(-inf, inf, b.runs + 1, False)
        if end.outcome == Outcome.PERFORATED:
            f = end.y.V * end.y.V - V_arrest * V_arrest
            # The limit is about proportional to the thickness.
            limit = sqrt(max(Vi * Vi - f / ENERGY_LEFT, 0.01 * Vi * Vi))
            b = after_perforation(b, -Hc0, f, -max(Hc0, 0.1 * p.D0) * Vi / limit)
            if Hc0 >= thick:
                return SearchResult(-inf, -Hc0, b.runs, True)
        else:
            b = after_defeat(b, -Hc0)
            if Hc0 <= thin:
                return SearchResult(-Hc0, inf, b.runs, True)
        if is_converged(b, tolerance):
            return SearchResult(b.low, b.high, b.runs, True)
        Hc0 = -next_point(b, tolerance)
        if not b.low_known and b.estimate <= b.low:
            Hc0 = thick
