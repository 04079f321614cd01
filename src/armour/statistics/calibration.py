"""What the tests at hand say of parameters that were not measured: least squares on the compiled engine."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from armour.analysis.least_thickness import solver_options
from armour.core.equations import cross_section
from armour.core.state import Outcome
from armour.errors import InputError, NoAnswerError, Problem
from armour.scenario.library import library_toml
from armour.scenario.loading import Scenario
from armour.scenario.parameters import (
    BACKING,
    CERAMIC,
    INPUTS,
    NAMES,
    VELOCITY,
    check_names,
    check_ranges,
    entry_of,
    inputs_of,
    name_of,
    rows_of,
)
from armour.statistics.test_data import Row, read_rows
from armour.units import G

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FLOW_STRESS = "ceramic.flow_stress_GPa"
LIMIT, RESIDUAL, MASS, OUTCOME = "ballistic_limit_m_s", "residual_velocity_m_s", "residual_mass_g", "outcome"
# What a test can have measured, and the column of its uncertainty, one standard deviation.
MEASURED = {
    LIMIT: "ballistic_limit_uncertainty_m_s",
    RESIDUAL: "residual_velocity_uncertainty_m_s",
    MASS: "residual_mass_uncertainty_g",
}
# Of anything measured and of uncertainties, whatever the unit.
RANGE = 1e-3, 1e6

Law = Literal["constant", "linear", "proportional", "thicknesses"]
# What the ceramic's flow stress is made of: 1, its thickness and the backing's.
LAWS: dict[Law, tuple[bool, bool, bool]] = {
    "constant": (True, False, False),
    "linear": (True, True, False),
    "proportional": (False, True, False),
    "thicknesses": (True, True, True),
}
TERMS = ("", " per mm of ceramic", " per mm of backing")

CONFIDENCE = 0.95
# Bounds of a parameter, in units of the scenario's own value; a law's slopes may be negative.
LEAST, MOST = 0.1, 10.0
# What a law is cut off at, in the same units.
FLOOR = 0.05
# Where the fit starts from, in the same units.
STARTS = (1.0, 0.5, 2.0)
# Tolerance of ballistic limits, m/s, and relative change of parameters for the derivatives.
LIMIT_TOLERANCE_M_S = 1e-6
DIFFERENCE = 1e-4
# A sum of squares so close to the least, and parameters so close to each other, are the same.
SAME = 1e-3
# Folds of the leave-one-out error where there are more tests.
MAX_FOLDS = 100


class Measurement(NamedTuple):
    """What one test has measured of one quantity."""

    test: int
    quantity: str
    value: float  # the impact velocity where only the outcome is known
    width: float  # what the deviation is divided by
    side: int  # 0; +1 where the limit is at least the value, -1 where it is at most


class Group(NamedTuple):
    """Tests with the same materials."""

    scenario: Scenario
    where: "NDArray[np.int64]"
    columns: dict[str, "Floats"]


class Tests(NamedTuple):
    """A table of tests, ready for the engine."""

    file: str
    names: tuple[str, ...]
    groups: tuple[Group, ...]
    measurements: tuple[Measurement, ...]
    weighted: bool  # by uncertainties; else by the values measured
    cells: tuple[Mapping[str, float | str], ...]


@dataclass(frozen=True)
class Coefficient:
    """A parameter as the tests have it.

    Attributes
    ----------
    name : str
    estimate : float or None
        None where the tests do not identify it.
    interval : tuple of float or None
    reason : str
        Why it is not identified.
    """

    name: str
    estimate: float | None
    interval: tuple[float, float] | None
    reason: str = ""


@dataclass(frozen=True)
class Residual:
    """A measurement beside what the calibrated model says.

    Attributes
    ----------
    test, quantity : str
    measured, computed : float
    left_out : float or None
        Computed with parameters from the other tests; None where these are too few.
    bound : {"", "at least", "at most"}
        What a one-sided test says of the ballistic limit.
    """

    test: str
    quantity: str
    measured: float
    computed: float
    left_out: float | None
    bound: str

    @property
    def met(self) -> bool:
        """Whether a one-sided test is met."""
        return self.computed >= self.measured if self.bound == "at least" else self.computed <= self.measured


@dataclass(frozen=True)
class CalibrationResult:
    """Parameters from tests.

    Attributes
    ----------
    tests : str
        Their file.
    law : str
        Of the ceramic's flow stress.
    weights : {"uncertainties", "relative"}
    coefficients : tuple of Coefficient
    correlation : tuple of tuple of float
        Of the coefficients, in their order.
    residuals : tuple of Residual
    mean_error_percent, left_out_error_percent : float or None
        Mean magnitude of the deviations, one-sided tests aside; None where there is none.
    degrees_of_freedom : int
    chi_squared : float
        Sum of the squares of deviations over their uncertainties, or over the values measured.
    starts, starts_agreeing : int
        From how many starts the fit began, and how many came to the same end.
    confidence : float
        Of the intervals.
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

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


