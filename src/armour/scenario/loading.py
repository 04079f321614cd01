"""A scenario: read, checked whole, immutable; and what it means to the core."""

from collections.abc import Mapping
from copy import deepcopy
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import PrivateAttr, ValidationError, field_validator

from armour.core.state import Parameters
from armour.errors import InputError, Problem
from armour.files import read_toml, write_atomic
from armour.scenario.distributions import Uncertainty
from armour.scenario.library import (
    KINDS,
    Kind,
    Library,
    LibraryEntry,
    penetrator_length_mm,
    read_library,
    shipped_library,
)
from armour.scenario.messages import Section, key_name, problems_of
from armour.scenario.schema import (
    ArmourSection,
    BallisticLimitSection,
    DesignSection,
    Impact,
    LibrarySection,
    Model,
    Optimise,
    Solver,
    Threat,
    printable,
)
from armour.units import GPA, MM, MPA


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
        return printable(title)

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
    ) -> Parameters:
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
        return Parameters(
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
    write_atomic(Path(path), scenario.to_toml().encode())


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
