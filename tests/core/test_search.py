"""Searches by interpolation, against bisection on the outcome."""

from collections.abc import Callable
from math import inf
from typing import Any

import pytest

from armour.analysis.ballistic_limit import bisect
from armour.core import search
from armour.core.bounds import may_perforate
from armour.core.events import ERODED_FRACTION
from armour.core.run import run
from armour.core.search import (
    ENERGY_LEFT,
    GOLDEN,
    NEAR,
    Change,
    Impact,
    Root,
    SearchResult,
    Solver,
    bisected,
    change_at_peak,
    change_between_causes,
    find_ballistic_limit,
    find_least_ceramic_thickness,
    first_impacts,
    impact,
    narrowed,
    next_change,
    rough_impact,
    rough_root,
    scan,
    scanned_impact,
)
from armour.core.state import Parameters
from armour.core.stepping import time_step
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
        runs.append(found.runs)
    assert max(runs) <= 15
    assert sum(runs) / len(runs) <= 9.0


def test_the_ends_of_a_fine_bracket_have_their_outcomes():
    """The residual energy vanishes some 5e-10 m/s below the change of the outcome."""
    p = armour("7.62 mm AP", "AD85", "6061-T6", 7.83, 7.24)
    for flow_stress in (5.238e9, 5.24e9, 5.248e9, 5.258e9):
        own = p._replace(Yc0=flow_stress)
        found = find_ballistic_limit(own, VELOCITIES, 1e-9, 1.0, 0.0, STEPS)
        assert perforates(own, found.high)
        assert not perforates(own, found.low)


def test_the_least_thickness_takes_few_runs():
    runs = [
        find_least_ceramic_thickness(p, 700.0, 0.0, 10.0 * p.D0, 1e-8, 1.0, 0.0, STEPS).runs
        for p in random_designs(COUNT)[1::2]
    ]
    assert sum(runs) / len(runs) < 10.0
    assert max(runs) <= 15


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
    assert found == (500.0, inf, found.runs, True)
    assert found.runs <= sum(may_perforate(p, velocity) for velocity in slow) + 1
    assert find_ballistic_limit(p, scan(900.0, 1500.0), 1e-3, 1.0, 0.0, STEPS) == (-inf, 900.0, 1, True)
    assert find_least_ceramic_thickness(p, 3000.0, 0.0, 0.01, 1e-8, 1.0, 0.0, STEPS) == (-inf, -0.01, 3, True)
    assert find_least_ceramic_thickness(p, 200.0, 0.002, 0.01, 1e-8, 1.0, 0.0, STEPS) == (-0.002, inf, 1, True)


def test_an_unresolved_run_ends_the_search():
    unresolved = SearchResult(-inf, inf, 1, False)
    found = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, 3)
    assert found == SearchResult(found.low, found.low, 1, False)
    assert not may_perforate(armour(), found.low)
    found = find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, 21)
    assert found.low == found.high > VELOCITIES[0]
    assert not found.resolved
    assert find_least_ceramic_thickness(armour(), 800.0, 0.0, 0.01, 1e-8, 1.0, 0.0, 10) == unresolved


def test_an_unresolved_run_ends_the_search_for_a_thickness_wherever_it_comes(monkeypatch: pytest.MonkeyPatch):
    made, usual = 0, search.impact

    def counted(p: Parameters, V: float, solver: Solver) -> Impact:
        nonlocal made
        made += 1
        return usual(p, V, solver)

    monkeypatch.setattr(search, "impact", counted)
    seen = set()
    for steps in range(10, 60):
        made = 0
        found = find_least_ceramic_thickness(armour(), 800.0, 0.0, 0.02, 1e-8, 1.0, 0.0, steps)
        assert found.runs == made
        if not found.resolved:
            assert found == SearchResult(-inf, inf, made, False)
        seen.add((found.resolved, made > 1))
    assert seen == {(False, False), (False, True), (True, True)}


def test_a_tolerance_below_rounding_ends():
    found = find_ballistic_limit(armour(), VELOCITIES, 0.0, 1.0, 0.0, STEPS)
    assert found.high - found.low < 1e-12
    assert found.runs < 120


SOLVER = Solver(1.0, 0.0, STEPS)


