"""Fit of a scenario's inputs to tests by least squares."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm, t

from armour.analysis.answers import Answers
from armour.analysis.estimates import CONFIDENCE
from armour.analysis.searches import ballistic_limits
from armour.analysis.variants import Bools, Floats, OnProgress, Variants, ignore_progress, perforated, variants_of
from armour.errors import Problem, refuse
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, NAMES, VELOCITY, check_names, name_of
from armour.statistics.flow_stress_laws import (
    FLOW_STRESS,
    LAWS,
    MAX_RATIO,
    Coefficients,
    Law,
    coefficients_of,
    input_values,
)
from armour.statistics.test_data import LIMIT, MASS, RESIDUAL, Tests

# Starting points of the fit, in units of the coefficients' scales.
STARTS = (1.0, 0.5, 2.0)
# Tolerance of ballistic limits, m/s, and relative change of coefficients for the derivatives.
LIMIT_TOLERANCE_M_S = 1e-9
DIFFERENCE = 1e-4
# Change of coefficients, divided by their scales, up to which a fit to fewer tests is linearised.
SMALL_CHANGE = 1e-3
# Coefficients this close to each other are equal.
EQUAL = 1e-3


@dataclass(frozen=True)
class Coefficient:
    """A fitted coefficient."""

    name: str  # of the input, with its unit, and the thickness that it multiplies
    estimate: float | None  # None where the tests do not identify it
    interval: tuple[float, float] | None  # confidence interval
    reason: str = ""  # why it is not identified


class LeastSquaresFit(NamedTuple):
    """A fit of coefficients to tests."""

    fitted: Coefficients
    x: Floats  # values of the coefficients, divided by their scales, (k,)
    coefficients: tuple[Coefficient, ...]
    deviations: Floats  # of the m measurements, as `minimised` weighs them, (m,)
    jacobian: Floats  # their derivatives, (m, k)
    correlation: Floats  # (k, k)
    chi_squared: float  # sum of squares
    degrees_of_freedom: int
    starts: int
    starts_agreeing: int


def fit_inputs(
    tests: Tests, scenario: Scenario, inputs: Sequence[str], law: Law, on_progress: OnProgress = ignore_progress
) -> LeastSquaresFit:
    """Fit inputs of a scenario to tests, from several starting points; see `armour.statistics.calibration.calibrate`.

    The confidence intervals are those of the model linearised at the estimate, with the uncertainties given or, without
    them, with the scatter of the deviations.
    """
    _check(tests, scenario, inputs, law)
    fitted = coefficients_of(tests, inputs, law)
    everything = np.ones(len(tests.measurements), dtype=bool)
    ends = [minimised(tests, fitted, start, everything, on_progress) for start in _starts(fitted.lower < 0.0)]
    best = min(ends, key=lambda end: float(end.cost))
    exact = np.array([m.side == 0 for m in tests.measurements])
    freedom = int((exact | (best.fun != 0.0)).sum()) - len(best.x)
    inverse = np.linalg.pinv(best.jac, rcond=1e-6)
    # A coefficient is not identified if it can change without an effect on the measurements.
    unidentified = np.diag(inverse @ best.jac) < 1.0 - 1e-6
    covariance = inverse @ inverse.T * (1.0 if tests.weighted else 2.0 * best.cost / freedom)
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = covariance / np.outer(deviation, deviation)
    np.fill_diagonal(correlation, 1.0)
    tail = 0.5 * (1.0 + CONFIDENCE)
    factor = float(norm.ppf(tail) if tests.weighted else t.ppf(tail, freedom))
    return LeastSquaresFit(
        fitted=fitted,
        x=best.x,
        coefficients=_coefficients(fitted, best.x, factor * deviation, unidentified),
        deviations=best.fun,
        jacobian=best.jac,
        correlation=correlation,
        chi_squared=2.0 * float(best.cost),
        degrees_of_freedom=freedom,
        starts=len(ends),
        starts_agreeing=sum(np.allclose(end.x, best.x, rtol=EQUAL, atol=EQUAL) for end in ends),
    )


def minimised(tests: Tests, fitted: Coefficients, start: Floats, kept: Bools, on_progress: OnProgress) -> Any:
    """Return scipy's result of a least-squares search from a starting point, with some of the measurements.

    A deviation is divided by its uncertainty or, without one, by the measured value; that of a censored observation
    counts only where its bound is not met.
    """
    scales = [m.uncertainty or m.value for m in tests.measurements]
    value, scale, side = np.array([(m.value, s, m.side) for m, s in zip(tests.measurements, scales, strict=True)]).T

    def deviations(x: Floats) -> Floats:
        found = (predicted(tests, fitted, x) - value) / scale
        on_progress(len(value), None)
        return np.where((side == 0) | (side * found < 0.0), found, 0.0)[kept]

    bounds = (fitted.lower, MAX_RATIO)
    return least_squares(deviations, start, bounds=bounds, diff_step=np.full(len(start), DIFFERENCE), xtol=1e-10)


def without(tests: Tests, done: LeastSquaresFit, kept: Bools, on_progress: OnProgress) -> Floats:
    """Return the coefficients fitted to some of the measurements, (k,), given the fit to all of them.

    A small change is that of the model linearised at the fit to all, whose error is of the second order; else the
    search is repeated.
    """
    change = np.linalg.lstsq(done.jacobian[kept], -done.deviations[kept], rcond=1e-6)[0]
    x: Floats = done.x + change
    if (np.abs(change) <= SMALL_CHANGE).all() and ((done.fitted.lower < x) & (x < MAX_RATIO)).all():
        return x
    found: Floats = minimised(tests, done.fitted, done.x, kept, on_progress).x
    return found


def predicted(tests: Tests, coefficients: Coefficients, x: Floats) -> Floats:
    """Return the model's values of the m measurements, (m,), given coefficients, (k,), or those of each test, (k, n).

    These are divided by their scales.
    """
    found = np.empty(len(tests.measurements))
    of_test = np.array([m.test for m in tests.measurements])
    quantities = np.array([m.quantity for m in tests.measurements])
    for group in tests.groups:
        columns = {**group.columns, **input_values(coefficients, x, group)}
        variants = variants_of(group.scenario, columns, len(group.where))
        in_group = np.isin(of_test, group.where)
        for quantity, model in MODELS.items():
            where = np.flatnonzero(in_group & (quantities == quantity))
            if len(where):
                found[where] = model(variants.at(np.searchsorted(group.where, of_test[where])))
    return found


def _limits(variants: Variants) -> Floats:
    """Return ballistic limits, m/s; the end of the search's range where the limit lies beyond it."""
    search = variants.settings.ballistic_limit
    limits = ballistic_limits(variants, tolerance=LIMIT_TOLERANCE_M_S)
    outside = np.flatnonzero(np.isnan(limits))
    if len(outside):
        slowest = np.full(len(outside), search.velocity_min_m_s)
        below = perforated(variants.at(outside)._replace(velocities=slowest))
        limits[outside] = np.where(below, search.velocity_min_m_s, search.velocity_max_m_s)
    return limits


