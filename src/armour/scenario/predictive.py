"""The model error on tests, as a distribution for each of many armours, from configs/evidence.toml.

docs/methods.md describes it.  The distribution is that of a new alloy, a new round or a new series of tests.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.scenario.evidence import MEASURES, DataRange, Evidence, is_outside, shipped_data, shipped_evidence
from armour.scenario.library import DEFAULTS
from armour.scenario.mixture import Floats, Mixture
from armour.units import GPA, MPA

# Flow stress over yield strength of a plate.
CONSTRAINT = DEFAULTS["flow_stress_GPa"][0] * GPA / MPA
# m/D^3 of a usual core, g/mm3.
CORE = 0.0215
# Part of the trend beyond the tests that is added to the scale there.
TREND_DOUBT = 0.5
# Factors outside the ranges of the tests beyond which the error is not known, of bare plates and with a ceramic.
FARTHEST_BARE, FARTHEST_CERAMIC = float(np.exp(0.5)), 2.0
# Ratios that the error of armour with a ceramic depends on.
THICKNESSES = ("ceramic_thickness_ratio", "backing_thickness_ratio")
# Parameters of the core that make a law of the flow stress.
LAW_FIELDS = ("Yc0", "n_B", "n_cB", "a_c", "a_B")


class Conditions(NamedTuple):
    """What the error of n armours depends on; arrays, (n,)."""

    ceramic: Any  # thicknesses along the line of fire over the diameter
    backing: Any
    strength: Any  # yield strength of the plate, MPa
    tensile: Any  # its tensile strength, MPa; NaN if not given
    core: Any  # mass of the penetrator over the cube of its diameter, g/mm3
    path: Any  # 1/cos of the obliquity

    def over(self, thickness: float, strength: float) -> "Conditions":
        """Return the conditions over those of reference, of which the terms are made."""
        return Conditions(
            self.ceramic / thickness,
            self.backing / thickness,
            self.strength / strength,
            self.tensile / strength,
            self.core / CORE,
            self.path,
        )


# Terms of the fits by name, of conditions over those of reference.
TERMS: dict[str, Callable[[Conditions], Any]] = {
    "1": lambda c: np.ones(np.shape(c.backing)),
    "x": lambda c: np.log(c.backing),
    "x2": lambda c: np.log(c.backing) ** 2,
    "h": lambda c: np.log(c.backing).clip(min=0.0),
    "Y": lambda c: np.log(c.strength),
    "u": lambda c: np.log(c.tensile / c.strength),
    "s": lambda c: np.log(c.core),
    "o": lambda c: c.path - 1.0,
    "cb": lambda c: np.log(c.ceramic * c.backing),
}


def matrix_of(terms: Sequence[str], reference: tuple[float, float], conditions: Conditions) -> Floats:
    """Return the terms of n armours, (n, terms)."""
    return np.column_stack([TERMS[term](conditions.over(*reference)) for term in terms])


# Measured ranges of which the trend beyond them is doubted: the condition that each is of, and its value in that unit.
DOUBTED = {
    "backing_thickness_ratio": ("backing", 1.0),
    "backing_strength_GPa": ("strength", GPA / MPA / CONSTRAINT),
    "rod_mass_ratio": ("core", 1.0),
}


class Fit(NamedTuple):
    """A fit of the logarithm of the armour's ballistic limit over the model's."""

    terms: tuple[str, ...]
    reference: tuple[float, float]  # thickness over the diameter, and strength, MPa
    coefficients: Floats  # (terms,)
    covariance: Floats  # (terms, terms)
    variance: float  # of a new alloy, round and test
    degrees_of_freedom: float
    flow_stress: Mapping[str, float] = {}  # parameters of the law, of a ceramic
    tensile_ratio: tuple[float, float] | None = None  # range of the tensile over the yield strength, if it is a term

    def predicted(self, conditions: Conditions, ranges: Mapping[str, tuple[float, float]]) -> tuple[Floats, Floats]:
        """Return locations and scales of the distributions of n armours, (n,) each.

        Beyond the ranges of the tests, by condition, the trend goes on, and a part of it is added to the scale.
        """
        matrix = matrix_of(self.terms, self.reference, conditions)
        variance = self.variance + np.einsum("ni,ij,nj->n", matrix, self.covariance, matrix)
        for condition, (low, high) in ranges.items():
            inside = conditions._replace(**{condition: getattr(conditions, condition).clip(low, high)})
            trend = (matrix - matrix_of(self.terms, self.reference, inside)) @ self.coefficients
            variance += (TREND_DOUBT * trend) ** 2
        return matrix @ self.coefficients, np.sqrt(variance)


@cache
def fits() -> dict[str, Fit]:
    """Return the fits by name."""
    found = {}
    for name, data in shipped_data()["fit"].items():
        given: dict[str, Any] = {key: data[key] for key in data if key in Fit._fields}
        given |= {key: np.array(data[key]) for key in ("coefficients", "covariance")}
        found[name] = Fit(**given)
    return found


class Errors(NamedTuple):
    """Distributions of the model error for n armours: mixtures over laws of the flow stress of the ceramic.

    The first law is the armour's own.
    """

    ratio: Mixture  # of the limits, (laws, components, n); weights are 0 if not used, and NaN if the error is not known
    flow_stress: Floats  # parameters of the laws, see `LAW_FIELDS`, (laws, fields, n)

    @classmethod
    def of(cls, ratio: Mixture, count: int) -> "Errors":
        """Return n times the error, given the distribution of the ratio of both limits, (k,)."""
        repeated = ratio.mapped(lambda array: np.repeat(array[None, :, None], count, axis=2))
        return cls(repeated, np.zeros((1, len(LAW_FIELDS), count)))

    @classmethod
    def unknown(cls, count: int, laws: int = 1, components: int = 1) -> "Errors":
        """Return n errors that are not known."""
        shape = (laws, components, count)
        ratio = Mixture(np.full(shape, np.nan), np.zeros(shape), np.ones(shape), np.ones(shape))
        return cls(ratio, np.zeros((laws, len(LAW_FIELDS), count)))

    def put(self, law: int, where: Any, components: Sequence[Any], flow_stress: Any) -> None:
        """Set a law of some armours: arrays of its mixture, (components, n) each, and its parameters, (fields, n)."""
        count = len(components[1])
        for array, values in zip(self.ratio.arrays, components, strict=True):
            array[law, :count][:, where] = values
        self.flow_stress[law][:, where] = flow_stress

    def at(self, where: Any) -> "Errors":
        """Return the errors of some armours."""
        return Errors(self.ratio.mapped(lambda array: array[..., where]), self.flow_stress[..., where])

    @property
    def weights(self) -> Floats:
        """Probabilities of the components, (laws, components, n)."""
        return self.ratio.weights

    @property
    def known(self) -> Any:
        """Whether the error is known, (n,)."""
        return ~np.isnan(self.weights[0, 0])

    def used(self, law: int) -> Any:
        """Return for which armours a law is one of the mixture, (n,)."""
        return (self.weights[law] > 0.0).any(axis=0)

    def of_law(self, law: int) -> Mixture:
        """Return the distributions of the ratio by a law alone, (components, n)."""
        alone = self.ratio.mapped(lambda array: array[law])
        with np.errstate(invalid="ignore"):
            return replace(alone, weights=alone.weights / alone.weights.sum(axis=0))

    def of_limits(self, limits: Any) -> Mixture:
        """Return the distributions of ballistic limits, given those by each law, (laws, n)."""
        _, components, count = self.weights.shape
        return self.ratio.mapped(lambda array: array.reshape(-1, count)).times(np.repeat(limits, components, axis=0))


def set_shipped(errors: Errors, armour: Parameters, tensile_MPa: Any, cosines: Any) -> None:
    """Set the errors of those of n armours that the shipped tests are of; see `errors_of`."""
    for evidence in shipped_evidence():
        where = np.flatnonzero((evidence.differences(armour) == 0) & (evidence.fails_angle(cosines) ^ True))
        where = where[
            _factor(evidence, rows_of(armour, where)) <= (FARTHEST_BARE if evidence.bare else FARTHEST_CERAMIC)
        ]
        if not len(where):
            continue
        some = rows_of(armour, where)
        conditions = Conditions(
            some.Hc0 / some.D0,
            some.Hb / some.D0,
            some.YB / MPA / CONSTRAINT,
            tensile_MPa[where],
            MEASURES["rod_mass_ratio"].of(some),
            1.0 / cosines[where],
        )
        errors.weights[..., where] = 0.0
        if evidence.bare:
            _set_bare(errors, evidence, where, conditions)
        else:
            _set_by_law(errors, evidence, where, conditions, some)


def rows_of(armour: Parameters, where: Any) -> Parameters:
    """Return some of n armours."""
    return Parameters._make(np.asarray(values)[where] for values in armour)


def _factor(evidence: Evidence, armour: Parameters) -> Any:
    """Return the greatest factor by which n armours are outside the ranges of tests that the error depends on."""
    measures = [MEASURES[name] for name in (DOUBTED if evidence.bare else THICKNESSES)]
    factors = [factor_outside(limits, armour) for limits in evidence.measured if limits.measure in measures]
    return np.maximum.reduce(factors)


def factor_outside(limits: DataRange, armour: Parameters) -> Any:
    """Return the factor by which n armours are outside of a range, at least 1; infinite for none against some."""
    value = np.asarray(limits.measure.of(armour), dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.maximum(value / limits.high, limits.low / value)
    return np.where((value >= limits.low) & (value <= limits.high), 1.0, np.maximum(factor, 1.0))


def _set_bare(errors: Errors, evidence: Evidence, where: Any, conditions: Conditions) -> None:
    """Set the errors of bare plates: of the last fit whose terms are given and were tested."""
    measured = {limits.measure: limits for limits in evidence.measured}
    ranges = {
        condition: (limits.low * unit, limits.high * unit)
        for name, (condition, unit) in DOUBTED.items()
        if (limits := measured.get(MEASURES[name])) is not None
    }
    for fit in map(fits().__getitem__, evidence.fits):
        rows = np.arange(len(where))
        if fit.tensile_ratio is not None:
            (low, high), ratio = fit.tensile_ratio, conditions.tensile / conditions.strength
            rows = np.flatnonzero((ratio >= low) & (ratio <= high))
        shifts, scales = fit.predicted(Conditions(*(values[rows] for values in conditions)), ranges)
        errors.put(0, where[rows], (1.0, shifts[None], scales, fit.degrees_of_freedom), 0.0)


def _set_by_law(errors: Errors, evidence: Evidence, where: Any, conditions: Conditions, armour: Parameters) -> None:
    """Set the errors of armours with a ceramic: a mixture of all laws with equal weights.

    Other laws than the armour's own are those of the fit, with the flow stress in proportion to the armour's.
    """
    laws, own_law = [fits()[name] for name in evidence.fits], law_of(armour)
    for own, ranges in enumerate(evidence.laws):
        rows = np.flatnonzero(is_outside(ranges, armour) ^ True)
        some = Conditions(*(values[rows] for values in conditions))
        for index, fit in enumerate([laws[own], *laws[:own], *laws[own + 1 :]]):
            law = own_law[:, rows]
            if index:
                law = np.zeros_like(law)
                law[0] = own_law[0, rows] * (
                    fit.flow_stress["flow_stress_GPa"] / laws[own].flow_stress["flow_stress_GPa"]
                )
                law[1] = fit.flow_stress["flow_stress_backing_exponent"]
                law[2] = fit.flow_stress["flow_stress_product_exponent"]
            shifts, scales = fit.predicted(some, {})
            errors.put(index, where[rows], (1.0 / len(laws), shifts[None], scales, fit.degrees_of_freedom), law)


def law_of(armour: Parameters) -> Floats:
    """Return the parameters of the law of the flow stress of n armours, (fields, n)."""
    return np.array([getattr(armour, name) for name in LAW_FIELDS])
