"""Scenarios: reading, validation and conversion to the core's parameters."""

from collections.abc import Iterable, Mapping
from copy import deepcopy
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import tomli_w
from pydantic import PrivateAttr, ValidationError

from armour.core.state import Parameters
from armour.errors import InputError, Problem, refuse, suggestion
from armour.files import located, read_toml, shipped_files, shipped_suites, write_atomic
from armour.scenario.assignments import Parts, changed, leaves, parts_of
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
from armour.scenario.parameters import ROLES, entry_of, fields_of, inputs_of, with_inputs
from armour.scenario.reach import check_not_twice
from armour.scenario.schema import (
    SHEAR_LAWS,
    ArmourSection,
    BallisticLimitSection,
    DesignSection,
    Impact,
    LibrarySection,
    Line,
    Model,
    Optimise,
    Solver,
    Threat,
)
from armour.units import MM


class _Source(NamedTuple):
    data: dict[str, Any]
    file: str  # name for messages
    folder: Path  # of the library files that the scenario names


class Scenario(Section):
    """A validated scenario: an impact, an armour and settings of the computations.

    `load_scenario` and `parse_scenario` make scenarios.
    """

    title: Line = ""
    author: Line = ""
    project: Line = ""
    date: Line = ""
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

    _entries: Library = PrivateAttr(default_factory=Library)
    _source: _Source = PrivateAttr(default_factory=lambda: _Source({}, "", Path()))

    @property
    def file(self) -> str:
        """Name of the scenario's file, for messages."""
        return self._source.file

    def entry(self, kind: Kind, name: str) -> LibraryEntry:
        """Return an entry of the scenario's library."""
        return self._entries.entries[kind][name]

    def core_armour(self) -> Parameters:
        """Return projectile and armour as parameters of the core, SI units."""
        fields: dict[str, Any] = dict.fromkeys(Parameters._fields, 0.0) | fields_of(inputs_of(self))
        fields["L0"] = penetrator_length_mm(self.entry("projectile", self.impact.projectile)) * MM
        fields["shear_law"] = SHEAR_LAWS[self.model.shear_perimeter]
        return Parameters(**fields)

    def areal_density_kg_m2(self) -> float:
        """Compute the areal density of the armour, kg/m²."""
        armour = self.core_armour()
        return armour.rho_c * armour.Hc0 + armour.rho_B * armour.Hb

    def replaced(self, changes: Mapping[str, object]) -> "Scenario":
        """Return the scenario with other values by dotted key, such as ``{"impact.velocity_m_s": 900.0}``.

        A key may also be an input, such as ``"ceramic.flow_stress_GPa"``.  A table is merged into an existing one.  The
        scenario is validated again; an InputError lists every mistake.
        """
        data, file, folder = self._source
        return parse_changed(data, changes, file=file, folder=folder)

    def to_toml(self) -> str:
        """Return the scenario as the text of a TOML file."""
        return tomli_w.dumps(self._source.data)


def load_scenario(path: str | PathLike[str], changes: Mapping[str, object] | None = None) -> Scenario:
    """Read a scenario from a TOML file.

    Parameters
    ----------
    path : path-like
        Where there is no such file, a shipped scenario of this name, such as ``"wilkins"``, is read.  Paths of library
        files in the scenario are relative to the folder of the file.
    changes : mapping of str to object, optional
        Values by dotted key, such as ``{"impact.velocity_m_s": 900.0}``, or by input, such as
        ``{"ceramic.flow_stress_GPa": 4.5}``, in place of the file's; a table is merged into an existing one.

    Returns
    -------
    Scenario

    Raises
    ------
    InputError
        With every mistake in the file and in the library files that it names.
    """
    path = scenario_file(Path(path))
    return parse_changed(read_toml(path), changes or {}, file=str(path), folder=path.parent)


def scenario_file(path: Path, others: Mapping[str, Path] | None = None) -> Path:
    """Return the file at a path or, where there is none, the shipped scenario, or other file, of that name."""
    known = {**shipped_files("scenarios", ".toml"), **(others or {})}
    listed = "; `armour init --list` lists the shipped scenarios"
    if str(path) not in known and not path.exists():
        kinds = {f"{name}.csv": "table of tests" for name in shipped_files("scenarios/tests", ".csv")}
        if kind := (kinds | dict.fromkeys(shipped_suites(), "suite")).get(str(path)):
            raise InputError([Problem(str(path), "", f"must be a scenario, is the name of a shipped {kind}{listed}")])
    return located(path, known, listed)


