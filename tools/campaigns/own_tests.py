"""Count how often the distributions that `armour calibrate` gives from own tests hold the limits of other armours.

    python -m tools.campaigns.own_tests

Armour of AD85 on 6061-T6 follows one of three laws of the flow stress, each as often, with the exponents of the library
or, in the cases of "other exponents", normal about them with a standard deviation of 0.1.  A series has an error of 5 %
in all of its limits, and each test one of the scatter.  The limits of armours of the series inside the tests, thinner
and thicker are then predicted.  Columns: the part of 95 % intervals that hold the limit; the part of limits above the
velocity that is stopped with a stated probability of 95 %; the root mean square error of the median, per cent.  Limits
are interpolated between those of a table.

Then some of the tests of each series of Wilkins' are the own ones and the others of it are predicted, with a prior of
the exponents, 0.20 with a standard deviation of 0.25, that does not rest on them.
"""

import argparse
import sys
from collections.abc import Callable
from functools import cache
from itertools import combinations
from math import log, sqrt
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from armour.analysis.variants import Floats, variants_of
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.library import FLOW_STRESS_LAW
from armour.scenario.mixture import Mixture
from armour.scenario.scenario import load_scenario
from armour.statistics.calibration import FLOW_STRESS
from armour.statistics.likelihood import MODELS
from armour.statistics.measured import LIMIT, read_tests
from armour.statistics.own_tests import EXPONENTS, TESTED, TESTED_GPA, LawPosterior, Measured, covariate, evidence_of
from armour.units import MM
from tools.campaigns import verdict

STRESSES_GPA = np.geomspace(0.8, 30.0, 60)
# Least share of intervals, and of stated 95 %, that must contain the truth, per cent.
LEAST = 95.0
# Entries of the library that have the laws.
ENTRIES = ("AD85", "AD85 backing law", "AD85 product law")
SERIES, OTHER_EXPONENTS = 0.05, 0.1
DESIGNS = {"inside": (8.0, 6.0), "thin": (4.5, 3.0), "thick": (13.0, 9.0)}
ARMOURS = ((7.0, 5.0), (9.0, 7.0), (9.0, 5.0), (7.0, 7.0), (8.0, 6.5), (7.5, 5.5))


# Ends of the interval, the velocity that is stopped with 95 %, and the median.
CHANCES = (0.025, 0.05, 0.5, 0.975)


class Case(NamedTuple):
    """Tests of armours, each a ceramic on a back plate, mm, with a scatter."""

    name: str
    armours: tuple[tuple[float, float], ...]
    scatter: float
    other_exponents: bool = False


CASES = [
    *(Case(f"{n} tests", ARMOURS[:n], scatter) for scatter in (0.02, 0.035, 0.05) for n in (1, 2, 4, 6)),
    Case("two armours twice", ARMOURS[:2] * 2, 0.025),
    Case("one back plate", ((7.0, 6.0), (8.0, 6.0), (9.0, 6.0)), 0.025),
    Case("one armour three times", ((8.0, 6.0),) * 3, 0.025),
    Case("2 tests, other exponents", ARMOURS[:2], 0.025, other_exponents=True),
    Case("6 tests, other exponents", ARMOURS, 0.025, other_exponents=True),
]


@cache
def library() -> tuple[float, list[tuple[float, float]]]:
    """Return the diameter of the penetrator, mm, and flow stress and exponent of each law."""
    scenarios = [load_scenario("wilkins").replaced({"armour.ceramic": name}) for name in ENTRIES]
    entries = [scenario.entry_of("ceramic") for scenario in scenarios]
    found = [
        (entry["flow_stress_GPa"], max(entry[key] if key in entry.values else 0.0 for key in FLOW_STRESS_LAW))
        for entry in entries
        if entry is not None
    ]
    return scenarios[0].core_armour().D0 / MM, found


@cache
def curve(armour: tuple[float, float]) -> Callable[[Floats], Floats]:
    """Return the logarithm of the limit of an armour over that of the flow stress, GPa."""
    scenario, count = load_scenario("wilkins"), len(STRESSES_GPA)
    columns = {CERAMIC: np.full(count, armour[0]), BACKING: np.full(count, armour[1]), FLOW_STRESS: STRESSES_GPA}
    return CubicSpline(np.log(STRESSES_GPA), np.log(MODELS[LIMIT](variants_of(scenario, columns, count))))


def covariates(armours: tuple[tuple[float, float], ...]) -> list[Floats | None]:
    """Return what the exponent of each law multiplies for armours, (n,)."""
    ceramic, backing = np.array(armours).T / library()[0]
    return [covariate(exponent, ceramic, backing) for exponent in EXPONENTS]


