"""Fits of tests, and their update by own tests, against the formulas by hand."""

import numpy as np
import pytest
from scipy.stats import multivariate_t, norm
from scipy.stats import t as student

from armour.evidence import fit as module
from armour.evidence.fit import (
    CHANCE,
    GROSS_ERROR,
    LENGTH,
    REPEAT,
    SAFE,
    LotTests,
    as_measurements,
    confirmed,
    distances,
    fits,
    lower_of,
    matrix_of,
)
from tools.evidence import GROUPS, LAWS, plates_of, tiles_of

GROUP = GROUPS["fragments_aluminium"]
PLATES = plates_of(GROUP.kind, GROUP.metal)
FIT = fits()["fragments_aluminium"]
LOT = FIT.of_lot()
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


@pytest.fixture
def alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """Armours that share nothing of their deviations, and tests without gross errors."""
    monkeypatch.setattr(module, "REPEAT", 1.0)
    monkeypatch.setattr(module, "CHANCE", 0.0)


@pytest.mark.usefixtures("alike")
def test_without_shared_deviations_the_coefficients_are_updated():
    """B = b0 + P Z' S^-1 (e - Z b0), with the scatter of a test in S and in the variance."""
    tests = lot([0.10, 0.14, -0.02])
    Z = matrix_of(FIT.terms, FIT.reference, tests.quantities)
    S = Z @ prior() @ Z.T + REST**2 * np.eye(3)
    gain = prior() @ Z.T @ np.linalg.inv(S)
    updated = LOT.given(tests)
    location, scale, _ = updated.predicted(tests.quantities, {})
    coefficients = FIT.coefficients + gain @ (tests.errors - Z @ FIT.coefficients)
    assert location == pytest.approx(Z @ coefficients, rel=1e-13)
    covariance = prior() - gain @ Z @ prior()
    deviations, nu = tests.errors - Z @ FIT.coefficients, FIT.degrees_of_freedom
    widened_by = max(1.0, (nu + deviations @ np.linalg.solve(S, deviations)) / (nu + 3))
    expected = widened_by * (REST**2 + np.einsum("ni,ij,nj->n", Z, covariance, Z))
    assert scale**2 == pytest.approx(expected, rel=1e-13)
    assert updated.degrees_of_freedom == FIT.degrees_of_freedom + 3
    density = multivariate_t(Z @ FIT.coefficients, S, int(FIT.degrees_of_freedom)).logpdf(tests.errors)
    assert updated.weight == pytest.approx(density + 1.5 * np.log(np.pi))


def test_a_gross_error_is_one_of_the_hypotheses():
    """As the mixture over the hypotheses by hand: means and variances of each, and their probabilities."""
    tests = lot([-0.30, -0.22, 0.15])
    q, n, nu = tests.quantities, 3, FIT.degrees_of_freedom
    Z = matrix_of(FIT.terms, FIT.reference, q)
    misfit = (REST**2 - REPEAT**2) * np.exp(-distances(q, q) / LENGTH)
    K = Z @ prior() @ Z.T + misfit + REPEAT**2 * np.eye(n)
    covariance, e, found = K - REPEAT**2 * np.eye(n), tests.errors - Z @ FIT.coefficients, []
    for wrong in (None, 0, 1, 2):
        S = K + GROSS_ERROR**2 * np.diag(np.arange(n) == wrong)
        density = multivariate_t(np.zeros(n), S, int(nu)).pdf(e) * (1.0 if wrong is None else CHANCE / (1.0 - CHANCE))
        widened_by = max(1.0, (nu + e @ np.linalg.solve(S, e)) / (nu + np.trace(np.linalg.solve(S, K))))
        variance = widened_by * np.diag(K - covariance @ np.linalg.solve(S, covariance))
        found.append((density, covariance @ np.linalg.solve(S, e), variance))
    weights = np.array([density for density, *_ in found])
    weights /= weights.sum()
    means, variances = (np.array([part[i] for part in found]) for i in (1, 2))
    location, scale, _ = LOT.given(tests).predicted(q, {})
    assert location - Z @ FIT.coefficients == pytest.approx(weights @ means)
    assert scale**2 == pytest.approx(weights @ variances + weights @ (means - weights @ means) ** 2)
    assert weights[3] > 0.2


def test_a_test_of_the_very_armour_says_what_its_limit_is():
    tests = lot([-0.20])
    [location], [scale], _ = LOT.given(tests).predicted(tests.quantities, {})
    assert location == pytest.approx(-0.20, abs=0.01)
    assert scale < 0.06 < LOTS + REST


def test_a_test_out_of_line_is_improbable_given_the_others():
    """The conditional distribution, of a multivariate Student's t distribution, of each given the others."""
    tests = lot([0.10, 0.14, -0.42])
    Z, nu = matrix_of(FIT.terms, FIT.reference, tests.quantities), FIT.degrees_of_freedom
    misfit = (REST**2 - REPEAT**2) * np.exp(-distances(tests.quantities, tests.quantities) / LENGTH)
    S, d = Z @ prior() @ Z.T + misfit + REPEAT**2 * np.eye(3), tests.errors - Z @ FIT.coefficients
    probabilities = LOT.probabilities_of_farther(tests)
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
    updated, other_round = LOT.given(tests), {**tests.quantities, "rod_diameter_mm": np.array([12.6])}
    (same, narrow, _), (shifted, wide, _) = (updated.predicted(q, {}) for q in (tests.quantities, other_round))
    [before], *_ = FIT.predicted(tests.quantities, {})
    assert before < shifted[0] < same[0]
    assert wide[0] > narrow[0]
    assert wide[0] < FIT.predicted(other_round, {})[1][0] * 1.02


