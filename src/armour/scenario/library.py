"""Library of projectiles and materials: the shipped entries and those that files and scenarios add; named threats.

Every value has a status (measured, nominal, fitted or assumed) and a source.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain, islice
from math import nan
from os import PathLike
from typing import Annotated, Any, Generic, Literal, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, field_validator, model_validator

from armour.errors import CHOOSE, MAX_WORDS, InputError, Note, Problem, listed, mistake, refuse, suggestion
from armour.files import read_toml, shipped, shipped_files
from armour.scenario.checked import checked
from armour.scenario.inputs import INPUTS, ROD, YIELD, Kind, length_mm
from armour.scenario.keys import describe, key_name, plain_name, with_plain_keys
from armour.scenario.sections import NOT_TINY, NUMBER, TINY, Items, NumberOrText, Section, every_problem
from armour.units import GPA, MPA

Number = TypeVar("Number", bound=float)


class Value(Section, Generic[Number]):
    """A number of the library, with its origin.

    Attributes
    ----------
    value : float
        The number, in the unit at the end of its key.
    status : str
        "measured", "nominal" (as a table or a standard lists it), "fitted" or "assumed".
    source : str
        Its source; empty if none is given.
    tests : list of dict
        Tests that it was calibrated to: inputs and measured values by name, in the units at the ends of the names.
    """

    value: Number
    """The number, in the unit of the key."""
    status: Literal["measured", "nominal", "fitted", "assumed"] = "assumed"
    """How the number is known: "measured", "nominal" (as a table or a standard lists it), "fitted" or "assumed"."""
    source: str = ""
    """Source of the number."""
    tests: Annotated[list[dict[str, NumberOrText]], Field(exclude_if=lambda tests: not tests)] = []
    """Tests to which the number was calibrated."""

    def __repr__(self) -> str:
        return f"<Value: {self.value:g}, {self.status}{f', {self.source}' if self.source else ''}>"

    @classmethod
    def model_parametrized_name(cls, params: tuple[Any, ...]) -> str:
        """Return the name of a class of bounded numbers without dots, at which pickle splits it."""
        return super().model_parametrized_name(params).replace(".", "_")


def _as_table(value: object) -> object:
    """Return a number as the table of a `Value`; leave a table as it is."""
    return value if isinstance(value, dict | Value) else {NUMBER: value}


_NumberOrTable = BeforeValidator(_as_table, json_schema_input_type=float | Value[float])
# The bounds are wide: they catch values in a wrong unit.
Length = Annotated[Value[Annotated[float, Field(gt=0.0, le=1e4), NOT_TINY]], _NumberOrTable]
Mass = Annotated[Value[Annotated[float, Field(gt=0.0, le=1e9), NOT_TINY]], _NumberOrTable]
Density = Annotated[Value[Annotated[float, Field(ge=100.0, le=30000.0)]], _NumberOrTable]
StressGPa = Annotated[Value[Annotated[float, Field(ge=0.001, le=1000.0)]], _NumberOrTable]
StressMPa = Annotated[Value[Annotated[float, Field(ge=1.0, le=1e6)]], _NumberOrTable]
LawCoefficient = Annotated[Value[Annotated[float, Field(ge=-3.0, le=3.0)]], _NumberOrTable]
Strain = Annotated[Value[Annotated[float, Field(gt=0.0, le=10.0), NOT_TINY]], _NumberOrTable]


# Greatest number of own tests of an entry, each of which takes time in every answer.
MOST_TESTS = 300


class LawTests(Section):
    """Ballistic limits of own tests by a law, from which a fit of the shipped tests is updated."""

    fit: str
    """Name of the fit."""
    values: dict[str, float] = {}
    """Values of the entry, by key, that the limits are computed with."""
    level: Annotated[tuple[float, Annotated[float, Field(gt=0.0)]], Field(strict=False)] | None = None
    """Mean and standard deviation of the logarithm of measured over computed limits before the tests, if not the
    fit's."""
    computed_m_s: Annotated[Items[Annotated[float, Field(gt=0.0)]], Field(max_length=MOST_TESTS)]
    """Ballistic limits computed."""


