"""Tests that the model was compared with, shipped or the user's own: which apply, and where an armour is far off."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property
from math import log
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.errors import Note, counted, joined
from armour.evidence.caveats import caveats, is_no_metal
from armour.evidence.core_digest import changed_equations
from armour.evidence.fit import Fit, LotTests, Quantities, fits, law_parameters, quantities, same_rods, shipped_data
from armour.scenario.inputs import cosine_of
from armour.scenario.library import (
    FLOW_STRESS_KEY,
    FLOW_STRESS_LAW,
    IN_COMMON,
    VARIED,
    LibraryEntry,
    OwnTests,
    strength_notes,
    tensile_strength,
)
from armour.scenario.scenario import Scenario
from armour.scenario.schema import Impact
from armour.units import MM

# Factor by which a quantity of an unusual armour, see `is_unusual`, lies outside all that the model was compared with.
UNUSUAL_FACTOR = 2.0
# Factors outside the ranges of the tests beyond which the error is not known: of bare plates and with a ceramic.
FARTHEST_BARE, FARTHEST_CERAMIC = float(np.exp(0.5)), 2.0
# Factor by which an armour may differ from own tests of a ceramic without shipped tests, in the quantities that these
# tests have in common.
ALIKE_FACTOR = 1.1
# Additional standard deviations between lots, beyond that of the shipped tests: with a ceramic, and for armours
# unlike the shipped tests, as on another metal.
STRANGE, STRANGE_METAL = 0.10, 0.15
# Thicknesses of the layers, in diameters of the penetrator; and by how much the greatest probability of stopping that
# is stated falls where the logarithm of a thickness over the nearest tested one grows by 1.
THICKNESSES = ("ceramic_thickness_ratio", "backing_thickness_ratio")
# Words for the layers, and the factor outside a range of the tests beyond which an armour is called far from them.
LAYERS, FAR = dict(zip(THICKNESSES, ("tile", "plate"), strict=True)), 1.1
FALL = 0.1 / log(1.5)
# Properties that identify a ceramic.
OF_CERAMIC = ("ceramic_density_kg_m3", "ceramic_modulus_GPa", "ceramic_strength_GPa")
# Least number of sources of the flow stress of a ceramic without tests on which a verdict is based.
LEAST_SOURCES = 2
# Fraction of tables of sound tests in which some test is called out of line.
FALSE_ALARMS = 0.05
# Number of standard deviations from the prediction for any lot beyond which an own test is a mistake.
IMPLAUSIBLE = 6.0
# Number of differences that a ceramic instead of none counts for, more than all others together; relative size of
# rounding errors.
BY_CERAMIC, ROUNDING = 1000, 1e-6


class DataRange(NamedTuple):
    """Range of a quantity of armours or rounds, such as that of tests; its text is a description with the unit."""

    name: str
    low: float
    high: float

    def excludes(self, q: Quantities) -> Any:
        """Return whether each of n armours lies outside the range, (n,)."""
        return ~((q[self.name] >= self.low) & (q[self.name] <= self.high))

    def factor(self, q: Quantities) -> Any:
        """Return the factor by which n armours are outside the range, (n,): 1 inside; infinite if value or end is 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.fmax(np.fmax(q[self.name] / self.high, self.low / q[self.name]), 1.0)

    def containing(self, values: Any) -> "DataRange":
        """Return the range widened to contain further values, with a margin for rounding."""
        low, high = float(values.min()) * (1.0 - ROUNDING), float(values.max()) * (1.0 + ROUNDING)
        return DataRange(self.name, min(self.low, low), max(self.high, high))

    def __str__(self) -> str:
        ends = dict.fromkeys(f"{end:.4g}" for end in (self.low, self.high))
        return str(shipped_data()["quantity"][self.name]).format(" to ".join(ends))


