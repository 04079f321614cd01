"""Calibration: inputs of a scenario fitted to tests, with intervals and leave-one-out errors."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from typing import Any, Literal

import numpy as np
from scipy.special import ndtri, stdtrit

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.results import OnProgress, TableResult, by_column, ignore_progress
from armour.analysis.variants import Bools, Floats
from armour.errors import Note, joined, listed, mistake
from armour.evidence.core_digest import changed_equations
from armour.evidence.fit import LEAST_REST
from armour.evidence.tests import FALSE_ALARMS, own_evidence
from armour.scenario.checked import Names, checked
from armour.scenario.inputs import FLOW_STRESS, ROLES
from armour.scenario.keys import key_name
from armour.scenario.library import FLOW_STRESS_LAW, MOST_TESTS
from armour.scenario.scenario import Scenario
from armour.statistics.likelihood import Coefficient, InputFit, Likelihood, fit_inputs, likelihood_of, refitted_inputs
from armour.statistics.measured import LIMIT, ORIGINS, SERIES_COLUMNS, Tests, common_of, subject_of, with_scatter
from armour.statistics.own_tests import nothing_of_error, own_tests, repeated, role_of, unused

Law = Literal["constant", "ceramic", "backing", "product", "linear"]
# Keys of the ceramic that each law fits.
LAWS: dict[Law, tuple[str, ...]] = {
    "constant": (),
    "ceramic": ("flow_stress_ceramic_slope",),
    "backing": ("flow_stress_backing_exponent",),
    "product": ("flow_stress_product_exponent",),
    "linear": ("flow_stress_ceramic_slope", "flow_stress_backing_slope"),
}


def law_of(scenario: Scenario) -> str:
    """Return the name of the law of the flow stress of the scenario's ceramic; "combined" if several laws are in it."""
    values = scenario.inputs()
    nonzero = {key for key in FLOW_STRESS_LAW if values.get(f"ceramic.{key}")}
    return next((law for law, keys in LAWS.items() if nonzero == set(keys)), "combined")


def with_law(scenario: Scenario, law: Law | None) -> Scenario:
    """Return the scenario with a ceramic whose flow stress has one law only; without a law, the scenario as it is.

    Coefficients of other laws become 0, and so do those of `law` that the ceramic lacks.
    """
    if law is None:
        return scenario
    values = scenario.inputs()
    changes = {key: 0.0 for key in FLOW_STRESS_LAW if (key in LAWS[law]) != bool(values.get(f"ceramic.{key}"))}
    return with_ceramic(scenario, changes) if changes else scenario


def with_ceramic(scenario: Scenario, values: dict[str, float]) -> Scenario:
    """Return the scenario with other values of its ceramic, by key of the library; its entry may lack these keys."""
    entry = scenario.entry_of("ceramic")
    assert entry is not None
    table: dict[str, Any] = dict(values)
    if entry.name not in scenario.library.ceramic:
        table["based_on"] = entry.name
    return scenario.replaced({key_name(["library", "ceramic", entry.name]): table})


ASSUMED = (
    f"the tests are too few to estimate their scatter: {100.0 * LEAST_REST:g} % of each measured value is assumed, and "
    "the intervals depend on it"
)
ONE_SIDED = "all shots have the same outcome: if shots with the other one were left out, the fitted limits are wrong"
# Formats of dates, of which a column has one: the day goes before the month where both are possible.
DATE_FORMATS = ("%Y-%m-%d", "%Y-%m-%d %H:%M:%S", "%d.%m.%Y", "%d.%m.%y", "%d/%m/%Y", "%m/%d/%Y", "%d/%m/%y", "%m/%d/%y")
# A computed value may miss a bound by this much, half of the last digit shown, and still meet it.
AT_BOUND = 0.005