# Quantities of the armours of own tests that an entry keeps, see `armour.evidence.fit.quantities`: those that vary
# freely, and those that further armours of a ceramic without shipped tests must have in common with them.
VARIED = (
    "ceramic_thickness_ratio",
    "backing_thickness_ratio",
    "rod_diameter_mm",
    "rod_length_ratio",
    "rod_mass_ratio",
    "rod_density_kg_m3",
    "rod_strength_GPa",
    "path_ratio",
)
IN_COMMON = (
    "ceramic_density_kg_m3",
    "ceramic_modulus_GPa",
    "backing_density_kg_m3",
    "backing_strength_GPa",
    "backing_shear_ratio",
)
# Quantities of the results: a side is 1 if the limit is above the velocity of a shot, -1 if below, and 0 for a limit.
TEST_RESULTS = ("velocity_m_s", "uncertainty_m_s", "side")
# Number of the laboratory or series of a test, where several are named.
SERIES_KEY = "series"
# Least possible values of these quantities; all others but the side are above 0.
MAY_BE_0 = ("ceramic_thickness_ratio", "ceramic_density_kg_m3", "ceramic_modulus_GPa", "uncertainty_m_s", SERIES_KEY)
LEAST_OF_TESTS = {"path_ratio": 1.0, **dict.fromkeys(MAY_BE_0, 0.0)}


class OwnTests(Section):
    """Own tests of one lot, to which a value of the entry was calibrated; `armour calibrate` writes them."""

    lot: str = ""
    """Name of the lot."""
    source: str = ""
    """Source of the tests."""
    calibrated: dict[str, float] = {}
    """Calibrated values by quantity."""
    tests: dict[str, Items[float]] = {}
    """Quantities of the armours tested, with thicknesses along the line of fire over the penetrator's diameter, and
    what was measured; a side is 1 where the limit is above the velocity of a shot, -1 below, and 0 of a limit."""
    names: Items[str] = ()
    """Names of the tests, with their laboratories and series."""
    calibrated_m_s: Items[Annotated[float, Field(gt=0.0)]] = ()
    """Ballistic limits computed with the calibrated values."""
    law: Items[LawTests] = ()
    """Laws that the limits were computed with; none if the tests do not determine the model error."""
    reason: str = ""
    """Reason why the tests do not determine the model error."""

    @model_validator(mode="after")
    def _complete(self) -> "OwnTests":
        """Refuse tests that do not determine the model error as they should: of unequal lengths or impossible."""
        if not self.law:
            return self
        optional = filter(None, (self.names, self.calibrated_m_s))
        columns = (*self.tests.values(), *(law.computed_m_s for law in self.law), *optional)
        counts = {len(column) for column in columns}
        if {*self.tests} - {SERIES_KEY} != {*VARIED, *IN_COMMON, *TEST_RESULTS} or len(counts) > 1 or 0 in counts:
            raise ValueError("must be as armour calibrate writes it: a number for each test in each of its lists")
        for name, column in self.tests.items():
            least = LEAST_OF_TESTS.get(name, TINY**2)  # that of a ratio of two numbers
            if {*column} - {-1.0, 0.0, 1.0} if name == "side" else min(column) < least:
                raise ValueError(f"must be as armour calibrate writes it: {name} has an impossible number")
        return self

    def shows_scatter(self) -> bool:
        """Return whether the tests show the scatter of shots: enough shots at one of the armours, with both results."""
        columns = (self.tests.get(key, ()) for key in (*VARIED, *IN_COMMON, "side"))
        results = Counter[tuple[float, ...]](zip(*columns, strict=False))
        return any(
            results[*armour, 1.0] + results[*armour, -1.0] >= LEAST_SHOTS
            for *armour, side in results
            if side == 1.0 and (*armour, -1.0) in results
        )


Name = Annotated[str, AfterValidator(plain_name)]


class Entry(Section):
    """An entry of a library file; it inherits missing values from the entry that it is based on."""

    description: str = ""
    """Description of the entry."""
    based_on: Name | None = None
    """Name of the entry that supplies every value not given."""
    aliases: Items[Name] = ()
    """Other names of the entry."""
    doubtful: str = ""
    """Why its values are doubtful; an entry with values of its own does not inherit it."""
    evidence: OwnTests | None = None
    """Own tests to which the entry was calibrated; written by `armour calibrate`."""

    def values(self) -> dict[str, Value[float]]:
        """Return the values that the entry gives, by key."""
        return {key: value for key, value in self if isinstance(value, Value)}


