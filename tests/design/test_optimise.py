"""Design optimisation: the grid of a scenario, and what holds for any result."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.analysis.variants import Bools, Variants
from armour.design.optimise import optimise
from armour.scenario.scenario import Scenario
from tests.design.results import best_of
from tests.helpers.cases import grid, library, offer, scenario
from tests.helpers.exotic import narrow_ranges

pytestmark = pytest.mark.slow

GRID = grid((8.0, 14.0, 0.5), (4.0, 9.0, 1.0))
ONE = {"min": 6.0, "max": 6.0, "step": 1.0}
# Up to 5.7 mm of ceramic on 2.3 mm stops the projectile at 532.67 m/s, though lower velocities perforate.
LOWER_LIMIT = library(
    (6.5, 18.23505911750531, 11000.0, 1.3743377021448488),
    (4005.9656263700754, 398.6927467929853, 6.3598050199703575),
    (2750.0, 3.7794144984922697, 792.4002047497445),
)

THICKER = "{}: a thicker {} is perforated at a velocity that a thinner one stops"


def case(**grid: dict[str, float]) -> Scenario:
    """The grid of the paper's question: by the model alone."""
    by_model = {"model": {"included": False}}
    return scenario(backing="5083-H3", velocity=850.0, optimise={**GRID, **grid}, uncertainty=by_model)


def lower_limit(ceramic: tuple[float, float, float] = (1.0, 19.0, 0.1), **sections: Any) -> Scenario:
    grid = {
        "ceramic_thickness_mm": dict(zip(("min", "max", "step"), ceramic, strict=True)),
        "backing_thickness_mm": {"min": 1.9, "max": 2.3, "step": 0.1},
    }
    return scenario("x", "c", "b", velocity=532.67, library=LOWER_LIMIT, optimise=grid, **sections)


def of_design(of: Scenario, design: Any) -> Scenario:
    names = ("ceramic_thickness_mm", "backing_thickness_mm")
    return of.replaced({f"armour.{name}": getattr(design, name) for name in names})


def stops(of: Scenario, ceramic: float, backing: float) -> bool:
    thicknesses = {"armour.ceramic_thickness_mm": ceramic, "armour.backing_thickness_mm": backing}
    return simulate(of.replaced(thicknesses)).outcome == "stopped"


def test_a_range_whose_end_is_omitted():
    told = "ceramic_thickness_mm: the last value is 14, since 15 is not a whole number of steps away"
    beyond = {"min": 8.0, "max": 15.0, "step": 2.0}
    assert f"optimise.{told}" in optimise(case(ceramic_thickness_mm=beyond)).warnings
    layers = {"ceramic": [{"material": "SiC", "thickness_mm": 10.0}, {"material": "AD85", "thickness_mm": beyond}]}
    found = optimise(case().replaced({"design": layers})).warnings
    assert "design.ceramic[1].thickness_mm: " + told.partition(": ")[2] in found


def test_of_very_many_back_plates_the_frontier_has_every_second_and_the_best():
    layers = grid((11.0, 11.0, 1.0), (5.0, 14.0, 0.005))
    result = optimise(case(**layers))
    found = [design.backing_thickness_mm for design in result.frontier]
    assert len(found) <= 1002
    assert set(np.diff(found).round(6).tolist()) <= {0.005, 0.01}
    assert found[0] == best_of(result).backing_thickness_mm
    thinner = {"armour.backing_thickness_mm": found[0] - 0.005}
    assert ballistic_limit(of_design(case(), best_of(result)).replaced(thinner)).ballistic_limit_m_s < 850.0


@pytest.mark.parametrize(
    ("grid", "warning"),
    [
        (
            {"backing_thickness_mm": {"min": 4.0, "max": 5.2, "step": 0.5}},
            "optimise.backing_thickness_mm: the design lies at the greatest back plate thickness of the range, "
            "5 mm; a thicker back plate may make the armour lighter",
        ),
        (
            {"ceramic_thickness_mm": {"min": 12.0, "max": 14.0, "step": 0.5}},
            "optimise.ceramic_thickness_mm: the design lies at the least ceramic thickness of the range, 12 mm; "
            "a thinner ceramic may make the armour lighter",
        ),
    ],
)
def test_a_best_design_at_an_end_of_a_range_is_told(grid: dict[str, Any], warning: str):
    assert warning in optimise(case(**grid)).warnings