def save_scenario(scenario: Scenario, path: str | PathLike[str]) -> None:
    """Write a scenario to a TOML file, atomically.

    Parameters
    ----------
    scenario : Scenario
    path : path-like

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    write_atomic(Path(path), scenario.to_toml().encode())


def parse_scenario(data: Mapping[str, Any], *, file: str = "scenario", folder: str | PathLike[str] = ".") -> Scenario:
    """Make a scenario from plain data.

    Parameters
    ----------
    data : mapping
        Content of a scenario file.
    file : str
        Name of the scenario for messages.
    folder : path-like
        Folder that paths of library files are relative to.

    Returns
    -------
    Scenario

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
    refuse(problems)
    scenario._entries = library
    scenario._source = source
    return scenario


def parse_changed(data: Mapping[str, Any], *changes: Mapping[str, object], file: str, folder: Path) -> Scenario:
    """Make a scenario from plain data with other values by dotted key or input, one mapping after the other.

    Inputs are those of the scenario with all other changes, whatever their order.
    """
    inputs: dict[str, Any] = {}
    others: list[Parts] = []
    for group in filter(None, changes):
        by_role = {key: value for key, value in group.items() if _names_a_role(key)}
        inputs |= {key_name(leaf): value for leaf, value in leaves(changed({}, by_role, file))}
        rest = {key: value for key, value in group.items() if key not in by_role}
        data = _based(changed(data, rest, file), data, rest, file, folder)
        others += (leaf for key, value in rest.items() for leaf, _ in leaves(value, parts_of(key)))
    made = parse_scenario(data, file=file, folder=folder)
    if not inputs:
        return made
    check_not_twice(made, inputs, others)
    try:
        return with_inputs(made, inputs)
    except InputError as error:
        raise InputError([_told_of(made, inputs, problem) for problem in error.problems]) from None


def _told_of(scenario: Scenario, inputs: Iterable[str], problem: Problem) -> Problem:
    """Return a problem in an entry of the scenario as one with the input that sets its key or, if none, another one."""
    table, _, key = problem.key.rpartition(".")
    for role in ROLES:
        entry = entry_of(scenario, role)
        own = [name for name in inputs if name.startswith(f"{role}.")]
        if own and entry is not None and table == key_name(["library", entry.kind, entry.name]):
            return problem._replace(key=f"{role}.{key}" if f"{role}.{key}" in own else own[0])
    return problem


def _names_a_role(key: str) -> bool:
    """Return whether a key is an input by role, or meant to be."""
    try:
        section = parts_of(key)[0]
    except ValueError:
        return False
    return section not in Scenario.model_fields and bool(suggestion(section, list(ROLES)))


def _based(
    data: dict[str, Any], before: Mapping[str, Any], keys: Iterable[str], file: str, folder: Path
) -> dict[str, Any]:
    """Return changed data where an entry of which keys set single values, new to the data, is based on its namesake."""
    bases: dict[str, object] = {}
    for section, *entry in map(parts_of, keys):
        if section == "library" and len(entry) > 2:
            kind, name, *_ = entry
            is_new = name not in _table(_table(before, "library"), kind)
            if is_new and "based_on" not in _table(_table(_table(data, "library"), kind), name):
                library, _, _ = _library_of(_Source(dict(before), file, folder))
                if any(kind == known and name in entries for known, entries in library.entries.items()):
                    bases[key_name(["library", kind, name, "based_on"])] = name
    return changed(data, bases, file)


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario file, for editors.

    It does not cover names of the library, nor conditions on several keys.
    """
    schema = Scenario.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "armour scenario"}


def _library_of(source: _Source) -> tuple[Library, dict[Kind, list[str]], list[Problem]]:
    """Return the scenario's library, the known names by kind and the mistakes in it.

    A name is known even if its entry has a mistake, so that one mistake gives one message.
    """
    library, problems = shipped_library(), []
    tables = _table(source.data, "library")
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
    names: dict[Kind, list[str]] = {kind: [*library.names(kind), *_table(tables, kind)] for kind in KINDS}
    try:
        library = library.extended(LibrarySection.model_validate(tables), source.file, "library")
    except ValidationError:
        pass  # the validation of the whole scenario reports it
    except InputError as error:
        problems.extend(error.problems)
    return library, names, problems


def _table(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Return a table of data that is not validated yet; {} if there is none."""
    found = data.get(key)
    return found if isinstance(found, dict) else {}
