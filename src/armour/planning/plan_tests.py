"""Choose the tests to make next: those that best determine fitted inputs or the ballistic limits of designs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan, sqrt
from os import PathLike
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, PlainValidator
from scipy.optimize import approx_fprime
from scipy.special import ndtri, stdtrit

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.evaluate import check_keys, scenarios_of
from armour.analysis.results import OnProgress, TableResult, by_column, ignore_progress
from armour.analysis.variants import Floats
from armour.errors import MAX_PROBLEMS, Note, Problem, choices, mistake, refuse, restated
from armour.leaving import warn_leaving
from armour.planning import optimal_design
from armour.planning.optimal_design import Task
from armour.scenario.checked import Names, checked, instance
from armour.scenario.inputs import FLOW_STRESS, INPUTS, NAMES, VELOCITY
from armour.scenario.keys import canonical
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics import likelihood
from armour.statistics.calibration import Law, check_fitted, check_same_prior, fitted_names, law_of, under_law, with_law
from armour.statistics.likelihood import InputFit, Likelihood
from armour.statistics.measured import LIMIT, MaterialGroup, Tests, with_scatter
from armour.sweeps.cases import Grid, SweepCases, source_of

# Column of the costs of candidates.
COST_CRITERION = "cost"
MAX_CANDIDATES, MAX_COST = 10_000, 1e12

Measure = Literal["limit", "outcome"]
Choice = Mapping[str, object] | str | PathLike[str] | Grid | SweepCases
MAX_NUMBER = 200

Criterion = Literal["D", "I"]


def _scenarios(designs: object) -> tuple[Scenario, ...]:
    return tuple(instance(design, Scenario) for design in (designs if isinstance(designs, list | tuple) else [designs]))


Designs = Annotated[Scenario | Sequence[Scenario], PlainValidator(_scenarios)]


@dataclass(frozen=True)
class PlannedTest:
    """A planned test, and how well the tests up to it determine the inputs and limits.

    Attributes
    ----------
    number : int
        1 for the first test; 0 for the state before all tests.
    inputs : dict of str to float or str
        Inputs of its armour, and the velocity if the outcome is measured, by key of the scenario.
    ballistic_limit_m_s : float or None
        Ballistic limit of its armour by the model, m/s.
    cost, total_cost : float or None
        Cost of this test, and of all tests up to it; None without costs.
    half_widths : dict of str to float or None
        Expected half-width of the interval of each fitted input, in its unit, after this test; None for an input that
        the tests do not determine.
    limit_half_widths_m_s : tuple of float or None
        Expected half-width of the interval of the ballistic limit of each design, m/s, after this test.
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
    """Tests to make next, in order.

    Attributes
    ----------
    planned : tuple of PlannedTest
        The first has number 0: the state before all tests.
    criterion : {"D", "I"}
        What the tests minimise, as in `plan_tests`.
    measure : {"limit", "outcome"}
        What a test measures, as in `plan_tests`.
    law : str
        Law of the ceramic's flow stress; empty if the flow stress is not fitted.
    values : dict of str to float
        Values of the fitted inputs at which the tests are planned.
    tests : str
        File of the earlier tests; empty without any.
    scatter_percent : float
        Standard deviation of a test, % of the ballistic limit.
    scatter_known : bool
        Whether the scatter is given; otherwise it is estimated from the tests, which widens the intervals.
    scatter_source : {"given", "uncertainties", "residuals"}
        Where the scatter is from: the argument, or the uncertainties or the residuals of the earlier tests.
    designs : tuple of str
        Files of the designs whose ballistic limits are to be determined.
    design_limits_m_s : tuple of float
        Their ballistic limits, m/s.
    efficiency : float or None
        Lower bound on the efficiency of the planned tests, 0 to 1, compared with the best distribution of the same cost
        over the candidates; None if these tests do not determine the inputs or, by "I", the limits of the designs.
    not_identified : tuple of str
        Fitted inputs that all candidates together do not determine.
    candidates : dict of str to tuple
        Inputs of the candidates, by key of the scenario.
    sensitivities : tuple of float
        Gain per cost of one further test of each candidate, relative to the average planned test; empty if the planned
        tests do not determine the inputs.
    confidence : float
        Confidence level of the intervals.
    notes : tuple of Note
    """

    planned: tuple[PlannedTest, ...]
    criterion: Criterion
    measure: Measure
    law: str
    values: dict[str, float]
    tests: str
    scatter_percent: float
    scatter_known: bool
    scatter_source: Literal["given", "uncertainties", "residuals"]
    designs: tuple[str, ...]
    design_limits_m_s: tuple[float, ...]
    efficiency: float | None
    not_identified: tuple[str, ...]
    candidates: dict[str, tuple[float | str, ...]]
    sensitivities: tuple[float, ...]
    confidence: float
    notes: tuple[Note, ...]

    def _columns(self) -> Mapping[str, Any]:
        rows = []
        for test in self.planned[1:]:
            row: dict[str, Any] = {"number": test.number, **test.inputs}
            row |= {"ballistic_limit_m_s": test.ballistic_limit_m_s, "total_cost": test.total_cost}
            row |= {f"half-width of {name}": width for name, width in test.half_widths.items()}
            for name, width in zip(self.designs, test.limit_half_widths_m_s, strict=True):
                row[f"half-width of the limit of {name}, m/s"] = width
            rows.append(row)
        return by_column(rows)