def read_tests(path: Path, scenario: Scenario) -> Tests:
    """Read a table of tests: inputs of the scenario that differ from test to test, and what was measured.

    Raises
    ------
    InputError
        With every mistake in it.
    """
    numbers = (*INPUTS, *MEASURED, *MEASURED.values())
    rows = read_rows(path, numbers=numbers, texts=("test", OUTCOME, *NAMES.values()), needed=())
    names = [str(row["test"] or row.place) for row in rows]
    problems = [problem for row in rows for problem in _wrong(row, names, str(path))]
    widths = {row[width] is None for row in rows for name, width in MEASURED.items() if row[name] is not None}
    alone = [row for row in rows if row[OUTCOME] is not None and all(row[name] is None for name in MEASURED)]
    widths |= {row[MEASURED[LIMIT]] is None for row in alone}
    if len(widths) == 2:
        message = "uncertainties must be given for every measurement and outcome, or for none"
        problems.append(Problem(str(path), "", message))
    if problems:
        raise InputError(problems)
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(rows):
        groups.setdefault(tuple(row[name] for name in NAMES.values()), []).append(i)
    made = []
    for where in groups.values():
        try:
            made.append(_group(rows, where, scenario, str(path)))
        except InputError as error:
            place = rows[where[0]].place
            problems += (Problem(str(path), place, f"{problem.key}: {problem.message}") for problem in error.problems)
    if problems:
        raise InputError(problems)
    measurements = tuple(m for i, row in enumerate(rows) for m in _measurements(i, row))
    cells = tuple(
        {name: cell for name, cell in row.cells.items() if cell is not None and name not in MEASURED.values()}
        for row in rows
    )
    return Tests(str(path), tuple(names), tuple(made), measurements, widths == {False}, cells)


def _group(rows: Sequence[Row], where: Sequence[int], scenario: Scenario, file: str) -> Group:
    """Tests with the same materials.

    Raises
    ------
    InputError
        If the scenario does not allow a name or a value of theirs.
    """
    import numpy as np

    texts = {name: rows[where[0]][name] for name in NAMES.values() if rows[where[0]][name] is not None}
    changed = scenario.replaced(texts) if texts else scenario
    own = inputs_of(changed)
    given = [name for name in INPUTS if any(rows[i][name] is not None for i in where)]
    check_names(given, changed, file)
    columns = {
        name: np.array([own[name] if rows[i][name] is None else rows[i][name] for i in where], dtype=np.float64)
        for name in given
    }
    check_ranges(changed, columns)
    return Group(changed, np.array(where), columns)


def _wrong(row: Row, names: Sequence[str], file: str) -> list[Problem]:
    """What is wrong in a row."""
    problems = []

    def add(name: str, message: str) -> None:
        problems.append(Problem(file, f"{row.place}: {name}" if name else row.place, message))

    if row["test"] is not None and names.count(str(row["test"])) > 1:
        add("test", f'must name one test, found "{row["test"]}" on several lines')
    found = [name for name in (*MEASURED, OUTCOME) if row[name] is not None]
    if not found:
        add("", f"must have one of {', '.join((*MEASURED, OUTCOME))}")
    if row[OUTCOME] is not None and row[OUTCOME] not in ("defeated", "perforated"):
        add(OUTCOME, f'must be "defeated" or "perforated", found "{row[OUTCOME]}"')
    if row[OUTCOME] == "defeated" and row[RESIDUAL] is not None:
        add(OUTCOME, "must not be defeated where there is a residual velocity")
    if row[OUTCOME] is not None and row[VELOCITY] is None:
        add(VELOCITY, "is missing and must be given with an outcome")
    for name in (*MEASURED, *MEASURED.values()):
        value = row[name]
        if isinstance(value, float) and not RANGE[0] <= value <= RANGE[1]:
            hint = '; a projectile that is stopped is an outcome, "defeated"' if name == RESIDUAL else ""
            add(name, f"must be at least {RANGE[0]:g} and at most {RANGE[1]:g}, found {value:g}{hint}")
    return problems


