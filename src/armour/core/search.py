"""Searches for the ballistic limit and the least ceramic thickness, by interpolation of residual velocities.

Just above the ballistic limit the square of the residual velocity is linear in the impact velocity, and in the ceramic
thickness.  Each run is therefore placed just on the perforated side of the root of a polynomial through the last
perforations, or at the middle of the bracket where that root lies outside it.
"""

from math import inf, isfinite, sqrt
from typing import NamedTuple

from armour.core.equations import sheared_diameter
from armour.core.run import run
from armour.core.state import Outcome, Parameters
from armour.core.stepping import time_step

# Residual energy of the first perforation as a fraction of the impact energy above the limit's; an estimate.
ENERGY_LEFT = 0.85
# Runs of a search after which it continues by bisection.
MAX_INTERPOLATED_RUNS = 30
# Factor by which the velocity is raised until a run perforates.
GROWTH = 1.25


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


def find_ballistic_limit(
    p: Parameters, low: float, high: float, tolerance: float, V_arrest: float, given: float, max_steps: int
) -> SearchResult:
    """Find the ballistic limit between two impact velocities, m/s, between which the outcome changes once.

    ``tolerance`` is the width of the final bracket, m/s, and ``given`` the time step, s, as in
    `armour.core.stepping.time_step`.
    """
    b = initial_bracket(low, high)
    guess = estimated_limit(p)
    V = min(max(guess, low), high) if isfinite(guess) else low
    while True:
        end = run(p, V, time_step(p, V, given), V_arrest, max_steps)
        if end.outcome == Outcome.UNRESOLVED:
            return SearchResult(-inf, inf, b.runs + 1, False)
        if end.outcome == Outcome.PERFORATED:
            f = end.y.V * end.y.V - V_arrest * V_arrest
            b = after_perforation(b, V, f, sqrt(max(V * V - f / ENERGY_LEFT, 0.0)))
            if low >= V:
                return SearchResult(-inf, V, b.runs, True)
        else:
            b = after_defeat(b, V)
            if high <= V:
                return SearchResult(V, inf, b.runs, True)
        if is_converged(b, tolerance):
            return SearchResult(b.low, b.high, b.runs, True)
        if not b.high_known:
            V = min(GROWTH * b.low, high)
        elif not b.low_known and b.estimate <= low:
            V = low
        else:
            V = next_point(b, tolerance)


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


def estimated_limit(p: Parameters) -> float:
    """Return an estimate of the ballistic limit, m/s, good to about a tenth, from which a search starts.

    The work of strength and shear is equated to the energy of the projectile.  The coefficients are fitted to 1,000
    random designs of both projectiles of the paper; they affect the number of runs of a search, not its result.
    """
    rod = p.rho_p * p.L0
    sheared = 3.4 * p.Hb + 3.25 * (sheared_diameter(p.shear_law, p.D0, p.Hc0) - p.D0)
    work = 0.86 * p.Yc0 * p.Hc0 + 0.56 * p.YB * p.Hb + p.tau * p.Hb * sheared / p.D0
    return sqrt(max(work / rod, 0.0)) * (1.0 + 0.3 * p.rho_c * p.Hc0 / rod + 0.6 * p.rho_B * p.Hb / rod)
