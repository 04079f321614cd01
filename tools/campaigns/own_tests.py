"""Predict real and simulated armours from own tests of their lots, and fill docs/evidence/own-tests.md.

    python -m tools.campaigns own_tests

Of bare plates, an alloy is left out of the fit, and a few of its tests against a round are the own ones of a lot; the
others of the lot are predicted.  Of AD85, a series of Wilkins' tests is left out, some of its tests are the own ones,
and the others of it are predicted.  Simulated lots of armour with a ceramic follow one of three laws of the flow
stress, each as often.
"""

from collections.abc import Iterator
from functools import cache
from itertools import combinations
from math import comb
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.variants import Floats, ballistic_limits, variants_of
from armour.evidence.fit import Fit, LotTests, distances, fits, mixture_of
from armour.evidence.tests import STRANGE, STRANGE_METAL
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import load_scenario
from armour.statistics.own_tests import SHOT_SCATTER
from tools.campaigns.evidence import NAMES, Outcome, joined, numbers, ranges_of, updated, wilkins
from tools.campaigns.verdict import verdict
from tools.evidence import GROUPS, LAWS, ROOT, Plates, fitted, plates_of
from tools.tables import table, write_tables

PAGE = ROOT / "docs" / "evidence" / "own-tests.md"
PLATES = ("cores_steel", "cores_aluminium_tensile", "cores_aluminium", "fragments_aluminium")
DRAWS, SAMPLES = 100, 200
# Own tests of a simulated lot.
OWN = 2
# The seed of draws; the constants of the update were chosen with others.
SEED = 2
# Armours that are predicted, by their greatest distance from an own test.
KINDS = {"all": np.inf, "near": 0.1}
# Least share of "95 true", also of fragments near own tests, and of simulated lots, of both, per cent.
LEAST_TRUE, LEAST_NEAR, LEAST_SIMULATED = 95.0, 94.0, 92.0


def lots_of(group_name: str, own: int, draws: int = DRAWS) -> Iterator[dict[str, Floats]]:
    """Predict each lot, its alloy left out of the fit, from random draws of own tests: mean shares, by kind of armour.

    A lot is the tests of an alloy against a round; of one without predictions there is nothing.
    """
    for alloy, lot in _lots(group_name):
        (fit, ranges), dice, count = _left_out(group_name, alloy), np.random.default_rng([SEED, own]), len(lot.error)
        apart = distances(lot.quantities, lot.quantities)
        found: dict[str, list[Outcome]] = {kind: [] for kind in KINDS}
        for some in choices(count, own, draws, dice):
            rest = np.setdiff1d(np.arange(count), some)
            nearest = apart[np.ix_(rest, some)].min(axis=1, initial=np.inf if own else 0)
            by_own = updated(fit, lot.at(some)) if own else fit
            for kind, farthest in KINDS.items():
                if len(of_kind := rest[nearest <= farthest]):
                    mixture = mixture_of([by_own], lot.at(of_kind).quantities, ranges)
                    found[kind].append(Outcome.of(lot.error[of_kind], mixture))
        yield {kind: np.mean([one.means() for one in parts], axis=0) for kind, parts in found.items() if parts}


def choices(count: int, own: int, draws: int, dice: np.random.Generator) -> Iterator[Any]:
    """Yield choices of own tests of a lot: all that there are, or else some that are drawn."""
    if comb(count, own) <= draws:
        yield from (np.array(some, dtype=np.int64) for some in combinations(range(count), own))
    else:
        yield from (dice.choice(count, own, replace=False) for _ in range(draws))


def _lots(group_name: str) -> Iterator[tuple[str, Plates]]:
    """Yield alloy and tests of each lot."""
    group = GROUPS[group_name]
    plates = plates_of(group.kind, group.metal)
    for alloy, fired in sorted(set(zip(plates.alloy.tolist(), plates.round.tolist(), strict=True))):
        yield alloy, plates.at((plates.alloy == alloy) & (plates.round == fired))


@cache
def _left_out(group_name: str, alloy: str) -> tuple[Fit, dict[str, tuple[float, float]]]:
    """Return the fit without an alloy, and the ranges of its tests."""
    group = GROUPS[group_name]
    plates = plates_of(group.kind, group.metal)
    rest = plates.at(plates.alloy != alloy)
    return fitted(group, rest), ranges_of(rest)


# Armours of simulated own tests, and of what is predicted, mm.
ARMOURS = ((7.0, 5.0), (9.0, 7.0), (9.0, 5.0), (7.0, 7.0), (8.0, 6.5), (7.5, 5.5))
DESIGNS = {"inside": (8.0, 6.0), "thin": (4.5, 3.0), "thick": (13.0, 9.0)}
EXPONENTS = {"constant": (0.0, 0.0), "backing": (1.0, 0.0), "product": (1.0, 1.0)}


@cache
def limits() -> tuple[dict[str, Floats], Any]:
    """Return logarithms of limits of all armours by each law, and their quantities."""
    armours = np.array([*ARMOURS, *DESIGNS.values()])
    found, q = {}, None
    for name, law in LAWS.items():
        scenario = load_scenario("wilkins", {"armour.ceramic": law.ceramic})
        rows = variants_of(scenario, {CERAMIC: armours[:, 0], BACKING: armours[:, 1]}, len(armours))
        found[name], q = np.log(ballistic_limits(rows)), rows.armours.quantities()
    return found, q