def _measurements(test: int, row: Row) -> list[Measurement]:
    found = []
    for name, uncertainty in MEASURED.items():
        value, width = row[name], row[uncertainty]
        if isinstance(value, float):
            found.append(Measurement(test, name, value, width if isinstance(width, float) else value, 0))
    if row[OUTCOME] is not None and not found:
        velocity, width = row[VELOCITY], row[MEASURED[LIMIT]]
        assert isinstance(velocity, float)
        side = 1 if row[OUTCOME] == "defeated" else -1
        found.append(Measurement(test, LIMIT, velocity, width if isinstance(width, float) else velocity, side))
    return found


class _Terms(NamedTuple):
    """The coefficients that are fitted: by which input, and by which term of its law."""

    inputs: tuple[str, ...]
    terms: tuple[int, ...]
    scales: "Floats"  # the scenario's own value, over a mean thickness where a term has one

    def names(self) -> list[str]:
        return [name + TERMS[term] for name, term in zip(self.inputs, self.terms, strict=True)]


class Fit(NamedTuple):
    """A fit, and how to fit again."""

    terms: _Terms
    x: "Floats"  # coefficients over their scales
    cost: float  # half the sum of squares
    covariance: "Floats"
    coefficients: tuple[Coefficient, ...]
    freedom: int
    starts: int
    agreeing: int
    without: Callable[["NDArray[np.bool_]"], "Floats"]  # coefficients without some measurements


def calibrate(
    tests: Tests,
    scenario: Scenario,
    fit: Sequence[str] = (FLOW_STRESS,),
    law: Law = "constant",
) -> CalibrationResult:
    """Fit inputs of the scenario to tests.

    Deviations are divided by their uncertainties or, where none are given, by the values measured.  A residual velocity
    of a test that the model defeats counts as the velocity that it lacks to its ballistic limit, below zero.  A
    one-sided test counts where it is not met, with what the ballistic limit lacks.

    Parameters
    ----------
    tests : Tests
    scenario : Scenario
        What the tests have in common.
    fit : sequence of str
        Names of inputs.
    law : str
        What the ceramic's flow stress depends on, where it is fitted.

    Raises
    ------
    InputError
        If a name is no input, the tests differ in the material that is fitted, or are fewer than the coefficients.
    """
    import numpy as np

    done = fitted(tests, scenario, fit, law)
    computed, left_out = _predicted(tests, done.terms, done.x), _left_out(tests, done)
    deviation = np.sqrt(np.diag(done.covariance))
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
        correlation=tuple(map(tuple, (done.covariance / np.outer(deviation, deviation)).tolist())),
        residuals=residuals,
        mean_error_percent=_mean_percent([(r.computed, r.measured) for r in residuals if not r.bound]),
        left_out_error_percent=_mean_percent([(r.left_out, r.measured) for r in residuals if not r.bound]),
        degrees_of_freedom=done.freedom,
        chi_squared=2.0 * done.cost,
        starts=done.starts,
        starts_agreeing=done.agreeing,
        confidence=CONFIDENCE,
    )


def fitted(tests: Tests, scenario: Scenario, fit: Sequence[str], law: Law) -> Fit:
    """Fit inputs of the scenario to tests, from several starts; see `calibrate`.

    The intervals are those of the model made linear at the estimate: with the uncertainties given, or with what the
    deviations themselves show.
    """
    import numpy as np
    from scipy.optimize import least_squares

    _check(tests, scenario, fit, law)
    terms = _terms_of(tests, fit, law)
    slopes = np.array([term > 0 and law != "proportional" for term in terms.terms])
    bounds, steps = (np.where(slopes, -MOST, LEAST), np.full(len(slopes), MOST)), np.full(len(slopes), DIFFERENCE)

    def solved(start: "Floats", kept: "NDArray[np.bool_] | slice") -> Any:
        def deviations(x: "Floats") -> "Floats":
            return _deviations(tests, _predicted(tests, terms, x))[kept]

        return least_squares(deviations, start, bounds=bounds, diff_step=steps, xtol=1e-10)

    ends = [solved(start, slice(None)) for start in _starts(slopes)]
    best = min(ends, key=lambda end: float(end.cost))
    exact = np.array([m.side == 0 for m in tests.measurements])
    freedom = int((exact | (best.fun != 0.0)).sum()) - len(slopes)
    covariance, unseen = _covariance(best.jac)
    if not tests.weighted:
        covariance = covariance * (2.0 * best.cost / freedom)
    deviation = np.sqrt(np.diag(covariance))
    return Fit(
        terms=terms,
        x=best.x,
        cost=float(best.cost),
        covariance=covariance,
        coefficients=_coefficients(terms, best.x, deviation, unseen, bounds, None if tests.weighted else freedom),
        freedom=freedom,
        starts=len(ends),
        agreeing=sum(np.allclose(end.x, best.x, rtol=SAME, atol=SAME) for end in ends),
        without=lambda out: solved(best.x, ~out).x,
    )


