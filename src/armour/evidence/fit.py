"""Fits of the ratio of measured to computed ballistic limits: shipped, for a new lot, or updated by own tests.

The logarithm of the ratio is linear in terms of armour and round, with normal effects of the lot (a production lot of
an alloy, or a series of tests), of the round and of the test.  docs/methods.md describes the fits.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from math import lgamma
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.evidence.mixture import Floats
from armour.files import read_toml, shipped
from armour.scenario.inputs import INPUTS
from armour.scenario.library import DEFAULTS
from armour.units import GPA, MM, MPA

# Ratio of flow stress to yield strength of a plate.
CONSTRAINT = DEFAULTS["flow_stress_GPa"][0] * GPA / MPA
# m/D^3 of a usual core, g/mm3.
CORE = 0.0215
# Least standard deviation of a test that is assumed for own tests, as it differs between lots.
LEAST_REST = 0.04
# Quantities that distinguish rounds.
RODS = ("rod_diameter_mm", "rod_length_ratio", "rod_density_kg_m3", "rod_strength_GPa")
# Values of n armours by name, (n,).
Quantities = Mapping[str, Any]


def quantities(armour: Parameters, tensile_MPa: Any, cosines: Any) -> dict[str, Any]:
    """Return the quantities of n armours that the evidence depends on; the parameters are arrays, (n,)."""
    return {
        "ceramic_thickness_ratio": armour.Hc0 / armour.D0,
        "ceramic_density_kg_m3": armour.rho_c,
        "ceramic_modulus_GPa": armour.Ec / GPA,
        "ceramic_strength_GPa": armour.Yc0 / GPA,
        "backing_exponent": armour.n_B,
        "product_exponent": armour.n_cB,
        "slopes": abs(armour.a_c) + abs(armour.a_B),
        "backing_thickness_ratio": armour.Hb / armour.D0,
        "backing_density_kg_m3": armour.rho_B,
        "backing_strength_GPa": armour.YB / GPA,
        "backing_shear_ratio": armour.tau / armour.YB,
        "tensile_MPa": tensile_MPa,
        "tensile_ratio": tensile_MPa / (armour.YB / MPA / CONSTRAINT),
        "rod_length_ratio": armour.L0 / armour.D0,
        "rod_mass_ratio": 0.25e-6 * np.pi * armour.rho_p * armour.L0 / armour.D0,
        "rod_density_kg_m3": armour.rho_p,
        "rod_strength_GPa": armour.Yp / GPA,
        "rod_diameter_mm": armour.D0 / MM,
        "path_ratio": 1.0 / cosines,
    }


def _thickness(q: Quantities, reference: Sequence[float]) -> Any:
    return np.log(q["backing_thickness_ratio"] / reference[0])


# Terms of the fits by name: functions of quantities, and of a reference thickness over the diameter and strength, MPa.
TERMS: dict[str, Callable[[Quantities, Sequence[float]], Any]] = {
    "1": lambda q, _: np.ones(len(q["path_ratio"])),
    "x": _thickness,
    "x2": lambda q, reference: _thickness(q, reference) ** 2,
    "h": lambda q, reference: _thickness(q, reference).clip(min=0.0),
    "Y": lambda q, reference: np.log(q["backing_strength_GPa"] * GPA / MPA / CONSTRAINT / reference[1]),
    "u": lambda q, _: np.log(q["tensile_MPa"] / (q["backing_strength_GPa"] * GPA / MPA / CONSTRAINT)),
    "s": lambda q, _: np.log(q["rod_mass_ratio"] / CORE),
    "o": lambda q, _: q["path_ratio"] - 1.0,
    "cb": lambda q, _: np.log(q["ceramic_thickness_ratio"] * q["backing_thickness_ratio"]),
}


def matrix_of(terms: Sequence[str], reference: Sequence[float], q: Quantities) -> Floats:
    """Return the terms of n armours, (n, terms)."""
    return np.column_stack([TERMS[term](q, reference) for term in terms])


class LotTests(NamedTuple):
    """n own tests of a lot, with the ballistic limits by the law of a fit; arrays, (n,)."""

    quantities: Quantities
    errors: Floats  # logarithms of measured limits, or of velocities of shots, over the computed limits
    sides: Floats  # 0, or 1 where the limit is above the velocity of a shot and -1 where it is below
    uncertainties: Floats  # relative standard deviations of the measurements
    armours: Any  # numbers of the armours: shots at the same armour have the same limit


class Fit(NamedTuple):
    """A fit of the logarithm of the armour's ballistic limit over the model's."""

    name: str
    terms: tuple[str, ...]
    reference: tuple[float, float]  # thickness over the diameter, and strength, MPa
    coefficients: Floats  # (terms,); of an updated fit with the effects of k rounds, (terms + k,)
    covariance: Floats
    variance: float  # of a new lot, round and test; of an updated fit, of a test alone
    degrees_of_freedom: float
    standard_deviations: tuple[float, ...]  # between lots, between rounds, of a test, and of the second coefficient
    law: Mapping[str, float] = {}  # parameters of the core that the limits are computed with in place of the armour's
    rods: Floats | None = None  # of the rounds of an updated fit, (k, 4)
    weight: float = 1.0  # probability of the law

    def predicted(self, q: Quantities, ranges: Mapping[str, tuple[float, float]]) -> tuple[Floats, Floats]:
        """Return locations and scales of the distributions of n armours, (n,) each.

        Beyond the ranges of the tests, by quantity, the trend continues, and half of it is added to the scale.
        """
        matrix = self._matrix(q)
        variance = self.variance + np.einsum("ni,ij,nj->n", matrix, self.covariance, matrix)
        if self.rods is not None:
            variance += ~matrix[:, len(self.terms) :].any(axis=1) * self.standard_deviations[1] ** 2
        for name, ends in ranges.items():
            inside = self._matrix({**q, name: q[name].clip(*ends)})
            variance += (0.5 * ((matrix - inside) @ self.coefficients)) ** 2
        return matrix @ self.coefficients, np.sqrt(variance)

    def _matrix(self, q: Quantities) -> Floats:
        """Return the terms of n armours and, for an updated fit, which of its rounds is fired at each."""
        matrix = matrix_of(self.terms, self.reference, q)
        if self.rods is None:
            return matrix
        # The rounds are the same but for rounding.
        rounds = np.isclose(rods_of(q)[:, None], self.rods, rtol=1e-6, atol=0.0).all(axis=2)
        return np.column_stack([matrix, rounds])

    def updated(self, tests: LotTests, extra_deviation: float = 0.0, level: Sequence[float] | None = None) -> "Fit":
        """Return the fit for the lot of own tests; its weight is the logarithm of their density.

        Parameters
        ----------
        tests : LotTests
        extra_deviation : float
            Standard deviation between lots in addition to that of the fit.
        level : sequence of float, optional
            Mean and standard deviation of the first coefficient, for a lot that the fit does not cover.
        """
        rods, b, C, Z, K = self._of_tests(tests, extra_deviation, level)
        nu, deviations, variances = self.degrees_of_freedom, tests.errors - Z @ b, tests.uncertainties**2
        limits, shots = np.flatnonzero(tests.sides == 0.0), np.flatnonzero(tests.sides)
        S = K[np.ix_(limits, limits)] + np.diag(variances[limits])
        log_density = _log_density(deviations[limits], S, nu)
        if len(shots):
            gain = np.linalg.solve(S, K[limits]).T
            mean, covariance = gain[shots] @ deviations[limits], (K - gain @ K[limits])[np.ix_(shots, shots)]
            measurements = as_measurements(mean, covariance, deviations[shots], tests.sides[shots], variances[shots])
            deviations[shots], variances[shots], log_probability = measurements
            log_density += log_probability
        S = K + np.diag(variances)
        G = np.linalg.solve(S, Z @ C).T
        # Tests that contradict each other or the fit widen it; outcomes count in proportion to their information.
        squares, expected_squares = deviations @ np.linalg.solve(S, deviations), np.trace(np.linalg.solve(S, K))
        widened_by = max(1.0, (nu + squares) / (nu + expected_squares))
        return self._replace(
            coefficients=b + G @ deviations,
            covariance=widened_by * (C - G @ Z @ C),
            variance=widened_by * self._test_deviation**2,
            degrees_of_freedom=nu + len(Z),
            rods=rods,
            weight=log_density,
        )

    def probabilities_of_farther(
        self, tests: LotTests, extra_deviation: float = 0.0, level: Sequence[float] | None = None
    ) -> Floats:
        """Return how probable it is that each own test lies farther from what the others predict, (n,); 1 for shots.

        The parameters are those of `updated`.
        """
        from scipy.special import stdtr  # slow to import

        _, b, _, Z, K = self._of_tests(tests, extra_deviation, level)
        limits, nu = np.flatnonzero(tests.sides == 0.0), self.degrees_of_freedom
        deviations = (tests.errors - Z @ b)[limits]
        precision = np.linalg.inv((K + np.diag(tests.uncertainties**2))[np.ix_(limits, limits)])
        # Squared deviation of each from the prediction by the others, over its variance, and the sum for the others.
        squares = (precision @ deviations) ** 2 / np.diag(precision)
        other_squares = deviations @ precision @ deviations - squares
        freedom, probabilities = nu + len(limits) - 1, np.ones(len(tests.errors))
        probabilities[limits] = 2.0 * stdtr(freedom, -np.sqrt(squares * freedom / (nu + other_squares)))
        return probabilities

    def _of_tests(self, tests: LotTests, extra_deviation: float, level: Sequence[float] | None) -> tuple[Floats, ...]:
        """Return rounds, coefficients and their covariance, terms of the tests, and the covariance of their limits."""
        rods = np.unique(rods_of(tests.quantities), axis=0)
        Z = self._replace(rods=rods)._matrix(tests.quantities)
        b, C = self._of_new_lot(len(rods), extra_deviation, level)
        # Tests at the same armour have the same limit.
        return rods, b, C, Z, Z @ C @ Z.T + self._test_deviation**2 * (tests.armours[:, None] == tests.armours)

    @property
    def _test_deviation(self) -> float:
        return max(self.standard_deviations[2], LEAST_REST)

    def _of_new_lot(self, rounds: int, extra_deviation: float, level: Sequence[float] | None) -> tuple[Floats, Floats]:
        """Return coefficients of a lot and effects of rounds, and their covariance; see `updated`."""
        between_lots, between_rounds, _, trend = self.standard_deviations
        count = len(self.terms)
        b = np.append(self.coefficients, np.zeros(rounds))
        C = np.diag([0.0] * count + [between_rounds**2] * rounds)
        C[:count, :count] = self.covariance
        C[0, 0] += between_lots**2 + extra_deviation**2
        if level is not None:
            C[0], C[:, 0] = 0.0, 0.0
            b[0], C[0, 0] = level[0], level[1] ** 2
        C[1, 1] += trend**2
        return b, C


def _log_density(deviations: Floats, scale: Floats, freedom: float) -> float:
    """Return the logarithm of the density of Student's t distribution of n values, but for a constant times n."""
    n, squares = len(deviations), float(deviations @ np.linalg.solve(scale, deviations))
    log_density = lgamma(0.5 * (freedom + n)) - lgamma(0.5 * freedom) - 0.5 * n * np.log(freedom)
    return float(log_density - 0.5 * ((freedom + n) * np.log1p(squares / freedom) + np.linalg.slogdet(scale)[1]))


