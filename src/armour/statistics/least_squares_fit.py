"""Fit of a scenario's inputs to tests by least squares."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm, t

from armour.analysis.answers import Answers
from armour.analysis.estimates import CONFIDENCE
from armour.analysis.searches import smooth_limits
from armour.analysis.variants import Bools, Floats, Variants, perforated, variants_of
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, NAMES, VELOCITY, check_names, name_of
from armour.statistics.flow_stress_laws import FLOW_STRESS, LAWS, Coefficients, Law, coefficients_of, input_values
from armour.statistics.test_data import LIMIT, MASS, MEASURED, RESIDUAL, Tests

# Bounds of a coefficient in units of its scale; slopes of a law may be negative.
MIN_RATIO, MAX_RATIO = 0.1, 10.0
# Starting points of the fit, in the same units.
STARTS = (1.0, 0.5, 2.0)
# Tolerance of ballistic limits, m/s, and relative change of coefficients for the derivatives.
LIMIT_TOLERANCE_M_S = 1e-6
DIFFERENCE = 1e-4
# Coefficients this close to each other are equal.
EQUAL = 1e-3


@dataclass(frozen=True)
class Coefficient:
    """A fitted coefficient.

    Attributes
    ----------
    name : str
        Name of the input, with its unit, and the thickness that it multiplies.
    estimate : float or None
        None where the tests do not identify it.
    interval : tuple of float or None
        Confidence interval.
    reason : str
        Why it is not identified.
    """

    name: str
    estimate: float | None
    interval: tuple[float, float] | None
    reason: str = ""


class LeastSquaresFit(NamedTuple):
    """A fit of coefficients to tests."""

    fitted: Coefficients
    x: Floats  # values of the coefficients, divided by their scales
    cost: float  # half the sum of squares
    covariance: Floats
    coefficients: tuple[Coefficient, ...]
    degrees_of_freedom: int
    starts: int
    starts_agreeing: int

    def correlation(self) -> Floats:
        """Return the correlation matrix of the coefficients."""
        deviation = np.sqrt(np.diag(self.covariance))
        found: Floats = self.covariance / np.outer(deviation, deviation)
        np.fill_diagonal(found, 1.0)
        return found


def fit_inputs(tests: Tests, scenario: Scenario, inputs: Sequence[str], law: Law) -> LeastSquaresFit:
    """Fit inputs of a scenario to tests, from several starting points; see `armour.statistics.calibration.calibrate`.

    The confidence intervals are those of the model linearised at the estimate, with the uncertainties given or, without
    them, with the scatter of the deviations.

    Raises
    ------
    InputError
        If an input cannot be fitted to the tests, these are too few, or a run does not end.
    """
    _check(tests, scenario, inputs, law)
    fitted = coefficients_of(tests, inputs, law)
    bounds = _bounds(fitted, law)
    slopes = bounds[0] < 0.0
    everything = np.ones(len(tests.measurements), dtype=bool)
    ends = [_minimised(tests, fitted, bounds, start, everything) for start in _starts(slopes)]
    best = min(ends, key=lambda end: float(end.cost))
    exact = np.array([m.side == 0 for m in tests.measurements])
    freedom = int((exact | (best.fun != 0.0)).sum()) - len(slopes)
    covariance, unidentified = _covariance(best.jac)
    if not tests.weighted:
        covariance = covariance * (2.0 * best.cost / freedom)
    tail = 0.5 * (1.0 + CONFIDENCE)
    factor = float(norm.ppf(tail) if tests.weighted else t.ppf(tail, freedom))
    return LeastSquaresFit(
        fitted=fitted,
        x=best.x,
        cost=float(best.cost),
        covariance=covariance,
        coefficients=_coefficients(fitted, best.x, factor * np.sqrt(np.diag(covariance)), unidentified, bounds),
        degrees_of_freedom=freedom,
        starts=len(ends),
        starts_agreeing=sum(np.allclose(end.x, best.x, rtol=EQUAL, atol=EQUAL) for end in ends),
    )


def refitted(tests: Tests, fit: LeastSquaresFit, law: Law, kept: Bools) -> Floats:
    """Fit again to some of the measurements; return the values of the coefficients, divided by their scales."""
    found: Floats = _minimised(tests, fit.fitted, _bounds(fit.fitted, law), fit.x, kept).x
    return found


def predicted(tests: Tests, coefficients: Coefficients, x: Floats) -> Floats:
    """Compute the model's value of every measurement, (m,).

    Raises
    ------
    InputError
        If a run does not end.
    """
    count = len(tests.names)
    values = {name: np.full(count, np.nan) for name in MEASURED}
    needed = {name: np.zeros(count, dtype=bool) for name in MEASURED}
    for m in tests.measurements:
        needed[m.quantity][m.test] = True
    for group in tests.groups:
        columns = {**group.columns, **input_values(coefficients, x, group)}
        variants = variants_of(group.scenario, columns, len(group.where))
        for name, column in _model_values(variants, {n: needed[n][group.where] for n in needed}).items():
            values[name][group.where] = column
    return np.array([values[m.quantity][m.test] for m in tests.measurements])


def _model_values(variants: Variants, needed: Mapping[str, Bools]) -> dict[str, Floats]:
    """Ballistic limits, residual velocities and residual masses of tests, where they are needed.

    The residual velocity of a defeated test is negative: the velocity that it lacks to its ballistic limit.
    """
    found = {name: np.full(len(variants.velocities), np.nan) for name in MEASURED}
    needs_limit = needed[LIMIT].copy()
    shots = np.flatnonzero(needed[RESIDUAL] | needed[MASS])
    if len(shots):
        answers = Answers(variants.at(shots))
        found[RESIDUAL][shots] = answers.impacts.V
        found[MASS][shots] = answers.residual_masses
        needs_limit[shots] |= ~answers.perforated & needed[RESIDUAL][shots]
    where = np.flatnonzero(needs_limit)
    if len(where):
        found[LIMIT][where] = _limits_in_range(variants.at(where))
        below = needs_limit & needed[RESIDUAL] & (found[LIMIT] > variants.velocities)
        found[RESIDUAL][below] = variants.velocities[below] - found[LIMIT][below]
    return found


def _limits_in_range(variants: Variants) -> Floats:
    """Ballistic limits, m/s; the end of the search's range where the limit lies beyond it."""
    search = variants.settings.ballistic_limit
    limits = smooth_limits(variants, LIMIT_TOLERANCE_M_S)
    outside = np.flatnonzero(np.isnan(limits))
    if len(outside):
        slowest = np.full(len(outside), search.velocity_min_m_s)
        below = perforated(variants.at(outside)._replace(velocities=slowest))
        limits[outside] = np.where(below, search.velocity_min_m_s, search.velocity_max_m_s)
    return limits


