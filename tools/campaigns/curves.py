"""How often the intervals of `armour v50` contain the true values, in simulated firings of a normal curve.

`CURVES`: V50 is 720 m/s and the scale 10 m/s.  The velocities are those of an up-and-down rule, with steps of 15 m/s
from a start that misses V50 by 15 m/s and velocities that miss their aim by 5 m/s (standard deviations), or with a
quarter of all three, as at an armour of much scatter, or of five levels from two scales below V50 to two scales above
it.  Samples for which the program gives no V50 are counted apart.

`WIDE`: scales of 15, 30 and 60 m/s, and velocities that miss their aim by 10 m/s; in one half of the cases the last
shot is far below, at 8 scales or at 300 m/s.

`lots`: pairs of firings of 10 to 14 shots, up and down, at lots whose V50s are equal or differ by two scales of 10 m/s;
in the last case, which is stated and not judged, the second lot has twice the scale.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from armour.analysis.estimates import CONFIDENCE
from armour.statistics.curves import Z95, FittedCurve, Interval, ShotLikelihood, curve_of, fit_curve, has_curve
from armour.statistics.lots import difference_of
from armour.statistics.v50 import Shots
from tools.campaigns.verdict import Share, holds

V50, SCALE = 720.0, 10.0
START, STEP, MISS = 15.0, 15.0, 5.0
LEVELS = (700.0, 710.0, 720.0, 730.0, 740.0)
# Arguments of the curve at the velocities whose intervals are counted.
POINTS = {"V50": 0.0, "V05": -Z95["probit"], "V95": Z95["probit"], "V01": float(ndtri(0.01))}
# Least share of intervals that must contain the truth, per cent.
LEAST = 92.0


class Case(NamedTuple):
    """Firings of a number of shots at an armour, by a rule."""

    name: str
    shots: int
    seeds: tuple[int, ...]
    scale: float = SCALE
    part: float | None = 1.0  # of start, step and miss; None for levels
    miss: float = MISS
    far: bool = False  # whether the last shot is far below
    judged: tuple[str, ...] = ()  # intervals that must hold the truth often enough

    def fired(self, dice: np.random.Generator) -> Shots:
        """Fire the shots but the far one."""
        if self.part is None:
            velocities = np.resize(LEVELS, self.shots)
            return Shots(
                tuple(velocities.tolist()), tuple((dice.normal(V50, self.scale, self.shots) < velocities).tolist())
            )
        return up_and_down(self.shots - self.far, dice, self.part, self.scale, self.miss)


CURVES = [
    Case(
        f"{rule}, {shots} shots",
        shots,
        (shots,),
        part=part,
        judged=("V50", "scale", "V05", "V95") if part != 0.25 else (),
    )
    for rule, part in (("up and down", 1.0), ("up and down, small steps", 0.25), ("levels", None))
    for shots in (10, 20, 60)
]
# The widest scale far exceeds the steps: its shares are stated and not judged.
WIDE = [
    Case(
        f"scale {scale}, {shots} shots{', the last far below' if far else ''}", shots, (shots, scale), scale,
        miss=10.0, far=far, judged=(*POINTS, "probability") if scale < 60 else (),
    )
    for scale, shots, far in product((15, 30, 60), (8, 12, 20), (False, True))
]  # fmt: skip


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


def penalised(partial: Sequence[float], complete: Sequence[float]) -> tuple[ShotLikelihood, FittedCurve] | None:
    """Return the penalised likelihood of shots and its curve; None if they have no V50."""
    if not has_curve(partial, complete):
        return None
    shots = ShotLikelihood(partial, complete, "probit", penalised=True)
    fit = curve_of(shots, CONFIDENCE)
    return (shots, fit) if fit else None


def held(shots: ShotLikelihood, fit: FittedCurve, scale: float) -> list[str]:
    """Return the names of the intervals, and of the one-sided bounds, that hold the true value."""
    intervals: dict[str, tuple[Interval, float]] = {
        "scale": (fit.scale_interval_m_s, scale),
        "probability": (shots.probability_interval(V50 + scale, CONFIDENCE), float(ndtr(1.0))),
    }
    for name, z in POINTS.items():
        intervals[name] = shots.velocity_interval(z, CONFIDENCE), V50 + z * scale
        if z <= 0.0:
            intervals[f"lower bound of {name}"] = (shots.lower_bound(z, CONFIDENCE), None), V50 + z * scale
    found = [name for name, (interval, true) in intervals.items() if holds(interval, true)]
    return [*found, *["V50 not bounded"] * (None in fit.v50_interval_m_s)]


def shares(cases: Sequence[Case], samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of intervals that contain the true value, by case and method, and samples that have no V50."""
    for case in cases:
        dice, found, fitted = np.random.default_rng([seed, *case.seeds]), Counter({"no V50": 0}), 0
        while fitted < samples:
            fired = case.fired(dice)
            slow = max(V50 - 8.0 * case.scale, 300.0)
            partial, complete = [*fired.of(complete=False), *[slow] * case.far], fired.of(complete=True)
            if (curve := penalised(partial, complete)) is None:
                found["no V50"] += 1
                continue
            fitted += 1
            found.update(held(*curve, case.scale))
            likeliest = fit_curve(partial, complete, "probit")
            assert likeliest is not None
            found["maximum likelihood: V50"] += holds(likeliest.v50_interval_m_s, V50)
            found["maximum likelihood: scale"] += holds(likeliest.scale_interval_m_s, case.scale)
        for name, count in sorted(found.items()):
            yield Share(case.name, name, count, samples, LEAST if name in case.judged else None)


# Difference of the V50s of two lots, m/s, and the scale of the second.
LOTS = ((0.0, SCALE), (20.0, SCALE), (0.0, 2.0 * SCALE))


def lots(samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of pairs whose interval contains the difference, and of those found to differ or not."""
    for difference, scale in LOTS:
        dice, found = np.random.default_rng([seed, int(difference), int(scale)]), Counter[str]()
        for _ in range(samples):
            pair = difference_of(_lot(dice, 0.0, SCALE), _lot(dice, difference, scale), CONFIDENCE)
            found["interval"] += holds(pair.interval_m_s, difference)
            found["not found to differ"] += pair.p_value >= 1.0 - CONFIDENCE
            found["not bounded"] += None in pair.interval_m_s
        for name, count in found.items():
            judged = scale == SCALE and (name == "interval" or (name != "not bounded" and not difference))
            case = f"difference {difference:g} m/s, scales {SCALE:g} and {scale:g} m/s"
            yield Share(case, name, count, samples, LEAST if judged else None)


def _lot(dice: np.random.Generator, higher_m_s: float, scale: float) -> ShotLikelihood:
    """Fire 10 to 14 shots at a lot with a higher V50, again and again until they have a V50."""
    while True:
        shots = up_and_down(int(dice.integers(10, 15)), dice, scale=scale)
        partial, complete = ([v + higher_m_s for v in shots.of(complete=kind)] for kind in (False, True))
        if curve := penalised(partial, complete):
            return curve[0]