class Evidence(NamedTuple):
    """Tests of a kind of armour against a kind of penetrator, and the fits of the model error to them.

    The error applies to armours of the kind, and is extrapolated to some distance outside the ranges of the tests.
    """

    title: str = ""  # the tests, in words
    source: str = ""  # its key of the bibliography is in brackets
    laws: tuple[tuple[DataRange, ...], ...] = ()  # of the ceramic's flow stress, each as ranges of its parameters
    kind: tuple[DataRange, ...] = ()  # ranges that define the kind of armour and penetrator
    measured: tuple[DataRange, ...] = ()  # ranges of the tests
    compared: tuple[DataRange, ...] = ()  # outside these, an armour is unlike all that the model was compared with
    fits: tuple[Fit, ...] = ()  # of the model error, one for each law; none if an entry must be calibrated again
    ceramic: str = ""  # empty for bare plates
    metal: str = ""  # of the back plates, and the projectile, if there was only one
    projectile: str = ""
    obliquity_max_deg: float = 0.0  # greatest angle of the tests
    at_least_deg: float = 0.0  # greatest angle at which plates are known to have at least the limit at normal incidence
    at_least: str = ""  # the tests that show this
    lot: str = ""  # name of the lot of own tests; empty for shipped tests
    doubtful: tuple[int, ...] = ()  # own tests that are out of line or, without fits, implausible
    thicknesses: tuple[DataRange, ...] = ()  # of the layers in these tests; own ones of a tested ceramic or metal apart

    def differences(self, q: Quantities) -> Any:
        """Return in how many respects n armours are not of the kind, (n,); a ceramic or none outweighs all others."""
        by_ceramic = BY_CERAMIC * (bool(self.ceramic) == (q["ceramic_thickness_ratio"] == 0.0))
        # The flow stress of the ceramic may have any of the laws.
        by_law = np.all([is_outside(law, q) for law in self.laws], axis=0) if self.laws else 0
        return sum((data_range.excludes(q) for data_range in self.kind), start=by_ceramic) + by_law

    def holds(self, q: Quantities) -> Any:
        """Return whether the error is known for each of n armours, (n,): of the kind, and near enough to the tests."""
        most = FARTHEST_CERAMIC if self.ceramic else FARTHEST_BARE
        return (self.differences(q) == 0) & (farthest(self.measured, q) <= most) & bool(self.fits)

    def excludes_angle(self, cosines: Any) -> Any:
        """Return whether angles, given their cosines, are greater than those of the tests."""
        return cosines < cosine_of(self.obliquity_max_deg) * (1.0 - ROUNDING)

    def angles(self) -> str:
        """Describe the angles of the tests, as the reason why the error at a greater one is not known."""
        if self.obliquity_max_deg:
            return f"tests of such plates at up to {max(self.obliquity_max_deg, self.at_least_deg):g}° only"
        return f"no test of {'an armour with a ceramic' if self.ceramic else 'such a plate'} at an angle"


def greatest_probability(evidence: Evidence, q: Quantities) -> Any:
    """Return the greatest probability of stopping that may be stated for n armours, (n,), so far from the tests.

    It falls with the distance from the tests: the greater logarithm of the factors by which the layers are thicker or
    thinner than tested ones, in diameters of the penetrator.  Own tests count for the round that they were fired with.
    """
    distance = np.log(farthest(evidence.thicknesses, q))
    if evidence.lot:
        tested = evidence.fits[0].own[0].tests.quantities
        same = same_rods(q, tested)
        own = []
        for name, *_ in evidence.thicknesses:
            low, high = np.where(same, tested[name], np.inf).min(axis=1), np.where(same, tested[name], 0.0).max(axis=1)
            own.append(DataRange(name, low * (1.0 - ROUNDING), high * (1.0 + ROUNDING)))
        distance = np.where(same.any(axis=1), np.minimum(distance, np.log(farthest(own, q))), distance)
    return (1.0 - FALL * distance).clip(min=0.0)


def farthest(ranges: Iterable[DataRange], q: Quantities) -> Any:
    """Return the greatest factor by which each of n armours is outside any of the ranges, (n,); 1 inside all."""
    return np.max([data_range.factor(q) for data_range in ranges], axis=0)


