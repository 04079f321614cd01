import pytest

from armour.analysis.estimates import Estimate, proportion


def test_clopper_pearson_intervals():
    assert proportion(0, 100).low == 0.0
    assert proportion(0, 100).high == pytest.approx(1.0 - 0.025 ** (1 / 100))
    assert proportion(100, 100).high == 1.0


def test_samples_for_a_last_digit():
    estimate = Estimate(0.2, 0.19, 0.21)
    assert estimate.samples_for(0.001, 1000) == 400_000
    assert estimate.samples_for(0.1, 1000) == 1000
