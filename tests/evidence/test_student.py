"""Student's t distribution, against scipy's."""

import numpy as np
import pytest
from scipy.stats import t

from armour.evidence import student

FREEDOM = np.array([2.5, 3.0, 7.0, 30.0, 199.0, 201.0, 2e3, 1e6])[:, None]


def test_probabilities():
    values = np.array([-50.0, -8.0, -1.0, -1e-9, 0.0, 0.3, 2.0, 30.0])
    probabilities = student.probability_below(FREEDOM, values, many=False)
    np.testing.assert_allclose(probabilities, t.cdf(values, FREEDOM), rtol=0.0, atol=1e-12)


def test_quantiles():
    probabilities = np.array([1e-3, 0.025, 0.2, 0.5, 0.9, 0.999])
    quantiles = student.quantile(FREEDOM, probabilities, many=False)
    np.testing.assert_allclose(quantiles, t.ppf(probabilities, FREEDOM), rtol=1e-10, atol=1e-12)


def test_density():
    np.testing.assert_allclose(student.density_at_0(FREEDOM), t.pdf(0.0, FREEDOM), rtol=1e-12)


@pytest.mark.parametrize("many", [False, True])
def test_ends(many: bool):
    ends = student.quantile(np.array([5.0]), np.array([0.0, 1.0, np.nan]), many=many)
    np.testing.assert_array_equal(ends, [-np.inf, np.inf, np.nan])


def test_one_and_many_are_alike():
    values, freedom = np.linspace(-5.0, 5.0, 101), np.array(5.0)
    chances = student.probability_below(freedom, values, many=True)
    np.testing.assert_allclose(student.probability_below(freedom, values, many=False), chances, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(student.quantile(freedom, chances, many=False), values, rtol=1e-10, atol=1e-12)
