"""Model error of armours, the ratio of actual to computed ballistic limit: its distribution, or why it is not known."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import exp, expm1, log
from typing import Any, NamedTuple, Self

import numpy as np

from armour.core.state import Parameters
from armour.errors import mistake
from armour.evidence.caveats import is_no_metal
from armour.evidence.core_digest import changed_equations
from armour.evidence.fit import confirmed, is_same_armour, mixture_of
from armour.evidence.mixture import Floats, Mixture
from armour.evidence.tests import Armours, Evidence, Materials, greatest_probability, is_outside, is_untested, outside
from armour.scenario.checked import FloatOrArray, checked
from armour.scenario.inputs import cosine_of
from armour.scenario.library import SCATTER_KEYS
from armour.scenario.scenario import Scenario
from armour.scenario.schema import DesignSection, Model, Solver

# Probabilities of the quantiles that results give.
ERROR_QUANTILES = (0.025, 0.05, 0.5, 0.95, 0.975)
# Scatter that is assumed for shots where none is given, the standard deviation of the velocities that single shots need
# to perforate, per cent of V50: median, and the factor of one standard deviation of its logarithm.
SCATTER_PERCENT, SCATTER_FACTOR = 2.0, 2.0
# Mean of this distribution, and its source in words.
MEAN_SCATTER_PERCENT = SCATTER_PERCENT * exp(0.5 * log(SCATTER_FACTOR) ** 2)
ASSUMED = f"assumed: {SCATTER_PERCENT:g} % within a factor of {SCATTER_FACTOR:g}"
# Parameters of the core that a law of the limits may replace.
LAW_FIELDS = ("Yc0", "n_B", "n_cB", "a_c", "a_B", "YB", "tau", "Hc0", "Hb")
# Quantities of bare plates whose trend is uncertain beyond the tests.
DOUBTED = ("backing_thickness_ratio", "backing_strength_GPa", "rod_mass_ratio")
# Greatest tolerance of a ballistic limit to which the error of the tests applies, m/s: a small part of it.
MAX_TOLERANCE_M_S = 1.0
# Reason why the error is not known with a layer between tile and back plate.
INTERLAYER = (
    "no shipped test has a layer between tile and back plate, and a compliant one may lower the ballistic limit"
)
# Reason why a given error is not used.
BARE = "uncertainty.model is not used: its error needs scale_percent, degrees_of_freedom and source"


@dataclass(frozen=True)
class TestsHere:
    """Own tests of the same armour against the same round, and the prediction from all other tests.

    Attributes
    ----------
    limits_m_s, uncertainties_m_s : tuple of float
        Limits that were measured, and their standard deviations, m/s.
    shots : int
        Number of shots at this armour.
    confirmed : bool
        Whether there are several tests of this armour, and they agree.
    out_of_line : int
        Number of the tests of this armour that are out of line with the others.
    others : int
        Number of the other own tests.
    median_m_s : float
        Ballistic limit that the armour exceeds with a probability of 50 %, given only the other tests, own and shipped,
        m/s.
    interval_m_s : tuple of float
        Interval in which the ballistic limit lies with a probability of 95 %, given only these, m/s.
    """

    limits_m_s: tuple[float, ...]
    uncertainties_m_s: tuple[float, ...]
    shots: int
    confirmed: bool
    out_of_line: int
    others: int
    median_m_s: float
    interval_m_s: tuple[float, float]


@dataclass(frozen=True)
class ModelError:
    """Relative error of the ballistic limit: actual limit divided by computed limit, minus 1, per cent.

    Attributes
    ----------
    mean_percent, scale_percent : float or None
        Location and scale of Student's t distribution, %; None if the distribution is a mixture of several.
    degrees_of_freedom : float or None
        Degrees of freedom of this distribution.
    source : str
        Tests, or other source, from which the error is estimated.
    extrapolated : tuple of str
        Quantities in which the armour lies outside the tests from which the error is estimated.
    quantiles_percent : dict of str to float
        Quantiles of the error of an armour, %, by probability: "0.025", "0.05", "0.5", "0.95" and "0.975".
    at_least : str
        Tests that show that the limit of the armour, at an angle, is at least the one with this error; empty if none.
    tests_here : TestsHere or None
        Own tests of the same armour; None if there are none.
    scatter_percent : float
        Standard deviation of the velocities that single shots need to perforate, per cent of V50.
    scatter_source : str
        Source of this scatter.
    greatest_probability : float
        Greatest probability of stopping that is stated, as the layers are thicker or thinner than tested ones.
    """

    mean_percent: float | None
    scale_percent: float | None
    degrees_of_freedom: float | None
    source: str = ""
    extrapolated: tuple[str, ...] = ()
    quantiles_percent: dict[str, float] = field(default_factory=dict, hash=False)
    at_least: str = ""
    tests_here: TestsHere | None = None
    scatter_percent: float = MEAN_SCATTER_PERCENT
    scatter_source: str = ASSUMED
    greatest_probability: float = 1.0

    @classmethod
    def of_ratio(cls, ratio: Mixture, source: str, outside: tuple[str, ...] = (), **others: Any) -> Self:
        """Make the error of one armour from the distribution of its actual over its computed limit, (k,).

        `outside` is the attribute ``extrapolated``; `others` are further attributes.
        """
        mean = scale = freedom = None
        has_weight = ratio.weights > 0.0
        if has_weight.sum() == 1:
            [mean], [scale], [freedom] = (array[has_weight].tolist() for array in ratio[1:4])
            mean, scale = 100.0 * (expm1(mean) if ratio.logarithmic else mean - 1.0), 100.0 * scale
        quantiles = (100.0 * (ratio.quantile(ERROR_QUANTILES) - 1.0)).tolist()
        by_probability = dict(zip(map(str, ERROR_QUANTILES), quantiles, strict=True))
        error = cls(mean, scale, freedom, source, outside, by_probability, **others)
        vars(error)["ratio"] = ratio
        return error

    @cached_property
    def ratio(self) -> Mixture:
        """Distribution of the ratio of the armour's ballistic limit to that by the model."""
        numbers = (self.mean_percent, self.scale_percent, self.degrees_of_freedom)
        mean, scale, freedom = (np.array([number], dtype=np.float64) for number in numbers)
        return Mixture(np.ones(1), 1.0 + mean / 100.0, scale / 100.0, freedom, logarithmic=False)

    @property
    def of_shots(self) -> Mixture:
        """Distribution of the velocity below which a shot is stopped, over the ballistic limit by the model."""
        return self.ratio.of_shots(self.scatter_percent / 100.0)

    @checked
    def quantile(self, probability: FloatOrArray) -> Any:
        """Return the error that is not exceeded with a probability of 0 to 1, as a fraction of at least -0.99.

        Both are floats or arrays.
        """
        if not ((probability >= 0.0) & (probability <= 1.0)).all():
            raise mistake("quantile", "probability", f"must be 0 to 1, found {probability}")
        return (self.ratio.quantile(probability) - 1.0).clip(min=-0.99)

    @checked
    def interval(self, limit_m_s: float, tail: float = 0.025) -> tuple[float, float]:
        """Return the interval of the armour's ballistic limit, given that of the model, m/s.

        The probability beyond each end is `tail`; by default, that of the interval is 95 %.
        """
        low, high = (limit_m_s * (1.0 + self.quantile((tail, 1.0 - tail)))).tolist()
        return low, high

    @checked
    def median(self, limit_m_s: float) -> float:
        """Return the expected limit, at which the armour stops half of all shots, given the limit by the model, m/s."""
        return float(limit_m_s * self.of_shots.quantile(0.5))

    @checked
    def probability_of_stopping(self, limit_m_s: FloatOrArray, velocity_m_s: FloatOrArray) -> Any:
        """Return the probability that the armour stops a shot at a velocity.

        `limit_m_s` is the ballistic limit by the model, above 0; both are numbers or arrays, m/s.  The probability is
        NaN where either is missing.  It is at most `greatest_probability`.
        """
        by_tests = self.of_shots.probability_above(velocity_m_s / limit_m_s)
        return np.minimum(by_tests, self.greatest_probability)

    @checked
    def probability_v50_exceeds(self, limit_m_s: FloatOrArray, velocity_m_s: FloatOrArray) -> Any:
        """Return the probability that V50, the ballistic limit of the armour, exceeds a velocity.

        The arguments are those of `probability_of_stopping`; the scatter of shots does not count.
        """
        return self.ratio.probability_above(velocity_m_s / limit_m_s)