def test_a_scan_starts_at_the_highest_velocity_without_the_energy_to_perforate():
    before, start = first_impacts(armour(), VELOCITIES, SOLVER)
    i = VELOCITIES.index(start.V)
    assert not may_perforate(armour(), VELOCITIES[i])
    assert may_perforate(armour(), VELOCITIES[i + 1])
    assert before == Impact(VELOCITIES[i - 1], False, start.eroded, True, -inf, -inf)
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


def stopped(V: float, nearness: float = 0.0, eroded: bool = False) -> Impact:
    return Impact(V, False, eroded, True, nearness, -inf)


def scanned_as(monkeypatch: pytest.MonkeyPatch, given: Callable[[float], Impact]) -> list[float]:
    """Replace the impacts of a scan by given ones, and return the list of the velocities to come."""
    velocities = []

    def scanned(p: Parameters, V: float, solver: Solver) -> Impact:
        assert (p, solver) == (armour(), SOLVER)
        velocities.append(V)
        return given(V)

    monkeypatch.setattr(search, "scanned_impact", scanned)
    return velocities


def hill(V: float) -> Impact:
    """Impacts of greatest depth at 250 m/s."""
    return stopped(V, -((V - 250.0) ** 2))


@pytest.mark.parametrize("resolved", [True, False])
def test_a_search_of_a_peak_ends_at_the_other_outcome(monkeypatch: pytest.MonkeyPatch, resolved: bool):
    def given(V: float) -> Impact:
        return Impact(V, resolved, False, resolved, -1.0, 1.0) if abs(V - 250.0) < 5.0 else hill(V)

    velocities = scanned_as(monkeypatch, given)
    found = change_at_peak(armour(), hill(100.0), hill(200.0), hill(400.0), SOLVER)
    assert found == Change(hill(200.0), given(velocities[-1]), 3)
    velocities = scanned_as(monkeypatch, given)
    above = change_at_peak(armour(), hill(230.0), hill(240.0), hill(265.0), SOLVER)
    assert above == Change(hill(240.0), given(240.0 + 25.0 * GOLDEN), 1)


@pytest.mark.parametrize("resolved", [True, False])
def test_a_search_between_causes_ends_at_a_perforation(monkeypatch: pytest.MonkeyPatch, resolved: bool):
    def given(V: float) -> Impact:
        return Impact(V, resolved, False, resolved, -1.0, 1.0) if abs(V - 130.0) < 2.0 else stopped(V, eroded=V > 130.0)

    scanned_as(monkeypatch, given)
    found = change_between_causes(armour(), stopped(100.0), stopped(200.0, eroded=True), SOLVER)
    assert found == Change(stopped(125.0), given(131.25), 4)


def changes(monkeypatch: pytest.MonkeyPatch, given: list[Impact], hidden: Impact | None = None) -> tuple[Change, Any]:
    """The lowest change of given impacts, the first two before the search; and what is searched between them."""
    searched = []

    def between(p: Parameters, *impacts: Any) -> Change:
        assert (p, impacts[-1]) == (armour(), SOLVER)
        searched.append(impacts[:-1])
        return Change(impacts[-3], hidden or impacts[-3], 10)

    scanned_as(monkeypatch, lambda V: next(i for i in given if V == i.V))

    def usual(p: Parameters, V: float, solver: Solver) -> Impact:
        assert (p, solver) == (armour(), SOLVER)
        return next(i for i in [hidden, *given] if i and V == i.V)

    monkeypatch.setattr(search, "impact", usual)
    monkeypatch.setattr(search, "change_at_peak", between)
    monkeypatch.setattr(search, "change_between_causes", between)
    velocities = [5.0, *(i.V for i in given)]
    return next_change(armour(), given[0], given[1], velocities, SOLVER), searched


def test_a_scan_ends_at_a_change_or_an_unresolved_run(monkeypatch: pytest.MonkeyPatch):
    rising = [stopped(10.0 * i, float(i)) for i in range(1, 6)]
    perforated = Impact(60.0, True, False, True, -1.0, 1.0)
    for end in (perforated, perforated._replace(perforated=False, resolved=False)):
        assert changes(monkeypatch, [*rising, end]) == (Change(rising[-1], end, 4), [])
    assert changes(monkeypatch, rising) == (Change(rising[-1], rising[-1], 3), [])
    falling = [Impact(10.0 * i, True, False, True, -float(i), float(i)) for i in range(1, 6)]
    assert changes(monkeypatch, [*falling, stopped(60.0)]) == (Change(falling[-1], stopped(60.0), 4), [])