def is_outside(ranges: Iterable[DataRange], q: Quantities) -> Any:
    """Return whether each of n armours lies outside any of the ranges, (n,)."""
    return np.any([data_range.excludes(q) for data_range in ranges], axis=0)


def outside(ranges: Iterable[DataRange], q: Quantities) -> tuple[str, ...]:
    """Describe each of the ranges outside which an armour, or any of n, lies."""
    return tuple(str(data_range) for data_range in ranges if data_range.excludes(q).any())


# Attributes of `Evidence` that configs/evidence.toml gives under their own names.
AS_GIVEN = ("title", "source", "ceramic", "metal", "projectile", "obliquity_max_deg", "at_least_deg", "at_least")


def _ranges(data: Mapping[str, Sequence[float]]) -> tuple[DataRange, ...]:
    """Return the ranges of quantities, given their ends by name."""
    return tuple(DataRange(name, *ends) for name, ends in data.items())


def _thicknesses(ranges: Iterable[DataRange]) -> tuple[DataRange, ...]:
    """Return those of the ranges that are of thicknesses of the layers."""
    return tuple(data_range for data_range in ranges if data_range.name in THICKNESSES)


@cache
def shipped_evidence() -> tuple[Evidence, ...]:
    """Return the shipped tests, by kind of armour; of several equally close to an armour, the first is used."""
    tests = []
    for data in shipped_data()["tests"]:
        kind, laws = data["kind"], shipped_data()["law"]
        # The mass ratio follows from slenderness and density, which have ranges of their own.
        compared = kind | {k: v for k, v in data.get("computed", data["measured"]).items() if k != "rod_mass_ratio"}
        whole = Evidence(
            laws=tuple(_ranges(laws[fit]) for fit in data["fits"] if fit in laws),
            kind=_ranges(kind),
            measured=_ranges(data["measured"]),
            compared=_ranges(compared),
            thicknesses=_thicknesses(_ranges(data["measured"])),
            fits=tuple(fits()[name]._replace(weight=1.0 / len(data["fits"])) for name in data["fits"]),
            **{key: data[key] for key in AS_GIVEN if key in data},
        )
        if "tensile_fit" in data:
            ratio = DataRange("tensile_ratio", *data["tensile_ratio"])
            tests.append(whole._replace(kind=(*whole.kind, ratio), fits=(fits()[data["tensile_fit"]],)))
        tests.append(whole)
    return tuple(tests)


def tests_of_tiles() -> Evidence:
    """Return the shipped tests of armour with a ceramic, whose kind begins with the ranges of `OF_CERAMIC`."""
    return next(evidence for evidence in shipped_evidence() if evidence.ceramic)


def nearest_shipped(q: Quantities) -> Any:
    """Return the index in `shipped_evidence` of the tests whose kind each of n armours differs least from, (n,)."""
    return np.argmin([evidence.differences(q) for evidence in shipped_evidence()], axis=0)


class Materials(NamedTuple):
    """Entries of the library in an armour; a ceramic only if the scenario names one."""

    ceramic: LibraryEntry | None
    backing: LibraryEntry


class _Rows(NamedTuple):
    """Columns of `Armours`, which adds the methods: a named tuple cannot have cached properties."""

    parameters: Parameters  # of the core, arrays, (n,)
    cosines: Any  # of the obliquities, (n,)
    material_of_row: Any  # index of the materials of each armour, (n,)
    materials: Sequence[Materials]