class ErrorRows(NamedTuple):
    """Distributions of the model error for n armours: mixtures over the laws used to compute ballistic limits.

    A law sets the parameters `LAW_FIELDS`.  The first law is that of the armour itself; its weight may be 0.
    """

    ratio: Mixture  # actual over computed limits, (laws, n); weights are 0 for unused laws, NaN for unknown errors
    parameters: Floats  # of the core, by law and field of `LAW_FIELDS`, (laws, fields, n)
    scatters: Floats  # standard deviations of shots about V50, over V50, (n,)
    greatest: Floats  # greatest probabilities of stopping that are stated, (n,)

    @classmethod
    def unknown(cls, count: int, laws: int = 1) -> "ErrorRows":
        """Make the errors of `count` armours for none of which the error is known."""
        shape = (laws, count)
        nothing, ones = np.zeros(shape), np.ones(shape)
        ratio = Mixture(np.full(shape, np.nan), nothing, ones, ones.copy(), narrowed=ones.copy())
        scatters, parameters = np.full(count, MEAN_SCATTER_PERCENT / 100.0), np.zeros((laws, len(LAW_FIELDS), count))
        return cls(ratio, parameters, scatters, np.ones(count))

    @property
    def known(self) -> Any:
        """Whether the error of each armour is known, (n,)."""
        return ~np.isnan(self.ratio.weights[0])

    @property
    def of_shots(self) -> "ErrorRows":
        """The same with distributions of the velocities below which single shots are stopped, in place of V50."""
        return self._replace(ratio=self.ratio.of_shots(self.scatters))

    def of_law(self, law: int) -> Mixture:
        """Return the distributions of the ratio by one law, given its index, (1, n)."""
        alone = self.ratio.mapped(lambda array: array[law : law + 1])
        return alone._replace(weights=np.ones_like(alone.weights))


