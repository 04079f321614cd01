"""From what is not known for sure to how sure an answer is: sampled by the compiled engine."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from math import ceil, log2
from typing import TYPE_CHECKING, Any

from armour.analysis.impact import unresolved_error
from armour.analysis.least_thickness import solver_options
from armour.core.state import Outcome
from armour.errors import InputError, NoLimitError, Problem
from armour.scenario.applicability import warnings_of
from armour.scenario.distributions import Uncertainty
from armour.scenario.loading import Scenario
from armour.scenario.parameters import VELOCITY, check_names, check_ranges, inputs_of, rows_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

CONFIDENCE = 0.95
# Part of the samples below each quantile of the ballistic limit that is given.
PARTS = {"V05": 0.05, "V50": 0.5, "V95": 0.95}
# Points of the curve of the probability of perforation.
CURVE_POINTS = 121
# Samples for one set of Sobol' indices, as a part of those for the probability, and the least of them.
INDEX_PART, MIN_FOR_INDICES = 4, 256
RESAMPLES = 499


@dataclass(frozen=True)
class Estimate:
    """A number from samples, with its interval.

    Attributes
    ----------
    value, low, high : float
    """

    value: float
    low: float
    high: float

    def samples_for(self, last_digit: float, samples: int) -> int:
        """About how many samples, where so many gave this, settle a last digit worth so much."""
        half = 0.5 * (self.high - self.low)
        return max(samples, ceil(samples * (half / (0.5 * last_digit)) ** 2)) if half > 0.5 * last_digit else samples


@dataclass(frozen=True)
class Index:
    """How much an input matters for the ballistic limit.

    Attributes
    ----------
    input : str
    first, total : Estimate or None
        Sobol' indices: part of the variance that the input explains alone, and with all that it acts together with;
        None where inputs are correlated, for which they are not defined.
    limits_m_s : tuple of float
        Ballistic limits with the input at the 5th and the 95th hundredth of its distribution, the others as in the
        scenario.
    """

    input: str
    first: Estimate | None
    total: Estimate | None
    limits_m_s: tuple[float, float]


@dataclass(frozen=True)
class ProbabilityCurve:
    """Probability of perforation over impact velocity, with its pointwise band."""

    velocity_m_s: tuple[float, ...]
    probability: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True)
class UncertaintyResult:
    """How sure the answers of a scenario are.

    Attributes
    ----------
    samples, seed : int
    method : str
    confidence : float
        Of the intervals and the band.
    probability_of_perforation : Estimate
        At the impact velocity, its own distribution included.
    ballistic_limit_m_s : mapping of str to Estimate
        "V05", "V50" and "V95": the velocities that so many hundredths of the armours do not withstand.
    mean_m_s, standard_deviation_m_s : float
        Of the ballistic limit.
    deterministic_m_s : float
        Ballistic limit of the scenario as it stands.
    curve : ProbabilityCurve
    inputs : tuple of Index
        The one that matters most first.
    warnings : tuple of str
    """

    samples: int
    seed: int
    method: str
    confidence: float
    probability_of_perforation: Estimate
    ballistic_limit_m_s: Mapping[str, Estimate]
    mean_m_s: float
    standard_deviation_m_s: float
    deterministic_m_s: float
    curve: ProbabilityCurve
    inputs: tuple[Index, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


def uncertainty(scenario: Scenario) -> UncertaintyResult:
    """Sample the inputs that the scenario's section ``uncertainty`` gives distributions.

    Raises
    ------
    InputError
        If there is none, or a distribution reaches values that are not allowed.
    NoLimitError
        If a sample has no ballistic limit in the range of its search.
    """
    import numpy as np

    from armour.scenario.sampling import columns_of, points_of

    section = section_of(scenario)
    own = inputs_of(scenario)
    columns = columns_of(section, own, points_of(section))
    check_samples(scenario, columns)
    perforated = perforations(scenario, columns)
    limits = np.sort(limits_of(scenario, columns))
    deterministic = float(limits_of(scenario, {name: np.array([own[name]]) for name in columns})[0])
    return UncertaintyResult(
        samples=section.samples,
        seed=section.seed,
        method=section.method,
        confidence=CONFIDENCE,
        probability_of_perforation=proportion(int(perforated.sum()), section.samples),
        ballistic_limit_m_s={name: quantile(limits, part) for name, part in PARTS.items()},
        mean_m_s=float(limits.mean()),
        standard_deviation_m_s=float(limits.std(ddof=1)),
        deterministic_m_s=deterministic,
        curve=curve_of(limits),
        inputs=indices_of(scenario, section),
        warnings=warnings_of(scenario, deterministic),
    )


def section_of(scenario: Scenario) -> Uncertainty:
    """The scenario's distributions.

    Raises
    ------
    InputError
        If it has none, or for an input that it does not have.
    """
    section = scenario.uncertainty
    if section is None or not section.inputs():
        message = "is missing and must be given: the distributions of inputs, as in docs/howto/uncertainty.md"
        raise InputError([Problem(scenario.file, "uncertainty", message)])
    check_names(section.inputs(), scenario, scenario.file, "uncertainty")
    own = inputs_of(scenario)
    problems = [
        Problem(scenario.file, f"uncertainty.{name}", lacking)
        for name, distribution in section.inputs().items()
        if (lacking := distribution.mean_problem(own[name]))
    ]
    if problems:
        raise InputError(problems)
    return section


def check_samples(scenario: Scenario, columns: Mapping[str, "Floats"]) -> None:
    """Make sure that the scenario allows every value that is sampled.

    Raises
    ------
    InputError
        With every distribution that reaches too far.
    """
    problems = []
    for name, values in columns.items():
        try:
            check_ranges(scenario, {name: values})
        except InputError as error:
            message = f"must not reach values that are not allowed: {error.problems[0].message}; give it a min or max"
            problems.append(Problem(scenario.file, f"uncertainty.{name}", message))
    if problems:
        raise InputError(problems)


def perforations(scenario: Scenario, columns: Mapping[str, "Floats"]) -> "NDArray[np.bool_]":
    """Whether each sample is perforated.

    Raises
    ------
    InputError
        If the time step given is too short for a run to end.
    """
    from armour.engine import batch

    rows, velocities = rows_of(scenario, columns, len(next(iter(columns.values()))))
    outcomes = batch.impacts(rows, velocities, solver_options(scenario)).outcome
    for i in (outcomes == Outcome.UNRESOLVED).nonzero()[0][:1]:
        raise unresolved_error(scenario.solver, scenario.file, float(velocities[i]))
    perforated: NDArray[np.bool_] = outcomes == Outcome.PERFORATED
    return perforated


def limits_of(scenario: Scenario, columns: Mapping[str, "Floats"]) -> "Floats":
    """Ballistic limit of each sample, m/s.

    Raises
    ------
    NoLimitError
        If one has none in the range of the search.
    """
    from armour.engine import batch

    search = scenario.ballistic_limit
    low, high = search.velocity_min_m_s, search.velocity_max_m_s
    rows, _ = rows_of(scenario, columns, len(next(iter(columns.values()))))
    places = batch.ballistic_limits(rows, low, high, search.tolerance_m_s, solver_options(scenario))
    unbounded = int((~places.bounded).sum())
    if unbounded:
        raise NoLimitError(
            f"no ballistic limit of {unbounded} of {len(rows)} samples from {low:g} to {high:g} m/s; "
            "widen the range of the section ballistic_limit, or truncate the distributions"
        )
    return places.perforated


def proportion(hits: int, samples: int) -> Estimate:
    """A part of the samples, with the interval of Clopper and Pearson."""
    from scipy.stats import binomtest

    found = binomtest(hits, samples).proportion_ci(CONFIDENCE, method="exact")
    return Estimate(hits / samples, float(found.low), float(found.high))


def quantile(ordered: "Floats", part: float) -> Estimate:
    """A quantile of ordered samples, with an interval between two of them that needs no distribution."""
    import numpy as np
    from scipy.stats import quantile_test

    found: Any = quantile_test(ordered, p=part).confidence_interval(CONFIDENCE)
    low, high = (
        end if np.isfinite(end) else edge for end, edge in ((found.low, ordered[0]), (found.high, ordered[-1]))
    )
    return Estimate(float(np.quantile(ordered, part)), float(low), float(high))


def curve_of(ordered: "Floats") -> ProbabilityCurve:
    """Probability of perforation over velocity, with Clopper and Pearson's interval at each."""
    import numpy as np
    from scipy.stats import beta

    margin = 0.05 * (ordered[-1] - ordered[0]) + 1.0
    velocities = np.linspace(ordered[0] - margin, ordered[-1] + margin, CURVE_POINTS)
    hits, count = np.searchsorted(ordered, velocities, side="right"), len(ordered)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low = np.where(hits > 0, beta.ppf(tail, np.maximum(hits, 1), count - hits + 1), 0.0)
    high = np.where(hits < count, beta.ppf(1.0 - tail, hits + 1, np.maximum(count - hits, 1)), 1.0)
    return ProbabilityCurve(*(tuple(values.tolist()) for values in (velocities, hits / count, low, high)))