def test_a_change_between_near_velocities_is_confirmed(monkeypatch: pytest.MonkeyPatch):
    """Rough runs say that the outcome changes at 130 and at 150 m/s; by usual ones, it changes at 101 alone."""

    def rough(V: float) -> Impact:
        return Impact(V, 130.0 <= V < 131.0 or V >= 150.0, False, True, -1.0, 1.0)

    def usual(_p: Parameters, V: float, _solver: Solver) -> Impact:
        repeated.append(V)
        return Impact(V, limit <= V, False, True, -1.0, 1.0)

    repeated: list[float] = []
    scanned = scanned_as(monkeypatch, rough)
    monkeypatch.setattr(search, "impact", usual)
    velocities = [100.0 * 1.01**i for i in range(60)]
    limit, start = 140.0, stopped(100.0)
    found = next_change(armour(), start, start, velocities, SOLVER)
    assert found.below.V < limit <= found.above.V < 1.02 * found.below.V
    assert found.runs == len(scanned) + len(repeated) > len(scanned) + 3
    limit = 99.0
    found = next_change(armour(), start, start, velocities, SOLVER)
    assert found.below.V < limit <= found.above.V
    limit = 160.0
    assert limit < next_change(armour(), start, start, velocities, SOLVER).above.V


def test_a_change_is_confirmed_downwards_to_the_start_of_the_scan(monkeypatch: pytest.MonkeyPatch):
    """By steps of the ratio of the two velocities between which rough runs saw it."""

    def usual(p: Parameters, V: float, solver: Solver) -> Impact:
        assert (p, solver) == (armour(), SOLVER)
        tried.append(V)
        return Impact(V, limits[-1] < V, False, abs(V - unresolved) > 0.1, 0.0, 0.0)

    monkeypatch.setattr(search, "impact", usual)
    rough = Change(stopped(121.0), Impact(133.1, True, False, True, -1.0, 1.0), 0)
    limits = []
    for limit, unresolved, below in (
        (125.0, 0.0, [121.0]),
        (105.0, 0.0, [121.0, 110.0, 103.0]),
        (99.0, 0.0, [121.0, 110.0, 103.0, 103.0 / 1.1]),
        (0.0, 110.0, [121.0, 110.0]),
        (140.0, 0.0, []),
        (0.0, 133.1, []),
    ):
        limits.append(limit)
        tried: list[float] = []
        found = search.confirmed(armour(), stopped(103.0), rough, SOLVER)
        assert tried == pytest.approx([133.1, *below])
        assert found.runs == len(tried)
        ends = [found.below, found.above]
        if not below:
            assert ends == [rough.below, usual(armour(), 133.1, SOLVER)]
        elif unresolved:
            assert ends == [usual(armour(), tried[-1], SOLVER)] * 2
            assert not found.below.resolved
        else:
            assert ends == [usual(armour(), V, SOLVER) for V in (tried[-1], tried[-2])]


def test_a_dense_scan_ends_at_a_change_of_usual_runs():
    """A rough run stops at 598.9 m/s, 0.1 % above the limit."""
    diameter, length = 0.010040931635386902, 0.014445457264143074
    p = armour()._replace(
        **{"L0": length, "D0": diameter, "rho_p": 1742.0719886677127, "Yp": 478215813.40796876},
        **{"Hc0": 0.007440340113910355, "rho_c": 6246.720506983897, "Ec": 289590958413.44086, "Yc0": 169740481.7533118},
        **{"Hb": 0.0018409893972657538, "rho_B": 6831.447194808159, "YB": 616192919.3746121, "tau": 43166782.10224621},
        shear_law=1,
    )
    limits = []
    for points in (search.SCAN_POINTS, search.DENSE_SCAN_POINTS):
        found = find_ballistic_limit(p, scan(1.0, 10000.0, points), 0.01, 1.0, 0.0, STEPS)
        assert not impact(p, found.low, SOLVER).perforated
        assert impact(p, found.high, SOLVER).perforated
        limits.append(found.high)
    assert limits[0] == pytest.approx(limits[1], abs=0.02)