def given_error(scenario: Scenario) -> ModelError | None:
    """Return the error that the section ``uncertainty.model`` gives; None if it gives none, or one without a source."""
    section = None if scenario.uncertainty is None else scenario.uncertainty.model
    if section is None or section.scale_percent is None or section.is_bare:
        return None
    return ModelError(section.mean_percent, section.scale_percent, section.degrees_of_freedom, section.source)


def scatter_of(scenario: Scenario, materials: Materials, *, bare: bool) -> tuple[float, str]:
    """Return the scatter of shots at an armour, per cent of V50, and its source in words.

    `bare` tells whether the armour has no tile.  Its ceramic or, of a bare plate, its metal gives it, or else the
    section ``design``; otherwise it is assumed.
    """
    entry = materials.backing if bare or materials.ceramic is None else materials.ceramic
    for given in (entry, scenario.design or DesignSection()):
        if given.scatter_percent is not None:
            return given.scatter_percent, given.scatter_source
    return MEAN_SCATTER_PERCENT, ASSUMED


def _scatters_of(scenario: Scenario, armours: Armours) -> Floats:
    """Return the scatter of shots at each of n armours, as a fraction of V50, (n,)."""
    percents = np.full(len(armours.material_of_row), MEAN_SCATTER_PERCENT)
    for place, materials in enumerate(armours.materials):
        for is_bare in (False, True):
            rows = (armours.material_of_row == place) & ((armours.parameters.Hc0 == 0.0) == is_bare)
            percents[rows] = scatter_of(scenario, materials, bare=is_bare)[0]
    return percents / 100.0


def other_settings(scenario: Scenario) -> str:
    """Describe the settings and equations that differ from those that the tests were computed with; "" if none does."""
    sections = (("model", scenario.model, Model()), ("solver", scenario.solver, Solver()))
    values = ((name, key, value, getattr(usual, key)) for name, section, usual in sections for key, value in section)
    others = [f"{name}.{key} = {value}" for name, key, value, usual in values if value != usual]
    if (tolerance := scenario.ballistic_limit.tolerance_m_s) > MAX_TOLERANCE_M_S:
        others.append(f"ballistic_limit.tolerance_m_s = {tolerance}")
    return ", ".join(filter(None, [*others, changed_equations()]))


def why_by_settings(scenario: Scenario) -> str:
    """Return why the error is not known, whatever the armour, by the sections of a scenario; "" if these allow it."""
    section = None if scenario.uncertainty is None else scenario.uncertainty.model
    if section is not None and section.is_bare:
        return BARE
    settings, arrest = other_settings(scenario), scenario.solver.arrest_velocity_m_s
    if given_error(scenario) is not None:  # it may be that of any model, but no model stops what is still fast
        settings = "" if arrest == Solver().arrest_velocity_m_s else f"solver.arrest_velocity_m_s = {arrest}"
    return f"the tests were not computed with {settings}" if settings else ""


