import pytest

from armour.analysis.least_thickness import defeats_threat, grid, least_backing, least_ceramic, least_in_proportion
from armour.errors import InputError
from armour.scenario.loading import Scenario
from tests.cases import scenario
from tests.design.test_optimisation import GRID

WIDE = {
    "ceramic_thickness_mm": {"min": 1.0, "max": 20.0, "step": 0.5},
    "backing_thickness_mm": {"min": 1.0, "max": 20.0, "step": 0.5},
}


def case(grid: dict[str, dict[str, float]] = WIDE, velocity: float = 850.0) -> Scenario:
    return scenario(backing="5083-H3", velocity=velocity, optimise=grid)


def test_the_ceramic_that_a_backing_needs():
    threat = case(GRID)
    design = least_ceramic(threat, 7.0)
    assert design is not None
    assert defeats_threat(threat, design.ceramic_thickness_mm, 7.0)
    assert not defeats_threat(threat, design.ceramic_thickness_mm - 2e-6, 7.0)
    assert least_ceramic(threat, 1.0) is None
    thick = least_ceramic(threat, 60.0)
    assert thick is not None
    assert thick.ceramic_thickness_mm == 8.0


def test_the_backing_that_a_ceramic_needs():
    threat = case()
    design = least_backing(threat, 10.0)
    assert design is not None
    assert defeats_threat(threat, 10.0, design.backing_thickness_mm)
    assert not defeats_threat(threat, 10.0, design.backing_thickness_mm - 2e-6)
    across = least_ceramic(threat, design.backing_thickness_mm)
    assert across is not None
    assert across.ceramic_thickness_mm == pytest.approx(10.0, abs=1e-5)
    assert least_backing(threat, 1.0) is None


def test_the_thinnest_armour_in_proportion():
    threat = case()
    design = least_in_proportion(threat)
    assert design is not None
    ceramic, backing = design.ceramic_thickness_mm, design.backing_thickness_mm
    assert ceramic == pytest.approx(backing)  # the case has 6.35 mm of both
    assert defeats_threat(threat, ceramic, backing)
    assert not defeats_threat(threat, ceramic - 2e-6, backing - 2e-6)


def test_no_armour_in_proportion():
    assert least_in_proportion(case(velocity=3000.0)) is None
    apart = {
        "ceramic_thickness_mm": {"min": 1.0, "max": 2.0, "step": 0.5},
        "backing_thickness_mm": {"min": 10.0, "max": 20.0, "step": 0.5},
    }
    assert least_in_proportion(case(apart)) is None


def test_a_bare_plate_in_proportion():
    bare = scenario(
        ceramic=None,
        ceramic_mm=0.0,
        velocity=500.0,
        optimise={**WIDE, "ceramic_thickness_mm": {"min": 0.0, "max": 0.0, "step": 1.0}},
    )
    design = least_in_proportion(bare)
    assert design is not None
    assert design.ceramic_thickness_mm == 0.0
    assert design == least_backing(bare, 0.0)


def test_the_grid_must_be_there():
    with pytest.raises(InputError, match="optimise: is missing"):
        grid(scenario())