@pytest.mark.usefixtures("alike")
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_outcome_has_the_moments_of_the_truncated_distribution(side: float):
    tests = lot([0.05], [side])
    [mean], [scale], _ = FIT.predicted(tests.quantities, {})
    Z = matrix_of(FIT.terms, FIT.reference, tests.quantities)
    deviation = float(np.sqrt(Z @ prior() @ Z.T + REST**2)[0, 0])
    score = side * (mean - 0.05) / deviation
    shift = side * norm.pdf(score) / norm.cdf(score) * (Z @ prior() @ Z.T)[0, 0] / deviation
    assert LOT.given(tests).predicted(tests.quantities, {})[0][0] == pytest.approx(mean + shift)
    assert LOT.given(tests).weight == pytest.approx(norm.logcdf(score))
    assert scale > 0.0


def test_shots_at_one_armour_are_of_one_limit():
    """Stopped just below and perforated just above, they tell as much as the limit that they bracket."""
    shots = LOT.given(lot([-0.201, -0.199], [1.0, -1.0], [0, 0])._replace(quantities=PLATES.at([0, 0]).quantities))
    limit = LOT.given(lot([-0.200]))
    q = PLATES.at([0]).quantities
    for ours, theirs in zip(shots.predicted(q, {}), limit.predicted(q, {}), strict=True):
        assert ours == pytest.approx(theirs, abs=0.01)


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
    updated = FIT.of_lot(offset=(0.3, 0.2)).given(tests)
    Z = matrix_of(FIT.terms, FIT.reference, q)
    coefficients = FIT.coefficients.copy()
    coefficients[0] = 0.3
    assert updated.predicted(q, {})[0] == pytest.approx(Z @ coefficients, abs=1e-3)


def test_the_lower_of_two_distributions_has_no_greater_probability():
    """At the median, above it, and on its safe side, as far as `SAFE` scales."""
    given = [(np.array([0.02, -0.1, 0.0]), np.array([0.05, 0.05, 0.08]) ** 2)]
    given.append((np.array([0.05, 0.0, -0.02]), np.array([0.09, 0.05, 0.05]) ** 2))
    location, variance, narrowed = lower_of(given)
    for score in np.linspace(-SAFE, 4.0, 13):
        factor = np.where(score > 0.0, narrowed, 1.0)
        places = location + score * factor * np.sqrt(variance)
        for mean, square in given:
            assert (score >= (places - mean) / np.sqrt(square) - 1e-12).all()


def test_a_test_is_confirmed_by_another_of_the_same_armour_alone():
    tests = lot([0.0, 0.02, 0.2])
    same = tests._replace(quantities=PLATES.at([0, 0, 0]).quantities)
    nothing = np.zeros(3)
    assert confirmed(same, same.errors, nothing).tolist() == [1.0, 1.0, 0.0]
    assert confirmed(tests, np.zeros(3), nothing).tolist() == [0.0, 0.0, 0.0]


def test_own_tests_of_a_ceramic_carry_the_answer_once_another_confirms_them():
    """With one test at the armour, the lower of the probabilities with its deviation and without it counts."""
    fit, q = fits()["constant"], tiles_of(LAWS["constant"]).at([0]).quantities
    high, away = 0.25, {**q, "ceramic_thickness_ratio": np.array([1.9])}
    alone, twice, apart = (
        LotTests({name: np.concatenate([of[name] for of in parts]) for name in q}, np.array(errors), *zeros(len(parts)))
        for parts, errors in (([q], [high]), ([q, q], [high, high]), ([q, q, away], [high, 0.0, 0.0]))
    )
    (alone_at, alone_low, _), (twice_at, twice_low, _), (apart_at, _, _) = (
        fit.of_lot(0.1).given(tests).predicted(q, {}) for tests in (alone, twice, apart)
    )
    assert alone_at - 2.0 * alone_low < 0.1 < twice_at - 2.0 * twice_low
    assert apart_at < alone_at


def zeros(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sides of limits, exact measurements, and numbers of armours."""
    return np.zeros(count), np.zeros(count), np.arange(count)


def test_tests_of_two_laboratories_tell_less_of_a_third():
    q = PLATES.at([0, 0, 0]).quantities
    errors = [-0.2, -0.21, -0.19]
    scales = []
    for series in ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 2.0]):
        tests = lot(errors)._replace(quantities={**q, "series": np.array(series)})
        scales.append(LOT.given(tests).predicted(PLATES.at([0]).quantities, {})[1][0])
    without = LOT.given(lot(errors)._replace(quantities=q)).predicted(PLATES.at([0]).quantities, {})[1][0]
    assert scales[0] == without
    assert scales[0] < scales[2] < scales[1]
