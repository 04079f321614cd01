"""The scenario's format: read, checked whole, immutable; and what it means to the core."""

from collections.abc import Mapping
from copy import deepcopy
from math import floor
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import (
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from armour.checks import Section, key_name, problems_of
from armour.core.state import Armour
from armour.distributions import Uncertainty
from armour.errors import InputError, Problem, nearest
from armour.files import read_toml, write_whole
from armour.library import (
    KINDS,
    Kind,
    Library,
    LibraryEntry,
    LibraryTables,
    penetrator_length_mm,
    read_library,
    shipped_library,
)
from armour.units import GPA, MM, MPA, US

# More values on an axis, or designs on a grid, than anyone means.
MOST_VALUES = 100_000
MOST_DESIGNS = 1_000_000

Thickness = Annotated[float, Field(gt=0.0, le=1e5)]
ThicknessOrNone = Annotated[float, Field(ge=0.0, le=1e5)]
FASTEST_M_S = 1e4
Velocity = Annotated[float, Field(gt=0.0, le=FASTEST_M_S)]
Positive = Annotated[float, Field(gt=0.0)]
# Costs and masses per area; the bound is there to catch mistakes.
Amount = Annotated[float, Field(ge=0.0, le=1e9)]


def _named(kind: Kind, name: str, info: ValidationInfo) -> str:
    """The name, which must be in the library."""
    known: list[str] = info.context["names"][kind] if info.context else [name]
    if name not in known:
        raise ValueError(f'must name a {kind} of the library, found "{name}"{nearest(name, known)}')
    return name


def _printable(text: str) -> str:
    """The text, which must be fit to print."""
    if not text.isprintable():
        raise ValueError(f"must be one line of printable text, found {text!r}")
    return text


class Impact(Section):
    """What strikes the armour, and how fast."""

    projectile: str
    velocity_m_s: Velocity

    @field_validator("projectile")
    @classmethod
    def _projectile(cls, name: str, info: ValidationInfo) -> str:
        return _named("projectile", name, info)


class ArmourSection(Section):
    """The armour: a ceramic tile, or none, on a metal back plate."""

    ceramic: str | None = None
    ceramic_thickness_mm: ThicknessOrNone
    backing: str
    backing_thickness_mm: Thickness

    @field_validator("ceramic")
    @classmethod
    def _ceramic(cls, name: str | None, info: ValidationInfo) -> str | None:
        return None if name is None else _named("ceramic", name, info)

    @field_validator("backing")
    @classmethod
    def _backing(cls, name: str, info: ValidationInfo) -> str:
        return _named("metal", name, info)

    @field_validator("ceramic_thickness_mm")
    @classmethod
    def _thickness(cls, thickness: float, info: ValidationInfo) -> float:
        if thickness > 0.0 and info.data.get("ceramic", "") is None:
            raise ValueError(f"must be 0 where no ceramic is named, found {thickness:g}; name one as armour.ceramic")
        return thickness


class Model(Section):
    """Readings of the paper that can be chosen."""

    shear_perimeter: Literal["conoid", "projectile"] = "conoid"


class Solver(Section):
    """Numerics."""

    time_step_us: Positive | None = None
    arrest_velocity_m_s: Velocity = 1.0

    @property
    def time_step(self) -> float:
        """The time step given, s; 0 where it is left to the core."""
        return 0.0 if self.time_step_us is None else self.time_step_us * US


class BallisticLimitSection(Section):
    """Range and tolerance of the search for the ballistic limit."""

    velocity_min_m_s: Velocity = 20.0
    velocity_max_m_s: Velocity = 4000.0
    tolerance_m_s: Annotated[float, Field(ge=1e-9)] = 0.01

    @model_validator(mode="after")
    def _ordered(self) -> "BallisticLimitSection":
        if self.velocity_min_m_s >= self.velocity_max_m_s:
            raise ValueError(
                "velocity_min_m_s must be below velocity_max_m_s, "
                f"found {self.velocity_min_m_s:g} and {self.velocity_max_m_s:g}"
            )
        return self


class Range(Section):
    """Evenly spaced values, the ends included where the step meets them."""

    min: ThicknessOrNone
    max: ThicknessOrNone
    step: Positive

    @model_validator(mode="after")
    def _countable(self) -> "Range":
        if self.min > self.max:
            raise ValueError(f"min must not be above max, found {self.min:g} and {self.max:g}")
        if self.count() > MOST_VALUES:
            raise ValueError(f"must hold at most {MOST_VALUES} values, found {self.count():.7g}; widen the step")
        return self

    def count(self) -> float:
        """How many values the range holds."""
        return floor(min((self.max - self.min) / self.step, 1e18) + 1e-9) + 1

    def values(self) -> tuple[float, ...]:
        """The values, rounded to what the file's own digits would give."""
        return tuple(round(self.min + i * self.step, 9) for i in range(int(self.count())))


class Optimise(Section):
    """The grid of designs."""

    ceramic_thickness_mm: Range
    backing_thickness_mm: Range

    @field_validator("backing_thickness_mm")
    @classmethod
    def _some_backing(cls, backing: Range) -> Range:
        if backing.min <= 0.0:
            raise ValueError(f"min must be greater than 0, found {backing.min:g}")
        return backing

    @model_validator(mode="after")
    def _not_absurd(self) -> "Optimise":
        designs = self.ceramic_thickness_mm.count() * self.backing_thickness_mm.count()
        if designs > MOST_DESIGNS:
            raise ValueError(f"must hold at most {MOST_DESIGNS} designs, found {designs:.3g}; widen the steps")
        return self


class Threat(Section):
    """A projectile and a velocity that a design must defeat, with what it must have in reserve."""

    name: str = ""
    projectile: str
    velocity_m_s: Velocity
    margin_m_s: Annotated[float, Field(ge=0.0, le=1e4)] = 0.0
    probability_of_perforation: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None

    @field_validator("projectile")
    @classmethod
    def _projectile(cls, name: str, info: ValidationInfo) -> str:
        return _named("projectile", name, info)

    @field_validator("name")
    @classmethod
    def _name(cls, name: str) -> str:
        return _printable(name)

    @model_validator(mode="after")
    def _within_reach(self) -> "Threat":
        if self.required_m_s > FASTEST_M_S:
            found = f"{self.velocity_m_s:g} and {self.margin_m_s:g}"
            raise ValueError(f"velocity_m_s and margin_m_s must be at most {FASTEST_M_S:g} together, found {found}")
        return self

    @property
    def required_m_s(self) -> float:
        """What the ballistic limit must be above."""
        return self.velocity_m_s + self.margin_m_s

    @property
    def title(self) -> str:
        """Its name, or projectile and velocity."""
        return self.name or f"{self.projectile} at {self.velocity_m_s:g} m/s"


class FreeRange(Section):
    """Any value between two."""

    min: ThicknessOrNone
    max: Thickness

    @model_validator(mode="after")
    def _ordered(self) -> "FreeRange":
        if self.min >= self.max:
            raise ValueError(f"min must be below max, found {self.min:g} and {self.max:g}")
        return self


def _kind_of_range(value: object) -> str:
    """Which of the kinds of thicknesses a value is meant to be."""
    if isinstance(value, list):
        return "<list>"
    stepped = isinstance(value, Range) or (isinstance(value, dict) and "step" in value)
    return "<range>" if stepped else "<free>"


Thicknesses = Annotated[
    Annotated[Annotated[list[ThicknessOrNone], Field(min_length=1)], Tag("<list>")]
    | Annotated[Range, Tag("<range>")]
    | Annotated[FreeRange, Tag("<free>")],
    Discriminator(_kind_of_range),
]


class Layer(Section):
    """A material to choose, and the thicknesses in which it is to be had."""

    material: str
    thickness_mm: Thicknesses
    cost_per_kg: Amount = 0.0
    cost_per_m2: Amount = 0.0
    density_kg_m3: Annotated[float, Field(ge=100.0, le=30000.0)] | None = None

    @property
    def free(self) -> bool:
        """Whether any thickness of its range is to be had."""
        return isinstance(self.thickness_mm, FreeRange)

    def thicknesses(self) -> tuple[float, ...]:
        """Thicknesses to be had, mm; the ends of a free range."""
        if isinstance(self.thickness_mm, Range):
            return self.thickness_mm.values()
        if isinstance(self.thickness_mm, FreeRange):
            return (self.thickness_mm.min, self.thickness_mm.max)
        return tuple(sorted(set(self.thickness_mm)))


class CeramicLayer(Layer):
    """A ceramic to choose."""

    @field_validator("material")
    @classmethod
    def _material(cls, name: str, info: ValidationInfo) -> str:
        return _named("ceramic", name, info)


class BackingLayer(Layer):
    """A metal to choose for the back plate."""

    @field_validator("material")
    @classmethod
    def _material(cls, name: str, info: ValidationInfo) -> str:
        return _named("metal", name, info)

    @field_validator("thickness_mm")
    @classmethod
    def _some(cls, thickness: object) -> object:
        least = min(thickness) if isinstance(thickness, list) else getattr(thickness, "min", 1.0)
        if least <= 0.0:
            raise ValueError(f"must be greater than 0, found {least:g}")
        return thickness


Objective = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]
Criterion = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2", "margin_m_s"]


