"""Fits of tests, and their update by own tests, against the formulas by hand."""

import numpy as np
import pytest
from scipy.stats import multivariate_t, norm
from scipy.stats import t as student

from armour.evidence.fit import LEAST_REST, LotTests, as_measurements, fits, matrix_of
from tools.evidence import GROUPS, plates_of

GROUP = GROUPS["fragments_aluminium"]
PLATES = plates_of(GROUP.kind, GROUP.metal)
FIT = fits()["fragments_aluminium"]
LOTS, ROUNDS, REST, TREND = FIT.standard_deviations
NOTHING = np.zeros(3)


def lot(errors: list[float], sides: list[float] | None = None, armours: list[int] | None = None) -> LotTests:
    """Own tests of the first plates of the table, which are against one round."""
    n = len(errors)
    q = PLATES.at(np.arange(n)).quantities
    numbers = np.arange(n) if armours is None else np.array(armours)
    return LotTests(q, np.array(errors), np.zeros(n) if sides is None else np.array(sides), np.zeros(n), numbers)


def prior() -> np.ndarray:
    """Covariance of the coefficients for a lot and a round."""
    covariance = FIT.covariance.copy()
    covariance[0, 0] += LOTS**2 + ROUNDS**2
    covariance[1, 1] += TREND**2
    return covariance


def test_measured_limits_update_the_population():
    """B = b0 + P Z' S^-1 (e - Z b0), with the scatter of a test in S and in the variance."""
    tests = lot([0.10, 0.14, -0.02])
    Z = matrix_of(FIT.terms, FIT.reference, tests.quantities)
    S = Z @ prior() @ Z.T + REST**2 * np.eye(3)
    gain = prior() @ Z.T @ np.linalg.inv(S)
    updated = FIT.updated(tests)
    location, scale = updated.predicted(tests.quantities, {})
    coefficients = FIT.coefficients + gain @ (tests.errors - Z @ FIT.coefficients)
    assert location == pytest.approx(Z @ coefficients)
    covariance = prior() - gain @ Z @ prior()
    deviations, nu = tests.errors - Z @ FIT.coefficients, FIT.degrees_of_freedom
    widened_by = max(1.0, (nu + deviations @ np.linalg.solve(S, deviations)) / (nu + 3))
    assert scale**2 == pytest.approx(widened_by * (REST**2 + np.einsum("ni,ij,nj->n", Z, covariance, Z)))
    assert updated.degrees_of_freedom == FIT.degrees_of_freedom + 3
    density = multivariate_t(Z @ FIT.coefficients, S, int(FIT.degrees_of_freedom)).logpdf(tests.errors)
    assert updated.weight == pytest.approx(density + 1.5 * np.log(np.pi))


def test_a_test_out_of_line_is_improbable_given_the_others():
    """The conditional distribution, of a multivariate Student's t distribution, of each given the others."""
    tests = lot([0.10, 0.14, -0.42])
    Z, nu = matrix_of(FIT.terms, FIT.reference, tests.quantities), FIT.degrees_of_freedom
    S, d = Z @ prior() @ Z.T + max(REST, LEAST_REST) ** 2 * np.eye(3), tests.errors - Z @ FIT.coefficients
    probabilities = FIT.probabilities_of_farther(tests)
    for i in range(3):
        others = [place for place in range(3) if place != i]
        gain = np.linalg.solve(S[np.ix_(others, others)], S[others, i])
        variance = (S[i, i] - gain @ S[others, i]) * (
            nu + d[others] @ np.linalg.solve(S[np.ix_(others, others)], d[others])
        )
        deviation = abs(d[i] - gain @ d[others]) / np.sqrt(variance / (nu + 2))
        assert probabilities[i] == pytest.approx(2.0 * student.sf(deviation, nu + 2))
    assert probabilities[2] < 0.01 < min(probabilities[:2])


def test_against_another_round_only_the_alloys_part_is_shared():
    tests = lot([-0.20])
    updated, other_round = FIT.updated(tests), {**tests.quantities, "rod_diameter_mm": np.array([12.6])}
    (same, narrow), (shifted, wide) = updated.predicted(tests.quantities, {}), updated.predicted(other_round, {})
    [before], _ = FIT.predicted(tests.quantities, {})
    assert before < shifted[0] < same[0]
    assert wide[0] > narrow[0]
    assert wide[0] < FIT.predicted(other_round, {})[1][0] * 1.02


