"""The model error for armour of an entry that was calibrated to own tests, from what the entry has of these."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from armour.core.equations import THINNEST_CERAMIC
from armour.core.state import Parameters
from armour.scenario.evidence import MEASURES, DataRange, ModelError, closest
from armour.scenario.inputs import INPUTS, ROLES, fields_of, inputs_of_entry
from armour.scenario.library import FLOW_STRESS_LAW, Library, LibraryEntry, OwnEvidence
from armour.scenario.mixture import Floats, Mixture
from armour.scenario.predictive import (
    FARTHEST_BARE,
    FARTHEST_CERAMIC,
    LAW_FIELDS,
    THICKNESSES,
    Errors,
    factor_outside,
)
from armour.scenario.scenario import NORMAL

# Factor by which densities, strengths and the length of the penetrator may be outside of those of the tests.
ALIKE = 1.1
# Relative change of the limits of bare plates with their thickness that the model misses, which may be all of it.
TREND = 0.24
# Part of a number that is rounding, and factor by which written ends of ranges are rounded.
ROUNDING, DIGITS = 1e-9, 1.001
PRODUCT = "flow_stress_product_exponent"


class OwnTests(NamedTuple):
    """An entry with own tests in its role."""

    role: str
    entry: LibraryEntry
    evidence: OwnEvidence

    def matches(self, armour: Parameters) -> Any:
        """Return whether an armour, or each of n, has the values of the entry."""
        found: Any = True
        for field, value in fields_of(inputs_of_entry(self.role, self.entry)).items():
            found = found & (abs(getattr(armour, field) - value) <= ROUNDING * abs(value))
        # Of a ceramic, values of a law that the entry lacks are 0.
        if self.role == "ceramic":
            for name in FLOW_STRESS_LAW:
                if name not in self.entry.values:
                    found = found & (getattr(armour, INPUTS[f"ceramic.{name}"].field) == 0.0)
            found = found & (armour.Hc0 > 0.0)
        return found

    def ranges(self) -> Iterator[tuple[str, DataRange]]:
        """Give the ranges of the tests that other armours of the entry may be outside of."""
        for name, ends in self.evidence.measured:
            if MEASURES[name].key != f"{self.role}.{self.evidence.key}":
                yield name, DataRange(MEASURES[name], *ends)

    def extrapolated(self, armour: Parameters) -> tuple[str, ...]:
        """Return the ranges of the tests, in words, that an armour lies outside of by more than rounding."""
        return tuple(str(limits) for _, limits in self.ranges() if factor_outside(limits, armour) > DIGITS)

    def why_unknown(self, armour: Parameters) -> str:
        """Return why the model error is not known for an armour of the entry."""
        angle = f"obliquities up to {self.evidence.steepest_deg:g}°"
        ranges = ", ".join(self.extrapolated(armour)) or angle
        return f"the armour differs from the {self.evidence.source} to which {self.entry.name} is calibrated: {ranges}"


ROLE_OF = {kind: role for role, kind in ROLES.items()}


def own_tests(library: Library) -> tuple[OwnTests, ...]:
    """Return the entries of a library that were calibrated to own tests, ceramics first."""
    return tuple(
        OwnTests(ROLE_OF[entry.kind], entry, entry.evidence)
        for entry in library.own_tests
        if entry.evidence is not None
    )


def own_tests_of(tests: Iterable[OwnTests], armour: Parameters) -> OwnTests | None:
    """Return the first own tests that an armour has an entry of; None if there are none."""
    return next((each for each in tests if each.matches(armour)), None)


def error_of_armour(ratio: Mixture, tests: Iterable[OwnTests], armour: Parameters) -> ModelError:
    """Return the model error on own tests, or else on the shipped ones, given the distribution of the ratio."""
    own = own_tests_of(tests, armour)
    if own is not None:
        return ModelError.of_ratio(
            ratio, f"{own.evidence.source}, of armour of the tested lots", own.extrapolated(armour)
        )
    evidence = closest(armour)
    return ModelError.of_ratio(ratio, evidence.title, evidence.extrapolated(armour))


def with_own(errors: Errors, tests: Sequence[OwnTests], armour: Parameters, cosines: Any) -> Errors:
    """Return the errors of n armours by the shipped tests with those of armours that have entries with own tests."""
    for each in reversed(tests):
        where = np.flatnonzero(each.matches(armour))
        if len(where):
            some = Parameters._make(np.asarray(values)[where] for values in armour)
            own = errors_of_own(each, some, cosines[where])
            errors, own = (found.grown(errors.weights.shape, own.weights.shape) for found in (errors, own))
            for into, values in zip(errors.arrays, own.arrays, strict=True):
                into[..., where] = values
    return errors


def errors_of_own(tests: OwnTests, armour: Parameters, cosines: Any) -> Errors:
    """Return the errors of the model for n armours of an entry with own tests.

    They are known where the armours are like the tests, but for thicknesses, which may be outside as far as those of
    the shipped tests may.

    Parameters
    ----------
    tests : OwnTests
    armour : Parameters
        Arrays, (n,) each; thicknesses along the line of fire.
    cosines : array, (n,)
        Cosines of the obliquities.
    """
    count = len(cosines)
    bare = armour.Hc0 == 0.0
    farthest = np.where(bare, FARTHEST_BARE, FARTHEST_CERAMIC)
    known, far = cosines >= np.cos(np.radians(tests.evidence.steepest_deg)) - ROUNDING, np.ones(count)
    for name, limits in tests.ranges():
        factor = factor_outside(limits, armour)
        known &= factor <= (farthest if name in THICKNESSES else ALIKE)
        far = np.maximum(far, factor) if name in THICKNESSES else far
    doubt = np.where(bare, TREND * np.log(np.where(known, far, 1.0)), 0.0)
    own = [key for key in FLOW_STRESS_LAW if tests.entry.values.get(key) and tests.entry[key]]
    laws = sorted(tests.evidence.law, key=lambda law: [law.exponent] != (own or [""]))
    of_stress = tests.role == "ceramic" and tests.evidence.key == "flow_stress_GPa"
    # The limit that is shown may be by a law that the tests do not weigh.
    unlisted = int(of_stress and [laws[0].exponent] != (own or [""]))
    shape = (len(laws) + unlisted, max(len(law.components) for law in laws), count)
    found = Errors.unknown(count, *shape[:2])
    found.weights[:, :, known] = 0.0
    found.flow_stress[0] = [getattr(armour, name) for name in LAW_FIELDS]
    value = tests.entry[tests.evidence.key]
    for place, law in enumerate(laws, start=unlisted):
        rows = np.array(law.components)
        exponent = np.zeros(count)
        if law.exponent:
            ceramic = np.maximum(armour.Hc0 / armour.D0, THINNEST_CERAMIC) if law.exponent == PRODUCT else 1.0
            exponent = np.log(ceramic * armour.Hb / armour.D0)
        else:
            rows = np.column_stack([rows, np.zeros((len(rows), 3))])
        weight, error, level, level_error, power, power_error, correlation = rows.T[:, :, None]
        if not place:
            used, used_power = value, tests.entry[law.exponent] if law.exponent else 0.0
        else:
            used, used_power = (float((weight * each).sum() / weight.sum()) for each in (level, power))
            strength = (armour.Yc0 * used / value, 0.0, 0.0, 0.0, 0.0)
            for field, values in enumerate(strength):
                found.flow_stress[place, field] = values
            if law.exponent:
                found.flow_stress[place, 1 + (law.exponent == PRODUCT)] = used_power
        parts = slice(0, len(rows))
        variance: Floats = level_error**2 + (power_error * exponent) ** 2
        variance = variance + 2.0 * correlation * level_error * power_error * exponent
        found.weights[place, parts, known] = np.broadcast_to(weight[:, 0], (int(known.sum()), len(rows)))
        found.shifts[place, parts] = law.slope * (np.log(level / used) + (power - used_power) * exponent)
        found.scales[place, parts] = np.sqrt(error**2 + law.slope**2 * variance + doubt**2)
        found.degrees_of_freedom[place, parts] = NORMAL
    return found
