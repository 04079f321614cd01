"""The tests that the model was compared with, shipped or the user's own, and where an armour lies outside them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from math import log
from typing import Any, NamedTuple

import numpy as np

from armour.core.state import Parameters
from armour.errors import Note, counted, joined
from armour.evidence.caveats import caveats, is_no_metal, too_thin
from armour.evidence.core_digest import changed_equations
from armour.evidence.fit import (
    Fit,
    LotTests,
    Quantities,
    fits,
    law_parameters,
    quantities,
    same_rods,
    shipped_data,
)
from armour.scenario.inputs import CERAMIC, OBLIQUITY, VELOCITY, cosine_of
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
from armour.units import MM

# Quantity for which the answer itself says that the armour is below the tests.
THIN = "ceramic_thickness_ratio"
# Kind of the caveat on a ceramic that is too thin.
TOO_THIN = "too thin"
# Factor by which a quantity of an unusual armour lies outside of all that the model was compared with.
UNUSUAL_FACTOR = 2.0
# Factors outside the ranges of the tests beyond which the error is not known: of bare plates and with a ceramic.
FARTHEST_BARE, FARTHEST_CERAMIC = float(np.exp(0.5)), 2.0
# Factor by which an armour may differ from own tests of a ceramic without shipped tests, in the quantities that these
# tests have in common.
ALIKE_FACTOR = 1.1
# Additional standard deviations between lots, beyond that of the shipped tests: with a ceramic, and for armours unlike
# the shipped tests, as on another metal.
STRANGE, STRANGE_METAL = 0.10, 0.15
# Thicknesses of the layers, in diameters of the penetrator; and by how much the greatest probability of stopping that
# is stated falls where the logarithm of a thickness over the nearest tested one grows by 1.
THICKNESSES = (THIN, "backing_thickness_ratio")
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
OF_NO_LOT = "an own test has a limit that no lot of such armour can have"
NO_LAW = "no limit of its own tests says how exact the model is"
# Number of differences that a ceramic instead of none counts for, more than all others together; relative size of
# rounding errors.
BY_CERAMIC, ROUNDING = 1000, 1e-6


class DataRange(NamedTuple):
    """Range of a quantity within which the model was tested."""

    name: str
    low: float
    high: float

    def fails(self, q: Quantities) -> Any:
        """Return whether each of n armours lies outside the range."""
        return ~((q[self.name] >= self.low) & (q[self.name] <= self.high))

    def factor(self, q: Quantities) -> Any:
        """Return the factor by which n armours are outside the range, at least 1; infinite if value or end is 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.fmax(np.fmax(q[self.name] / self.high, self.low / q[self.name]), 1.0)

    def ratio(self, q: Quantities) -> Any:
        """Return the values of n armours, each over the nearest value in the range: 1 inside it and for a NaN."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.nan_to_num(q[self.name] / q[self.name].clip(self.low, self.high), nan=1.0, posinf=np.inf)

    def log_ratio(self, q: Quantities) -> Any:
        """Return the logarithms of these ratios."""
        with np.errstate(divide="ignore"):
            return np.log(self.ratio(q))

    def joined(self, low: float, high: float) -> "DataRange":
        """Return the range widened to contain `low` and `high`."""
        return DataRange(self.name, min(self.low, float(low)), max(self.high, float(high)))

    def containing(self, values: Any) -> "DataRange":
        """Return the range widened to contain further values, with a margin for rounding."""
        return self.joined(values.min() * (1.0 - ROUNDING), values.max() * (1.0 + ROUNDING))

    @property
    def key(self) -> str:
        """Key of the scenario that the quantity depends on."""
        return str(shipped_data()["quantity"][self.name]["key"])

    def __str__(self) -> str:
        return self.words(self.ends())

    def ends(self) -> str:
        """Return the ends of the range, or its only value, as text."""
        return " to ".join(dict.fromkeys(f"{end:.4g}" for end in (self.low, self.high)))

    def words(self, values: str) -> str:
        """Return the words that describe the quantity with given values."""
        return str(shipped_data()["quantity"][self.name]["words"]).format(values)


class Evidence(NamedTuple):
    """Tests of a kind of armour against a kind of penetrator, and the error of the ballistic limit on them.

    The error applies to armours of the kind, and is extrapolated outside the ranges of the tests.
    """

    title: str = ""
    source: str = ""  # its key of the bibliography is in brackets
    laws: tuple[tuple[DataRange, ...], ...] = ()  # of the ceramic's flow stress, each as ranges of its parameters
    kind: tuple[DataRange, ...] = ()  # ranges that define the kind of armour and penetrator
    measured: tuple[DataRange, ...] = ()  # ranges of the tests
    compared: tuple[DataRange, ...] = ()  # outside these, an armour is unlike all that the model was compared with
    velocities: DataRange = DataRange("velocity_m_s", 0.0, np.inf)
    fits: tuple[Fit, ...] = ()  # of the model error, one for each law; none if these are results of the paper's program
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
        """Return in how many respects n armours differ from the tests; a ceramic instead of none outweighs the rest."""
        by_ceramic = BY_CERAMIC * (bool(self.ceramic) == (q["ceramic_thickness_ratio"] == 0.0))
        return sum((data_range.fails(q) for data_range in self.kind), start=by_ceramic) + self.has_other_law(q)

    def has_other_law(self, q: Quantities) -> Any:
        """Return whether the flow stress of the ceramic of n armours has none of the laws."""
        return np.all([is_outside(law, q) for law in self.laws], axis=0) if self.laws else q["path_ratio"] < 0.0

    def holds(self, q: Quantities) -> Any:
        """Return whether the error is known for n armours: they are of the kind, and near enough to the tests."""
        farthest = FARTHEST_CERAMIC if self.ceramic else FARTHEST_BARE
        factor = np.maximum.reduce([data_range.factor(q) for data_range in self.measured])
        return (self.differences(q) == 0) & (factor <= farthest) & bool(self.fits)

    def fails_angle(self, cosines: Any) -> Any:
        """Return whether angles, given their cosines, are beyond those of the tests."""
        return cosines < cosine_of(self.obliquity_max_deg) * (1.0 - ROUNDING)

    def angles(self) -> str:
        """Describe the angles of the tests."""
        if self.obliquity_max_deg:
            return f"tests of such plates at up to {max(self.obliquity_max_deg, self.at_least_deg):g}° only"
        return f"no test of {'an armour with a ceramic' if self.ceramic else 'such a plate'} at an angle"


def greatest_probability(evidence: Evidence, q: Quantities) -> Any:
    """Return the greatest probability of stopping that tests allow to state for n armours, (n,).

    It falls with the distance from the tests: the greater logarithm of the factors by which the layers are thicker or
    thinner than tested ones, in diameters of the penetrator.  Own tests count for the round that they were fired with.
    """
    distance = np.max([abs(data_range.log_ratio(q)) for data_range in evidence.thicknesses], axis=0)
    if evidence.lot:
        tested = evidence.fits[0].own[0].tests.quantities
        same = same_rods(q, tested)
        own = [
            DataRange(
                data_range.name,
                np.where(same, tested[data_range.name], np.inf).min(axis=1) * (1.0 - ROUNDING),
                np.where(same, tested[data_range.name], 0.0).max(axis=1) * (1.0 + ROUNDING),
            )
            for data_range in evidence.thicknesses
        ]
        by_own = np.max([abs(data_range.log_ratio(q)) for data_range in own], axis=0)
        distance = np.where(same.any(axis=1), np.minimum(distance, by_own), distance)
    return (1.0 - FALL * distance).clip(min=0.0)


def is_outside(ranges: Iterable[DataRange], q: Quantities) -> Any:
    """Return whether each of n armours lies outside any of the ranges."""
    return np.any([data_range.fails(q) for data_range in ranges], axis=0)


def outside(ranges: Iterable[DataRange], q: Quantities) -> tuple[str, ...]:
    """Describe those of the ranges outside which an armour lies."""
    return tuple(str(data_range) for data_range in ranges if data_range.fails(q).any())


AS_GIVEN = ("title", "source", "ceramic", "metal", "projectile", "obliquity_max_deg", "at_least_deg", "at_least")


def _ranges(data: Mapping[str, Sequence[float]]) -> tuple[DataRange, ...]:
    """Return the ranges of quantities, given their ends by name."""
    return tuple(DataRange(name, *ends) for name, ends in data.items())


def _thicknesses(ranges: Iterable[DataRange]) -> tuple[DataRange, ...]:
    """Return those of the ranges that are of thicknesses of the layers."""
    return tuple(data_range for data_range in ranges if data_range.name in THICKNESSES)


@cache
def shipped_evidence() -> tuple[Evidence, ...]:
    """Return the shipped tests; if several are equally close to an armour, the first of them is used."""
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
            velocities=DataRange("velocity_m_s", *data["velocities_m_s"]),
            fits=tuple(fits()[name]._replace(weight=1.0 / len(data["fits"])) for name in data["fits"]),
            **{key: data[key] for key in AS_GIVEN if key in data},
        )
        if "tensile_fit" in data:
            ratio = DataRange("tensile_ratio", *data["tensile_ratio"])
            tests.append(whole._replace(kind=(*whole.kind, ratio), fits=(fits()[data["tensile_fit"]],)))
        tests.append(whole)
    return tuple(tests)


def shipped_evidence_of(fit: str) -> Evidence:
    """Return the tests that a fit is based on."""
    return next(tests for tests in shipped_evidence() if fit in [shipped_fit.name for shipped_fit in tests.fits])


class Materials(NamedTuple):
    """Entries of the library in an armour."""

    ceramic: LibraryEntry | None
    backing: LibraryEntry


class _Rows(NamedTuple):
    parameters: Parameters  # of the core, arrays, (n,)
    cosines: Any  # of the obliquities, (n,)
    material_of_row: Any  # index of the materials of each armour, (n,)
    materials: Sequence[Materials]


class Armours(_Rows):
    """n armours with their projectiles."""

    def at(self, where: Any) -> "Armours":
        """Return some of the armours, given their indices or a mask."""
        parameters = Parameters._make(np.asarray(values)[where] for values in self.parameters)
        return Armours(parameters, self.cosines[where], self.material_of_row[where], self.materials)

    def at_normal_incidence(self) -> "Armours":
        """Return the armours with the thicknesses of their layers in place of those along the line of fire."""
        parameters, cosines = self.parameters, self.cosines
        parameters = parameters._replace(Hc0=parameters.Hc0 * cosines, Hb=parameters.Hb * cosines)
        return self._replace(parameters=parameters, cosines=np.ones_like(cosines))

    def with_law(self, values: Mapping[str, Any]) -> "Armours":
        """Return the armours with other parameters of the core, such as those of a law, by name, in SI units."""
        columns: dict[str, Any] = {name: np.full(len(self.cosines), value) for name, value in values.items()}
        return self._replace(parameters=self.parameters._replace(**columns))

    def quantities(self) -> dict[str, Any]:
        """Return the quantities that the evidence depends on, (n,) by name."""
        tensile = np.array([tensile_strength(materials.backing) for materials in self.materials])
        return quantities(self.parameters, tensile[self.material_of_row], self.cosines)

    def by_evidence(self) -> Sequence[tuple[Evidence, Any]]:
        """Return each evidence with a mask of the armours that it applies to, (n,); it is looked up once.

        The evidence on an armour is the own tests of its ceramic or its bare plate, or else the closest shipped tests.
        """
        return self._by_evidence

    @cached_property
    def _by_evidence(self) -> list[tuple[Evidence, Any]]:
        found, is_bare, has_shipped = [], self.parameters.Hc0 == 0.0, np.ones(len(self.material_of_row), dtype=bool)
        for place, materials in enumerate(self.materials):
            for entry, has_kind in ((materials.ceramic, ~is_bare), (materials.backing, is_bare)):
                rows = (self.material_of_row == place) & has_kind
                if entry is not None and entry.evidence is not None and rows.any():
                    has_shipped = has_shipped & ~rows
                    found.append((own_evidence(entry, entry.evidence), rows))
        q = self.quantities()
        nearest = np.argmin([evidence.differences(q) for evidence in shipped_evidence()], axis=0)
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
    """Return the evidence on an entry of the library with own tests: the shipped tests, updated by the own ones.

    It holds for armours with the calibrated values.  It has no fit if the entry must be calibrated again.
    """
    if not own_tests.law:
        return Evidence(source=own_tests.reason or NO_LAW, lot=entry.name)
    from scipy.special import softmax  # slow to import

    tested = {name: np.array(column) for name, column in own_tests.tests.items()}
    tested["tensile_MPa"] = np.full(len(tested["side"]), tensile_strength(entry))
    shipped = shipped_evidence_of(own_tests.law[0].fit)
    by_law = list(_by_law(own_tests, tested, "ceramic" if shipped.ceramic else "backing"))
    distances = np.min([_distances(fit, tests, level) for fit, tests, level in by_law], axis=0)
    if (distances > IMPLAUSIBLE).any():
        doubtful = np.flatnonzero(distances > IMPLAUSIBLE)
        return Evidence(source=OF_NO_LOT, lot=entry.name, doubtful=tuple(doubtful.tolist()))
    is_strange = is_outside(_kept_kind(shipped, own_tests), tested).any()
    between_lots = STRANGE_METAL if is_strange else STRANGE * bool(shipped.ceramic)
    lots = [(fit.of_lot(between_lots, level), tests) for fit, tests, level in by_law]
    updated = [lot.given(tests) for lot, tests in lots]
    weights = softmax([fit.weight for fit in updated])
    velocities, doubtful = tested["velocity_m_s"], np.zeros(0, dtype=np.int64)
    if len(velocities) > 1:  # a single test that is far off may just be of another lot
        farther = [lot.probabilities_of_farther(tests) for lot, tests in lots]
        doubtful = np.flatnonzero(np.max(farther, axis=0) * len(velocities) < FALSE_ALARMS)
    words = f"{counted(len(velocities), 'own test')} of this lot"
    words += f" ({len(doubtful)} out of line)" * bool(len(doubtful))
    words += ", for another laboratory or series" * ("series" in tested)
    is_new = own_tests.law[0].level is not None
    kind, measured = _ranges_with(own_tests, tested, shipped, is_new=is_new)
    return shipped._replace(
        title=f"{words}, taken to scatter like {shipped.title}" if is_new else f"{shipped.title} and {words}",
        laws=(),
        kind=kind,
        measured=measured,
        thicknesses=_thicknesses(measured) if is_new else shipped.thicknesses,
        compared=(*kind, *measured),
        velocities=shipped.velocities.joined(velocities.min(), velocities.max()),
        fits=tuple(fit._replace(weight=w) for fit, w in zip(updated, weights, strict=True)),
        obliquity_max_deg=max(shipped.obliquity_max_deg, *np.degrees(np.arccos(1.0 / tested["path_ratio"]))),
        lot=own_tests.lot or entry.name,
        doubtful=tuple(doubtful.tolist()),
    )


def _kept_kind(shipped: Evidence, own_tests: OwnTests) -> tuple[DataRange, ...]:
    """Return the kind of armour of the shipped tests, without the ranges of calibrated quantities."""
    return tuple(
        data_range for data_range in shipped.kind if data_range.name not in ("tensile_ratio", *own_tests.calibrated)
    )


def _ranges_with(
    own_tests: OwnTests, tested: Mapping[str, Any], shipped: Evidence, *, is_new: bool
) -> tuple[tuple[DataRange, ...], tuple[DataRange, ...]]:
    """Return the kind of armour for which own tests of a lot hold, and the ranges of the tests.

    Both are those of the shipped tests, widened to contain the own tests, whose quantities `tested` has by name.  If
    `is_new`, there are no shipped tests of the ceramic, and the armour must be like that of the own tests.
    """
    columns = {name: np.append(column, own_tests.calibrated.get(name, [])) for name, column in tested.items()}
    kind, measured = (
        tuple(data_range.containing(columns[data_range.name]) for data_range in ranges)
        for ranges in (_kept_kind(shipped, own_tests), shipped.measured)
    )
    if is_new:
        around = [DataRange(name, np.inf, -np.inf).containing(tested[name]) for name in (*VARIED[:2], *IN_COMMON)]
        alike = (
            DataRange(data_range.name, data_range.low / ALIKE_FACTOR, data_range.high * ALIKE_FACTOR)
            for data_range in around[2:]
        )
        kind = (*alike, *(data_range for data_range in kind if data_range.name.startswith("rod_")))
        measured = (*around[:2], *(data_range for data_range in measured if data_range.name.startswith("rod_")))
    calibrated = (DataRange(n, v - ROUNDING * abs(v), v + ROUNDING * abs(v)) for n, v in own_tests.calibrated.items())
    # Beyond the angles of the shipped tests, own tests hold for their own angle only.
    paths = DataRange("path_ratio", np.inf, -np.inf).containing(tested["path_ratio"])
    at_angle = (paths,) * (cosine_of(shipped.obliquity_max_deg) * paths.high > 1.0 + 2.0 * ROUNDING)
    return (*kind, *calibrated, *at_angle), measured


def _by_law(
    own_tests: OwnTests, tested: Mapping[str, Any], role: str
) -> Iterator[tuple[Fit, LotTests, Sequence[float] | None]]:
    """Yield the shipped fit, the own tests and the level of their lot, for each law of the flow stress.

    The tests have the logarithms of the measured over the limits that this law gives.  The level is the mean and the
    standard deviation of what the whole lot deviates by, or None.
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