def _minimised(tests: Tests, fitted: Coefficients, bounds: tuple[Floats, Floats], start: Floats, kept: Bools) -> Any:
    """Result of a least-squares search from a starting point, with some of the measurements."""

    def deviations(x: Floats) -> Floats:
        return _deviations(tests, predicted(tests, fitted, x))[kept]

    return least_squares(deviations, start, bounds=bounds, diff_step=np.full(len(start), DIFFERENCE), xtol=1e-10)


def _deviations(tests: Tests, computed: Floats) -> Floats:
    """Deviations divided by their scales; of a censored observation, only where the bound is not met."""
    value, scale, side = np.array([(m.value, m.scale, m.side) for m in tests.measurements]).T
    found = (computed - value) / scale
    return np.where(side == 0, found, np.where(side * found < 0.0, found, 0.0))


def _bounds(coefficients: Coefficients, law: Law) -> tuple[Floats, Floats]:
    """Bounds of the coefficients, divided by their scales."""
    slopes = np.array([term > 0 and law != "proportional" for term in coefficients.terms])
    return np.where(slopes, -MAX_RATIO, MIN_RATIO), np.full(len(slopes), MAX_RATIO)


def _starts(slopes: Bools) -> list[Floats]:
    """Starting points: several values of each coefficient, with zero and with positive slopes of a law."""
    starts = [np.where(slopes, 0.0, start) for start in STARTS]
    return [*starts, np.where(slopes, 0.3, 0.5)] if slopes.any() else starts


