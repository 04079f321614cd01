"""Fit a scenario's inputs to tests by maximum likelihood, with profile-likelihood intervals.

A point `x`, (k,), has the k fitted inputs in their units.  The unit of an input is the scenario's own value, so that
1.1 is 10 % more; that of a coefficient of a law of the flow stress is 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import exp, log, pi, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import approx_fprime, least_squares, minimize_scalar
from scipy.special import chdtrc, log_ndtr, ndtri, stdtrit

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.evaluate import QuantityValues
from armour.analysis.results import OnProgress
from armour.analysis.variants import Bools, Floats, Variants, ballistic_limits
from armour.core.search import SCAN_POINTS
from armour.errors import Problem, mistake, refuse
from armour.scenario.inputs import INPUTS, NAMES
from armour.scenario.library import FLOW_STRESS_LAW
from armour.statistics.curves import profile_end
from armour.statistics.measured import LIMIT, MASS, RESIDUAL, Tests

# Bounds of a fitted input, in its unit, and greatest absolute value of a coefficient of a law.
MIN_RATIO, MAX_VALUE_RATIO, MAX_COEFFICIENT = 0.1, 10.0, 3.0
# Change of inputs for the derivatives.
DIFFERENCE = 1e-4
# Accuracy of the inputs in a fit, and in fits that are compared with it, with an input held or tests left out.
FIT_TOLERANCE, COMPARED_TOLERANCE = 1e-10, 1e-5
# Change of inputs, in their units, up to which a fit to fewer tests is linearised.
SMALL_CHANGE = 1e-3
# Values this close to each other are equal.
CLOSE = 1e-3
# Range of the scatter, a fraction of the measured value.
SCATTER_BOUNDS = 1e-6, 1.0
# Least p value at which the given uncertainties are taken to explain the deviations.
MIN_P_VALUE = 0.05


@dataclass(frozen=True)
class Coefficient:
    """A fitted input.

    Attributes
    ----------
    name : str
        Name of the input, such as ``"ceramic.flow_stress_GPa"``.
    estimate : float or None
        In the unit of the name; None if the tests do not identify it.
    interval : tuple of float or None, or None
        Profile-likelihood interval; None for an end that is open, or if both are.
    reason : str
        Reason why the input is not identified; empty if it is.
    standard_error : float or None
        Standard error, from the model linearised at the estimate; None without an estimate.
    """

    name: str
    estimate: float | None
    interval: tuple[float | None, float | None] | None
    reason: str = ""
    standard_error: float | None = None


class Likelihood(NamedTuple):
    """The likelihood of k inputs given the m measurements of n tests.

    A measured value is normally distributed about the model's value.  Its standard deviation is the given uncertainty
    or, without uncertainties, a fraction of the value, the scatter, which is common to all.  The likelihood of an
    outcome is the probability that a ballistic limit with this distribution is above the impact velocity (stopped) or
    below it (perforated).
    """

    tests: Tests
    names: tuple[str, ...]
    units: Floats  # of the inputs: the scenario's own values, or 1, (k,)
    lower: Floats  # bounds in these units, (k,)
    upper: Floats
    kept: Bools  # whether each measurement counts, (m,); a fit to fewer tests leaves some out
    on_progress: OnProgress

    @property
    def sides(self) -> Floats:
        """Kind of each measurement that counts: 0 for a measured value, +1 for a shot stopped, -1 for one perforating.

        It is the side of the velocity on which the ballistic limit lies.
        """
        return np.array([m.side for m in self.tests.measurements])[self.kept]

    @property
    def usable(self) -> int:
        """Number of measurements to fit to: those that count, without outcomes unless uncertainties are given."""
        return len(self.sides) if self.tests.weighted else int((self.sides == 0).sum())

    @property
    def needed(self) -> int:
        """Number of measurements that a fit needs: one for each input and, without uncertainties, one more."""
        return len(self.names) + (not self.tests.weighted)

    def deviations(self, x: Floats) -> Floats:
        """Return the deviations of the model at a point, (k,), from the measurements that count, one for each.

        A deviation, computed minus measured, is divided by the uncertainty of its measurement or, without
        uncertainties, by the measured value.
        """
        scales = [m.uncertainty or m.value for m in self.tests.measurements]
        values = np.array([m.value for m in self.tests.measurements])
        self.on_progress(len(values), None)
        return ((self.predicted(x) - values) / scales)[self.kept]

    def predicted(self, x: Floats) -> Floats:
        """Return the model's values of the m measurements, (m,), each in the unit of its quantity.

        `x` is a point, (k,), or has one point for each of the n tests, (k, n).
        """
        measurements = self.tests.measurements
        values = np.empty(len(measurements))
        test_indices = np.array([m.test for m in measurements])
        quantities = np.array([m.quantity for m in measurements])
        inputs = np.broadcast_to((x.T * self.units).T.reshape(len(x), -1), (len(x), len(self.tests.names)))
        for group in self.tests.groups:
            variants = group.variants(dict(zip(self.names, inputs[:, group.where], strict=True)))
            in_group = np.isin(test_indices, group.where)
            for quantity, model in MODELS.items():
                where = np.flatnonzero(in_group & (quantities == quantity))
                if len(where):
                    values[where] = model(variants.at(np.searchsorted(group.where, test_indices[where])))
        return values


def _limits(variants: Variants) -> Floats:
    """Return the ballistic limits of variants, m/s, (n,), clipped to the range of the search.

    The usual scan is enough even for unusual armours: a fit meets them only far from its solution, or has none.
    """
    section = variants.scenario.ballistic_limit
    ends = section.velocity_min_m_s, section.velocity_max_m_s
    return ballistic_limits(variants, tolerance=1e-9, points=SCAN_POINTS).clip(*ends)


def _residual_velocities(variants: Variants) -> Floats:
    """Return the residual velocities of variants, m/s, (n,): where stopped, the impact velocity minus the limit."""
    answers = QuantityValues(variants)
    residual = answers.impacts.V.copy()
    stopped = np.flatnonzero(~answers.perforated)
    if len(stopped):
        residual[stopped] = np.minimum(variants.velocities[stopped] - _limits(variants.at(stopped)), residual[stopped])
    return residual


# Function that computes each measured quantity of variants by the model.
MODELS: dict[str, Callable[[Variants], Floats]] = {
    LIMIT: _limits,
    RESIDUAL: _residual_velocities,
    MASS: lambda variants: QuantityValues(variants).residual_masses,
}


class Point(NamedTuple):
    """The most likely inputs and scatter that a search has found; some may have been held."""

    x: Floats  # in their units, (k,)
    scatter: float  # 1 if uncertainties are given
    loss: float  # -2 times the logarithm of the likelihood, up to a constant


@dataclass(frozen=True)
class Precision:
    """How precisely tests determine k fitted inputs: the base of `InputFit`."""

    covariance: Floats  # of the inputs in their units, (k, k)
    degrees_of_freedom: float
    chi_squared: float  # of the measured values
    p_value: float | None
    widened_by: float  # factor by which the intervals are widened
    threshold: float  # deviance at the ends of the intervals


@dataclass(frozen=True)
class InputFit(Precision):
    """A fit of inputs to tests.

    ``gradients`` (of the m measurements that count, by `_weighted_gradients`) and ``residuals`` are the least-squares
    problem linearised at the fit, whose solution is a Newton step.
    """

    likelihood: Likelihood
    best: Point
    gradients: Floats  # (m, k)
    residuals: Floats  # (m,)
    starts: int
    starts_agreeing: int

    def coefficients(self) -> tuple[Coefficient, ...]:
        """Return each fitted input with its profile-likelihood interval, or why the tests do not identify it."""
        return tuple(_coefficient(self, index) for index in range(len(self.likelihood.names)))


def fit_inputs(likelihood: Likelihood) -> InputFit:
    """Fit inputs to tests, from several starts; see `armour.statistics.calibration.calibrate`.

    An InputError says that there are too few measurements.
    """
    tests, needed, count = likelihood.tests, likelihood.needed, likelihood.usable
    if count < needed:
        kinds = "measurements or outcomes" if tests.weighted else "measurements, as their uncertainties are not given,"
        message = f"must have at least {needed} {kinds} for {len(likelihood.names)} coefficients, found {count}"
        raise mistake(tests.file, "", message)
    is_coefficient = likelihood.lower < 0.0
    # Coefficients of a law start at 0, and once elsewhere.
    starts = [np.where(is_coefficient, 0.0, start) for start in (1.0, 0.5, 2.0)]
    starts += [np.where(is_coefficient, 0.3, 1.0)] if is_coefficient.any() else []
    solutions = [search(likelihood, start) for start in starts]
    best = min(solutions, key=lambda solution: solution.loss)
    sides, z = likelihood.sides, likelihood.deviations(best.x) / best.scatter
    weights, gradients = _weighted_gradients(likelihood, best.x, best.scatter)
    residuals = np.where(sides == 0, z, -sides * _hazard(sides * z) / np.maximum(weights, 1e-150))
    if tests.weighted:
        precision = _precision_by_uncertainties(gradients, residuals, sides)
    else:
        precision = _precision_by_scatter(gradients, weights, z, sides, best.scatter)
    return InputFit(
        **vars(precision),
        likelihood=likelihood,
        best=best,
        gradients=gradients,
        residuals=residuals,
        starts=len(solutions),
        starts_agreeing=sum(np.allclose(solution.x, best.x, rtol=CLOSE, atol=CLOSE) for solution in solutions),
    )


def likelihood_of(tests: Tests, inputs: Sequence[str], on_progress: OnProgress) -> Likelihood:
    """Return the likelihood of inputs, by name, given tests; raise an InputError if they cannot be fitted to these."""
    _check_fittable(tests, inputs)
    first = tests.groups[0].scenario
    values, is_coefficient = first.inputs(), np.array([name.partition(".")[2] in FLOW_STRESS_LAW for name in inputs])
    units = np.where(is_coefficient, 1.0, [values[name] for name in inputs])
    lower = np.where(is_coefficient, -MAX_COEFFICIENT, MIN_RATIO)
    upper = np.where(is_coefficient, MAX_COEFFICIENT, MAX_VALUE_RATIO)
    kept = np.ones(len(tests.measurements), dtype=bool)
    return Likelihood(tests, tuple(inputs), units, lower, upper, kept, on_progress)


def search(
    likelihood: Likelihood,
    start: Floats,
    held: int | None = None,
    scatter: float | None = None,
    tolerance: float = FIT_TOLERANCE,
) -> Point:
    """Search for the most likely inputs, and the scatter, from a starting point, (k,).

    The input at the index `held`, if there is one, keeps its value, and the scatter is `scatter`, if this is given.
    `tolerance` is the accuracy of the inputs in their units.
    """
    free = np.flatnonzero(np.arange(len(start)) != held)
    sides, x = likelihood.sides, start.copy()
    # Without outcomes the scatter has no effect on the most likely inputs.
    scatter_matters = bool(sides.any())

    @cache
    def deviations_at(inputs: tuple[float, ...]) -> Floats:
        """Return the deviations at given values of the inputs that are not held."""
        point = x.copy()
        point[free] = inputs
        return likelihood.deviations(point)

    def move(scatter: float) -> Floats:
        """Move `x` to the most likely inputs given the scatter, and return the deviations there."""

        def losses(inputs: Floats) -> Floats:
            """Return the residuals of least squares, (m,)."""
            return _losses(deviations_at(tuple(inputs.tolist())) / scatter, sides)

        def slopes(inputs: Floats) -> Floats:
            """Return the derivatives of the residuals by the inputs that are not held."""
            return approx_fprime(inputs, losses, DIFFERENCE)

        if len(free):
            bounds = likelihood.lower[free], likelihood.upper[free]
            ftol = max(tolerance, 1e-8)
            x[free] = least_squares(losses, x[free], jac=slopes, bounds=bounds, ftol=ftol, xtol=tolerance).x
        return deviations_at(tuple(x[free].tolist()))

    def loss(deviations: Floats, scatter: float) -> float:
        """Return -2 times the log-likelihood, up to a constant."""
        return float((_losses(deviations / scatter, sides) ** 2).sum() + 2.0 * (sides == 0).sum() * log(scatter))

    def profile(log_scatter: float) -> float:
        """Return the loss at the most likely inputs given the scatter."""
        return loss(move(exp(log_scatter)), exp(log_scatter))

    if scatter_matters and not likelihood.tests.weighted and scatter is None:
        ends = log(SCATTER_BOUNDS[0]), log(SCATTER_BOUNDS[1])
        scatter = exp(minimize_scalar(profile, bounds=ends, options={"xatol": 1e-3}).x)
    deviations = move(scatter if scatter and scatter_matters else 1.0)
    if scatter is None:
        scatter = 1.0 if likelihood.tests.weighted else float(np.clip(np.sqrt(np.mean(deviations**2)), *SCATTER_BOUNDS))
    return Point(x, scatter, loss(deviations, scatter))


def _losses(z: Floats, sides: Floats) -> Floats:
    """Return residuals whose squares are -2 times the log-likelihoods of the measurements, up to constants, (m,).

    `z`, (m,), are deviations in standard deviations; `sides`, (m,), are those of `Likelihood`.
    """
    return np.where(sides == 0, z, np.sqrt(-2.0 * log_ndtr(sides * z)))


# Probability below the upper end of an interval.
UPPER = 0.5 * (1.0 + CONFIDENCE)


def _precision_by_uncertainties(gradients: Floats, residuals: Floats, sides: Floats) -> Precision:
    """Return the precision of a fit to tests with uncertainties, lower if the deviations are larger than these explain.

    `gradients`, (m, k), and `residuals`, (m,), are those of `InputFit`; `sides`, (m,), those of `Likelihood`.
    """
    count, measured = gradients.shape[1], sides == 0
    covariance, leverages = _covariance_and_leverages(gradients, count)
    # The part of the inputs that outcomes determine takes no degree of freedom from measured values.
    freedom = float(measured.sum() - count + leverages[~measured].sum())
    freedom = round(freedom, 9) + 0.0  # outcomes alone leave none, but for rounding
    chi_squared = float((residuals[measured] ** 2).sum())
    p_value = float(chdtrc(freedom, chi_squared)) if freedom > 0.5 else None
    widened_by, threshold = 1.0, float(ndtri(UPPER)) ** 2
    if p_value is not None and p_value < MIN_P_VALUE:
        widened_by = sqrt(chi_squared / freedom)
        threshold = (widened_by * float(stdtrit(freedom, UPPER))) ** 2
    return Precision(covariance * widened_by**2, freedom, chi_squared, p_value, widened_by, threshold)


def _precision_by_scatter(gradients: Floats, weights: Floats, z: Floats, sides: Floats, scatter: float) -> Precision:
    """Return the precision of a fit to tests without uncertainties, whose scatter is estimated with the inputs.

    `gradients`, (m, k), are those of `InputFit`, `weights`, (m,), those of `_weighted_gradients`; `z`, (m,), are
    deviations over the scatter; `sides`, (m,), are those of `Likelihood`.  Without outcomes, the intervals are exact
    for a linear model.  Outcomes count as the number of measured values that would determine the scatter as well.
    """
    count, measurements, measured = gradients.shape[1], len(z), sides == 0
    # With the logarithm of the scatter as a further unknown: it affects the inputs through outcomes.
    joint_gradients = np.zeros((measurements + 1, count + 1))
    joint_gradients[:-1, :count] = gradients
    joint_gradients[:-1, count] = np.where(measured, 0.0, -weights * z)
    joint_gradients[-1, count] = sqrt(2.0 * measured.sum())
    information = np.where(measured, 2.0, z**2 * _hazard(sides * z) * _hazard(-sides * z))  # on the scatter's logarithm
    equivalent = 0.5 * float(information.sum())  # number of measured values that determine the scatter as well
    freedom = equivalent - count
    joint_gradients *= sqrt(freedom / equivalent)
    return Precision(
        covariance=_covariance_and_leverages(joint_gradients, count)[0],
        degrees_of_freedom=freedom,
        chi_squared=float((z[measured] ** 2).sum()) * scatter**2,
        p_value=None,
        widened_by=1.0,
        threshold=equivalent * float(np.log1p(stdtrit(freedom, UPPER) ** 2 / freedom)),
    )


def _covariance_and_leverages(gradients: Floats, count: int) -> tuple[Floats, Floats]:
    """Return the covariance of the first `count` unknowns of a least-squares problem, and the leverages on them.

    `gradients`, (n, unknowns), are the coefficients of its n equations, whose errors have variance 1.  The covariance
    is (count, count); each equation has a leverage, (n,).
    """
    inverse = np.linalg.pinv(gradients, rcond=1e-6)[:count]
    return inverse @ inverse.T, (gradients[:, :count] * inverse.T).sum(axis=1)


def _weighted_gradients(likelihood: Likelihood, x: Floats, scatter: float) -> tuple[Floats, Floats]:
    """Return the weights, (m,), and the weighted gradients, (m, k), of the m measurements that count, at a point, (k,).

    A weighted gradient is the weight times the gradient of the deviation, in standard deviations, by the inputs in
    their units.  The weight of a measured value is 1, that of an outcome less.  The information about the inputs, in
    their units, is gradients.T @ gradients.
    """
    sides = likelihood.sides
    jacobian = approx_fprime(x, likelihood.deviations, DIFFERENCE).reshape(len(sides), len(x)) / scatter
    z = sides * likelihood.deviations(x) / scatter
    hazards = _hazard(z)
    weights = np.sqrt(np.where(sides == 0, 1.0, hazards * (hazards + z)))
    return weights, weights[:, None] * jacobian


def _hazard(z: Floats) -> Floats:
    """Return the density of the standard normal distribution divided by its distribution function, at each `z`."""
    return np.exp(-0.5 * z * z - log_ndtr(z)) / sqrt(2.0 * pi)


def _coefficient(fit: InputFit, index: int) -> Coefficient:
    """Return the fitted input at an index, with its interval, or why the tests do not identify it."""
    likelihood, name = fit.likelihood, fit.likelihood.names[index]
    unit, error = float(likelihood.units[index]), sqrt(max(float(fit.covariance[index, index]), 0.0))
    bounds = float(likelihood.lower[index]), float(likelihood.upper[index])
    (low, flat_below), (high, flat_above) = (_interval_end(fit, index, bound, error) for bound in bounds)
    ends = (None if low is None else low * unit, None if high is None else high * unit)
    if ends == (None, None):
        return Coefficient(name, None, None, "the tests bound it neither above nor below")
    if flat_below or flat_above:
        bound = bounds[0 if flat_below else 1] * unit
        return Coefficient(name, None, ends, f"the fit is as good at {bound:.3g}, the end of the range searched")
    return Coefficient(name, float(fit.best.x[index]) * unit, ends, standard_error=error * unit)


def _interval_end(fit: InputFit, index: int, bound: float, error: float) -> tuple[float | None, bool]:
    """Return the end of the interval of an input on the side of its bound, and whether the fit is as good at the bound.

    The end, in the unit of the input, is None if the likelihood does not fall enough up to the bound.  `index` is that
    of the input, `error` its standard error, in its unit.
    """
    likelihood, best = fit.likelihood, fit.best
    # Most likely changes of the other inputs per change of this one.
    other_inputs = np.arange(len(best.x)) != index
    slopes = np.linalg.lstsq(fit.gradients[:, other_inputs], -fit.gradients[:, index], rcond=1e-6)[0]

    def deviance(value: float) -> float:
        """Return the deviance of a value of this input, with the others as likely as possible."""
        start = best.x.copy()
        start[index] = value
        start[other_inputs] += slopes * (value - best.x[index])
        start = np.clip(start, likelihood.lower, likelihood.upper)
        return search(likelihood, start, held=index, tolerance=COMPARED_TOLERANCE).loss - best.loss

    step = min(max(1.8 * error, DIFFERENCE), 1.0)
    end = profile_end(deviance, float(best.x[index]), bound, sqrt(fit.threshold), step, 1e-3 * step)
    return end, end is None and deviance(bound) < CLOSE


def refitted_inputs(fit: InputFit, kept: Bools) -> Floats:
    """Return the inputs fitted to the measurements `kept` alone, (k,), with the scatter of the fit to all.

    `kept`, (m,), tells which measurements count.

    If the change from the fit to all is small, it is a Newton step, with an error of second order; otherwise the search
    is repeated.
    """
    likelihood = fit.likelihood._replace(kept=kept)
    change = np.linalg.lstsq(fit.gradients[kept], -fit.residuals[kept], rcond=1e-6)[0]
    x: Floats = np.clip(fit.best.x + change, likelihood.lower, likelihood.upper)
    if (np.abs(x - fit.best.x) <= SMALL_CHANGE).all():
        return x
    return search(likelihood, x, scatter=fit.best.scatter, tolerance=COMPARED_TOLERANCE).x


def _check_fittable(tests: Tests, inputs: Sequence[str]) -> None:
    """Raise an InputError unless inputs, by name, can be fitted to tests: properties that no column of these varies."""
    tests.scenario.check_names(inputs, "calibrate", "fit")
    problems = []
    for name in inputs:
        if any(name in group.columns for group in tests.groups):
            problems.append(Problem(tests.file, name, "must not be a column if it is fitted"))
        if INPUTS[name].kind is None:
            message = f'must be a property of a material or projectile, found "{name}"'
            problems.append(Problem("calibrate", "fit", message))
    for role, key in NAMES.items():
        names = {group.scenario.name_of(role) for group in tests.groups}
        if len(names) > 1 and any(name.startswith(role + ".") for name in inputs):
            found = ", ".join(sorted(map(str, names)))
            message = f"must be the same in all tests if the {role} is fitted, found {found}"
            problems.append(Problem(tests.file, key, message))
    refuse(problems)
