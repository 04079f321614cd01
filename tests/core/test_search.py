"""Searches by interpolation, against bisection on the outcome."""

from math import inf, nextafter

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core.bounds import may_perforate
from armour.core.search import (
    Bracket,
    SearchResult,
    Solver,
    after_defeat,
    after_perforation,
    bisected,
    extrapolated_root,
    find_ballistic_limit,
    find_least_ceramic_thickness,
    first_impacts,
    impact,
    initial_bracket,
    is_converged,
    next_point,
    rough_impact,
    rough_root,
    scan,
    scanned_impact,
    slope_at_root,
)
from tests.helpers.cases import armour
from tests.helpers.runs import perforates, random_designs

COUNT = 40
LIMITS = 15
STEPS = 500_000
VELOCITIES = scan(20.0, 4000.0)


def test_the_limits_are_those_of_scan_and_bisection_in_few_runs():
    runs = []
    for p in random_designs(COUNT)[:LIMITS]:
        found = find_ballistic_limit(p, VELOCITIES, 1e-4, 1.0, 0.0, STEPS)
        above = next(i for i, velocity in enumerate(VELOCITIES) if found.high <= velocity)
        ends = VELOCITIES[above - 1], VELOCITIES[above]
        assert found[:2] == bisect(lambda velocity, p=p: perforates(p, velocity), *ends, 1e-4)  # type: ignore[misc]
        assert found.resolved
        scanned = sum(may_perforate(p, velocity) for velocity in VELOCITIES[:above]) + 2
        runs.append(found.runs - scanned)
    assert max(runs) <= 12
    assert sum(runs) / len(runs) < 7


def test_an_interval_of_bisection():
    for x, expected in ((0.0, (0.0, 0.125)), (0.3, (0.25, 0.375)), (0.375, (0.375, 0.5)), (1.0, (0.875, 1.0))):
        assert bisected(x, 0.0, 1.0, 0.2) == expected
    low, high = bisected(0.3, 0.0, 1.0, 0.0)
    assert low <= 0.3 < high == nextafter(low, 1.0)


@pytest.mark.parametrize("index", range(0, COUNT, 2))
def test_the_least_thickness_is_that_of_bisection(index: int):
    p = random_designs(COUNT)[index]
    thick = 10.0 * p.D0
    found = find_least_ceramic_thickness(p, 700.0, 0.0, thick, 1e-8, 1.0, 0.0, STEPS)
    if not perforates(p._replace(Hc0=0.0), 700.0):
        assert (found.low, found.high) == (0.0, inf)
        return
    _, high = bisect(lambda Hc0: not perforates(p._replace(Hc0=Hc0), 700.0), 0.0, thick, 1e-9)
    assert -found.low == pytest.approx(high, abs=2e-8)
    assert 0.0 < found.high - found.low <= 1e-8
    assert found.runs <= 60


def test_the_least_thickness_by_a_law_of_the_flow_stress():
    p = armour()._replace(n_B=0.4, n_cB=-0.3, a_c=0.2, a_B=-0.1)
    found = find_least_ceramic_thickness(p, 800.0, 0.0, 0.05, 1e-8, 1.0, 0.0, STEPS)
    assert perforates(p._replace(Hc0=-found.high), 800.0)
    assert not perforates(p._replace(Hc0=-found.low), 800.0)
    assert 0.0 < found.high - found.low <= 1e-8


def test_a_range_without_a_root():
    p = armour()
    assert find_ballistic_limit(p, scan(20.0, 500.0), 1e-3, 1.0, 0.0, STEPS)[:2] == (500.0, inf)
    assert find_ballistic_limit(p, scan(900.0, 1500.0), 1e-3, 1.0, 0.0, STEPS)[:2] == (-inf, 900.0)
    assert find_least_ceramic_thickness(p, 3000.0, 0.0, 0.01, 1e-8, 1.0, 0.0, STEPS)[:2] == (-inf, -0.01)
    assert find_least_ceramic_thickness(p, 200.0, 0.002, 0.01, 1e-8, 1.0, 0.0, STEPS)[:2] == (-0.002, inf)


def test_an_unresolved_run_ends_the_search():
    unresolved = SearchResult(-inf, inf, 1, False)
    found = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, 3)
    assert found == SearchResult(found.low, found.low, 1, False)
    assert not may_perforate(armour(), found.low)
    found = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, 21)
    assert found.low == found.high > VELOCITIES[0]
    assert not found.resolved
    assert find_least_ceramic_thickness(armour(), 800.0, 0.0, 0.01, 1e-8, 1.0, 0.0, 10) == unresolved


def test_a_tolerance_below_rounding_ends():
    found = find_ballistic_limit(armour(), VELOCITIES, 0.0, 1.0, 0.0, STEPS)
    assert found.high - found.low < 1e-12
    assert found.runs < 120


def test_extrapolation_is_exact_for_lines_and_parabolas():
    def x(f: float) -> float:
        return 700.0 + 0.3 * f - 0.02 * f * f

    assert extrapolated_root(1, 700.3, 1.0, 700.6, 2.0, 0.0, 0.0) == pytest.approx(700.0)
    assert extrapolated_root(2, x(1.0), 1.0, x(2.0), 2.0, x(5.0), 5.0) == pytest.approx(700.0)
    assert extrapolated_root(1, 700.0, 1.0, 710.0, 1.0, 0.0, 0.0) == 700.0