def _distances(fit: Fit, tests: LotTests, level: Sequence[float] | None) -> Any:
    """Return the deviations of own tests from the prediction for any lot, (n,), in standard deviations.

    The deviation of a shot is negative if its outcome is as predicted.
    """
    location, scale, _ = fit.predicted(tests.quantities, {})
    mean, deviation = level or (0.0, 0.0)
    errors = tests.errors - location - mean
    return np.where(tests.sides == 0.0, abs(errors), tests.sides * errors) / np.hypot(scale, deviation)


def is_untested(ceramic: LibraryEntry) -> bool:
    """Return whether there is no test of a ceramic on metal."""
    values = np.array([ceramic["density_kg_m3"], ceramic["youngs_modulus_GPa"]])
    q = dict(zip(OF_CERAMIC[:2], values, strict=True))
    kinds = (evidence.kind for evidence in shipped_evidence() if evidence.ceramic and evidence.fits)
    return ceramic.evidence is None and all(
        is_outside((data_range for data_range in kind if data_range.name in q), q) for kind in kinds
    )


def lacks_sources(ceramic: LibraryEntry) -> bool:
    """Return whether neither tests nor enough sources give the flow stress of a ceramic.

    Own tests count for the values that were calibrated to them, and shipped tests for their laws of the flow stress; of
    a tested ceramic, another flow stress needs a source.
    """
    if ceramic.sources >= LEAST_SOURCES:
        return False
    strength, in_backing, in_product, *slopes = (
        ceramic[key] if key in ceramic.values else 0.0 for key in (FLOW_STRESS_KEY, *FLOW_STRESS_LAW)
    )
    values = np.array([strength, in_backing, in_product, sum(map(abs, slopes))])
    q = dict(zip((OF_CERAMIC[2], "backing_exponent", "product_exponent", "slopes"), values, strict=True))
    if ceramic.evidence is not None:
        calibrated = ceramic.evidence.calibrated
        return any(abs(q[name] - calibrated[name]) > ROUNDING * abs(calibrated[name]) for name in {*q} & {*calibrated})
    if ceramic.sources or is_untested(ceramic):
        return is_untested(ceramic)
    tested = (
        (*law, *(data_range for data_range in evidence.kind if data_range.name in q))
        for evidence in shipped_evidence()
        for law in evidence.laws
    )
    return all(is_outside(ranges, q) for ranges in tested)


