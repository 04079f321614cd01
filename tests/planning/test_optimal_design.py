"""Optimal designs of known form."""

from itertools import combinations_with_replacement

import numpy as np
import pytest

from armour.planning.optimal_design import (
    Task,
    best_set,
    continuous_design,
    efficiency,
    identified,
    missing_tests,
    ordered,
)

NOTHING = np.zeros((2, 2))
LINE = np.linspace(-1.0, 1.0, 21)
STRAIGHT = np.column_stack([np.ones(21), LINE])
QUADRATIC = np.column_stack([np.ones(21), LINE, LINE**2])


def task(rows: np.ndarray, *, base=None, costs=None, targets=None) -> Task:
    count, width = rows.shape
    return Task(
        np.zeros((width, width)) if base is None else base, rows, np.ones(count) if costs is None else costs, targets
    )


def test_one_input_is_tested_where_the_gradient_is_greatest():
    rows = np.array([[1.0], [-3.0], [2.0], [3.0]])
    assert best_set(task(rows), 3) == [1, 1, 1]  # of equals the first


def test_a_straight_line_is_tested_at_its_ends():
    assert sorted(best_set(task(STRAIGHT), 6)) == [0, 0, 0, 20, 20, 20]
    shares, _ = continuous_design(task(STRAIGHT), 1.0)
    assert shares[[0, 20]] == pytest.approx([0.5, 0.5], abs=1e-3)


def test_a_parabola_is_tested_at_its_ends_and_in_its_middle():
    assert sorted(best_set(task(QUADRATIC), 6)) == [0, 0, 10, 10, 20, 20]


def test_the_limit_of_a_target_is_tested_there():
    """The mean of a straight line at 0 is best known from tests at 0, or from any that are symmetric."""
    problem = task(STRAIGHT, targets=np.array([[1.0, 0.0]]))
    chosen = best_set(problem, 4)
    assert problem.loss(problem.information(chosen)) == pytest.approx(np.log(0.25))
    assert efficiency(problem, chosen) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("targets", [None, np.array([[1.0, 0.4, 0.2], [0.0, 1.0, 0.0]])])
@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_the_equivalence_theorem(targets, scale: float):
    """At the optimum no candidate tells more than the mean of those that have a share; D: as many as inputs."""
    problem = task(np.random.default_rng(1).normal(size=(40, 3)) * [1.0, scale, 1.0], targets=targets)
    shares, _ = continuous_design(problem, 1.0)
    information = (problem.rows * shares[:, None]).T @ problem.rows
    slopes = problem.sensitivities(information)
    assert slopes.max() <= (3.0 if targets is None else 1.0) + 2e-4
    assert slopes[shares > 0.01] == pytest.approx(slopes.max(), rel=2e-2)


@pytest.mark.parametrize("targets", [None, np.array([[1.0, 0.4]])])
def test_a_set_is_nearly_the_best_of_all(targets):
    problem = task(np.random.default_rng(2).normal(size=(9, 2)), targets=targets)
    losses = [float(problem.loss(problem.information(s))) for s in combinations_with_replacement(range(9), 4)]
    assert problem.loss(problem.information(best_set(problem, 4))) == pytest.approx(min(losses), abs=1e-3)


def test_the_units_of_inputs_change_nothing():
    rows = np.random.default_rng(3).normal(size=(30, 3))
    mixed = rows @ np.array([[1e4, 0.0, 0.0], [0.3, 1e-4, 0.0], [0.0, 2.0, 7.0]])
    assert best_set(task(rows), 5) == best_set(task(mixed), 5)


def test_what_is_known_is_not_tested_again():
    ends = np.array([[1.0, -1.0]])
    problem = task(STRAIGHT, base=1e4 * ends.T @ ends)
    assert best_set(problem, 3) == [20, 20, 20]
    assert (missing_tests(NOTHING, STRAIGHT), missing_tests(problem.base, STRAIGHT)) == (2, 1)


def test_costs():
    """At ten times the cost for half as much information again, a test is not worth it."""
    rows, costs = np.array([[1.0], [1.5]]), np.array([1.0, 10.0])
    assert best_set(task(rows, costs=costs), 2) == [0, 0]
    assert best_set(task(rows), 2) == [1, 1]


def test_directions_that_no_candidate_informs_of():
    rows = np.column_stack([LINE, 2.0 * LINE, np.ones(21)])
    found = identified(np.zeros((3, 3)), rows)
    assert found.shape == (3, 2)
    assert pytest.approx([0.0, 0.0], abs=1e-9) == found.T @ [2.0, -1.0, 0.0]


def test_too_few_tests_for_all_inputs():
    assert len(best_set(task(QUADRATIC), 2)) == 2


def test_the_order_is_that_of_the_gain():
    problem = task(np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 3.0]]), base=np.eye(2))
    assert ordered(problem, [0, 1, 2]) == [2, 0, 1]
