"""Searches for the ballistic limit and the least ceramic thickness.

The outcome may change more than once with the impact velocity.  The ballistic limit is the lowest change that a scan of
velocities sees.  Perforation, or stop, between two scanned velocities is searched for where their neighbours hint at
it: at a maximum of the penetration depth, at a minimum of the residual velocity, and where stopped projectiles stop at
one velocity and are used up at the next.

The scan starts at the highest velocity below which no projectile has the energy to perforate, and passes over the next
velocity as long as the depth is small and rises.  Its runs are rough, with longer time steps, and are repeated with the
usual ones where the outcome is close.  A change is then narrowed by rough runs and, from where these lead, by a few
usual ones; an end of the bracket that is further from the estimate than its error is known without a run.

The square of the residual velocity is nearly linear in the square of the impact velocity, and in the ceramic thickness.
Where a projectile stops together with all material ahead, its deceleration is constant, and the energy that it lacks
continues the function below the limit (`residual_energy`).  Each run is placed at the root of a polynomial through the
last runs, at the perforated side of it where one side alone is known, or at the middle of the bracket.
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
# Depth of a stopped projectile, as a part of the thickness, up to which the scan may pass over the next velocity.
FAR = 0.6
# Runs of a search between scanned velocities.
HIDDEN_RUNS = 10
# Errors of estimates of the root: of the first one and of a line, as parts of their distance from a perforated end, and
# of a parabola, as a part of its difference from the line.
ESTIMATE_ERROR = 0.2
LINE_ERROR = 0.03
PARABOLA_ERROR = 0.1
# Parts of the tolerance: how near to the estimate a perforated end is for a last run, how far below this end that run
# is, and how far above the estimate another run is at least.
ENDING, WITHIN, LEAST_MARGIN = 0.7, 0.9, 1.0 / 3.0
# How far above a stopped end the next run is, times the error that the estimate has shown there.
MISSED = 4.0
# How near to the other outcome a rough impact is repeated: parts of the thickness and of the square of the velocity.
# Of an unusual armour, rough runs stop at 99.3 % of the thickness where usual ones perforate.
CLOSE = 0.025
# Error of a limit at which rough runs end, as a part of it, and of the slope of the residual energy that they give.
ROUGH_ERROR = 5e-4
SLOPE_ERROR = 0.02
# Greatest relative change of that slope over the relative change of the velocity.
BEND = 20.0
# An estimate of a limit is trusted if it differs by at most this part of it from the one before.
AGREEMENT = 3e-3
# Greatest relative error of the slope of rough runs with which the estimate by a single usual run is trusted.
GREATEST_DOUBT = 0.3
# Usual runs after which no estimate is trusted: a residual energy that takes so many is not smooth.
TRUSTED_RUNS = 4
# Part of a limit to which the residual energy and the outcome of a run agree: rounding, and the width of events.
ROUNDING = 1e-11
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
    # How near it is to the other outcome: the penetration depth, m, or if perforated -f.
    nearness: float
    f: float  # residual energy, see `residual_energy`, m^2/s^2


class Change(NamedTuple):
    """Two impacts between which the outcome changes; the outcome is the same at both if no change is seen."""

    below: Impact
    above: Impact
    runs: int


class Root(NamedTuple):
    """Where the outcome changes by rough runs."""

    x: float
    slope: float  # derivative of the point by f, see `Bracket`
    doubt: float  # error of the slope, as a part of it
    runs: int
    resolved: bool


class Bracket(NamedTuple):
    """Interval that contains the root, and the points of the interpolation.

    A run at ``high`` perforates, and one at ``low`` is stopped if ``low_known``.  The function ``f`` is the residual
    energy of `residual_energy`, m^2/s^2.
    """

    low: float
    high: float
    low_known: bool
    smooth: bool  # f is known at ``low``
    points: int  # number of points that the estimate uses, 1 to 3
    x1: float  # last point
    f1: float
    x2: float  # the one before it
    f2: float
    estimate: float  # estimate of the root
    error: float  # error of the estimate
    runs: int


class Zero(NamedTuple):
    """Where usual runs estimate that the residual energy f is zero, by the last run and the slope there."""

    x: float
    error: float  # inf where it is not trusted
    slope: float  # derivative of the point by f
    x1: float  # last run with a known f
    f1: float  # -inf before the first


class SearchResult(NamedTuple):
    """Result of a search."""

    low: float  # highest point known to be stopped, by a run or by the estimate; -inf if none
    high: float  # lowest point known to perforate, by the same; inf if none
    runs: int
    resolved: bool  # every run ended within the maximum number of steps


def first_bracket(low: float, high: float, f: float, estimate: float) -> Bracket:
    """Return the bracket after a first run, which perforates at ``high``, with an estimate of the root."""
    error = ESTIMATE_ERROR * abs(high - estimate)
    return Bracket(low, high, False, False, 1, high, f, 0.0, 0.0, estimate, error, 1)


def after_run(b: Bracket, x: float, f: float, perforated: bool) -> Bracket:
    """Return the bracket after a run at x; f is -inf where it is not known."""
    low, high = (b.low, x) if perforated else (x, b.high)
    known, runs = b.low_known or not perforated, b.runs + 1
    if f == -inf:
        return Bracket(low, high, known, False, b.points, b.x1, b.f1, b.x2, b.f2, b.estimate, b.error, runs)
    estimate = estimated_root(b.points, x, f, b.x1, b.f1, b.x2, b.f2)
    error, smooth = abs(estimate - b.estimate), b.smooth or not perforated
    return Bracket(low, high, known, smooth, min(b.points + 1, 3), x, f, b.x1, b.f1, estimate, error, runs)


def estimated_root(earlier: int, x1: float, f1: float, x2: float, f2: float, x3: float, f3: float) -> float:
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
    middle = 0.5 * (b.low + b.high)
    return b.low_known and (b.high - b.low <= tolerance or not b.low < middle < b.high)


def next_point(b: Bracket, tolerance: float) -> float:
    """Return the point of the next run.

    It is a little above the estimate, by the error that this may have, so that the run most likely perforates.  If the
    upper end is already that near, the run is just within the tolerance below it, to end the search.
    """
    middle = 0.5 * (b.low + b.high)
    if b.runs > MAX_INTERPOLATED_RUNS:
        return middle
    away = b.high - b.estimate
    if away <= ENDING * tolerance:
        x = b.high - WITHIN * tolerance
    else:
        margin = 0.0 if b.smooth else (b.error, LINE_ERROR * away, PARABOLA_ERROR * b.error)[b.points - 1]
        x = b.estimate + max(margin, LEAST_MARGIN * tolerance)
        if x <= b.low:
            x = b.low + MISSED * max(margin, b.low - b.estimate)
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
    f = residual_energy(end, p, solver.V_arrest)
    if end.outcome == Outcome.PERFORATED:
        return Impact(V, True, False, resolved, -f, f)
    return Impact(V, False, end.y.L < ERODED_FRACTION * p.L0, resolved, end.y.Z, f)


def residual_energy(end: Run, p: Parameters, V_arrest: float) -> float:
    """Return the square of the residual velocity less that of the arrest velocity, m^2/s^2.

    A projectile that stops together with all material ahead, at a constant deceleration (33), would have perforated
    with more energy in proportion to the armour that is left: this continues the function below the limit without a
    bend.  It is -inf for other projectiles that stop.
    """
    f = end.y.V * end.y.V - V_arrest * V_arrest
    if end.outcome == Outcome.PERFORATED:
        return f
    return f + 2.0 * end.constant_dV * (p.Hc0 + p.Hb - end.y.Z) if end.constant_dV < 0.0 else -inf


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
    return Impact(velocities[i - 1], False, start.eroded, True, -inf, -inf), start


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
    last, ahead, runs = start, start, 0
    i = 0
    while i < len(velocities) and velocities[i] <= start.V:
        i += 1
    while i < len(velocities):
        V = velocities[i]
        if V > ahead.V and i + 1 < len(velocities) and is_far(p, last, V):
            ahead = scanned_impact(p, velocities[i + 1], solver)
            runs += 1
            if rises(last, ahead):
                V = ahead.V
                i += 1
        end = ahead
        if V != ahead.V:
            end = scanned_impact(p, V, solver)
            runs += 1
        i += 1
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


def is_far(p: Parameters, last: Impact, V: float) -> bool:
    """Return whether a scan may pass over a velocity, m/s: the last impact has stopped far from the back face."""
    return not last.perforated and NEAR * last.V < V and last.nearness < FAR * (p.Hc0 + p.Hb)


def rises(last: Impact, ahead: Impact) -> bool:
    """Return whether a faster projectile stops as the last one did, and deeper: none between is taken to perforate."""
    return ahead.resolved and not ahead.perforated and ahead.eroded == last.eroded and ahead.nearness > last.nearness


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

    Usual runs at ends of the intervals of bisection estimate where the residual energy is zero.  An end of the bracket
    that is further from the estimate than its error needs no run, unless the change is between near velocities.  The
    bracket is in ascending order of velocity.
    """
    # The upper end of a bracket perforates: velocities are negative where the outcome above the change is stop.
    sign = 1.0 if change.above.perforated else -1.0
    first, other = (change.above, change.below) if change.above.perforated else (change.below, change.above)
    low, high = sign * other.V, sign * first.V
    rough = rough_root(p, low, high, first, other, sign, solver)
    if not rough.resolved:
        return SearchResult(rough.x, rough.x, rough.runs, False)
    trusted = TRUSTED_RUNS if change.above.V > NEAR * change.below.V else 0
    zero = Zero(rough.x, inf, rough.slope, 0.0, -inf)
    stopped, perforated = low, high
    beyond, runs = 0.0, 0
    while True:
        if runs > MAX_INTERPOLATED_RUNS or not stopped <= zero.x < perforated:
            zero = zero_at(zero, 0.5 * (stopped + perforated))
        start, end = bisected(zero.x, low, high, tolerance)
        start_known = stopped >= start or zero.x - start > zero.error
        end_known = perforated <= end or end - zero.x > zero.error
        if start_known and end_known:
            break
        x = start if end_known or (not start_known and zero.x - start < end - zero.x) else end
        tried = impact(p, sign * x, solver)
        runs += 1
        if not tried.resolved:
            return SearchResult(tried.V, tried.V, rough.runs + runs, False)
        if tried.perforated:
            perforated = x
        else:
            stopped = x
        if tried.f > -inf:
            zero = after_usual(zero, rough, x, tried.f, runs <= trusted)
        else:
            # The run tells only that the change is above x: the steps away from it grow.
            beyond = MISSED * beyond + ROUGH_ERROR * abs(x)
            zero = zero_at(zero, x + beyond)
    if sign < 0.0:
        return SearchResult(-end, -start, rough.runs + runs, True)
    return SearchResult(start, end, rough.runs + runs, True)