def is_unusual(armour: Parameters) -> Any:
    """Return whether each of n armours is far from all armours, bare or with ceramic, that the model was compared with.

    A strength, density, slenderness or thickness over the diameter is then more than a factor of two outside every
    range compared.  The outcome of such an armour may change more than once with the velocity or a thickness.  A NaN
    counts as inside.
    """
    q = quantities(armour, np.nan, np.ones(np.shape(armour.D0)))
    is_far: dict[tuple[bool, str], Any] = {}
    ranges = {
        (bool(evidence.ceramic), data_range) for evidence in shipped_evidence() for data_range in evidence.compared
    }
    for has_ceramic, data_range in ranges:
        key = has_ceramic, data_range.name
        is_far[key] = is_far.get(key, True) & (data_range.factor(q) > UNUSUAL_FACTOR)
    return np.any([far & (has_ceramic == (armour.Hc0 > 0.0)) for (has_ceramic, _), far in is_far.items()], axis=0)


class Outside(NamedTuple):
    """A range of the tests, or another condition on them, outside which some of n armours lie."""

    key: str  # of the input that it depends on
    words: str  # what the model was compared with
    rows: Any  # indices of the armours outside
    numbers: str  # the range of their values, in words

    def note(self, key: str = "") -> Note:
        """Return the warning, by default with its own key."""
        return Note(self.words + self.numbers, key or self.key, said="far")


