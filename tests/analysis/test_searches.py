"""Searches over many variants, against those of single scenarios."""

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import QuantityValues
from armour.analysis.variants import Variants, ballistic_limits, variants_of
from armour.errors import NoLimitError
from armour.scenario.scenario import Scenario
from tests.helpers.cases import grid, scenario
from tests.helpers.exotic import narrow_ranges, random_wide_designs

pytestmark = pytest.mark.slow

WIDE = grid((1.0, 20.0, 0.5), (1.0, 20.0, 0.5))
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"


def case(velocity: float = 850.0, **thicknesses: float) -> Scenario:
    return scenario(backing="5083-H3", velocity=velocity, optimise=WIDE, **thicknesses)


def alone(of: Scenario) -> Variants:
    return variants_of(of, {}, 1)


def rows_of(of: Scenario, ceramics: list[float], backings: list[float]) -> Variants:
    return variants_of(of, {CERAMIC: np.array(ceramics), BACKING: np.array(backings)}, len(ceramics))


def limit_of(of: Scenario) -> float:
    try:
        return ballistic_limit(of).ballistic_limit_m_s
    except NoLimitError:
        return np.nan


def test_no_armour_in_proportion():
    apart = grid((1.0, 2.0, 0.5), (10.0, 20.0, 0.5))
    for of in (case(velocity=3000.0), case().replaced({"optimise": apart})):
        assert np.isnan(alone(of).least_thicknesses("armour").mm).all()


def test_a_bare_plate_in_proportion():
    bare = scenario(
        ceramic=None,
        ceramic_mm=0.0,
        velocity=500.0,
        optimise={**WIDE, "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}},
    )
    assert alone(bare).least_thicknesses("armour").mm == pytest.approx(
        alone(bare).least_thicknesses("back plate").mm, abs=2e-6
    )


def inside_the_data(count: int) -> list[Scenario]:
    rng = np.random.default_rng(3)
    return [
        case(ceramic_mm=float(rng.uniform(4.0, 16.0)), backing_mm=float(rng.uniform(4.5, 18.0))) for _ in range(count)
    ]


@pytest.mark.parametrize("of", [*inside_the_data(3), *random_wide_designs(3, 1)])
def test_the_limit_of_a_row_is_that_of_a_single_search(of: Scenario):
    [limit] = QuantityValues(alone(of)).ballistic_limits.tolist()
    assert limit == pytest.approx(limit_of(of), rel=0.0, abs=0.0, nan_ok=True)


def test_limits_outside_the_range():
    variants = rows_of(case(), [6.0, 6.0], [6.0, 12.0])
    assert ballistic_limits(variants, (20.0, 100.0)).tolist() == [np.inf, np.inf]
    assert ballistic_limits(variants, (1500.0, 4000.0)).tolist() == [-np.inf, -np.inf]
    fast = alone(case().replaced({"ballistic_limit": {"velocity_min_m_s": 1500.0}}))
    assert np.isnan(QuantityValues(fast).ballistic_limits).all()
    assert fast.limits_anywhere() == pytest.approx(ballistic_limits(alone(case())), abs=0.02)


def test_limits_of_unusual_rows_are_searched_densely_and_in_place():
    ceramics = np.array([10.75, 10.0, 10.75])
    variants = variants_of(narrow_ranges(), {"armour.ceramic_thickness_mm": ceramics}, 3)
    usual = alone(scenario())
    together = variants._replace(parameters=np.concatenate([usual.parameters, variants.parameters, usual.parameters]))
    together = together._replace(
        velocities=np.full(5, 359.086), cosines=np.ones(5), material_of_row=np.zeros(5, dtype=int)
    )
    limits = ballistic_limits(together, (1.0, 10_000.0))
    alone_limits = [ballistic_limits(together.at(np.array([i])), (1.0, 10_000.0))[0] for i in range(5)]
    assert limits.tolist() == alone_limits
    assert limits[0] == limits[4] == pytest.approx(723.77, abs=0.02)
    assert limits[1] == limits[3] == pytest.approx(252.67, abs=0.02)
    assert together.stops_again_above(limits).tolist() == [False, True, True, True, False]


def test_the_thinnest_layer_that_stops_an_impact_that_a_thicker_one_does_not():
    velocities = np.array([359.086, 320.0])
    variants = variants_of(narrow_ranges(), {"impact.velocity_m_s": velocities}, 2)
    least = variants.least_thicknesses("ceramic")
    assert least.mm[0] == pytest.approx(9.546, abs=1e-3)
    values = np.linspace(0.5, 60.0, 500)
    for i, thickness in enumerate(least.mm):
        many = variants.at(np.full(500, i)).with_thicknesses(ceramic_mm=values)
        stops = ~many.perforated()
        assert not stops[values < thickness].any()
        assert least.changes_again[i] == (~stops[values > thickness]).any()
    assert not alone(case()).least_thicknesses("ceramic").changes_again[0]