@dataclass(frozen=True)
class Residual:
    """A measurement and the value of the calibrated model, in the unit of the quantity's name.

    Attributes
    ----------
    test, quantity : str
    measured, computed : float
    left_out : float or None
        Value computed with coefficients fitted to the other tests; None if these are too few.
    bound : {"", "at least", "at most"}
        Bound on the ballistic limit that the outcome of a test gives; empty for a measured value.
    uncertainty : float or None
        Standard deviation of the measured value, where it is given.
    """

    test: str
    quantity: str
    measured: float
    computed: float
    left_out: float | None
    bound: str
    uncertainty: float | None = None

    @property
    def missed_by(self) -> float:
        """Distance of the computed value beyond the bound; negative if it meets the bound, -inf without one."""
        sides = {"at least": 1.0, "at most": -1.0}
        return sides[self.bound] * (self.measured - self.computed) if self.bound else -np.inf

    @property
    def met(self) -> bool:
        """Whether the computed value meets the bound, within `AT_BOUND`; true without a bound."""
        return self.missed_by <= AT_BOUND


@dataclass(frozen=True, repr=False)
class CalibrationResult(TableResult):
    """Inputs fitted to tests.

    Attributes
    ----------
    tests : str
        File of the tests.
    law : str
        Law of the ceramic's flow stress, "combined" for several at once; empty if the flow stress is not fitted.
    weights : {"uncertainties", "relative"}
        Standard deviations of the measurements: those given, or one fraction of the measured values.
    coefficients : tuple of Coefficient
        The fitted inputs.  An end of an interval that the tests do not bound is None.
    correlation : tuple of tuple of float
        Correlation matrix of the coefficients, from the model linearised at the estimate.
    residuals : tuple of Residual
    mean_error_percent, left_out_error_percent : float or None
        Mean absolute deviations of the measured values, in sample and leave-one-out, %; None if there are none.
        Bounds are excluded.
    degrees_of_freedom : float
        Degrees of freedom of the scatter or, if uncertainties are given, of chi-squared.  With measured values alone,
        this is the number of values minus the number of coefficients.
    chi_squared : float
        Sum of the squared deviations of measured values, each divided by its uncertainty or, if none are given, by the
        value.
    starts, starts_agreeing : int
        Number of starting points of the fit, and of those that converged to the same solution.
    confidence : float
        Confidence level of the intervals.
    p_value : float or None
        Probability of a greater chi-squared if the model and the uncertainties given are right; None without
        uncertainties or without degrees of freedom.
    widened_by : float
        Factor by which the intervals are widened.  If the p value is less than 0.05, it is the Birge ratio, the square
        root of chi-squared over the degrees of freedom; otherwise 1.
    evidence : mapping or None
        Distribution of the ballistic limits of such armours given the tests: the key ``evidence`` of the fitted entry
        in a library file.  None if the tests do not determine it, for example if none measured or shot at a ballistic
        limit, if properties of two materials or of the projectile were fitted, or if one of several inputs is not
        identified.
    notes : tuple of Note
        A bad fit, tests out of line with the others, and ways in which tests are unlike those that the model was
        compared with before.
    reason : str
        Reason why there is no evidence; empty if there is.
    """

    tests: str
    law: str
    weights: str
    coefficients: tuple[Coefficient, ...]
    correlation: tuple[tuple[float, ...], ...]
    residuals: tuple[Residual, ...]
    mean_error_percent: float | None
    left_out_error_percent: float | None
    degrees_of_freedom: float
    chi_squared: float
    starts: int
    starts_agreeing: int
    confidence: float
    p_value: float | None = None
    widened_by: float = 1.0
    evidence: Mapping[str, Any] | None = None
    notes: tuple[Note, ...] = ()
    reason: str = ""

    def _columns(self) -> dict[str, Any]:
        """Return the columns of the table: the residuals."""
        return by_column(asdict(residual) for residual in self.residuals)