def limits_outside(armours: Armours, velocities: Any) -> Iterator[Outside]:
    """Yield the ranges and conditions of the tests outside which some of n armours, or of their velocities, m/s, lie.

    A NaN is not outside.
    """
    ceramics = ", ".join(dict.fromkeys(tests.ceramic for tests in shipped_evidence() if tests.ceramic))
    for evidence, rows in armours.by_evidence():
        members = armours.at(rows)
        q, ceramic = members.quantities(), members.materials[members.material_of_row[0]].ceramic
        name, is_shipped = f', found "{ceramic.name}"' if ceramic else "", not evidence.lot
        oblique = evidence.fails_angle(members.cosines)
        is_other = is_outside(evidence.kind[:2], q) & is_shipped & bool(evidence.ceramic)
        checks = [
            (OBLIQUITY, evidence.angles(), oblique, ""),
            _check(evidence.velocities, {"velocity_m_s": velocities[rows]}),
            ("armour.ceramic", "no test by such a law of the flow stress", evidence.has_other_law(q), name),
            ("armour.ceramic", f"tests or results of the paper's program of {ceramics} only", is_other, name),
            ("armour.ceramic", evidence.title, ~is_other & (not evidence.fits) & is_shipped, name),
            *(_check(data_range, q, ~(is_other & (data_range.name in OF_CERAMIC))) for data_range in evidence.compared),
        ]
        for key, words, fails, numbers in checks:
            if fails.any():
                yield Outside(key, f"the model was compared with {words}", np.flatnonzero(rows)[fails], numbers)