def _check(tests: Tests, scenario: Scenario, fit: Sequence[str], law: Law) -> None:
    """Make sure that the fit makes sense."""
    check_names(fit, scenario, scenario.file, "--fit")
    problems = []
    if len(set(fit)) != len(fit):
        problems.append(Problem(scenario.file, "--fit", "must not name an input twice"))
    for name in fit:
        if any(name in group.columns for group in tests.groups):
            problems.append(Problem(tests.file, name, "must not be a column where it is what is fitted"))
        if name in (VELOCITY, CERAMIC, BACKING):
            problems.append(Problem(scenario.file, "--fit", f'must be of a material or projectile, found "{name}"'))
    for role, key in NAMES.items():
        kinds = {name_of(group.scenario, role) for group in tests.groups}
        if len(kinds) > 1 and any(name.startswith(role + ".") for name in fit):
            message = (
                f"must be the same in all tests where the {role} is fitted, found {', '.join(sorted(map(str, kinds)))}"
            )
            problems.append(Problem(tests.file, key, message))
    if law != "constant" and FLOW_STRESS not in fit:
        problems.append(Problem(scenario.file, "--law", f"is of {FLOW_STRESS}, which must be fitted with it"))
    coefficients = len(fit) - 1 + sum(LAWS[law])
    exact = sum(m.side == 0 for m in tests.measurements)
    needed = coefficients + (not tests.weighted)
    if exact < needed:
        without = "" if tests.weighted else " without uncertainties"
        message = (
            f"must have at least {needed} measurements{without} for {coefficients} to fit, found {exact}; "
            "outcomes bound, they do not fit"
        )
        problems.append(Problem(tests.file, "", message))
    if problems:
        raise InputError(problems)


def _terms_of(tests: Tests, fit: Sequence[str], law: Law) -> _Terms:
    import numpy as np

    material = tests.groups[0].scenario
    own = inputs_of(material)
    means = [1.0, *(_mean(tests, name) for name in (CERAMIC, BACKING))]
    pairs = [
        (name, term)
        for name in fit
        for term, there in enumerate(LAWS[law] if name == FLOW_STRESS else LAWS["constant"])
        if there
    ]
    scales = np.array([own[name] / means[term] for name, term in pairs])
    return _Terms(tuple(name for name, _ in pairs), tuple(term for _, term in pairs), scales)


def _mean(tests: Tests, name: str) -> float:
    """Mean of a thickness over the tests."""
    values = [thickness for group in tests.groups for thickness in _column(group, name)]
    return float(sum(values) / len(values)) or 1.0


def _column(group: Group, name: str) -> "Floats":
    import numpy as np

    own = inputs_of(group.scenario).get(name, 0.0)
    return group.columns.get(name, np.full(len(group.where), own))


def _starts(slopes: "NDArray[np.bool_]") -> list["Floats"]:
    """Where the fit starts from: several values of every parameter, with slopes of a law at none and some."""
    import numpy as np

    starts = [np.where(slopes, 0.0, start) for start in STARTS]
    return [*starts, np.where(slopes, 0.3, 0.5)] if slopes.any() else starts


def _values(terms: _Terms, x: "Floats", group: Group) -> dict[str, "Floats"]:
    """The fitted inputs of a group's tests."""
    import numpy as np

    thicknesses = (np.ones(len(group.where)), _column(group, CERAMIC), _column(group, BACKING))
    found: dict[str, Floats] = {}
    for name, term, coefficient in zip(terms.inputs, terms.terms, x * terms.scales, strict=True):
        found[name] = found.get(name, 0.0) + coefficient * thicknesses[term]
    own = inputs_of(group.scenario)
    return {name: np.maximum(values, FLOOR * own[name]) for name, values in found.items()}


