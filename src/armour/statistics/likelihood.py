"""Fit of a scenario's inputs to tests by maximum likelihood, with prior knowledge and profile-likelihood intervals."""

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
from armour.analysis.samples import centre_and_width
from armour.analysis.variants import Bools, Floats, Ints, Variants, ballistic_limits
from armour.core.search import SCAN_POINTS
from armour.errors import Problem, mistake, refuse
from armour.scenario.inputs import INPUTS, NAMES
from armour.scenario.library import FLOW_STRESS_LAW
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Uncertainty, correlation_matrix
from armour.statistics.curves import profile_end
from armour.statistics.measured import LIMIT, MASS, RESIDUAL, MaterialGroup, Tests


class Prior(NamedTuple):
    """Distributions of q of k inputs, normal in the inputs or in their logarithms."""

    where: Ints  # indices of the inputs, (q,)
    logs: Bools  # whether the logarithm is normal, (q,)
    centres: Floats  # of inputs in their units, or of their logarithms, (q,)
    widths: Floats
    root: Floats  # of the inverse of the correlation matrix, (q, q): its transpose times itself

    def scores(self, x: Floats) -> Floats:
        """Return independent standard normal scores of inputs in their units, (q,)."""
        inputs = x[self.where]
        return self.root @ ((np.where(self.logs, np.log(np.abs(inputs)), inputs) - self.centres) / self.widths)

    def rows(self, x: Floats) -> Floats:
        """Return the derivatives of the scores by the inputs, (q, k)."""
        derivatives = np.zeros((len(self.where), len(x)))
        derivatives[:, self.where] = self.root / self.deviations(x)
        return derivatives

    def deviations(self, x: Floats) -> Floats:
        """Return the standard deviations of the inputs near a point, (q,)."""
        return self.widths * np.where(self.logs, x[self.where], 1.0)

    def centred(self, x: Floats) -> Floats:
        """Return a point with the inputs that have a distribution at its centre."""
        centre = x.copy()
        centre[self.where] = np.where(self.logs, np.exp(self.centres), self.centres)
        return centre


NO_PRIOR = Prior(np.empty(0, dtype=int), np.empty(0, dtype=bool), np.empty(0), np.empty(0), np.empty((0, 0)))


def prior_of(scenario: Scenario, names: Sequence[str], units: Floats) -> Prior:
    """Return a scenario's distributions of fitted inputs, of which there must be at least one."""
    section, values = scenario.uncertainty or Uncertainty(), scenario.inputs()
    distributions = {name: distribution for name, distribution in section.inputs().items() if name in names}
    if not distributions:
        message = f"is missing and must be given for a prior: the distribution of {' or '.join(names)}"
        raise mistake(scenario.file, "uncertainty", message)
    problems = []
    for name, distribution in distributions.items():
        message = distribution.mean_problem(values[name])
        if distribution.distribution == "uniform" or (distribution.min, distribution.max) != (None, None):
            message = "must be normal or lognormal, without min and max, to be a prior"
        if message:
            problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    refuse(problems)
    where = np.array([names.index(name) for name in distributions])
    logs = np.array([distribution.distribution == "lognormal" for distribution in distributions.values()])
    moments = [centre_and_width(distribution, values[name]) for name, distribution in distributions.items()]
    centres, widths = np.array(moments).T
    scale = units[where]
    pairs = [pair for pair in section.correlation if {*pair.between} <= {*distributions}]
    root = np.linalg.inv(np.linalg.cholesky(correlation_matrix([*distributions], pairs)))
    centres, widths = np.where(logs, (centres - np.log(scale), widths), (centres / scale, widths / scale))
    return Prior(where, logs, centres, widths, root)