@checked
def calibrate(
    tests: Tests,
    scenario: Scenario,
    fit: Names = FLOW_STRESS,
    law: Law | None = None,
    *,
    on_progress: OnProgress = ignore_progress,
) -> CalibrationResult:
    """Fit inputs of a scenario to tests by maximum likelihood, with profile-likelihood intervals.

    A measured value is normally distributed about the model's value, with its uncertainty or, if none are given, with a
    standard deviation that is an unknown fraction, common to all, of the measured value.  If the model stops the
    projectile of a test, its residual velocity is negative: the impact velocity minus the ballistic limit.  The
    likelihood of an outcome alone is the probability that a ballistic limit with that distribution is above the impact
    velocity (stopped) or below it (perforated).

    Parameters
    ----------
    tests : Tests
        See `read_tests`.
    scenario : Scenario
        Inputs that the tests have in common: the scenario that the tests were read with.
    fit : str or sequence of str, default "ceramic.flow_stress_GPa"
        Input to fit, or several; by default the ceramic's flow stress.
    law : str, optional
        Law of the ceramic's flow stress, whose coefficients are fitted too: constant, ceramic (linear in its
        thickness), backing (a power of the back plate's thickness), product (a power of the product of both) or linear
        (in both).  By default the scenario's law.
    on_progress : callable, optional
        Called with the number of tests computed since the last call, and None, as their total is not known.

    Returns
    -------
    CalibrationResult

    Raises
    ------
    InputError
        If the tests were read with another scenario, a name is not an input, the tests differ in the material that is
        fitted, there are fewer of them than coefficients, there are more than 300 limits and outcomes, or a run does
        not end.
    """
    fit = tuple(fit)
    if common_of(scenario) != common_of(tests.scenario):
        message = "must be the one that the tests were read with; read_tests reads them with this one"
        raise mistake("calibrate", "scenario", message)
    for role in ROLES:
        entry = tests.groups[0].scenario.entry_of(role) if any(name.startswith(f"{role}.") for name in fit) else None
        if entry is not None and entry.evidence is not None:
            message = f"must not be of a material with own tests, found {entry.name}; give all tests of the lot at once"
            raise mistake(tests.file, "", message)
    if (count := sum(m.quantity == LIMIT for m in tests.measurements)) > MOST_TESTS:
        raise mistake(tests.file, "", f"must have at most {MOST_TESTS} limits and outcomes, found {count}")
    if not fit:
        raise mistake("calibrate", "fit", "must name at least one input")
    if law is not None and FLOW_STRESS not in fit:
        raise mistake("calibrate", "law", f'must not be given unless {FLOW_STRESS} is fitted, found "{law}"')
    groups = tuple(group._replace(scenario=with_law(group.scenario, law)) for group in tests.groups)
    tests_by_law = replace(tests, groups=groups, scenario=with_law(scenario, law))
    names = [*dict.fromkeys([*fit, *(f"ceramic.{key}" for key in (LAWS[law] if law else ()))])]
    result = _fitted(likelihood_of(tests_by_law, names, on_progress), law)
    question = {"scenario": scenario, "tests": tests, "changed": changed_equations()}
    return _with_evidence(result, tests_by_law, fit).of(subject_of(tests), **question)


