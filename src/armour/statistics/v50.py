"""Ballistic limits from firing tests: V50 by the rule of MIL-STD-662F, and by maximum likelihood."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from math import erf, exp, log, nan, pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from armour.analysis.ballistic_limit import ballistic_limit
from armour.errors import InputError, NoAnswerError, Problem
from armour.scenario.loading import Scenario
from armour.statistics.test_data import read_rows

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# Shots of each kind that a V50 takes, and the greatest span of their velocities, m/s: 60, 90 and 125 feet a second
# for two, three and five.
SPANS_M_S = {5: 38.1, 3: 27.4, 2: 18.3}
# Slower and faster than any shot; they catch a value in the wrong unit.
SLOWEST_M_S, FASTEST_M_S = 1.0, 1e4
CONFIDENCE = 0.95
Curve = Literal["probit", "logit"]
CURVES: tuple[Curve, ...] = ("probit", "logit")
# The narrowest curve looked at, and how far a bound is looked for, in spreads of the velocities.
NARROWEST = 1e-7
FARTHEST = 1e3


@dataclass(frozen=True)
class Shots:
    """Firing results.

    Attributes
    ----------
    velocities_m_s : tuple of float
    complete : tuple of bool
        Whether each was a complete penetration.
    file : str
    """

    velocities_m_s: tuple[float, ...]
    complete: tuple[bool, ...]
    file: str = "shots"

    def of(self, *, complete: bool) -> list[float]:
        """Velocities of the complete, or of the partial, penetrations, in order."""
        pairs = zip(self.velocities_m_s, self.complete, strict=True)
        return sorted(velocity for velocity, found in pairs if found == complete)


@dataclass(frozen=True)
class Mean:
    """V50 as the mean of as many highest partial as lowest complete penetrations.

    Attributes
    ----------
    v50_m_s : float
    pairs : int
        Shots of each kind.
    span_m_s, span_allowed_m_s : float
        Between the slowest and the fastest of them.
    """

    v50_m_s: float
    pairs: int
    span_m_s: float
    span_allowed_m_s: float


@dataclass(frozen=True)
class Fit:
    """A curve of the probability of complete penetration, by maximum likelihood.

    Attributes
    ----------
    curve : {"probit", "logit"}
    v50_m_s : float
        The middle of the gap where the shots separate.
    v50_interval_m_s : tuple of float or None
        By profile likelihood; None for an end that the shots do not bound.
    scale_m_s : float
        Standard deviation of the normal, scale of the logistic distribution; 0 where the shots separate.
    scale_interval_m_s : tuple of float or None
        None for an upper end that the shots do not bound.
    log_likelihood : float
    """

    curve: Curve
    v50_m_s: float
    v50_interval_m_s: tuple[float | None, float | None]
    scale_m_s: float
    scale_interval_m_s: tuple[float, float | None]
    log_likelihood: float


@dataclass(frozen=True)
class FiringResult:
    """What firing results say of the ballistic limit.

    Attributes
    ----------
    shots, complete : int
    highest_partial_m_s, lowest_complete_m_s : float
    separated : bool
        Whether every complete penetration was faster than every partial one.
    mean : Mean or None
        None where no rule's span holds.
    fits : tuple of Fit
    confidence : float
        Of the intervals.
    model_ballistic_limit_m_s : float or None
        Of the scenario, where one is given.  The model knows no scatter: it is one velocity, not the middle of a curve.
    """

    shots: int
    complete: int
    highest_partial_m_s: float
    lowest_complete_m_s: float
    separated: bool
    mean: Mean | None
    fits: tuple[Fit, ...]
    confidence: float
    model_ballistic_limit_m_s: float | None

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


def read_shots(path: Path) -> Shots:
    """Read firing results: a CSV file with the columns ``velocity_m_s``, ``result`` and, for names, ``shot``.

    Raises
    ------
    InputError
        With every mistake in the file.
    """
    rows = read_rows(path, numbers=("velocity_m_s",), texts=("result", "shot"), needed=("velocity_m_s", "result"))
    problems = []
    words = {"complete": True, "partial": False}
    for row in rows:
        velocity, result = row["velocity_m_s"], row["result"]
        if not isinstance(velocity, float) or not SLOWEST_M_S <= velocity <= FASTEST_M_S:
            message = f"must be at least {SLOWEST_M_S:g} and at most {FASTEST_M_S:g}"
            problems.append(Problem(str(path), f"{row.place}: velocity_m_s", message))
        if result not in words:
            message = f'must be "partial" or "complete", found "{result or ""}"'
            problems.append(Problem(str(path), f"{row.place}: result", message))
    if not problems:
        kinds = {words[str(row["result"])] for row in rows}
        if kinds != {True, False}:
            only = "only complete ones" if True in kinds else "only partial ones"
            message = f"must have at least one partial and one complete penetration, found {only}"
            problems.append(Problem(str(path), "result", message))
    if problems:
        raise InputError(problems)
    velocities = tuple(float(row["velocity_m_s"] or nan) for row in rows)
    return Shots(velocities, tuple(words[str(row["result"])] for row in rows), str(path))


def v50(
    shots: Shots,
    scenario: Scenario | None = None,
    *,
    pairs: int | None = None,
    span_m_s: float | None = None,
    confidence: float = CONFIDENCE,
) -> FiringResult:
    """Find the velocity that perforates every other time.

    Parameters
    ----------
    shots : Shots
        At least one partial and one complete penetration.
    scenario : Scenario, optional
        The same armour and projectile, for the model's ballistic limit beside the test's.
    pairs : int, optional
        Shots of each kind for the mean; by default the most of 5, 3 and 2 whose span holds.
    span_m_s : float, optional
        Greatest span of their velocities; by default that of MIL-STD-662F for so many.
    confidence : float
        Of the intervals.

    Raises
    ------
    NoAnswerError
        If faster shots did not perforate more often, or the scenario has no ballistic limit.
    """
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    return FiringResult(
        shots=len(shots.complete),
        complete=len(complete),
        highest_partial_m_s=partial[-1],
        lowest_complete_m_s=complete[0],
        separated=partial[-1] < complete[0],
        mean=mean_of(shots, pairs, span_m_s),
        fits=tuple(fitted(shots, curve, confidence) for curve in CURVES),
        confidence=confidence,
        model_ballistic_limit_m_s=None if scenario is None else ballistic_limit(scenario).ballistic_limit_m_s,
    )


def mean_of(shots: Shots, pairs: int | None = None, span_m_s: float | None = None) -> Mean | None:
    """V50 by the rule of MIL-STD-662F; None where the shots do not meet it."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    for count in SPANS_M_S if pairs is None else (pairs,):
        if count > min(len(partial), len(complete)):
            continue
        used = [*partial[-count:], *complete[:count]]
        allowed = SPANS_M_S.get(count, SPANS_M_S[5]) if span_m_s is None else span_m_s
        span = max(used) - min(used)
        if span <= allowed + 1e-9:
            return Mean(sum(used) / len(used), count, span, allowed)
    return None