def test_a_rough_run_that_stops_just_before_the_back_face_is_repeated():
    """Rough runs stop at 99.3 % of the armour where usual ones perforate, from 375.5 m/s on."""
    p = armour()._replace(
        **{"L0": 0.006350408380587619, "D0": 0.004541507847394343, "rho_p": 14111.636826672104},
        **{"Yp": 320589843.7495303, "Hc0": 0.011761596478282434, "rho_c": 13187.436616944182, "Ec": 314398895568.2017},
        **{"Yc0": 134874305.17299995, "Hb": 0.0011619449624660212, "rho_B": 9211.16075663967},
        **{"YB": 63582364.74388469, "tau": 61144823.2027819},
        shear_law=1,
    )
    found = find_ballistic_limit(p, scan(300.0, 500.0, 60), 0.01, 1.0, 0.0, STEPS)
    assert found.high == pytest.approx(375.54, abs=0.02)


def linear(V: float, sign: float, limit: float = 700.0, left: float = 0.8, jump: float = 0.0) -> Impact:
    """Impacts whose residual energy is a part of what is left above a limit, and known below it without a jump."""
    f = sign * left * (V * V - limit * limit)
    if f > 0.0:
        return Impact(V, True, False, True, -f - jump, f + jump)
    return Impact(V, False, False, True, 0.0, -inf if jump else f)


def test_a_change_to_stop_is_narrowed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(search, "rough_impact", lambda _, V, __: linear(V, -1.0))
    monkeypatch.setattr(search, "impact", lambda _, V, __: linear(V, -1.0))
    change = Change(linear(620.0, -1.0), linear(790.0, -1.0), 0)
    found = narrowed(armour(), change, 1e-4, SOLVER)
    low, high = bisected(-700.0, -790.0, -620.0, 1e-4)
    assert (found.low, found.high, found.resolved) == (-high, -low, True)
    assert found.runs <= 3


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_change_with_a_jump_is_narrowed_by_runs_at_both_ends(monkeypatch: pytest.MonkeyPatch, sign: float):
    """The residual energy says nothing of where it jumps, and is not known below."""
    tried = set()

    def given(_p: Parameters, V: float, _solver: Solver) -> Impact:
        tried.add(V)
        return linear(V, sign, jump=9000.0)

    monkeypatch.setattr(search, "rough_impact", given)
    monkeypatch.setattr(search, "impact", given)
    ends = [linear(V, sign, jump=9000.0) for V in (620.0, 790.0)]
    found = narrowed(armour(), Change(ends[0], ends[1], 0), 1e-4, SOLVER)
    assert found.low <= 700.0 <= found.high <= found.low + 1e-4
    assert {found.low, found.high} <= tried
    assert found.runs < 60


@pytest.mark.parametrize("below", [610.0, 690.0])
def test_ends_of_a_bracket_that_the_estimate_tells_are_not_run(monkeypatch: pytest.MonkeyPatch, below: float):
    """But for a change between near velocities, which may be unlike any other."""
    tried = set()

    def given(_p: Parameters, V: float, _solver: Solver) -> Impact:
        tried.add(V)
        return linear(V, 1.0)

    monkeypatch.setattr(search, "rough_impact", given)
    monkeypatch.setattr(search, "impact", given)
    found = narrowed(armour(), Change(linear(below, 1.0), linear(710.0, 1.0), 0), 0.01, SOLVER)
    assert found[:2] == bisected(700.0, below, 710.0, 0.01)
    assert ({found.low, found.high} <= tried) == (below * NEAR > 710.0)


def test_the_residual_energy_continues_below_the_limit():
    """Its derivative is the same above and below; where a projectile is used up, or stops alone, it is not known."""
    p = armour()
    limit = find_ballistic_limit(p, VELOCITIES, 1e-8, 1.0, 0.0, STEPS).high
    f = [impact(p, limit + distance, SOLVER).f for distance in (-0.02, -0.01, 0.01, 0.02)]
    assert f[0] < f[1] < 0.0 < f[2] < f[3]
    assert f[2] - f[1] == pytest.approx(2.0 * (f[1] - f[0]), rel=1e-3)
    assert f[2] - f[1] == pytest.approx(2.0 * (f[3] - f[2]), rel=1e-3)
    assert impact(p, 100.0, SOLVER).f == -inf