class Armours(_Rows):
    """n armours with their projectiles, as arrays: parameters of the core in SI units, and the materials.

    Thicknesses in `parameters` are along the line of fire.
    """

    def at(self, where: Any) -> "Armours":
        """Return some of the armours, given their indices or a mask."""
        parameters = Parameters._make(np.asarray(values)[where] for values in self.parameters)
        return Armours(parameters, self.cosines[where], self.material_of_row[where], self.materials)

    def at_normal_incidence(self) -> "Armours":
        """Return the same armours, hit at normal incidence instead of at their angles."""
        parameters, cosines = self.parameters, self.cosines
        parameters = parameters._replace(Hc0=parameters.Hc0 * cosines, Hb=parameters.Hb * cosines)
        return self._replace(parameters=parameters, cosines=np.ones_like(cosines))

    def with_law(self, values: Mapping[str, Any]) -> "Armours":
        """Return the armours with other parameters of the core, such as those of a law, by name, in SI units."""
        columns: dict[str, Any] = {name: np.full(len(self.cosines), value) for name, value in values.items()}
        return self._replace(parameters=self.parameters._replace(**columns))

    def quantities(self) -> dict[str, Any]:
        """Return the quantities that the evidence depends on, (n,) by name; see `armour.evidence.fit.quantities`."""
        tensile = np.array([tensile_strength(materials.backing) for materials in self.materials])
        return quantities(self.parameters, tensile[self.material_of_row], self.cosines)

    @cached_property
    def by_evidence(self) -> list[tuple[Evidence, Any]]:
        """Each evidence with a mask of the armours that it applies to, (n,).

        The evidence on an armour is the own tests of its ceramic or its bare plate, or else the closest shipped tests.
        """
        found, is_bare, has_shipped = [], self.parameters.Hc0 == 0.0, np.ones(len(self.material_of_row), dtype=bool)
        for place, materials in enumerate(self.materials):
            for entry, has_kind in ((materials.ceramic, ~is_bare), (materials.backing, is_bare)):
                rows = (self.material_of_row == place) & has_kind
                if entry is not None and entry.evidence is not None and rows.any():
                    has_shipped = has_shipped & ~rows
                    found.append((own_evidence(entry, entry.evidence), rows))
        q = self.quantities()
        nearest = nearest_shipped(q)
        for place, evidence in enumerate(shipped_evidence()):
            if (rows := has_shipped & (nearest == place)).any():
                found.append((evidence, rows))
        return found


def materials_of(scenario: Scenario) -> Materials:
    """Return the entries of the library in the armour of a scenario."""
    return Materials(scenario.entry_of("ceramic"), scenario.entry("metal", scenario.armour.backing))


def armours_of(*scenarios: Scenario) -> Armours:
    """Return the armours of n scenarios with the same materials."""
    parameters = Parameters._make(np.array([scenario.core_armour() for scenario in scenarios]).T)
    cosines = np.array([scenario.cosine() for scenario in scenarios])
    return Armours(parameters, cosines, np.zeros(len(scenarios), dtype=np.int64), [materials_of(scenarios[0])])