def _covariance(jacobian: Floats) -> tuple[Floats, Bools]:
    """Covariance for deviations of variance one, and which coefficients the tests do not identify."""
    _, singular, axes = np.linalg.svd(jacobian, full_matrices=False)
    seen = singular > 1e-6 * max(float(singular[0]), 1e-30)
    inverse = np.where(seen, 1.0 / np.where(seen, singular, 1.0), 0.0)
    unidentified = (np.abs(axes[~seen]) > 1e-3).any(axis=0)
    scaled = axes.T * inverse
    covariance = scaled @ scaled.T
    covariance[np.diag_indices_from(covariance)] = np.maximum(np.diag(covariance), 1e-300)
    return covariance, unidentified


def _coefficients(
    fitted: Coefficients, x: Floats, half_widths: Floats, unidentified: Bools, bounds: tuple[Floats, Floats]
) -> tuple[Coefficient, ...]:
    """Coefficients with their confidence intervals, or why the tests do not identify them."""
    found = []
    for i, name in enumerate(fitted.names()):
        half, scale = float(half_widths[i]), float(fitted.scales[i])
        reason = ""
        if unidentified[i]:
            reason = "no test depends on it, or only together with others"
        elif not bounds[0][i] + EQUAL < x[i] < bounds[1][i] - EQUAL:
            reason = f"the fit runs to {x[i] * scale:.3g}, the end of the range of the search"
        elif half >= max(1.0, abs(x[i])) or half >= MAX_RATIO:
            reason = f"the tests leave it open to ± {half * scale:.3g}"
        if reason:
            found.append(Coefficient(name, None, None, reason))
        else:
            ends = float((x[i] - half) * scale), float((x[i] + half) * scale)
            found.append(Coefficient(name, float(x[i] * scale), ends))
    return tuple(found)


def _check(tests: Tests, scenario: Scenario, inputs: Sequence[str], law: Law) -> None:
    """Check that the inputs can be fitted to the tests.

    Raises
    ------
    InputError
        With every mistake.
    """
    check_names(inputs, scenario, scenario.file, "--fit")
    problems = []
    if len(set(inputs)) != len(inputs):
        problems.append(Problem(scenario.file, "--fit", "must not name an input twice"))
    for name in inputs:
        if any(name in group.columns for group in tests.groups):
            problems.append(Problem(tests.file, name, "must not be a column where it is fitted"))
        if name in (VELOCITY, CERAMIC, BACKING):
            problems.append(Problem(scenario.file, "--fit", f'must be of a material or projectile, found "{name}"'))
    for role, key in NAMES.items():
        names = {name_of(group.scenario, role) for group in tests.groups}
        if len(names) > 1 and any(name.startswith(role + ".") for name in inputs):
            message = (
                f"must be the same in all tests where the {role} is fitted, found {', '.join(sorted(map(str, names)))}"
            )
            problems.append(Problem(tests.file, key, message))
    if law != "constant" and FLOW_STRESS not in inputs:
        problems.append(Problem(scenario.file, "--law", f"is of {FLOW_STRESS}, which must be fitted with it"))
    count = len(inputs) - 1 + sum(LAWS[law])
    exact = sum(m.side == 0 for m in tests.measurements)
    needed = count + (not tests.weighted)
    if exact < needed:
        without = "" if tests.weighted else " without uncertainties"
        message = (
            f"must have at least {needed} measurements{without} for {count} coefficients, found {exact}; "
            "outcomes are bounds and do not count"
        )
        problems.append(Problem(tests.file, "", message))
    if problems:
        raise InputError(problems)