def test_a_scan_passes_over_a_velocity_while_the_depth_is_small_and_rises(monkeypatch: pytest.MonkeyPatch):
    p, thickness = armour(), armour().Hc0 + armour().Hb
    scanned = [100.0 * 1.2**i for i in range(9)]

    def depth(V: float) -> Impact:
        return stopped(V, thickness * parts[scanned.index(V)])

    parts = [0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.8, 0.9, 0.95]
    velocities = scanned_as(monkeypatch, depth)
    found = next_change(p, depth(100.0), depth(100.0), scanned, SOLVER)
    assert velocities == [scanned[i] for i in (2, 4, 6, 7, 8)]
    assert found.runs == 5
    # The depth does not rise from the first to the third: both others are looked at.
    parts[2] = 0.05
    velocities = scanned_as(monkeypatch, depth)
    monkeypatch.setattr(search, "change_at_peak", lambda _p, _below, peak, _above, _solver: Change(peak, peak, 0))
    next_change(p, depth(100.0), depth(100.0), scanned, SOLVER)
    assert velocities == [scanned[i] for i in (2, 1, 4, 6, 7, 8)]
    # A dense scan looks at all.
    scanned = [100.0 * 1.04**i for i in range(9)]
    velocities = scanned_as(monkeypatch, depth)
    next_change(p, depth(100.0), depth(100.0), scanned, SOLVER)
    assert velocities == scanned[1:]


def test_an_unresolved_run_ends_the_narrowing(monkeypatch: pytest.MonkeyPatch):
    def given(V: float) -> Impact:
        return linear(V, 1.0)

    def unresolved(V: float) -> Impact:
        return Impact(V, False, False, False, 0.0, -inf)

    change = Change(given(620.0), given(790.0), 0)
    monkeypatch.setattr(search, "rough_impact", lambda _, V, __: unresolved(V))
    ends = given(790.0), given(620.0)
    root = rough_root(armour(), 620.0, 790.0, *ends, 1.0, SOLVER)
    assert root == Root(root.x, 1.0 / ENERGY_LEFT, 1.0, 1, False)
    assert root.x == pytest.approx(700.0, abs=0.2)
    assert narrowed(armour(), change, 1e-4, SOLVER) == (root.x, root.x, 1, False)
    monkeypatch.setattr(search, "rough_impact", lambda _, V, __: given(V))
    monkeypatch.setattr(search, "impact", lambda _, V, __: unresolved(V))
    rough = rough_root(armour(), 620.0, 790.0, *ends, 1.0, SOLVER)
    found = narrowed(armour(), change, 1e-4, SOLVER)
    assert found == (found.low, found.low, rough.runs + 1, False)
    assert found.low == pytest.approx(700.0, abs=2e-4)


def test_a_scan_has_even_ratios_from_end_to_end():
    velocities = scan(20.0, 4000.0, 5)
    assert (velocities[0], velocities[-1], len(velocities)) == (20.0, 4000.0, 5)
    assert velocities[1:4] == pytest.approx([20.0 * 200.0 ** (i / 4) for i in (1, 2, 3)])
    assert len(VELOCITIES) == search.SCAN_POINTS


PERFORATED = Impact(24.0, True, False, True, -1.0, 1.0)
UNRESOLVED = Impact(24.0, False, False, False, 0.0, -1.0)


