"""Fits of the ratio of measured to computed ballistic limits: shipped, for a new lot, or updated by own tests.

A fit predicts the model error of an armour.  The logarithm of the ratio is linear in terms of armour and round, with
normal effects of the lot (a production lot of an alloy, or a series of tests), of the round and of the test.
docs/evidence/methods.md describes the fits.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from math import lgamma
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.evidence.mixture import Floats, Mixture
from armour.files import read_toml, shipped
from armour.scenario.inputs import INPUTS
from armour.scenario.library import DEFAULTS
from armour.units import GPA, MM, MPA

# Ratio of flow stress to yield strength of a plate.
CONSTRAINT = DEFAULTS["flow_stress_GPa"][0] * GPA / MPA
# m/D^3 of a usual core, g/mm3.
USUAL_MASS_RATIO = 0.0215
# Least standard deviation of a test about the fit that is assumed for own tests, since it differs between lots.
LEAST_REST = 0.04
# Standard deviation between repeated tests of one armour of a lot; and the distance of armours, see `distances`, over
# which the covariance of their deviations falls by the factor e.
REPEAT, LENGTH = 0.03, 0.15
# Chance of a gross error, such as a mistyped number, in an own test of a bare plate, and its standard deviation.
CHANCE, GROSS_ERROR = 0.07, 0.25
# Number of scales below the median at which the distribution by `lower_of` meets the lowest given one: beyond 99 %.
SAFE = 3.0
# Standard deviation between laboratories or series of tests of one lot, where they are named.
BETWEEN_SERIES = 0.04
# Greatest distance, see `distances`, of two armours that count as the same.
SAME_ARMOUR = 0.02
# Quantities from which the distance between armours is computed; the least value of which a logarithm is taken.
ARMOUR = (
    "ceramic_thickness_ratio",
    "backing_thickness_ratio",
    "path_ratio",
    "backing_strength_GPa",
    "backing_density_kg_m3",
)
TINY_RATIO = 1e-9
# Quantities by which rounds are told apart.
RODS = ("rod_diameter_mm", "rod_length_ratio", "rod_density_kg_m3", "rod_strength_GPa")
# Values of n armours, (n,), by name of the quantity; `q` in the functions below.
Quantities = Mapping[str, Any]


def quantities(armour: Parameters, tensile_MPa: Any, cosines: Any) -> dict[str, Any]:
    """Return the quantities of n armours that the evidence depends on, (n,) by name with the unit at its end.

    The parameters of `armour` are arrays, (n,), as are the tensile strengths of the plates and the cosines of the
    angles.
    """
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
    """Return the logarithm of the back plate thickness over the diameter, relative to that of the reference, (n,)."""
    return np.log(q["backing_thickness_ratio"] / reference[0])


# Terms of the fits by name: functions of the quantities and of a reference, which is a back plate thickness over the
# diameter, and a strength, MPa.
TERMS: dict[str, Callable[[Quantities, Sequence[float]], Any]] = {
    "1": lambda q, _: np.ones(len(q["path_ratio"])),
    "x": _thickness,
    "x2": lambda q, reference: _thickness(q, reference) ** 2,
    "h": lambda q, reference: _thickness(q, reference).clip(min=0.0),
    "Y": lambda q, reference: np.log(q["backing_strength_GPa"] * GPA / MPA / CONSTRAINT / reference[1]),
    "u": lambda q, _: np.log(q["tensile_MPa"] / (q["backing_strength_GPa"] * GPA / MPA / CONSTRAINT)),
    "s": lambda q, _: np.log(q["rod_mass_ratio"] / USUAL_MASS_RATIO),
    "o": lambda q, _: q["path_ratio"] - 1.0,
    "cb": lambda q, _: np.log(q["ceramic_thickness_ratio"] * q["backing_thickness_ratio"]),
}


def matrix_of(terms: Sequence[str], reference: Sequence[float], q: Quantities) -> Floats:
    """Return the values of the terms named in `TERMS` for n armours, (n, terms); `reference` is that of a `Fit`."""
    return np.column_stack([TERMS[term](q, reference) for term in terms])


class LotTests(NamedTuple):
    """n own tests of a lot, and how they differ from the ballistic limits that a law gives; arrays, (n,)."""

    quantities: Quantities
    errors: Floats  # logarithms of measured limits, or of velocities of shots, over the computed limits
    sides: Floats  # 0 for a measured limit; 1 for a shot below the limit, which was stopped, and -1 for one above it
    uncertainties: Floats  # relative standard deviations of the measurements
    armours: Any  # numbers of the armours: shots at the same armour have the same limit

    def at(self, where: Any) -> "LotTests":
        """Return some of the tests, given their indices or a mask."""
        some = {name: column[where] for name, column in self.quantities.items()}
        return LotTests(some, *(column[where] for column in self[1:]))


class Fit(NamedTuple):
    """A fit of the model error: of the logarithm of an armour's ballistic limit over the model's.

    It is linear in `terms`, and its errors have Student's t distribution.
    """

    name: str
    terms: tuple[str, ...]
    reference: tuple[float, float]  # thickness over the diameter, and strength, MPa
    coefficients: Floats  # (terms,); own tests of a lot do not change them
    covariance: Floats  # of the coefficients, (terms, terms)
    variance: float  # of a new lot, round and test together, in addition to that by the coefficients
    degrees_of_freedom: float
    standard_deviations: tuple[float, ...]  # between lots, between rounds, of a test, and of the second coefficient
    law: Mapping[str, float] = {}  # parameters of the core that replace the armour's when limits are computed
    weight: float = 1.0  # probability of the law; from `given`, the logarithm of the density of the tests
    own: tuple["Posterior", ...] = ()  # distributions given own tests; of several, the lower limit counts

    def predicted(self, q: Quantities, ranges: Mapping[str, tuple[float, float]]) -> tuple[Floats, Floats, Floats]:
        """Return locations and scales of the logarithms for n armours, and factors of the scales above the locations.

        Each is an array, (n,), as in a `Mixture`.  `ranges` has the ends of the ranges of the tests by quantity.
        Beyond them the trend continues, and half of its change there is added to the scale, as the root of the sum of
        squares.
        """
        matrix = matrix_of(self.terms, self.reference, q)
        location, coefficients, narrowed = matrix @ self.coefficients, self.coefficients, np.ones(len(matrix))
        variance = self.variance + np.einsum("ni,ij,nj->n", matrix, self.covariance, matrix)
        if self.own:
            location, variance, narrowed = lower_of([posterior.predicted(q) for posterior in self.own])
            coefficients = self.own[0].coefficients
        for name, ends in ranges.items():
            inside = matrix_of(self.terms, self.reference, {**q, name: q[name].clip(*ends)})
            variance += (0.5 * ((matrix - inside) @ coefficients)) ** 2
        return location, np.sqrt(variance), narrowed

    def given(self, tests: LotTests) -> "Fit":
        """Return this fit for a lot, which `of_lot` has returned, updated by tests of the lot.

        The weight of the new fit is the logarithm of the probability density of the tests by this one: of several laws,
        that which predicts the tests best then has the greatest weight.
        """
        K, deviations = self.covariance_and_deviations(tests)
        variances = tests.uncertainties**2
        limits, shots = np.flatnonzero(tests.sides == 0.0), np.flatnonzero(tests.sides)
        S = K[np.ix_(limits, limits)] + np.diag(variances[limits])
        log_density = _log_density(deviations[limits], S, self.degrees_of_freedom)
        if len(shots):
            gain = np.linalg.solve(S, K[limits]).T
            mean, covariance = gain[shots] @ deviations[limits], (K - gain @ K[limits])[np.ix_(shots, shots)]
            measurements = as_measurements(mean, covariance, deviations[shots], tests.sides[shots], variances[shots])
            deviations[shots], variances[shots], log_probability = measurements
            log_density += log_probability
        has_ceramic = tests.quantities["ceramic_thickness_ratio"].any()
        # With a ceramic, lots differ so much that a gross error looks like an armour that deviates.  There are then two
        # cases: similar armours share the deviation of every test, or only of tests that another test confirms.
        cases = [(0.0, 1.0), (0.0, confirmed(tests, deviations, variances))] if has_ceramic else [(CHANCE, 1.0)]
        own = tuple(Posterior.of(self, tests, deviations, variances, *case) for case in cases)
        freedom = self.degrees_of_freedom + len(deviations)
        return self._replace(degrees_of_freedom=freedom, weight=log_density + own[0].log_factor, own=own)

    def probabilities_of_farther(self, tests: LotTests) -> Floats:
        """Return the probability that each of n tests of the lot would lie farther from what the others predict, (n,).

        Only measured limits are compared, with each other; the probability of a shot, which only bounds a limit, is 1.
        """
        from scipy.special import stdtr  # slow to import

        K, deviations = self.covariance_and_deviations(tests)
        limits, nu = np.flatnonzero(tests.sides == 0.0), self.degrees_of_freedom
        deviations = deviations[limits]
        precision = np.linalg.inv((K + np.diag(tests.uncertainties**2))[np.ix_(limits, limits)])
        # Squared deviation of each test from the prediction by the others, over its variance; and the sum of squares of
        # the others.
        squares = (precision @ deviations) ** 2 / np.diag(precision)
        other_squares = deviations @ precision @ deviations - squares
        freedom, probabilities = nu + len(limits) - 1, np.ones(len(tests.errors))
        probabilities[limits] = 2.0 * stdtr(freedom, -np.sqrt(squares * freedom / (nu + other_squares)))
        return probabilities

    def of_lot(self, extra_deviation: float = 0.0, offset: Sequence[float] | None = None) -> "Fit":
        """Return this fit for one lot before its tests: as lots differ, its coefficients are less certain.

        Parameters
        ----------
        extra_deviation : float
            Standard deviation between lots in addition to that of the fit.
        offset : sequence of float, optional
            Mean and standard deviation of the first coefficient, the constant one, for a lot of another ceramic.
        """
        between_lots, _, _, trend = self.standard_deviations
        b, C = self.coefficients.copy(), self.covariance.copy()
        C[0, 0] += between_lots**2 + extra_deviation**2
        if offset is not None:
            # The variance of the offset includes its square: the offset is in doubt by as much as it differs from 0.
            C[0], C[:, 0] = 0.0, 0.0
            b[0], C[0, 0] = offset[0], offset[1] ** 2 + offset[0] ** 2
        if len(b) > 1:
            C[1, 1] += trend**2
        return self._replace(coefficients=b, covariance=C)

    def covariance_and_deviations(self, tests: LotTests, shared: Any = 1.0) -> tuple[Floats, Floats]:
        """Return the covariance of n own tests of this lot, (n, n), and by how much they deviate from the fit, (n,).

        Both are of logarithms of ballistic limits, and before the tests are known; `shared` is that of `Posterior`.
        """
        q, same_armour = tests.quantities, tests.armours[:, None] == tests.armours
        matrix, rest, repeat = matrix_of(self.terms, self.reference, q), *self.variances_of_test()
        K = self.covariance_of(q, q, shared * np.reshape(shared, (-1, 1)))
        K += same_armour * (repeat + (rest - repeat) * (1.0 - shared))
        if "series" in q:
            K += series_variance(q) * (q["series"][:, None] == q["series"])
        return K, tests.errors - matrix @ self.coefficients

    def variances_of_test(self) -> tuple[float, float]:
        """Return the variance of tests of a lot about the terms of the fit, and its part between repeated tests."""
        rest = max(self.standard_deviations[2], LEAST_REST) ** 2
        return rest, min(REPEAT**2, rest)

    def covariance_of(self, q: Quantities, tested: Quantities, shared: Any = 1.0) -> Floats:
        """Return the covariances of the logarithmic limits of n armours of this lot with those of m tests, (n, m).

        `shared`, (m,), is 1 if armours like that of a test share the smooth part of its deviation, otherwise 0.
        """
        Z, others = (matrix_of(self.terms, self.reference, each) for each in (q, tested))
        rest, repeat = self.variances_of_test()
        smooth = shared * (rest - repeat) * np.exp(-distances(q, tested) / LENGTH)
        return Z @ self.covariance @ others.T + same_rods(q, tested) * (self.standard_deviations[1] ** 2 + smooth)


class Posterior(NamedTuple):
    """Distribution of the model error in a lot given m own tests, one of which may have a gross error; arrays, (m,)."""

    lot_fit: Fit  # the fit for the lot before its tests
    tests: LotTests
    shared: Any  # 1 if armours like that of a test share its deviation, otherwise 0
    precision: Floats  # inverse of the covariance of the tests, (m, m)
    deviations: Floats  # of the tests from the fit before them
    shifts: Floats  # expected gross errors of the tests
    variances: Floats  # that possible gross errors add to a limit, over the square of its gain from each test
    widened_by: float  # factor of the variance of a limit, if tests contradict each other or the fit
    log_factor: float  # logarithm of the factor by which possible gross errors change the density of the tests

    @classmethod
    def of(
        cls, lot_fit: Fit, tests: LotTests, deviations: Floats, variances: Floats, chance: float, shared: Any
    ) -> "Posterior":
        """Return the distribution given tests of a lot, each with the probability `chance` of a gross error.

        `deviations` and `variances`, (m,), are those of the tests, with `as_measurements` in the place of shots.
        """
        K, nu = lot_fit.covariance_and_deviations(tests, shared)[0], lot_fit.degrees_of_freedom
        precision: Any = np.linalg.inv(K + np.diag(variances))
        # The first hypothesis is that all tests are sound.  Each other one is that one test has a gross error, which
        # changes one element of the covariance matrix.
        residuals, diagonal, n = precision @ deviations, np.diag(precision), len(deviations)
        changes = 1.0 / (1.0 / GROSS_ERROR**2 + diagonal)
        squares = deviations @ residuals - np.append(0.0, changes * residuals**2)
        expected = n - diagonal @ variances - np.append(0.0, changes * (diagonal - precision**2 @ variances))
        logarithms = -0.5 * (nu + n) * np.log((nu + squares) / (nu + squares[0]))
        chances = chance / (1.0 - chance) * (tests.sides == 0.0)
        odds = np.exp(logarithms - logarithms.max()) * np.append(1.0, chances * np.sqrt(1.0 - changes * diagonal))
        probabilities = odds / odds.sum()
        # Tests that contradict each other or the fit widen the distribution; outcomes of shots count in proportion to
        # their information.
        widened_by = np.maximum(1.0, (nu + squares) / (nu + expected))
        by_change = probabilities[1:] * changes
        return cls(
            *(lot_fit, tests, shared, precision, deviations),
            shifts=by_change * residuals,
            variances=by_change * (widened_by[1:] + changes * residuals**2),
            widened_by=float(probabilities @ widened_by),
            log_factor=float(logarithms.max() + np.log(odds.sum())),
        )

    def predicted(self, q: Quantities) -> tuple[Floats, Floats]:
        """Return locations and squared scales of the logarithms for n other armours of the lot, (n,) each."""
        fit, matrix = self.lot_fit, matrix_of(self.lot_fit.terms, self.lot_fit.reference, q)
        covariance = fit.covariance_of(q, self.tests.quantities, self.shared)
        gain = covariance @ self.precision
        before = np.einsum("ni,ij,nj->n", matrix, fit.covariance, matrix)
        before += fit.standard_deviations[1] ** 2 + fit.variances_of_test()[0] + series_variance(self.tests.quantities)
        variance = self.widened_by * (before - (gain * covariance).sum(axis=1))
        variance += gain**2 @ self.variances - (gain @ self.shifts) ** 2
        return matrix @ fit.coefficients + gain @ (self.deviations - self.shifts), variance

    @property
    def coefficients(self) -> Floats:
        """Expected coefficients of the lot given its tests, (terms,)."""
        fit, Z = self.lot_fit, matrix_of(self.lot_fit.terms, self.lot_fit.reference, self.tests.quantities)
        return fit.coefficients + fit.covariance @ Z.T @ self.precision @ (self.deviations - self.shifts)


def series_variance(tested: Quantities) -> float:
    """Return the variance between the series of the tests: 0 unless the tests name several series."""
    return BETWEEN_SERIES**2 * (len({*tested.get("series", ())}) > 1)


def mixture_of(
    fits_by_law: Sequence[Fit], q: Quantities, ranges: Mapping[str, tuple[float, float]] = MappingProxyType({})
) -> Mixture:
    """Return the distributions of the limits of n armours over those by each law, with the shape (laws, n).

    There is a fit for each law, updated by own tests with `Fit.given`, so that its weight is a logarithm.  `ranges` is
    that of `Fit.predicted`.
    """
    parts = zip(*(fit.predicted(q, ranges) for fit in fits_by_law), strict=True)
    locations, scales, narrowed = (np.array(columns) for columns in parts)
    freedom = np.array([[fit.degrees_of_freedom] for fit in fits_by_law]) * np.ones_like(scales)
    weights = np.exp([[fit.weight - max(each.weight for each in fits_by_law)] for fit in fits_by_law])
    return Mixture(weights / weights.sum() * np.ones_like(scales), locations, scales, freedom, narrowed=narrowed)


def lower_of(given: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats, Floats]:
    """Return a distribution of n limits that is nowhere higher than any of those given.

    Each of these has locations and squared scales, (n,).  The result has location, squared scale, and factor of the
    scale above the location, (n,) each.  The probability that a
    limit exceeds a velocity is then at most that by each of the given distributions.
    """
    means, variances = (np.array(columns) for columns in zip(*given, strict=True))
    location, scales = means.min(axis=0), np.sqrt(variances)
    scale = (scales - (means - location) / SAFE).max(axis=0)
    return location, scale**2, scales.min(axis=0) / scale


def confirmed(tests: LotTests, deviations: Floats, variances: Floats) -> Any:
    """Return 1 for each of n tests that another test of the same armour confirms, otherwise 0, (n,).

    Two tests confirm each other if they differ by less than two standard deviations.  `deviations` and `variances`,
    (n,), are those of the logarithms of the limits.
    """
    same = is_same_armour(tests.quantities, tests.quantities) & ~np.eye(len(deviations), dtype=bool)
    apart = abs(deviations[:, None] - deviations) < 2.0 * np.sqrt(2.0 * REPEAT**2 + variances[:, None] + variances)
    return (same & apart).any(axis=1).astype(float)


def is_same_armour(q: Quantities, tested: Quantities) -> Any:
    """Return whether each of n armours is practically that of each of m tests, against the same round, (n, m)."""
    return same_rods(q, tested) & (distances(q, tested) < SAME_ARMOUR)


def distances(q: Quantities, tested: Quantities) -> Floats:
    """Return how unlike n armours are m others, (n, m): the Euclidean distance of the logarithms of `ARMOUR`."""
    logs = [np.log(np.maximum([each[name] for name in ARMOUR], TINY_RATIO)) for each in (q, tested)]
    return np.sqrt(((logs[0][:, :, None] - logs[1][:, None]) ** 2).sum(axis=0))


def same_rods(q: Quantities, tested: Quantities) -> Any:
    """Return whether the rounds of n armours equal those of m others, except for rounding, (n, m)."""
    rods, others = (np.column_stack([each[name] for name in RODS])[:, None] for each in (q, tested))
    return np.isclose(rods, others[:, 0], rtol=1e-6, atol=0.0).all(axis=2)


def _log_density(deviations: Floats, scale: Floats, freedom: float) -> float:
    """Return the logarithm of the density of a t distribution at n deviations, (n,), up to a constant times n.

    `scale` is its scale matrix, (n, n), and `freedom` its degrees of freedom.
    """
    n, squares = len(deviations), float(deviations @ np.linalg.solve(scale, deviations))
    log_density = lgamma(0.5 * (freedom + n)) - lgamma(0.5 * freedom) - 0.5 * n * np.log(freedom)
    return float(log_density - 0.5 * ((freedom + n) * np.log1p(squares / freedom) + np.linalg.slogdet(scale)[1]))


def as_measurements(
    mean: Floats, covariance: Floats, places: Floats, sides: Floats, variances: Floats
) -> tuple[Floats, Floats, float]:
    """Return normal measurements of limits that stand for the outcomes of n shots, by expectation propagation.

    Before the shots, the limits have a normal distribution with `mean`, (n,), and `covariance`, (n, n).  Each limit
    lies above the place of its shot, side 1, or below it, side -1, apart from an error with one of the `variances`.
    The results are means and variances of the measurements, (n,), and the logarithm of the probability of the outcomes.
    """
    n = len(mean)
    from scipy.special import log_ndtr  # slow to import

    precision, information = np.zeros(n), np.zeros(n)  # of the measurements
    middle, posterior = mean.copy(), covariance.copy()  # of the limits
    # Means and variances of each limit without its shot, and how far that mean is on the side of the outcome.
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


def law_parameters(role: str, values: Mapping[str, float]) -> dict[str, float]:
    """Return values of a library entry, by key, as parameters of the core, by field and in SI units.

    `role` is that of the entry in an armour, such as "ceramic".
    """
    return {(parameter := INPUTS[f"{role}.{key}"]).field: value * parameter.factor for key, value in values.items()}


@cache
def shipped_data() -> dict[str, Any]:
    """Return the content of configs/evidence.toml: the shipped tests, the fits to them, and caveats."""
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
