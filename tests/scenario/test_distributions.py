from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy import stats

from armour.scenario.distributions import Distribution, Uncertainty, columns_of, points_of

PARTS = np.linspace(0.001, 0.999, 999)


def made(**keys: Any) -> Distribution:
    return Distribution.model_validate(keys)


def test_normal():
    found = made(distribution="normal", standard_deviation=2.0).quantiles(PARTS, 10.0)
    assert found == pytest.approx(stats.norm(10.0, 2.0).ppf(PARTS))
    percent = made(distribution="normal", mean=20.0, standard_deviation_percent=10.0).quantiles(PARTS, 10.0)
    assert percent == pytest.approx(stats.norm(20.0, 2.0).ppf(PARTS))


def test_lognormal_has_the_mean_and_the_deviation_given():
    u = (np.arange(1_000_000) + 0.5) / 1_000_000
    found = made(distribution="lognormal", standard_deviation=2.0).quantiles(u, 10.0)
    assert (found.mean(), found.std()) == pytest.approx((10.0, 2.0), rel=1e-3)


def test_uniform():
    assert made(distribution="uniform", min=2.0, max=4.0).quantiles(PARTS, 99.0) == pytest.approx(2.0 + 2.0 * PARTS)


@pytest.mark.parametrize("kind", ["normal", "lognormal"])
def test_truncated(kind: str):
    whole = made(distribution=kind, standard_deviation=2.0)._untruncated(10.0)
    found = made(distribution=kind, standard_deviation=2.0, min=9.0, max=11.0).quantiles(PARTS, 10.0)
    assert 9.0 < found.min() < found.max() < 11.0
    shares = (whole.cdf(found) - whole.cdf(9.0)) / (whole.cdf(11.0) - whole.cdf(9.0))
    assert shares == pytest.approx(PARTS, abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"distribution": "normal"}, "must have standard_deviation or standard_deviation_percent"),
        ({"distribution": "normal", "standard_deviation": 1.0, "standard_deviation_percent": 1.0}, "and not both"),
        ({"distribution": "uniform", "min": 1.0}, "a uniform distribution must have min and max, and nothing else"),
        ({"distribution": "uniform", "min": 1.0, "max": 2.0, "mean": 1.5}, "and nothing else"),
        ({"distribution": "normal", "standard_deviation": 1.0, "min": 3.0, "max": 2.0}, "min must be below max"),
        ({"distribution": "triangular"}, "Input should be 'normal'"),
    ],
)
def test_wrong_distributions(keys: dict[str, Any], message: str):
    with pytest.raises(ValidationError, match=message):
        made(**keys)


NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
TWO = {"ceramic": {"density_kg_m3": NORMAL, "flow_stress_GPa": NORMAL}, "armour": {"backing_thickness_mm": NORMAL}}
OWN = {"ceramic.density_kg_m3": 3430.0, "ceramic.flow_stress_GPa": 5.2, "armour.backing_thickness_mm": 6.0}
PAIR = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"]


@pytest.mark.parametrize("method", ["sobol", "latin hypercube"])
def test_samples_have_the_correlation_and_the_distributions(method: str):
    section = Uncertainty.model_validate(
        {**TWO, "method": method, "samples": 16384, "correlation": [{"between": PAIR, "coefficient": 0.7}]}
    )
    columns = columns_of(section, OWN, points_of(section))
    density, strength, backing = (columns[name] for name in OWN)
    assert np.corrcoef(density, strength)[0, 1] == pytest.approx(0.7, abs=0.01)
    assert abs(np.corrcoef(density, backing)[0, 1]) < 0.02
    for name, values in columns.items():
        assert stats.kstest(values, stats.norm(OWN[name], 0.1 * OWN[name]).cdf).statistic < 0.01


def test_the_seed_tells_the_samples():
    def points(seed: int) -> np.ndarray:
        return points_of(Uncertainty.model_validate({**TWO, "samples": 128, "seed": seed}))

    np.testing.assert_array_equal(points(1), points(1))
    assert (points(1) != points(2)).any()


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"samples": 1000}, "samples must be a power of 2 for Sobol' points, such as 1024, found 1000"),
        ({"correlation": [{"between": PAIR, "coefficient": 1.0}]}, "less than 1"),
        ({"correlation": [{"between": [PAIR[0], "hardness"], "coefficient": 0.5}]}, 'found "hardness"'),
        ({"correlation": [{"between": [PAIR[0], PAIR[0]], "coefficient": 0.5}]}, "must name two inputs"),
        ({"correlation": [{"between": PAIR, "coefficient": 0.5}] * 2}, "each two once"),
        (
            {
                "correlation": [
                    {"between": PAIR, "coefficient": 0.9},
                    {"between": [PAIR[0], "armour.backing_thickness_mm"], "coefficient": 0.9},
                    {"between": [PAIR[1], "armour.backing_thickness_mm"], "coefficient": -0.9},
                ]
            },
            "not positive definite",
        ),
    ],
)
def test_wrong_sections(keys: dict[str, Any], message: str):
    with pytest.raises(ValidationError, match=message):
        Uncertainty.model_validate({**TWO, **keys})