def fitted(shots: Shots, curve: Curve, confidence: float = CONFIDENCE) -> Fit:
    """A curve by maximum likelihood, with profile-likelihood intervals.

    The likelihood is that of P = F(slope x - intercept), x being the velocity less its mean over its spread; its
    logarithm is concave in both.  Where the shots separate it is greatest at an infinite slope, with any probability at
    a velocity that a partial and a complete penetration share.  Each point of a profile is the greatest value along a
    line, which exists, at an infinite slope if need be, whether the shots separate or not.

    Raises
    ------
    NoAnswerError
        If faster shots did not perforate more often.
    """
    import numpy as np
    from scipy.stats import chi2

    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if np.mean(complete) <= np.mean(partial):
        raise NoAnswerError(
            f"no V50: the complete penetrations were no faster on average ({np.mean(complete):.1f} m/s) than the "
            f"partial ones ({np.mean(partial):.1f} m/s)"
        )
    velocities = np.array([*partial, *complete])
    signs = np.repeat([-1.0, 1.0], [len(partial), len(complete)])
    middle, spread = float(velocities.mean()), float(velocities.std())
    x = (velocities - middle) / spread
    log_cdf = _log_cdf(curve)

    def likelihood(slope: float, intercept: float) -> float:
        return float(log_cdf(signs * (slope * x - intercept)).sum())

    def at_place(place: float) -> float:
        """Greatest likelihood of all curves through one half at a place."""
        found = _least(lambda part: -likelihood(part / (1.0 - part), place * part / (1.0 - part)), 0.0, 1.0 - NARROWEST)
        return max(-found, likelihood(1.0 / NARROWEST, place / NARROWEST), likelihood(0.0, 0.0))

    def at_scale(scale: float) -> float:
        """Greatest likelihood of all curves so wide."""
        ends = (x[0] / scale, x[-1] / scale, x[len(partial)] / scale, x[len(partial) - 1] / scale)
        return -_least(lambda intercept: -likelihood(1.0 / scale, intercept), min(ends) - 9.0, max(ends) + 9.0)

    low, high = float(x[len(partial) - 1]), float(x[len(partial)])
    if low <= high:
        tied = [int((x[signs == sign] == low).sum()) for sign in (-1.0, 1.0)] if low == high else []
        place, scale, top = 0.5 * (low + high), 0.0, sum(n * log(n / sum(tied)) for n in tied)
    else:
        place, scale, top = _peak(curve, signs, x)
    least_likely = top - 0.5 * float(chi2.ppf(confidence, 1))

    def place_likely(place: float) -> float:
        return at_place(place) - least_likely

    def scale_likely(log_scale: float) -> float:
        return at_scale(exp(log_scale)) - least_likely

    # Where the shots separate any place between them is as likely.
    starts = (low, high) if scale == 0.0 else (place, place)
    ends = _crossing(place_likely, starts[0], -1.0), _crossing(place_likely, starts[1], 1.0)
    narrowest = _crossing(scale_likely, log(scale), -1.0) if scale else None
    widest = _crossing(scale_likely, log(scale or NARROWEST), 1.0)
    return Fit(
        curve=curve,
        v50_m_s=middle + spread * place,
        v50_interval_m_s=(
            None if ends[0] is None else middle + spread * ends[0],
            None if ends[1] is None else middle + spread * ends[1],
        ),
        scale_m_s=spread * scale,
        scale_interval_m_s=(
            0.0 if narrowest is None else spread * exp(narrowest),
            None if widest is None else spread * exp(widest),
        ),
        log_likelihood=top,
    )