def errors_of(scenario: Scenario, armours: Armours) -> ErrorRows:
    """Return the model errors of n armours under the settings of a scenario.

    The scenario may give the error, or exclude it.  Otherwise the errors come from the own tests of the library
    entries, or else from the shipped tests.
    """
    count, error = len(armours.material_of_row), given_error(scenario)
    if scenario.excludes_error() or why_by_settings(scenario) or (error is None and scenario.interlayers):
        return ErrorRows.unknown(count)
    if error is not None:
        repeated = error.ratio.mapped(lambda array: np.repeat(array[:, None], count, axis=1))
        scatters, parameters = _scatters_of(scenario, armours), np.zeros((1, len(LAW_FIELDS), count))
        return ErrorRows(repeated, parameters, scatters, np.ones(count))
    laws = [law for evidence, rows in armours.by_evidence for law in _laws_of(scenario, evidence, armours, rows)]
    errors = ErrorRows.unknown(count, 1 + max((number for number, *_ in laws), default=0))
    errors.scatters[:] = _scatters_of(scenario, armours)
    errors.parameters[0] = law_of(armours.parameters)
    for _, rows, _, _, greatest in laws:
        errors.ratio.weights[:, rows] = 0.0
        errors.greatest[rows] = greatest
    arrays = (*errors.ratio[:4], np.asarray(errors.ratio.narrowed))
    for number, rows, parameters, ratio, _ in laws:
        errors.parameters[number][:, rows] = parameters
        for array, values in zip(arrays, ratio, strict=True):
            array[number, rows] = values
    return errors


def _laws_of(
    scenario: Scenario, evidence: Evidence, armours: Armours, rows: Any
) -> Iterator[tuple[int, Any, Floats, tuple[Any, ...], Any]]:
    """Yield the laws by which evidence gives the model error of some of n armours, marked in the mask `rows`, (n,).

    Each comes as its index among the laws of the armours, 0 for their own; the indices of the armours; its parameters,
    by field of `LAW_FIELDS`; weights, locations, scales, degrees of freedom and factors of the scales, as of a
    `Mixture`; and the greatest probabilities of stopping that are stated for these armours.

    With a ceramic, the law of the armour comes first; the flow stress by the others is in proportion to its own.
    The scenario may assume that a limit at an angle is at least that at normal incidence.
    """
    oblique = evidence.excludes_angle(armours.cosines)
    # The greatest angle at which an armour is assumed to have at least its limit at normal incidence.
    as_at_normal = evidence.ceramic and scenario.design and scenario.design.angles_as_at_normal_incidence
    at_least_deg = 90.0 if as_at_normal else evidence.at_least_deg
    is_bounded = oblique & (armours.cosines >= cosine_of(at_least_deg))
    bare = () if evidence.ceramic else evidence.measured
    doubted = {tested.name: (tested.low, tested.high) for tested in bare if tested.name in DOUBTED}
    for is_member, at_normal in ((rows & ~oblique, False), (rows & is_bounded, True)):
        if not (evidence.fits and is_member.any()):
            continue
        places = np.flatnonzero(is_member)
        members = armours.at(places).at_normal_incidence() if at_normal else armours.at(places)
        q = members.quantities()
        holds, greatest = evidence.holds(q), greatest_probability(evidence, q)
        for own_fit, law in zip(evidence.fits, evidence.laws or [()], strict=False):
            has_law = np.flatnonzero(holds & ~is_outside(law, q))
            by_own_law = members.at(has_law)
            others = [fit for fit in evidence.fits if fit is not own_fit]
            for number, fit in enumerate([own_fit, *others], start=int(at_normal or evidence.lot != "")):
                changes: dict[str, Any] = {} if fit is own_fit and not evidence.lot else dict(fit.law)
                if changes and evidence.laws:
                    changes["Yc0"] = by_own_law.parameters.Yc0 * (fit.law["Yc0"] / own_fit.law["Yc0"])
                of_law = by_own_law.with_law(changes)
                locations, scales, narrowed = fit.predicted(of_law.quantities(), doubted)
                ratio = fit.weight, locations, scales, fit.degrees_of_freedom, narrowed
                yield number, places[has_law], law_of(of_law.parameters), ratio, greatest[has_law]