class DesignSection(Section):
    """What a design is made of, what it must keep to and what makes one better than another."""

    minimise: Objective = "areal_density_kg_m2"
    pareto: Annotated[list[Criterion], Field(min_length=2, max_length=3)] | None = None
    runners_up_percent: Annotated[float, Field(ge=0.0, le=100.0)] = 5.0
    thickness_max_mm: Thickness | None = None
    areal_density_max_kg_m2: Positive | None = None
    cost_max_per_m2: Positive | None = None
    added_thickness_mm: ThicknessOrNone = 0.0
    added_areal_density_kg_m2: Amount = 0.0
    added_cost_per_m2: Amount = 0.0
    ceramic: list[CeramicLayer] = []
    backing: list[BackingLayer] = []

    @model_validator(mode="after")
    def _consistent(self) -> "DesignSection":
        if self.pareto is not None and len(set(self.pareto)) < len(self.pareto):
            raise ValueError("pareto must not name a criterion twice")
        counts = [
            sum(len(layer.thicknesses()) for layer in layers) for layers in (self.ceramic, self.backing) if layers
        ]
        if len(counts) == 2 and counts[0] * counts[1] > MOST_DESIGNS:
            raise ValueError(f"must hold at most {MOST_DESIGNS} designs, found {counts[0] * counts[1]}")
        return self