def _with_evidence(result: CalibrationResult, tests: Tests, inputs: Sequence[str]) -> CalibrationResult:
    """Return the result of a calibration with its evidence, or with the reason why it has none, and with warnings.

    The evidence is the tests as a library entry stores them.  `tests` have the law of the result; `inputs` are the
    names of the fitted inputs.
    """
    scenario, notes = tests.groups[0].scenario, list[str]()
    values = {c.name: c.estimate for c in result.coefficients if c.estimate is not None}
    # A single value that the tests do not identify keeps its present value; the tests still inform about the limits.
    if not values and len(result.coefficients) == 1:
        values = {name: scenario.inputs()[name] for name in inputs}
        notes = [f"{name} stays at {value:g}: the tests do not identify it" for name, value in values.items()]
    role = role_of(tests, inputs) if len(values) == len(result.coefficients) else ""
    reasons = unused(tests, role) if role else []
    used = [place for place, reason in enumerate(reasons) if not reason]
    places = {reason: [i for i, other in enumerate(reasons) if other == reason] for reason in filter(None, reasons)}
    doubts = [
        f"not used for the probability of stopping: {listed([_line_of_test(tests, i) for i in where])}: {reason}"
        for reason, where in places.items()
    ]
    doubts += tests.read.warnings if tests.read else ()
    entry, doubtful = scenario.entry_of(role) if role else None, set[int]()
    stored = own_tests(tests, values, used) if entry else None
    if entry and stored:
        evidence = own_evidence(entry, stored)
        doubtful = {used[place] for place in evidence.doubtful}
        if not evidence.fits:
            doubts += [f"{_line_of_test(tests, place)}: {evidence.source}" for place in sorted(doubtful)]
            stored, doubtful = None, set()
    if stored is not None:
        notes += repeated(tests)
        result = replace(result, evidence=stored.model_dump(exclude_none=True, exclude_defaults=True))
    elif {name.partition(".")[0] for name in inputs} != {"projectile"}:
        result = replace(result, reason=nothing_of_error(scenario))
        notes = [f"no probability follows from the entry: {result.reason}"]
    doubts += (*_outlier_warnings(tests, result, doubtful), *_origin_warnings(tests, result.residuals))
    return replace(result, notes=(*map(Note, doubts), *result.notes, *map(Note, notes)))


def _fitted(likelihood: Likelihood, law: Law | None) -> CalibrationResult:
    """Fit the inputs of a likelihood, and return the result of the calibration, still without its evidence.

    A scatter is assumed if the tests are too few to estimate it.
    """
    tests = likelihood.tests
    too_few = not tests.weighted and likelihood.usable < likelihood.needed
    if too_few:
        tests = with_scatter(tests, LEAST_REST)
    fit = fit_inputs(likelihood._replace(tests=tests))
    computed, left_out = fit.likelihood.predicted(fit.best.x), _left_out_values(fit)
    residuals = tuple(
        Residual(
            test=tests.names[m.test],
            quantity=m.quantity,
            measured=m.value,
            computed=float(computed[i]),
            left_out=None if np.isnan(left_out[i]) else float(left_out[i]),
            bound=("", "at least", "at most")[m.side],
            uncertainty=m.uncertainty,
        )
        for i, m in enumerate(tests.measurements)
    )
    errors = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    correlation = fit.covariance / np.outer(errors, errors)
    np.fill_diagonal(correlation, 1.0)
    measured_values = [r for r in residuals if not r.bound]
    return CalibrationResult(
        tests=tests.file,
        law=(law or law_of(tests.groups[0].scenario)) if FLOW_STRESS in likelihood.names else "",
        weights="uncertainties" if tests.weighted else "relative",
        coefficients=fit.coefficients(),
        correlation=tuple(map(tuple, correlation.tolist())),
        residuals=residuals,
        mean_error_percent=_mean_percent([(r.computed, r.measured) for r in measured_values]),
        left_out_error_percent=_mean_percent([(r.left_out, r.measured) for r in measured_values]),
        degrees_of_freedom=fit.degrees_of_freedom,
        chi_squared=fit.chi_squared,
        starts=fit.starts,
        starts_agreeing=fit.starts_agreeing,
        confidence=CONFIDENCE,
        p_value=fit.p_value,
        widened_by=fit.widened_by,
        notes=(
            *map(Note, _fit_warnings(fit, assumed=too_few)),
            *(() if "impact.projectile" in tests.cells[0] else tests.scenario.unused_threats()),
        ),
    )


def out_of_line(deviations: Floats, left_out: Floats, coefficients: int) -> Bools:
    """Return whether each of n measurements is out of line with the others, (n,).

    `deviations`, (n,), are the relative deviations of the fit to all measurements; in `left_out`, (n,), each is that of
    a fit to the others.  `coefficients` is the number of fitted inputs.  A measurement is out of line if its
    studentised left-out deviation exceeds a quantile of Student's t, with Bonferroni's correction.  In a linear model,
    a measurement adds the product of its two deviations to the sum of squares.
    """
    freedom = len(deviations) - coefficients - 1
    if freedom < 1:
        return np.zeros(len(deviations), dtype=bool)
    added = deviations * left_out
    scatter = np.maximum(deviations @ deviations - added, 0.0) / freedom
    limit = stdtrit(freedom, 1.0 - 0.5 * FALSE_ALARMS / len(deviations))
    return added > limit**2 * scatter


