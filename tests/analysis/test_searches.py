"""Searches over many variants, against those of single scenarios."""

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.analysis.searches import (
    ballistic_limits,
    bisect_rows,
    least_backings_mm,
    least_ceramics_mm,
    least_totals_mm,
    lowest_limits,
    smooth_limits,
)
from armour.analysis.variants import Bools, Floats, Ints, Variants, perforated, variants_of, with_thicknesses
from armour.errors import NoLimitError
from armour.scenario.loading import Scenario
from tests.helpers.cases import library, scenario

WIDE = {
    "ceramic_thickness_mm": {"min": 1.0, "max": 20.0, "step": 0.5},
    "backing_thickness_mm": {"min": 1.0, "max": 20.0, "step": 0.5},
}
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


def defeated(variants: Variants) -> list[bool]:
    found: list[bool] = (~perforated(variants)).tolist()
    return found


def test_the_least_ceramic_just_defeats_the_impact():
    variants = rows_of(case(), [5.0] * 3, [7.0, 1.0, 60.0])
    least = least_ceramics_mm(variants)
    assert np.isnan(least).tolist() == [False, True, False]
    assert least[2] == 1.0
    assert defeated(with_thicknesses(variants, ceramic_mm=least).at(np.array([0, 2]))) == [True, True]
    assert defeated(with_thicknesses(variants, ceramic_mm=least - 2e-6).at(np.array([0]))) == [False]


def test_the_least_back_plate_is_that_of_the_least_ceramic():
    variants = rows_of(case(), [10.0, 1.0], [5.0, 5.0])
    least = least_backings_mm(variants)
    assert np.isnan(least).tolist() == [False, True]
    across = least_ceramics_mm(with_thicknesses(variants, backing_mm=least).at(np.array([0])))
    assert across[0] == pytest.approx(10.0, abs=1e-5)


def test_the_least_armour_in_proportion():
    half = 0.5 * least_totals_mm(alone(case()))  # the case has 6.35 mm of both
    for less, outcome in ((-1e-9, True), (2e-6, False)):
        found = with_thicknesses(alone(case()), ceramic_mm=half - less, backing_mm=half - less)
        assert defeated(found) == [outcome]


def test_no_armour_in_proportion():
    apart = {
        "ceramic_thickness_mm": {"min": 1.0, "max": 2.0, "step": 0.5},
        "backing_thickness_mm": {"min": 10.0, "max": 20.0, "step": 0.5},
    }
    for of in (case(velocity=3000.0), case().replaced({"optimise": apart})):
        assert np.isnan(least_totals_mm(alone(of))).all()


def test_a_bare_plate_in_proportion():
    bare = scenario(
        ceramic=None,
        ceramic_mm=0.0,
        velocity=500.0,
        optimise={**WIDE, "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}},
    )
    assert least_totals_mm(alone(bare)) == pytest.approx(least_backings_mm(alone(bare)), abs=2e-6)


def test_limits_of_rows_are_those_of_single_searches():
    thicknesses = [(c, b) for c in (2.0, 6.0, 12.0) for b in (3.0, 9.0)]
    variants = rows_of(case(), *map(list, zip(*thicknesses, strict=True)))
    expected = [limit_of(case(ceramic_mm=c, backing_mm=b)) for c, b in thicknesses]
    assert ballistic_limits(variants).tolist() == expected
    assert lowest_limits(variants, 20.0, 4000.0).values.tolist() == expected
    assert smooth_limits(variants, 1e-6) == pytest.approx(np.array(expected), abs=0.01, nan_ok=True)


def test_the_lowest_limit_is_that_of_the_scan_where_outcomes_are_not_monotonic():
    materials = library((6.5, 18.235, 11000.0, 1.3743), (4006.0, 398.7, 6.36), (2750.0, 3.7794, 792.4))
    of = scenario("x", "c", "b", ceramic_mm=3.3, backing_mm=2.3, velocity=533.0, library=materials)
    found = lowest_limits(alone(of), 20.0, 4000.0)
    assert simulate(of).outcome == "defeated"
    assert found.values[0] < 533.0
    assert found.values[0] == limit_of(of)
    assert found.runs > 33


def test_lowest_limits_outside_the_range():
    variants = rows_of(case(), [6.0, 6.0], [6.0, 12.0])
    assert lowest_limits(variants, 20.0, 100.0).values.tolist() == [np.inf, np.inf]
    assert lowest_limits(variants, 1500.0, 4000.0).values.tolist() == [-np.inf, -np.inf]
    middle = float(lowest_limits(variants, 20.0, 4000.0).values.mean())
    assert lowest_limits(variants, middle, 4000.0).values[0] == -np.inf


def test_brackets_are_narrowed_row_by_row():
    places, asked = np.array([0.3, 0.7, 0.9]), []

    def holds(values: Floats, rows: Ints) -> Bools:
        asked.extend(values.tolist())
        reached: Bools = values >= places[rows]
        return reached

    found = bisect_rows(holds, 1e-6, np.zeros(3), np.ones(3))
    assert ((found >= places) & (found < places + 1e-6)).all()
    count = len(asked)
    again = bisect_rows(holds, 1e-6, np.zeros(3), np.ones(3), places - 1e-3, places + 1e-3)
    assert again.tolist() == found.tolist()
    assert len(asked) - count < count