def predicted(found: list[LawPosterior], armour: tuple[float, float]) -> Mixture:
    """Return the distribution of the limit of an armour, given what tests tell of the laws."""
    parts: list[Floats] = []
    for values, evidence in zip(covariates((armour,)), found, strict=True):
        terms = np.array([1.0] if values is None else [1.0, values[0]])
        parts.append(evidence.predicted(terms, curve(armour)))
    return Mixture(*np.concatenate(parts, axis=1))


class Outcome(NamedTuple):
    """Of the limits of a design: whether intervals hold them, whether they are above, and errors of the median."""

    held: Floats
    above: Floats
    errors: Floats


def simulate(case: Case, samples: int, seed: int) -> dict[str, Outcome]:
    """Simulate tests and predictions of a case."""
    dice = np.random.default_rng([seed, len(case.armours), round(1000.0 * case.scatter)])
    of_tests = covariates(case.armours)
    curves = [curve(armour) for armour in case.armours]
    nothing = np.zeros(len(curves))
    results: dict[str, list[tuple[bool, bool, float]]] = {name: [] for name in DESIGNS}
    for _ in range(samples):
        true = int(dice.integers(len(of_tests)))
        stress, exponent = library()[1][true]
        if case.other_exponents:
            exponent += dice.normal(0.0, OTHER_EXPONENTS) if true else 0.0
        series = dice.normal(0.0, SERIES)

        def limit(armour: tuple[float, float], law: int = true, stress: float = stress, n: float = exponent) -> float:
            values = covariates((armour,))[law]
            return float(curve(armour)(np.array([log(stress) + (0.0 if values is None else n * values[0])]))[0])

        values = np.array([limit(armour) for armour in case.armours])
        values += series + case.scatter * dice.normal(size=len(values))
        found = evidence_of(Measured(values, nothing, nothing, curves), of_tests, log(TESTED_GPA), TESTED)
        for name, design in DESIGNS.items():
            truth, mixture = np.exp(limit(design) + series), predicted(found, design)
            low, stopped, middle, high = mixture.quantile(np.array(CHANCES))
            results[name].append((low <= truth <= high, truth > stopped, log(truth / middle)))
    return {name: Outcome(*np.array(rows, dtype=float).T) for name, rows in results.items()}


# Rows of Wilkins' tests that are a series each.
WILKINS = (range(4), range(4, 9), range(9, 13))


def wilkins(own: int) -> Outcome:
    """Predict the tests of each of Wilkins' series from a number of them, all combinations of it."""
    tests = read_tests("wilkins.csv", load_scenario("wilkins"))
    columns, values = tests.groups[0].columns, np.array([measurement.value for measurement in tests.measurements])
    armours = list(zip(columns[CERAMIC].tolist(), columns[BACKING].tolist(), strict=True))
    rows, nothing = [], np.zeros(own)
    for series in WILKINS:
        for some in combinations(series, own):
            tested = tuple(armours[i] for i in some)
            measured = Measured(np.log(values[list(some)]), nothing, nothing, [curve(armour) for armour in tested])
            found = evidence_of(measured, covariates(tested), log(TESTED_GPA), TESTED, (0.2, 0.25))
            for i in {*series} - {*some}:
                low, stopped, middle, high = predicted(found, armours[i]).quantile(np.array(CHANCES))
                rows.append((low <= values[i] <= high, values[i] > stopped, log(values[i] / middle)))
    return Outcome(*np.array(rows, dtype=float).T)


def main() -> int:
    """Print the shares, per cent."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print("tests | scatter, % | design | in 95 % | stated 95 % | RMS, %")
    shares: list[float] = []
    for case in CASES:
        for name, found in simulate(case, given.samples, given.seed).items():
            shares += shown(f"{case.name} | {100.0 * case.scatter:g} | {name}", found)
    for own in (1, 2, 3):
        shown(f"{own} tests of a series of Wilkins' | | the others of it", wilkins(own))
    return verdict.coverage(shares, given.samples, LEAST)


def shown(case: str, found: Outcome) -> tuple[float, float]:
    """Print a row and return its shares."""
    shares = 100.0 * float(found.held.mean()), 100.0 * float(found.above.mean())
    print(f"{case} | {shares[0]:.1f} | {shares[1]:.1f} | {100.0 * sqrt(np.mean(found.errors**2)):.1f}", flush=True)
    return shares


if __name__ == "__main__":
    sys.exit(main())