@dataclass(frozen=True)
class Candidates:
    """The n armours that can be tested, with the velocities of the shots if outcomes are measured."""

    file: str
    places: tuple[str, ...]  # name of each in messages, (n,)
    columns: dict[str, Any]  # inputs and names of materials by key, (n,) each
    costs: Floats | None  # of a test of each, (n,)
    groups: tuple[MaterialGroup, ...]

    def values(self) -> dict[str, tuple[float | str, ...]]:
        """Return the columns as tuples, by key."""
        return {key: tuple(column.tolist()) for key, column in self.columns.items()}

    def inputs(self, place: int) -> dict[str, float | str]:
        """Return the inputs of the candidate at an index, by key."""
        return {key: column[place].item() for key, column in self.columns.items()}

    def subject(self, scenario: Scenario) -> str:
        """Return what the tests are of, such as "Tests of AD85 on 6061-T6 against 7.62 mm AP"."""
        varied = {key: () if key in INPUTS else column for key, column in self.values().items()}
        return f"Tests of {scenario.subject({**ANY_VELOCITY, **varied})}"


def of_candidates(problem: Problem) -> Problem:
    """Return a problem of a sweep as one of the candidates of `plan_tests`."""
    if problem.file != "sweep":
        return problem
    return problem._replace(file="plan_tests", key=f"candidates {problem.key.removeprefix('over').strip()}".strip())


@restated(of_candidates)
def candidates_of(scenario: Scenario, choice: Choice, measure: Measure, cost: float | None) -> Candidates:
    """Read and check the candidates that the user chose.

    They have costs if `choice` has a column of costs, or if `cost`, that of a test without its target, is given.
    """
    source = choice if isinstance(choice, Grid | SweepCases) else source_of(choice)
    file = source.file if isinstance(source, SweepCases) else "candidates"
    count = source.count
    if count > MAX_CANDIDATES:
        raise mistake(file, "", f"must be at most {MAX_CANDIDATES:,} candidates, found {count:,}")
    columns = source.rows(np.arange(count))
    costs = columns.pop(COST_CRITERION, None)
    columns = dict(zip(canonical(columns, file), columns.values(), strict=True))
    _check_columns(scenario, columns, measure, file)
    if costs is not None:
        invalid = np.flatnonzero(~((costs > 0.0) & (costs <= MAX_COST)))[:MAX_PROBLEMS]
        message = f"must be greater than 0 and at most {MAX_COST:g}, found"
        refuse(source.place(0, int(row), Problem(file, COST_CRITERION, f"{message} {costs[row]:g}")) for row in invalid)
    if costs is not None or cost is not None:
        costs = (0.0 if costs is None else costs) + np.full(count, cost or 0.0)
    if measure == "outcome" and VELOCITY not in columns:
        columns[VELOCITY] = np.full(count, scenario.impact.velocity_m_s)
    groups = scenarios_of(scenario, columns, lambda row, problem: source.place(0, row, problem))
    return Candidates(
        file=file,
        places=tuple(source.place(0, row, Problem(file, "", "")).key.removeprefix("over ") for row in range(count)),
        columns=columns,
        costs=costs,
        groups=tuple(MaterialGroup(armour, where, inputs) for where, armour, inputs in groups),
    )