def _residual_velocities(variants: Variants) -> Floats:
    """Return residual velocities, m/s; of a defeated test, the impact velocity less the ballistic limit."""
    answers = Answers(variants)
    found = answers.impacts.V.copy()
    defeated = np.flatnonzero(~answers.perforated)
    if len(defeated):
        found[defeated] = np.minimum(variants.velocities[defeated] - _limits(variants.at(defeated)), found[defeated])
    return found


# The model's values of variants, by measured quantity.
MODELS: dict[str, Callable[[Variants], Floats]] = {
    LIMIT: _limits,
    RESIDUAL: _residual_velocities,
    MASS: lambda variants: Answers(variants).residual_masses,
}


def _starts(slopes: Bools) -> list[Floats]:
    """Return the starting points: several values of each coefficient, with zero and with positive slopes of a law."""
    starts = [np.where(slopes, 0.0, start) for start in STARTS]
    return [*starts, np.where(slopes, 0.3, 0.5)] if slopes.any() else starts


def _coefficients(fitted: Coefficients, x: Floats, half_widths: Floats, unidentified: Bools) -> tuple[Coefficient, ...]:
    """Return the coefficients with their confidence intervals, or why the tests do not identify them."""
    found = []
    for i, name in enumerate(fitted.names()):
        half, scale = float(half_widths[i]), float(fitted.scales[i])
        reason = ""
        if unidentified[i]:
            reason = "no test depends on it, or only together with others"
        elif not fitted.lower[i] + EQUAL < x[i] < MAX_RATIO - EQUAL:
            reason = f"the fit runs to {x[i] * scale:.3g}, the end of the range of the search"
        elif half >= max(1.0, abs(x[i])) or half >= MAX_RATIO:
            reason = f"the tests determine it only to ± {half * scale:.3g}"
        if reason:
            found.append(Coefficient(name, None, None, reason))
        else:
            ends = float((x[i] - half) * scale), float((x[i] + half) * scale)
            found.append(Coefficient(name, float(x[i] * scale), ends))
    return tuple(found)


def _check(tests: Tests, scenario: Scenario, inputs: Sequence[str], law: Law) -> None:
    """Check that the inputs can be fitted to the tests."""
    check_names(inputs, scenario, scenario.file, "--fit")
    problems = []
    if len(set(inputs)) != len(inputs):
        problems.append(Problem(scenario.file, "--fit", "must not name an input twice"))
    for name in inputs:
        if any(name in group.columns for group in tests.groups):
            problems.append(Problem(tests.file, name, "must not be a column where it is fitted"))
        if name in (VELOCITY, CERAMIC, BACKING):
            problems.append(
                Problem(scenario.file, "--fit", f'must be a property of a material or projectile, found "{name}"')
            )
    for role, key in NAMES.items():
        names = {name_of(group.scenario, role) for group in tests.groups}
        if len(names) > 1 and any(name.startswith(role + ".") for name in inputs):
            message = (
                f"must be the same in all tests where the {role} is fitted, found {', '.join(sorted(map(str, names)))}"
            )
            problems.append(Problem(tests.file, key, message))
    if law != "constant" and FLOW_STRESS not in inputs:
        problems.append(
            Problem(scenario.file, "--law", f'must be "constant" where {FLOW_STRESS} is not fitted, found "{law}"')
        )
    count = len(inputs) - 1 + len(LAWS[law])
    exact = sum(m.side == 0 for m in tests.measurements)
    needed = count + (not tests.weighted)
    if exact < needed:
        without = "" if tests.weighted else " without uncertainties"
        message = (
            f"must have at least {needed} measurements{without} for {count} coefficients, found {exact}; "
            "outcomes are bounds and do not count"
        )
        problems.append(Problem(tests.file, "", message))
    refuse(problems)