class Case(NamedTuple):
    """A kind of simulated lots: standard deviations of effects, and what is done with the tests."""

    name: str
    lot: float = 0.05
    exponents: float = 0.0  # standard deviation of the exponents about the library's, times the slope of the limit
    more: float = STRANGE
    mixed: bool = False  # own tests are of two lots, and armours of one are predicted
    shots: str = ""  # "outcomes" near the computed limit, or "stopped" ones only


CASES = (
    Case("a lot like the others"),
    Case("a strange lot", lot=0.10),
    Case("another metal", lot=0.15, more=STRANGE_METAL),
    Case("two lots, mixed", mixed=True),
    Case("other exponents", exponents=0.062),
    Case("outcomes", shots="outcomes"),
    Case("stopped shots only", shots="stopped"),
)
SCATTERS = (0.02, 0.035, 0.05)


def simulated(case: Case, scatter: float, dice: Any, samples: int = SAMPLES) -> dict[str, Outcome]:
    """Simulate lots, own tests and predictions."""
    (by_law, q), count, own = limits(), len(ARMOURS), OWN
    parts: dict[str, list[Outcome]] = {name: [] for name in DESIGNS}
    ratios = np.log(np.stack([q["backing_thickness_ratio"], q["ceramic_thickness_ratio"]]))
    for _ in range(samples):
        name = list(LAWS)[int(dice.integers(len(LAWS)))]
        effect, other = dice.normal(0.0, case.lot, 2)
        true = by_law[name] + dice.normal(0.0, case.exponents) * (np.array(EXPONENTS[name]) @ ratios)
        some = dice.choice(count, own, replace=False)
        tested = true[some] + scatter * dice.normal(size=own)
        tested += np.where(case.mixed & (np.arange(own) < own // 2), other, effect)
        sides = uncertainties = np.zeros(own)
        if case.shots:
            limit, away = tested + SHOT_SCATTER * dice.normal(size=own), 0.08 * dice.normal(size=own)
            tested = by_law["constant"][some] + (-abs(away) if case.shots == "stopped" else away)
            sides, uncertainties = np.where(limit > tested, 1.0, -1.0), np.full(own, SHOT_SCATTER)
            if case.shots == "stopped" and (sides < 0.0).any():
                continue
        of_tests, by_own = {key: values[some] for key, values in q.items()}, []
        for law in LAWS:
            tests = LotTests(of_tests, tested - by_law[law][some], sides, uncertainties, np.arange(own))
            by_own.append(fits()[law].of_lot(case.more).given(tests))
        for place, design in enumerate(DESIGNS, start=count):
            of_design, first = {key: values[[place]] for key, values in q.items()}, by_law["constant"][[place]]
            found = mixture_of(by_own, of_design).times(np.exp([by_law[law][[place]] - first for law in LAWS]))
            parts[design].append(Outcome.of(true[[place]] + effect - first, found))
    return {design: joined(found) for design, found in parts.items()}


def main() -> int:
    """Write the tables of the page."""
    of_plates, wrong = [], list[str]()
    for name in PLATES:
        for own in (0, 1, 3):
            lots = list(lots_of(name, own))
            for kind in KINDS if own else ("all",):
                known = [lot[kind] for lot in lots if kind in lot]
                means = np.mean(known, axis=0)
                off = f"{100.0 * means[-1]:.0f}"
                of_plates.append([NAMES[name], f"{own}", kind, f"{len(known)}", *numbers(means), off])
                required = LEAST_NEAR if kind == "near" and name == "fragments_aluminium" else LEAST_TRUE
                wrong += [f"95 true: {name} {own} {kind}"] * bool(own and 100.0 * means[2] < required)
    simulations = {}
    for case in CASES:
        dice = [np.random.default_rng([OWN, number]) for number in range(len(SCATTERS))]
        parts = [simulated(case, *each) for each in zip(SCATTERS, dice, strict=True)]
        simulations[case.name] = {design: joined([part[design] for part in parts]) for design in DESIGNS}
    of_lots = {(name, design): found[design].means() for name, found in simulations.items() for design in DESIGNS}
    least = min(100.0 * share for means in of_lots.values() for share in means[1:3])
    head = "RMS", "within 95", "95 true", "half-width"
    write_tables(
        PAGE,
        table(("tests of", "own tests", "armours", "lots", *head, "off"), of_plates),
        table(("own tests", *head), [[f"{own}", *numbers(wilkins(own).means())] for own in (0, 1, 2, 3)]),
        table(("lots", "armour", *head), [[*names, *numbers(means)] for names, means in of_lots.items()]),
    )
    wrong += [f"simulated lots: {least:.1f} %"] * bool(least < LEAST_SIMULATED)
    text = f"of simulated lots at least {least:.1f} % are right; not as demanded: {'; '.join(wrong) or 'nothing'}"
    return verdict(text, right=not wrong)
