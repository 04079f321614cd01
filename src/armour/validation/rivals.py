"""Compare the errors of the model, of rival predictions and of simpler formulas on the same tests.

The rivals of a table of a suite are predictions by other methods, each in a column of the table.  Errors of fits are
given in sample and leave-one-out.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from armour.analysis.variants import Floats
from armour.scenario.inputs import FLOW_STRESS
from armour.scenario.sections import TINY
from armour.statistics.measured import LIMIT, read_tests
from armour.validation import formulas
from armour.validation.comparison import Error
from armour.validation.suite import Case

# Least number of tests for a fit, and of different areal densities to fit the exponent too.
MIN_FITTED = 3


def errors_of(computed: Iterable[tuple[Case, float | str | None]]) -> tuple[Error, ...]:
    """Return the errors of the predictions of a table's cases: by its rivals, this model and simpler formulas.

    `computed` has the cases, each with its value by this model.  The result is empty if the table has no rivals.
    """
    rows = [(case, value) for case, value in computed if case.rivals and abs(float(case.expected or 0.0)) >= TINY]
    cases = [case for case, _ in rows]
    magnitudes_by_name: dict[str, list[float]] = {}
    for case, value in rows:
        by_model = {"this model": value} if isinstance(value, float) else {}
        for name, predicted in {**case.rivals, **by_model, **_florence_limits(case)}.items():
            magnitudes_by_name.setdefault(name, []).append(100.0 * abs(predicted / float(case.expected or 0.0) - 1.0))
    errors = [
        _error(cases[0].group, name, magnitudes, _fitted_before(cases[0]) if name == "this model" else "")
        for name, magnitudes in magnitudes_by_name.items()
    ]
    if len(cases) >= MIN_FITTED and cases[0].quantity == LIMIT:
        errors += [*_refitted_errors(cases), *_rule_errors(cases)]
    return tuple(errors)


def _florence_limits(case: Case) -> Mapping[str, float]:
    """Return Florence's ballistic limits of a case, m/s, by name: for the penetrator and for the whole projectile.

    There are none if the case lacks values that the formula needs, or is not about a ballistic limit.
    """
    scenario = case.scenario
    if case.quantity != LIMIT or formulas.missing_for_florence(scenario):
        return {}
    return {formulas.florence_name(each): each.ballistic_limit_m_s for each in formulas.florence_results(scenario)}


def _fitted_before(case: Case) -> str:
    """Return the source of the flow stress of a case's ceramic if it was fitted to tests; else ""."""
    name = case.scenario.name_of("ceramic")
    value = case.scenario.entry("ceramic", name).values["flow_stress_GPa"] if name else None
    return f"flow stress of {name}: {value.source}" if value is not None and value.status == "fitted" else ""


def _refitted_errors(cases: Sequence[Case]) -> Iterator[Error]:
    """Yield the errors of this model with the ceramic's flow stress fitted to the measured limits.

    Nothing is fitted if cases differ in the settings of the solver or of the search for the limit.
    """
    # Imported here for scipy, which a suite without rivals does not need.
    from armour.statistics import calibration, likelihood

    name, scenario = cases[0].scenario.name_of("ceramic"), cases[0].scenario
    settings = {(case.scenario.solver, case.scenario.ballistic_limit) for case in cases}
    if name is None or len(settings) > 1:
        return
    rows = [
        {**case.scenario.inputs(), "test": place, LIMIT: limit}
        for place, (case, limit) in enumerate(zip(cases, measured_limits(cases).tolist(), strict=True))
    ]
    for row in rows:
        del row[FLOW_STRESS]
    fit, result = calibration.fit_by_law(read_tests(rows, scenario), [FLOW_STRESS], None)
    [stress] = likelihood.intervals(fit)
    if stress.estimate is None:
        return
    computed = np.array([[residual.computed, residual.left_out] for residual in result.residuals], dtype=np.float64).T
    fitted = f"flow stress of {name} to these tests: {stress.estimate:.2f} GPa"
    yield _fitted_error(cases, "this model, flow stress refitted", fitted, *computed)


def _rule_errors(cases: Sequence[Case]) -> Iterator[Error]:
    """Yield the errors of the areal density rule, limit = k A^p, fitted to the measured limits.

    First p is 1; then, if there are enough areal densities, p is fitted too.
    """
    densities, limits = areal_densities(cases), measured_limits(cases)
    for p in (1.0, None):
        if p is None and len(np.unique(densities.round(6))) < MIN_FITTED:
            continue
        rule = formulas.fit_areal_density_rule(densities, limits, p)
        left_out = [
            formulas.fit_areal_density_rule(np.delete(densities, place), np.delete(limits, place), p).limit(density)
            for place, density in enumerate(densities)
        ]
        name = "p = 1" if p else "p fitted"
        fitted = f"k = {rule.k:.2f} to these tests" if p else f"k = {rule.k:.2f} and p = {rule.p:.3f} to these tests"
        predicted = np.array([rule.limit(density) for density in densities])
        yield _fitted_error(cases, f"areal density rule, {name}", fitted, predicted, np.array(left_out))


def areal_densities(cases: Sequence[Case]) -> Floats:
    """Return the areal densities of cases along the line of fire, kg/m²."""
    return np.array([formulas.along_fire_kg_m2(case.scenario) for case in cases])


def measured_limits(cases: Sequence[Case]) -> Floats:
    """Return the measured ballistic limits of cases, m/s."""
    return np.array([float(case.expected or 0.0) for case in cases])


def _fitted_error(cases: Sequence[Case], predictor: str, fitted: str, predicted: Floats, left_out: Floats) -> Error:
    """Return the errors of a method fitted to the measured limits.

    `predicted` and `left_out`, (cases,), are its limits, m/s, with all tests in the fit and with the test left out.
    """
    in_sample, out_of_sample = (
        100.0 * np.abs(values / measured_limits(cases) - 1.0) for values in (predicted, left_out)
    )
    return _error(cases[0].group, predictor, in_sample.tolist(), fitted, float(out_of_sample.mean()))


def _error(table: str, predictor: str, percents: Sequence[float], fitted: str, left_out: float | None = None) -> Error:
    """Return the error of a method, given the magnitudes of its relative errors, %."""
    mean = sum(percents) / len(percents)
    return Error(table, predictor, len(percents), mean, max(percents), left_out, fitted)
