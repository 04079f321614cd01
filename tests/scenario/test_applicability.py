from functools import cache

import pytest

from armour.scenario.applicability import BACKING, CERAMIC, SLENDERNESS, VELOCITY, DataRange, warnings_of
from armour.scenario.library import penetrator_length_mm
from armour.validation.suite import load_suite
from armour.validation.validate import paper_suite
from tests.helpers.cases import scenario


@cache
def covered() -> dict[DataRange, list[float]]:
    """Values of the paper's cases, without those with an initial flow stress."""
    found: dict[DataRange, list[float]] = {VELOCITY: [], CERAMIC: [], BACKING: [], SLENDERNESS: []}
    for case in load_suite(paper_suite()).cases:
        armour = case.scenario.armour
        # Rows of a table are scored together where they are not each.
        if (case.not_scored and not case.group) or (armour.ceramic or "").endswith("initial"):
            continue
        projectile = case.scenario.entry("projectile", case.scenario.impact.projectile)
        diameter = projectile["penetrator_diameter_mm"]
        is_limit = case.quantity == "ballistic_limit_m_s" and case.measured is None
        found[VELOCITY].append(float(case.expected) if is_limit else case.scenario.impact.velocity_m_s)
        found[CERAMIC].append(armour.ceramic_thickness_mm / diameter)
        found[BACKING].append(armour.backing_thickness_mm / diameter)
        found[SLENDERNESS].append(penetrator_length_mm(projectile) / diameter)
    return found


@pytest.mark.parametrize("data", [VELOCITY, CERAMIC, BACKING, SLENDERNESS], ids=lambda data: data.words)
def test_the_ranges_are_those_of_the_published_cases(data: DataRange):
    values = covered()[data]
    assert data.low <= min(values) <= 1.04 * data.low
    assert 0.96 * data.high <= max(values) <= data.high


def test_no_warning_within_the_validated_range():
    assert warnings_of(scenario(), 723.8) == ()


@pytest.mark.parametrize(
    ("changes", "velocity", "start"),
    [
        ({}, 2000.0, "impact.velocity_m_s: the model was tested on velocities from 620 to 1300 m/s, found 2e+03"),
        ({"ceramic_mm": 60.0}, 800.0, "armour.ceramic_thickness_mm: the model was tested on ceramics"),
        ({"backing_mm": 1.0}, 800.0, "armour.backing_thickness_mm: the model was tested on back plates"),
    ],
)
def test_a_quantity_outside_the_validated_range_is_named(changes: dict[str, float], velocity: float, start: str):
    [warning] = warnings_of(scenario(**changes), velocity)
    assert warning.startswith(start)


def test_a_stubby_penetrator():
    stub = {"projectile": {"stub": {"based_on": "7.62 mm AP", "penetrator_diameter_mm": 9.0}}}
    case = scenario(projectile="stub", ceramic_mm=9.0, backing_mm=9.0, library=stub)
    [warning] = warnings_of(case, 800.0)
    assert warning.startswith("impact.projectile: the model was tested on penetrators from 3.2 to 5.4 diameters long")