class Projectile(Entry):
    """A projectile; its penetrator is modelled as a cylinder."""

    caliber_mm: Length | None = None
    """Calibre of the round."""
    projectile_mass_g: Mass | None = None
    """Mass of the whole projectile, for Florence's formula."""
    penetrator_diameter_mm: Length | None = None
    """Diameter of the penetrator."""
    penetrator_mass_g: Mass | None = None
    """Mass of the penetrator; with diameter and density it gives the length."""
    density_kg_m3: Density | None = None
    """Density of the penetrator."""
    flow_stress_GPa: StressGPa | None = None
    """Flow stress of the penetrator."""


ScatterPercent = Annotated[float, Field(gt=0.0, le=50.0), NOT_TINY]
# Least scatter of shots, per cent of V50, that needs no own firings; the least number of shots of such a firing.
LEAST_SCATTER_PERCENT, LEAST_SHOTS = 2.5, 36
SCATTER_KEYS = ("scatter_percent", "scatter_source")


def least_scatter(percent: float) -> str:
    """Return the message that a scatter of shots, per cent of V50, is too small to be taken without own firings."""
    return (
        f"must be at least {LEAST_SCATTER_PERCENT:g}, or be given in an entry of the library with an own firing of "
        f"{LEAST_SHOTS} shots or more with both results, found {percent:g}"
    )


def _enough_without_firings(percent: float) -> float:
    """Return a scatter of shots, per cent of V50, unless it is so small that it needs own firings."""
    if percent < LEAST_SCATTER_PERCENT:
        raise ValueError(least_scatter(percent))
    return percent


# A scatter that is given without own firings.
AssumedScatter = Annotated[ScatterPercent, AfterValidator(_enough_without_firings)]


def check_scatter(percent: float | None, source: str) -> None:
    """Raise a ValueError for a scatter of shots, per cent of V50, without its source, or a source without a scatter."""
    if (percent is None) != (not source):
        raise ValueError(f"must have {' and '.join(SCATTER_KEYS)}, or neither")


class Layer(Entry):
    """A material of a layer."""

    scatter_percent: ScatterPercent | None = None
    """Standard deviation of the velocities that single shots need to perforate, per cent of V50; below 2.5 only for an
    entry with own firings of 36 shots or more, with both results."""
    scatter_source: str = ""
    """Source of this scatter."""

    @model_validator(mode="after")
    def _has_source_of_scatter(self) -> "Layer":
        """Refuse a scatter of shots without its source."""
        check_scatter(self.scatter_percent, self.scatter_source)
        return self


class Ceramic(Layer):
    """A ceramic."""

    density_kg_m3: Density | None = None
    """Density."""
    youngs_modulus_GPa: StressGPa | None = None
    """Young's modulus, for the velocity of the crack."""
    flow_stress_GPa: StressGPa | None = None
    """Flow stress of the intact ceramic."""
    flow_stress_sources_GPa: Annotated[Items[Annotated[float, Field(ge=0.001, le=1000.0)]], Field(max_length=2)] = ()
    """Least and greatest flow stress that sources give, of a ceramic of which no test on metal is known; one number if
    a single source gives one."""
    flow_stress_backing_exponent: LawCoefficient | None = None
    """Law of the flow stress: exponent of the back plate's thickness."""
    flow_stress_product_exponent: LawCoefficient | None = None
    """Law of the flow stress: exponent of the product of both thicknesses."""
    flow_stress_ceramic_slope: LawCoefficient | None = None
    """Law of the flow stress: slope by the ceramic's thickness."""
    flow_stress_backing_slope: LawCoefficient | None = None
    """Law of the flow stress: slope by the back plate's thickness."""

    @field_validator("flow_stress_sources_GPa")
    @classmethod
    def _in_order(cls, sources: tuple[float, ...]) -> tuple[float, ...]:
        """Return the flow stresses, GPa, if they rise."""
        if list(sources) != sorted(sources):
            raise ValueError(f"must be the least flow stress and the greatest one, found {list(sources)}")
        return sources


class Metal(Layer):
    """A metal for back plates."""

    density_kg_m3: Density | None = None
    """Density."""
    static_yield_strength_MPa: StressMPa | None = None
    """Static yield strength, as given in data sheets; not used if there is a dynamic one."""
    dynamic_yield_strength_MPa: StressMPa | None = None
    """Dynamic yield strength; by default the static one."""
    flow_stress_GPa: StressGPa | None = None
    """Constrained flow stress; by default 2.7 times the dynamic yield strength."""
    shear_strength_MPa: StressMPa | None = None
    """Ultimate shear strength; by default 0.7 times the dynamic yield strength."""
    ultimate_tensile_strength_MPa: StressMPa | None = None
    """Ultimate tensile strength, for Florence's formula."""
    strain_to_fracture: Strain | None = None
    """Strain to fracture, for Florence's formula."""


