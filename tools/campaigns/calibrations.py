"""How often the 95 % intervals of `armour calibrate` contain the true values, in simulated tests.

The tests are Wilkins' armours with a known flow stress of the ceramic.
Ballistic limits are normal about the model's, with a standard deviation of 15 m/s where it is given to the fit, and of
2 % where it is not.  Limits are interpolated between those of a table, to 0.01 m/s.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from armour.analysis.results import ignore_progress
from armour.analysis.variants import Floats, Variants, variants_of
from armour.core.equations import intact_strength
from armour.engine.batch import fields
from armour.scenario.inputs import BACKING, CERAMIC, FLOW_STRESS
from armour.scenario.scenario import load_scenario
from armour.statistics import likelihood as likelihood_fit
from armour.statistics.calibration import LAWS, Law, with_ceramic, with_law
from armour.statistics.measured import LIMIT, Measurement, Tests, read_tests
from armour.units import GPA
from tools.campaigns.verdict import Share, holds

ROOT = Path(__file__).resolve().parents[2]
TRUE_GPA, TRUE_EXPONENT = 5.2, 0.3
GIVEN_M_S, RELATIVE = 15.0, 0.02
# Least share of intervals that must contain the truth, per cent.
LEAST = 93.0
# Wilkins' armours of which limits are measured, in the cases with few.
SIX = (0, 3, 4, 8, 9, 12)
# Flow stresses of the table, GPa.
TABLE_GPA = np.geomspace(0.2, 60.0, 200)


@dataclass(frozen=True)
class Case:
    """Simulated tests: limits of some armours, and outcomes of others, shots that many scatters away from the limit."""

    name: str
    limits: tuple[int, ...]
    outcomes: tuple[int, ...] = ()
    away: tuple[float, ...] = ()
    given: bool = True  # whether the fit is given the uncertainty
    law: Law = "constant"


SPREAD = tuple(np.linspace(-1.5, 1.5, 10).tolist())
CASES = [
    Case("six limits, uncertainty given", SIX),
    Case("six limits", SIX, given=False),
    Case("two limits, 20 outcomes at the limit + 1 sd, uncertainty given", SIX[:2], (5,) * 20, (1.0,) * 20),
    Case("six limits, 10 outcomes around them, uncertainty given", SIX, (1, 2, 5, 6, 7, 10, 11, 0, 3, 4), SPREAD),
    Case("six limits, 10 outcomes around them", SIX, (1, 2, 5, 6, 7, 10, 11, 0, 3, 4), SPREAD, given=False),
    Case("13 limits, law backing", tuple(range(13)), given=False, law="backing"),
    Case("13 limits, law backing, uncertainty given", tuple(range(13)), law="backing"),
]


class Table:
    """Ballistic limits of armours by the flow stress of the intact ceramic, in place of the model's."""

    def __init__(self, model: Callable[[Variants], Floats]) -> None:
        self.model = model
        self.splines: dict[tuple[float, float], CubicSpline] = {}

    def __call__(self, variants: Variants) -> Floats:
        """Return the limits of variants, m/s."""
        p = fields(variants.parameters)
        law = (p.n_B, p.n_cB, p.a_c, p.a_B)
        strengths = np.array([intact_strength(*row) for row in zip(p.Yc0, p.D0, p.Hc0, p.Hb, *law, strict=True)])
        found = np.empty(len(strengths))
        for armour in {*zip(p.Hc0.tolist(), p.Hb.tolist(), strict=True)}:
            rows = np.flatnonzero((p.Hc0 == armour[0]) & (p.Hb == armour[1]))
            if armour not in self.splines:
                self.splines[armour] = self.spline(variants.at(rows[:1]))
            found[rows] = self.splines[armour](np.log(strengths[rows]))
        return found

    def spline(self, variant: Variants) -> CubicSpline:
        """Return the limits of an armour by the logarithm of the flow stress."""
        rows = variant.at(np.zeros(len(TABLE_GPA), dtype=int))
        p = fields(rows.parameters)
        p.Yc0[:] = TABLE_GPA * GPA
        for coefficient in (p.n_B, p.n_cB, p.a_c, p.a_B):
            coefficient[:] = 0.0
        return CubicSpline(np.log(TABLE_GPA * GPA), self.model(rows))


class Simulation:
    """Simulated tests of a case, and fits to them."""

    def __init__(self, case: Case) -> None:
        self.case = case
        tested = np.loadtxt(ROOT / "scenarios/tests/wilkins.csv", delimiter=",", skiprows=1)
        armours = tested[[*case.limits, *case.outcomes]]
        self.scenario = with_law(load_scenario("wilkins"), case.law)
        self.columns = {CERAMIC: armours[:, 0], BACKING: armours[:, 1]}
        names = "test", CERAMIC, BACKING, LIMIT
        rows = [dict(zip(names, (place, *row), strict=True)) for place, row in enumerate(armours.tolist())]
        self.tests = replace(read_tests(rows, self.scenario), weighted=case.given)
        self.truth = {FLOW_STRESS: TRUE_GPA} | {f"ceramic.{key}": TRUE_EXPONENT for key in LAWS[case.law]}

    def drawn(self, dice: np.random.Generator) -> Tests:
        """Return simulated tests."""
        case, first = self.case, len(self.case.limits)
        true = with_ceramic(self.scenario, {name.split(".")[1]: value for name, value in self.truth.items()})
        limits = likelihood_fit.MODELS[LIMIT](variants_of(true, self.columns, len(self.tests.names)))
        deviations = np.full(len(limits), GIVEN_M_S) if case.given else RELATIVE * limits
        found = limits + deviations * dice.normal(size=len(limits))
        given = GIVEN_M_S if case.given else None
        measurements = [Measurement(i, LIMIT, float(found[i]), given, 0) for i in range(first)]
        for i, away in enumerate(case.away, start=first):
            shot = float(limits[i] + away * deviations[i])
            measurements.append(Measurement(i, LIMIT, shot, given, 1 if found[i] > shot else -1))
        return replace(self.tests, measurements=tuple(measurements))

    def held(self, dice: np.random.Generator) -> Iterable[str]:
        """Return the inputs whose intervals hold the true value."""
        likelihood = likelihood_fit.likelihood_of(self.drawn(dice), [*self.truth], ignore_progress)
        fit = likelihood_fit.fit_inputs(likelihood)
        for found in fit.coefficients():
            if holds(found.interval or (None, None), self.truth[found.name]):
                yield found.name


def shares(samples: int, seed: int) -> Iterator[Share]:
    """Yield the shares of intervals that contain the true value, by case and coefficient."""
    exact = likelihood_fit.MODELS[LIMIT]
    likelihood_fit.MODELS[LIMIT] = Table(exact)
    for case in CASES:
        simulation, dice = Simulation(case), np.random.default_rng(seed)
        counts = Counter(name for _ in range(samples) for name in simulation.held(dice))
        for name, count in sorted(counts.items()):
            yield Share(case.name, name, count, samples, LEAST)
    likelihood_fit.MODELS[LIMIT] = exact
