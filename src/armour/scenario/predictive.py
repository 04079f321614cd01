"""The model error on tests, as a distribution for each of many armours, from configs/evidence.toml.

docs/howto/confidence.md derives it.  The distribution is that of a new alloy, a new round or a new series of tests.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.scenario.evidence import MEASURES, DataRange, Evidence, follows, shipped_data, shipped_evidence
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
    tensile: Any  # its tensile strength, MPa; NaN where not given
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
    flow_stress: Mapping[str, float]  # parameters of the law, of a ceramic
    tensile: tuple[float, float] | None  # range of the tensile over the yield strength, where it is a term

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
    return {
        name: Fit(
            tuple(data["terms"]),
            tuple(data["reference"]),
            np.array(data["coefficients"]),
            np.array(data["covariance"]),
            data["variance"],
            data["degrees_of_freedom"],
            data.get("flow_stress", {}),
            tuple(data["tensile_ratio"]) if "tensile_ratio" in data else None,
        )
        for name, data in shipped_data()["fit"].items()
    }


class Errors(NamedTuple):
    """Distributions of the model error for n armours: mixtures over laws of the flow stress of the ceramic.

    Of each law there are several components, (laws, components, n).  The first law is the armour's own.
    """

    weights: Floats  # 0 where a component is not used; NaN where the error is not known
    shifts: Floats  # logarithm of the armour's ballistic limit over that of the model by the law
    scales: Floats
    degrees_of_freedom: Floats
    flow_stress: Floats  # parameters of the laws, see `LAW_FIELDS`, (laws, fields, n)
    logarithmic: bool = True

    @classmethod
    def of(cls, ratio: Mixture, count: int) -> "Errors":
        """Return n times the error of which the ratio of both limits has a distribution, (k,)."""
        arrays = (ratio.weights, ratio.locations, ratio.scales, ratio.degrees_of_freedom)
        parts = (np.repeat(array[None, :, None], count, axis=2) for array in arrays)
        return cls._make([*parts, np.zeros((1, len(LAW_FIELDS), count)), ratio.logarithmic])

    @classmethod
    def unknown(cls, count: int, laws: int = 1, components: int = 1) -> "Errors":
        """Return n errors that are not known."""
        shape = (laws, components, count)
        flow_stress = np.zeros((laws, len(LAW_FIELDS), count))
        return cls(np.full(shape, np.nan), np.zeros(shape), np.ones(shape), np.ones(shape), flow_stress)

    @property
    def arrays(self) -> list[Floats]:
        """All arrays, of which the last axis is that of the armours."""
        return [self.weights, self.shifts, self.scales, self.degrees_of_freedom, self.flow_stress]

    def grown(self, *shapes: tuple[int, ...]) -> "Errors":
        """Return the errors with as many laws and components as the most of some shapes; further ones are not used."""
        more = [max(shape[axis] for shape in shapes) - self.weights.shape[axis] for axis in (0, 1)]
        pads = ((0, more[0]), (0, more[1]), (0, 0))
        weights, shifts = (np.pad(array, pads) for array in (self.weights, self.shifts))
        scales, freedom = (np.pad(array, pads, constant_values=1.0) for array in self[2:4])
        weights[:, :, ~self.known] = np.nan
        flow_stress = np.pad(self.flow_stress, (pads[0], (0, 0), (0, 0)))
        return Errors(weights, shifts, scales, freedom, flow_stress, self.logarithmic)

    def at(self, where: Any) -> "Errors":
        """Return the errors of some armours."""
        return Errors._make([*(array[..., where] for array in self.arrays), self.logarithmic])

    @property
    def known(self) -> Any:
        """Whether the error is known, (n,)."""
        return ~np.isnan(self.weights[0, 0])

    def used(self, law: int) -> Any:
        """Return for which armours a law is one of the mixture, (n,)."""
        return (self.weights[law] > 0.0).any(axis=0)

    def of_law(self, law: int) -> Mixture:
        """Return the distributions of the ratio by a law alone, (components, n)."""
        with np.errstate(invalid="ignore"):
            weights = self.weights[law] / self.weights[law].sum(axis=0)
        return Mixture(weights, self.shifts[law], self.scales[law], self.degrees_of_freedom[law], self.logarithmic)

    def of_limits(self, limits: Any) -> Mixture:
        """Return the distributions of ballistic limits, given those by each law, (laws, n)."""
        _, components, count = self.weights.shape
        ratio = Mixture(self.weights, self.shifts, self.scales, self.degrees_of_freedom, self.logarithmic)
        return ratio.mapped(lambda array: array.reshape(-1, count)).times(np.repeat(limits, components, axis=0))


def errors_of(armour: Any, tensile_MPa: Any, cosines: Any) -> Errors:
    """Return the errors of the model on tests of such armours, for n armours.

    Parameters
    ----------
    armour : Parameters
        Arrays, (n,) each; thicknesses along the line of fire.
    tensile_MPa : array, (n,)
        Tensile strengths of the back plates, MPa; NaN where not given.
    cosines : array, (n,)
        Cosines of the obliquities.
    """
    found = Errors.unknown(len(armour.Hc0), max(len(evidence.laws) for evidence in shipped_evidence()))
    for evidence in shipped_evidence():
        where = np.flatnonzero((evidence.differences(armour) == 0) & (evidence.fails_angle(cosines) ^ True))
        if len(where):
            near = outside(evidence, Parameters(*(values[where] for values in armour))) <= farthest(evidence)
            where = where[near]
        if not len(where):
            continue
        some = Parameters(*(values[where] for values in armour))
        conditions = Conditions(
            some.Hc0 / some.D0,
            some.Hb / some.D0,
            some.YB / MPA / CONSTRAINT,
            tensile_MPa[where],
            MEASURES["rod_mass_ratio"].of(some),
            1.0 / cosines[where],
        )
        if evidence.bare:
            _set_bare(found, evidence, where, conditions)
        else:
            _set_by_law(found, evidence, where, conditions, some)
    return found


def farthest(evidence: Evidence) -> float:
    """Return the factor outside the ranges of tests beyond which the error is not known."""
    return FARTHEST_BARE if evidence.bare else FARTHEST_CERAMIC


def outside(evidence: Evidence, armour: Parameters) -> Any:
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


def _set_bare(found: Errors, evidence: Evidence, where: Any, conditions: Conditions) -> None:
    """Set the errors of bare plates: of the last fit whose terms are given and were tested."""
    measured = {limits.measure: limits for limits in evidence.measured}
    ranges = {
        condition: (limits.low * unit, limits.high * unit)
        for name, (condition, unit) in DOUBTED.items()
        if (limits := measured.get(MEASURES[name])) is not None
    }
    for fit in map(fits().__getitem__, evidence.fits):
        if fit.tensile is None:
            rows = np.arange(len(where))
        else:
            ratio = conditions.tensile / conditions.strength
            rows = np.flatnonzero((ratio >= fit.tensile[0]) & (ratio <= fit.tensile[1]))
        some = Conditions(*(values[rows] for values in conditions))
        shifts, scales = fit.predicted(some, ranges)
        places = where[rows]
        found.weights[:, 0, places] = 0.0
        found.weights[0, 0, places] = 1.0
        found.shifts[0, 0, places] = shifts
        found.scales[0, 0, places] = scales
        found.degrees_of_freedom[0, 0, places] = fit.degrees_of_freedom


def _set_by_law(found: Errors, evidence: Evidence, where: Any, conditions: Conditions, armour: Parameters) -> None:
    """Set the errors of armours with a ceramic: a mixture of all laws with equal weights.

    Other laws than the armour's own are those of the fit, with the flow stress in proportion to the armour's.
    """
    laws = [fits()[name] for name in evidence.fits]
    for own, ranges in enumerate(evidence.laws):
        rows = np.flatnonzero(follows(ranges, armour))
        places = where[rows]
        some = Conditions(*(values[rows] for values in conditions))
        of_armour = {name: getattr(armour, name)[rows] for name in LAW_FIELDS}
        order = [own, *(index for index in range(len(laws)) if index != own)]
        for index, fit in enumerate(laws[place] for place in order):
            found.weights[index, 0, places] = 1.0 / len(laws)
            found.shifts[index, 0, places], found.scales[index, 0, places] = fit.predicted(some, {})
            found.degrees_of_freedom[index, 0, places] = fit.degrees_of_freedom
            stress = fit.flow_stress["flow_stress_GPa"] / laws[own].flow_stress["flow_stress_GPa"]
            law = (
                of_armour["Yc0"] * stress,
                fit.flow_stress["flow_stress_backing_exponent"],
                fit.flow_stress["flow_stress_product_exponent"],
                0.0,
                0.0,
            )
            for field, value in enumerate(of_armour.values() if index == 0 else law):
                found.flow_stress[index, field, places] = value