def as_measurements(
    mean: Floats, covariance: Floats, places: Floats, sides: Floats, variances: Floats
) -> tuple[Floats, Floats, float]:
    """Return the normal measurements that stand for the outcomes of n shots: means and variances, (n,).

    The limits have a normal distribution with a mean and a covariance.  Each lies above the place of its shot, side 1,
    or below it, -1, apart from an error with a given variance.  The method is expectation propagation.  The third
    result is the logarithm of the probability of the outcomes.
    """
    n = len(mean)
    from scipy.special import log_ndtr  # slow to import

    precision, information = np.zeros(n), np.zeros(n)  # of the measurements
    middle, posterior = mean.copy(), covariance.copy()  # of the limits
    # Means and variances of the limits without the shot, and how far these are on its side.
    without, spread, score = np.empty(n), np.empty(n), np.empty(n)
    for _ in range(100):
        before = precision.copy()
        for i in range(n):
            cavity = 1.0 / posterior[i, i] - precision[i]  # precision of the limit without the shot
            without[i], spread[i] = (middle[i] / posterior[i, i] - information[i]) / cavity, 1.0 / cavity
            total = spread[i] + variances[i]
            score[i] = sides[i] * (without[i] - places[i]) / np.sqrt(total)
            slope = np.exp(-0.5 * score[i] ** 2 - log_ndtr(score[i])) / np.sqrt(2.0 * np.pi)
            mean_with = without[i] + spread[i] * sides[i] * slope / np.sqrt(total)
            narrowed = spread[i] - spread[i] ** 2 * slope * (slope + score[i]) / total
            precision_change = max(1.0 / narrowed - cavity, 1e-9) - precision[i]
            information_change = mean_with / narrowed - without[i] * cavity - information[i]
            precision[i], information[i] = precision[i] + precision_change, information[i] + information_change
            change = posterior[:, i] / (1.0 + precision_change * posterior[i, i])
            middle = middle + change * (information_change - precision_change * middle[i])
            posterior = posterior - precision_change * np.outer(change, posterior[i])
        if (np.abs(precision - before) <= 1e-6 * precision).all():
            break
    residual = information - precision * mean
    scaled = 1.0 + precision * spread
    log_density = log_ndtr(score) + 0.5 * np.log(scaled)
    log_density -= 0.5 * (information**2 * spread + 2.0 * information * without - precision * without**2) / scaled
    whole = information @ mean - 0.5 * precision @ mean**2 + 0.5 * residual @ posterior @ residual
    whole -= 0.5 * np.linalg.slogdet(np.eye(n) + precision[:, None] * covariance)[1]
    return information / precision, 1.0 / precision, float(log_density.sum() + whole)


def rods_of(q: Quantities) -> Floats:
    """Return the quantities that distinguish the rounds of n armours, (n, 4)."""
    return np.column_stack([q[name] for name in RODS])


def law_parameters(role: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return values of a library entry, by key, as parameters of the core, SI units."""
    return {(parameter := INPUTS[f"{role}.{key}"]).field: value * parameter.factor for key, value in values.items()}


@cache
def shipped_data() -> dict[str, Any]:
    """Return configs/evidence.toml."""
    return read_toml(shipped("configs") / "evidence.toml")


@cache
def fits() -> dict[str, Fit]:
    """Return the shipped fits by name."""
    shipped_fits = {}
    for name, data in shipped_data()["fit"].items():
        arrays = {key: np.array(data[key]) for key in ("coefficients", "covariance")}
        law = law_parameters("ceramic", data.get("flow_stress", {}))
        shipped_fits[name] = Fit(name, law=law, **{key: data[key] for key in data if key in Fit._fields} | arrays)
    return shipped_fits
