from math import log, log1p, sqrt
from typing import Any

import numpy as np
import pytest
from scipy import stats

from armour.analysis.samples import REPLICATES, columns_of, moved_mean, points_of, quantiles
from armour.scenario.schema import Distribution, Uncertainty

PARTS = np.linspace(0.001, 0.999, 999)
NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
SECTION = {"ceramic": {"density_kg_m3": NORMAL, "flow_stress_GPa": NORMAL}, "armour": {"backing_thickness_mm": NORMAL}}
OWN = {"ceramic.density_kg_m3": 3430.0, "ceramic.flow_stress_GPa": 5.2, "armour.backing_thickness_mm": 6.0}
PAIR = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"]


def distribution_of(**keys: Any) -> Distribution:
    return Distribution.model_validate(keys)


def test_normal():
    values = quantiles(distribution_of(distribution="normal", standard_deviation=2.0), PARTS, 10.0)
    assert values == pytest.approx(stats.norm(10.0, 2.0).ppf(PARTS))
    percent = quantiles(distribution_of(distribution="normal", mean=20.0, standard_deviation_percent=10.0), PARTS, 10.0)
    assert percent == pytest.approx(stats.norm(20.0, 2.0).ppf(PARTS))


def test_lognormal_has_the_mean_and_the_deviation_given():
    u = (np.arange(100_000) + 0.5) / 100_000
    values = quantiles(distribution_of(distribution="lognormal", standard_deviation=2.0), u, 10.0)
    assert (values.mean(), values.std()) == pytest.approx((10.0, 2.0), rel=1e-3)


def test_uniform():
    assert quantiles(distribution_of(distribution="uniform", min=2.0, max=4.0), PARTS, 99.0) == pytest.approx(
        2.0 + 2.0 * PARTS
    )


def test_truncated_normal():
    values = quantiles(distribution_of(distribution="normal", standard_deviation=2.0, min=9.0, max=11.0), PARTS, 10.0)
    assert values == pytest.approx(stats.truncnorm(-0.5, 0.5, 10.0, 2.0).ppf(PARTS))


def test_truncated_lognormal():
    values = quantiles(
        distribution_of(distribution="lognormal", standard_deviation=2.0, min=9.0, max=11.0), PARTS, 10.0
    )
    width = sqrt(log1p(0.2**2))
    middle = log(10.0) - width**2 / 2.0
    ends = [(log(end) - middle) / width for end in (9.0, 11.0)]
    assert values == pytest.approx(np.exp(stats.truncnorm(*ends, middle, width).ppf(PARTS)))


def test_a_value_that_cannot_be_a_mean_is_certain():
    values = quantiles(distribution_of(distribution="lognormal", standard_deviation=2.0), PARTS, 0.0)
    assert values.shape == PARTS.shape
    assert not values.any()


def test_samples_have_the_correlation_and_the_distributions():
    section = Uncertainty.model_validate(
        {**SECTION, "samples": 16384, "correlation": [{"between": PAIR, "coefficient": 0.7}]}
    )
    columns = columns_of(section, OWN, points_of(section))
    density, strength, backing = (columns[name] for name in OWN)
    assert np.corrcoef(density, strength)[0, 1] == pytest.approx(0.7, abs=0.01)
    assert abs(np.corrcoef(density, backing)[0, 1]) < 0.02
    for name, values in columns.items():
        assert stats.kstest(values, stats.norm(OWN[name], 0.1 * OWN[name]).cdf).statistic < 0.01


def test_each_replicate_covers_the_whole_range():
    """Each has a point of its own in each of as many equal parts as it has points."""
    points = points_of(Uncertainty.model_validate({**SECTION, "samples": 512}))
    replicates = np.array(np.array_split(points, REPLICATES))
    assert (np.sort((replicates * 32).astype(int), axis=1) == np.arange(32)[:, None]).all()
    assert len(np.unique(points[:, 0])) == 512


def test_a_mean_that_truncation_moves():
    half = distribution_of(distribution="normal", standard_deviation=2.0, min=10.0)
    assert moved_mean(half, 10.0) == pytest.approx((10.0, 10.0 + 2.0 * sqrt(2.0 / np.pi)), rel=1e-3)
    assert moved_mean(distribution_of(distribution="normal", standard_deviation=2.0, min=5.0), 10.0) is None
    assert moved_mean(distribution_of(distribution="normal", standard_deviation=2.0, min=9.0, max=11.0), 10.0) is None
    assert moved_mean(distribution_of(distribution="uniform", min=11.0, max=12.0), 10.0) is None
    assert moved_mean(distribution_of(distribution="lognormal", standard_deviation_percent=300.0), 10.0) is None
