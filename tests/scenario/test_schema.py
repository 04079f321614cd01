from typing import Any

import pytest

from armour.scenario.schema import Distribution
from tests.helpers.cases import scenario

NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
SECTION = {"ceramic": {"density_kg_m3": NORMAL, "flow_stress_GPa": NORMAL}, "armour": {"backing_thickness_mm": NORMAL}}
PAIR = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"]


@pytest.mark.parametrize(
    ("keys", "own", "message"),
    [
        ({"distribution": "lognormal", "standard_deviation": 1.0}, 0.0, "must have a mean greater than 0"),
        ({"distribution": "lognormal", "standard_deviation": 1.0, "mean": 2.0}, 0.0, ""),
        ({"distribution": "normal", "standard_deviation_percent": 1.0}, 0.0, "must have standard_deviation"),
        ({"distribution": "normal", "standard_deviation": 1.0}, 0.0, ""),
    ],
)
def test_a_mean_that_is_impossible(keys: dict[str, Any], own: float, message: str):
    problem = Distribution.model_validate(keys).mean_problem(own)
    assert problem.startswith(message)
    assert bool(problem) == bool(message)


def test_a_thickness_on_offer_may_be_a_plain_number():
    layers = {"backing": [{"material": "6061-T6", "thickness_mm": 20.0}]}
    design = scenario(design=layers).design
    assert design is not None
    assert design.backing[0].thicknesses() == (20.0,)
