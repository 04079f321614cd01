"""Compare planned tests with Wilkins' 13 armours: intervals of the flow stress and of the limit of a design.

For each law of the flow stress the true inputs are those of the fit to Wilkins' tests.  The sets of 13 tests are
Wilkins' armours, and those that `armour plan tests` chooses from ceramics of 4 to 12 mm and back plates of 3 to 10 mm,
in steps of 0.5 mm, at the true inputs: D-optimal and, for the limit of the paper's 7.62 mm optimum, I-optimal.  A
measured limit is normal about the model's with a standard deviation of 3 %, which the fit estimates.  Half-widths of
95 % intervals are those of the formula, and means over simulated tests with the share of intervals that hold the true
value.  In the simulation limits are interpolated between those of a table.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import sqrt

import numpy as np
from scipy.stats import t

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.results import ignore_progress
from armour.analysis.variants import Floats
from armour.planning.plan_tests import LimitModel, plan_tests
from armour.scenario.inputs import BACKING, CERAMIC, FLOW_STRESS
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics import likelihood as likelihood_fit
from armour.statistics.calibration import LAWS, Law, calibrate, with_ceramic, with_law
from armour.statistics.measured import LIMIT, MaterialGroup, read_tests
from tools.experiments.calibrations import ROOT, Table
from tools.experiments.share import Share

SCATTER, NUMBER = 0.03, 13
# Least share of intervals that must contain the truth, per cent.
LEAST = 90.0
CANDIDATES = {CERAMIC: {"min": 4.0, "max": 12.0, "step": 0.5}, BACKING: {"min": 3.0, "max": 10.0, "step": 0.5}}


@dataclass(frozen=True)
class Set:
    """Thirteen tests, and the design in question, under a law with its true inputs."""

    name: str
    law: Law
    armours: dict[str, Floats]
    true: Scenario
    design: Scenario

    def model(self) -> LimitModel:
        """Return the limits of the tests and, last, of the design."""
        names = (FLOW_STRESS, *(f"ceramic.{key}" for key in LAWS[self.law]))
        groups = (
            MaterialGroup(self.true, np.arange(NUMBER), self.armours),
            MaterialGroup(self.design, np.array([NUMBER]), {}),
        )
        units = likelihood_fit.units_of(self.true, names)
        return LimitModel(groups, (("", ""),) * (NUMBER + 1), names, units, ignore_progress)

    @property
    def x(self) -> Floats:
        """The true inputs in their units."""
        entry = self.true.entry("ceramic", "AD85")
        return np.array([1.0, *(entry[key] for key in LAWS[self.law])])

    def expected(self) -> tuple[float, float]:
        """Return half-widths of the intervals of flow stress, GPa, and limit of the design, m/s, by the formula."""
        model = self.model()
        rows = model.gradients(self.x, model.limits(self.x))[:NUMBER] / SCATTER
        return half_widths(model, np.linalg.inv(rows.T @ rows).astype(np.float64), self.x)

    def simulated(self, samples: int, seed: int) -> Iterator[tuple[float, bool, float, bool]]:
        """Yield half-widths and whether intervals hold the true value, of flow stress and limit, for each sample."""
        model, dice = self.model(), np.random.default_rng(seed)
        *limits, truth = model.limits(self.x).tolist()
        columns = {"test": range(NUMBER), **self.armours, LIMIT: limits}
        rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
        tests = read_tests(rows, self.true)
        for _ in range(samples):
            errors = 1.0 + SCATTER * dice.normal(size=NUMBER)
            measured = [m._replace(value=m.value * error) for m, error in zip(tests.measurements, errors, strict=True)]
            sample = replace(tests, measurements=tuple(measured))
            fit = likelihood_fit.fit_inputs(likelihood_fit.likelihood_of(sample, model.names, ignore_progress))
            low, high = likelihood_fit.intervals(fit)[0].interval or (None, None)
            if low is None or high is None:
                continue  # counted as no sample; the caller prints how many there are
            half = half_widths(model, fit.covariance, fit.best.x)[1]
            holds = low <= model.units[0] <= high
            yield 0.5 * (high - low), holds, half, abs(model.limits(fit.best.x)[-1] - truth) <= half


def half_widths(model: LimitModel, covariance: Floats, x: Floats) -> tuple[float, float]:
    """Return the half-widths that a covariance gives, of flow stress, GPa, and limit of the design, m/s."""
    factor = float(t.ppf(0.5 * (1.0 + CONFIDENCE), NUMBER - len(x)))
    limits = model.limits(x)
    slope = model.gradients(x, limits)[-1] * limits[-1]
    return factor * sqrt(covariance[0, 0]) * float(model.units[0]), factor * sqrt(slope @ covariance @ slope)


def sets_of(law: Law) -> Iterator[Set]:
    """Yield Wilkins' armours and the planned ones."""
    plain = load_scenario(ROOT / "scenarios/wilkins.toml")
    read = read_tests(ROOT / "scenarios/tests/wilkins.csv", plain)
    fitted = calibrate(read, plain, law=law)
    values = {c.name.split(".")[1]: c.estimate for c in fitted.coefficients if c.estimate is not None}
    true = with_ceramic(with_law(plain, law), values)
    optimum = load_scenario(ROOT / "scenarios/paper/optimum_7.62mm_AP.toml")
    design = with_ceramic(with_law(optimum, law), values)
    group = read.groups[0]
    yield Set("Wilkins", law, {name: group.columns[name] for name in (CERAMIC, BACKING)}, true, design)
    for criterion in ("D", "I"):
        planned = partial(plan_tests, true, CANDIDATES, law=law, number=NUMBER, designs=[design])
        plan = planned(criterion=criterion, scatter_percent=100.0 * SCATTER)
        inputs = [step.inputs for step in plan.planned[1:]]
        armours = {name: np.array([step[name] for step in inputs], dtype=float) for name in (CERAMIC, BACKING)}
        yield Set(f"{criterion}-optimal", law, armours, true, design)


def shares(samples: int, seed: int) -> Iterator[Share]:
    """Print half-widths; yield the shares of intervals that contain the true value."""
    exact, table = likelihood_fit.MODELS[LIMIT], Table(likelihood_fit.MODELS[LIMIT])
    for law in LAWS:
        for tests in sets_of(law):
            expected = tests.expected()
            likelihood_fit.MODELS[LIMIT] = table
            simulated = np.array([*tests.simulated(samples, seed)], dtype=float)
            likelihood_fit.MODELS[LIMIT] = exact
            stress, stress_held, limit, limit_held = simulated.mean(axis=0)
            case = f"{law}, {tests.name}"
            print(
                f"{case}: half-widths by the formula, and their means: "
                f"flow stress {expected[0]:.3f} and {stress:.3f} GPa, limit {expected[1]:.2f} and {limit:.2f} m/s"
            )
            if tests.name != "Wilkins":
                pairs, counts = np.unique(np.column_stack([*tests.armours.values()]), axis=0, return_counts=True)
                print("   ", "; ".join(f"{n} x {c:g}/{b:g}" for (c, b), n in zip(pairs, counts, strict=True)))
            for name, held in (("flow stress", stress_held), ("limit", limit_held)):
                yield Share(case, name, round(held * len(simulated)), len(simulated), LEAST)
