"""Estimates from samples, against scipy and the properties that define them."""

import numpy as np
import pytest
from scipy import stats

from armour.analysis.estimates import mean_of_replicates, proportion, proportion_of_replicates


def test_clopper_pearson_intervals():
    for hits in (0, 3, 50, 100):
        found, true = proportion(hits, 100), stats.binomtest(hits, 100).proportion_ci()
        assert (found.low, found.value, found.high) == pytest.approx((true.low, hits / 100, true.high))


def test_the_t_interval_of_replicates():
    values = np.random.default_rng(1).normal(size=16)
    found, true = mean_of_replicates(values), stats.ttest_1samp(values, 0.0).confidence_interval()
    assert (found.low, found.value, found.high) == pytest.approx((true.low, values.mean(), true.high))


def test_a_proportion_of_replicates_has_the_t_interval_unless_it_is_rare():
    hits = [9, 10, 11, 10] * 4
    found, true = proportion_of_replicates(hits, [64] * 16), mean_of_replicates(np.array(hits) / 64)
    assert (found.low, found.value, found.high) == pytest.approx((true.low, true.value, true.high))
    assert found.high - found.value < 0.5 * (proportion(160, 1024).high - found.value)
    for rare in ([0] * 16, [0] * 15 + [15], [64] * 16):
        assert proportion_of_replicates(rare, [64] * 16) == proportion(sum(rare), 1024)


def test_equal_replicates_leave_a_width():
    found = proportion_of_replicates([32] * 16, [64] * 16)
    assert (found.low, found.high) == pytest.approx((0.5 - 3.69 / 1024, 0.5 + 3.69 / 1024), abs=1e-5)
