"""How many shots each procedure needs to know V50, and how often its interval contains V50.

The armour is the paper's lightest against the 7.62 mm AP.  V50 is 0, 1 or 2 standard deviations of the error of the
model from the median that this gives, above it in one half of the firings and below it in the other; the scatter is 15
or 30 m/s, or drawn from the prior for the Bayesian procedure.  A shot misses the velocity that it is aimed at by 5 m/s
(standard deviation), and is measured exactly.  A firing ends when the interval of V50 is within +- 15 m/s: of the
Bayesian procedure that of the posterior, of the others that of the penalised likelihood of `armour v50`.  "bayesian,
scatter known" is told the scatter within a factor of 1.2.  The procedures "without the model" are told that V50 lies
within 50 % of the model's limit, and up-and-down starts 20 % above it.

`decisions` asks whether a velocity exceeds 90 % of the model's limit, V50 or that at which 5 % of shots perforate, by
the Bayesian procedure.  The velocity is this requirement or a number of scatters away from it.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.variants import Bools, Floats
from armour.planning.firing import limits_of
from armour.planning.procedures import MOST_SHOTS, PROCEDURES, Firings, ShotSettings, fire, posterior
from armour.scenario.scenario import load_scenario
from armour.statistics.posterior import FiringPrior, posterior_of
from armour.statistics.v50 import Shots
from tools.experiments.share import Share

SCENARIO, HALF_WIDTH_M_S, CONFIDENCE, MISS_M_S, MOST = "paper/optimum_7.62mm_AP", 15.0, 0.95, 5.0, 150
DEVIATIONS, SCATTERS_M_S = (0.0, 1.0, 2.0), (15.0, 30.0)
DISTANCES = (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0)
KNOWN, KNOWN_FACTOR, REQUIRED = "bayesian, scatter known", 1.2, 0.9
CLASSIC = ("up-and-down", "langlie", "neyer")
# Compared at both confidences; the others at the first.
COMPARED = ("bayesian", KNOWN, "up-and-down", "langlie")
CONFIDENCES = (CONFIDENCE, 0.9)
# How much less than its confidence an interval may hold, and least share of right decisions, per cent.
SLACK, RIGHT = 3.0, 95.0
# What the procedures start from without the model, in units of its limit: limits of V50, and the first shot.
WITHOUT, WIDE, START = ", without the model", (0.5, 1.5), 1.2
# Firings at once; nodes of V50 and scatter of the Bayesian procedure, and its velocities.
BLOCK, NODES, CANDIDATES = 500, (301, 15), 201


class Outcome(NamedTuple):
    """Shots of each firing, and whether its interval held V50; MOST shots where it did not end."""

    shots: Floats
    held: Bools


class Intervals:
    """Intervals of V50 by penalised likelihood of many firings, from grids of V50 and scale around a centre."""

    def __init__(
        self,
        count: int,
        centre: float,
        reach: float = 150.0,
        nodes: tuple[int, int] = (101, 25),
        confidence: float = CONFIDENCE,
    ) -> None:
        self.nodes, self.centre, self.root = nodes, centre, float(ndtri(0.5 + 0.5 * confidence))
        self.v50 = np.linspace(-reach, reach, nodes[0])
        scales = np.geomspace(2.0, 2000.0, nodes[1])
        self.points = np.repeat(self.v50, nodes[1]), np.tile(scales, nodes[0])
        self.log_likelihood, *self.moments = np.zeros((4, count, nodes[0] * nodes[1]))

    def add(self, velocities: Floats, complete: Bools) -> None:
        """Add a shot to each firing."""
        x = (velocities - self.centre)[:, None]
        z = (x - self.points[0]) / self.points[1]
        above, below = log_ndtr(z), log_ndtr(-z)
        self.log_likelihood += np.where(complete[:, None], above, below)
        weights = np.exp(-z * z - above - below)
        for power, moment in enumerate(self.moments):
            moment += weights * x**power

    def ends(self) -> Floats:
        """Return the ends of the interval of each firing, (n, 2); not finite where the shots do not bound it."""
        zero, one, two = self.moments
        with np.errstate(divide="ignore"):
            value = self.log_likelihood + 0.5 * np.log(np.maximum(zero * two - one * one, 0.0))
        value = np.maximum(value, -1e9).reshape(-1, *self.nodes)
        profile = _vertex(value)
        found = np.full((len(value), 2), np.nan)
        peaks = profile.argmax(axis=1)
        tops = _vertex(profile[:, None])[:, 0]
        flat = value.max(axis=1).argmax(axis=1) == self.nodes[1] - 1
        roots = np.sqrt(2.0 * np.maximum(tops[:, None] - profile, 0.0)) - self.root
        for row in np.flatnonzero(~flat & (peaks > 0) & (peaks < self.nodes[0] - 1)):
            inside = np.flatnonzero(roots[row] <= 0.0)
            first, last = inside[0], inside[-1]
            if first > 0 and last < self.nodes[0] - 1:
                sides = (first, first - 1), (last, last + 1)
                found[row] = [np.interp(0.0, roots[row, [near, far]], self.v50[[near, far]]) for near, far in sides]
        return found + self.centre

    def keep(self, which: Bools) -> None:
        """Keep some of the firings."""
        self.log_likelihood, *self.moments = (array[which] for array in (self.log_likelihood, *self.moments))


def _vertex(value: Floats) -> Floats:
    """Return the maximum along the last axis, from the parabola through the greatest value and its neighbours."""
    index = value.argmax(axis=-1)[..., None].clip(1, value.shape[-1] - 2)
    low, top, high = (np.take_along_axis(value, index + step, -1)[..., 0] for step in (-1, 0, 1))
    bend = 2.0 * top - low - high
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = np.where((bend > 0.0) & (bend < 5.0), (high - low) ** 2 / (8.0 * bend), 0.0)
    return np.where(np.maximum(low, high) > top, np.maximum(low, high), top + gain)


class Classic:
    """Firings of a procedure that knows no prior."""

    def __init__(self, procedure: str, settings: ShotSettings, truths: Floats) -> None:
        self.rule, self.settings = PROCEDURES[procedure.removesuffix(WITHOUT)], settings
        self.fired = [Shots((), ()) for _ in truths]
        self.grids = Intervals(len(truths), float(truths.mean()), confidence=settings.confidence)

    def aims(self) -> Floats:
        """Return the velocities of the next shots."""
        return np.array([self.rule.aim(shots, self.settings).velocity_m_s for shots in self.fired])

    def add(self, velocities: Floats, complete: Bools) -> None:
        """Add a shot to each firing."""
        self.fired = [
            Shots((*shots.velocities_m_s, velocity), (*shots.complete, result))
            for shots, velocity, result in zip(self.fired, velocities.tolist(), complete.tolist(), strict=True)
        ]
        self.grids.add(velocities, complete)

    def intervals(self, _confidence: float) -> Floats:
        """Return the ends of the interval of each firing, (n, 2)."""
        return self.grids.ends()

    def keep(self, which: Bools) -> None:
        """Keep some of the firings."""
        self.fired = [shots for shots, kept in zip(self.fired, which, strict=True) if kept]
        self.grids.keep(which)


def fired(
    firings: Firings | Classic, confidence: float, truths: Floats, scatters: Floats, dice: np.random.Generator
) -> Outcome:
    """Fire until the interval of each firing is short enough."""
    count = len(truths)
    shots, held, going = np.full(count, MOST), np.zeros(count, dtype=bool), np.arange(count)
    for number in range(1, MOST + 1):
        velocities = dice.normal(firings.aims(), MISS_M_S)
        firings.add(velocities, dice.normal(truths[going], scatters[going]) < velocities)
        low, high = firings.intervals(confidence).T
        over = 0.5 * (high - low) <= HALF_WIDTH_M_S
        shots[going[over]] = number
        held[going[over]] = ((low <= truths[going]) & (truths[going] <= high))[over]
        going = going[~over]
        firings.keep(~over)
        if not len(going):
            break
    return Outcome(shots, held)


def deviation_percent(prior: FiringPrior) -> float:
    """Return the standard deviation of a normal distribution like the model error, per cent."""
    low, high = prior.error.quantile(ndtr([-1.0, 1.0]))
    return 50.0 * float(high - low)


def prior_for(procedure: str, scatter: float) -> FiringPrior:
    """Return the prior of a procedure."""
    limit = ballistic_limit(load_scenario(SCENARIO))
    assert limit.model_error is not None
    prior = FiringPrior(limit.ballistic_limit_m_s, limit.model_error)
    if procedure != KNOWN:
        return prior
    return prior._replace(scatter_percent=100.0 * scatter / prior.limit_m_s, scatter_factor=KNOWN_FACTOR)


class Missed(Firings):
    """Firings whose shots miss their aim."""

    def aims(self) -> Floats:
        """Return the velocities of the next shots."""
        self.dice = getattr(self, "dice", np.random.default_rng(0))
        return self.dice.normal(super().aims(), MISS_M_S)


def requirement(
    distance: float, scatter: float, firings: int, seed: int, fraction: float = 0.5
) -> tuple[float, float, float]:
    """Simulate firings at armour a number of scatters from a requirement.

    Return the fractions that end with the requirement met and not met, and the mean number of shots, of which a firing
    that does not end has 100.
    """
    prior = prior_for("bayesian", scatter)
    settings = ShotSettings(prior, requirement_m_s=REQUIRED * prior.limit_m_s, requirement_fraction=fraction)
    v50 = REQUIRED * prior.limit_m_s + (distance - float(ndtri(fraction))) * scatter
    known, dice = posterior(Shots((), ()), settings), np.random.default_rng([seed, firings])
    many = Missed(known, settings, firings, CANDIDATES)
    shots, decided, _ = fire(many, np.full(firings, v50), np.full(firings, scatter), dice)
    return float((decided > 0).mean()), float((decided < 0).mean()), float(np.minimum(shots, MOST_SHOTS).mean())


def simulate(
    procedure: str,
    deviations: float,
    scatter: float | None,
    firings: int,
    seed: int,
    confidence: float = CONFIDENCE,
) -> Outcome:
    """Simulate firings of a procedure; without a scatter, each has one drawn from its prior."""
    prior = prior_for(procedure, scatter or 0.0)
    limit = prior.limit_m_s
    settings = ShotSettings(prior, limits_of(prior), HALF_WIDTH_M_S, confidence)
    if procedure.endswith(WITHOUT):
        shifted = prior._replace(limit_m_s=START * limit, scatter_percent=prior.scatter_percent / START)
        settings = settings._replace(prior=shifted, limits_m_s=(WIDE[0] * limit, WIDE[1] * limit))
    found = []
    for start in range(0, firings, BLOCK):
        # Above the limit in one block, below in the next: the grids of a block have one centre.
        number = start // BLOCK
        offset = (1.0 if number % 2 == 0 else -1.0) * deviations * deviation_percent(prior) / 100.0
        truths = np.full(min(BLOCK, firings - start), prior.error.median(limit) + limit * offset)
        dice = np.random.default_rng([seed, number, round(10.0 * deviations), round(scatter or 0.0)])
        scatters = np.full(len(truths), scatter or 0.0)
        if scatter is None:
            scatters = prior.scatter_percent / 100.0 * truths * prior.scatter_factor ** dice.normal(size=len(truths))
        many: Firings | Classic
        if procedure.removesuffix(WITHOUT) in CLASSIC:
            many = Classic(procedure, settings, truths)
        else:
            many = Firings(posterior_of(prior, (), (), NODES), settings, len(truths), CANDIDATES)
        found.append(fired(many, confidence, truths, scatters, dice))
    return Outcome(*(np.concatenate(column) for column in zip(*found, strict=True)))


def shares(firings: int, seed: int) -> Iterator[Share]:
    """Print mean numbers of shots; yield the shares of the firings that end whose interval contains V50."""
    for level in CONFIDENCES:
        others = ("neyer", *(name + WITHOUT for name in CLASSIC)) if level == CONFIDENCE else ()
        cases = [(scatter, name) for scatter in SCATTERS_M_S for name in (*COMPARED, *others)]
        for scatter, procedure in [*cases, (None, "bayesian")]:
            least = 100.0 * level - SLACK if scatter is None else None
            for deviations in DEVIATIONS:
                outcome = simulate(procedure, deviations, scatter, firings, seed, level)
                ended = outcome.shots < MOST
                case = f"{level:g}, scatter {scatter or 'of the prior'}, {deviations:g} deviations away, {procedure}"
                print(f"{case}: mean shots: {outcome.shots.mean():.1f}")
                yield Share(case, "V50", int(outcome.held[ended].sum()), int(ended.sum()), least)


def decisions(firings: int, seed: int) -> Iterator[Share]:
    """Yield the shares of firings whose decision on a requirement is right or open; print both kinds of decisions."""
    for scatter, fraction in ((15.0, 0.5), (30.0, 0.5), (15.0, 0.05)):
        for distance in DISTANCES:
            met, not_met, shots = requirement(distance, scatter, firings, seed, fraction)
            case = f"scatter {scatter:g}, fraction {fraction:g}, {distance:+.1f} scatters from the requirement"
            print(f"{case}: met {100.0 * met:.1f} %, not met {100.0 * not_met:.1f} %, mean shots {shots:.1f}")
            wrong = max(met if distance <= 0.0 else 0.0, not_met if distance >= 0.0 else 0.0)
            yield Share(case, "not decided wrongly", round(firings * (1.0 - wrong)), firings, RIGHT)