def _check_columns(scenario: Scenario, columns: Mapping[str, Any], measure: Measure, file: str) -> None:
    """Check that each column is a key that a test may have, and that it has an effect."""
    allowed = (*INPUTS, *NAMES.values())
    refuse(
        Problem(file, key, f"must be an input or a name that a test has{choices(key, (*allowed, COST_CRITERION))}")
        for key in columns
        if key not in allowed
    )
    if not columns:
        raise mistake(file, "", "must have at least one key of an armour")
    if measure == "limit" and VELOCITY in columns:
        message = "must not be given if the ballistic limit is measured; use --measure outcome for shots at a velocity"
        raise mistake(file, VELOCITY, message)
    quantities = ["outcome" if measure == "outcome" else LIMIT]
    check_keys(scenario, {key: column[0].item() for key, column in columns.items()}, quantities, file)


class LimitModel(NamedTuple):
    """Ballistic limits of n armours, the candidates and then the designs, as functions of k inputs."""

    groups: tuple[MaterialGroup, ...]  # with the law of the flow stress
    places: tuple[tuple[str, str], ...]  # file and place of each armour in messages, (n,)
    names: tuple[str, ...]  # of the inputs
    units: Floats  # of the inputs: a scenario's values, or 1, (k,)
    on_progress: OnProgress

    @property
    def scenario(self) -> Scenario:
        """Scenario of the first candidate."""
        return self.groups[0].scenario

    def limits(self, x: Floats) -> Floats:
        """Return the limits of the n armours, m/s, (n,), at `x`, the inputs in their units, (k,)."""
        limits = np.empty(len(self.places))
        for group in self.groups:
            inputs = np.repeat([x * self.units], len(group.where), axis=0).T
            limits[group.where] = likelihood.MODELS[LIMIT](group.variants(dict(zip(self.names, inputs, strict=True))))
        return limits

    def check(self, limits: Floats) -> None:
        """Check that all limits, m/s, (n,), are within the ranges of their searches."""
        problems = []
        for group in self.groups:
            section = group.scenario.ballistic_limit
            low, high = section.velocity_min_m_s, section.velocity_max_m_s
            ends = f"between {low:g} and {high:g} m/s, the range of the search"
            inside = (limits[group.where] > low) & (limits[group.where] < high)
            for file, place in (self.places[row] for row in group.where[~inside]):
                problems.append(Problem(file, place, f"must have a ballistic limit {ends}, found none"))
        refuse(problems)

    def gradients(self, x: Floats, limits: Floats) -> Floats:
        """Return the gradients, (n, k), of the logarithms of the limits at `x`, (k,), where these are `limits`, m/s."""

        def changes(x: Floats) -> Floats:
            self.on_progress(len(limits), None)
            return (self.limits(x) - limits) / limits

        return approx_fprime(x, changes, likelihood.DIFFERENCE).reshape(len(limits), len(x))


def limit_model(
    candidates: Candidates, designs: Sequence[Scenario], fit: Sequence[str], law: Law | None, on_progress: OnProgress
) -> LimitModel:
    """Return the limits of candidates, followed by those of designs, as functions of the inputs to fit.

    Check that these inputs can be fitted.
    """
    places, groups = [(candidates.file, place) for place in candidates.places], [*candidates.groups]
    for design in designs:
        groups.append(MaterialGroup(design, np.array([len(places)]), {}))
        places.append((design.file, ""))
    groups = [group._replace(scenario=with_law(group.scenario, law)) for group in groups]
    names = fitted_names(fit, law)
    likelihood.check_fittable(candidates.file, groups[0].scenario, groups, names, "plan_tests")
    units = likelihood.units_of(groups[0].scenario, names)
    return LimitModel(tuple(groups), tuple(places), tuple(names), units, on_progress)


