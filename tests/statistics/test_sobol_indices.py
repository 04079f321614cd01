"""Sobol' indices against functions whose indices are known in closed form."""

from math import pi

import numpy as np
import pytest

from armour.analysis.variants import Floats
from armour.scenario.sampling import columns_of, points_of
from armour.scenario.schema import Uncertainty
from armour.statistics.uncertainty import first_order_indices, total_indices

INPUTS = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa", "backing.density_kg_m3"]


def section_of(distribution: dict[str, object], samples: int, **keys: object) -> Uncertainty:
    """Three inputs of a distribution."""
    ceramic = {"density_kg_m3": distribution, "flow_stress_GPa": distribution}
    return Uncertainty.model_validate(
        {"ceramic": ceramic, "backing": {"density_kg_m3": distribution}, "samples": samples, **keys}
    )


def ishigami(points: Floats) -> Floats:
    a, b, c = pi * (2.0 * points.T - 1.0)
    found: Floats = np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)
    return found


@pytest.mark.parametrize("method", ["sobol", "latin hypercube"])
def test_ishigamis_function(method: str):
    """Saltelli et al., Global Sensitivity Analysis, 2008."""
    v1, v2, v13 = 0.5 * (1.0 + 0.1 * pi**4 / 5.0) ** 2, 7.0**2 / 8.0, 0.1**2 * pi**8 * 8.0 / 225.0
    section = section_of({"distribution": "uniform", "min": -pi, "max": pi}, 4096, method=method)
    points = points_of(section)
    first = first_order_indices(section, points, ishigami(points))
    total = total_indices(ishigami, [0, 1, 2], 3, 4096, 1)
    for found, variances in ((first, (v1, v2, 0.0)), (total, (v1 + v13, v2, v13))):
        for estimate, variance in zip(found, variances, strict=True):
            true = variance / (v1 + v2 + v13)
            assert estimate.value == pytest.approx(true, abs=0.02)
            # Not each of a dozen intervals need hold the truth.
            assert abs(estimate.value - true) < 1.5 * (estimate.high - estimate.value)


def test_a_linear_function_of_correlated_inputs():
    """The first-order index of x1 of a sum is (a1 + rho a2)^2 / Var."""
    section = section_of(
        {"distribution": "normal", "mean": 0.0, "standard_deviation": 1.0},
        1024,
        correlation=[{"between": INPUTS[:2], "coefficient": 0.6}],
    )
    points = points_of(section)
    assert list(section.inputs()) == INPUTS
    a, b, c = columns_of(section, dict.fromkeys(INPUTS, 0.0), points).values()
    found = first_order_indices(section, points, 2.0 * a - b + c)
    whole = 4.0 + 1.0 - 2.4 + 1.0
    for estimate, true in zip(found, (1.4**2 / whole, 0.2**2 / whole, 1.0 / whole), strict=True):
        assert estimate.low < true < estimate.high
        assert estimate.high - estimate.low < 0.1