def probability(fit: Fit, velocity_m_s: float) -> float:
    """Probability of complete penetration by a fitted curve."""
    if fit.scale_m_s == 0.0:
        return 0.5 * (1.0 + (velocity_m_s > fit.v50_m_s) - (velocity_m_s < fit.v50_m_s))
    z = (velocity_m_s - fit.v50_m_s) / fit.scale_m_s
    if fit.curve == "probit":
        return 0.5 * (1.0 + erf(z / sqrt(2.0)))
    return 1.0 / (1.0 + exp(-z)) if z > -700.0 else 0.0


def _log_cdf(curve: Curve) -> "Callable[[Floats], Floats]":
    from scipy.special import log_expit, log_ndtr

    return log_ndtr if curve == "probit" else log_expit


def _least(f: Callable[[float], float], low: float, high: float) -> float:
    """Least value of a function with one minimum between two ends."""
    from scipy.optimize import minimize_scalar

    return float(minimize_scalar(f, bounds=(low, high), method="bounded", options={"xatol": 1e-10}).fun)


def _peak(curve: Curve, signs: "Floats", x: "Floats") -> tuple[float, float, float]:
    """Place and scale of the greatest likelihood of shots that overlap, and its logarithm."""
    import numpy as np
    from scipy.optimize import minimize
    from scipy.special import expit

    log_cdf = _log_cdf(curve)

    def lost(p: "Floats") -> tuple[float, "Floats"]:
        z = signs * (p[0] * x - p[1])
        steep = signs * (expit(-z) if curve == "logit" else np.exp(-0.5 * z * z - log_cdf(z)) / sqrt(2.0 * pi))
        return -float(log_cdf(z).sum()), np.array([-(steep * x).sum(), steep.sum()])

    found = minimize(lost, np.array([1.0, 0.0]), jac=True, method="BFGS", options={"gtol": 1e-9})
    slope, intercept = found.x
    return float(intercept / slope), float(1.0 / slope), -float(found.fun)


def _crossing(inside: Callable[[float], float], start: float, direction: float) -> float | None:
    """Where a function stops being positive, from a start in a direction; None where it does not."""
    from scipy.optimize import brentq

    step, near = 1e-3, start
    while step < FARTHEST:
        far = start + direction * step
        if inside(far) < 0.0:
            return float(brentq(inside, near, far, xtol=1e-9)) if inside(near) > 0.0 else near
        near, step = far, 2.0 * step
    return None