def far_from_tests(scenario: Scenario, armours: Armours) -> tuple[str, ...]:
    """Return in what the armour of a scenario, a single row, is far from the tests, such as "5083-H3 (on 6061-T6)".

    A material or a projectile counts if another one was tested, any other quantity if it is more than 10 % outside the
    range of the tests, which is rounded inwards.
    """
    p, cosines = armours.parameters, armours.cosines
    sizes_mm = ((thickness * cosines).item() / MM for thickness in (p.Hc0, p.Hb))
    return what_was_tested(scenario, armours).far_of(armours.materials[0].ceramic, *sizes_mm)


class Tested(NamedTuple):
    """What was tested of armours like one."""

    thicknesses_mm: dict[str, tuple[float, float]]  # least and greatest, by layer, "tile" or "plate"
    others: tuple[str, ...]  # what else of the armour is far from that, in words

    def far_of(self, ceramic: LibraryEntry | None, tile_mm: float, plate_mm: float) -> tuple[str, ...]:
        """Return in what an armour with these thicknesses, mm, is far from the tests."""
        words = [f"{ceramic.name} (no test)"] if ceramic is not None and tile_mm and is_untested(ceramic) else []
        words += filter(None, map(self.far, LAYERS.values(), (tile_mm, plate_mm)))
        return (*words, *self.others)

    def far(self, layer: str, size_mm: float) -> str:
        """Return the thickness of a layer, mm, with the range tested if it is far from that; otherwise ""."""
        low, high = self.thicknesses_mm.get(layer, (0.0, np.inf))
        if not size_mm or low / FAR <= size_mm <= high * FAR:
            return ""
        # Of a single thickness, both roundings.
        ends = sorted((np.ceil(10.0 * low) / 10.0, np.floor(10.0 * high) / 10.0))
        return f"{size_mm:.4g} mm {layer} (tested {' to '.join(dict.fromkeys(f'{end:g}' for end in ends))} mm)"


