"""Simpler formulas, against published check values and other forms."""

from math import pi, sqrt

import numpy as np
import pytest

from armour.validation.formulas import Plates, fit_areal_density_rule, florence_limit

MASS, RADIUS = 8.32e-3, 3.81e-3


def plates(h1: float, h2: float) -> Plates:
    return Plates(3420.0, h1, 2700.0, h2, 310e6, 0.17)


@pytest.mark.parametrize(
    ("ceramic_mm", "backing_mm", "limit"), [(6.35, 6.35, 435.02), (8.64, 6.35, 739.00), (8.0, 5.0, 550.18)]
)
def test_florence_check_values(ceramic_mm: float, backing_mm: float, limit: float):
    found = florence_limit(MASS, RADIUS, plates(ceramic_mm * 1e-3, backing_mm * 1e-3))
    assert found == pytest.approx(limit, abs=0.005)


def test_florence_in_another_form():
    """Energy of the plate's stretching, shared with the mass that moves along."""
    p = plates(7e-3, 6e-3)
    area = pi * (RADIUS + 2.0 * p.h1) ** 2
    moved = (p.rho1 * p.h1 + p.rho2 * p.h2) * area
    energy = p.eps2 * p.sigma2 * p.h2 * area / 0.91
    assert florence_limit(MASS, RADIUS, p) == pytest.approx(sqrt(energy * (MASS + moved)) / MASS)


DENSITIES = np.array([30.0, 35.0, 42.0, 47.0, 60.0])


@pytest.mark.parametrize(("k", "p"), [(17.6, 1.0), (40.0, 0.8), (700.0, 0.0)])
def test_the_rule_recovers_what_it_is_given(k: float, p: float):
    limits = k * DENSITIES**p
    for given in (p, None):
        rule = fit_areal_density_rule(DENSITIES, limits, given)
        assert rule.p == pytest.approx(p, abs=1e-5)
        assert rule.k == pytest.approx(k, rel=1e-4)
    assert rule.limit(50.0) == pytest.approx(k * 50.0**p)


def test_the_rule_has_the_least_squares_of_the_relative_errors():
    limits = np.array([500.0, 640.0, 690.0, 850.0, 930.0])

    def squares(k: np.ndarray, p: float) -> np.ndarray:
        found: np.ndarray = ((np.multiply.outer(k, DENSITIES**p) / limits - 1.0) ** 2).sum(-1)
        return found

    for p in (1.0, 0.8, None):
        rule = fit_areal_density_rule(DENSITIES, limits, p)
        near = rule.k * np.linspace(0.9, 1.1, 201)
        assert squares(near, rule.p).argmin() == 100
        if p is None:
            others = [
                squares(k, q).min() for q in rule.p + np.linspace(-0.2, 0.2, 21) for k in [near * 42.0 ** (rule.p - q)]
            ]
            assert np.argmin(others) == 10
