"""Searches for the ballistic limit and the least ceramic thickness.

The outcome may change more than once with the impact velocity.  The ballistic limit is the lowest change that a scan of
velocities sees.  Perforation, or defeat, between two scanned velocities is searched for where their neighbours hint at
it: at a maximum of the penetration depth, at a minimum of the residual velocity, and where defeated projectiles stop at
one velocity and are used up at the next.

The scan starts at the highest velocity below which no projectile has the energy to perforate.  Its runs are rough, with
longer time steps, and are repeated with the usual ones where the outcome is close.  A change is then narrowed by rough
runs and, from where these lead, by usual ones: of the final bracket no end is rough.

Just above the ballistic limit the square of the residual velocity is linear in the impact velocity, and in the ceramic
thickness.  Within a bracket, each run is therefore placed just on the perforated side of the root of a polynomial
through the last perforations, or at the middle of the bracket where that root lies outside it.
"""

from collections.abc import Sequence
from math import inf, sqrt
from typing import NamedTuple

from armour.core.bounds import may_perforate
from armour.core.events import ERODED_FRACTION
from armour.core.run import Run, run
from armour.core.state import Outcome, Parameters
from armour.core.stepping import time_step

# Residual energy of the first perforation as a fraction of the impact energy above the limit's; an estimate.
ENERGY_LEFT = 0.65
# Runs of a search after which it continues by bisection.
MAX_INTERPOLATED_RUNS = 30
# Number of velocities of a scan.
SCAN_POINTS = 33
# The same where the outcome is likely to change more than once.
DENSE_SCAN_POINTS = 1025
# Ratio of two velocities up to which the outcome of a rough run between them may be wrong.
NEAR = 1.05
# Runs of a search between scanned velocities.
HIDDEN_RUNS = 10
# Error of a parabola through three perforations as a part of its difference from the line.
PARABOLA_ERROR = 0.1
# How near to the other outcome a rough impact is repeated: parts of the thickness and of the square of the velocity.
CLOSE = 0.01
# Usual error of a limit by rough runs and, with these, of the slope of the square of the residual velocity there.
ROUGH_ERROR = 1e-4
SLOPE_ERROR = 2e-3
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


class Root(NamedTuple):
    """Where the outcome changes by rough runs."""

    x: float
    slope: float  # derivative of the point by f, see `Bracket`
    runs: int
    resolved: bool


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


def after_perforation(b: Bracket, x: float, f: float, first_estimate: float, first_error: float) -> Bracket:
    """Return the bracket after a perforated run at x; the first such run uses the estimate of the root given."""
    if b.points == 0:
        estimate, error = first_estimate, first_error
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


def slope_at_root(root: float, x1: float, f1: float, x2: float, f2: float) -> float:
    """Return the derivative of x by f at the root, x as a parabola of f through the root and two points."""
    s1, s2 = (x1 - root) / f1, (x2 - root) / f2
    return (s1 * f2 - s2 * f1) / (f2 - f1)


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
        margin = (0.0, b.error, 0.03 * away, PARABOLA_ERROR * b.error)[b.points]
        x = b.estimate + max(margin, tolerance / 3.0)
        if x <= b.low:
            x = b.low + 4.0 * max(margin, b.low - b.estimate)
    return x if b.low < x < b.high else middle


def scan(low: float, high: float, points: int = SCAN_POINTS) -> list[float]:
    """Return the velocities of a scan from `low` to `high`, both included, evenly spaced on a logarithmic scale."""
    ratio, last = high / low, points - 1
    return [low, *(low * ratio ** (i / last) for i in range(1, last)), high]


def impact(p: Parameters, V: float, solver: Solver) -> Impact:
    """Compute the impact at a velocity, m/s."""
    dt = time_step(p, V, solver.given)
    return impact_of(run(p, V, dt, solver.V_arrest, solver.max_steps, None, False), p, V, solver)


def rough_impact(p: Parameters, V: float, solver: Solver) -> Impact:
    """Compute the impact at a velocity, m/s, with longer time steps; its numbers are a few thousandths off."""
    dt = time_step(p, V, 0.0)
    return impact_of(run(p, V, dt, solver.V_arrest, solver.max_steps, None, True), p, V, solver)


def scanned_impact(p: Parameters, V: float, solver: Solver) -> Impact:
    """Compute the impact at a velocity, m/s: roughly or, where it is close to the other outcome, with usual steps."""
    tried = rough_impact(p, V, solver)
    close = tried.nearness > -CLOSE * V * V if tried.perforated else tried.nearness > (1.0 - CLOSE) * (p.Hc0 + p.Hb)
    return impact(p, V, solver) if close or not tried.resolved else tried