def own_evidence(entry: LibraryEntry, own_tests: OwnTests) -> Evidence:
    """Return the evidence on an entry of the library that has own tests: the shipped tests, updated by the own ones.

    It holds for armours with the values that were calibrated to the own tests.  It has no fits, and the reason as its
    source, if the own tests cannot tell the error or the entry must be calibrated again.
    """
    if not own_tests.law:
        reason = own_tests.reason or "no limit of its own tests says how exact the model is"
        return Evidence(source=reason, lot=entry.name)
    from scipy.special import softmax  # slow to import

    tested = {name: np.array(column) for name, column in own_tests.tests.items()}
    tested["tensile_MPa"] = np.full(len(tested["side"]), tensile_strength(entry))
    # The shipped tests that have the fits which the own tests update.
    shipped = next(each for each in shipped_evidence() if own_tests.law[0].fit in [fit.name for fit in each.fits])
    by_law = list(_by_law(own_tests, tested, "ceramic" if shipped.ceramic else "backing"))
    distances = np.min([_deviations_from_lots(fit, tests, offset) for fit, tests, offset in by_law], axis=0)
    if (distances > IMPLAUSIBLE).any():
        doubtful = np.flatnonzero(distances > IMPLAUSIBLE)
        reason = "a measured limit is impossible for any lot of such armour; check it, its unit and the armour"
        return Evidence(source=reason, lot=entry.name, doubtful=tuple(doubtful.tolist()))
    is_strange = is_outside(_kind_without_calibrated(shipped, own_tests), tested).any()
    between_lots = STRANGE_METAL if is_strange else STRANGE * bool(shipped.ceramic)
    fits_of_lot = [(fit.of_lot(between_lots, offset), tests) for fit, tests, offset in by_law]
    updated = [fit.given(tests) for fit, tests in fits_of_lot]
    weights = softmax([fit.weight for fit in updated])
    velocities, doubtful = tested["velocity_m_s"], np.zeros(0, dtype=np.int64)
    if len(velocities) > 1:  # a single test that is far off may just be of another lot
        farther = [fit.probabilities_of_farther(tests) for fit, tests in fits_of_lot]
        doubtful = np.flatnonzero(np.max(farther, axis=0) * len(velocities) < FALSE_ALARMS)
    words = f"{counted(len(velocities), 'own test')} of this lot"
    words += f" ({len(doubtful)} out of line)" * bool(len(doubtful))
    words += ", for another laboratory or series" * ("series" in tested)
    is_new = own_tests.law[0].level is not None
    kind, measured = _ranges_with_own_tests(own_tests, tested, shipped, is_new=is_new)
    return shipped._replace(
        title=f"{words}, taken to scatter like {shipped.title}" if is_new else f"{shipped.title} and {words}",
        laws=(),
        kind=kind,
        measured=measured,
        thicknesses=_thicknesses(measured) if is_new else shipped.thicknesses,
        fits=tuple(fit._replace(weight=w) for fit, w in zip(updated, weights, strict=True)),
        obliquity_max_deg=max(shipped.obliquity_max_deg, *np.degrees(np.arccos(1.0 / tested["path_ratio"]))),
        lot=own_tests.lot or entry.name,
        doubtful=tuple(doubtful.tolist()),
    )


def _kind_without_calibrated(shipped: Evidence, own_tests: OwnTests) -> tuple[DataRange, ...]:
    """Return the ranges that define the kind of the shipped tests, without those of calibrated quantities."""
    return tuple(each for each in shipped.kind if each.name not in ("tensile_ratio", *own_tests.calibrated))


def _ranges_with_own_tests(
    own_tests: OwnTests, tested: Mapping[str, Any], shipped: Evidence, *, is_new: bool
) -> tuple[tuple[DataRange, ...], tuple[DataRange, ...]]:
    """Return the ranges that define the kind of armour for which own tests of a lot hold, and those of the tests.

    Both are those of the shipped tests, widened to contain the own tests, whose quantities `tested` has by name.  If
    `is_new`, there are no shipped tests of the ceramic, and the armour must be like that of the own tests.
    """
    columns = {name: np.append(column, own_tests.calibrated.get(name, [])) for name, column in tested.items()}
    both = _kind_without_calibrated(shipped, own_tests), shipped.measured
    kind, measured = (tuple(each.containing(columns[each.name]) for each in ranges) for ranges in both)
    if is_new:
        around = [DataRange(name, np.inf, -np.inf).containing(tested[name]) for name in (*VARIED[:2], *IN_COMMON)]
        alike = (DataRange(each.name, each.low / ALIKE_FACTOR, each.high * ALIKE_FACTOR) for each in around[2:])
        kind = (*alike, *(each for each in kind if each.name.startswith("rod_")))
        measured = (*around[:2], *(each for each in measured if each.name.startswith("rod_")))
    calibrated = (DataRange(n, v - ROUNDING * abs(v), v + ROUNDING * abs(v)) for n, v in own_tests.calibrated.items())
    # Beyond the angles of the shipped tests, own tests hold for their own angle only.
    paths = DataRange("path_ratio", np.inf, -np.inf).containing(tested["path_ratio"])
    at_angle = (paths,) * (cosine_of(shipped.obliquity_max_deg) * paths.high > 1.0 + 2.0 * ROUNDING)
    return (*kind, *calibrated, *at_angle), measured


