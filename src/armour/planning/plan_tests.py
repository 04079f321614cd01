"""Plans of tests: which armours to test next, to determine fitted inputs or the limit of a design best."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import isfinite, nan, sqrt
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, PlainValidator
from scipy.optimize import approx_fprime
from scipy.stats import norm, t

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.evaluate import check_keys, scenarios_of
from armour.analysis.results import OnProgress, TableResult, by_column, ignore_progress
from armour.analysis.variants import Floats
from armour.errors import MAX_PROBLEMS, InputError, Problem, choices, mistake, refuse
from armour.planning import optimal_design
from armour.planning.optimal_design import Task
from armour.scenario.checked import Names, checked, instance
from armour.scenario.inputs import INPUTS, NAMES, VELOCITY
from armour.scenario.keys import canonical
from armour.scenario.scenario import Scenario
from armour.statistics.calibration import FLOW_STRESS, Law, check_fitted, law_of, under_law
from armour.statistics.likelihood import (
    DIFFERENCE,
    InputFit,
    Likelihood,
    fit_inputs,
    hazard,
    likelihood_of,
    needed_of,
    rows_at,
    usable,
)
from armour.statistics.measured import LIMIT, MEASURED, MaterialGroup, Measurement, Tests, subject_of
from armour.sweeps.cases import Cases, Grid, source_of

# Column of the cost of a candidate.
COST = "cost"
MAX_CANDIDATES, MAX_NUMBER = 10_000, 200
MAX_COST = 1e12
# Information on a relative change of an input below which a test does not inform: a standard deviation of a million.
NOTHING = 1e-12
# Part of a vector that may lie outside the directions that tests determine.
OUTSIDE = 1e-2
# Parts of the range of a search within which a fit ends at its end.
AT_END = 1e-6

Criterion = Literal["D", "I"]
Measure = Literal["limit", "outcome"]
ScatterSource = Literal["given", "uncertainties", "residuals"]


def _several(designs: object) -> tuple[Scenario, ...]:
    return tuple(instance(design, Scenario) for design in (designs if isinstance(designs, list | tuple) else [designs]))


Designs = Annotated[Scenario | Sequence[Scenario], PlainValidator(_several)]
Candidates = Mapping[str, object] | str | PathLike[str] | Grid | Cases


@dataclass(frozen=True)
class PlannedTest:
    """A planned test, and what is known once it has been made.

    Attributes
    ----------
    number : int
        1 for the first; 0 for what is known before.
    inputs : dict of str to float or str
        Its armour, and the velocity if the outcome is measured, by key of the scenario.
    ballistic_limit_m_s : float or None
        By the model, m/s.
    cost, total_cost : float or None
        Of this test, and of all up to it; None without costs.
    half_widths : dict of str to float or None
        Expected half-width of the interval of each fitted input, in its unit; None if the tests do not determine it.
    limit_half_widths_m_s : tuple of float or None
        The same of the ballistic limit of each design, m/s.
    """

    number: int
    inputs: dict[str, float | str]
    ballistic_limit_m_s: float | None
    cost: float | None
    total_cost: float | None
    half_widths: dict[str, float | None]
    limit_half_widths_m_s: tuple[float | None, ...]


@dataclass(frozen=True, repr=False)
class PlannedTests(TableResult):
    """Tests to make next, in their order.

    Attributes
    ----------
    planned : tuple of PlannedTest
        Number 0, what is known before, comes first.
    criterion : {"D", "I"}
    measure : {"limit", "outcome"}
    law : str
        Law of the ceramic's flow stress; empty if the flow stress is not fitted.
    values : dict of str to float
        Fitted inputs, at whose values the tests are planned.
    tests : str
        File of the tests made before; empty without any.
    scatter_percent : float
        Standard deviation of a test, % of the ballistic limit.
    scatter_known : bool
        Whether it is given; otherwise it is estimated from the tests, which widens the intervals.
    scatter_source : {"given", "uncertainties", "residuals"}
        Where the scatter comes from: the argument, or the uncertainties or the residuals of the tests made before.
    designs : tuple of str
        Files of the designs in question.
    design_limits_m_s : tuple of float
        Their ballistic limits, m/s.
    efficiency : float or None
        Lower bound on the efficiency of these tests, 0 to 1, relative to the best distribution of the same cost over
        the candidates; None if they do not determine the inputs or, by "I", the limits of the designs.
    not_identified : tuple of str
        Fitted inputs that all candidates together do not determine.
    candidates : dict of str to tuple
        Inputs of the candidates, by key of the scenario.
    sensitivities : tuple of float
        Gain per cost of one further test of each candidate, relative to the average planned test; empty if the planned
        tests do not determine the inputs.
    confidence : float
        Confidence level of the intervals.
    warnings : tuple of str
    """

    planned: tuple[PlannedTest, ...]
    criterion: Criterion
    measure: Measure
    law: str
    values: dict[str, float]
    tests: str
    scatter_percent: float
    scatter_known: bool
    scatter_source: ScatterSource
    designs: tuple[str, ...]
    design_limits_m_s: tuple[float, ...]
    efficiency: float | None
    not_identified: tuple[str, ...]
    candidates: dict[str, tuple[float | str, ...]]
    sensitivities: tuple[float, ...]
    confidence: float
    warnings: tuple[str, ...]

    def _words(self) -> str:
        least = "" if self.efficiency is None else f", {self.criterion}-efficiency {self.efficiency:.3f}"
        return f"{len(self.planned) - 1} tests of {len(self.sensitivities)} candidates{least}"

    def _columns(self) -> Mapping[str, Any]:
        return by_column(
            {
                "number": test.number,
                **test.inputs,
                "ballistic_limit_m_s": test.ballistic_limit_m_s,
                "total_cost": test.total_cost,
                **{f"half-width of {name}": value for name, value in test.half_widths.items()},
                **{
                    f"half-width of the limit of {name}, m/s": value
                    for name, value in zip(self.designs, test.limit_half_widths_m_s, strict=True)
                },
            }
            for test in self.planned[1:]
        )


@checked
def plan_tests(
    scenario: Scenario,
    candidates: Candidates,
    fit: Names = FLOW_STRESS,
    law: Law | None = None,
    *,
    number: Annotated[int, Field(ge=1, le=MAX_NUMBER)] = 4,
    tests: Tests | None = None,
    criterion: Criterion = "D",
    designs: Designs = (),
    measure: Measure = "limit",
    scatter_percent: Annotated[float, Field(ge=0.01, le=50.0)] | None = None,
    cost: Annotated[float, Field(gt=0.0, le=MAX_COST)] | None = None,
    prior: bool = False,
    on_progress: OnProgress = ignore_progress,
) -> PlannedTests:
    """Choose the tests that best determine fitted inputs or the ballistic limits of designs.

    The information of a test is that of the likelihood of `armour.calibrate`, linearised at the fit to earlier tests or
    else at the scenario's values.

    Parameters
    ----------
    scenario : Scenario
        Inputs that the tests have in common.
    candidates : mapping of str to values, or path-like
        Armours that can be tested, as for `armour.sweep`: every combination of values, or a CSV file.  Its column
        ``cost`` is the cost of a target.
    fit : str or sequence of str, default "ceramic.flow_stress_GPa"
        Input to determine, or several; by default the ceramic's flow stress.
    law : {"constant", "ceramic", "backing", "product", "linear"}, optional
        Law of the ceramic's flow stress, as in calibrate, whose coefficients are determined too.
    number : int, default 4
        Number of tests to plan, 1 to 200.  A candidate may be tested several times.
    tests : Tests, optional
        Tests made before.
    criterion : {"D", "I"}
        "D" minimises the joint confidence region of the inputs, "I" the mean variance of the designs' ballistic limits.
    designs : Scenario or sequence of Scenario, optional
        Designs in question; by default the scenario's own armour.
    measure : {"limit", "outcome"}
        What a test measures: the ballistic limit, or whether one shot at ``impact.velocity_m_s`` perforates.
    scatter_percent : float, optional
        Standard deviation of a test, % of the ballistic limit, 0.01 to 50; by default that of the earlier tests.
    cost : float, optional
        Cost of a test without its target.
    prior : bool, default False
        Whether to use the scenario's distributions of the fitted inputs as priors.
    on_progress : callable, optional
        Called with the number of armours computed since the last call, and None.

    Returns
    -------
    PlannedTests

    Raises
    ------
    InputError
        If a setting is out of its range, a candidate is not a valid armour or has no ballistic limit in the range of
        the search, the candidates do not depend on the inputs, or the scatter is not known.
    """
    questions = (designs,) if isinstance(designs, Scenario) else tuple(designs) or (scenario,)
    fit = tuple(fit)
    check_fitted(fit, law, "plan_tests")
    scenario.check_names([name for name in fit if law is None or name == FLOW_STRESS], "plan_tests", "fit")
    rows, costs = _candidates(scenario, candidates, measure, cost)
    source: ScatterSource = "uncertainties" if tests is not None and tests.weighted else "residuals"
    if tests is not None and scatter_percent is not None and not tests.weighted:
        tests = _weighted_by(tests, scatter_percent / 100.0)
    _check_materials([(design.file, design) for design in questions], rows.groups[0].scenario, fit)
    all_rows = _with_designs(rows, questions)
    all_rows, names = under_law(all_rows, fit, law)
    likelihood = likelihood_of(all_rows, names, on_progress, prior=prior)
    scatter = None if scatter_percent is None else scatter_percent / 100.0
    known = _knowledge(tests, likelihood, fit, law, scatter, prior=prior, on_progress=on_progress)
    likelihood, gradients, limits = _gradients(likelihood, known.x, len(rows.names))
    count = len(rows.names)
    informing = gradients[:count] / known.scatter
    if measure == "outcome":
        velocities = np.array([cell[VELOCITY] for cell in rows.cells], dtype=np.float64)
        # As in a calibration, an outcome's scatter is in proportion to its velocity.
        z = (velocities - limits[:count]) / (known.scatter * velocities)
        informing *= (limits[:count] / velocities * np.sqrt(hazard(z) * hazard(-z)))[:, None]
    if (informing**2).sum(axis=1).max() < NOTHING:
        raise mistake(rows.file, "", f"must depend on {', '.join(names)}, found no candidate that does")
    basis = optimal_design.identified(known.base, informing)
    inputs = _determined(np.eye(len(basis)), basis)
    targets = _determined(gradients[count:] * limits[count:, None], basis)  # m/s
    task = Task(
        base=basis.T @ known.base @ basis,
        rows=informing @ basis,
        costs=np.ones(count) if costs is None else costs,
        targets=targets if criterion == "I" else None,
    )
    if criterion == "I" and np.isnan(targets).any():
        message = 'must not be "I": the candidates do not determine the limit of a design'
        raise mistake("plan_tests", "criterion", message)
    chosen = optimal_design.best_set(task, number)
    regular = not optimal_design.missing(task.information(chosen), task.rows)
    gains = np.empty(0)
    if regular:
        slopes = task.sensitivities(task.information(chosen)) / task.costs
        gains = slopes / (slopes[chosen] @ task.costs[chosen] / task.costs[chosen].sum())
    lacking = tuple(name for name, row in zip(names, inputs, strict=True) if np.isnan(row).any())
    warnings = [*known.warnings]
    if lacking:
        warnings.append(
            f"the candidates do not determine {', '.join(lacking)}: their limits depend on the inputs alike"
        )
    if number < (needed := optimal_design.missing(task.base, task.rows)):
        warnings.append(f"{number} tests do not determine the inputs; at least {needed} are needed")
    planned = []
    for made in range(number + 1):
        halves = _half_widths(task, chosen[:made], known, [*(inputs * likelihood.units[:, None]), *targets], measure)
        last = chosen[made - 1]
        planned.append(
            PlannedTest(
                number=made,
                inputs=dict(rows.cells[last]) if made else dict.fromkeys(rows.cells[0], ""),
                ballistic_limit_m_s=float(limits[last]) if made else None,
                cost=float(costs[last]) if made and costs is not None else None,
                total_cost=None if costs is None else float(sum(costs[chosen[:made]])),
                half_widths=dict(zip(names, halves, strict=False)),
                limit_half_widths_m_s=tuple(halves[len(names) :]),
            )
        )
    comparable = regular and (criterion == "I" or not lacking)
    return PlannedTests(
        planned=tuple(planned),
        criterion=criterion,
        measure=measure,
        law=law or (law_of(all_rows.groups[0].scenario) if FLOW_STRESS in names else ""),
        values=dict(zip(names, (known.x * likelihood.units).tolist(), strict=True)),
        tests="" if tests is None else tests.file,
        scatter_percent=100.0 * known.scatter,
        scatter_known=known.freedom is None,
        scatter_source=source if scatter_percent is None else "given",
        designs=tuple(design.file for design in questions),
        design_limits_m_s=tuple(limits[count:].tolist()),
        efficiency=optimal_design.efficiency(task, chosen) if comparable else None,
        not_identified=lacking,
        candidates={key: tuple(cell[key] for cell in rows.cells) for key in rows.cells[0]},
        sensitivities=tuple(gains.tolist()),
        confidence=CONFIDENCE,
        warnings=tuple(warnings),
    ).of(subject_of(rows), scenario=scenario, tests=tests)


@contextmanager
def of_candidates() -> Iterator[None]:
    """Call the values of a sweep candidates in the messages on them."""
    try:
        yield
    except InputError as error:
        problems = (
            problem._replace(file="plan_tests", key=f"candidates {problem.key.removeprefix('over').strip()}".strip())
            if problem.file == "sweep"
            else problem
            for problem in error.problems
        )
        raise InputError(tuple(problems)) from None


def _candidates(
    scenario: Scenario, candidates: Candidates, measure: Measure, cost: float | None
) -> tuple[Tests, Floats | None]:
    """Return the candidates as tests without measurements, and their costs, (n,); None without costs."""
    with of_candidates():
        if isinstance(candidates, str | PathLike):
            candidates = Cases(Path(candidates))
        source = candidates if isinstance(candidates, Grid | Cases) else source_of(candidates)
    file = str(source.path) if isinstance(source, Cases) else "candidates"
    if source.count > MAX_CANDIDATES:
        raise mistake(file, "", f"must be at most {MAX_CANDIDATES:,} candidates, found {source.count:,}")
    count = source.count
    columns = source.rows(np.arange(count))
    costs = columns.pop(COST, None)
    columns = dict(zip(canonical(columns, file), columns.values(), strict=True))
    allowed = (*INPUTS, *NAMES.values())
    known = allowed if costs is not None else (*allowed, COST)
    unknown = [key for key in columns if key not in allowed]
    refuse(Problem(file, key, f"must be an input or a name that a test has{choices(key, known)}") for key in unknown)
    if not columns:
        raise mistake(file, "", "must have at least one key of an armour")
    if measure == "limit" and VELOCITY in columns:
        message = "must not be given if the ballistic limit is measured; --measure outcome for shots at a velocity"
        raise mistake(file, VELOCITY, message)
    quantity = "outcome" if measure == "outcome" else LIMIT
    check_keys(scenario, {key: values[0].item() for key, values in columns.items()}, (quantity,), file)
    if costs is not None:
        wrong = np.flatnonzero(~((costs > 0.0) & (costs <= MAX_COST)))[:MAX_PROBLEMS]
        message = f"must be greater than 0 and at most {MAX_COST:g}, found"
        refuse(source.place(0, int(row), Problem(file, COST, f"{message} {costs[row]:g}")) for row in wrong)
    if measure == "outcome" and VELOCITY not in columns:
        columns[VELOCITY] = np.full(count, scenario.impact.velocity_m_s)
    cells = tuple({key: values[i].item() for key, values in columns.items()} for i in range(count))
    with of_candidates():
        groups = tuple(
            MaterialGroup(made, where, own)
            for where, made, own in scenarios_of(scenario, columns, lambda row, problem: source.place(0, row, problem))
        )
    places = tuple(source.place(0, row, Problem(file, "", "")).key.removeprefix("over ") for row in range(count))
    if costs is not None or cost is not None:
        costs = (0.0 if costs is None else costs) + np.full(count, cost or 0.0)
    return Tests(file, places, groups, (), False, cells, scenario, places), costs


def _with_designs(rows: Tests, designs: Sequence[Scenario]) -> Tests:
    """Return candidates with the designs below them, as tests that measure the limit."""
    count = len(rows.names)
    groups = [MaterialGroup(design, np.array([count + i]), {}) for i, design in enumerate(designs)]
    return rows._replace(
        names=(*rows.names, *(design.file for design in designs)),
        groups=(*rows.groups, *groups),
        measurements=tuple(Measurement(row, LIMIT, 1.0, None, 0) for row in range(count + len(designs))),
    )


def _weighted_by(tests: Tests, scatter: float) -> Tests:
    """Return tests whose measurements have this relative uncertainty."""
    measurements = tuple(m._replace(uncertainty=scatter * m.value) for m in tests.measurements)
    cells = [dict(cell) for cell in tests.cells]
    for m in measurements:
        cells[m.test][MEASURED[m.quantity]] = scatter * m.value
    return tests._replace(measurements=measurements, weighted=True, cells=tuple(cells))


class _Knowledge(NamedTuple):
    """What is known before the planned tests."""

    x: Floats  # inputs in their units, (k,)
    base: Floats  # information of the inputs, (k, k)
    scatter: float  # of a test, relative
    freedom: float | None  # degrees of freedom of the scatter; None where it is given
    warnings: tuple[str, ...]


def _knowledge(
    tests: Tests | None,
    likelihood: Likelihood,
    inputs: Sequence[str],
    law: Law | None,
    scatter: float | None,
    *,
    prior: bool,
    on_progress: OnProgress,
) -> _Knowledge:
    """Return what earlier tests and the prior determine of the inputs, and how tests scatter."""
    fit = of_tests = None
    if tests is not None:
        tests, names = under_law(tests, inputs, law)
        made = [(tests.file, group.scenario) for group in tests.groups[:1]]
        _check_materials(made, likelihood.tests.groups[0].scenario, names)
        of_tests = likelihood_of(tests, names, on_progress, prior=prior)
        if usable(tests, of_tests.kept) >= needed_of(of_tests):
            fit = fit_inputs(tests, names, on_progress, prior=prior)
        scatter = scatter or (fit.spread if fit and not tests.weighted else _given_scatter(tests))
    if scatter is None:
        message = "must be given: there are too few tests to estimate it from"
        raise mistake("plan_tests", "scatter_percent", message)
    if fit is not None:
        return _fitted(fit, scatter)
    own = likelihood.tests.groups[0].scenario.inputs()
    x = likelihood.prior.centred(np.array([own.get(name, 0.0) for name in likelihood.names]) / likelihood.units)
    base = likelihood.prior.rows(x).T @ likelihood.prior.rows(x)
    warning = "the plan is optimal only near the inputs' present values, which no tests support"
    if of_tests is not None:
        rows = rows_at(of_tests, x, 1.0)[1]
        base, warning = base + rows.T @ rows, f"{warning}: too few for a fit"
    return _Knowledge(x, base, scatter, None, (warning,))


def _fitted(fit: InputFit, scatter: float) -> _Knowledge:
    """Return what a fit determines."""
    tests, rows = fit.likelihood.tests, fit.rows.copy()
    rows[: len(tests.measurements)] *= fit.best.scatter / fit.spread
    rows /= fit.widened_by
    warnings = []
    if fit.widened_by > 1.0:
        warnings.append(
            f"the tests in {tests.file} deviate more than their scatter explains, p = {fit.p_value:.2g}; "
            f"their standard deviations are multiplied by {fit.widened_by:.2f}"
        )
    lower, upper = fit.likelihood.lower, fit.likelihood.upper
    # The search comes close to an end without meeting it.
    if (np.minimum(fit.best.x - lower, upper - fit.best.x) < AT_END * (upper - lower)).any():
        warnings.append("the fit to the tests ends at the end of the range of its search")
    freedom = None if tests.weighted else fit.degrees_of_freedom
    return _Knowledge(fit.best.x, rows.T @ rows, scatter, freedom, tuple(warnings))


def _given_scatter(tests: Tests) -> float | None:
    """Return the root mean square of the relative uncertainties of limits and outcomes; None without any."""
    found = [m.uncertainty / m.value for m in tests.measurements if m.quantity == LIMIT and m.uncertainty]
    return sqrt(sum(part**2 for part in found) / len(found)) if found else None


def _check_materials(found: Sequence[tuple[str, Scenario]], first: Scenario, names: Sequence[str]) -> None:
    """Check that scenarios, of files, have the materials whose properties are fitted."""
    refuse(
        Problem(
            file, key, f"must be the same as for the candidates, {first.name_of(role)}, as it is fitted, found {name}"
        )
        for role, key in NAMES.items()
        if any(fitted.startswith(f"{role}.") for fitted in names)
        for file, scenario in found
        if (name := scenario.name_of(role)) != first.name_of(role)
    )


def _gradients(likelihood: Likelihood, x: Floats, count: int) -> tuple[Likelihood, Floats, Floats]:
    """Return relative gradients, (n, k), of the limits of candidates and designs, and the limits, m/s, (n,)."""
    tests = likelihood.tests
    limits = likelihood.predicted(x)
    problems = []
    for group in tests.groups:
        section = group.scenario.ballistic_limit
        low, high = section.velocity_min_m_s, section.velocity_max_m_s
        for row in group.where[~((limits[group.where] > low) & (limits[group.where] < high))]:
            message = (
                f"must have a ballistic limit between {low:g} and {high:g} m/s, the range of the search, found none"
            )
            file, key = (tests.file, tests.names[row]) if row < count else (tests.names[row], "")
            problems.append(Problem(file, key, message))
    refuse(problems)
    measured = tuple(m._replace(value=float(limits[m.test])) for m in tests.measurements)
    scaled = likelihood._replace(tests=tests._replace(measurements=measured))
    found = approx_fprime(x, scaled.deviations, DIFFERENCE).reshape(len(limits), len(x))
    return scaled, found, limits


def _determined(vectors: Floats, basis: Floats) -> Floats:
    """Return vectors, (m, k), in the directions that the tests determine, (k, r); NaN for those outside of these."""
    found: Floats = vectors @ basis
    outside = np.linalg.norm(vectors - found @ basis.T, axis=1) > OUTSIDE * np.linalg.norm(vectors, axis=1)
    found[outside] = nan
    return found


def _half_widths(
    task: Task, made: Sequence[int], known: _Knowledge, gradients: Sequence[Floats], measure: Measure
) -> list[float | None]:
    """Return the expected half-widths of the intervals of quantities with gradients, after tests are made."""
    # Further limits also add to the knowledge of the scatter.
    freedom = known.freedom and known.freedom + (len(made) if measure == "limit" else 0)
    information, tail = task.information(made), 0.5 * (1.0 + CONFIDENCE)
    if optimal_design.missing(information, task.rows):
        return [None] * len(gradients)
    factor = float(norm.ppf(tail) if freedom is None else t.ppf(tail, freedom))
    every = np.array(gradients)
    variances = np.einsum("mr,rs,ms->m", every, np.linalg.inv(information), every)
    return [factor * sqrt(value) if isfinite(value) else None for value in variances.tolist()]
