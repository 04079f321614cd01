"""Searches that use residual velocities, against bisection on the outcome."""

from math import inf

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.run import run
from armour.core.search import (
    Bracket,
    Found,
    ballistic_limit_of,
    defeated,
    extrapolated_root,
    first_guess,
    is_narrow,
    least_ceramic_thickness,
    opened,
    perforated,
    proposed,
    time_step,
    with_ceramic,
)
from armour.core.stages import default_time_step
from armour.core.state import Outcome, Parameters
from tests.cases import armour
from tests.numerics.test_independent import random_designs

DESIGNS = random_designs(60)
STEPS = 500_000


def is_perforated(a: Parameters, velocity: float) -> bool:
    return run(a, velocity, default_time_step(a, velocity), 1.0, STEPS).outcome == Outcome.PERFORATED


@pytest.mark.parametrize("index", range(len(DESIGNS)))
def test_the_limit_is_that_of_bisection_in_few_runs(index: int):
    a = DESIGNS[index]
    found = ballistic_limit_of(a, 20.0, 4000.0, 1e-4, 1.0, 0.0, STEPS)
    low, high = bisect(lambda velocity: is_perforated(a, velocity), 20.0, 4000.0, 1e-6)
    assert found.low <= high
    assert low <= found.high
    assert 0.0 < found.high - found.low <= 1e-4
    assert is_perforated(a, found.high)
    assert not is_perforated(a, found.low)
    assert found.runs <= 24
    assert found.resolved


def test_the_runs_are_few_on_average():
    runs = [ballistic_limit_of(a, 20.0, 4000.0, 2e-4, 1.0, 0.0, STEPS).runs for a in DESIGNS]
    assert sum(runs) / len(runs) < 8.5


@pytest.mark.parametrize("index", range(0, len(DESIGNS), 2))
def test_the_thinnest_ceramic_is_that_of_bisection(index: int):
    a = DESIGNS[index]
    thick = 10.0 * a.D0
    found = least_ceramic_thickness(a, 700.0, 0.0, thick, 1e-8, 1.0, 0.0, STEPS)
    if not is_perforated(with_ceramic(a, 0.0), 700.0):
        assert (found.low, found.high) == (0.0, inf)
        return
    _, high = bisect(lambda h: not is_perforated(with_ceramic(a, h), 700.0), 0.0, thick, 1e-9)
    assert -found.low == pytest.approx(high, abs=2e-8)
    assert 0.0 < found.high - found.low <= 1e-8
    assert found.runs <= 60


def test_no_place_in_the_range():
    a = armour()
    assert ballistic_limit_of(a, 20.0, 500.0, 1e-3, 1.0, 0.0, STEPS)[:2] == (500.0, inf)
    assert ballistic_limit_of(a, 900.0, 1500.0, 1e-3, 1.0, 0.0, STEPS)[:2] == (-inf, 900.0)
    assert least_ceramic_thickness(a, 3000.0, 0.0, 0.01, 1e-8, 1.0, 0.0, STEPS)[:2] == (-inf, -0.01)
    assert least_ceramic_thickness(a, 200.0, 0.002, 0.01, 1e-8, 1.0, 0.0, STEPS)[:2] == (-0.002, inf)


def test_a_run_that_is_given_up_ends_the_search():
    assert ballistic_limit_of(armour(), 20.0, 4000.0, 1e-3, 1.0, 0.0, 10) == Found(-inf, inf, 1, False)
    assert least_ceramic_thickness(armour(), 800.0, 0.0, 0.01, 1e-8, 1.0, 0.0, 10) == Found(-inf, inf, 1, False)


def test_a_tolerance_below_rounding_ends():
    found = ballistic_limit_of(armour(), 20.0, 4000.0, 0.0, 1.0, 0.0, STEPS)
    assert found.high - found.low < 1e-12
    assert found.runs < 120


def test_the_first_guess_is_near():
    for a in DESIGNS:
        limit = ballistic_limit_of(a, 20.0, 4000.0, 1e-2, 1.0, 0.0, STEPS).high
        assert 0.5 < first_guess(a) / limit < 2.0


def test_vanishing_is_exact_for_lines_and_parabolas_of_f():
    def place(f: float) -> float:
        return 700.0 + 0.3 * f - 0.02 * f * f

    assert extrapolated_root(1, 700.3, 1.0, 700.6, 2.0, 0.0, 0.0) == pytest.approx(700.0)
    assert extrapolated_root(2, place(1.0), 1.0, place(2.0), 2.0, place(5.0), 5.0) == pytest.approx(700.0)
    assert extrapolated_root(1, 700.0, 1.0, 710.0, 1.0, 0.0, 0.0) == 700.0


def test_what_a_bracket_keeps():
    b = perforated(opened(0.0, 1000.0), 800.0, 100.0, 750.0)
    assert (b.high, b.high_known, b.low_known, b.places, b.estimate, b.runs) == (800.0, True, False, 1, 750.0, 1)
    b = defeated(b, 740.0)
    assert (b.low, b.low_known, b.runs) == (740.0, True, 2)
    b = perforated(b, 760.0, 20.0, 0.0)
    assert b.estimate == pytest.approx(750.0)
    assert b.error == pytest.approx(0.0)
    assert (b.x1, b.f1, b.x2, b.f2) == (760.0, 20.0, 800.0, 100.0)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-3, 1.0])
def test_a_proposal_is_inside_the_bracket(tolerance: float):
    for estimate in (-1e9, 700.0, 749.9999, 750.0, 750.0001, 799.9999, 800.0, 1e9):
        for error in (0.0, 1e-9, 1.0, 1e9, inf):
            for places in (1, 2, 3):
                for runs in (5, 50):
                    b = Bracket(750.0, 800.0, True, True, places, 800.0, 1.0, 810.0, 2.0, estimate, error, runs)
                    assert 750.0 < proposed(b, tolerance) < 800.0


def test_narrow_enough():
    b = Bracket(750.0, 750.5, True, True, 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1)
    assert is_narrow(b, 0.5)
    assert not is_narrow(b, 0.4)
    assert not is_narrow(b._replace(low_known=False), 0.5)
    assert is_narrow(b._replace(high=750.0000000000001), 0.0)


def test_a_time_step_that_is_given():
    a = armour()
    default = default_time_step(a, 800.0)
    assert time_step(a, 800.0, 0.0) == default
    assert time_step(a, 800.0, 0.1 * default) == 0.1 * default
    assert time_step(a, 800.0, 100.0 * default) == 1.6 * default