# Bounds of an input in units of the scenario's own value; of a coefficient of a law, which may be negative.
MIN_RATIO, MAX_VALUE_RATIO, MAX_COEFFICIENT = 0.1, 10.0, 3.0
# Tolerance of ballistic limits, m/s, and change of inputs for the derivatives.
LIMIT_TOLERANCE_M_S = 1e-9
DIFFERENCE = 1e-4
# Accuracy of the inputs of a fit, and of fits compared with it, in which an input is held or tests are left out.
FIT_TOLERANCE, COMPARED_TOLERANCE = 1e-10, 1e-5
# Change of inputs, in their units, up to which a fit to fewer tests is linearised.
SMALL_CHANGE = 1e-3
# Values this close to each other are equal.
CLOSE = 1e-3
# Range of the scatter.
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
        Profile-likelihood interval; None for an end that is open.
    reason : str
        Reason why it is not identified.
    standard_error : float or None
        Of the model linearised at the estimate.
    prior_share : float or None
        Share of the prior in its precision, 0 to 1; None without a prior of it.
    """

    name: str
    estimate: float | None
    interval: tuple[float | None, float | None] | None
    reason: str = ""
    standard_error: float | None = None
    prior_share: float | None = None


class Likelihood(NamedTuple):
    """The likelihood of k inputs given m measurements.

    A measured value is normally distributed about the model's value.  Its standard deviation is the given uncertainty
    or, without uncertainties, a fraction of the value, the scatter, which is common to all.  An outcome has the
    probability that a ballistic limit of this distribution lies on its side of the impact velocity.  A prior counts as
    measured values of its normal scores.
    """

    tests: Tests
    names: tuple[str, ...]
    units: Floats  # of the inputs: the scenario's own values, or 1, (k,)
    lower: Floats  # bounds in these units, (k,)
    upper: Floats
    kept: Bools  # measurements that count, (m,)
    on_progress: OnProgress
    prior: Prior

    @property
    def sides(self) -> Floats:
        """0 for measured values, +1 or -1 for outcomes; of those that count."""
        return np.array([m.side for m in self.tests.measurements])[self.kept]

    @property
    def usable(self) -> int:
        """Number of the measurements that count; without uncertainties, of measured values only."""
        return len(self.sides) if self.tests.weighted else int((self.sides == 0).sum())

    @property
    def needed(self) -> int:
        """Number of measurements that a fit needs; without uncertainties, one more for their scatter."""
        count = len(self.names)
        return max(count - len(self.prior.where), 1) if self.tests.weighted else count + 1

    def deviations(self, x: Floats) -> Floats:
        """Return the model's deviations from the measurements that count, divided by uncertainties or values."""
        scales = [m.uncertainty or m.value for m in self.tests.measurements]
        values = np.array([m.value for m in self.tests.measurements])
        self.on_progress(len(values), None)
        return ((self.predicted(x) - values) / scales)[self.kept]

    def predicted(self, x: Floats) -> Floats:
        """Return the model's values of the m measurements; inputs are in their units, (k,) or, test by test, (k, n)."""
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
    """Return ballistic limits, m/s, clipped to the range of the search.

    The usual scan is enough for unusual armours too: a fit meets these only far from its end, or has no end.
    """
    section = variants.scenario.ballistic_limit
    ends = section.velocity_min_m_s, section.velocity_max_m_s
    return ballistic_limits(variants, tolerance=LIMIT_TOLERANCE_M_S, points=SCAN_POINTS).clip(*ends)


def _residual_velocities(variants: Variants) -> Floats:
    """Return residual velocities, m/s; of a stopped test, the impact velocity less the ballistic limit."""
    answers = QuantityValues(variants)
    residual = answers.impacts.V.copy()
    stopped = np.flatnonzero(~answers.perforated)
    if len(stopped):
        residual[stopped] = np.minimum(variants.velocities[stopped] - _limits(variants.at(stopped)), residual[stopped])
    return residual


# The model's values of variants, by measured quantity.
MODELS: dict[str, Callable[[Variants], Floats]] = {
    LIMIT: _limits,
    RESIDUAL: _residual_velocities,
    MASS: lambda variants: QuantityValues(variants).residual_masses,
}


class Point(NamedTuple):
    """Inputs and scatter of the greatest likelihood, at least with some inputs held."""

    x: Floats  # in their units, (k,)
    scatter: float  # 1 if uncertainties are given
    loss: float  # -2 times the logarithm of likelihood and prior, up to a constant independent of the inputs


