"""Compiled results are those of plain Python, bit by bit, in any order and number of threads."""

from functools import cache

import numpy as np
import pytest

from armour.core.run import run
from armour.core.search import find_ballistic_limit, scan
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from tests.helpers.runs import random_designs

COUNT = 300


@cache
def designs(count: int) -> tuple[Parameters, ...]:
    """Random armours, every other one with a law of the ceramic's flow stress."""
    laws = np.random.default_rng(3).uniform(-1.0, 1.0, (count, 4)).tolist()
    return tuple(
        p._replace(n_B=law[0], n_cB=law[1], a_c=law[2], a_B=law[3]) if i % 2 else p
        for i, (p, law) in enumerate(zip(random_designs(count), laws, strict=True))
    )


@pytest.fixture(scope="module")
def rows() -> batch.Floats:
    return batch.packed(designs(COUNT))


@pytest.fixture(scope="module")
def velocities() -> batch.Floats:
    return np.asarray(np.random.default_rng(1).uniform(200.0, 1500.0, COUNT))


@pytest.mark.slow
def test_impacts_are_those_of_plain_python():
    """Of tiles and bare plates, by every law, with steps that are given and events at the ends of steps."""
    armours, rng = designs(600), np.random.default_rng(1)
    for part, dt in ((slice(500), 0.0), (slice(500, 600), 2e-6)):
        some = armours[part]
        velocities = rng.uniform(200.0, 1500.0, len(some)).round(-1)
        found = batch.impacts(batch.packed(some), velocities, batch.DEFAULT_SETTINGS._replace(dt=dt))
        ends = [run(p, V, dt, 1.0, 500_000) for p, V in zip(some, velocities.tolist(), strict=True)]
        expected = [(end.outcome, end.t, *end.y, end.steps) for end in ends]
        assert list(zip(*(column.tolist() for column in found), strict=True)) == expected


@pytest.mark.slow
def test_ballistic_limits_are_those_of_plain_python():
    armours = designs(40)
    found = batch.ballistic_limits(batch.packed(armours), 20.0, 4000.0, 1e-3)
    plain = [find_ballistic_limit(p, scan(20.0, 4000.0), 1e-3, 1.0, 0.0, 500_000) for p in armours]
    assert list(zip(*(column.tolist() for column in found), strict=True)) == [tuple(limit) for limit in plain]


def test_results_depend_neither_on_threads_nor_on_order(rows: batch.Floats, velocities: batch.Floats):
    one = batch.impacts(rows, velocities, threads=1)
    order = np.random.default_rng(2).permutation(COUNT)
    for threads in (1, 2, 5):
        other = batch.impacts(rows[order], velocities[order], threads=threads)
        for column, shuffled in zip(one, other, strict=True):
            np.testing.assert_array_equal(column[order], shuffled)
    limits = batch.ballistic_limits(rows, 20.0, 4000.0, 1e-2, threads=1)
    again = batch.ballistic_limits(rows[order], 20.0, 4000.0, 1e-2, threads=3)
    for limit, shuffled_limit in zip(limits, again, strict=True):
        np.testing.assert_array_equal(limit[order], shuffled_limit)


def test_arrays_of_any_layout(rows: batch.Floats):
    """Columns in Fortran's order, an array that cannot be written, one velocity for all, and integers."""
    expected = batch.impacts(rows, np.full(COUNT, 700.0)).V
    fixed = rows.copy()
    fixed.flags.writeable = False
    for made, velocity in (
        (np.asfortranarray(rows), np.full(COUNT, 700.0)),
        (fixed, np.broadcast_to(700.0, COUNT)),
        (rows, np.array([700])),
        (np.repeat(rows, 2, axis=0)[::2], np.full(2 * COUNT, 700.0)[::2]),
    ):
        np.testing.assert_array_equal(batch.impacts(made, velocity).V, expected)


def test_searches_of_invalid_numbers_end(rows: batch.Floats):
    invalid = rows[:3].copy()
    invalid[0, 4], invalid[1, 4], invalid[2, 7] = np.nan, -0.01, np.nan
    assert (
        len(batch.ballistic_limits(invalid, 20.0, 4000.0, 1e-2, batch.DEFAULT_SETTINGS._replace(max_steps=2000)).runs)
        == 3
    )


def test_impacts_that_reach_the_maximum_number_of_steps(rows: batch.Floats, velocities: batch.Floats):
    found = batch.impacts(rows[:3], velocities[:3], batch.DEFAULT_SETTINGS._replace(max_steps=3))
    assert (found.outcome == Outcome.UNRESOLVED).all()
    assert not batch.ballistic_limits(
        rows[:3], 20.0, 4000.0, 1e-2, batch.DEFAULT_SETTINGS._replace(max_steps=3)
    ).resolved.any()
