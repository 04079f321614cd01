"""The compiled way gives the numbers of the plain one, bit by bit, in whatever order and number of threads."""

import numpy as np
import pytest

from armour.core.run import run
from armour.core.search import ballistic_limit_of, least_ceramic_thickness, time_step
from armour.core.state import Outcome
from armour.engine import batch
from tests.numerics.test_independent import random_designs

DESIGNS = random_designs(400)
ROWS = batch.packed(DESIGNS)
VELOCITIES = np.random.default_rng(1).uniform(200.0, 1500.0, len(DESIGNS))


def test_impacts_are_those_of_plain_runs():
    found = batch.impacts(ROWS, VELOCITIES)
    for i, (a, V) in enumerate(zip(DESIGNS, VELOCITIES.tolist(), strict=True)):
        end = run(a, V, time_step(a, V, 0.0), 1.0, 500_000)
        plain = (end.outcome, end.t, *end.y, end.steps)
        assert tuple(column[i] for column in found) == pytest.approx(plain, rel=1e-9)


def test_limits_are_those_of_the_plain_search():
    found = batch.ballistic_limits(ROWS, 20.0, 4000.0, 1e-3)
    for i, a in enumerate(DESIGNS[:40]):
        plain = ballistic_limit_of(a, 20.0, 4000.0, 1e-3, 1.0, 0.0, 500_000)
        assert (found.defeated[i], found.perforated[i]) == pytest.approx((plain.low, plain.high), rel=1e-9)
        assert (found.runs[i], found.resolved[i]) == (plain.runs, plain.resolved)


def test_thinnest_ceramics_are_those_of_the_plain_search():
    found = batch.least_thicknesses(ROWS, VELOCITIES, 0.0, 0.1, 1e-8)
    for i, a in enumerate(DESIGNS[:40]):
        plain = least_ceramic_thickness(a, float(VELOCITIES[i]), 0.0, 0.1, 1e-8, 1.0, 0.0, 500_000)
        assert (found.defeated[i], found.perforated[i]) == pytest.approx((-plain.low, -plain.high), rel=1e-9)


def test_neither_threads_nor_order_count():
    one = batch.impacts(ROWS, VELOCITIES, batch.SolverOptions(threads=1))
    order = np.random.default_rng(2).permutation(len(ROWS))
    for threads in (1, 2, 5):
        other = batch.impacts(ROWS[order], VELOCITIES[order], batch.SolverOptions(threads=threads))
        for column, shuffled in zip(one, other, strict=True):
            np.testing.assert_array_equal(column[order], shuffled)
    limits = batch.ballistic_limits(ROWS, 20.0, 4000.0, 1e-2, batch.SolverOptions(threads=1))
    again = batch.ballistic_limits(ROWS[order], 20.0, 4000.0, 1e-2, batch.SolverOptions(threads=3))
    for there, here in zip(limits, again, strict=True):
        np.testing.assert_array_equal(there[order], here)


def test_rows_of_another_shape():
    for rows in (ROWS[:, :12], ROWS[0]):
        with pytest.raises(ValueError, match="rows must be of the shape"):
            batch.impacts(rows, VELOCITIES[: len(rows)])


def test_numbers_that_are_none_end():
    """Nothing is promised of them but that the search ends."""
    rows = ROWS[:3].copy()
    rows[0, 4], rows[1, 4], rows[2, 7] = np.nan, -0.01, np.nan
    assert len(batch.ballistic_limits(rows, 20.0, 4000.0, 1e-2, batch.SolverOptions(max_steps=2000)).perforated) == 3


def test_an_empty_batch():
    assert len(batch.impacts(ROWS[:0], VELOCITIES[:0]).V) == 0


def test_steps_that_do_not_suffice():
    found = batch.impacts(ROWS[:3], VELOCITIES[:3], batch.SolverOptions(max_steps=3))
    assert (found.outcome == Outcome.UNRESOLVED).all()
    assert not batch.ballistic_limits(ROWS[:3], 20.0, 4000.0, 1e-2, batch.SolverOptions(max_steps=3)).resolved.any()