KINDS: dict[Kind, type[Entry]] = {"projectile": Projectile, "ceramic": Ceramic, "metal": Metal}
# Keys of the values of each kind.
VALUE_KEYS = {kind: [key for key in KINDS[kind].model_fields if key not in Entry.model_fields] for kind in KINDS}
# Keys that the model does not use: data of the whole projectile, and properties for the formulas of `armour compare`.
UNUSED = ("caliber_mm", "projectile_mass_g", "ultimate_tensile_strength_MPa", "strain_to_fracture")
# Coefficients of the law of a ceramic's flow stress, see `armour.core.equations.intact_strength`; 0 if absent.
FLOW_STRESS_LAW = tuple(key for key in Ceramic.model_fields if key.endswith(("_exponent", "_slope")))
STATIC, DYNAMIC = "static_yield_strength_MPa", "dynamic_yield_strength_MPa"
FLOW_STRESS_KEY = "flow_stress_GPa"
# Keys that an entry may lack.
SOURCES_KEY = "flow_stress_sources_GPa"
OPTIONAL = (*UNUSED, *FLOW_STRESS_LAW, STATIC, SOURCES_KEY, *SCATTER_KEYS)

# Defaults for metals: multiples of the static yield strength, or else of the dynamic one, in MPa, and their source.
DEFAULTS = {
    DYNAMIC: (1.0, "the static yield strength, as no dynamic one is known"),
    "flow_stress_GPa": (2.7 * MPA / GPA, "2.7 times the dynamic yield strength, the constraint factor of the paper"),
    "shear_strength_MPa": (0.7, "0.7 times the dynamic yield strength, which fits the paper's 6061-T6 and 5083-H3"),
}
# Names of what is neither metal nor ceramic, why no answer on it is known, and the page that explains it.
NO_METAL = re.compile(
    r"\b(aramid|kevlar|twaron|uhmwpe|dyneema|spectra|polyethylene|hdpe|rubber|elastomer|polycarbonate|pmma|acrylic|"
    r"polyurethane|polyurea|nylon|epoxy|gfrp|grp|cfrp|frp|fib(?:re|er)|[es]-?2?[ -]?glass|laminate|plywood|wood)",
    re.IGNORECASE,
)
NOT_MODELLED = "laminates and rubber fail by delamination and tension, which is not modelled"
PAGE = "docs/howto/confidence.md"
# Range of the ratio of length to diameter of a penetrator; outside it, the mass most likely has a wrong unit.
SLENDERNESS = (0.1, 100.0)


class LibraryTables(Section):
    """Tables of a library file, or of the section [library] of a scenario."""

    projectile: dict[str, Projectile] = {}
    """Entries of projectiles."""
    ceramic: dict[str, Ceramic] = {}
    """Entries of ceramics."""
    metal: dict[str, Metal] = {}
    """Entries of metals."""


