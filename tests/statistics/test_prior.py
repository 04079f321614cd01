"""Prior knowledge of inputs: scores and their derivatives."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from armour.statistics.likelihood import Prior, prior_of
from tests.helpers.cases import shipped_scenario

STRESS, TAU = "ceramic.flow_stress_GPa", "backing.shear_strength_MPa"
NAMES = ("backing.flow_stress_GPa", STRESS, TAU)
UNITS = np.array([1.0, 5.2, 100.0])


@pytest.fixture(scope="module")
def prior() -> Prior:
    section = {
        "ceramic": {"flow_stress_GPa": {"distribution": "normal", "standard_deviation_percent": 10.0}},
        "backing": {"shear_strength_MPa": {"distribution": "lognormal", "mean": 200.0, "standard_deviation": 20.0}},
        "correlation": [{"between": [STRESS, TAU], "coefficient": 0.6}],
    }
    return prior_of(shipped_scenario("wilkins").replaced({"uncertainty": section}), NAMES, UNITS)


def test_the_scores_are_those_of_the_correlated_distribution(prior: Prior):
    x = np.array([7.0, 1.05, 2.2])
    spread = np.sqrt(np.log1p(0.01))
    normal = np.array([0.5, np.log(220.0 / (200.0 / np.sqrt(1.01))) / spread])
    matrix = np.array([[1.0, 0.6], [0.6, 1.0]])
    order = [NAMES.index(name) for name in (STRESS, TAU)]
    assert sorted(prior.where.tolist()) == order
    assert (prior.scores(x) ** 2).sum() == pytest.approx(normal @ np.linalg.inv(matrix) @ normal)
    assert prior.rows(x) == pytest.approx(approx_fprime(x, prior.scores, 1e-7), abs=1e-5)


def test_the_centre_has_no_score(prior: Prior):
    centre = prior.centred(np.array([3.0, 9.0, 9.0]))
    assert prior.scores(centre) == pytest.approx([0.0, 0.0])
    assert centre[0] == 3.0
