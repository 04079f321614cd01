"""How many shots the Bayesian procedure needs to know V50, and how often its interval contains V50.

The armour is the paper's lightest against the 7.62 mm AP.  V50 is 0, 1 or 2 standard deviations of the error of the
model from the median that this gives, above it in one half of the firings and below it in the other; the scatter is 15
or 30 m/s, or drawn from the prior.  A shot misses the velocity that it is aimed at by 5 m/s
(standard deviation), and is measured exactly.  A firing ends when the interval of V50 of the posterior is within +- 15
m/s.  "bayesian, scatter known" is told the scatter within a factor of 1.2.

`decisions` asks whether a velocity exceeds 90 % of the model's limit, V50 or that at which 5 % of shots perforate, by
the Bayesian procedure.  The velocity is this requirement or a number of scatters away from it.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.variants import Bools, Floats
from armour.planning.firing import limits_of
from armour.planning.procedures import MOST_SHOTS, Firings, ShotSettings, fire, posterior
from armour.scenario.scenario import load_scenario
from armour.statistics.posterior import FiringPrior, posterior_of
from armour.statistics.v50 import Shots
from tools.campaigns.verdict import Share

SCENARIO, HALF_WIDTH_M_S, CONFIDENCE, MISS_M_S, MOST = "paper/optimum_7.62mm_AP", 15.0, 0.95, 5.0, 150
DEVIATIONS, SCATTERS_M_S = (0.0, 1.0, 2.0), (15.0, 30.0)
DISTANCES = (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0)
KNOWN, KNOWN_FACTOR, REQUIRED = "bayesian, scatter known", 1.2, 0.9
CONFIDENCES = (CONFIDENCE, 0.9)
# How much less than its confidence an interval may hold, and least share of right decisions, per cent.
SLACK, RIGHT = 3.0, 95.0
# Firings at once; nodes of V50 and scatter of the Bayesian procedure, and its velocities.
BLOCK, NODES, CANDIDATES = 500, (301, 15), 201


class Outcome(NamedTuple):
    """Shots of each firing, and whether its interval held V50; MOST shots where it did not end."""

    shots: Floats
    held: Bools


def fired(firings: Firings, confidence: float, truths: Floats, scatters: Floats, dice: np.random.Generator) -> Outcome:
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
        firings.weights = firings.weights[~over]
        if not len(going):
            break
    return Outcome(shots, held)


def deviation_percent(prior: FiringPrior) -> float:
    """Return the standard deviation of a normal distribution like the model error, per cent."""
    low, high = prior.error.quantile(ndtr([-1.0, 1.0]))
    return 50.0 * float(high - low)


def prior_for(procedure: str, scatter: float) -> FiringPrior:
    """Return the prior of a procedure."""
    limit = ballistic_limit(load_scenario(SCENARIO).replaced({"uncertainty.model.included": True}))
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
    shots, decided = fire(many, np.full(firings, v50), np.full(firings, scatter), dice)
    return float((decided > 0).mean()), float((decided < 0).mean()), float(np.minimum(shots, MOST_SHOTS).mean())


def simulate(
    procedure: str, deviations: float, scatter: float | None, firings: int, seed: int, confidence: float = CONFIDENCE
) -> Outcome:
    """Simulate firings of a procedure; without a scatter, each has one drawn from its prior."""
    prior = prior_for(procedure, scatter or 0.0)
    limit = prior.limit_m_s
    settings = ShotSettings(prior, limits_of(prior), HALF_WIDTH_M_S, confidence)
    found = []
    for start in range(0, firings, BLOCK):
        # Above the limit in one block, below in the next.
        number = start // BLOCK
        offset = (1.0 if number % 2 == 0 else -1.0) * deviations * deviation_percent(prior) / 100.0
        truths = np.full(min(BLOCK, firings - start), prior.error.median(limit) + limit * offset)
        dice = np.random.default_rng([seed, number, round(10.0 * deviations), round(scatter or 0.0)])
        scatters = np.full(len(truths), scatter or 0.0)
        if scatter is None:
            scatters = prior.scatter_percent / 100.0 * truths * prior.scatter_factor ** dice.normal(size=len(truths))
        many = Firings(posterior_of(prior, (), (), NODES), settings, len(truths), CANDIDATES)
        found.append(fired(many, confidence, truths, scatters, dice))
    return Outcome(*(np.concatenate(column) for column in zip(*found, strict=True)))


def shares(firings: int, seed: int) -> Iterator[Share]:
    """Print mean numbers of shots; yield the shares of the firings that end whose interval contains V50."""
    for level in CONFIDENCES:
        cases = [(scatter, name) for scatter in SCATTERS_M_S for name in ("bayesian", KNOWN)]
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