def test_a_scan_searches_where_neighbours_hint_at_a_change(monkeypatch: pytest.MonkeyPatch):
    """A perforation is confirmed by usual runs at both ends, which are two more."""
    peak = [stopped(10.0, 1.0), stopped(20.0, 3.0), stopped(30.0, 2.0), stopped(40.0, 5.0)]
    used_up = [stopped(10.0, 1.0), stopped(20.0, 3.0), stopped(30.0, 4.0, eroded=True)]
    for given, between in ((peak, tuple(peak[:3])), (used_up, tuple(used_up[1:]))):
        assert changes(monkeypatch, given, PERFORATED) == (Change(given[1], PERFORATED, 13), [between])
        assert changes(monkeypatch, given, UNRESOLVED) == (Change(given[1], UNRESOLVED, 11), [between])
        runs = len(given) - 2 + 10
        assert changes(monkeypatch, given) == (Change(given[-1], given[-1], runs), [between])
    for given in (
        [stopped(10.0, 3.0), *peak[1:3]],
        [peak[0], peak[1], stopped(30.0, 3.0)],
        [peak[0]._replace(eroded=True), *peak[1:3]],
    ):
        assert changes(monkeypatch, given, PERFORATED) == (Change(given[-1], given[-1], 1), [])


def test_a_search_between_velocities_ends_after_some_runs(monkeypatch: pytest.MonkeyPatch):
    velocities = scanned_as(monkeypatch, hill)
    found = change_at_peak(armour(), hill(100.0), hill(200.0), hill(400.0), SOLVER)
    assert found == Change(found.below, found.below, search.HIDDEN_RUNS)
    assert len(velocities) == search.HIDDEN_RUNS
    assert found.below.V == max((hill(V) for V in velocities), key=lambda tried: tried.nearness).V
    velocities = scanned_as(monkeypatch, lambda V: stopped(V, eroded=V > 130.0))
    found = change_between_causes(armour(), stopped(100.0), stopped(200.0, eroded=True), SOLVER)
    assert found == Change(found.below, found.below, search.HIDDEN_RUNS)
    assert len(velocities) == search.HIDDEN_RUNS
    assert 130.0 - 100.0 / 2.0**10 <= found.below.V <= 130.0


@pytest.mark.parametrize("index", range(4))
def test_the_runs_of_a_search_are_counted(monkeypatch: pytest.MonkeyPatch, index: int):
    """A scanned impact that is repeated with usual steps counts once."""
    made = 0

    def counting(name: str, weight: int) -> None:
        function = getattr(search, name)

        def counted(*arguments: Any) -> Any:
            nonlocal made
            before = made
            result = function(*arguments)
            made = before + 1 if weight else made + 1
            return result

        monkeypatch.setattr(search, name, counted)

    counting("rough_impact", 0)
    counting("impact", 0)
    counting("scanned_impact", 1)
    p = random_designs(COUNT)[index]
    for tolerance in (1.0, 1e-6):
        made = 0
        assert find_ballistic_limit(p, VELOCITIES, tolerance, 1.0, 0.0, STEPS).runs == made
    made = 0
    assert find_least_ceramic_thickness(p, 700.0, 0.0, 10.0 * p.D0, 1e-8, 1.0, 0.0, STEPS).runs == made


def test_an_unresolved_run_is_both_ends_of_the_bracket():
    """Wherever in the search it comes."""
    p, ends, whole = armour(), set(), find_ballistic_limit(armour(), VELOCITIES, 1e-3, 1.0, 0.0, STEPS)
    for steps in range(2, 60):
        found = find_ballistic_limit(p, VELOCITIES, 1e-3, 1.0, 0.0, steps)
        assert found.resolved == (found == whole)
        if not found.resolved:
            assert VELOCITIES[0] <= found.low == found.high <= VELOCITIES[-1]
            assert 1 <= found.runs <= whole.runs
            ends.add((found.low in VELOCITIES, found.runs))
    assert {scanned for scanned, _ in ends} == {True, False}


def bracket(**changes: Any) -> search.Bracket:
    """A bracket from 1 to 2 with the root at about 1.4."""
    return search.Bracket(1.0, 2.0, True, False, 1, 2.0, 0.6, 0.0, 0.0, 1.4, 0.1, 5)._replace(**changes)