def what_was_tested(scenario: Scenario, armours: Armours) -> Tested:
    """Return what was tested of armours like that of a scenario, a single row; without that its ceramic was not."""
    [(nearest, _)] = armours.by_evidence()
    evidence, q = _tests_of(nearest, armours), armours.quantities()
    diameter_mm = float((armours.parameters.D0 * armours.cosines).item()) / MM
    ranges = [*evidence.kind, *evidence.measured]
    roles = {each.name.partition("_")[0] for each in ranges if each.name not in LAYERS and each.factor(q)[0] > FAR}
    thicknesses_mm = {
        LAYERS[each.name]: (each.low * diameter_mm, each.high * diameter_mm) for each in ranges if each.name in LAYERS
    }
    words = []
    for name, tested, role, with_it in (
        (armours.materials[0].backing.name, evidence.metal, "backing", "on"),
        (scenario.impact.projectile, evidence.projectile, "rod", "with"),
    ):
        if tested and not evidence.lot and tested != name:
            words.append(f"{name} ({with_it} {tested})")
        elif not tested and role in roles:
            words.append(name)
    if evidence.fails_angle(armours.cosines)[0]:
        words.append(f"{scenario.impact.obliquity_deg:g}° (tested to {evidence.obliquity_max_deg:g}°)")
    return Tested(thicknesses_mm, tuple(words))