def law_of(parameters: Parameters) -> Floats:
    """Return the parameters of n armours that a law may replace, by field of `LAW_FIELDS`, (fields, n)."""
    return np.array([getattr(parameters, name) for name in LAW_FIELDS])


def error_of(scenario: Scenario, ratio: Mixture, armour: Armours, limit_m_s: float) -> ModelError | None:
    """Return the model error of a single armour, with its source, as results give it; None if it is not known.

    `ratio` is the distribution of its actual over its computed limit, `limit_m_s` the computed limit.
    """
    if np.isnan(ratio.weights).any():
        return None
    [materials] = (armour.materials[place] for place in armour.material_of_row)
    is_bare = bool(np.all(armour.parameters.Hc0 == 0.0))
    shots: Any = dict(zip(SCATTER_KEYS, scatter_of(scenario, materials, bare=is_bare), strict=True))
    if (error := given_error(scenario)) is not None:
        return ModelError.of_ratio(ratio, error.source, **shots)
    [(evidence, _)] = armour.by_evidence
    oblique = bool(evidence.excludes_angle(armour.cosines).all())
    q = (armour.at_normal_incidence() if oblique else armour).quantities()
    return ModelError.of_ratio(
        ratio,
        evidence.title + ", at normal incidence" * oblique,
        outside(evidence.measured, q),
        at_least=evidence.at_least if oblique else "",
        tests_here=_tests_here(evidence, ratio, armour, limit_m_s) if evidence.lot else None,
        greatest_probability=float(greatest_probability(evidence, q)[0]),
        **shots,
    )


def _tests_here(evidence: Evidence, ratio: Mixture, armour: Armours, limit_m_s: float) -> TestsHere | None:
    """Return the own tests of this very armour, None without any; arguments as in `error_of`."""
    q, posterior = armour.with_law(evidence.fits[0].law).quantities(), evidence.fits[0].own[0]
    tests, tested = posterior.tests, posterior.tests.quantities
    here = is_same_armour(q, tested)[0]
    if not here.any():
        return None
    # `ratio` is given all tests and is relative to the limit by the model.  Leaving out the tests of this armour moves
    # its locations, law by law, as it moves those of the mixture.
    without = [fit.own[0].lot_fit.given(fit.own[0].tests.at(~here)) for fit in evidence.fits]
    given, others = (mixture_of(each, q).one() for each in (evidence.fits, without))
    predicted = others._replace(locations=ratio.locations[1:] + others.locations - given.locations).times(limit_m_s)
    low, median, high = predicted.quantile((0.025, 0.5, 0.975)).tolist()
    limits = here & (tests.sides == 0.0)
    velocities = tested["velocity_m_s"][limits]
    return TestsHere(
        limits_m_s=tuple(velocities.tolist()),
        uncertainties_m_s=tuple(tested["uncertainty_m_s"][limits].tolist()),
        shots=int((here & ~limits).sum()),
        confirmed=bool(confirmed(tests, tests.errors, tests.uncertainties**2)[here].all()),
        out_of_line=int(np.isin(np.flatnonzero(here), evidence.doubtful).sum()),
        others=int((~here).sum()),
        median_m_s=median,
        interval_m_s=(low, high),
    )


def why_unknown(scenario: Scenario, armour: Armours) -> str:
    """Return why the model error is not known for a single armour, the only row of `armour`, in words."""
    if reason := why_by_settings(scenario):
        return reason
    if is_no_metal(np.min(armour.parameters.rho_B)):
        return "the back plate may be no metal"
    if scenario.interlayers:
        return INTERLAYER
    [(evidence, _)] = armour.by_evidence
    if evidence.lot and not evidence.fits:
        return f"{evidence.lot}: {evidence.source}"
    q, ceramic = armour.quantities(), armour.materials[armour.material_of_row[0]].ceramic
    if evidence.holds(q).all():
        return f"the model was compared with {evidence.angles()}"
    if not evidence.differences(q).any():
        return f"the armour is too far from the tests, which are of {', '.join(outside(evidence.measured, q))}"
    if evidence.lot:
        return f"the armour differs from the own tests of {evidence.lot}: {', '.join(outside(evidence.kind, q))}"
    if evidence.ceramic and ceramic is not None and is_untested(ceramic):
        return f"no test of {ceramic.name} on metal is known"
    return "no test of such an armour is known"
