"""Own tests of a lot, as stored in a calibrated entry: armours, results, and the limits by each law.

A law is one of the flow stress of a ceramic, or the fit to shipped tests of bare plates.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from armour.analysis.variants import Floats, Variants, ballistic_limits, concatenated
from armour.csv_files import shipped_rows
from armour.errors import counted
from armour.evidence.caveats import is_long_rod
from armour.evidence.fit import law_parameters, shipped_data
from armour.evidence.model_error import other_settings
from armour.evidence.tests import armours_of, is_outside, tests_of_tiles
from armour.scenario import library
from armour.scenario.inputs import BACKING, CERAMIC, OBLIQUITY, ROD, cosine_of
from armour.scenario.library import LawTests, LibraryEntry, OwnTests
from armour.scenario.scenario import Scenario
from armour.scenario.schema import FASTEST_M_S, SLOWEST_M_S
from armour.statistics.measured import LIMIT, SERIES_COLUMNS, Measurement, Tests

# Relative standard deviation of the velocity at which shots perforate an armour, if none is given.
SHOT_SCATTER = 0.02
# Standard deviation of the logarithm of the flow stress of a ceramic without shipped tests, about its entry's value.
UNTESTED_DEVIATION = 0.40
# Fit of the flow stress of such a ceramic: greatest factor between the fitted value and the entry's, number of Newton
# steps, change of the logarithm for the derivative of the limit's logarithm, and least value of this derivative, which
# is 0.35 to 0.62 for most armours.
FACTOR, STEPS, STEP, LEAST_SLOPE = 8.0, 6, 0.05, 0.3
NOTHING_OF_ERROR = "its own tests do not determine the model error"
# What identifies a test: layers, angle, penetrator and measured limit.
IDENTITY = (CERAMIC, BACKING, OBLIQUITY, *ROD[:2], LIMIT)
# What can be calibrated to own tests, by role: keys of the entry, and the quantities of an armour that follow.
FITTED_KEYS = {
    "ceramic": ("flow_stress_GPa", *library.FLOW_STRESS_LAW),
    "backing": ("flow_stress_GPa", "shear_strength_MPa"),
}
QUANTITIES_OF_ROLE = {
    "ceramic": ("ceramic_strength_GPa", "backing_exponent", "product_exponent", "slopes"),
    "backing": ("backing_strength_GPa", "backing_shear_ratio"),
}


def repeated(tests: Tests) -> Iterator[str]:
    """Yield a warning if two or more tests are among the shipped ones, from which the model error comes."""
    usual = tests.scenario.inputs()
    shipped_values = {**usual, CERAMIC: 0.0, OBLIQUITY: 0.0}  # where a shipped table has no such column
    shipped = set()
    for name in ("tests/wilkins", "tests/plates"):
        shipped |= {_identity(row, shipped_values) for row in shipped_rows(name)}
    count = sum(_identity(cells, usual) in shipped for cells in tests.cells)
    # One alone may be a coincidence.
    if count > 1:
        yield (
            f"{count} of {len(tests.cells)} tests are among those that the model error comes from; written as own "
            "tests, they count twice: leave them out"
        )


def nothing_of_error(scenario: Scenario) -> str:
    """Return the reason why a calibrated entry has no model error: none of its tests could be used."""
    if settings := other_settings(scenario):
        return f"{NOTHING_OF_ERROR}: their limits were computed with {settings}"
    reasons = "none measured a limit, one is implausible for any lot, or their settings, armours or angles are not"
    return f"{NOTHING_OF_ERROR}: {reasons} those of the shipped tests"


def _identity(cells: Mapping[str, float | str], usual: Mapping[str, float]) -> tuple[float, ...]:
    """Return what identifies a test, the values of `IDENTITY`: its cells or, where blank, the `usual` ones."""
    # An empty cell is no value; a zero is one.
    values = {key: value for key, value in cells.items() if value != ""}
    return tuple(float(values.get(key, usual.get(key, 0.0))) for key in IDENTITY)


def role_of(tests: Tests, fitted: Sequence[str]) -> str:
    """Return the role of the material whose own tests can determine the model error; "" if there is none.

    There is none if something else than a strength of ceramic or back plate was fitted, or if settings of the model
    differ from those of the shipped tests.  `fitted` are the names of the fitted inputs.
    """
    role, *other_roles = {name.partition(".")[0] for name in fitted}
    keys = {name.partition(".")[2] for name in fitted} - {"dynamic_yield_strength_MPa"}
    is_of_strength = not other_roles and keys <= {*FITTED_KEYS.get(role, ())}
    return role if is_of_strength and not other_settings(tests.scenario) else ""


def _variants_of(tests: Tests, measurements: Sequence[Measurement]) -> Variants:
    """Return the armour and impact of each measurement, (n,), as variants."""
    places = np.argsort(np.concatenate([group.where for group in tests.groups]))
    all_variants = concatenated([group.variants() for group in tests.groups])
    return all_variants.at(places[[measurement.test for measurement in measurements]])


def unused(tests: Tests, role: str) -> list[str]:
    """Return for each measurement why it does not count for the model error of the material in a role; "" if it does.

    Those that are unlike most others, such as those of long rods or at an angle beyond those of the shipped tests, do
    not count.
    """
    shots = np.array([place for place, m in enumerate(tests.measurements) if m.quantity == LIMIT], dtype=np.int64)
    reasons = np.array(["it measured no ballistic limit"] * len(tests.measurements), dtype=object)
    reasons[shots] = ""
    if not len(shots):
        return reasons.tolist()
    variants = _variants_of(tests, [tests.measurements[place] for place in shots])
    quantities = variants.armours.quantities()

    def leave_out(where: Any, reason: str) -> None:
        """Give the measured limits `where`, a mask, a reason unless they have one."""
        reasons[shots[where & (reasons[shots] == "")]] = reason

    is_bare = quantities["ceramic_thickness_ratio"] == 0.0
    leave_out(is_bare & (role == "ceramic"), "it is of a bare plate")
    leave_out(~is_bare & (role == "backing"), "it is of an armour with a ceramic")
    evidence = tests_of_tiles()
    if role == "backing":
        # The tests of plates that hold for most of the measurements still in use.
        holding = [(each, rows & each.holds(quantities)) for each, rows in variants.armours.by_evidence]
        evidence, holds = max(holding, key=lambda held: (held[1] & (reasons[shots] == "")).sum())
        leave_out(~holds, "no shipped test is of such a plate and penetrator")
    longest_path = (1.0 + 1e-6) / cosine_of(evidence.obliquity_max_deg)
    angles = np.where(quantities["path_ratio"] > longest_path, _rounded(variants.cosines), 1.0)
    for values, reason in (
        (1.0 - is_long_rod(variants.armours.parameters), "it is of a long rod, or most are"),
        (angles, "it is at another angle than most"),
    ):
        used = values[reasons[shots] == ""]
        leave_out(values != max(sorted({*used.tolist()}, reverse=True), key=used.tolist().count, default=1.0), reason)
    return reasons.tolist()


def own_tests(tests: Tests, fitted: Mapping[str, float], used: Sequence[int]) -> OwnTests | None:
    """Return the tests as stored in a calibrated entry; None if they do not determine the model error.

    `fitted` has the fitted values by input, of the role that `role_of` returns.  `used` are the indices of the
    measurements that `unused` has no reason against.
    """
    shots = [tests.measurements[place] for place in used]
    role, scenario = next(iter(fitted)).partition(".")[0], tests.groups[0].scenario
    entry = scenario.entry_of(role)
    if not shots or entry is None:
        return None
    variants, velocities = _variants_of(tests, shots), np.array([shot.value for shot in shots])
    quantities, sides = variants.armours.quantities(), np.array([float(shot.side) for shot in shots])
    measured = np.where(sides == 0.0, velocities, np.nan)
    laws = _laws_of_plates(variants, entry) if role == "backing" else _laws_of_ceramic(variants, entry, measured)
    calibrated = scenario.with_inputs({name: float(f"{value:.6g}") for name, value in fitted.items()})
    values = armours_of(calibrated).quantities()
    scatter = [abs(m.side) * SHOT_SCATTER * m.value if m.uncertainty is None else m.uncertainty for m in shots]
    quantities |= {"velocity_m_s": velocities, "uncertainty_m_s": np.array(scatter), "side": sides}
    series = [tuple(str(tests.cells[shot.test].get(name, "")) for name in SERIES_COLUMNS) for shot in shots]
    stored_keys = [*library.VARIED, *library.IN_COMMON, *library.TEST_RESULTS]
    stored_keys += [library.SERIES_KEY] * (len({*series}) > 1)
    quantities[library.SERIES_KEY] = np.array([float(sorted({*series}).index(name)) for name in series])
    return OwnTests(
        source=f"{counted(len({shot.test for shot in shots}), 'test')} of {Path(tests.file).name}",
        calibrated={name: float(values[name][0]) for name in QUANTITIES_OF_ROLE[role]},
        tests={name: _rounded(quantities[name]) for name in stored_keys},
        law=laws,
    )


def _rounded(values: Floats) -> tuple[float, ...]:
    """Return values, (n,), with seven significant digits, as a library file has them."""
    return tuple(float(f"{value:.7g}") for value in values)


def _limits_with(variants: Variants, role: str, values: Mapping[str, float]) -> Floats:
    """Return the ballistic limits of variants, m/s, (n,), with `values`, by key, of the entry in a role.

    They are searched for up to the greatest velocity, whatever the range of the scenario.
    """
    ends = SLOWEST_M_S, FASTEST_M_S
    return ballistic_limits(variants.with_fields(law_parameters(role, values)), ends).clip(*ends)


def _laws_of_plates(variants: Variants, entry: LibraryEntry) -> tuple[LawTests, ...]:
    """Return the limits of bare plates computed with the strengths of their entry, for each fit to shipped plates."""
    [(evidence, _)] = variants.armours.by_evidence
    values = {key: float(f"{entry[key]:.7g}") for key in FITTED_KEYS["backing"]}
    computed = _rounded(_limits_with(variants, "backing", values))
    return tuple(LawTests(fit=fit.name, values=values, computed_m_s=computed) for fit in evidence.fits)


def _laws_of_ceramic(variants: Variants, entry: LibraryEntry, measured: Floats) -> tuple[LawTests, ...]:
    """Return the computed limits of variants by each law of the flow stress of their ceramic.

    A ceramic with shipped tests has the flow stress fitted to these.  For any other, it is fitted to the limits
    `measured`, m/s, (n,), which are NaN for shots.  The level is then the mean and the standard deviation of the
    logarithm of a ratio: limits by the entry's own flow stress, which is uncertain, over limits by the fitted one.
    """
    shipped = tests_of_tiles()
    is_outside_any = is_outside(shipped.kind[:2], variants.armours.quantities()).any()
    has_tests = entry.origin == shipped.ceramic and not is_outside_any
    laws = {fit.name: shipped_data()["fit"][fit.name]["flow_stress"] for fit in shipped.fits}
    ratio = 1.0 if has_tests else entry["flow_stress_GPa"] / laws["constant"]["flow_stress_GPa"]
    by_law = []
    for name, values in laws.items():

        def log_limits(shift: float, values: Mapping[str, float] = values) -> Floats:
            """Return logarithms of limits, with the flow stress of a law raised by exp(shift)."""
            scaled = {**values, "flow_stress_GPa": values["flow_stress_GPa"] * ratio * np.exp(shift)}
            return np.log(_limits_with(variants, "ceramic", scaled))

        shift, slope = 0.0, 1.0
        for _ in range(0 if has_tests else STEPS):
            slope = max(float((log_limits(shift + STEP) - log_limits(shift - STEP)).mean()) / (2.0 * STEP), LEAST_SLOPE)
            if not np.isnan(measured).all():
                deviation = float(np.nanmean(np.log(measured) - log_limits(shift)))
                shift = float(np.clip(shift + deviation / slope, -np.log(FACTOR), np.log(FACTOR)))
        fitted = {**values, "flow_stress_GPa": float(f"{values['flow_stress_GPa'] * ratio * np.exp(shift):.7g}")}
        level = None if has_tests else (-slope * shift, slope * UNTESTED_DEVIATION)
        by_law.append(LawTests(fit=name, values=fitted, level=level, computed_m_s=_rounded(np.exp(log_limits(shift)))))
    return tuple(by_law)