def _by_law(
    own_tests: OwnTests, tested: Mapping[str, Any], role: str
) -> Iterator[tuple[Fit, LotTests, Sequence[float] | None]]:
    """Yield, for each law of the flow stress, the shipped fit, the own tests compared by it, and the offset of the lot.

    The tests have the logarithms of the measured over the limits that this law gives.  The offset is the mean and the
    standard deviation of what the whole lot deviates by; None for a lot that the fit covers.
    `tested` has the quantities of the tests by name; `role` is that of the material, "ceramic" or "backing".
    """
    velocities, sides = tested["velocity_m_s"], tested["side"]
    rows = np.column_stack([tested[name] for name in (*VARIED, *IN_COMMON)])
    # Shots at equal armours count as shots at one armour; each measured limit belongs to an armour of its own.
    armours = np.where(sides == 0.0, -1.0 - np.arange(len(rows)), np.unique(rows, axis=0, return_inverse=True)[1])
    for law in own_tests.law:
        fit = fits()[law.fit]._replace(law=law_parameters(role, law.values))
        errors = np.log(velocities / np.array(law.computed_m_s))
        yield fit, LotTests(tested, errors, sides, tested["uncertainty_m_s"] / velocities, armours), law.level


def _deviations_from_lots(fit: Fit, tests: LotTests, offset: Sequence[float] | None) -> Any:
    """Return by how many standard deviations own tests differ from the prediction for any lot, (n,).

    The deviation of a shot is negative if its outcome is as predicted.
    """
    location, scale, _ = fit.predicted(tests.quantities, {})
    mean, deviation = offset or (0.0, 0.0)
    errors = tests.errors - location - mean
    return np.where(tests.sides == 0.0, abs(errors), tests.sides * errors) / np.hypot(scale, deviation)


def is_untested(ceramic: LibraryEntry) -> bool:
    """Return whether no test of a ceramic on metal is known: no own one, and no shipped one of such a ceramic."""
    values = np.array([ceramic["density_kg_m3"], ceramic["youngs_modulus_GPa"]])
    q = dict(zip(OF_CERAMIC[:2], values, strict=True))
    return ceramic.evidence is None and bool(is_outside(tests_of_tiles().kind[:2], q))


def lacks_sources(ceramic: LibraryEntry) -> bool:
    """Return whether neither tests nor enough sources give the flow stress of a ceramic.

    Own tests count for the values that were calibrated to them, and shipped tests for their laws of the flow stress; of
    a tested ceramic, another flow stress needs a source.
    """
    if ceramic.sources >= LEAST_SOURCES:
        return False
    numbers = (ceramic[key] if key in ceramic.values else 0.0 for key in (FLOW_STRESS_KEY, *FLOW_STRESS_LAW))
    strength, in_backing, in_product, *slopes = numbers
    values = np.array([strength, in_backing, in_product, sum(map(abs, slopes))])
    q = dict(zip((OF_CERAMIC[2], "backing_exponent", "product_exponent", "slopes"), values, strict=True))
    if ceramic.evidence is not None:
        calibrated = ceramic.evidence.calibrated
        return any(abs(q[name] - calibrated[name]) > ROUNDING * abs(calibrated[name]) for name in {*q} & {*calibrated})
    if ceramic.sources or is_untested(ceramic):
        return is_untested(ceramic)
    tiles = tests_of_tiles()
    return all(is_outside((tiles.kind[2], *law), q) for law in tiles.laws)


def is_unusual(armour: Parameters) -> Any:
    """Return whether each of n armours is unlike all those, bare or with ceramic, that the model was compared with.

    A strength, density, slenderness or thickness over the diameter is then more than a factor of two outside every
    range compared.  The outcome of such an armour may change more than once with the velocity or a thickness.  A NaN
    counts as inside.
    """
    q = quantities(armour, np.nan, np.ones(np.shape(armour.D0)))
    is_far: dict[tuple[bool, str], Any] = {}
    ranges = {(bool(each.ceramic), compared) for each in shipped_evidence() for compared in each.compared}
    for has_ceramic, data_range in ranges:
        key = has_ceramic, data_range.name
        is_far[key] = is_far.get(key, True) & (data_range.factor(q) > UNUSUAL_FACTOR)
    return np.any([far & (has_ceramic == (armour.Hc0 > 0.0)) for (has_ceramic, _), far in is_far.items()], axis=0)