def _tests_of(evidence: Evidence, armours: Armours) -> Evidence:
    """Return the evidence if it has a fit; otherwise, as for results of the paper's program, tests of such armour."""
    if evidence.fits:
        return evidence
    has_ceramic = bool(np.any(armours.parameters.Hc0))
    return next(tests for tests in shipped_evidence() if tests.fits and bool(tests.ceramic) == has_ceramic)


def contradicted(armours: Armours, *, said: bool = True) -> Iterator[tuple[Note, Any]]:
    """Yield what tests contradict of the limits of n armours, or of their probabilities, unless own tests tell.

    Masks and `said` are as in `caveats`.
    """
    q = armours.quantities()
    for name, data in shipped_data()["caveat"].items():
        rows = ~is_outside(_ranges(data["ranges"]), q) & ~is_no_metal(armours.parameters.rho_B)
        if rows.any():
            for evidence, members in armours.by_evidence():
                if evidence.lot and evidence.fits:
                    rows[members] &= evidence.differences(armours.at(members).quantities()) > 0
        if rows.any():
            yield Note(data["words"], data["key"], said="caveat" * said, about=("contradicted", name)), rows


def limits_of_model(
    armours: Armours, metals: Iterable[LibraryEntry], *, said: bool = True
) -> Iterator[tuple[Note, Any]]:
    """Yield the `caveats` and `contradicted` about n armours, and those on changed equations and too thin ceramics.

    Masks and `said` are as in `caveats`.
    """
    p, least = armours.parameters, np.zeros(len(armours.cosines))
    if changed := changed_equations():
        words = f"computed with {changed}"
        yield Note(words, said="caveat" * said, about=("equations", changed)), np.ones(len(least), dtype=bool)
    yield from caveats(p, metals, said=said)
    yield from contradicted(armours, said=said)
    for evidence, rows in armours.by_evidence():
        ranges = _tests_of(evidence, armours.at(rows)).measured
        least[rows] = sum(data_range.low for data_range in ranges if data_range.name == THIN)
    is_thin = p.Hc0 / p.D0 < least
    if is_thin.any():
        ratios, thicknesses_mm = least[is_thin], (least * p.D0 * armours.cosines / MM)[is_thin]
        words = too_thin(_ends(ratios, ".2g"), _ends(thicknesses_mm, ".2g"))
        ends = (float(end) for values in (ratios, thicknesses_mm) for end in (values.min(), values.max()))
        yield Note(words, CERAMIC, said="far", about=(TOO_THIN, *ends)), is_thin