@dataclass(frozen=True)
class Precision:
    """How precisely tests determine inputs."""

    covariance: Floats  # of the inputs in their units, (k, k)
    spread: float  # the scatter, without the bias that fitted inputs give it
    degrees_of_freedom: float
    chi_squared: float  # sum of the squared deviations of the measured values
    p_value: float | None
    widened_by: float  # factor of the intervals
    threshold: float  # of -2 times the logarithm of a likelihood ratio, for the intervals


@dataclass(frozen=True)
class InputFit(Precision):
    """A fit of inputs to tests.

    ``rows`` and ``residuals`` are those of the least-squares problem whose first step is Newton's from the fit, with
    the q scores of the prior below the m measurements.
    """

    likelihood: Likelihood
    best: Point
    rows: Floats  # (m + q, k)
    residuals: Floats  # (m + q,)
    prior_shares: tuple[float | None, ...]  # of the precisions of the inputs, (k,)
    aicc: float | None
    starts: int
    starts_agreeing: int


def fit_inputs(likelihood: Likelihood) -> InputFit:
    """Fit inputs to tests, from several starts; see `armour.statistics.calibration.calibrate`."""
    tests, needed, count = likelihood.tests, likelihood.needed, likelihood.usable
    if count < needed:
        kinds = "measurements or outcomes" if tests.weighted else "measurements, as their uncertainties are not given,"
        message = f"must have at least {needed} {kinds} for {len(likelihood.names)} coefficients, found {count}"
        raise mistake(tests.file, "", message)
    of_law = likelihood.lower < 0.0
    # Coefficients of a law start at 0, and once elsewhere.
    starts = [np.where(of_law, 0.0, start) for start in (1.0, 0.5, 2.0)]
    starts += [np.where(of_law, 0.3, 1.0)] if of_law.any() else []
    ends = [search(likelihood, start) for start in starts]
    best = min(ends, key=lambda end: end.loss)
    sides, z = likelihood.sides, likelihood.deviations(best.x) / best.scatter
    weights, rows = rows_at(likelihood, best.x, best.scatter)
    residuals = np.where(sides == 0, z, -sides * hazard(sides * z) / np.maximum(weights, 1e-150))
    rows = np.vstack([rows, likelihood.prior.rows(best.x)])
    residuals = np.append(residuals, likelihood.prior.scores(best.x))
    if tests.weighted:
        precision = _by_uncertainties(rows, residuals, sides)
    else:
        precision = _by_scatter(rows, weights, z, sides, best.scatter)
    return InputFit(
        **vars(precision),
        likelihood=likelihood,
        best=best,
        rows=rows,
        residuals=residuals,
        prior_shares=_prior_shares(likelihood.prior, best, precision),
        aicc=None if len(likelihood.prior.where) else _aicc(likelihood, best),
        starts=len(ends),
        starts_agreeing=sum(np.allclose(end.x, best.x, rtol=CLOSE, atol=CLOSE) for end in ends),
    )


def likelihood_of(tests: Tests, inputs: Sequence[str], on_progress: OnProgress, *, prior: bool = False) -> Likelihood:
    """Return the likelihood of inputs that can be fitted to tests, with or without their prior."""
    check_fittable(tests.file, tests.scenario, tests.groups, inputs)
    first = tests.groups[0].scenario
    of_law = np.array([_is_of_law(name) for name in inputs])
    units = units_of(first, inputs)
    lower = np.where(of_law, -MAX_COEFFICIENT, MIN_RATIO)
    upper = np.where(of_law, MAX_COEFFICIENT, MAX_VALUE_RATIO)
    kept = np.ones(len(tests.measurements), dtype=bool)
    distributions = prior_of(first, inputs, units) if prior else NO_PRIOR
    return Likelihood(tests, tuple(inputs), units, lower, upper, kept, on_progress, distributions)


def units_of(scenario: Scenario, inputs: Sequence[str]) -> Floats:
    """Return the units of inputs: the scenario's values, or 1 for coefficients of a law of the flow stress, (k,)."""
    values = scenario.inputs()
    return np.array([1.0 if _is_of_law(name) else values[name] for name in inputs])


def _is_of_law(name: str) -> bool:
    return name.partition(".")[2] in FLOW_STRESS_LAW