def impact_of(end: Run, p: Parameters, V: float, solver: Solver) -> Impact:
    """Return the impact at a velocity, m/s, of which a run is given."""
    resolved = end.outcome != Outcome.UNRESOLVED
    if end.outcome == Outcome.PERFORATED:
        return Impact(V, True, False, resolved, solver.V_arrest * solver.V_arrest - end.y.V * end.y.V)
    return Impact(V, False, end.y.L < ERODED_FRACTION * p.L0, resolved, end.y.Z)


def first_impacts(p: Parameters, velocities: Sequence[float], solver: Solver) -> tuple[Impact, Impact]:
    """Return the first two impacts of a scan of velocities, m/s: an imagined one, and the one at which it starts.

    The scan starts at the highest velocity at which the projectile lacks the energy to perforate, or the lowest.  The
    depth of the imagined impact, one velocity below, is none, so that a maximum is seen where the depth falls.
    """
    i = 0
    while i + 1 < len(velocities) and not may_perforate(p, velocities[i + 1]):
        i += 1
    start = scanned_impact(p, velocities[i], solver)
    if i == 0:
        return start, start
    return Impact(velocities[i - 1], False, start.eroded, True, -inf), start


def find_ballistic_limit(
    p: Parameters, velocities: Sequence[float], tolerance: float, V_arrest: float, given: float, max_steps: int
) -> SearchResult:
    """Find the ballistic limit: the lowest change of the outcome that a scan of velocities, m/s, sees.

    It is none if the lowest velocity perforates.  ``tolerance`` is the width of the final bracket, m/s, and ``given``
    the time step, s, as in `armour.core.stepping.time_step`.  An unresolved run is both ends of the bracket.
    """
    solver = Solver(V_arrest, given, max_steps)
    before, start = first_impacts(p, velocities, solver)
    if not start.resolved:
        return SearchResult(start.V, start.V, 1, False)
    if start.perforated:
        return SearchResult(-inf, start.V, 1, True)
    change = next_change(p, before, start, velocities, solver)
    runs = change.runs + 1
    if not change.above.resolved:
        return SearchResult(change.above.V, change.above.V, runs, False)
    if not change.above.perforated:
        return SearchResult(change.above.V, inf, runs, True)
    found = narrowed(p, change, tolerance, solver)
    return SearchResult(found.low, found.high, found.runs + runs, found.resolved)


def next_change(p: Parameters, before: Impact, start: Impact, velocities: Sequence[float], solver: Solver) -> Change:
    """Return the lowest change of the outcome above an impact that a scan of velocities, m/s, sees.

    ``before`` is the impact below it, or the same.  The search ends at an unresolved run, which is then the impact
    above.
    """
    last, runs = start, 0
    for V in velocities:
        if V <= start.V:
            continue
        end = scanned_impact(p, V, solver)
        runs += 1
        if end.resolved and end.perforated != last.perforated and V < NEAR * last.V:
            sure = confirmed(p, start, Change(last, end, 0), solver)
            runs += sure.runs
            last, end = sure.below, sure.above
        if not end.resolved or end.perforated != last.perforated:
            return Change(last, end, runs)
        hidden = Change(last, last, 0)
        if end.eroded != last.eroded:
            hidden = change_between_causes(p, last, end, solver)
        elif before.eroded == last.eroded and before.nearness < last.nearness > end.nearness:
            hidden = change_at_peak(p, before, last, end, solver)
        runs += hidden.runs
        if hidden.above.resolved and hidden.above.perforated != last.perforated:
            hidden = confirmed(p, start, hidden, solver)
            runs += hidden.runs
        if not hidden.above.resolved or hidden.above.perforated != hidden.below.perforated:
            return Change(hidden.below, hidden.above, runs)
        before, last = last, end
    return Change(last, last, runs)


def confirmed(p: Parameters, start: Impact, change: Change, solver: Solver) -> Change:
    """Return a change between near velocities with both ends by usual impacts, the lower moved down to one that stands.

    Both ends have the outcome below the change if the upper one does not stand.  ``start`` is where the scan started.
    """
    above = impact(p, change.above.V, solver)
    below, V, runs = change.below, change.below.V, 1
    if not above.resolved or above.perforated == below.perforated:
        return Change(below, above, runs)
    ratio = above.V / V
    while True:
        below = impact(p, V, solver)
        runs += 1
        if not below.resolved:
            return Change(below, below, runs)
        if below.perforated != above.perforated:
            return Change(below, above, runs)
        above = below
        V = start.V if V / ratio < start.V < V else V / ratio


