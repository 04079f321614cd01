"""Armours available for testing, the candidates of planned tests, and their ballistic limits by the model."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.optimize import approx_fprime

from armour.analysis.evaluate import check_keys, scenarios_of
from armour.analysis.results import OnProgress
from armour.analysis.variants import Floats, variants_of
from armour.errors import MAX_PROBLEMS, Problem, choices, mistake, refuse, restated
from armour.scenario.inputs import INPUTS, NAMES, VELOCITY
from armour.scenario.keys import canonical
from armour.scenario.scenario import ANY_VELOCITY, Scenario
from armour.statistics.calibration import Law, fitted_names, with_law
from armour.statistics.likelihood import DIFFERENCE, MODELS, check_fittable, units_of
from armour.statistics.measured import LIMIT, MaterialGroup
from armour.sweeps.cases import Cases, Grid, source_of

# Column of the cost of a candidate.
COST = "cost"
MAX_CANDIDATES, MAX_COST = 10_000, 1e12

Measure = Literal["limit", "outcome"]
Choice = Mapping[str, object] | str | PathLike[str] | Grid | Cases


@dataclass(frozen=True)
class Candidates:
    """Armours that can be tested, and the velocities of their shots if outcomes are measured."""

    file: str
    places: tuple[str, ...]  # in messages, (n,)
    columns: dict[str, Any]  # inputs and names by key, (n,)
    costs: Floats | None  # (n,)
    groups: tuple[MaterialGroup, ...]

    @property
    def count(self) -> int:
        """Number of candidates."""
        return len(self.places)

    def values(self) -> dict[str, tuple[float | str, ...]]:
        """Return the columns as plain data."""
        return {key: tuple(column.tolist()) for key, column in self.columns.items()}

    def inputs(self, place: int) -> dict[str, float | str]:
        """Return the inputs of one candidate."""
        return {key: column[place].item() for key, column in self.columns.items()}

    def subject(self, scenario: Scenario) -> str:
        """Return materials and rounds, such as "Tests of AD85 on 6061-T6 against 7.62 mm AP"."""
        varied = {key: () if key in INPUTS else column for key, column in self.values().items()}
        return f"Tests of {scenario.subject({**ANY_VELOCITY, **varied})}"


@contextmanager
def of_candidates() -> Iterator[None]:
    """Say "candidates" instead of "sweep" in error messages."""
    with restated(_of_candidates):
        yield


def _of_candidates(problem: Problem) -> Problem:
    if problem.file != "sweep":
        return problem
    return problem._replace(file="plan_tests", key=f"candidates {problem.key.removeprefix('over').strip()}".strip())


@of_candidates()
def candidates_of(scenario: Scenario, choice: Choice, measure: Measure, cost: float | None) -> Candidates:
    """Return the candidates of a choice, checked; they have costs if the choice has, or if a test has a cost."""
    source = choice if isinstance(choice, Grid | Cases) else source_of(choice)
    file = str(source.path) if isinstance(source, Cases) else "candidates"
    count = source.count
    if count > MAX_CANDIDATES:
        raise mistake(file, "", f"must be at most {MAX_CANDIDATES:,} candidates, found {count:,}")
    columns = source.rows(np.arange(count))
    costs = columns.pop(COST, None)
    columns = dict(zip(canonical(columns, file), columns.values(), strict=True))
    _check_columns(scenario, columns, measure, file, has_costs=costs is not None)
    if costs is not None:
        invalid = np.flatnonzero(~((costs > 0.0) & (costs <= MAX_COST)))[:MAX_PROBLEMS]
        message = f"must be greater than 0 and at most {MAX_COST:g}, found"
        refuse(source.place(0, int(row), Problem(file, COST, f"{message} {costs[row]:g}")) for row in invalid)
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


def _check_columns(
    scenario: Scenario, columns: Mapping[str, Any], measure: Measure, file: str, *, has_costs: bool
) -> None:
    """Check that the columns are keys that a test may have and that have an effect."""
    allowed = (*INPUTS, *NAMES.values())
    proposed = allowed if has_costs else (*allowed, COST)
    refuse(
        Problem(file, key, f"must be an input or a name that a test has{choices(key, proposed)}")
        for key in columns
        if key not in allowed
    )
    if not columns:
        raise mistake(file, "", "must have at least one key of an armour")
    if measure == "limit" and VELOCITY in columns:
        message = "must not be given if the ballistic limit is measured; use --measure outcome for shots at a velocity"
        raise mistake(file, VELOCITY, message)
    quantity = "outcome" if measure == "outcome" else LIMIT
    check_keys(scenario, {key: column[0].item() for key, column in columns.items()}, (quantity,), file)


class LimitModel(NamedTuple):
    """Ballistic limits of n candidates and designs as functions of k inputs."""

    groups: tuple[MaterialGroup, ...]  # under the law of the flow stress
    places: tuple[tuple[str, str], ...]  # file and place of each in messages, (n,)
    names: tuple[str, ...]  # of the inputs
    units: Floats  # of the inputs: a scenario's values, or 1, (k,)
    on_progress: OnProgress

    @property
    def scenario(self) -> Scenario:
        """The first scenario."""
        return self.groups[0].scenario

    def limits(self, x: Floats) -> Floats:
        """Return the limits, m/s, (n,), given the inputs in their units, (k,)."""
        limits = np.empty(len(self.places))
        for group in self.groups:
            fitted = {
                name: np.full(len(group.where), value) for name, value in zip(self.names, x * self.units, strict=True)
            }
            variants = variants_of(group.scenario, {**group.columns, **fitted}, len(group.where))
            limits[group.where] = MODELS[LIMIT](variants)
        return limits

    def check(self, limits: Floats) -> None:
        """Check that all limits are within the ranges of their searches."""
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
        """Return the gradients of the limits, relative to the limits, (n, k)."""

        def changes(x: Floats) -> Floats:
            self.on_progress(len(limits), None)
            return (self.limits(x) - limits) / limits

        return approx_fprime(x, changes, DIFFERENCE).reshape(len(limits), len(x))


def limit_model(
    candidates: Candidates, designs: Sequence[Scenario], fit: Sequence[str], law: Law | None, on_progress: OnProgress
) -> LimitModel:
    """Return the limits of candidates, followed by those of designs, as functions of inputs, which are checked."""
    design_groups = (MaterialGroup(design, np.array([candidates.count + i]), {}) for i, design in enumerate(designs))
    groups = tuple(
        group._replace(scenario=with_law(group.scenario, law)) for group in (*candidates.groups, *design_groups)
    )
    names = fitted_names(fit, law)
    check_fittable(candidates.file, groups[0].scenario, groups, names)
    places = [(candidates.file, place) for place in candidates.places] + [(design.file, "") for design in designs]
    units = units_of(groups[0].scenario, names)
    return LimitModel(groups, tuple(places), tuple(names), units, on_progress)
