"""Calibration: inputs of a scenario fitted to tests, with intervals and leave-one-out errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armour.analysis.estimates import CONFIDENCE
from armour.analysis.results import Result
from armour.analysis.variants import Floats, OnProgress, ignore_progress
from armour.errors import InputError, Problem, choices
from armour.scenario.loading import Scenario
from armour.statistics.flow_stress_laws import FLOW_STRESS, LAWS, Law
from armour.statistics.least_squares_fit import Coefficient, LeastSquaresFit, fit_inputs, predicted, without
from armour.statistics.test_data import Tests

# Greatest number of folds of the leave-one-out error.
MAX_FOLDS = 100


@dataclass(frozen=True)
class Residual:
    """A measurement and the value of the calibrated model, in the unit of the quantity's name."""

    test: str
    quantity: str
    measured: float
    computed: float
    left_out: float | None  # computed with coefficients fitted to the other tests; None where these are too few
    bound: str  # "at least" or "at most": bound on the ballistic limit that the outcome of a test gives

    @property
    def met(self) -> bool:
        """Whether the computed value meets the bound."""
        return self.computed >= self.measured if self.bound == "at least" else self.computed <= self.measured


@dataclass(frozen=True)
class CalibrationResult(Result):
    """Inputs fitted to tests.

    Attributes
    ----------
    tests : str
        File of the tests.
    law : str
        Law of the ceramic's flow stress; empty where it is not fitted.
    weights : {"uncertainties", "relative"}
    coefficients : tuple of Coefficient
    correlation : tuple of tuple of float
        Correlation matrix of the coefficients.
    residuals : tuple of Residual
    mean_error_percent, left_out_error_percent : float or None
        Mean absolute deviations, in sample and leave-one-out, bounds excluded, %; None where there are none.
    degrees_of_freedom : int
    chi_squared : float
        Sum of the squared deviations, divided by their uncertainties or by the measured values.
    starts, starts_agreeing : int
        Number of starting points of the fit, and of those that led to the same end.
    confidence : float
        Confidence level of the intervals.
    """

    tests: str
    law: str
    weights: str
    coefficients: tuple[Coefficient, ...]
    correlation: tuple[tuple[float, ...], ...]
    residuals: tuple[Residual, ...]
    mean_error_percent: float | None
    left_out_error_percent: float | None
    degrees_of_freedom: int
    chi_squared: float
    starts: int
    starts_agreeing: int
    confidence: float


def calibrate(
    tests: Tests,
    scenario: Scenario,
    fit: Sequence[str] = (FLOW_STRESS,),
    law: Law = "constant",
    *,
    on_progress: OnProgress = ignore_progress,
) -> CalibrationResult:
    """Fit inputs of a scenario to tests.

    Deviations are divided by their uncertainties or, where none are given, by the measured values.  The residual
    velocity of a test that the model defeats is negative: the impact velocity less the ballistic limit.  A test with an
    outcome alone is a bound on the ballistic limit; its deviation counts where the bound is not met.

    Parameters
    ----------
    tests : Tests
        See `armour.statistics.test_data.read_tests`.
    scenario : Scenario
        Inputs that the tests have in common.
    fit : sequence of str
        Names of the inputs to fit.
    law : {"constant", "linear", "proportional", "thicknesses"}
        Law of the ceramic's flow stress, where it is fitted.
    on_progress : callable, optional
        Called with the number of tests computed since the last call, and None, as their total is not known.

    Returns
    -------
    CalibrationResult

    Raises
    ------
    InputError
        If a name is not an input, the tests differ in the material that is fitted, there are too few of them, or a run
        does not end.
    """
    if law not in LAWS:
        raise InputError([Problem("calibrate", "law", f'must be a law, found "{law}"{choices(str(law), list(LAWS))}')])
    if not fit:
        raise InputError([Problem("calibrate", "fit", "must name at least one input")])
    done = fit_inputs(tests, scenario, fit, law, on_progress)
    computed, left_out = predicted(tests, done.fitted, done.x), _left_out(tests, done, on_progress)
    residuals = tuple(
        Residual(
            test=tests.names[m.test],
            quantity=m.quantity,
            measured=m.value,
            computed=float(computed[i]),
            left_out=None if np.isnan(left_out[i]) else float(left_out[i]),
            bound=("", "at least", "at most")[m.side],
        )
        for i, m in enumerate(tests.measurements)
    )
    return CalibrationResult(
        tests=tests.file,
        law=law if FLOW_STRESS in fit else "",
        weights="uncertainties" if tests.weighted else "relative",
        coefficients=done.coefficients,
        correlation=tuple(map(tuple, done.correlation.tolist())),
        residuals=residuals,
        mean_error_percent=_mean_percent([(r.computed, r.measured) for r in residuals if not r.bound]),
        left_out_error_percent=_mean_percent([(r.left_out, r.measured) for r in residuals if not r.bound]),
        degrees_of_freedom=done.degrees_of_freedom,
        chi_squared=done.chi_squared,
        starts=done.starts,
        starts_agreeing=done.starts_agreeing,
        confidence=CONFIDENCE,
    )


def _left_out(tests: Tests, done: LeastSquaresFit, on_progress: OnProgress) -> Floats:
    """Return each measurement's value with coefficients fitted to the other tests; NaN where these are too few."""
    exact = np.array([m.side == 0 for m in tests.measurements])
    of_test = np.array([m.test for m in tests.measurements])
    folds = min(len(tests.names), MAX_FOLDS)
    coefficients = np.full((len(done.x), len(tests.names)), np.nan)
    for fold in range(folds):
        kept = of_test % folds != fold
        if (exact & kept).sum() >= len(done.x):
            coefficients[:, fold::folds] = without(tests, done, kept, on_progress)[:, None]
    fitted = ~np.isnan(coefficients[0])
    found = predicted(tests, done.fitted, np.where(fitted, coefficients, done.x[:, None]))
    found[~fitted[of_test]] = np.nan
    return found


def _mean_percent(pairs: Sequence[tuple[float | None, float]]) -> float | None:
    errors = [abs(computed / measured - 1.0) for computed, measured in pairs if computed is not None]
    return 100.0 * sum(errors) / len(errors) if errors else None