class LibrarySection(LibraryTables):
    """Entries that the scenario adds to the library."""

    files: list[str] = []


class _Source(NamedTuple):
    """Where a scenario comes from."""

    data: dict[str, Any]
    file: str
    folder: Path


class Scenario(Section):
    """A scenario, checked: an impact, an armour and how to compute.

    Make one with `load_scenario` or `parse_scenario`.
    """

    title: str = ""
    impact: Impact
    armour: ArmourSection
    model: Model = Model()
    solver: Solver = Solver()
    ballistic_limit: BallisticLimitSection = BallisticLimitSection()
    optimise: Optimise | None = None
    threat: list[Threat] = []
    design: DesignSection | None = None
    uncertainty: Uncertainty | None = None
    library: LibrarySection = LibrarySection()

    @field_validator("title")
    @classmethod
    def _title(cls, title: str) -> str:
        return _printable(title)

    _entries: Library = PrivateAttr(default_factory=Library)
    _source: _Source = PrivateAttr(default=_Source({}, "", Path()))

    @property
    def file(self) -> str:
        """File that the scenario was read from, for messages."""
        return self._source.file

    def entry(self, kind: Kind, name: str) -> LibraryEntry:
        """Entry of the scenario's library."""
        return self._entries.entries[kind][name]

    def core_armour(
        self,
        ceramic_thickness_mm: float | None = None,
        backing_thickness_mm: float | None = None,
    ) -> Armour:
        """Projectile and armour in the core's terms, with other thicknesses where they are given, mm."""
        Hc0, Hb = self._thicknesses(ceramic_thickness_mm, backing_thickness_mm)
        projectile = self.entry("projectile", self.impact.projectile)
        metal = self.entry("metal", self.armour.backing)
        rho_c = Ec = Yc0 = 0.0
        if self.armour.ceramic is not None:
            ceramic = self.entry("ceramic", self.armour.ceramic)
            rho_c = ceramic["density_kg_m3"]
            Ec = ceramic["youngs_modulus_GPa"] * GPA
            Yc0 = ceramic["flow_stress_GPa"] * GPA
        return Armour(
            L0=penetrator_length_mm(projectile) * MM,
            D0=projectile["penetrator_diameter_mm"] * MM,
            rho_p=projectile["density_kg_m3"],
            Yp=projectile["flow_stress_GPa"] * GPA,
            Hc0=Hc0 * MM,
            rho_c=rho_c,
            Ec=Ec,
            Yc0=Yc0,
            Hb=Hb * MM,
            rho_B=metal["density_kg_m3"],
            YB=metal["flow_stress_GPa"] * GPA,
            tau=metal["shear_strength_MPa"] * MPA,
            conoid=self.model.shear_perimeter == "conoid",
        )

    def areal_density_kg_m2(
        self,
        ceramic_thickness_mm: float | None = None,
        backing_thickness_mm: float | None = None,
    ) -> float:
        """Mass of the armour per area, with other thicknesses where they are given, mm."""
        armour = self.core_armour(ceramic_thickness_mm, backing_thickness_mm)
        return armour.rho_c * armour.Hc0 + armour.rho_B * armour.Hb

    def _thicknesses(self, ceramic: float | None, backing: float | None) -> tuple[float, float]:
        return (
            self.armour.ceramic_thickness_mm if ceramic is None else ceramic,
            self.armour.backing_thickness_mm if backing is None else backing,
        )

    def replaced(self, changes: Mapping[str, object]) -> "Scenario":
        """The scenario with other values, checked again.

        Parameters
        ----------
        changes : mapping of str to object
            Values by dotted key, such as ``{"impact.velocity_m_s": 900.0}``; tables are merged into those there.

        Raises
        ------
        InputError
            If a value is not allowed.
        """
        data, file, folder = self._source
        return parse_scenario(changed(data, changes), file=file, folder=folder)

    def to_toml(self) -> str:
        """The scenario as a file has it."""
        import tomli_w

        return tomli_w.dumps(self._source.data)


