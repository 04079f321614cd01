"""Quantities of a scenario, against the results of a single impact and of a single search."""

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.impact import simulate
from armour.analysis.quantities import OF_IMPACT, OF_WEIGHT, QUANTITIES, label_and_unit
from armour.scenario.scenario import Scenario
from tests.helpers.cases import grid, scenario

# An output of an impact is an attribute of ImpactResult; of losses, it has what is left.
LOSSES = ("velocity_lost_percent", "mass_lost_percent")
IMPACT = [name for name, each in QUANTITIES.items() if each.reads in (OF_IMPACT, OF_WEIGHT) and name not in LOSSES]
GRID = grid((0.0, 60.0, 0.5), (1.0, 60.0, 0.5))
THIN = {layer: {"min": 0.5, "max": 2.0, "step": 0.5} for layer in GRID}


def value(name: str, of: Scenario) -> float | str:
    found: float | str = evaluate(of, {}, [name])[name][0].item()
    return found


def number(name: str, of: Scenario) -> float:
    return float(value(name, of))


@pytest.mark.parametrize("name", IMPACT)
@pytest.mark.parametrize("velocity", [800.0, 500.0])
def test_quantities_of_an_impact_are_those_of_its_result(name: str, velocity: float):
    of = scenario(velocity=velocity)
    assert value(name, of) == getattr(simulate(of), name)


@pytest.mark.parametrize("ceramic", ["AD85", "SiC"])
def test_the_expected_limit_is_that_given_the_tests(ceramic: str):
    found, known = number("expected_limit_m_s", scenario(ceramic=ceramic)), ceramic == "AD85"
    expected = ballistic_limit(scenario(ceramic=ceramic)).expected_limit_m_s
    assert (expected is not None) == known
    assert found == (pytest.approx(expected, rel=1e-9) if known else pytest.approx(np.nan, nan_ok=True))


def test_losses():
    found = simulate(scenario())
    velocity = 100.0 * (1.0 - found.residual_velocity_m_s / 800.0)
    assert value("velocity_lost_percent", scenario()) == pytest.approx(velocity)
    assert value("mass_lost_percent", scenario()) == pytest.approx(100.0 * (1.0 - found.residual_mass_g / 5.46))


@pytest.mark.parametrize("layer", ["ceramic", "backing"])
def test_the_required_thickness_just_stops_the_impact(layer: str):
    of = scenario(optimise=GRID)
    key = f"armour.{layer}_thickness_mm"
    required = number(f"required_{layer}_thickness_mm", of)
    assert simulate(of.replaced({key: required})).outcome == "stopped"
    assert simulate(of.replaced({key: required - 2e-6})).outcome == "perforated"


def test_the_required_areal_density_is_that_of_the_required_ceramic():
    of = scenario(optimise=GRID)
    ceramic = number("required_ceramic_thickness_mm", of)
    assert number("required_areal_density_kg_m2", of) == pytest.approx(3.43 * ceramic + 2.75 * 6.35)


def test_the_required_total_thickness_keeps_the_proportions():
    of = scenario(optimise=GRID)
    total = number("required_total_thickness_mm", of)
    for thickness, outcome in ((total, "stopped"), (total - 2e-6, "perforated")):
        layers = {f"armour.{layer}_thickness_mm": 0.5 * thickness for layer in ("ceramic", "backing")}
        assert simulate(of.replaced(layers)).outcome == outcome


@pytest.mark.parametrize("name", [name for name, quantity in QUANTITIES.items() if quantity.on_grid])
def test_no_thickness_of_the_range_is_enough(name: str):
    assert np.isnan(number(name, scenario(ceramic_mm=1.0, backing_mm=1.0, optimise=THIN)))


@pytest.mark.parametrize("name", [name for name, quantity in QUANTITIES.items() if quantity.on_grid])
def test_the_least_thickness_of_the_range_is_enough(name: str):
    grid = {**GRID, "ceramic_thickness_mm": {"min": 20.0, "max": 30.0, "step": 1.0}}
    of = scenario(ceramic_mm=20.0, backing_mm=20.0, optimise=grid)
    least = {
        "required_ceramic_thickness_mm": 20.0,
        "required_backing_thickness_mm": 1.0,
        "required_total_thickness_mm": 40.0,
        "required_areal_density_kg_m2": 20.0 * (3.43 + 2.75),
    }
    assert number(name, of) == pytest.approx(least[name], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("armour.ceramic_thickness_mm", ("tile thickness", "mm")),
        ("ballistic_limit_m_s", ("ballistic limit", "m/s")),
        ('library.metal."x".density_kg_m3', ("x density", "kg/m³")),
        ("model.limit_error_percent", ("model error", "%")),
        ("armour.backing_thickness_mm", ("plate thickness", "mm")),
        ("metal.youngs_modulus_GPa", ("Young's modulus", "GPa")),
        ("outcome", ("outcome by the model", "")),
    ],
)
def test_labels_of_keys_and_quantities(name: str, expected: tuple[str, str]):
    assert label_and_unit(name) == expected