def _outlier_warnings(tests: Tests, result: CalibrationResult, doubtful: Collection[int]) -> Iterator[str]:
    """Yield a warning for each measurement that is out of line with the others, with the line of its test in the file.

    These are the measurements at the indices `doubtful`, those that `out_of_line` finds, and outcomes whose bounds the
    fit misses by too much.
    """
    residuals, count = result.residuals, len(result.residuals)
    measured_places = np.array([place for place, r in enumerate(residuals) if not r.bound], dtype=np.int64)
    measured, computed, left_out, scales = (
        np.array([getattr(residuals[place], key) for place in measured_places], dtype=np.float64)
        for key in ("measured", "computed", "left_out", "uncertainty")
    )
    scales = np.where(np.isnan(scales), measured, scales)
    outliers = out_of_line((computed - measured) / scales, (left_out - measured) / scales, len(result.coefficients))
    farthest = ndtri(1.0 - FALSE_ALARMS / count)
    missed = {
        place
        for place, r in enumerate(residuals)
        if r.missed_by > farthest * max((r.uncertainty or 0.0) * result.widened_by, LEAST_REST * r.measured)
    }
    for place in sorted({*measured_places[outliers].tolist(), *doubtful, *missed}):
        r = residuals[place]
        expected = f"the fit gives {r.computed:.4g}"
        if r.left_out is not None:
            expected = f"a fit to the others gives {r.left_out:.4g}"
        yield (
            f"{_line_of_test(tests, place)}: {r.quantity} is out of line with the other tests: measured "
            f"{r.bound}{' ' * bool(r.bound)}{r.measured:g}, but {expected}; chance alone makes one such test in about "
            f"{100.0 * FALSE_ALARMS:g} % of tables"
        )


def _origin_warnings(tests: Tests, residuals: Sequence[Residual]) -> Iterator[str]:
    """Yield a warning for each column of origin, such as the laboratory, by which the deviations of limits differ.

    A drift over dates goes before a difference between them.
    """
    places = [i for i, m in enumerate(tests.measurements) if m.quantity == LIMIT and not m.side]
    deviations = np.array([np.log(residuals[i].measured / residuals[i].computed) for i in places])
    deviations = deviations - deviations.mean() if places else deviations
    for column in ORIGINS:
        names = np.array([str(tests.cells[tests.measurements[i].test].get(column, "")) for i in places])
        remedy = "find out what differed, and give it as a column of inputs"
        if column in SERIES_COLUMNS:
            remedy = "the probabilities allow for it, but the intervals of the fitted inputs do not"
        elif len(days := _day_numbers(names)) and np.ptp(days):
            since = days - days.mean()
            if (p_value := _permutation_p_value(deviations, since[None], np.ones(1))) < FALSE_ALARMS:
                drift = 100.0 * np.expm1(deviations @ since / (since @ since) * np.ptp(days))
                ends = f"from {names[days.argmin()]} to {names[days.argmax()]}"
                yield f"the deviations drift with the {column}: {drift:+.1f} % {ends}; {_by_chance(p_value)}; {remedy}"
                continue
        has_name = names == np.unique(names)[:, None]
        counts = has_name.sum(axis=1)
        if len(counts) > 1 and (p_value := _permutation_p_value(deviations, has_name, counts)) < FALSE_ALARMS:
            means = 100.0 * (np.exp(has_name @ deviations / counts) - 1.0)
            by_name = [f"{name or 'none'} {mean:+.1f} %" for name, mean in zip(np.unique(names), means, strict=True)]
            yield f"the deviations differ by {column}: {joined(by_name)}; {_by_chance(p_value)}; {remedy}"