def search(
    likelihood: Likelihood,
    start: Floats,
    held: int | None = None,
    scatter: float | None = None,
    tolerance: float = FIT_TOLERANCE,
) -> Point:
    """Return the most likely inputs by a search from a starting point; one of them, and the scatter, may be held."""
    free = np.flatnonzero(np.arange(len(start)) != held)
    sides, prior, x = likelihood.sides, likelihood.prior, start.copy()
    # Without outcomes and prior the scatter has no effect on the most likely inputs.
    scatter_matters = bool(sides.any() or len(prior.where))

    def with_free(inputs: Floats | tuple[float, ...]) -> Floats:
        point = x.copy()
        point[free] = inputs
        return point

    @cache
    def deviations_at(inputs: tuple[float, ...]) -> Floats:
        return likelihood.deviations(with_free(inputs))

    def move(scatter: float) -> Floats:
        """Move to the most likely inputs given the scatter, and return their deviations."""

        def losses(inputs: Floats) -> Floats:
            z = deviations_at(tuple(inputs.tolist())) / scatter
            return np.concatenate([_losses(z, sides), prior.scores(with_free(inputs))])

        def slopes(inputs: Floats) -> Floats:
            return approx_fprime(inputs, losses, DIFFERENCE)

        if len(free):
            bounds = likelihood.lower[free], likelihood.upper[free]
            ftol = max(tolerance, 1e-8)
            x[free] = least_squares(losses, x[free], jac=slopes, bounds=bounds, ftol=ftol, xtol=tolerance).x
        return deviations_at(tuple(x[free].tolist()))

    def loss(deviations: Floats, scatter: float) -> float:
        by_tests = float((_losses(deviations / scatter, sides) ** 2).sum() + 2.0 * (sides == 0).sum() * log(scatter))
        return by_tests + float((prior.scores(x) ** 2).sum())

    def profile(log_scatter: float) -> float:
        return loss(move(exp(log_scatter)), exp(log_scatter))

    if scatter_matters and not likelihood.tests.weighted and scatter is None:
        ends = log(SCATTER_BOUNDS[0]), log(SCATTER_BOUNDS[1])
        scatter = exp(minimize_scalar(profile, bounds=ends, options={"xatol": 1e-3}).x)
    deviations = move(scatter if scatter and scatter_matters else 1.0)
    if scatter is None:
        scatter = 1.0 if likelihood.tests.weighted else float(np.clip(np.sqrt(np.mean(deviations**2)), *SCATTER_BOUNDS))
    return Point(x, scatter, loss(deviations, scatter))


def _losses(z: Floats, sides: Floats) -> Floats:
    """Return signed roots of -2 times the logarithms of likelihoods, given deviations in standard deviations."""
    return np.where(sides == 0, z, np.sqrt(-2.0 * log_ndtr(sides * z)))


# Probability below the upper end of an interval, and the threshold of a likelihood ratio where scatters are known.
UPPER = 0.5 * (1.0 + CONFIDENCE)
NORMAL_THRESHOLD = float(ndtri(UPPER)) ** 2


def _by_uncertainties(rows: Floats, residuals: Floats, sides: Floats) -> Precision:
    """Return the precision by the given uncertainties, widened if the deviations are larger than these explain."""
    count, exact, z, scores = rows.shape[1], sides == 0, residuals[: len(sides)], residuals[len(sides) :]
    covariance, leverages = _inverted(rows, count)
    # The part of the inputs that outcomes determine takes no degree of freedom from measured values and prior.
    freedom = float(exact.sum() + len(scores) - count + leverages[: len(z)][~exact].sum())
    freedom = round(freedom, 9) + 0.0  # outcomes alone leave none, but for rounding
    chi_squared = float((z[exact] ** 2).sum()) + float((scores**2).sum())
    p_value = float(chdtrc(freedom, chi_squared)) if freedom > 0.5 else None
    widened_by, threshold = 1.0, NORMAL_THRESHOLD
    # A wider interval does not repair a prior that the tests contradict.
    if p_value is not None and p_value < MIN_P_VALUE and not len(scores):
        widened_by = sqrt(chi_squared / freedom)
        threshold = (widened_by * float(stdtrit(freedom, UPPER))) ** 2
    return Precision(covariance * widened_by**2, 1.0, freedom, chi_squared, p_value, widened_by, threshold)