def test_the_next_point_is_just_beyond_the_estimate():
    for b, tolerance, expected in (
        (bracket(), 1e-3, 1.5),
        (bracket(points=2), 1e-3, 1.4 + 0.03 * 0.6),
        (bracket(points=3), 1e-3, 1.4 + search.PARABOLA_ERROR * 0.1),
        (bracket(points=3, error=0.0), 3e-3, 1.401),
        (bracket(smooth=True), 3e-3, 1.401),
        (bracket(estimate=1.9), 0.2, 2.0 - 0.18),
        (bracket(estimate=0.85, error=0.05), 1e-3, 1.6),
        (bracket(estimate=0.9, error=0.05), 1e-3, 1.4),
        (bracket(estimate=0.7), 1e-3, 1.5),
        (bracket(estimate=2.5), 1e-3, 2.0 - 0.9e-3),
        (bracket(runs=search.MAX_INTERPOLATED_RUNS), 1e-3, 1.5),
        (bracket(runs=search.MAX_INTERPOLATED_RUNS + 1), 1e-3, 1.5),
        (bracket(runs=search.MAX_INTERPOLATED_RUNS, error=0.2), 1e-3, 1.6),
        (bracket(runs=search.MAX_INTERPOLATED_RUNS + 1, error=0.2), 1e-3, 1.5),
    ):
        assert search.next_point(b, tolerance) == pytest.approx(expected, rel=1e-12)


def test_the_estimate_of_a_bracket_is_the_root_of_a_parabola():
    def x(f: float) -> float:
        return 3.0 + 2.0 * f - 0.5 * f * f

    b = search.first_bracket(0.0, x(1.0), 1.0, 3.5)
    assert b == (0.0, 4.5, False, False, 1, 4.5, 1.0, 0.0, 0.0, 3.5, 0.2, 1)
    assert search.first_bracket(0.0, 4.5, 1.0, 5.5) == b._replace(estimate=5.5)
    line = search.after_run(b, x(-1.0), -1.0, False)
    assert line == (0.5, 4.5, True, True, 2, 0.5, -1.0, 4.5, 1.0, 2.5, 1.0, 2)
    assert search.after_run(b, 0.5, -inf, False) == b._replace(low=0.5, low_known=True, runs=2)
    assert search.after_run(line, 0.5, -inf, False) == line._replace(smooth=False, runs=3)
    parabola = search.after_run(line, x(0.5), 0.5, True)
    assert parabola.estimate == pytest.approx(3.0)
    assert parabola.error == pytest.approx(0.5)
    assert parabola[:9] == (0.5, x(0.5), True, True, 3, x(0.5), 0.5, 0.5, -1.0)
    assert search.after_run(parabola, x(-0.25), -0.25, False)[:5] == (x(-0.25), x(0.5), True, True, 3)
    again = search.after_run(b, x(0.5), 0.5, True)
    assert again[:9] == (0.0, x(0.5), False, False, 2, x(0.5), 0.5, 4.5, 1.0)
    assert search.estimated_root(2, x(1.0), 1.0, x(0.5), 0.5, 7.0, 0.5) == 3.25
    assert search.estimated_root(2, x(1.0), 1.0, x(0.5), 0.5, 7.0, 1.0) == 3.25
    assert search.estimated_root(1, x(1.0), 1.0, x(0.5), 0.5, 7.0, 7.0) == 3.25
    assert search.estimated_root(2, 4.0, 1.0, x(0.5), 1.0, 7.0, 7.0) == 4.0


def test_a_scanned_impact_is_rough_unless_it_is_close_or_unresolved(monkeypatch: pytest.MonkeyPatch):
    p, V, usual = armour(), 500.0, stopped(500.0, 1.0)
    monkeypatch.setattr(search, "impact", lambda *_: usual)
    thickness = p.Hc0 + p.Hb
    for tried, close in (
        (Impact(V, True, False, True, -1.01 * search.CLOSE * V * V, 0.0), False),
        (Impact(V, True, False, True, -0.99 * search.CLOSE * V * V, 0.0), True),
        (stopped(V, (1.0 - 1.1 * search.CLOSE) * thickness), False),
        (stopped(V, (1.0 - 0.9 * search.CLOSE) * thickness), True),
        (stopped(V, 0.1 * thickness)._replace(resolved=False), True),
    ):
        monkeypatch.setattr(search, "rough_impact", lambda *_, tried=tried: tried)
        assert scanned_impact(p, V, SOLVER) == (usual if close else tried)