def _permutation_p_value(deviations: Floats, contrasts: Any, counts: Any) -> float:
    """Return the p value of a permutation test: the share of random orders that differ as much by group or date.

    A difference is the sum of the squares of the `contrasts`, (k, n), of the deviations, (n,), each over its count,
    (k,).
    """
    shuffled = np.random.default_rng(1).permuted(np.tile(deviations, (4999, 1)), axis=1)
    squares = ((np.vstack([deviations, shuffled]) @ contrasts.T) ** 2 / counts).sum(axis=1)
    return float((squares > squares[0] * (1.0 - 1e-9)).mean())


def _by_chance(p_value: float) -> str:
    """Return a p value, 0 to 1, as part of a warning: "chance alone does this in 2 % of tables"."""
    return f"chance alone does this in {100.0 * p_value:.2g} % of tables"


def _day_numbers(cells: Iterable[str]) -> Floats:
    """Return dates as numbers of days, (n,), by the first format that fits all cells; (0,) if no format does."""
    for form in DATE_FORMATS:
        with suppress(ValueError):
            return np.array([datetime.strptime(cell, form).toordinal() for cell in cells], float)
    return np.empty(0)


def _line_of_test(tests: Tests, place: int) -> str:
    """Return where the measurement at an index is: the line of its test in the file, and the name of the test."""
    test = tests.measurements[place].test
    line, name = tests.places[test], tests.names[test]
    return line if name == line else f"{line} ({name})"


def _fit_warnings(fit: InputFit, *, assumed: bool) -> Iterator[str]:
    """Yield warnings of a bad fit, of outcomes on one side, and of tests unlike those that the model was compared with.

    If the scatter is `assumed`, a warning says so.
    """
    tests = fit.likelihood.tests
    if fit.p_value is not None and fit.widened_by != 1.0:
        yield (
            "the deviations are larger than the uncertainties given explain: chi-squared "
            f"{fit.chi_squared:.2f} on {fit.degrees_of_freedom:.3g} degrees of freedom, p = {fit.p_value:.2g}; "
            f"the intervals are widened by {fit.widened_by:.2f}, and the model or the uncertainties are wrong"
        )
    if assumed:
        yield ASSUMED
    if {m.side for m in tests.measurements} in ({1}, {-1}):
        yield ONE_SIDED
    counts: Counter[str] = Counter()
    for group in tests.groups:
        counts.update(dict(group.variants().caveats()))
    for limit, count in counts.items():
        yield f"{limit}; this concerns {count} of {len(tests.names)} tests"


def _left_out_values(fit: InputFit) -> Floats:
    """Return the model's value of each measurement by inputs fitted to the other tests, (m,); NaN if too few."""
    tests, needed = fit.likelihood.tests, len(fit.best.x)
    if not tests.weighted and any(m.side for m in tests.measurements):
        needed += 1
    test_indices = np.array([m.test for m in tests.measurements])
    # Of more than 100 tests, several are left out at a time.
    folds = min(len(tests.names), 100)
    inputs = np.full((len(fit.best.x), len(tests.names)), np.nan)
    for fold in range(folds):
        kept = test_indices % folds != fold
        if fit.likelihood._replace(kept=kept).usable >= needed:
            inputs[:, fold::folds] = refitted_inputs(fit, kept)[:, None]
    is_fitted = ~np.isnan(inputs[0])
    values = fit.likelihood.predicted(np.where(is_fitted, inputs, fit.best.x[:, None]))
    values[~is_fitted[test_indices]] = np.nan
    return values


def _mean_percent(pairs: Sequence[tuple[float | None, float]]) -> float | None:
    """Return the mean absolute deviation of computed from measured values, %; None if no value is computed."""
    errors = [abs(computed / measured - 1.0) for computed, measured in pairs if computed is not None]
    return 100.0 * sum(errors) / len(errors) if errors else None