@checked
def plan_tests(
    scenario: Scenario,
    candidates: Choice,
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

    The information from a test follows from the likelihood of `armour.calibrate`, linearised at the fit to earlier
    tests or, without a fit, at the scenario's values.

    This function leaves with version 3.  Instead, spread tests over the thicknesses that you will use, on at least two
    back plates.

    Parameters
    ----------
    scenario : Scenario
        Inputs that the tests have in common.
    candidates : mapping of str to values, or path-like
        Armours that can be tested, as for `armour.sweep`: every combination of values, or a CSV file.  A column
        ``cost`` has the costs of the targets.
    fit : str or sequence of str, default "ceramic.flow_stress_GPa"
        Input to determine, or several; by default the ceramic's flow stress.
    law : str, optional
        Law of the ceramic's flow stress, as in `calibrate`: constant, ceramic, backing, product or linear.  Its
        coefficients are determined too.
    number : int, default 4
        Number of tests to plan, 1 to 200.  A candidate may be tested several times.
    tests : Tests, optional
        Earlier tests.
    criterion : {"D", "I"}
        "D" minimises the joint confidence region of the inputs, "I" the mean variance of the designs' ballistic limits.
    designs : Scenario or sequence of Scenario, optional
        Designs whose ballistic limits are to be determined; by default the scenario's armour.
    measure : {"limit", "outcome"}
        What a test measures: the ballistic limit, or whether one shot at ``impact.velocity_m_s`` perforates.
    scatter_percent : float, optional
        Standard deviation of a test, % of the ballistic limit, 0.01 to 50; by default that of the earlier tests.
    cost : float, optional
        Cost of a test without its target.
    prior : bool, default False
        Whether to use the scenario's distributions of the fitted inputs as priors.
    on_progress : callable, optional
        Called with the number of armours computed since the last call, and None, as the total is not known.

    Returns
    -------
    PlannedTests

    Raises
    ------
    InputError
        If a setting is out of its range, a candidate is not a valid armour or has no ballistic limit in the range of
        the search, the candidates do not depend on the inputs, or the scatter is not known.
    """
    # The caller is two frames up, as the arguments are checked between.
    warn_leaving("plan_tests", 3)
    designs = (designs,) if isinstance(designs, Scenario) else tuple(designs) or (scenario,)
    fit = tuple(fit)
    check_fitted(fit, law, "plan_tests")
    scenario.check_names([name for name in fit if law is None or name == FLOW_STRESS], "plan_tests", "fit")
    armours = candidates_of(scenario, candidates, measure, cost)
    _check_materials([(design.file, design) for design in designs], armours.groups[0].scenario, fit)
    model = limit_model(armours, designs, fit, law, on_progress)
    scatter = None if scatter_percent is None else scatter_percent / 100.0
    earlier_likelihood = None
    if tests is not None:
        if scatter is not None and not tests.weighted:
            tests = with_scatter(tests, scatter)
        if prior:
            check_same_prior(tests, scenario, "plan_tests")
        tests_by_law, names = under_law(tests, fit, law)
        _check_materials([(tests.file, tests_by_law.groups[0].scenario)], model.scenario, names)
        earlier_likelihood = likelihood.likelihood_of(tests_by_law, names, on_progress, prior=prior)
        # The scenario of the tests may have other values than the candidates.
        model = model._replace(units=earlier_likelihood.units)
    knowledge = _knowledge(earlier_likelihood, model, scatter, prior=prior)
    limits = model.limits(knowledge.x)
    model.check(limits)
    gradients, count = model.gradients(knowledge.x, limits), len(armours.places)
    rows = _informing(armours, gradients[:count], limits[:count], knowledge.scatter, measure)
    # A test that determines inputs only to a million times their values counts for nothing.
    if (rows**2).sum(axis=1).max() < 1e-12:
        message = f"must depend on {', '.join(model.names)}, found no candidate that does"
        raise mistake(armours.file, "", message)
    basis = optimal_design.identified(knowledge.base, rows)
    input_directions = _determined(np.eye(len(basis)), basis)
    targets = _determined(gradients[count:] * limits[count:, None], basis)  # m/s
    if criterion == "I" and np.isnan(targets).any():
        message = 'must not be "I": the candidates do not determine the limit of a design'
        raise mistake("plan_tests", "criterion", message)
    task = Task(
        base=basis.T @ knowledge.base @ basis,
        rows=rows @ basis,
        costs=np.ones(count) if armours.costs is None else armours.costs,
        targets=targets if criterion == "I" else None,
    )
    chosen = optimal_design.best_set(task, number)
    quantity_gradients = np.vstack([input_directions * model.units[:, None], targets])
    half_widths = [
        _half_widths(task, chosen[:place], knowledge, quantity_gradients, measure) for place in range(number + 1)
    ]
    undetermined = tuple(name for name, row in zip(model.names, input_directions, strict=True) if np.isnan(row).any())
    sensitivities = _sensitivities(task, chosen)
    comparable = len(sensitivities) > 0 and (criterion == "I" or not undetermined)
    return PlannedTests(
        planned=_planned(armours, chosen, limits, half_widths, model.names),
        criterion=criterion,
        measure=measure,
        law=law or (law_of(model.scenario) if FLOW_STRESS in model.names else ""),
        values=dict(zip(model.names, (knowledge.x * model.units).tolist(), strict=True)),
        tests="" if tests is None else tests.file,
        scatter_percent=100.0 * knowledge.scatter,
        scatter_known=knowledge.freedom is None,
        scatter_source="given" if scatter else "uncertainties" if knowledge.freedom is None else "residuals",
        designs=tuple(design.file for design in designs),
        design_limits_m_s=tuple(limits[count:].tolist()),
        efficiency=optimal_design.efficiency(task, chosen) if comparable else None,
        not_identified=undetermined,
        candidates=armours.values(),
        sensitivities=tuple(sensitivities.tolist()),
        confidence=CONFIDENCE,
        notes=(*scenario.unused_threats(), *map(Note, (*knowledge.warnings, *_warnings(task, number, undetermined)))),
    ).of(armours.subject(scenario), scenario=scenario, tests=tests)


def _informing(candidates: Candidates, gradients: Floats, limits: Floats, scatter: float, measure: Measure) -> Floats:
    """Return the rows of the information about the inputs from a test of each candidate, (n, k).

    The information from a row f is f f'.  `gradients`, (n, k), are those of the logarithms of the `limits`, m/s, (n,);
    `scatter` is relative to the limit.
    """
    if measure == "limit":
        return gradients / scatter
    velocities = candidates.columns[VELOCITY].astype(np.float64)
    # As in a calibration, an outcome's scatter is in proportion to its velocity.
    z = (velocities - limits) / (scatter * velocities)
    weights: Floats = limits / velocities * np.sqrt(likelihood.hazard(z) * likelihood.hazard(-z))
    return gradients / scatter * weights[:, None]


def _sensitivities(task: Task, chosen: Sequence[int]) -> Floats:
    """Return the gain per cost of one more test of each candidate, relative to the average planned test.

    The array, (n,), is empty if the planned tests, at the indices `chosen`, do not determine the inputs.
    """
    information = task.information(chosen)
    if optimal_design.missing_tests(information, task.rows):
        return np.empty(0)
    slopes = task.sensitivities(information) / task.costs
    gains: Floats = slopes / (slopes[chosen] @ task.costs[chosen] / task.costs[chosen].sum())
    return gains


def _planned(
    candidates: Candidates, chosen: Sequence[int], limits: Floats, half_widths: Sequence[Floats], names: Sequence[str]
) -> tuple[PlannedTest, ...]:
    """Return the state before the tests, and each planned test.

    `chosen` are the indices of their candidates, whose limits are `limits`, m/s, (n,).  `half_widths` are those of the
    k inputs, called `names`, and of the t designs' limits, before the tests and after each, (k + t,) each.
    """
    costs = None if candidates.costs is None else candidates.costs[chosen]
    planned = []
    for number, half_widths_after in enumerate(half_widths):
        widths = [float(width) if isfinite(width) else None for width in half_widths_after]
        last = chosen[number - 1]
        planned.append(
            PlannedTest(
                number=number,
                inputs=candidates.inputs(last) if number else dict.fromkeys(candidates.columns, ""),
                ballistic_limit_m_s=float(limits[last]) if number else None,
                cost=float(costs[number - 1]) if number and costs is not None else None,
                total_cost=None if costs is None else float(sum(costs[:number])),
                half_widths=dict(zip(names, widths, strict=False)),
                limit_half_widths_m_s=tuple(widths[len(names) :]),
            )
        )
    return tuple(planned)


def _warnings(task: Task, number: int, undetermined: Sequence[str]) -> Iterator[str]:
    """Yield warnings of inputs that the candidates, or the planned number of tests, do not determine."""
    if undetermined:
        yield f"the candidates do not determine {', '.join(undetermined)}: all limits depend on them in the same way"
    if number < (least := optimal_design.missing_tests(task.base, task.rows)):
        yield f"{number} tests do not determine the inputs; at least {least} are needed"


class _Knowledge(NamedTuple):
    """What is known of the inputs and of the scatter before the planned tests."""

    x: Floats  # inputs in their units, (k,)
    base: Floats  # information about the inputs, (k, k)
    scatter: float  # standard deviation of a test, relative to the limit
    freedom: float | None  # degrees of freedom of the scatter; None if it is given
    warnings: tuple[str, ...]


def _knowledge(earlier: Likelihood | None, model: LimitModel, scatter: float | None, *, prior: bool) -> _Knowledge:
    """Return what earlier tests and the prior say of the inputs, and the scatter of a test.

    `scatter` is the one given by the user, relative to the limit.  With too few earlier tests for a fit, the values are
    those of the prior or, without one, of the scenario.
    """
    fit = None
    if earlier is not None:
        tests = earlier.tests
        if earlier.usable >= earlier.needed:
            fit = likelihood.fit_inputs(earlier)
        scatter = scatter or (fit.spread if fit and not tests.weighted else _given_scatter(tests))
    if scatter is None:
        message = "must be given: there are too few tests to estimate it from"
        raise mistake("plan_tests", "scatter_percent", message)
    if fit is not None:
        return _fitted(fit, scatter)
    distributions = likelihood.prior_of(model.scenario, model.names, model.units) if prior else likelihood.NO_PRIOR
    values = model.scenario.inputs()
    x = distributions.centred(np.array([values.get(name, 0.0) for name in model.names]) / model.units)
    base = distributions.rows(x).T @ distributions.rows(x)
    warning = "the plan is optimal only near the inputs' present values, which no tests support"
    if earlier is not None:
        rows = likelihood.rows_at(earlier, x, 1.0)[1]
        base, warning = base + rows.T @ rows, f"{warning}: too few for a fit"
    return _Knowledge(x, base, scatter, None, (warning,))


def _fitted(fit: InputFit, scatter: float) -> _Knowledge:
    """Return what a fit to earlier tests says of the inputs; `scatter`, relative, is that of a test."""
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
    # The search approaches an end of the range without reaching it.
    if (np.minimum(fit.best.x - lower, upper - fit.best.x) < 1e-6 * (upper - lower)).any():
        warnings.append("the fit to the tests ends at the end of the range of its search")
    freedom = None if tests.weighted else fit.degrees_of_freedom
    return _Knowledge(fit.best.x, rows.T @ rows, scatter, freedom, tuple(warnings))


def _given_scatter(tests: Tests) -> float | None:
    """Return the root mean square of the relative uncertainties of limits in the tests; None if none is given."""
    relative = [m.uncertainty / m.value for m in tests.measurements if m.quantity == LIMIT and m.uncertainty]
    return sqrt(sum(part**2 for part in relative) / len(relative)) if relative else None


def _check_materials(scenarios: Sequence[tuple[str, Scenario]], first: Scenario, names: Sequence[str]) -> None:
    """Check that scenarios, each with its file, have the same materials as `first` where inputs of these are fitted.

    `names` are the fitted inputs; the other values of these materials must be the same too.
    """
    must = "must be the same as for the candidates, with the same values"
    refuse(
        Problem(file, key, f"{must}, as it is fitted: {first.name_of(role)}, found {scenario.name_of(role)}")
        for role, key in NAMES.items()
        if any(fitted.startswith(f"{role}.") for fitted in names)
        for file, scenario in scenarios
        if _values_of(scenario, role, names) != _values_of(first, role, names)
    )


def _values_of(scenario: Scenario, role: str, fitted: Sequence[str]) -> dict[str, float]:
    """Return the values of the projectile or material in a role that are not fitted, by input."""
    inputs = scenario.inputs().items()
    return {name: value for name, value in inputs if name.startswith(f"{role}.") and name not in fitted}


def _determined(vectors: Floats, basis: Floats) -> Floats:
    """Return m vectors, (m, k), in coordinates of the r directions in `basis`, (k, r); NaN if outside their span."""
    inside: Floats = vectors @ basis
    # A hundredth of the length of a vector may lie outside.
    outside = np.linalg.norm(vectors - inside @ basis.T, axis=1) > 0.01 * np.linalg.norm(vectors, axis=1)
    inside[outside] = nan
    return inside


def _half_widths(
    task: Task, chosen: Sequence[int], knowledge: _Knowledge, gradients: Floats, measure: Measure
) -> Floats:
    """Return the expected half-widths of the intervals of m quantities, (m,), after tests of candidates `chosen`.

    `gradients`, (m, r), are those of the quantities by the r parameters of the task.  A half-width is NaN if the tests
    do not determine the quantity.
    """
    information = task.information(chosen)
    if optimal_design.missing_tests(information, task.rows):
        return np.full(len(gradients), nan)
    # Further limits also add to the knowledge of the scatter.
    freedom = knowledge.freedom and knowledge.freedom + (len(chosen) if measure == "limit" else 0)
    factor = float(ndtri(likelihood.UPPER) if freedom is None else stdtrit(freedom, likelihood.UPPER))
    variances = np.einsum("mr,rs,ms->m", gradients, np.linalg.inv(information), gradients)
    return factor * np.sqrt(variances)
