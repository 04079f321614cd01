"""Searches against bisection on the outcome."""

from math import inf

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core import search
from armour.core.run import TOLERANCE
from armour.core.search import (
    RunSettings,
    find_ballistic_limit,
    find_least_ceramic_thickness,
    impact,
    narrowed_change,
    scan,
)
from tests.helpers.cases import armour
from tests.helpers.runs import perforates, random_designs

COUNT, LIMITS, STEPS = 40, 15, 500_000
VELOCITIES = scan(20.0, 4000.0)
SOLVER = RunSettings(1.0, 0.0, STEPS, TOLERANCE)


def test_the_limits_are_those_of_scan_and_bisection():
    for p in random_designs(COUNT)[:LIMITS]:
        found = find_ballistic_limit(p, VELOCITIES, 1e-4, 1.0, 0.0, STEPS)
        above = next(i for i, velocity in enumerate(VELOCITIES) if found.high <= velocity)
        low, high = bisect(lambda v, p=p: perforates(p, v), VELOCITIES[above - 1], VELOCITIES[above], 1e-6)  # type: ignore[misc]
        assert found.low <= high
        assert found.high >= low
        assert found.high - found.low <= 1e-4
        assert found.resolved
        assert found.runs <= 20


def test_the_ends_of_a_fine_bracket_have_their_outcomes():
    """The residual energy vanishes some 5e-10 m/s below the change of the outcome."""
    p = armour("7.62 mm AP", "AD85", "6061-T6", 7.83, 7.24)
    for flow_stress in (5.238e9, 5.24e9, 5.248e9, 5.258e9):
        own = p._replace(Yc0=flow_stress)
        found = find_ballistic_limit(own, VELOCITIES, 1e-9, 1.0, 0.0, STEPS)
        assert perforates(own, found.high)
        assert not perforates(own, found.low)


def test_a_change_to_stop_is_narrowed():
    """Where a faster projectile is stopped again, the lower impact perforates."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-6, 1.0, 0.0, STEPS).high
    found = narrowed_change(p, impact(p, limit + 50.0, SOLVER), impact(p, limit - 50.0, SOLVER), 1e-3, SOLVER)
    assert found.low <= limit <= found.high
    assert found.high - found.low <= 1.2e-3


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
    assert found.resolved


def test_the_least_thickness_by_a_law_of_the_flow_stress():
    p = armour()._replace(n_B=0.4, n_cB=-0.3, a_c=0.2, a_B=-0.1)
    found = find_least_ceramic_thickness(p, 800.0, 0.0, 0.05, 1e-8, 1.0, 0.0, STEPS)
    assert perforates(p._replace(Hc0=-found.high), 800.0)
    assert not perforates(p._replace(Hc0=-found.low), 800.0)
    assert 0.0 < found.high - found.low <= 1e-8


def test_a_range_without_a_root():
    p = armour()
    slow = scan(20.0, 500.0)
    found = find_ballistic_limit(p, slow, 1e-3, 1.0, 0.0, STEPS)
    assert (found.low, found.high, found.resolved) == (500.0, inf, True)
    found = find_ballistic_limit(p, scan(900.0, 1500.0), 1e-3, 1.0, 0.0, STEPS)
    assert (found.low, found.high, found.resolved) == (-inf, 900.0, True)
    found = find_least_ceramic_thickness(p, 3000.0, 0.0, 0.01, 1e-8, 1.0, 0.0, STEPS)
    assert (found.low, found.high, found.resolved) == (-inf, -0.01, True)
    found = find_least_ceramic_thickness(p, 200.0, 0.002, 0.01, 1e-8, 1.0, 0.0, STEPS)
    assert (found.low, found.high, found.resolved) == (-0.002, inf, True)


@pytest.mark.parametrize("steps", [3, 21])
def test_an_unresolved_run_ends_the_search(steps: int):
    found = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, steps)
    assert found.low == found.high
    assert not found.resolved
    assert not find_least_ceramic_thickness(armour(), 800.0, 0.0, 0.01, 1e-8, 1.0, 0.0, steps).resolved


def test_a_tolerance_below_rounding_ends():
    found = find_ballistic_limit(armour(), VELOCITIES, 0.0, 1.0, 0.0, STEPS)
    assert found.high - found.low < 1e-9
    assert found.runs < 140


def test_the_residual_energy_continues_below_the_limit():
    """Its derivative is the same above and below; where a projectile stops alone, it only has the sign."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-8, 1.0, 0.0, STEPS).high
    f = [impact(p, limit + distance, SOLVER).f for distance in (-0.02, -0.01, 0.01, 0.02)]
    assert f[0] < f[1] < 0.0 < f[2] < f[3]
    assert f[2] - f[1] == pytest.approx(2.0 * (f[1] - f[0]), rel=1e-3)
    assert f[2] - f[1] == pytest.approx(2.0 * (f[3] - f[2]), rel=1e-3)
    assert impact(p, 100.0, SOLVER).f < 0.0


def test_a_scan_has_even_ratios_from_end_to_end():
    velocities = scan(20.0, 4000.0, 5)
    assert (velocities[0], velocities[-1], len(velocities)) == (20.0, 4000.0, 5)
    assert velocities[1:4] == pytest.approx([20.0 * 200.0 ** (i / 4) for i in (1, 2, 3)])
    assert len(VELOCITIES) == search.SCAN_POINTS