@dataclass(frozen=True)
class LibraryEntry:
    """An entry of the library, with every value that its kind needs.

    Attributes
    ----------
    kind : {"projectile", "ceramic", "metal"}
    name : str
    description : str
    values : mapping of str to Value
        Number, status and source by key; a key ends with the unit.
    derived : frozenset of str
        Keys of values that follow from other values.
    file : str
        File that defines it; empty for the shipped library.
    aliases : tuple of str
        Other names of it.
    evidence : OwnTests or None
        Own tests that a value was calibrated to; by default those of the entry that it is based on.
    origin : str
        Name of the entry that it is based on, directly or not; its own if none.
    flow_stress_sources_GPa : tuple of float
        Least and greatest flow stress that sources give, or one number; by default those of the entry that it is based
        on.
    doubtful : str
        Why its values are doubtful; empty if they are not known to be.
    unsourced : frozenset of str
        Keys of values that are given without a source, here or in an entry that it is based on.
    scatter_percent : float or None
        Standard deviation of the velocities that single shots need to perforate, per cent of V50; by default that of
        the entry that it is based on.
    scatter_source : str
        Source of this scatter.
    """

    kind: Kind
    name: str
    description: str
    values: Mapping[str, Value[float]]
    derived: frozenset[str] = frozenset()
    file: str = field(default="", compare=False, repr=False)
    aliases: tuple[str, ...] = ()
    evidence: OwnTests | None = None
    origin: str = ""
    flow_stress_sources_GPa: tuple[float, ...] = ()
    doubtful: str = ""
    unsourced: frozenset[str] = frozenset()
    scatter_percent: float | None = None
    scatter_source: str = ""

    def __getitem__(self, key: str) -> float:
        """Return the number that a key has, in the unit at its end."""
        return self.values[key].value

    @property
    def is_static(self) -> bool:
        """Whether a static yield strength is taken for the dynamic one of a metal."""
        return DYNAMIC in self.derived

    @property
    def sources(self) -> int:
        """Number of sources of the flow stress: those listed if it lies between them, else 1, or 0 if it has none."""
        if FLOW_STRESS_KEY in self.unsourced:
            return 0
        listed_GPa = self.flow_stress_sources_GPa
        return len(listed_GPa) if listed_GPa and listed_GPa[0] <= self[FLOW_STRESS_KEY] <= listed_GPa[-1] else 1

    def inputs_as(self, role: str) -> dict[str, float]:
        """Return the values of the inputs that the entry gives in a role, such as "ceramic", by name of input."""
        return {
            name: self[key]
            for key in self.values
            if (name := f"{role}.{key}") in INPUTS and (name != YIELD or self.derived - {key})
        }

    def content(self) -> dict[str, Any]:
        """Return the content that results depend on, as plain data: numbers, the evidence, and the other names."""
        return {
            "values": {key: value.value for key, value in self.values.items()},
            "derived": sorted(self.derived),
            "evidence": self.evidence and self.evidence.model_dump(),
            "aliases": self.aliases,
            SOURCES_KEY: self.flow_stress_sources_GPa,
            **({"unsourced": True} if self.kind == "ceramic" and FLOW_STRESS_KEY in self.unsourced else {}),
            **({} if self.scatter_percent is None else {key: getattr(self, key) for key in SCATTER_KEYS}),
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the entry as plain data."""
        values = {key: value.model_dump() for key, value in self.values.items()}
        others = {SOURCES_KEY: list(self.flow_stress_sources_GPa)} | {key: getattr(self, key) for key in SCATTER_KEYS}
        optional = {"doubtful": self.doubtful, "aliases": list(self.aliases), **values, **others}
        entry = {"kind": self.kind, "name": self.name, "description": self.description}
        return entry | {key: value for key, value in optional.items() if value}


def hint(name: str, entries: Iterable[LibraryEntry], names: Iterable[str]) -> str:
    """Return the end of a message on a name that is not in the library: similar `entries`, or the closest of `names`.

    First come the entries whose names contain the name; if there are none, its first part, as with "5083-H32"; and then
    those whose descriptions contain it, as with "alumina".
    """
    for template in shipped_files("scenarios/templates", ".toml"):
        if all(part in "".join(name.casefold().split()) for part in template.split("_")):
            return f"; for this round there is a template: armour init --from templates/{template}"
    texts = {entry.name: ("\n".join((entry.name, *entry.aliases)), entry.description) for entry in entries}

    def alike(part: str, place: int) -> list[str]:
        """Return the entries that have a part of the name in their names (place 0) or descriptions (1)."""
        return [each for each in texts if part and part.casefold() in texts[each][place].casefold()]

    named = alike(name, 0)
    if NO_METAL.search(name) and not named:
        return f"; it is neither metal nor ceramic: {NOT_MODELLED}, see {PAGE}"
    for found in (named, alike(re.split("[ -]", name)[0], 0), alike(name, 1)):
        if 0 < len(found) <= 12:  # more are no help
            return CHOOSE + ", ".join(found)
    return suggestion(name, [*islice(names, MAX_WORDS + 1)]) or "; armour library lists them"


def strength_notes(metals: Iterable[LibraryEntry], *, bare: bool) -> tuple[Note, ...]:
    """Return a warning if the yield strength of metals is of another kind than in the tests; () if it is not.

    The tests have static strengths for bare plates, which `bare` tells, and dynamic ones for armour with a ceramic.
    """
    names = list(dict.fromkeys(metal.name for metal in metals if metal.is_static != bare and metal.evidence is None))
    if not names:
        return ()
    strength, tested, usually = ("dynamic", "static", "lower") if bare else ("static", "dynamic", "higher")
    armour = "bare plates" if bare else "armour with a ceramic"
    text = (
        f"the yield strength of {listed(names)} is {strength}, but those of the tests of {armour} are {tested}, "
        f"which are usually {usually}; do not compare them as they are"
    )
    return (Note(text, "armour.backing", said="detail", about=("strength", *names)),)


def tensile_strength(metal: LibraryEntry) -> float:
    """Return the tensile strength of a metal, MPa; NaN if it is not given."""
    key = "ultimate_tensile_strength_MPa"
    return metal[key] if key in metal.values else nan


def is_slender(inputs: Mapping[str, Any]) -> Any:
    """Return whether the length of a penetrator over its diameter lies within SLENDERNESS, for floats or arrays, (n,).

    `inputs` has the values of ROD by name.
    """
    ratio = slenderness(inputs)
    return (SLENDERNESS[0] <= ratio) & (ratio <= SLENDERNESS[1])


def slenderness(inputs: Mapping[str, Any]) -> Any:
    """Return the length of a penetrator over its diameter, a float or array; `inputs` has the values of ROD by name."""
    return length_mm(*(inputs[name] for name in ROD)) / inputs[ROD[0]]


@dataclass(frozen=True, repr=False)
class Library:
    """Library of projectiles and materials.

    Attributes
    ----------
    entries : mapping
        Entries by kind and name.
    notes : tuple of str
        A line for each entry that replaces another of the same name without being based on it.
    """

    entries: Mapping[Kind, Mapping[str, LibraryEntry]] = field(default_factory=lambda: {kind: {} for kind in KINDS})
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Library: {', '.join(f'{len(names)} {kind}s' for kind, names in self.entries.items())}>"

    def names(self, kind: Kind) -> list[str]:
        """Return the names of a kind, in the order of the files."""
        if kind not in KINDS:
            raise mistake("library", "kind", f"must be one of {', '.join(KINDS)}, found {describe(kind)}")
        return list(self.entries[kind])

    def to_dict(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Return the entries as plain data, by kind and name."""
        return {kind: {name: entry.to_dict() for name, entry in self.entries[kind].items()} for kind in KINDS}

    def entry(self, kind: Kind, name: str) -> LibraryEntry:
        """Return an entry; if there is none, an InputError suggests the closest name."""
        names = self.known(kind)
        name = plain_name(name) if isinstance(name, str) else name
        if name not in names:
            words = f"must name a {kind} of the library, found {describe(name)}"
            raise mistake("library", "name", words + hint(str(name), self.entries[kind].values(), names))
        return self.entries[kind][names[name]]

    def known(self, kind: Kind) -> dict[str, str]:
        """Return the name of each entry of a kind by each of its names, aliases included."""
        names = {name: name for name in self.names(kind)}
        return {alias: name for name in names for alias in self.entries[kind][name].aliases} | names

    def extended(self, tables: LibraryTables | Mapping[str, Any], file: str, prefix: str = "") -> "Library":
        """Return the library with added entries, which may be based on existing ones or replace those of the same name.

        `tables` has them by kind and name: ``{"ceramic": {"Mine": {"based_on": "AD85", "flow_stress_GPa": 4.5}}}``.
        `file` holds the entries and is the source of values without one; `prefix` is the key of the tables in it.
        """
        if not isinstance(tables, LibraryTables):
            data = with_plain_keys(tables, file)

            def read(rest: Mapping[str, Any]) -> Library:
                """Return the library with the entries in plain data."""
                return self.extended(LibraryTables.model_validate(rest), file, prefix)

            try:
                return read(data)
            except ValidationError as error:
                raise InputError(every_problem(error, LibraryTables, data, file, read)) from None
        if not any(getattr(tables, kind) for kind in KINDS):
            return self
        entries: dict[Kind, dict[str, LibraryEntry]] = {kind: dict(self.entries[kind]) for kind in KINDS}
        problems: list[Problem] = []
        notes = list(self.notes)
        for kind in KINDS:
            added: Mapping[str, Entry] = getattr(tables, kind)
            table = (prefix, kind) if prefix else (kind,)
            resolved, mistakes = _resolved(kind, added, self.entries[kind], file, table)
            entries[kind] |= {name: resolved[name] for name in added if name in resolved}
            problems += [*mistakes, *_ambiguous(added, entries[kind], file, table)]
            known = self.known(kind)
            for owner, entry in added.items():
                for name in (name for name in (owner, *entry.aliases) if name in known):
                    if not known[name] == owner == entry.based_on:
                        replaced = self.entries[kind][known[name]].file or "the shipped library"
                        notes.append(f"{file}: {key_name((*table, owner))}: replaces the {name} of {replaced}")
        refuse(problems)
        return Library(entries, tuple(notes))


def _ambiguous(
    added: Mapping[str, Entry], entries: Mapping[str, LibraryEntry], file: str, table: tuple[str, ...]
) -> Iterator[Problem]:
    """Yield a problem for each alias among added entries that is a name of another entry, or an alias of two.

    `entries` are those of the library with the added ones, by name; `table` has the parts of the key of their table in
    the file.
    """
    owners: dict[str, str] = {}
    for name, entry in added.items():
        for alias in entry.aliases:
            other = alias if alias in entries and alias != name else owners.setdefault(alias, name)
            if other != name:
                message = f'must be names of this entry alone, found "{alias}", a name of "{other}" too'
                yield Problem(file, key_name((*table, name, "aliases")), message)


def _resolved(
    kind: Kind, added: Mapping[str, Entry], earlier: Mapping[str, LibraryEntry], file: str, table: tuple[str, ...]
) -> tuple[dict[str, LibraryEntry], list[Problem]]:
    """Return the entries that a table of a file adds, with inherited values, and the problems of wrong entries.

    `added` has the entries of the table by name, `earlier` those of the library; `table` has the parts of its key.
    """
    resolved: dict[str, LibraryEntry] = {}
    problems: list[Problem] = []
    # Names of added entries by the added entry that they are based on; None for the others.  An entry that is based on
    # its own name refers to the earlier entry of that name.
    following: defaultdict[str | None, list[str]] = defaultdict(list)
    for name, entry in added.items():
        following[entry.based_on if entry.based_on in added and entry.based_on != name else None].append(name)
    ready = following.pop(None, [])
    for name in ready:
        ready += following.pop(name, [])  # a base precedes the entries based on it
        entry, base = added[name], added[name].based_on
        is_added = base in added and base != name
        inherited = None if base is None else (resolved if is_added else earlier).get(base)
        if base is None or inherited:
            complete = _completed(kind, name, entry, inherited, file)
            mistakes = _mistakes(complete)
            problems += (Problem(file, key_name((*table, name, key)), mistakes[key]) for key in mistakes)
            if not mistakes:
                resolved[name] = complete
        elif not is_added:  # an added base reports its own mistake
            names = (other for other in chain(earlier, added) if other != name)
            message = f'must name a {kind} of the library, found "{base}"{hint(base, earlier.values(), names)}'
            problems.append(Problem(file, key_name((*table, name, "based_on")), message))
    for name in chain.from_iterable(following.values()):
        message = f'must not lead back to the entry itself, found "{added[name].based_on}"'
        problems.append(Problem(file, key_name((*table, name, "based_on")), message))
    return resolved, problems


def _completed(kind: Kind, name: str, entry: Entry, base: LibraryEntry | None, file: str) -> LibraryEntry:
    """Return an entry with the values of its `base`, if it has one, and derived ones, in the order of the keys."""
    base = base or LibraryEntry(kind, name, description="", values={}, origin=name)
    values = {key: value for key, value in base.values.items() if key not in base.derived}
    unsourced = {*base.unsourced}
    for key, value in entry.values().items():
        if key in values and value.value == values[key].value and not value.source:
            continue  # the number of the base, whose source it keeps
        values[key] = value if value.source else value.model_copy(update={"source": file})
        unsourced = unsourced - {key} if value.source else unsourced | {key}
    derived = []
    if strength := values.get(DYNAMIC, values.get(STATIC)):
        derived = [key for key in DEFAULTS if key not in values]
        for key in derived:
            factor, source = DEFAULTS[key]
            values[key] = Value[float](value=factor * strength.value, source=source)
    gives_scatter = getattr(entry, SCATTER_KEYS[0], None) is not None
    scatter: Any = {key: getattr(entry if gives_scatter else base, key) for key in SCATTER_KEYS}
    return LibraryEntry(
        kind,
        name,
        entry.description or base.description,
        {key: values[key] for key in VALUE_KEYS[kind] if key in values},
        frozenset(derived),
        file,
        entry.aliases,
        entry.evidence or base.evidence,
        base.origin,
        getattr(entry, SOURCES_KEY, ()) or base.flow_stress_sources_GPa,
        entry.doubtful or base.doubtful * (not entry.values()),
        frozenset(unsourced),
        **scatter,
    )


def _mistakes(entry: LibraryEntry) -> dict[str, str]:
    """Return what is wrong with an entry, by key: values that it lacks, or a scatter or length that cannot be right."""
    if missing := [key for key in VALUE_KEYS[entry.kind] if key not in (*entry.values, *OPTIONAL)]:
        return dict.fromkeys(missing, "is missing and must be given, or based_on an entry that has it")
    has_firings = entry.evidence is not None and entry.evidence.shows_scatter()
    if entry.scatter_percent is not None and entry.scatter_percent < LEAST_SCATTER_PERCENT and not has_firings:
        return {SCATTER_KEYS[0]: least_scatter(entry.scatter_percent)}
    if entry.kind != "projectile" or is_slender(rod := entry.inputs_as("projectile")):
        return {}
    message = (
        f"must make a rod {SLENDERNESS[0]:g} to {SLENDERNESS[1]:g} diameters long with the diameter and density given, "
        f"found {slenderness(rod):.3g} diameters; is it in g?"
    )
    return {"penetrator_mass_g": message}


@checked
def read_library(path: str | PathLike[str], onto: Library) -> Library:
    """Read a library file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    onto : Library
        Library to which the entries are added; it is not changed.

    Returns
    -------
    Library

    Raises
    ------
    InputError
        With every mistake in the file, or if it cannot be read.
    """
    return onto.extended(read_toml(path, quoted=False), str(path))


@cache
def shipped_library() -> Library:
    """Return the library that is shipped with the package."""
    library = Library()
    for name in ("ceramics", "metals", "projectiles", "tested_plates"):
        library = library.extended(read_toml(shipped("configs") / f"{name}.toml"), file="")
    return library


# Keys of [impact] and [[threat]] that the name of a threat gives.
THREAT_KEYS = ("projectile", "velocity_m_s", "obliquity_deg")


class NamedThreat(Section):
    """A threat of a standard."""

    standard: str
    level: str
    round: str
    projectile: str
    velocity_m_s: float
    tolerance_m_s: float | None = None
    """By how much the velocity of a shot may differ."""
    obliquity_deg: float | None = None
    status: Literal["confirmed", "unconfirmed"]
    source: str

    def values(self) -> dict[str, object]:
        """Return the values that the threat gives in [impact] or [[threat]], by key."""
        return self.model_dump(include=set(THREAT_KEYS), exclude_none=True)


@cache
def named_threats() -> dict[str, NamedThreat]:
    """Return the shipped threats by name."""
    tables = read_toml(shipped("configs") / "threats.toml")["threat"]
    return {name: NamedThreat(**table) for name, table in tables.items()}


def search_library(words: Sequence[str]) -> list[tuple[Any, str, Any]]:
    """Return the kind, the name and the content of shipped entries and threats with these words, in any case.

    They are those that are called by the words together or, if there are none, those with each of them: a kind, such as
    "metals", or a part of a name or a description.  If there are none either, an InputError suggests similar ones.
    """
    library, threats = shipped_library(), named_threats()
    kinds: dict[Any, Mapping[str, Any]] = {**library.entries, "threat": threats}
    kind_of = {f"{kind}{plural}": kind for kind in kinds for plural in ("", "s")}
    name_asked = plain_name(" ".join(words))
    asked = name_asked.casefold().split()
    called, alike = list[tuple[Any, str, Any]](), list[tuple[Any, str, Any]]()
    for kind in ("projectile", "ceramic", "threat", "metal"):
        for name, item in kinds[kind].items():
            names = (name,) if kind == "threat" else (name, *item.aliases)
            others = (item.round, item.projectile) if kind == "threat" else (item.description,)
            if name_asked.casefold() in map(str.casefold, names):
                called.append((kind, name, item))
            text = "\n".join((*names, *others)).casefold()
            if all(kind_of[word] == kind if word in kind_of else _has_word(text, word) for word in asked):
                alike.append((kind, name, item))
    if found := called or alike:
        return found
    entries = [entry for kind in KINDS for entry in library.entries[kind].values()]
    known = [*(name for kind in KINDS for name in library.known(kind)), *threats]
    message = f'no entry of the library has the words "{name_asked}"{hint(name_asked, entries, known)}'
    raise mistake("library", name_asked, message)


def _has_word(text: str, word: str) -> bool:
    """Return whether a text contains a word; its numbers must be complete there: "4" is no part of "4569"."""
    before, after = r"(?<!\d)(?<!\d\.)" * word[0].isdigit(), r"(?!\.?\d)" * word[-1].isdigit()
    return re.search(f"{before}{re.escape(word)}{after}", text) is not None