def _predicted(tests: Tests, terms: _Terms, x: "Floats") -> "Floats":
    """What the model says of every measurement."""
    import numpy as np

    count = len(tests.names)
    answers = {name: np.full(count, np.nan) for name in MEASURED}
    asked = {name: np.zeros(count, dtype=bool) for name in MEASURED}
    for m in tests.measurements:
        asked[m.quantity][m.test] = True
    for group in tests.groups:
        rows, velocities = rows_of(group.scenario, {**group.columns, **_values(terms, x, group)}, len(group.where))
        for name, values in _answers(group, rows, velocities, {n: asked[n][group.where] for n in asked}).items():
            answers[name][group.where] = values
    return np.array([answers[m.quantity][m.test] for m in tests.measurements])


def _answers(
    group: Group, rows: "Floats", velocities: "Floats", asked: Mapping[str, "NDArray[np.bool_]"]
) -> dict[str, "Floats"]:
    """Ballistic limits, residual velocities and residual masses of a group's tests, where they are asked for."""
    import numpy as np

    from armour.engine import batch

    told = solver_options(group.scenario)
    found = {name: np.full(len(rows), np.nan) for name in MEASURED}
    needs_limit = asked[LIMIT].copy()
    shots = np.flatnonzero(asked[RESIDUAL] | asked[MASS])
    if len(shots):
        ends = batch.impacts(rows[shots], velocities[shots], told)
        a = batch.fields(rows[shots])
        found[RESIDUAL][shots] = ends.V
        found[MASS][shots] = a.rho_p * cross_section(a.D0) * ends.L / G
        needs_limit[shots] |= (ends.outcome != Outcome.PERFORATED) & asked[RESIDUAL][shots]
    search = group.scenario.ballistic_limit
    low, high = search.velocity_min_m_s, search.velocity_max_m_s
    where = np.flatnonzero(needs_limit)
    if len(where):
        places = batch.ballistic_limits(rows[where], low, high, LIMIT_TOLERANCE_M_S, told)
        found[LIMIT][where] = places.within(low, high)
        below = needs_limit & asked[RESIDUAL] & (found[LIMIT] > velocities)
        found[RESIDUAL][below] = velocities[below] - found[LIMIT][below]
    return found


def _deviations(tests: Tests, computed: "Floats") -> "Floats":
    """Deviations over their widths; of a one-sided test what is lacking."""
    import numpy as np

    value, width, side = (np.array([m[i] for m in tests.measurements]) for i in (2, 3, 4))
    found = (computed - value) / width
    return np.where(side == 0, found, np.where(side * found < 0.0, found, 0.0))


def _covariance(jacobian: "Floats") -> tuple["Floats", "NDArray[np.bool_]"]:
    """Covariance for deviations of width one, and which coefficients no combination of the tests shows."""
    import numpy as np

    _, singular, axes = np.linalg.svd(jacobian, full_matrices=False)
    seen = singular > 1e-6 * max(float(singular[0]), 1e-30)
    parts = np.where(seen, 1.0 / np.where(seen, singular, 1.0), 0.0)
    unseen = (np.abs(axes[~seen]) > 1e-3).any(axis=0)
    scaled = axes.T * parts
    covariance = scaled @ scaled.T
    covariance[np.diag_indices_from(covariance)] = np.maximum(np.diag(covariance), 1e-300)
    return covariance, unseen


def _coefficients(
    terms: _Terms,
    x: "Floats",
    deviation: "Floats",
    unseen: "NDArray[np.bool_]",
    bounds: tuple["Floats", "Floats"],
    freedom: int | None,
) -> tuple[Coefficient, ...]:
    """The coefficients with their intervals; no number where the tests do not identify one.

    ``freedom`` is None where the uncertainties are known.
    """
    from scipy.stats import norm, t

    tail = 0.5 * (1.0 + CONFIDENCE)
    factor = float(norm.ppf(tail) if freedom is None else t.ppf(tail, freedom))
    found = []
    for i, name in enumerate(terms.names()):
        half, scale = factor * float(deviation[i]), float(terms.scales[i])
        reason = ""
        if unseen[i]:
            reason = "no test depends on it, or only together with others"
        elif not bounds[0][i] + SAME < x[i] < bounds[1][i] - SAME:
            reason = f"the fit runs to {x[i] * scale:.3g}, the end of what is searched"
        elif half >= max(1.0, abs(x[i])) or half >= MOST:
            reason = f"the tests leave it open to ± {half * scale:.3g}"
        if reason:
            found.append(Coefficient(name, None, None, reason))
        else:
            ends = float((x[i] - half) * scale), float((x[i] + half) * scale)
            found.append(Coefficient(name, float(x[i] * scale), ends))
    return tuple(found)