def test_the_estimate_after_a_usual_run():
    """Its error is the distance of the run times what is doubted of the slope."""
    rough, first = Root(100.0, 2.0, 0.1, 5, True), search.Zero(100.0, inf, 2.0, 0.0, -inf)
    assert search.zero_at(first, 90.0) == (90.0, inf, 2.0, 0.0, -inf)
    second = search.after_usual(first, rough, 100.02, 0.01, True)
    assert second == pytest.approx((100.0, 1.1 * 0.02, 2.0, 100.02, 0.01))
    third = search.after_usual(second, rough, 100.001, 0.0, True)
    assert third[2:] == pytest.approx((1.9, 100.001, 0.0))
    assert third[:2] == pytest.approx((100.001, search.ROUNDING * 100.001))
    fourth = search.after_usual(second, rough, 100.002, 0.0005, True)
    slope = 0.018 / 0.0095
    doubt = 0.1 + abs(slope / 2.0 - 1.0) + search.BEND * 0.018 / 100.002
    assert fourth[:3] == pytest.approx((100.002 - slope * 0.0005, doubt * slope * 0.0005, slope))
    for trusted, zero, of in (
        (False, first, rough),
        (True, first._replace(x=100.0 * (1.0 + 2.0 * search.AGREEMENT)), rough),
        (True, first, rough._replace(doubt=1.01 * search.GREATEST_DOUBT)),
    ):
        assert search.after_usual(zero, of, 100.02, 0.01, trusted).error == inf


def test_rough_runs_tell_the_slope_and_how_far_it_is_to_be_doubted(monkeypatch: pytest.MonkeyPatch):
    tried = []

    def given(_p: Parameters, V: float, _solver: Solver) -> Impact:
        tried.append(V)
        return linear(V, sign)

    monkeypatch.setattr(search, "rough_impact", given)
    for sign in (1.0, -1.0):
        tried.clear()
        low, high = sorted((sign * 620.0, sign * 790.0))
        ends = linear(abs(high), sign), linear(abs(low), sign)
        root = rough_root(armour(), low, high, *ends, sign, SOLVER)
        assert root.x == pytest.approx(sign * 700.0, abs=0.01)
        assert root.slope == pytest.approx(0.5 / 0.8 / 700.0, rel=1e-6)
        assert root.doubt == pytest.approx(search.SLOPE_ERROR, abs=1e-6)
        assert (root.runs, root.resolved) == (len(tried), True)


def test_an_impact_says_how_it_ended():
    fast, slow = impact(armour(), 2000.0, SOLVER), impact(armour(), 300.0, SOLVER)
    assert (fast.perforated, fast.eroded, fast.resolved, fast.nearness) == (True, False, True, -fast.f)
    assert (slow.perforated, slow.resolved) == (False, True)
    assert 0.0 < slow.nearness < armour().Hc0 + armour().Hb
    assert not impact(armour(), 300.0, SOLVER._replace(max_steps=3)).resolved
    assert impact(armour(), 2000.0, SOLVER._replace(V_arrest=20.0)).f == pytest.approx(fast.f + 1.0 - 400.0, rel=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_rough_runs_begin_with_an_estimate_by_the_energy_that_is_left(monkeypatch: pytest.MonkeyPatch, sign: float):
    tried = []

    def given(_p: Parameters, V: float, _solver: Solver) -> Impact:
        tried.append(V)
        return linear(V, sign, jump=9000.0)

    monkeypatch.setattr(search, "rough_impact", given)
    low, high = sorted((sign * 620.0, sign * 790.0))
    first, other = given(armour(), abs(high), SOLVER), given(armour(), abs(low), SOLVER)._replace(f=-inf)
    rough_root(armour(), low, high, first, other, sign, SOLVER)
    away = first.f / ENERGY_LEFT
    assert tried[2] ** 2 == pytest.approx(high * high - sign * (1.0 - search.ESTIMATE_ERROR) * away)


def test_an_impact_says_whether_the_projectile_is_used_up():
    p = armour()
    end = run(p, 300.0, time_step(p, 300.0, 0.0), 1.0, STEPS, None, False)
    for part, eroded in ((0.99, True), (1.01, False)):
        left = end._replace(y=end.y._replace(L=part * ERODED_FRACTION * p.L0))
        assert search.impact_of(left, p, 300.0, SOLVER).eroded is eroded
