"""The model error for armour of an entry that was calibrated to own tests, from what the entry has of these."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from armour.core.equations import THINNEST_CERAMIC
from armour.core.state import Parameters
from armour.scenario.evidence import MEASURES, DataRange, ModelError, closest, shipped_evidence, why_unknown
from armour.scenario.inputs import INPUTS, ROLES, fields_of, inputs_of_entry
from armour.scenario.library import FLOW_STRESS_LAW, Library, LibraryEntry, OwnEvidence
from armour.scenario.mixture import Mixture
from armour.scenario.predictive import (
    FARTHEST_BARE,
    FARTHEST_CERAMIC,
    LAW_FIELDS,
    THICKNESSES,
    Errors,
    factor_outside,
    law_of,
    rows_of,
    set_shipped,
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


def why_no_error(tests: Iterable[OwnTests], armour: Parameters, cosine: float) -> str:
    """Return why the model error is not known for an armour at an angle, by own tests or else by the shipped ones."""
    own = own_tests_of(tests, armour)
    return why_unknown(armour, cosine) if own is None else own.why_unknown(armour)


def error_of_armour(ratio: Mixture, tests: Iterable[OwnTests], armour: Parameters) -> ModelError:
    """Return the model error on own tests, or else on the shipped ones, given the distribution of the ratio."""
    own = own_tests_of(tests, armour)
    if own is not None:
        return ModelError.of_ratio(
            ratio, f"{own.evidence.source}, of armour of the tested lots", own.extrapolated(armour)
        )
    evidence = closest(armour)
    return ModelError.of_ratio(ratio, evidence.title, evidence.extrapolated(armour))


def errors_of(armour: Parameters, tensile_MPa: Any, cosines: Any, tests: Sequence[OwnTests] = ()) -> Errors:
    """Return the errors of the model for n armours: on own tests of their entries, or else on the shipped ones.

    Parameters
    ----------
    armour : Parameters
        Arrays, (n,) each; thicknesses along the line of fire.
    tensile_MPa : array, (n,)
        Tensile strengths of the back plates, MPa; NaN if not given.
    cosines : array, (n,)
        Cosines of the obliquities.
    tests : sequence of OwnTests, optional
    """
    # The armour's own law may be one that the tests do not weigh.
    laws = [len(evidence.laws) for evidence in shipped_evidence()] + [len(own.evidence.law) + 1 for own in tests]
    components = [len(law.components) for own in tests for law in own.evidence.law]
    found = Errors.unknown(len(cosines), max(laws), max(components, default=1))
    set_shipped(found, armour, tensile_MPa, cosines)
    for own in reversed(tests):
        where = np.flatnonzero(own.matches(armour))
        if len(where):
            _set_own(found, own, where, rows_of(armour, where), cosines[where])
    return found


def _set_own(errors: Errors, tests: OwnTests, where: Any, armour: Parameters, cosines: Any) -> None:
    """Set the errors of those of n armours that have an entry with own tests.

    They are known if the armours are like the tests, but for thicknesses, which may be outside as far as those of the
    shipped tests may.
    """
    bare, own_law = armour.Hc0 == 0.0, law_of(armour)
    farthest = np.where(bare, FARTHEST_BARE, FARTHEST_CERAMIC)
    known, far = cosines >= np.cos(np.radians(tests.evidence.steepest_deg)) - ROUNDING, np.ones(len(where))
    for name, limits in tests.ranges():
        factor = factor_outside(limits, armour)
        known &= factor <= (farthest if name in THICKNESSES else ALIKE)
        far = np.maximum(far, factor) if name in THICKNESSES else far
    doubt = np.where(bare, TREND * np.log(np.where(known, far, 1.0)), 0.0)
    own = [key for key in FLOW_STRESS_LAW if tests.entry.values.get(key) and tests.entry[key]] or [""]
    laws = sorted(tests.evidence.law, key=lambda law: [law.exponent] != own)
    of_stress = tests.role == "ceramic" and tests.evidence.key == "flow_stress_GPa"
    value = tests.entry[tests.evidence.key]
    errors.weights[..., where] = np.where(known, 0.0, np.nan)
    errors.flow_stress[0][:, where] = own_law
    # The limit that is shown may be by a law that the tests do not weigh.
    for place, law in enumerate(laws, start=int(of_stress and [laws[0].exponent] != own)):
        rows, exponent = np.array(law.components), 0.0
        if law.exponent:
            ceramic = np.maximum(armour.Hc0 / armour.D0, THINNEST_CERAMIC) if law.exponent == PRODUCT else 1.0
            exponent = np.log(ceramic * armour.Hb / armour.D0)
        else:
            rows = np.column_stack([rows, np.zeros((len(rows), 3))])
        weight, error, level, level_error, power, power_error, correlation = rows.T[:, :, None]
        if not place:
            strength, used, used_power = own_law, value, tests.entry[law.exponent] if law.exponent else 0.0
        else:
            used, used_power = (float((weight * each).sum() / weight.sum()) for each in (level, power))
            strength = np.zeros_like(own_law)
            strength[0] = own_law[0] * used / value
            if law.exponent:
                strength[LAW_FIELDS.index(INPUTS[f"ceramic.{law.exponent}"].field)] = used_power
        shifts = law.slope * (np.log(level / used) + (power - used_power) * exponent)
        variance = level_error**2 + (power_error * exponent) ** 2
        variance = variance + 2.0 * correlation * level_error * power_error * exponent
        scales = np.sqrt(error**2 + law.slope**2 * variance + doubt**2)
        errors.put(place, where, (np.where(known, weight, np.nan), shifts, scales, NORMAL), strength)
