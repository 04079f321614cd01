"""Compare planned tests with Wilkins' 13 armours: intervals of the flow stress and of the limit of a design.

For each law of the flow stress the true inputs are those of the fit to Wilkins' tests.  The sets of 13 tests are
Wilkins' armours, and those that `armour plan tests` chooses from ceramics of 4 to 12 mm and back plates of 3 to 10 mm,
in steps of 0.5 mm, at the true inputs: D-optimal and, for the limit of the paper's 7.62 mm optimum, I-optimal.  A
measured limit is normal about the model's with a standard deviation of 3 %, which the fit estimates.  Half-widths of
95 % intervals are those of the formula, and means over simulated tests with the share of intervals that hold the true
value.  In the simulation limits are interpolated between those of a table.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.stats import t

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.results import ignore_progress
from armour.analysis.variants import Floats
from armour.planning.plan_tests import plan_tests
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics import likelihood as likelihood_fit
from armour.statistics.calibration import FLOW_STRESS, LAWS, Law, calibrate, with_ceramic, with_law
from armour.statistics.measured import LIMIT, MaterialGroup, Measurement, Tests, read_tests
from tools.experiments.calibrations import ROOT, Table
from tools.experiments.share import Share

SCATTER, NUMBER = 0.03, 13
# Least share of intervals that must contain the truth, per cent.
LEAST = 90.0
CANDIDATES = {
    CERAMIC: {"min": 4.0, "max": 12.0, "step": 0.5},
    BACKING: {"min": 3.0, "max": 10.0, "step": 0.5},
}


@dataclass(frozen=True)
class Set:
    """Thirteen tests, and the design in question, under a law with its true inputs."""

    name: str
    law: Law
    armours: dict[str, Floats]
    true: Scenario
    design: Scenario

    def likelihood(self, measured: Floats | None = None, *, of_design: bool = False) -> likelihood_fit.Likelihood:
        """Return the likelihood of measured limits, by default the model's own, of the tests or of the design."""
        scenario, columns = (self.design, {}) if of_design else (self.true, self.armours)
        count = 1 if of_design else NUMBER
        group = MaterialGroup(scenario, np.arange(count), columns)
        values = np.ones(count) if measured is None else measured
        made = tuple(Measurement(i, LIMIT, float(value), None, 0) for i, value in enumerate(values))
        tests = Tests(
            self.name, tuple(map(str, range(count))), (group,), made, False, ({},) * count, scenario, ("",) * count
        )
        names = (FLOW_STRESS, *(f"ceramic.{key}" for key in LAWS[self.law]))
        found = likelihood_fit.likelihood_of(tests, names, ignore_progress)
        if measured is not None:
            return found
        return self.likelihood(found.predicted(self.x), of_design=of_design) if not of_design else found

    @property
    def x(self) -> Floats:
        """The true inputs in their units."""
        entry = self.true.entry("ceramic", "AD85")
        return np.array([1.0, *(entry[key] for key in LAWS[self.law])])

    def limit_and_slope(self, x: Floats) -> tuple[float, Floats]:
        """Return the limit of the design, m/s, and its derivatives by the inputs."""
        likelihood = self.likelihood(of_design=True)
        limit = float(likelihood.predicted(x)[0])
        steps = (likelihood.predicted(x + likelihood_fit.DIFFERENCE * step)[0] for step in np.eye(len(x)))
        return limit, np.array([step - limit for step in steps]) / likelihood_fit.DIFFERENCE

    def expected(self) -> tuple[float, float]:
        """Return half-widths of the intervals of flow stress, GPa, and limit of the design, m/s, by the formula."""
        likelihood, x = self.likelihood(), self.x
        rows = likelihood_fit.rows_at(likelihood, x, SCATTER)[1]
        covariance = np.linalg.inv(rows.T @ rows).astype(np.float64)
        return self.half_widths(covariance, x, likelihood.units)

    def half_widths(self, covariance: Floats, x: Floats, units: Floats) -> tuple[float, float]:
        """Return the half-widths that a covariance gives."""
        factor = float(t.ppf(0.5 * (1.0 + CONFIDENCE), NUMBER - len(x)))
        slope = self.limit_and_slope(x)[1]
        return factor * sqrt(covariance[0, 0]) * float(units[0]), factor * sqrt(slope @ covariance @ slope)

    def simulated(self, samples: int, seed: int) -> Iterator[tuple[float, bool, float, bool]]:
        """Yield half-widths and whether intervals hold the true value, of flow stress and limit, for each sample."""
        likelihood, x, dice = self.likelihood(), self.x, np.random.default_rng(seed)
        limits, truth = likelihood.predicted(x), self.limit_and_slope(x)[0]
        for _ in range(samples):
            measured = limits * (1.0 + SCATTER * dice.normal(size=NUMBER))
            made = self.likelihood(measured).tests
            fit = likelihood_fit.fit_inputs(made, likelihood.names, ignore_progress)
            low, high = likelihood_fit.intervals(fit)[0].interval or (None, None)
            if low is None or high is None:
                continue  # counted as no sample; the caller prints how many there are
            found = self.limit_and_slope(fit.best.x)[0]
            half = self.half_widths(fit.covariance, fit.best.x, likelihood.units)[1]
            holds = low <= likelihood.units[0] <= high
            yield 0.5 * (high - low), holds, half, abs(found - truth) <= half


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
        plan = plan_tests(
            true,
            CANDIDATES,
            law=law,
            number=NUMBER,
            criterion=criterion,
            designs=[design],
            scatter_percent=100.0 * SCATTER,
        )
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