def _by_scatter(rows: Floats, weights: Floats, z: Floats, sides: Floats, scatter: float) -> Precision:
    """Return the precision by the scatter, which is estimated too.

    Without outcomes and prior the intervals are exact for a linear model.  With outcomes the scatter has as many
    degrees of freedom as measured values would give that determine it as well.
    """
    count, measured, exact = rows.shape[1], len(z), sides == 0
    # The estimates depend on the scatter through the outcomes and the prior.
    columns = np.zeros((len(rows) + 1, count + 1))
    columns[:-1, :count] = rows
    columns[:measured, count] = np.where(exact, 0.0, -weights * z)
    columns[-1, count] = sqrt(2.0 * exact.sum())
    _, leverages = _inverted(columns, count)
    information = np.where(exact, 2.0, z**2 * hazard(sides * z) * hazard(-sides * z))  # on the scatter's logarithm
    number = 0.5 * float(information.sum())  # of measured values that would determine it as well
    # The part that the prior determines takes no degree of freedom from the tests and adds no error to the scatter.
    by_tests = count - float(leverages[measured:].sum())
    freedom = number - by_tests
    columns[:measured] *= sqrt(freedom / number)
    columns[-1] *= sqrt(freedom / number)
    exact_threshold = number * float(np.log1p(stdtrit(freedom, UPPER) ** 2 / freedom))
    return Precision(
        covariance=_inverted(columns, count)[0],
        spread=scatter * sqrt(number / freedom),
        degrees_of_freedom=freedom,
        chi_squared=float((z[exact] ** 2).sum()) * scatter**2,
        p_value=None,
        widened_by=1.0,
        threshold=NORMAL_THRESHOLD + by_tests / count * (exact_threshold - NORMAL_THRESHOLD),
    )


def _inverted(rows: Floats, count: int) -> tuple[Floats, Floats]:
    """Return the covariance of the first unknowns of a least-squares problem, and the leverages of the rows on them."""
    inverse = np.linalg.pinv(rows, rcond=1e-6)[:count]
    return inverse @ inverse.T, (rows[:, :count] * inverse.T).sum(axis=1)


def _prior_shares(prior: Prior, best: Point, precision: Precision) -> tuple[float | None, ...]:
    """Return the shares of the prior in the precisions of the inputs, (k,)."""
    shares: list[float | None] = [None] * len(best.x)
    for i, deviation in zip(prior.where, prior.deviations(best.x), strict=True):
        shares[i] = min(float(precision.covariance[i, i]) / (precision.widened_by * deviation) ** 2, 1.0)
    return tuple(shares)


def rows_at(likelihood: Likelihood, x: Floats, scatter: float) -> tuple[Floats, Floats]:
    """Return the weights of the measurements that count, (m,), and their rows of the information at x, (m, k).

    Their information about the inputs, in units of these, is the transpose of the rows times the rows.
    """
    sides = likelihood.sides
    jacobian = approx_fprime(x, likelihood.deviations, DIFFERENCE).reshape(len(sides), len(x)) / scatter
    toward = sides * likelihood.deviations(x) / scatter
    slopes = hazard(toward)
    weights = np.sqrt(np.where(sides == 0, 1.0, slopes * (slopes + toward)))
    return weights, weights[:, None] * jacobian


def hazard(z: Floats) -> Floats:
    """Return the density of the normal distribution divided by the distribution function."""
    return np.exp(-0.5 * z * z - log_ndtr(z)) / sqrt(2.0 * pi)


def _aicc(likelihood: Likelihood, best: Point) -> float | None:
    """Return Akaike's information criterion, corrected for the number of measurements; None for too few."""
    unknowns = len(best.x) + (not likelihood.tests.weighted)
    freedom = len(likelihood.sides) - unknowns - 1
    if freedom < 1:
        return None
    scales = [m.uncertainty or m.value for m in likelihood.tests.measurements if m.side == 0]
    constants = sum(log(2.0 * pi * scale**2) for scale in scales)
    return best.loss + constants + 2.0 * unknowns + 2.0 * unknowns * (unknowns + 1.0) / freedom


