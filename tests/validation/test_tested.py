"""The tested armours that are nearest to a ballistic limit."""

import pytest

from armour.validation import tested
from tests.helpers.cases import scenario


def test_the_tested_armours_nearest_to_a_limit_are_those_against_such_a_core():
    """7.62 mm B32, 854 m/s: the core is like that of the AP and of the APM2, and unlike that of the M80 ball."""
    found = tested.nearest_measured(scenario("7.62 mm B32"), 854.0)
    tile, *plates = found
    assert (tile.armour, tile.projectile, tile.ballistic_limit_m_s) == (
        "7.83 mm AD85 on 6.35 mm 6061-T6",
        "7.62 mm AP",
        847.0,
    )
    assert tile.areal_density_kg_m2 == pytest.approx(3.43 * 7.83 + 2.75 * 6.35)
    assert {plate.projectile for plate in plates} == {".30 APM2"}
    assert min(plate.areal_density_kg_m2 for plate in plates) > 70.0
    assert tested.nearest_measured(scenario("20 mm FSP"), 854.0)[0].projectile == "20 mm FSP"
    assert tested.nearest_measured(scenario("25 mm APDS"), 854.0) == ()
    assert tested.nearest_measured(scenario().replaced({"impact.obliquity_deg": 30.0}), 854.0) == ()