def load_scenario(path: str | PathLike[str], changes: Mapping[str, object] | None = None) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    path : path
        A TOML file; files that it names are looked for from its folder.
    changes : mapping of str to object, optional
        Values that take the place of the file's, by dotted key such as "impact.velocity_m_s"; tables are merged
        into those there.

    Raises
    ------
    InputError
        With every mistake in the file and in the library files that it names.
    """
    path = Path(path)
    data = changed(read_toml(path), changes or {})
    return parse_scenario(data, file=str(path), folder=path.parent)


def changed(data: Mapping[str, Any], changes: Mapping[str, object]) -> dict[str, Any]:
    """The data of a scenario with other values, by dotted key; a table is merged into the one that is there."""
    result = deepcopy(dict(data))
    for key, value in changes.items():
        *sections, last = key.split(".")
        table = result
        for section in sections:
            table = table.setdefault(section, {})
            if not isinstance(table, dict):
                break  # the check says that this must be a table
        else:
            _put(table, last, value)
    return result


def _put(table: dict[str, Any], key: str, value: object) -> None:
    """Set a value; merge a table into the one that is there."""
    there = table.get(key)
    if isinstance(value, Mapping) and isinstance(there, dict):
        for inner in value:
            _put(there, inner, value[inner])
    else:
        table[key] = deepcopy(value)


def save_scenario(scenario: Scenario, path: str | PathLike[str]) -> None:
    """Write a scenario to a TOML file, whole or not at all.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    write_whole(Path(path), scenario.to_toml().encode())


def parse_scenario(data: Mapping[str, Any], *, file: str = "scenario", folder: str | PathLike[str] = ".") -> Scenario:
    """Make a scenario of plain data.

    Parameters
    ----------
    data : mapping
        What a scenario file holds.
    file : str
        Name to use in messages.
    folder : path
        Where to look for the library files that it names.

    Raises
    ------
    InputError
        With every mistake.
    """
    source = _Source(deepcopy(dict(data)), file, Path(folder))
    library, names, problems = _library_of(source)
    try:
        scenario = Scenario.model_validate(source.data, context={"names": names})
    except ValidationError as error:
        raise InputError([*problems_of(error, Scenario, file), *problems]) from None
    if problems:
        raise InputError(problems)
    scenario._entries = library
    scenario._source = source
    return scenario


def scenario_schema() -> dict[str, Any]:
    """JSON Schema of a scenario file, for editors; names of the library and what spans several keys it cannot check."""
    schema = Scenario.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "armour scenario"}


def _library_of(source: _Source) -> tuple[Library, dict[Kind, list[str]], list[Problem]]:
    """The scenario's library, the names it knows and what is wrong in it.

    A name is known even where its entry is wrong: one mistake is one message.
    """
    library, problems = shipped_library(), []
    names: dict[Kind, list[str]] = {}
    tables = source.data.get("library")
    tables = tables if isinstance(tables, dict) else {}
    files = tables.get("files")
    for index, file in enumerate(files if isinstance(files, list) else []):
        if not isinstance(file, str):
            continue
        try:
            library = read_library(source.folder / file, library)
        except InputError as error:
            key = key_name(["library", "files", index])
            for problem in error.problems:
                whole = Problem(source.file, key, f'must name a library file, found "{file}", which {problem.message}')
                problems.append(problem if problem.key else whole)
    for kind in KINDS:
        inline = tables.get(kind)
        names[kind] = [*library.names(kind), *(inline if isinstance(inline, dict) else ())]
    try:
        section = LibrarySection.model_validate(tables)
        library = library.extended(section, source.file, "library")
    except ValidationError:
        pass  # the check of the whole scenario reports it
    except InputError as error:
        problems.extend(error.problems)
    return library, names, problems
