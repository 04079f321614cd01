from typing import Any

import pytest
from pydantic import ValidationError

from armour.scenario.schema import Distribution, Uncertainty
from tests.helpers.cases import scenario

NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
SECTION = {"ceramic": {"density_kg_m3": NORMAL, "flow_stress_GPa": NORMAL}, "armour": {"backing_thickness_mm": NORMAL}}
PAIR = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"distribution": "normal"}, "must have standard_deviation or standard_deviation_percent"),
        ({"distribution": "normal", "standard_deviation": 1.0, "standard_deviation_percent": 1.0}, "and not both"),
        ({"distribution": "uniform", "min": 1.0}, "a uniform distribution must have min and max, and nothing else"),
        ({"distribution": "uniform", "min": 1.0, "max": 2.0, "mean": 1.5}, "and nothing else"),
        (
            {"distribution": "normal", "standard_deviation": 1.0, "min": 3.0, "max": 2.0},
            "must be above min, which is 3, found 2",
        ),
    ],
)
def test_wrong_distributions(keys: dict[str, Any], message: str):
    with pytest.raises(ValidationError, match=message):
        Distribution.model_validate(keys)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"samples": 1000}, "must be a power of 2 for Sobol' points, such as 1024, found 1000"),
        ({"samples": 2**21 + 1, "method": "latin hypercube"}, "must be at most 2097152 for a Latin hypercube"),
        ({"correlation": [{"between": [PAIR[0], "hardness"], "coefficient": 0.5}]}, 'found "hardness"'),
        ({"correlation": [{"between": [PAIR[0], PAIR[0]], "coefficient": 0.5}]}, "must name two inputs"),
        ({"correlation": [{"between": PAIR, "coefficient": 0.5}] * 2}, "each two once"),
        (
            {
                "correlation": [
                    {"between": PAIR, "coefficient": 0.9},
                    {"between": [PAIR[0], "armour.backing_thickness_mm"], "coefficient": 0.9},
                    {"between": [PAIR[1], "armour.backing_thickness_mm"], "coefficient": -0.9},
                ]
            },
            "not positive definite",
        ),
    ],
)
def test_wrong_sections(keys: dict[str, Any], message: str):
    with pytest.raises(ValidationError, match=message):
        Uncertainty.model_validate({**SECTION, **keys})


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