def _check(data_range: DataRange, q: Quantities, rows: Any = True) -> tuple[str, str, Any, str]:
    """Check whether quantities of n armours lie in a range; `rows` may restrict the check to some of them.

    Return the key, the words of the range, a mask of the armours that fail, and the range of their values in words.
    """
    fails = data_range.fails(q) & ~np.isnan(q[data_range.name]) & rows
    if data_range.name == THIN:  # `limits_of_model` has what is too thin
        fails &= q[THIN] > data_range.low
    return data_range.key, f"results for {data_range}", fails, f", found {_ends(q[data_range.name][fails])}"


def _ends(values: Any, spec: str = "") -> str:
    """Return the least and the greatest of values in words, such as "30 to 45"; one word if they are equal."""
    ends = values.min(initial=np.inf), values.max(initial=-np.inf)
    return " to ".join(dict.fromkeys(f"{end:{spec or ('.0f' if end >= 100.0 else '.3g')}}" for end in ends))


def scenario_warnings(
    scenario: Scenario, velocity: float, key: str = VELOCITY, *, armours: Armours | None = None, said: bool = False
) -> tuple[Note, ...]:
    """Return the caveats, and warnings of unused threats and of ways in which the scenario lies outside the tests.

    `velocity` is the impact velocity or the ballistic limit, m/s, and `key` its key; `armours` has the scenario's
    armour, if it is known already; `said` tells whether the answer itself contains the caveats.
    """
    armours = armours or armours_of(scenario)
    outside = limits_outside(armours, np.array([velocity]))
    notes = (limit.note(key if limit.key == VELOCITY else "") for limit in outside)
    metals = [armours.materials[0].backing]
    strengths = strength_notes(metals, bare=not scenario.armour.ceramic_thickness_mm)
    cannot = (note for note, _ in limits_of_model(armours, metals, said=said))
    return (*cannot, *scenario.unused_threats(), *notes, *strengths)


def _named(titles: Sequence[str], places: Sequence[int]) -> str:
    """Return words, such as " against M2", for the threats at some places; "" for all of them."""
    return f" against {joined([titles[place] for place in places])}" if len(places) < len(titles) else ""


def against_each(
    titles: Sequence[str], by_threat: Iterable[Iterable[tuple[Note, Any]]]
) -> Iterator[tuple[Note, list[Any]]]:
    """Yield each caveat on armours against threats once, with the masks of the armours that it is about.

    `by_threat` has the caveats, with their masks, against each of the threats.  One that is not about all threats, such
    as one with other numbers for another threat, names its own.
    """
    found: dict[tuple[str | float, ...], list[tuple[int, Note, Any]]] = {}
    for place, caveats_against in enumerate(by_threat):
        for note, mask in caveats_against:
            found.setdefault(note.about, []).append((place, note, mask))
    for each in found.values():
        places, notes, masks = zip(*each, strict=True)
        yield notes[0].against(_named(titles, places)), list(masks)


def threat_warnings(
    scenario: Scenario, armours: Armours, metals: Sequence[LibraryEntry] | None = None
) -> Iterator[Note]:
    """Yield the ways in which an armour and the threats of a scenario are unlike what the model was compared with.

    `armours` has a row of the armour against each threat.  `metals` are the metals whose strengths are compared, by
    default only the armour's own.  A warning that is not about all threats names its threats.
    """
    threats = scenario.threats()
    titles, backings = [threat.title for threat in threats], [materials.backing for materials in armours.materials]
    each = [armours] if len(threats) == 1 else [armours.at([place]) for place in range(len(threats))]
    by_threat = (limits_of_model(armour, backings) for armour in each)
    for note, _ in against_each(titles, by_threat):
        yield note
    for outside in limits_outside(armours, np.array([threat.velocity_m_s for threat in threats])):
        section, _, name = outside.key.partition(".")
        is_of_threat = scenario.threat and section in ("impact", "projectile")
        key = f"threat[{outside.rows[0]}].{name if section == 'impact' else 'projectile'}" if is_of_threat else ""
        yield outside.note(key).against(_named(titles, outside.rows))
    own = armours.materials[armours.material_of_row[0]].backing
    yield from strength_notes(metals or [own], bare=bool(np.all(armours.parameters.Hc0 == 0.0)))
