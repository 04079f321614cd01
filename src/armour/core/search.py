"""Where an armour just defeats: a bracket that runs narrow, and what their residual velocities tell of the place.

Just above the ballistic limit the square of the residual velocity is linear in the impact velocity, and in the
thickness of the ceramic.  The next run is therefore put where a polynomial through the last ones says that it vanishes,
a little on the perforated side; where that is outside the bracket, the bracket is bisected.
"""

from math import inf, isfinite, sqrt
from typing import NamedTuple

from armour.core.run import run
from armour.core.stages import default_time_step
from armour.core.state import Outcome, Parameters

# Part of the impact's energy, above that of the limit, that a first perforation leaves; a guess.
ENERGY_LEFT = 0.85
# Runs after which a search that has not come to its end is one by bisection alone.
PATIENCE = 30
# A time step that is given is shortened to this many default ones: beyond that no event is resolved.
COARSEST_STEP = 1.6
# How far a search feels its way up where nothing has perforated yet.
GROWTH = 1.25


class Bracket(NamedTuple):
    """What runs have told: ``low`` is defeated and ``high`` perforates, once they are known to.

    The last two places that perforate are kept with ``f``, the square of the residual velocity less that at which a
    projectile counts as stopped.
    """

    low: float
    high: float
    low_known: bool
    high_known: bool
    places: int  # that the estimate rests on, up to 3
    x1: float
    f1: float
    x2: float
    f2: float
    estimate: float  # of the place
    error: float  # of the estimate
    runs: int


class Found(NamedTuple):
    """How a search ended."""

    low: float  # highest place found that is defeated; -inf where none is
    high: float  # lowest place found that perforates; inf where none does
    runs: int
    resolved: bool  # whether every run has ended within the steps allowed


def time_step(p: Parameters, Vi: float, given: float) -> float:
    """Time step of an impact, s: the given one, within reason, or the default where 0 is given."""
    default = default_time_step(p, Vi)
    return min(given, COARSEST_STEP * default) if given > 0.0 else default


def opened(low: float, high: float) -> Bracket:
    """A bracket of which nothing is known."""
    return Bracket(low, high, False, False, 0, 0.0, 0.0, 0.0, 0.0, 0.0, inf, 0)


def defeated(b: Bracket, x: float) -> Bracket:
    """The bracket after a run that was defeated."""
    return Bracket(x, b.high, True, b.high_known, b.places, b.x1, b.f1, b.x2, b.f2, b.estimate, b.error, b.runs + 1)


def perforated(b: Bracket, x: float, f: float, first: float) -> Bracket:
    """The bracket after a run that perforated; ``first`` is the estimate to make of it where it is the only one."""
    if b.places == 0:
        estimate, error = first, 0.25 * abs(x - first)
    else:
        estimate = extrapolated_root(b.places, x, f, b.x1, b.f1, b.x2, b.f2)
        error = abs(estimate - b.estimate)
    places = min(b.places + 1, 3)
    return Bracket(b.low, x, b.low_known, True, places, x, f, b.x1, b.f1, estimate, error, b.runs + 1)


def extrapolated_root(earlier: int, x1: float, f1: float, x2: float, f2: float, x3: float, f3: float) -> float:
    """Where the polynomial through a place and one or two earlier ones vanishes (Neville)."""
    if f1 == f2:
        return x1
    line = x1 - f1 * (x2 - x1) / (f2 - f1)
    if earlier == 1 or f2 == f3 or f1 == f3:
        return line
    other = x2 - f2 * (x3 - x2) / (f3 - f2)
    return line - f1 * (other - line) / (f3 - f1)


def is_narrow(b: Bracket, tolerance: float) -> bool:
    """Whether the place is known to the tolerance, or as well as the numbers allow."""
    if not (b.low_known and b.high_known):
        return False
    middle = 0.5 * (b.low + b.high)
    return b.high - b.low <= tolerance or not b.low < middle < b.high