def test_a_lot_is_not_taken_to_scatter_less_than_lots_do():
    fit = fits()["cores_aluminium"]
    assert fit.standard_deviations[2] < LEAST_REST
    group = GROUPS["cores_aluminium"]
    q = plates_of(group.kind, group.metal).at([0]).quantities
    [expected], _ = fit.predicted(q, {})
    one_test = LotTests(q, np.array([expected]), np.zeros(1), np.zeros(1), np.zeros(1))
    assert fit.updated(one_test).variance == pytest.approx(LEAST_REST**2)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_outcome_has_the_moments_of_the_truncated_distribution(side: float):
    tests = lot([0.05], [side])
    [mean], [scale] = FIT.predicted(tests.quantities, {})
    Z = matrix_of(FIT.terms, FIT.reference, tests.quantities)
    deviation = float(np.sqrt(Z @ prior() @ Z.T + REST**2)[0, 0])
    score = side * (mean - 0.05) / deviation
    shift = side * norm.pdf(score) / norm.cdf(score) * (Z @ prior() @ Z.T)[0, 0] / deviation
    assert FIT.updated(tests).predicted(tests.quantities, {})[0][0] == pytest.approx(mean + shift)
    assert FIT.updated(tests).weight == pytest.approx(norm.logcdf(score))
    assert scale > 0.0


def test_shots_at_one_armour_are_of_one_limit():
    """Stopped just below and perforated just above, they tell as much as the limit that they bracket."""
    shots = FIT.updated(lot([0.099, 0.101], [1.0, -1.0], [0, 0])._replace(quantities=PLATES.at([0, 0]).quantities))
    limit = FIT.updated(lot([0.100]))
    q = PLATES.at([0]).quantities
    for ours, theirs in zip(shots.predicted(q, {}), limit.predicted(q, {}), strict=True):
        assert ours == pytest.approx(theirs, abs=0.01)


def test_outcomes_tell_the_same_in_any_order_and_contradictions_widen():
    errors, sides = [-0.02, 0.0, 0.03, 0.06, 0.08], [-1.0, -1.0, -1.0, 1.0, 1.0]
    q = PLATES.at([0] * 5).quantities
    predictions = []
    for order in ([0, 1, 2, 3, 4], [3, 4, 0, 1, 2], [4, 2, 0, 3, 1]):
        ordered = lot([errors[i] for i in order], [sides[i] for i in order], [0] * 5)
        updated = FIT.updated(ordered._replace(quantities=q, uncertainties=np.full(5, 0.02)))
        predictions.append(np.hstack([*updated.predicted(PLATES.at([0]).quantities, {}), updated.weight]))
    for prediction in predictions[1:]:
        assert prediction == pytest.approx(predictions[0], rel=1e-4)
    alike = lot([0.05, 0.05])._replace(quantities=PLATES.at([0, 0]).quantities)
    apart = alike._replace(errors=np.array([-0.25, 0.35]))
    widths = [FIT.updated(tests).predicted(q, {})[1][0] for tests in (alike, apart)]
    assert widths[1] > 1.2 * widths[0]


@pytest.mark.parametrize("count", [1, 2, 4])
def test_outcomes_are_approximated_well(count: int):
    """Mean, deviation and probability against a million draws."""
    rng = np.random.default_rng(count)
    root = rng.normal(size=(count, count))
    covariance, mean = root @ root.T * 0.01 + 0.003 * np.eye(count), rng.normal(size=count) * 0.05
    places, sides, variances = rng.normal(size=count) * 0.1, rng.choice([-1.0, 1.0], count), np.full(count, 4e-4)
    equal, spread, log_density = as_measurements(mean, covariance, places, sides, variances)
    drawn = rng.multivariate_normal(mean, covariance, size=1_000_000)
    weights = norm.cdf(sides * (drawn - places) / np.sqrt(variances)).prod(axis=1)
    expected = weights @ drawn / weights.sum()
    deviations = np.sqrt(weights @ (drawn - expected) ** 2 / weights.sum())
    gain = np.linalg.solve(covariance + np.diag(spread), covariance).T
    assert mean + gain @ (equal - mean) == pytest.approx(expected, abs=0.03 * deviations.max())
    assert np.sqrt((covariance - gain @ covariance).diagonal()) == pytest.approx(deviations, rel=0.03)
    assert log_density == pytest.approx(np.log(weights.mean()), abs=0.02)


def test_a_level_replaces_that_of_the_fit():
    tests = lot([0.5])._replace(uncertainties=np.array([1e3]))
    q = tests.quantities
    updated = FIT.updated(tests, level=(0.3, 0.2))
    Z = matrix_of(FIT.terms, FIT.reference, q)
    coefficients = FIT.coefficients.copy()
    coefficients[0] = 0.3
    assert updated.predicted(q, {})[0] == pytest.approx(Z @ coefficients, abs=1e-3)
