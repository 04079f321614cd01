"""Simpler formulas, against published check values and their conditions of optimality."""

from math import pi, sqrt

import numpy as np
import pytest

from armour.validation.formulas import (
    Plates,
    conoid_radius,
    fit_areal_density_rule,
    fit_lambert_jonas,
    fit_recht_ipson,
    florence_limit,
    florence_split,
    residual_velocity,
)

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
    area = pi * conoid_radius(RADIUS, p.h1) ** 2
    moved = (p.rho1 * p.h1 + p.rho2 * p.h2) * area
    energy = p.eps2 * p.sigma2 * p.h2 * area / 0.91
    assert florence_limit(MASS, RADIUS, p) == pytest.approx(sqrt(energy * (MASS + moved)) / MASS)


@pytest.mark.parametrize("areal_density", [5.0, 20.0, 40.0, 80.0, 300.0])
@pytest.mark.parametrize("mass", [5e-3, 95e-3])
def test_the_split_is_the_best_of_its_areal_density(areal_density: float, mass: float):
    h1, h2 = florence_split(mass, RADIUS, 3420.0, 2700.0, areal_density)
    assert 3420.0 * h1 + 2700.0 * h2 == pytest.approx(areal_density)
    best = florence_limit(mass, RADIUS, plates(h1, h2))
    for other in np.linspace(0.0, areal_density / 3420.0, 500, endpoint=False):
        assert florence_limit(mass, RADIUS, plates(other, (areal_density - 3420.0 * other) / 2700.0)) <= best + 1e-9
    a = conoid_radius(RADIUS, h1)
    loaded = pi * a * a * areal_density
    assert 3420.0 / (2700.0 * h2) == pytest.approx(4.0 / a * (1.0 + loaded / (mass + loaded)))


def test_the_split_of_a_very_thin_armour_is_a_bare_plate():
    assert florence_split(MASS, RADIUS, 3420.0, 2700.0, 2.0) == (0.0, 2.0 / 2700.0)


def test_residual_velocity_is_recht_and_ipsons_for_exponent_2():
    assert residual_velocity(1000.0, 800.0, 0.9, 2.0) == pytest.approx(0.9 * 600.0)
    assert residual_velocity(800.0, 800.0, 0.9, 2.0) == 0.0
    assert residual_velocity(700.0, 800.0, 0.9, 2.0) == 0.0
    assert residual_velocity(1000.0, 800.0, 1.0, 300.0) == pytest.approx(1000.0)


@pytest.mark.parametrize(("ratio", "exponent"), [(0.9, 2.0), (0.8, 3.3), (1.0, 1.4)])
def test_fits_recover_what_they_are_given(ratio: float, exponent: float):
    impact = np.linspace(805.0, 1300.0, 40).tolist()
    residual = [residual_velocity(v, 800.0, ratio, exponent) for v in impact]
    fit = fit_lambert_jonas(impact, residual, 800.0)
    assert fit.ratio == pytest.approx(ratio, abs=1e-4)
    assert fit.exponent == pytest.approx(exponent, abs=1e-3)
    assert fit.rms_m_s < 0.1
    simple = fit_recht_ipson(impact, residual, 800.0)
    assert simple.exponent == 2.0
    assert simple.rms_m_s >= fit.rms_m_s - 1e-3
    if exponent == 2.0:
        assert simple.ratio == pytest.approx(ratio)


def test_no_fit_gives_more_than_the_impact_velocity():
    impact = [900.0, 1000.0, 1100.0]
    assert fit_lambert_jonas(impact, impact, 800.0).ratio <= 1.0
    assert fit_recht_ipson(impact, impact, 800.0).ratio == 1.0


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
