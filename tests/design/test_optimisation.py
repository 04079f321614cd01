import sys

import pytest

from armour.analysis.least_thickness import defeats_threat
from armour.design.optimisation import (
    bisect_thinnest,
    is_monotonic,
    optimise,
    sweep_thinnest,
)
from armour.errors import InputError, NoDesignError
from armour.scenario.loading import Scenario
from tests.cases import scenario

GRID = {
    "ceramic_thickness_mm": {"min": 8.0, "max": 14.0, "step": 0.5},
    "backing_thickness_mm": {"min": 4.0, "max": 9.0, "step": 1.0},
}


def case(**grid: dict[str, float]) -> Scenario:
    return scenario(backing="5083-H3", velocity=850.0, optimise={**GRID, **grid})


def test_the_sweep_and_the_bisection_agree():
    quick, full = optimise(case()), optimise(case(), full_grid=True)
    assert quick.frontier == full.frontier
    assert quick.best == full.best
    assert quick.runs < full.runs == 6 * 13


def test_every_design_of_the_frontier_is_the_thinnest():
    threat = case()
    for design in optimise(threat).frontier:
        ceramic, backing = design.ceramic_thickness_mm, design.backing_thickness_mm
        assert defeats_threat(threat, ceramic, backing)
        assert not defeats_threat(threat, ceramic - 0.5, backing)
        assert design.areal_density_kg_m2 == pytest.approx(3.43 * ceramic + 2.75 * backing)


def test_the_best_is_the_lightest_and_has_its_limit():
    result = optimise(case())
    assert result.best.areal_density_kg_m2 == min(d.areal_density_kg_m2 for d in result.frontier)
    assert result.best.ballistic_limit_m_s is not None
    assert result.best.ballistic_limit_m_s > 850.0


def test_a_limit_outside_its_range_is_none():
    threat = case().replaced({"ballistic_limit.velocity_max_m_s": 500.0})
    assert optimise(threat).best.ballistic_limit_m_s is None


def test_a_backing_for_which_no_ceramic_is_enough_is_left_out():
    result = optimise(case(ceramic_thickness_mm={"min": 8.0, "max": 11.0, "step": 0.5}))
    assert [d.backing_thickness_mm for d in result.frontier] == [6.0, 7.0, 8.0, 9.0]


def test_no_design_is_no_answer():
    threat = case(ceramic_thickness_mm={"min": 1.0, "max": 2.0, "step": 0.5})
    with pytest.raises(NoDesignError, match="up to 2 mm of ceramic on 9 mm of backing"):
        optimise(threat)


def test_a_scenario_without_a_grid():
    with pytest.raises(InputError, match="optimise: is missing"):
        optimise(scenario())


def test_a_grid_of_ceramic_without_a_ceramic():
    threat = scenario(ceramic=None, ceramic_mm=0.0, optimise=GRID)
    with pytest.raises(InputError, match=r"armour\.ceramic: must name a ceramic"):
        optimise(threat)


def test_the_lightest_bare_plate():
    grid = {
        "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0},
        "backing_thickness_mm": {"min": 5.0, "max": 60.0, "step": 5.0},
    }
    result = optimise(scenario(ceramic=None, ceramic_mm=0.0, velocity=400.0, optimise=grid), refine=True)
    assert result.best.ceramic_thickness_mm == 0.0
    assert result.refined is not None
    assert result.best.backing_thickness_mm - 5.0 < result.refined.backing_thickness_mm
    assert result.refined.areal_density_kg_m2 < result.best.areal_density_kg_m2


def test_the_refined_design_is_lighter_than_any_of_a_finer_grid():
    threat = case()
    refined = optimise(threat, refine=True).refined
    assert refined is not None
    assert defeats_threat(threat, refined.ceramic_thickness_mm, refined.backing_thickness_mm)
    fine = case(
        ceramic_thickness_mm={"min": 10.0, "max": 12.0, "step": 0.02},
        backing_thickness_mm={"min": 5.0, "max": 7.5, "step": 0.1},
    )
    best = optimise(fine).best
    assert refined.areal_density_kg_m2 <= best.areal_density_kg_m2
    assert refined.areal_density_kg_m2 > best.areal_density_kg_m2 - 0.02 * 3.43


@pytest.mark.parametrize("first", range(40))
def test_both_searches_find_the_first_of_a_monotonic_column(first: int):
    ceramics = [float(i) for i in range(40)]
    for search in (sweep_thinnest, bisect_thinnest):
        assert search(lambda c: c >= first, ceramics) == first


def test_no_ceramic_is_enough():
    for search in (sweep_thinnest, bisect_thinnest):
        assert search(lambda _: False, [1.0, 2.0, 3.0]) is None


def test_a_column_that_is_not_monotonic_is_swept():
    ceramics = [float(i) for i in range(40)]
    outcomes = [3 < c < 12 or c > 30 for c in ceramics]
    tried: list[float] = []

    def defeats(ceramic: float) -> bool:
        tried.append(ceramic)
        return outcomes[int(ceramic)]

    assert bisect_thinnest(defeats, ceramics) == 4.0
    assert set(tried) == set(ceramics)
    assert not is_monotonic(outcomes)


def test_columns_that_are_not_monotonic_are_reported(monkeypatch: pytest.MonkeyPatch):
    def defeats(_: Scenario, ceramic: float, backing: float) -> bool:
        return ceramic > 12.0 or (backing == 5.0 and ceramic == 8.0)

    monkeypatch.setattr(sys.modules["armour.design.optimisation"], "defeats_threat", defeats)
    assert optimise(case()).not_monotonic_mm == (5.0,)


def test_progress_is_told():
    seen: list[tuple[bool, int]] = []
    optimise(case(), on_column=lambda column, total: seen.append((column.design is not None, total)))
    assert seen == [(True, 6)] * 6