def test_the_slope_at_the_root_is_that_of_the_parabola():
    def x(f: float) -> float:
        return 700.0 + 0.3 * f - 0.02 * f * f

    assert slope_at_root(700.0, x(1.0), 1.0, x(3.0), 3.0) == pytest.approx(0.3)


def test_a_bracket_after_runs():
    b = after_perforation(initial_bracket(0.0, 1000.0), 800.0, 100.0, 750.0, 7.0)
    assert (b.high, b.high_known, b.low_known, b.points, b.runs) == (800.0, True, False, 1, 1)
    assert (b.estimate, b.error) == (750.0, 7.0)
    b = after_defeat(b, 740.0)
    assert (b.low, b.low_known, b.runs) == (740.0, True, 2)
    b = after_perforation(b, 760.0, 20.0, 0.0, 0.0)
    assert b.estimate == pytest.approx(750.0)
    assert b.error == pytest.approx(0.0)
    assert (b.x1, b.f1, b.x2, b.f2) == (760.0, 20.0, 800.0, 100.0)


SOLVER = Solver(1.0, 0.0, STEPS)


def test_a_scan_starts_at_the_highest_velocity_without_the_energy_to_perforate():
    before, start = first_impacts(armour(), VELOCITIES, SOLVER)
    i = VELOCITIES.index(start.V)
    assert not may_perforate(armour(), VELOCITIES[i])
    assert may_perforate(armour(), VELOCITIES[i + 1])
    assert (before.V, before.nearness) == (VELOCITIES[i - 1], -inf)
    fast = scan(600.0, 4000.0)
    before, start = first_impacts(armour(), fast, SOLVER)
    assert before == start
    assert start.V == 600.0
    slow = scan(20.0, 60.0)
    assert first_impacts(armour(), slow, SOLVER)[1].V == 60.0


def test_a_rough_impact_is_repeated_where_it_is_close():
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-3, 1.0, 0.0, STEPS).high
    for V in (limit - 0.01, limit + 0.01):
        assert scanned_impact(p, V, SOLVER) == impact(p, V, SOLVER)
    for V in (0.9 * limit, 1.1 * limit):
        assert scanned_impact(p, V, SOLVER) == rough_impact(p, V, SOLVER) != impact(p, V, SOLVER)


def test_rough_runs_do_not_use_a_time_step_that_is_given():
    p = armour()
    assert rough_impact(p, 800.0, Solver(1.0, 1e-10, 1000)) == rough_impact(p, 800.0, SOLVER)


@pytest.mark.parametrize("tolerance", [1e-8, 1e-3, 0.5, 50.0])
def test_the_bracket_is_an_interval_of_bisection(tolerance: float):
    p = armour()
    found = find_ballistic_limit(p, VELOCITIES, tolerance, 1.0, 0.0, STEPS)
    above = next(i for i, velocity in enumerate(VELOCITIES) if found.high <= velocity)
    inside = 0.5 * (found.low + found.high)
    assert found[:2] == bisected(inside, VELOCITIES[above - 1], VELOCITIES[above], tolerance)
    assert perforates(p, found.high)
    assert not perforates(p, found.low)


def test_a_rough_root_is_near_the_limit():
    for p in random_designs(COUNT)[:LIMITS]:
        found = find_ballistic_limit(p, VELOCITIES, 1e-4, 1.0, 0.0, STEPS)
        above = next(velocity for velocity in VELOCITIES if found.high <= velocity)
        below = VELOCITIES[VELOCITIES.index(above) - 1]
        root = rough_root(p, below, above, rough_impact(p, above, SOLVER), 1.0, SOLVER)
        assert root.x == pytest.approx(found.high, rel=3e-4)
        nearness = [impact(p, found.high + more, SOLVER).nearness for more in (0.1, 0.2)]
        assert root.slope == pytest.approx(0.1 / (nearness[0] - nearness[1]), rel=0.02)


def known_bracket(low: float, high: float) -> Bracket:
    """A bracket with a run at each end."""
    return initial_bracket(low, high)._replace(low_known=True, high_known=True)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("points", [1, 2, 3])
@pytest.mark.parametrize("runs", [5, 50])
def test_the_next_point_is_inside_the_bracket(tolerance: float, points: int, runs: int):
    for estimate in (-1e9, 700.0, 749.9999, 750.0, 750.0001, 799.9999, 800.0, 1e9):
        for error in (0.0, 1e-9, 1.0, 1e9, inf):
            b = known_bracket(750.0, 800.0)._replace(points=points, estimate=estimate, error=error, runs=runs)
            assert 750.0 < next_point(b, tolerance) < 800.0


def test_convergence():
    b = known_bracket(750.0, 750.5)
    assert is_converged(b, 0.5)
    assert not is_converged(b, 0.4)
    assert not is_converged(b._replace(low_known=False), 0.5)
    assert is_converged(b._replace(high=750.0000000000001), 0.0)