def test_an_end_that_is_none_is_not_told():
    """Neither inside a range nor of a list or a single value."""
    assert optimise(case()).warnings == ()
    layers = offer("AD85", [11.0, 13.0], "5083-H3", ONE)
    listed = optimise(case().replaced({"design": layers}))
    assert best_of(listed).ceramic_thickness_mm == 11.0
    assert listed.warnings == ()


def test_a_design_with_a_ballistic_limit_below_the_threat_does_not_count():
    result = optimise(lower_limit())
    assert stops(lower_limit(), 3.3, 2.3)
    assert (best_of(result).ceramic_thickness_mm, best_of(result).backing_thickness_mm) == (5.8, 2.3)
    limit = ballistic_limit(of_design(lower_limit(), best_of(result))).ballistic_limit_m_s
    assert best_of(result).check.threats[0].ballistic_limit_m_s == limit
    assert limit >= 532.67
    assert all(design.ceramic_thickness_mm >= 5.8 for design in result.frontier if design.backing_thickness_mm == 2.3)


def test_a_pareto_front_has_no_design_with_a_ballistic_limit_below_the_threat():
    front = optimise(lower_limit((5.6, 6.6, 0.1), design={"pareto": ["areal_density_kg_m2", "margin_m_s"]})).pareto
    assert front[0].ceramic_thickness_mm == 5.8
    margins = [design.margin_m_s or 0.0 for design in front]
    masses = [design.areal_density_kg_m2 for design in front]
    assert margins[0] > 0.0
    assert margins == sorted(margins)
    assert masses == sorted(masses)
    for design in (front[0], front[-1]):
        limit = ballistic_limit(of_design(lower_limit(), design)).ballistic_limit_m_s
        assert design.margin_m_s == limit - 532.67


@pytest.mark.parametrize("section", [{}, {"ballistic_limit": {"velocity_min_m_s": 533.0}}])
def test_no_design_without_a_lower_ballistic_limit(section: dict[str, Any]):
    result = optimise(lower_limit((3.3, 3.3, 0.1), **section))
    assert result.reason == "none passes"
    assert result.shown.check.verdict == "perforated by the model"


def test_back_plates_at_which_a_thicker_ceramic_does_not_pass(monkeypatch: pytest.MonkeyPatch):
    perforated = Variants.perforated

    def weak_at_one(variants: Variants) -> Bools:
        weak = np.isclose(variants.ceramics_mm, 13.0) & np.isclose(variants.backings_mm, 6.0)
        return perforated(variants) | weak

    assert optimise(case()).not_monotonic_mm == ()
    monkeypatch.setattr(Variants, "perforated", weak_at_one)
    result = optimise(case())
    assert result.not_monotonic_mm == (6.0,)
    assert THICKER.format("AD85 on 5083-H3", "ceramic") + ", with a back plate of 6 mm" in result.warnings
    [thinnest] = [d.ceramic_thickness_mm for d in result.frontier if d.backing_thickness_mm == 6.0]
    assert thinnest < 13.0


def test_a_thicker_ceramic_that_is_perforated_where_a_thinner_one_stops_is_told():
    """Ceramics of 9.546 to 11.4 mm stop the impact, but not a slower one."""
    layers = offer("c", {"min": 9.0, "max": 14.0}, "b", [0.345424597])
    result = optimise(narrow_ranges().replaced({"design": layers}))
    assert best_of(result).ceramic_thickness_mm == pytest.approx(13.0, abs=0.02)
    assert THICKER.format("c on b", "ceramic") + ", with a back plate of 0.3454 mm" in result.warnings
    assert not any("thicker back plate is" in warning for warning in result.warnings)
