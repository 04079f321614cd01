"""Searches against bisection on the outcome."""

from collections.abc import Callable
from math import inf

import pytest

from armour.core import search
from armour.core.run import TOLERANCE
from armour.core.search import (
    RunSettings,
    Trial,
    find_ballistic_limit,
    impact,
    narrowed_change,
    scan,
)
from armour.core.state import Parameters
from tests.helpers.bisection import bisect
from tests.helpers.cases import armour
from tests.helpers.runs import perforates, random_designs

LIMITS, STEPS = 15, 500_000
VELOCITIES = scan(20.0, 4000.0)
SOLVER = RunSettings(1.0, 0.0, STEPS, TOLERANCE)


def test_the_limits_are_those_of_scan_and_bisection():
    for p in random_designs(LIMITS):
        result = find_ballistic_limit(p, VELOCITIES, 1e-4, 1.0, 0.0, STEPS)
        above = next(i for i, velocity in enumerate(VELOCITIES) if result.high <= velocity)
        low, high = bisect(lambda v, p=p: perforates(p, v), VELOCITIES[above - 1], VELOCITIES[above], 1e-6)  # type: ignore[misc]
        assert result.low <= high
        assert result.high >= low
        assert result.high - result.low <= 1e-4
        assert result.resolved
        assert result.runs <= 20


def test_the_ends_of_a_fine_bracket_have_their_outcomes():
    """The residual energy vanishes some 5e-10 m/s below the change of the outcome."""
    p = armour("7.62 mm AP", "AD85", "6061-T6", 7.83, 7.24)
    for flow_stress in (5.238e9, 5.24e9, 5.248e9, 5.258e9):
        harder = p._replace(Yc0=flow_stress)
        result = find_ballistic_limit(harder, VELOCITIES, 1e-9, 1.0, 0.0, STEPS)
        assert perforates(harder, result.high)
        assert not perforates(harder, result.low)


def test_a_change_to_stop_is_narrowed():
    """Where a faster projectile is stopped again, the lower impact perforates."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-6, 1.0, 0.0, STEPS).high
    result = narrowed_change(p, impact(p, limit + 50.0, SOLVER), impact(p, limit - 50.0, SOLVER), 1e-3, SOLVER)
    assert result.low <= limit <= result.high
    assert result.high - result.low <= 1.2e-3


def test_a_range_without_a_root():
    p = armour()
    slow = scan(20.0, 500.0)
    result = find_ballistic_limit(p, slow, 1e-3, 1.0, 0.0, STEPS)
    assert (result.low, result.high, result.resolved) == (500.0, inf, True)
    result = find_ballistic_limit(p, scan(900.0, 1500.0), 1e-3, 1.0, 0.0, STEPS)
    assert (result.low, result.high, result.resolved) == (-inf, 900.0, True)


@pytest.mark.parametrize("steps", [3, 21])
def test_an_unresolved_run_ends_the_search(steps: int):
    result = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, steps)
    assert result.low == result.high
    assert not result.resolved


class Impacts:
    """Impacts whose outcome is a function of the velocity, which it counts."""

    def __init__(self, perforates: Callable[[float], bool], unresolved: tuple[float, float] = (inf, inf)) -> None:
        self.perforates, self.unresolved, self.count = perforates, unresolved, 0

    def at_velocity(self, _p: Parameters, V: float, _solver: RunSettings) -> Trial:
        self.count += 1
        resolved = not self.unresolved[0] <= V <= self.unresolved[1]
        perforated = resolved and self.perforates(V)
        return Trial(V, perforated, resolved, 1.0 if perforated else -1.0)


FAST = scan(1000.0, 4000.0)  # no velocity lacks the energy to perforate


@pytest.mark.parametrize(
    ("change", "unresolved", "low", "high"),
    [
        (inf, (inf, inf), 4000.0, inf),
        (0.0, (inf, inf), -inf, 1000.0),
        (2500.0, (900.0, 1000.0), 1000.0, 1000.0),
        (2500.0, (2000.0, 2100.0), 2000.0, 2000.0),
        (2500.0, (2499.0, 2501.0), 2500.0, 2500.0),
    ],
)
def test_every_run_of_a_search_is_counted(monkeypatch: pytest.MonkeyPatch, change, unresolved, low, high):
    impacts = Impacts(lambda V: change < V, unresolved)
    monkeypatch.setattr(search, "impact", impacts.at_velocity)
    result = find_ballistic_limit(armour(), FAST, 0.01, 1.0, 0.0, STEPS)
    assert result.low == pytest.approx(low, abs=1.0)
    assert result.high == pytest.approx(high, abs=1.0)
    assert result.resolved is (unresolved[0] == inf)
    assert result.low == result.high or result.resolved
    assert result.runs == impacts.count


def test_a_change_is_as_narrow_as_its_tolerance(monkeypatch: pytest.MonkeyPatch):
    for tolerance in (1.0, 0.01):
        impacts = Impacts(lambda V: V > 2500.0)
        monkeypatch.setattr(search, "impact", impacts.at_velocity)
        result = find_ballistic_limit(armour(), FAST, tolerance, 1.0, 0.0, STEPS)
        assert result.low <= 2500.0 <= result.high
        assert result.high - result.low <= 1.01 * tolerance
        assert result.runs == impacts.count


def test_usual_runs_that_contradict_the_rough_ones_scan_again(monkeypatch: pytest.MonkeyPatch):
    """The rough runs see a change at 1,500 m/s, the usual ones at 2,500."""
    rough, usual = Impacts(lambda V: V > 1500.0), Impacts(lambda V: V > 2500.0)
    monkeypatch.setattr(
        search,
        "impact",
        lambda p, V, solver: (rough if solver.tolerance > TOLERANCE else usual).at_velocity(p, V, solver),
    )
    result = find_ballistic_limit(armour(), FAST, 0.01, 1.0, 0.0, STEPS)
    assert result.low <= 2500.0 <= result.high <= result.low + 0.0101
    assert result.runs == rough.count + usual.count


def test_a_tolerance_below_rounding_ends():
    result = find_ballistic_limit(armour(), VELOCITIES, 0.0, 1.0, 0.0, STEPS)
    assert result.high - result.low < 1e-9
    assert result.runs < 140


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
