"""How often the interval of the difference of two lots contains it, and equal lots are found to differ.

Pairs of firings of 10 to 14 shots, up and down as in `curves`, at lots whose V50s are equal or differ by two
scatters of 10 m/s; in the last case, which is stated and not judged, the second lot has twice the scatter.
"""

from collections import Counter
from collections.abc import Iterator

import numpy as np

from armour.analysis.estimates import CONFIDENCE
from armour.statistics.curves import ShotLikelihood, has_curve
from armour.statistics.lots import difference_of
from tools.experiments.curves import LEAST, SCALE, up_and_down
from tools.experiments.share import Share, holds

FEWEST, MOST = 10, 14
# Difference of the V50s, m/s, and the scatter of the second lot.
CASES = ((0.0, SCALE), (20.0, SCALE), (0.0, 2.0 * SCALE))


def fired(dice: np.random.Generator, higher_m_s: float, scale: float) -> ShotLikelihood:
    """Fire at a lot, with a higher V50 than in `curves`, until the shots have a V50."""
    while True:
        shots = up_and_down(int(dice.integers(FEWEST, MOST + 1)), dice, scale=scale)
        partial, complete = ([v + higher_m_s for v in shots.of(complete=kind)] for kind in (False, True))
        if has_curve(partial, complete):
            lot = ShotLikelihood(partial, complete, "probit", penalised=True)
            if lot.mode.slope > 0.0:
                return lot


def shares(samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of pairs whose interval contains the difference, and of those found to differ or not."""
    for difference, scale in CASES:
        dice, found = np.random.default_rng([seed, int(difference), int(scale)]), Counter[str]()
        for _ in range(samples):
            pair = difference_of(fired(dice, 0.0, SCALE), fired(dice, difference, scale), CONFIDENCE)
            found["interval"] += holds(pair.interval_m_s, difference)
            found["not found to differ"] += pair.p_value >= 1.0 - CONFIDENCE
            found["not bounded"] += None in pair.interval_m_s
        case = f"difference {difference:g} m/s, scatters {SCALE:g} and {scale:g} m/s"
        for name in ("interval", "not found to differ", "not bounded"):
            judged = scale == SCALE and (name == "interval" or (name != "not bounded" and not difference))
            yield Share(case, name, found[name], samples, LEAST if judged else None)
