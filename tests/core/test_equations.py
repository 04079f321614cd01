"""Each relation against a number calculated by hand or the balance that it solves."""

from math import isclose, sqrt

import pytest

from armour.core import equations as eq


def test_crack_velocity_is_a_fifth_of_the_bar_wave():
    assert isclose(eq.crack_velocity(267e9, 3430.0), 1764.5687, rel_tol=1e-7)


@pytest.mark.parametrize(
    ("law", "factor"),
    [
        ((0.0, 0.0, 0.0, 0.0), 1.0),
        ((2.0, 0.0, 0.0, 0.0), 0.25),
        ((0.0, -0.5, 0.0, 0.0), 1.0),
        ((0.0, 0.0, 0.2, 0.0), 1.2),
        ((0.0, 0.0, 0.0, -0.5), 1.25),
        ((-1.0, 3.0, 0.5, 0.2), 2.0 * 1.0 * (1.0 + 0.5 - 0.1)),
        ((-3.0, 0.0, 3.0, 0.0), 20.0),
        ((0.0, 0.0, -3.0, 0.0), 0.05),
    ],
)
def test_intact_strength_by_a_law(law: tuple[float, float, float, float], factor: float):
    """Ceramic two diameters thick on a plate of half a diameter; the factor is limited to 0.05 and 20."""
    assert isclose(eq.intact_strength(5e9, 8.0, 16.0, 4.0, *law), 5e9 * factor)
    assert eq.intact_strength(5e9, 8.0, 8.0, 8.0, *law) == 5e9


def test_intact_strength_by_the_product_of_the_thicknesses():
    assert isclose(eq.intact_strength(5e9, 8.0, 16.0, 12.0, 0.0, 0.5, 0.0, 0.0), 5e9 * sqrt(3.0))
    assert isclose(eq.intact_strength(5e9, 8.0, 16.0, 12.0, -1.0, 0.5, 0.0, 0.0), 5e9 * sqrt(3.0) / 1.5)


def test_fragmented_strength_falls_with_the_square_of_the_relative_velocity():
    assert isclose(eq.fragmented_strength(5.2e9, 500.0, 200.0, 600.0), 1.3e9)


@pytest.mark.parametrize("rho", [1000.0, 2750.0, 7850.0, 17000.0])
@pytest.mark.parametrize("w", [0.0, 100.0, 650.0, 699.0])
@pytest.mark.parametrize("y", [0.0, 0.9e9, 2.35e9])
def test_penetration_velocity_balances_the_pressures(rho: float, w: float, y: float):
    """Both sides of the interface carry the same pressure (5), (8), (20)."""
    u = eq.penetration_velocity(y, rho, 2.35e9, 7850.0, 700.0, w)
    projectile = eq.projectile_pressure(2.35e9, 7850.0, 700.0, u)
    target = eq.target_pressure(y, rho, u, w)
    assert isclose(projectile, target, rel_tol=1e-12)


def test_penetration_velocity_without_strength_is_a_golden_section():
    """For equal densities V (V - U) = U^2, unlike Bernoulli's U = V/2."""
    u = eq.penetration_velocity(0.0, 7850.0, 0.0, 7850.0, 1000.0, 0.0)
    assert isclose(u, 1000.0 * (sqrt(5.0) - 1.0) / 2.0)


def test_penetration_velocity_meets_w_where_the_target_stops_yielding():
    v, w = 700.0, 150.0
    y = 2.35e9 + 7850.0 * v * (v - w)
    assert isclose(eq.penetration_velocity(y, 3430.0, 2.35e9, 7850.0, v, w), w)
    assert abs(eq.target_excess(y, 2.35e9, 7850.0, v, w)) < 1e-3


def test_penetration_velocity_meets_v_where_the_projectile_stops_yielding():
    v, w = 700.0, 150.0
    y = 2.35e9 - 3430.0 * v * (v - w)
    assert isclose(eq.penetration_velocity(y, 3430.0, 2.35e9, 7850.0, v, w), v)
    assert abs(eq.projectile_excess(y, 3430.0, 2.35e9, v, w)) < 1e-3
