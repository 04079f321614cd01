"""How often the intervals of `armour v50` contain the true values, in simulated firings of a normal curve.

`shares`: V50 is 720 m/s and the scale 10 m/s.  The velocities are those of an up-and-down rule, with steps of 15 m/s
from a start that misses V50 by 15 m/s and velocities that miss their aim by 5 m/s (standard deviations), or with a
quarter of all three, as at an armour of much scatter, or of five levels from two scales below V50 to two scales above
it.  Samples for which the program gives no V50 are counted apart.

`wide_shares`: scales of 15, 30 and 60 m/s, steps of 15 m/s and velocities that miss their aim by 10 m/s; in one half of
the cases the last shot is far below, at 8 scales or at 300 m/s.  Also V01, and the probability one scale above V50.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import product

import numpy as np
from scipy.special import ndtr, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.errors import NoAnswerError
from armour.statistics.curves import Z95, FittedCurve, ShotLikelihood, fit_curve, has_curve
from armour.statistics.v50 import Shots
from tools.experiments.share import Share, holds

V50, SCALE = 720.0, 10.0
TRUE = {"V50": V50, "scale": SCALE, "V05": V50 - Z95["probit"] * SCALE, "V95": V50 + Z95["probit"] * SCALE}
START, STEP, MISS = 15.0, 15.0, 5.0
LEVELS = (700.0, 710.0, 720.0, 730.0, 740.0)
V01 = float(ndtri(0.01))
# A scale that far exceeds the steps: its shares are stated and not judged.
WIDEST = 60.0
# Least share of intervals that must contain the truth, per cent.
LEAST = 92.0


def up_and_down(
    shots: int, dice: np.random.Generator, part: float = 1.0, scale: float = SCALE, miss: float = MISS
) -> Shots:
    """Fire shots one after the other, slower after a complete and faster after a partial penetration."""
    aim, velocities, complete = dice.normal(V50, part * START), [], []
    for _ in range(shots):
        velocities.append(float(dice.normal(aim, part * miss)))
        complete.append(bool(dice.normal(V50, scale) < velocities[-1]))
        aim += part * (-STEP if complete[-1] else STEP)
    return Shots(tuple(velocities), tuple(complete))


def fixed_levels(shots: int, dice: np.random.Generator) -> Shots:
    """Fire shots at five velocities."""
    velocities = tuple(np.resize(LEVELS, shots).tolist())
    return Shots(velocities, tuple((dice.normal(V50, SCALE, shots) < velocities).tolist()))


SMALL_STEPS = "up and down, small steps"
RULES: dict[str, Callable[[int, np.random.Generator], Shots]] = {
    "up and down": up_and_down,
    SMALL_STEPS: lambda shots, dice: up_and_down(shots, dice, 0.25),
    "levels": fixed_levels,
}


def held(fit: FittedCurve) -> list[str]:
    """Return the names of the intervals, and of the one-sided bounds, that hold the true value."""
    intervals = {name: getattr(fit, f"{name.lower()}_interval_m_s") for name in TRUE}
    found = [name for name, interval in intervals.items() if interval and holds(interval, TRUE[name])]
    if fit.method == "penalised likelihood":
        bounds = {"V50": fit.v50_lower_m_s, "V05": fit.v05_lower_m_s}
        found += [f"lower bound of {name}" for name, low in bounds.items() if holds((low, None), TRUE[name])]
    return found


def simulate(rule: str, shots: int, samples: int, seed: int) -> Counter[str]:
    """Count how often each interval of each method holds the true value, and the samples that have no V50."""
    dice, found = np.random.default_rng([seed, shots]), Counter({"no V50": 0})
    fitted = 0
    while fitted < samples:
        fired = RULES[rule](shots, dice)
        partial, complete = fired.of(complete=False), fired.of(complete=True)
        penalised = None
        if partial and complete:
            with suppress(NoAnswerError):
                penalised = fit_curve(partial, complete, "probit", penalised=True)
        if penalised is None:
            found["no V50"] += 1
            continue
        fitted += 1
        found["separated"] += partial[-1] < complete[0]
        found["V50 not bounded"] += None in penalised.v50_interval_m_s
        for fit in (penalised, fit_curve(partial, complete, "probit")):
            assert fit is not None
            found.update(f"{fit.method}: {name}" for name in held(fit))
    return found


def wide_shares(samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of intervals and lower bounds of the recommended curve that contain the truth."""
    for scale, shots, far in product((15.0, 30.0, WIDEST), (8, 12, 20), (False, True)):
        dice, found, fitted = np.random.default_rng([seed, shots, int(scale)]), Counter[str](), 0
        while fitted < samples:
            fired = up_and_down(shots - far, dice, scale=scale, miss=10.0)
            slow = max(V50 - 8.0 * scale, 300.0)
            partial, complete = [*fired.of(complete=False), *[slow] * far], fired.of(complete=True)
            if not has_curve(partial, complete):
                continue
            curve = ShotLikelihood(partial, complete, "probit", penalised=True)
            if curve.mode.slope <= 0.0:
                continue
            fitted += 1
            for name, z in {"V50": 0.0, "V05": -Z95["probit"], "V95": Z95["probit"], "V01": V01}.items():
                found[name] += holds(curve.velocity_interval(z, CONFIDENCE), V50 + z * scale)
                if z <= 0.0:
                    found[f"lower bound of {name}"] += holds((curve.lower_bound(z, CONFIDENCE), None), V50 + z * scale)
            found["V50 not bounded"] += None in curve.velocity_interval(0.0, CONFIDENCE)
            found["probability"] += holds(curve.probability_interval(V50 + scale, CONFIDENCE), float(ndtr(1.0)))
        for name, count in sorted(found.items()):
            case = f"scale {scale:g}, {shots} shots{', the last far below' if far else ''}"
            judged = scale < WIDEST and not name.startswith("lower") and name != "V50 not bounded"
            yield Share(case, name, count, samples, LEAST if judged else None)


def shares(samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of intervals that contain the true value, by rule, number of shots and method."""
    for rule in RULES:
        for shots in (10, 20, 60):
            counts = simulate(rule, shots, samples, seed)
            for name, count in sorted(counts.items()):
                judged = name.removeprefix("penalised likelihood: ") in TRUE and rule != SMALL_STEPS
                yield Share(f"{rule}, {shots} shots", name, count, samples, LEAST if judged else None)
