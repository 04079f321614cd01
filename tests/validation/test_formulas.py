"""Simpler formulas, against published check values and other forms."""

from math import pi, sqrt

import numpy as np
import pytest

from armour.validation.formulas import fitted_factor, florence_limit

MASS, RADIUS = 8.32e-3, 3.81e-3


@pytest.mark.parametrize(
    ("ceramic_mm", "backing_mm", "limit"), [(6.35, 6.35, 435.02), (8.64, 6.35, 739.00), (8.0, 5.0, 550.18)]
)
def test_florence_check_values(ceramic_mm: float, backing_mm: float, limit: float):
    plates = 3420.0, ceramic_mm * 1e-3, 2700.0, backing_mm * 1e-3, 310e6, 0.17
    assert florence_limit(MASS, RADIUS, *plates) == pytest.approx(limit, abs=0.005)


def test_florence_in_another_form():
    """Energy of the plate's stretching, shared with the mass that moves along."""
    area = pi * (RADIUS + 2.0 * 7e-3) ** 2
    moved = (3420.0 * 7e-3 + 2700.0 * 6e-3) * area
    energy = 0.17 * 310e6 * 6e-3 * area / 0.91
    found = florence_limit(MASS, RADIUS, 3420.0, 7e-3, 2700.0, 6e-3, 310e6, 0.17)
    assert found == pytest.approx(sqrt(energy * (MASS + moved)) / MASS)


def test_the_rule_has_the_least_squares_of_the_relative_errors():
    densities, limits = np.array([30.0, 35.0, 42.0, 47.0]), np.array([500.0, 640.0, 690.0, 850.0])
    assert fitted_factor(densities, 17.6 * densities) == pytest.approx(17.6)
    near = fitted_factor(densities, limits) * np.linspace(0.9, 1.1, 201)
    squares = ((np.multiply.outer(near, densities) / limits - 1.0) ** 2).sum(-1)
    assert squares.argmin() == 100