class Far(NamedTuple):
    """One thing in which an armour or a threat is far from the tests, in words."""

    found: str  # such as "12 mm tile"
    tested: str = ""  # what was tested instead, such as "tested 5.8 to 7.9 mm"

    def __str__(self) -> str:
        return f"{self.found} ({self.tested})" if self.tested else self.found


def far_from_tests(scenario: Scenario, armours: Armours) -> tuple[Far, ...]:
    """Return in what the armour of a scenario is far from the tests; `armours` has it as its only row.

    A material or a projectile counts if another one was tested, any other quantity if it is more than 10 % outside the
    range of the tests, which is shown to 0.1 mm.
    """
    p, cosines = armours.parameters, armours.cosines
    sizes_mm = ((thickness * cosines).item() / MM for thickness in (p.Hc0, p.Hb))
    return what_was_tested(scenario.impact, armours).far_of(armours.materials[0].ceramic, *sizes_mm)


class Tested(NamedTuple):
    """What was tested of armours like one, to tell in what designs of the same materials are far from it."""

    thicknesses_mm: dict[str, tuple[float, float]]  # least and greatest, by layer, "tile" or "plate"
    others: tuple[Far, ...]  # in what else but the thicknesses the armour is far from that
    of_round: str  # added to the thicknesses if they were tested with other rounds

    def far_of(self, ceramic: LibraryEntry | None, tile_mm: float, plate_mm: float) -> tuple[Far, ...]:
        """Return in what an armour with this ceramic and these thicknesses, mm, is far from the tests."""
        found = [Far(ceramic.name, "no test")] if ceramic is not None and tile_mm and is_untested(ceramic) else []
        found += filter(None, map(self.far, LAYERS.values(), (tile_mm, plate_mm)))
        return (*found, *self.others)

    def far(self, layer: str, size_mm: float) -> Far | None:
        """Return the thickness of a layer, "tile" or "plate", and the range tested; None if it is not far from that."""
        low, high = self.thicknesses_mm.get(layer, (0.0, np.inf))
        if not size_mm or low / FAR <= size_mm <= high * FAR:
            return None
        tested = " to ".join(dict.fromkeys(f"{round(end, 1):g}" for end in (low, high)))
        return Far(f"{size_mm:.4g} mm {layer}", f"tested {tested} mm{self.of_round}")


def what_was_tested(impact: Impact, armours: Armours) -> Tested:
    """Return what was tested of armours like one, the only row of `armours`, against an impact.

    That its ceramic was not tested is left out.
    """
    [(evidence, _)] = armours.by_evidence
    q = armours.quantities()
    evidence = evidence if evidence.fits else shipped_evidence()[nearest_shipped(q)[0]]
    ranges = [*evidence.kind, *evidence.measured]
    fired = bool(evidence.lot) and same_rods(q, evidence.fits[0].own[0].tests.quantities).any()
    diameter_mm = float((armours.parameters.D0 * armours.cosines).item()) / MM
    roles = {each.name.partition("_")[0] for each in ranges if each.name not in LAYERS and each.factor(q)[0] > FAR}
    thicknesses_mm = {LAYERS[r.name]: (r.low * diameter_mm, r.high * diameter_mm) for r in ranges if r.name in LAYERS}
    others = []
    with_it = "own tests with another round" if evidence.lot else f"tested with {evidence.projectile}"
    for name, tested, role, words, own in (
        (armours.materials[0].backing.name, evidence.metal, "backing", f"tested on {evidence.metal}", evidence.lot),
        (impact.projectile, evidence.projectile, "rod", with_it, fired),
    ):
        if (not own and tested != name) if tested else role in roles:
            others.append(Far(name, words if tested else "no test"))
    if evidence.excludes_angle(armours.cosines)[0]:
        others.append(Far(f"{impact.obliquity_deg:g}°", f"tested to {evidence.obliquity_max_deg:g}°"))
    scaled = ", scaled to this round" * (not fired and evidence.projectile != impact.projectile)
    return Tested(thicknesses_mm, tuple(others), scaled)