def indices_of(scenario: Scenario, section: Uncertainty) -> tuple[Index, ...]:
    """How much each input matters for the ballistic limit; the impact velocity does not."""
    import numpy as np

    from armour.scenario.sampling import quantiles

    own = inputs_of(scenario)
    distributions = {name: found for name, found in section.inputs().items() if name != VELOCITY}
    names = list(distributions)
    if not names:
        return ()
    ends = {name: np.full(2 * len(names), own[name]) for name in names}
    for i, (name, distribution) in enumerate(distributions.items()):
        ends[name][2 * i : 2 * i + 2] = quantiles(distribution, np.array([0.05, 0.95]), own[name])
    check_samples(scenario, ends)
    swings = limits_of(scenario, ends).reshape(-1, 2).tolist()

    def limits(points: "Floats") -> "Floats":
        columns = {
            name: quantiles(distribution, points[i], own[name])
            for i, (name, distribution) in enumerate(distributions.items())
        }
        check_samples(scenario, columns)
        return limits_of(scenario, columns)

    pairs: list[tuple[Estimate | None, Estimate | None]] = [(None, None)] * len(names)
    if not section.correlation:
        count = max(MIN_FOR_INDICES, 2 ** int(log2(section.samples // INDEX_PART)))
        pairs = list(sobol(limits, len(names), count, section.seed))
    found = [Index(name, *pair, (low, high)) for name, pair, (low, high) in zip(names, pairs, swings, strict=True)]
    return tuple(sorted(found, key=lambda index: -(index.total.value if index.total else _swing(index))))


def _swing(index: Index) -> float:
    return abs(index.limits_m_s[1] - index.limits_m_s[0])


def sobol(
    f: Callable[["Floats"], "Floats"], inputs: int, count: int, seed: int
) -> tuple[tuple[Estimate, Estimate], ...]:
    """First-order and total Sobol' indices, with intervals, of a function of points of the unit cube, (inputs, n)."""
    import numpy as np
    from scipy.stats import qmc, sobol_indices

    if inputs == 1:
        # All of the variance is its own.
        return ((Estimate(1.0, 1.0, 1.0), Estimate(1.0, 1.0, 1.0)),)
    rng = np.random.default_rng(seed)
    both = qmc.Sobol(2 * inputs, rng=rng).random(count).T
    a, b = both[:inputs], both[inputs:]
    of_a, of_b = f(a), f(b)
    of_ab = [f(np.where(np.arange(inputs)[:, None] == i, b, a)) for i in range(inputs)]
    values = np.array([of_a, of_b, *of_ab])

    def indices(rows: "NDArray[np.int64] | slice") -> "Floats":
        v = values[:, None, rows]
        found = sobol_indices(func={"f_A": v[0], "f_B": v[1], "f_AB": v[2:]}, n=count)
        return np.array([np.ravel(found.first_order), np.ravel(found.total_order)])

    best = indices(slice(None))
    spread = np.array([indices(rng.integers(count, size=count)) for _ in range(RESAMPLES)])
    low, high = np.quantile(spread, [0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)], axis=0)
    made = [
        [Estimate(*map(float, ends)) for ends in zip(*rows, strict=True)] for rows in zip(best, low, high, strict=True)
    ]
    return tuple(zip(*made, strict=True))
