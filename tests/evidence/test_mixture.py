import numpy as np
import pytest
from scipy import stats

from armour.evidence.mixture import Mixture, probability_below, quantile

WEIGHTS, LOCATIONS = np.array([0.5, 0.2, 0.3]), np.array([6.4, 6.6, 6.7])
SCALES, FREEDOM = np.array([0.05, 0.1, 0.03]), np.array([5.0, 1e6, 12.0])
ONE = Mixture(np.array([1.0]), np.array([6.5]), np.array([0.05]), np.array([7.0]))
THREE = Mixture(WEIGHTS, LOCATIONS, SCALES, FREEDOM)
NARROWED = THREE._replace(narrowed=np.array([1.0, 0.5, 0.8]))
PROBABILITIES = np.array([0.001, 0.025, 0.5, 0.8, 0.975, 0.999])


def test_the_probability_is_that_of_the_components():
    for velocity in (500.0, 700.0, 900.0):
        above = stats.t.sf(np.log(velocity), FREEDOM, LOCATIONS, SCALES)
        assert THREE.probability_above(velocity) == pytest.approx(WEIGHTS @ above, rel=1e-9)


APART = Mixture(WEIGHTS, np.array([6.0, 6.5, 9.0]), np.array([0.01, 1e-4, 0.3]), FREEDOM)


def test_quantiles_invert_the_probability():
    for mixture in (THREE, ONE, APART, NARROWED):
        above = mixture.probability_above(mixture.quantile(PROBABILITIES))
        assert 1.0 - above == pytest.approx(PROBABILITIES, abs=1e-9)
    assert THREE.quantile([0.0, 1.0]) == pytest.approx([0.0, np.inf])


def test_with_normal_limits_the_scatter_is_exact():
    number = Mixture(np.ones(1), np.array([660.0]), np.array([30.0]), np.array([1e6]), logarithmic=False)
    velocities = np.array([550.0, 650.0, 700.0])
    exact = stats.norm.sf(velocities, 660.0, np.hypot(30.0, 0.025 * 660.0))
    assert number.of_shots(0.025).probability_above(velocities) == pytest.approx(exact, abs=1e-6)


def test_a_scatter_widens_both_sides_and_none_changes_nothing():
    for mixture in (THREE, NARROWED):
        assert mixture.of_shots(0.0).quantile(PROBABILITIES) == pytest.approx(mixture.quantile(PROBABILITIES))
    shots = NARROWED.of_shots(0.03)
    assert shots.scales == pytest.approx(np.hypot(SCALES, 0.03))
    assert shots.scales * shots.narrowed == pytest.approx(np.hypot(SCALES * NARROWED.narrowed, 0.03))


def test_the_density_is_the_derivative_of_the_probability():
    velocities = np.array([450.0, 600.0, 750.0, 900.0])
    for mixture in (THREE, NARROWED):
        slopes = mixture.probability_above(velocities - 0.01) - mixture.probability_above(velocities + 0.01)
        assert np.exp(mixture.log_density(velocities)) == pytest.approx(slopes / 0.02, rel=1e-5)


def test_draws_have_the_distribution():
    which, values = THREE.drawn((np.arange(20_000) + 0.5) / 20_000)
    assert np.bincount(which) / 20_000 == pytest.approx(WEIGHTS, abs=1e-4)
    assert np.quantile(values, PROBABILITIES[1:-1]) == pytest.approx(THREE.quantile(PROBABILITIES[1:-1]), rel=1e-4)


def test_a_mixture_of_many_armours_is_that_of_each():
    columns = np.array([1.0, 1.1, 0.9])
    weights, locations, scales = (np.stack([array] * 3, axis=1) for array in (WEIGHTS, LOCATIONS, SCALES))
    many = Mixture(weights, locations, scales, np.stack([FREEDOM] * 3, axis=1)).times(columns)
    velocities = np.array([600.0, 700.0, 800.0])
    for i, (factor, velocity) in enumerate(zip(columns, velocities, strict=True)):
        single = THREE.times(factor)
        assert many.probability_above(velocities)[i] == pytest.approx(single.probability_above(velocity))
        assert many.quantile(0.1 * columns)[i] == pytest.approx(single.quantile(0.1 * factor))


def test_numbers_of_an_armour_do_not_depend_on_how_many_are_computed_with_it():
    """A sweep computes as many rows at a time as it has measured to take about a second."""
    shifts = np.linspace(-0.5, 0.5, 2000)
    many = THREE.mapped(lambda array: np.repeat(array[:, None], len(shifts), axis=1))
    many = many._replace(locations=many.locations + shifts)
    few = many.mapped(lambda array: array[:, 700:702])
    np.testing.assert_array_equal(few.quantile(0.025), many.quantile(0.025)[700:702])
    np.testing.assert_array_equal(few.probability_above(650.0), many.probability_above(650.0)[700:702])
    chances = np.linspace(0.0, 1.0, 2000)
    np.testing.assert_array_equal(THREE.drawn(chances[700:702])[1], THREE.drawn(chances)[1][700:702])


def test_the_distribution_of_an_unknown_armour_is_unknown():
    weights = np.array([[1.0, np.nan]])
    mixture = Mixture(weights, np.full((1, 2), 6.5), np.full((1, 2), 0.1), np.full((1, 2), 9.0))
    assert np.isnan(mixture.probability_above(np.array([700.0, 700.0]))).tolist() == [False, True]
    assert np.isnan(mixture.quantile(np.array([0.5, 0.5]))).tolist() == [False, True]


def test_without_logarithm_the_number_itself_is_distributed():
    ratio = Mixture(np.ones(1), np.array([1.02]), np.array([0.05]), np.array([8.0]), logarithmic=False)
    distribution = ratio.times(700.0)
    assert distribution.probability_above(650.0) == pytest.approx(stats.t.sf(650.0, 8.0, 714.0, 35.0))
    assert distribution.quantile(0.05) == pytest.approx(stats.t.ppf(0.05, 8.0, 714.0, 35.0))
    assert np.exp(distribution.log_density(650.0)) == pytest.approx(stats.t.pdf(650.0, 8.0, 714.0, 35.0))


MANY_FREEDOMS = np.array([2.5, 3.0, 7.0, 30.0, 199.0, 201.0, 2e3, 1e6])[:, None]


def test_probabilities():
    values = np.array([-50.0, -8.0, -1.0, -1e-9, 0.0, 0.3, 2.0, 30.0])
    probabilities = probability_below(MANY_FREEDOMS, values, many=False)
    np.testing.assert_allclose(probabilities, stats.t.cdf(values, MANY_FREEDOMS), rtol=0.0, atol=1e-12)


def test_quantiles():
    probabilities = np.array([1e-3, 0.025, 0.2, 0.5, 0.9, 0.999])
    quantiles = quantile(MANY_FREEDOMS, probabilities, many=False)
    np.testing.assert_allclose(quantiles, stats.t.ppf(probabilities, MANY_FREEDOMS), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("many", [False, True])
def test_ends(many: bool):
    ends = quantile(np.array([5.0]), np.array([0.0, 1.0, np.nan]), many=many)
    np.testing.assert_array_equal(ends, [-np.inf, np.inf, np.nan])