def contradicted(armours: Armours) -> Iterator[tuple[Note, Any]]:
    """Yield caveats where tests contradict the limits of n armours or their probabilities, and no own tests tell.

    Each comes with a mask of the armours that it is about, (n,).
    """
    q = armours.quantities()
    for name, data in shipped_data()["caveat"].items():
        rows = ~is_outside(_ranges(data["ranges"]), q) & ~is_no_metal(armours.parameters.rho_B)
        if rows.any():
            for evidence, members in armours.by_evidence:
                if evidence.lot and evidence.fits:
                    rows[members] &= evidence.differences(armours.at(members).quantities()) > 0
        if rows.any():
            yield Note(data["words"], data["key"], said="caveat", about=("contradicted", name)), rows


def limits_of_model(armours: Armours, metals: Iterable[LibraryEntry]) -> Iterator[tuple[Note, Any]]:
    """Yield all caveats about n armours: by changed equations, by `caveats` and by `contradicted`; masks as there."""
    if changed := changed_equations():
        note = Note(f"computed with {changed}", said="caveat", about=("equations", changed))
        yield note, np.ones(len(armours.cosines), dtype=bool)
    yield from caveats(armours.parameters, metals)
    yield from contradicted(armours)


def scenario_warnings(scenario: Scenario, armours: Armours | None = None, *, said: bool = False) -> tuple[Note, ...]:
    """Return the caveats about the armour of a scenario, and warnings of unused threats and doubtful strengths.

    `armours` has the scenario's armour as its only row, if it is known already; `said` tells whether the answer itself
    contains the caveats, so that they are not said again.
    """
    armours = armours or armours_of(scenario)
    metals = [armours.materials[0].backing]
    cannot = (note for note, _ in limits_of_model(armours, metals))
    strengths = strength_notes(metals, bare=not scenario.armour.ceramic_thickness_mm)
    return (*(note if said else replace(note, said="") for note in cannot), *scenario.unused_threats(), *strengths)


def against_each(
    titles: Sequence[str], by_threat: Iterable[Iterable[tuple[Note, Any]]]
) -> Iterator[tuple[Note, list[Any]]]:
    """Yield each caveat on armours against several threats once, with its masks, one for each threat that it is about.

    `by_threat` has, for each of the threats in `titles`, the caveats with their masks.  One that is not about all
    threats, such as one with other numbers for another threat, names its own.
    """
    found: dict[tuple[str | float, ...], list[tuple[int, Note, Any]]] = {}
    for place, caveats_against in enumerate(by_threat):
        for note, mask in caveats_against:
            found.setdefault(note.about, []).append((place, note, mask))
    for each in found.values():
        places, notes, masks = zip(*each, strict=True)
        threats = f" against {joined([titles[place] for place in places])}" if len(places) < len(titles) else ""
        yield notes[0].against(threats), list(masks)


def threat_warnings(scenario: Scenario, armours: Armours) -> Iterator[Note]:
    """Yield the caveats about an armour and the threats of a scenario, and the doubtful strength of its metal.

    `armours` has a row of the armour against each threat.  A caveat that is not about all threats names its threats.
    """
    threats = scenario.threats()
    titles, backings = [threat.title for threat in threats], [materials.backing for materials in armours.materials]
    each = [armours] if len(threats) == 1 else [armours.at([place]) for place in range(len(threats))]
    by_threat = (limits_of_model(armour, backings) for armour in each)
    yield from (note for note, _ in against_each(titles, by_threat))
    own = armours.materials[armours.material_of_row[0]].backing
    yield from strength_notes([own], bare=bool(np.all(armours.parameters.Hc0 == 0.0)))
