from functools import cache

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.design.catalogue import Catalogue, catalogue_of
from armour.design.map import DesignMap, design_map
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario, shipped_scenario

pytestmark = pytest.mark.slow

PROBABILITIES = (0.02, 0.5, 0.8, 0.95)


@cache
def offered() -> Catalogue:
    return catalogue_of(shipped_scenario("catalogue"))


@cache
def found() -> DesignMap:
    return design_map(offered(), 0, [6.0, 9.0, 12.0], [5.0, 8.0], PROBABILITIES)


def armour_of(i: int, j: int, threat: int) -> Scenario:
    return (
        offered()
        .against(0, threat)
        .replaced(
            {
                "armour.ceramic_thickness_mm": float(found().ceramic_mm[i]),
                "armour.backing_thickness_mm": float(found().backing_mm[j]),
            }
        )
    )


def test_limits_are_those_of_each_armour_alone():
    assert found().limits_m_s.shape == (3, 2, 2)
    for place in np.ndindex(3, 2, 2):
        alone = ballistic_limit(armour_of(*place)).ballistic_limit_m_s
        assert found().limits_m_s[place] == pytest.approx(alone, abs=0.02)


def test_a_velocity_that_is_stopped_with_a_probability_has_that_probability():
    for probability in PROBABILITIES:
        velocity = float(found().stopped_with(probability)[1, 1, 1])
        alone = confidence(armour_of(1, 1, 1).replaced({"impact.velocity_m_s": velocity})).probability_of_stopping
        assert alone == pytest.approx(probability, abs=1e-4)


def test_no_velocity_is_known_where_the_error_of_the_model_is_not():
    silicon = catalogue_of(
        scenario(
            ceramic="SiC",
            optimise={
                f"{layer}_thickness_mm": {"min": 5.0, "max": 6.0, "step": 1.0} for layer in ("ceramic", "backing")
            },
        )
    )
    of = design_map(silicon, 0, [5.0], [5.0], PROBABILITIES)
    assert np.isfinite(of.limits_m_s).all()
    assert np.isnan(of.stopped_m_s).all()