def _left_out(tests: Tests, done: Fit) -> "Floats":
    """What the model says of every measurement with coefficients from the other tests; NaN where these are too few."""
    import numpy as np

    found = np.full(len(tests.measurements), np.nan)
    exact = np.array([m.side == 0 for m in tests.measurements])
    of_test = np.array([m.test for m in tests.measurements])
    folds = min(len(tests.names), MAX_FOLDS)
    for fold in range(folds):
        out = of_test % folds == fold
        if (exact & ~out).sum() >= len(done.x):
            found[out] = _predicted(tests, done.terms, done.without(out))[out]
    return found


def _mean_percent(pairs: Sequence[tuple[float | None, float]]) -> float | None:
    errors = [abs(computed / measured - 1.0) for computed, measured in pairs if computed is not None]
    return 100.0 * sum(errors) / len(errors) if errors else None


def value_at(result: CalibrationResult, name: str, ceramic_mm: float, backing_mm: float) -> float:
    """A fitted input by its law, at thicknesses.

    Raises
    ------
    NoAnswerError
        If a coefficient is not identified.
    """
    total = 0.0
    for term, thickness in zip(TERMS, (1.0, ceramic_mm, backing_mm), strict=True):
        for coefficient in result.coefficients:
            if coefficient.name == name + term:
                if coefficient.estimate is None:
                    raise NoAnswerError(f"nothing to write: {coefficient.name} is not identified: {coefficient.reason}")
                total += coefficient.estimate * thickness
    return total


def library_text(result: CalibrationResult, tests: Tests, scenario: Scenario) -> str:
    """A library file with the calibrated entries and what they were calibrated to.

    A value by a law of the thicknesses is that of the scenario's own.

    Raises
    ------
    NoAnswerError
        If a coefficient is not identified.
    """
    names = dict.fromkeys(c.name.split(" per ")[0] for c in result.coefficients)
    ceramic, backing = scenario.armour.ceramic_thickness_mm, scenario.armour.backing_thickness_mm
    of_law = f"{result.law} law" + ("" if result.law == "constant" else f" at {ceramic:g} mm on {backing:g} mm")
    tables: dict[str, Any] = {}
    material = tests.groups[0].scenario
    for name in names:
        role, key = name.split(".")
        entry = entry_of(material, role)
        assert entry is not None
        intervals = [c.interval for c in result.coefficients if c.name == name]
        source = f"armour calibrate, {len(tests.names)} tests of {Path(tests.file).name}"
        if name == FLOW_STRESS:
            source += f", {of_law}"
        if result.law in ("", "constant") and intervals and intervals[0] is not None:
            source += f", {100.0 * CONFIDENCE:g} % interval {intervals[0][0]:.4g} to {intervals[0][1]:.4g}"
        value = {
            "value": float(f"{value_at(result, name, ceramic, backing):.6g}"),
            "status": "fitted",
            "source": source,
            "tests": [_told(tests, i, role) for i in range(len(tests.names))],
        }
        entries = tables.setdefault(entry.kind, {})
        entries.setdefault(f"{entry.name}, calibrated", {"based_on": entry.name})[key] = value
    return library_toml(tables)


def _told(tests: Tests, test: int, role: str) -> dict[str, float | str]:
    """What tells a test from others, but for the material that is calibrated."""
    group = next(group for group in tests.groups if test in group.where)
    scenario = group.scenario
    told: dict[str, float | str] = {}
    for of, key in NAMES.items():
        name = name_of(scenario, of)
        if of != role and name is not None:
            told[key] = name
    told[CERAMIC] = scenario.armour.ceramic_thickness_mm
    told[BACKING] = scenario.armour.backing_thickness_mm
    cells = tests.cells[test]
    if LIMIT not in cells:
        told[VELOCITY] = scenario.impact.velocity_m_s
    return {**told, **{name: value for name, value in cells.items() if name not in ("test", *NAMES.values())}}
