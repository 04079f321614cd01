"""Errors of the model and of other predictions on the same tests, in sample and left out, by plain computations."""

import numpy as np
import pytest
from scipy.stats import linregress, t

from armour.validation.comparison import Prediction
from armour.validation.tested import COMPARED_TESTS
from tests.helpers.cases import SCENARIOS
from tests.helpers.fits import wilkins_fit
from tests.helpers.known import known
from tests.helpers.suites import of_paper
from tools import published

pytestmark = pytest.mark.slow

CERAMIC, PLATE, LIMIT = np.loadtxt(SCENARIOS / "tests" / "wilkins.csv", delimiter=",", skiprows=1).T
NAMES = ["the model, flow stress refitted", "k times areal density, fitted"]


@pytest.fixture(scope="module")
def errors() -> dict[str, Prediction]:
    return {found.method: found for found in published.predictions(of_paper())}


def test_wilkins_tests_by_what_is_fitted_to_them(errors: dict[str, Prediction]):
    fitted = [errors[name] for name in NAMES]
    assert [round(known(found.mean_percent), 1) for found in fitted] == [5.0, 4.2]
    assert [round(known(found.left_out_percent), 1) for found in fitted] == [5.5, 4.5]
    assert [round(known(found.largest_percent), 1) for found in fitted] == [11.2, 8.0]
    assert {name for name, found in errors.items() if found.left_out_percent is not None} == set(NAMES)
    assert errors["the model"].fitted == "flow stress of AD85: [Paper], table 2, to Wilkins' ballistic limits"
    assert [found.fitted for found in fitted] == [
        "flow stress of AD85 to these tests: 5.21 GPa",
        "k = 17.60 m/s per kg/m² to these tests",
    ]


def test_the_refitted_flow_stress_is_that_of_a_calibration(errors: dict[str, Prediction]):
    found = wilkins_fit()
    assert errors[NAMES[0]].mean_percent == pytest.approx(found.mean_error_percent)
    assert errors[NAMES[0]].left_out_percent == pytest.approx(found.left_out_error_percent)


def test_the_errors_go_with_the_back_plate():
    """The elasticities of docs/howto/compare.md, by regression of logarithms."""
    checks = [check for check in of_paper().checks if check.case.group == COMPARED_TESTS]
    computed = np.array([check.computed for check in checks], dtype=float)
    logs = np.column_stack([np.ones(13), np.log(CERAMIC), np.log(PLATE)])

    def elasticities(limits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found, squares, *_ = np.linalg.lstsq(logs, np.log(limits), rcond=None)
        errors = np.sqrt(np.diag(np.linalg.inv(logs.T @ logs)) * squares[0] / 10.0)
        return found[1:].round(2), (t.ppf(0.975, 10) * errors[1:]).round(2)

    measured, half = elasticities(LIMIT)
    assert measured.tolist() == [0.48, 0.43]
    assert half.tolist() == [0.25, 0.14]
    assert elasticities(computed)[0].tolist() == [0.31, 0.23]
    off = 100.0 * (computed / LIMIT - 1.0)
    assert off[np.argsort(PLATE)[:3]].round(1).tolist() == [10.0, 8.9, 7.6]
    assert linregress(np.log(PLATE), np.log(computed / LIMIT)).pvalue == pytest.approx(0.010, abs=5e-4)