def zero_at(zero: Zero, x: float) -> Zero:
    """Return an estimate of the zero at x without trust."""
    return Zero(x, inf, zero.slope, zero.x1, zero.f1)


def after_usual(zero: Zero, rough: Root, x: float, f: float, trusted: bool) -> Zero:
    """Return the estimate of the zero after a usual run at x with the residual energy f.

    Its error is its distance from x times the relative error of the slope.  It is trusted if it agrees with the one
    before it, unless it rests on one run and a doubtful slope of rough runs.
    """
    if zero.f1 == -inf or zero.f1 == f:
        # By one run, what is on the other side of the zero is known only further away than the run itself.
        slope, doubt = zero.slope, 1.0 + rough.doubt
        trusted = trusted and rough.doubt <= GREATEST_DOUBT
    else:
        slope = (x - zero.x1) / (f - zero.f1)
        doubt = rough.doubt + abs(slope / zero.slope - 1.0) + BEND * abs((x - zero.x1) / x)
    root = x - slope * f
    trusted = trusted and abs(root - zero.x) <= AGREEMENT * abs(x)
    return Zero(root, max(doubt * abs(x - root), ROUNDING * abs(x)) if trusted else inf, slope, x, f)


def rough_root(
    p: Parameters, low: float, high: float, first: Impact, other: Impact, sign: float, solver: Solver
) -> Root:
    """Return about where the outcome changes between two signed velocities, m/s, by rough runs.

    ``first`` is the impact at ``high``, which perforates, and ``other`` that at ``low``.  The search is for the signed
    square of the velocity, in which the residual energy is nearly linear.
    """
    x = sign * high * high
    b = first_bracket(sign * low * low, x, first.f, x - first.f / ENERGY_LEFT)
    b = after_run(b, b.low, other.f, False)
    slope, doubt = 1.0 / ENERGY_LEFT, 1.0
    tolerance = 2.0 * ROUGH_ERROR * high * high
    # The error of a parabola is a small part of its difference from the line.
    while (b.error if b.points < 3 else PARABOLA_ERROR * b.error) > tolerance and not is_converged(b, tolerance):
        x = next_point(b, tolerance)
        tried = rough_impact(p, sqrt(abs(x)), solver)
        if not tried.resolved:
            return Root(tried.V, slope, doubt, b.runs - 1, False)
        b = after_run(b, x, tried.f, tried.perforated)
    if b.points > 2 and b.x1 != b.estimate and b.f1 != b.f2:
        slope = slope_at_root(b.estimate, b.x1, b.f1, b.x2, b.f2)
        doubt = SLOPE_ERROR + abs((b.x1 - b.estimate) / (b.f1 * slope) - 1.0)
    V = sqrt(abs(min(max(b.estimate, b.low), b.high)))
    return Root(sign * V, 0.5 * slope / V, doubt, b.runs - 2, True)


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
    """Find the least ceramic thickness between two, m, that stops an impact; the outcome changes once between them.

    The result brackets the negative thickness, -Hc0, m, so that its upper end perforates.  ``p.Hc0`` is not used;
    ``tolerance`` is the width of the final bracket, m, and ``given`` the time step, s, as in `find_ballistic_limit`.
    """
    solver = Solver(V_arrest, given, max_steps)
    thinnest = impact(p._replace(Hc0=thin), Vi, solver)
    if not thinnest.resolved:
        return SearchResult(-inf, inf, 1, False)
    if not thinnest.perforated:
        return SearchResult(-thin, inf, 1, True)
    # The limit is about proportional to the thickness.
    limit = sqrt(max(Vi * Vi - thinnest.f / ENERGY_LEFT, 0.01 * Vi * Vi))
    b = first_bracket(-thick, -thin, thinnest.f, -max(thin, 0.1 * p.D0) * Vi / limit)
    while not is_converged(b, tolerance):
        Hc0 = thick if not b.low_known and b.estimate <= b.low else -next_point(b, tolerance)
        tried = impact(p._replace(Hc0=Hc0), Vi, solver)
        if not tried.resolved:
            return SearchResult(-inf, inf, b.runs + 1, False)
        # The energy that a stopped projectile lacks continues the function for the velocity, not for the thickness.
        b = after_run(b, -Hc0, tried.f if tried.perforated else -inf, tried.perforated)
        if tried.perforated and Hc0 >= thick:
            return SearchResult(-inf, -Hc0, b.runs, True)
    return SearchResult(b.low, b.high, b.runs, True)
