"""Errors of the model and of other predictions on the same tests, in sample and left out, by plain computations."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import linregress, t

from armour.validation.comparison import Error
from armour.validation.formulas import fit_areal_density_rule
from armour.validation.tested import COMPARED_TESTS
from tests.helpers.cases import SCENARIOS
from tests.helpers.fits import wilkins_fit
from tests.helpers.suites import of_paper
from tools import published

pytestmark = pytest.mark.slow

CERAMIC, PLATE, LIMIT = np.loadtxt(SCENARIOS / "tests" / "wilkins.csv", delimiter=",", skiprows=1).T
DENSITY = 3.43 * CERAMIC + 2.75 * PLATE
NAMES = ["this model, flow stress refitted", "areal density rule, p = 1", "areal density rule, p fitted"]


@pytest.fixture(scope="module")
def errors() -> dict[str, Error]:
    return {error.predictor: error for error in published.errors(of_paper())}


def rounded(error: Error) -> tuple[float, float, float]:
    return round(error.mean_percent, 1), round(error.left_out_percent or 0.0, 1), round(error.largest_percent, 1)


def test_wilkins_tests_by_what_is_fitted_to_them(errors: dict[str, Error]):
    assert [rounded(errors[name]) for name in NAMES] == [(5.0, 5.5, 11.2), (4.2, 4.5, 8.0), (4.0, 4.6, 8.4)]
    assert {name for name, error in errors.items() if error.left_out_percent is not None} == set(NAMES)
    assert errors["this model"].fitted == "flow stress of AD85: [Paper], table 2, to Wilkins' ballistic limits"
    assert [errors[name].fitted for name in NAMES] == [
        "flow stress of AD85 to these tests: 5.21 GPa",
        "k = 17.60 to these tests",
        "k = 22.25 and p = 0.938 to these tests",
    ]


def test_the_rule_left_out_by_a_search_for_each_test(errors: dict[str, Error]):
    """The relative errors are minimised by a general search, one test left out after the other."""
    for name, powers in ((NAMES[1], [1.0]), (NAMES[2], [])):

        def relative(x: np.ndarray, kept: np.ndarray, powers: list[float] = powers) -> np.ndarray:
            found: np.ndarray = np.exp(x[0] + (*x[1:], *powers)[0] * np.log(DENSITY[kept] / 40.0)) / LIMIT[kept] - 1.0
            return found

        start, everything = [6.5] if powers else [6.5, 1.0], np.arange(13)
        off = []
        for left in everything:
            kept = everything != left
            fit = least_squares(relative, start, args=(kept,), xtol=1e-12, ftol=1e-12)
            off.append(abs(relative(fit.x, everything == left)[0]))
        assert errors[name].left_out_percent == pytest.approx(100.0 * np.mean(off), abs=1e-4)


def test_a_power_of_0_8_as_docs_howto_compare_md_has_it():
    def off(kept: np.ndarray, asked: np.ndarray) -> np.ndarray:
        return abs(
            fit_areal_density_rule(DENSITY[kept], LIMIT[kept], 0.8).k * DENSITY[asked] ** 0.8 / LIMIT[asked] - 1.0
        )

    everything = np.arange(13)
    assert 100.0 * off(everything, everything).mean() == pytest.approx(3.80, abs=0.01)
    left_out = [off(everything != left, everything == left)[0] for left in everything]
    assert 100.0 * np.mean(left_out) == pytest.approx(4.12, abs=0.01)


def test_the_refitted_flow_stress_is_that_of_a_calibration(errors: dict[str, Error]):
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
