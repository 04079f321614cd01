"""Least areal densities of free thicknesses."""

import numpy as np
import pytest

from armour.analysis.variants import variants_of
from armour.design.free import least_areal_densities
from armour.design.optimise import optimise
from tests.helpers.cases import scenario


def test_least_areal_densities_are_those_of_refined_designs():
    grid = {
        "ceramic_thickness_mm": {"min": 4.0, "max": 14.0, "step": 1.0},
        "backing_thickness_mm": {"min": 4.0, "max": 9.0, "step": 1.0},
    }
    of = scenario(backing="5083-H3", optimise=grid)
    velocities = [750.0, 850.0, 3000.0]
    least = least_areal_densities(variants_of(of, {"impact.velocity_m_s": np.array(velocities)}, 3))
    for velocity, found in zip(velocities[:2], least[:2], strict=True):
        refined = optimise(of.replaced({"impact.velocity_m_s": velocity}), refine=True).refined
        assert refined is not None
        assert found == pytest.approx(refined.areal_density_kg_m2, abs=1e-5)
    assert np.isnan(least[2])