def change_at_peak(p: Parameters, below: Impact, peak: Impact, above: Impact, solver: Solver) -> Change:
    """Search around the nearest of three impacts to the other outcome for an impact of that outcome."""
    for i in range(HIDDEN_RUNS):
        upper = above.V - peak.V > peak.V - below.V
        V = peak.V + GOLDEN * (above.V - peak.V if upper else below.V - peak.V)
        tried = scanned_impact(p, V, solver)
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
        tried = scanned_impact(p, 0.5 * (below.V + above.V), solver)
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
    rough = rough_root(p, low, high, first, sign, solver)
    if not rough.resolved:
        return SearchResult(rough.x, rough.x, rough.runs, False)
    b = Bracket(low, high, True, True, 0, 0.0, 0.0, 0.0, 0.0, rough.x, inf, rough.runs)
    start, end = bisected(low, low, high, tolerance)
    cell = end - start
    beyond = 0.0
    while not is_converged(b, tolerance):
        x = next_point(b, 0.0)
        if b.points == 0 and b.runs < MAX_INTERPOLATED_RUNS:
            x = rough.x + beyond
            beyond = 4.0 * beyond + ROUGH_ERROR * abs(rough.x)
        # The upper end of the interval of bisection in which x lies, but for the last, which is known.
        _, x = bisected(min(max(x, b.low), b.high - 1.5 * cell), low, high, tolerance)
        if not b.low < x < b.high:
            x = 0.5 * (b.low + b.high)
        tried = impact(p, sign * x, solver)
        if not tried.resolved:
            return SearchResult(tried.V, tried.V, b.runs + 1, False)
        if tried.perforated:
            estimate = x + rough.slope * tried.nearness
            b = after_perforation(b, x, -tried.nearness, estimate, SLOPE_ERROR * (x - estimate))
        else:
            b = after_defeat(b, x)
    if sign < 0.0:
        return SearchResult(-b.high, -b.low, b.runs, True)
    return SearchResult(b.low, b.high, b.runs, True)


def rough_root(p: Parameters, low: float, high: float, first: Impact, sign: float, solver: Solver) -> Root:
    """Return about where the outcome changes between two signed velocities, m/s, by rough runs.

    ``first`` is the impact at ``high``, which perforates.  The search is for the signed square of the velocity, in
    which the square of the residual velocity is nearly linear.
    """
    b = after_defeat(initial_bracket(sign * low * low, sign * high * high), sign * low * low)
    guess = sign * (first.V * first.V + first.nearness / ENERGY_LEFT)
    b = after_perforation(b, b.high, -first.nearness, guess, 0.2 * (b.high - guess))
    slope = 1.0 / ENERGY_LEFT
    tolerance = 2.0 * ROUGH_ERROR * high * high
    # The error of a parabola is a small part of its difference from the line.
    while (b.error if b.points < 3 else PARABOLA_ERROR * b.error) > tolerance and not is_converged(b, tolerance):
        x = next_point(b, tolerance)
        tried = rough_impact(p, sqrt(abs(x)), solver)
        if not tried.resolved:
            return Root(tried.V, slope, b.runs - 1, False)
        if tried.perforated:
            b = after_perforation(b, x, -tried.nearness, 0.0, 0.0)
            if b.f1 > 0.0 and b.f2 > 0.0 and b.f1 != b.f2:
                slope = slope_at_root(b.estimate, b.x1, b.f1, b.x2, b.f2)
        else:
            b = after_defeat(b, x)
    V = sqrt(abs(min(max(b.estimate, b.low), b.high)))
    return Root(sign * V, 0.5 * slope / V, b.runs - 2, True)


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
        end = run(tried, Vi, time_step(tried, Vi, given), V_arrest, max_steps, None, False)
        if end.outcome == Outcome.UNRESOLVED:
            return SearchResult(-inf, inf, b.runs + 1, False)
        if end.outcome == Outcome.PERFORATED:
            f = end.y.V * end.y.V - V_arrest * V_arrest
            # The limit is about proportional to the thickness.
            limit = sqrt(max(Vi * Vi - f / ENERGY_LEFT, 0.01 * Vi * Vi))
            estimate = -max(Hc0, 0.1 * p.D0) * Vi / limit
            b = after_perforation(b, -Hc0, f, estimate, 0.2 * abs(Hc0 + estimate))
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