def proposed(b: Bracket, tolerance: float) -> float:
    """Where to run next in a bracket whose high end perforates."""
    middle = 0.5 * (b.low + b.high)
    if b.runs > PATIENCE:
        return middle
    away = b.high - b.estimate
    if away <= 0.7 * tolerance:
        x = b.high - 0.9 * tolerance
    else:
        margin = (0.0, 0.2 * away, 0.03 * away, 0.02 * b.error)[b.places]
        x = b.estimate + max(margin, tolerance / 3.0)
        if x <= b.low:
            x = b.low + 4.0 * max(margin, b.low - b.estimate)
    return x if b.low < x < b.high else middle


def ballistic_limit_of(
    p: Parameters, low: float, high: float, tolerance: float, V_arrest: float, given: float, max_steps: int
) -> Found:
    """Ballistic limit between two impact velocities, m/s, where the outcome changes once between them."""
    b = opened(low, high)
    guess = first_guess(p)
    V = min(max(guess, low), high) if isfinite(guess) else low
    while True:
        end = run(p, V, time_step(p, V, given), V_arrest, max_steps)
        if end.outcome == Outcome.UNRESOLVED:
            return Found(-inf, inf, b.runs + 1, False)
        if end.outcome == Outcome.PERFORATED:
            f = end.y.V * end.y.V - V_arrest * V_arrest
            b = perforated(b, V, f, sqrt(max(V * V - f / ENERGY_LEFT, 0.0)))
            if low >= V:
                return Found(-inf, V, b.runs, True)
        else:
            b = defeated(b, V)
            if high <= V:
                return Found(V, inf, b.runs, True)
        if is_narrow(b, tolerance):
            return Found(b.low, b.high, b.runs, True)
        if not b.high_known:
            V = min(GROWTH * b.low, high)
        elif not b.low_known and b.estimate <= low:
            V = low
        else:
            V = proposed(b, tolerance)


def least_ceramic_thickness(
    p: Parameters, Vi: float, thin: float, thick: float, tolerance: float, V_arrest: float, given: float, max_steps: int
) -> Found:
    """Ceramic thickness, m, at which an impact is just defeated; ``low`` and ``high`` are its negatives."""
    b = opened(-thick, -thin)
    Hc0 = thin
    while True:
        tried = with_ceramic(p, Hc0)
        end = run(tried, Vi, time_step(tried, Vi, given), V_arrest, max_steps)
        if end.outcome == Outcome.UNRESOLVED:
            return Found(-inf, inf, b.runs + 1, False)
        if end.outcome == Outcome.PERFORATED:
            f = end.y.V * end.y.V - V_arrest * V_arrest
            # The limit grows about as the thickness.
            limit = sqrt(max(Vi * Vi - f / ENERGY_LEFT, 0.01 * Vi * Vi))
            b = perforated(b, -Hc0, f, -max(Hc0, 0.1 * p.D0) * Vi / limit)
            if Hc0 >= thick:
                return Found(-inf, -Hc0, b.runs, True)
        else:
            b = defeated(b, -Hc0)
            if Hc0 <= thin:
                return Found(-Hc0, inf, b.runs, True)
        if is_narrow(b, tolerance):
            return Found(b.low, b.high, b.runs, True)
        Hc0 = -proposed(b, tolerance)
        if not b.low_known and b.estimate <= b.low:
            Hc0 = thick


def with_ceramic(p: Parameters, Hc0: float) -> Parameters:
    """The armour with another ceramic thickness."""
    return Parameters(p.L0, p.D0, p.rho_p, p.Yp, Hc0, p.rho_c, p.Ec, p.Yc0, p.Hb, p.rho_B, p.YB, p.tau, p.conoid)


def first_guess(p: Parameters) -> float:
    """Ballistic limit, m/s, within about a tenth: work of strengths and shear over the mass of the rod.

    The numbers are a fit to 1,000 random designs of both rounds of the paper; they cost or save a run and nothing else.
    """
    rod = p.rho_p * p.L0
    sheared = 3.4 * p.Hb + (13.0 * p.Hc0 if p.conoid else 0.0)
    work = 0.86 * p.Yc0 * p.Hc0 + 0.56 * p.YB * p.Hb + p.tau * p.Hb * sheared / p.D0
    return sqrt(max(work / rod, 0.0)) * (1.0 + 0.3 * p.rho_c * p.Hc0 / rod + 0.6 * p.rho_B * p.Hb / rod)