def intervals(fit: InputFit) -> tuple[Coefficient, ...]:
    """Return the coefficients with their profile-likelihood intervals, or why the tests do not identify them."""
    return tuple(_coefficient(fit, index) for index in range(len(fit.likelihood.names)))


def _coefficient(fit: InputFit, index: int) -> Coefficient:
    likelihood, name = fit.likelihood, fit.likelihood.names[index]
    unit, error = float(likelihood.units[index]), sqrt(max(float(fit.covariance[index, index]), 0.0))
    bounds = float(likelihood.lower[index]), float(likelihood.upper[index])
    (low, flat_below), (high, flat_above) = (_end(fit, index, bound, error) for bound in bounds)
    ends = (None if low is None else low * unit, None if high is None else high * unit)
    if ends == (None, None):
        return Coefficient(name, None, None, "the tests bound it neither above nor below")
    if flat_below or flat_above:
        bound = bounds[0 if flat_below else 1] * unit
        return Coefficient(name, None, ends, f"the fit is as good at {bound:.3g}, the end of the range searched")
    estimate, share = float(fit.best.x[index]) * unit, fit.prior_shares[index]
    return Coefficient(name, estimate, ends, standard_error=error * unit, prior_share=share)


def _end(fit: InputFit, index: int, bound: float, error: float) -> tuple[float | None, bool]:
    """Return the end of an interval towards a bound, and whether the likelihood is as great there as at the estimate.

    The end is None if the likelihood does not fall enough up to the bound.
    """
    likelihood, best = fit.likelihood, fit.best
    # Most likely changes of the other inputs per change of this one.
    other_inputs = np.arange(len(best.x)) != index
    slopes = np.linalg.lstsq(fit.rows[:, other_inputs], -fit.rows[:, index], rcond=1e-6)[0]

    def deviance(value: float) -> float:
        start = best.x.copy()
        start[index] = value
        start[other_inputs] += slopes * (value - best.x[index])
        start = np.clip(start, likelihood.lower, likelihood.upper)
        return search(likelihood, start, held=index, tolerance=COMPARED_TOLERANCE).loss - best.loss

    step = min(max(1.8 * error, DIFFERENCE), 1.0)
    end = profile_end(deviance, float(best.x[index]), bound, sqrt(fit.threshold), step, 1e-3 * step)
    return end, end is None and deviance(bound) < CLOSE


def without(fit: InputFit, kept: Bools) -> Floats:
    """Return the inputs fitted to some of the measurements, in their units, (k,), with the scatter of the fit to all.

    A small change is Newton's step from the fit to all, with an error of second order; otherwise the search is
    repeated.
    """
    likelihood = fit.likelihood._replace(kept=kept)
    kept_rows = np.append(kept, np.ones(len(fit.residuals) - len(kept), dtype=bool))
    change = np.linalg.lstsq(fit.rows[kept_rows], -fit.residuals[kept_rows], rcond=1e-6)[0]
    x: Floats = np.clip(fit.best.x + change, likelihood.lower, likelihood.upper)
    if (np.abs(x - fit.best.x) <= SMALL_CHANGE).all():
        return x
    return search(likelihood, x, scatter=fit.best.scatter, tolerance=COMPARED_TOLERANCE).x


def check_fittable(
    file: str, scenario: Scenario, groups: Sequence[MaterialGroup], inputs: Sequence[str], function: str = "calibrate"
) -> None:
    """Check that the inputs of a function can be fitted to the tests of a scenario in a file."""
    scenario.check_names(inputs, function, "fit")
    problems = []
    for name in inputs:
        if any(name in group.columns for group in groups):
            problems.append(Problem(file, name, "must not be a column if it is fitted"))
        if INPUTS[name].kind is None:
            problems.append(Problem(function, "fit", f'must be a property of a material or projectile, found "{name}"'))
    for role, key in NAMES.items():
        names = {group.scenario.name_of(role) for group in groups}
        if len(names) > 1 and any(name.startswith(role + ".") for name in inputs):
            message = (
                f"must be the same in all tests if the {role} is fitted, found {', '.join(sorted(map(str, names)))}"
            )
            problems.append(Problem(file, key, message))
    refuse(problems)
