"""Scenarios: reading, validation and conversion to the core's parameters."""

import json
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from functools import cached_property
from hashlib import sha256
from itertools import chain
from os import PathLike
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import tomli_w
from pydantic import PrivateAttr, ValidationError

from armour.core.state import Parameters
from armour.errors import InputError, Note, Problem, choices, joined, mistake, refuse, restated, suggestion
from armour.files import located, named, read_toml, shipped_files, write_file
from armour.scenario import keys, schema
from armour.scenario.checked import checked
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, NAMES, OBLIQUITY, ROD, ROLES, VELOCITY, Kind, fields_of
from armour.scenario.library import KINDS, THREAT_KEYS, Library, LibraryEntry, is_slender, read_library, shipped_library
from armour.scenario.sections import NOT_TINY, NUMBER, TINY, Items, Section, every_problem, model_in
from armour.units import MM, key_hint

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# Takes the index of a row and a problem in it, and returns the problem with the row named.
Place = Callable[[int, Problem], Problem]
# What a title says in place of a scenario's own values, by key: names to list, or nothing of a number to leave out.
Varied = Mapping[str, Sequence[object]]
# For the title of a result whose velocity is searched for.
ANY_VELOCITY: Varied = {VELOCITY: ()}
# Greatest number of names and threats to list.
MAX_LISTED = 3
LEFT_OUT_AT_ANGLES = "ricochet, yaw and bending of the core are not in the model"
EXACT_INPUTS = "the probability and interval take the inputs as exact; armour uncertainty includes their distributions"


def in_row(row: int, problem: Problem) -> Problem:
    """Return a problem whose key begins with "row n: ", counted from 1; `row` is the index, from 0."""
    return problem._replace(key=f"row {row + 1}: {problem.key}")


class _Source(NamedTuple):
    """What a scenario is parsed from."""

    data: dict[str, Any]
    file: str  # name for messages
    folder: Path  # of the library files that the scenario names


class Scenario(Section):
    """A validated scenario: an impact, an armour and settings of the computations.

    `load_scenario` and `parse_scenario` make scenarios.  A scenario cannot be changed: `replaced` returns one with
    other values.  Sections and keys of the file are attributes, as in ``scenario.impact.velocity_m_s``.
    """

    title: schema.Line = ""
    """Title, shown below the armour and the round."""
    author: schema.Line = ""
    """Author, shown in reports."""
    project: schema.Line = ""
    """Project, shown in reports."""
    date: schema.Line = ""
    """Date, shown in reports."""
    impact: schema.Impact
    """The projectile and its velocity."""
    armour: schema.ArmourSection
    """The armour."""
    model: schema.Model = schema.Model()
    """Options of the model."""
    solver: schema.Solver = schema.Solver()
    """Settings of the solver."""
    ballistic_limit: schema.BallisticLimitSection = schema.BallisticLimitSection()
    """Range and tolerance of the search for the ballistic limit."""
    optimise: schema.Optimise | None = None
    """Grid of designs."""
    threat: Items[schema.Threat] = ()
    """Threats, all of which a design must stop; by default [impact]."""
    design: schema.DesignSection | None = None
    """Catalogue of materials, with constraints and the objective; in place of the grid."""
    uncertainty: schema.Uncertainty | None = None
    """Uncertain inputs, and how they are sampled."""
    library: schema.LibrarySection = schema.LibrarySection()
    """Projectiles and materials that the scenario adds to the library."""

    _entries: Library = PrivateAttr(default_factory=Library)
    _source: _Source = PrivateAttr(default_factory=lambda: _Source({}, "", Path()))

    def model_post_init(self, context: Any) -> None:
        """Raise an InputError for a scenario that is made from sections directly, and so has no library."""
        if context is None:
            raise mistake("Scenario", "", "must be made by load_scenario or parse_scenario")

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> "Scenario":
        """Return a copy, with the sections in `update` in place of its own; it is validated as by `replaced`."""
        if update is None:
            return super().model_copy(deep=deep)
        sections = {key: keys.Whole(value) if isinstance(value, Mapping) else value for key, value in update.items()}
        return self.replaced(sections)

    def copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> "Scenario":  # type: ignore[override]
        """Return a copy as `model_copy` does, which has replaced this method in pydantic."""
        return self.model_copy(update=update, deep=deep)

    @property
    def file(self) -> str:
        """Name of the scenario's file, for messages."""
        return self._source.file

    @property
    def notes(self) -> tuple[str, ...]:
        """A line for each entry that overrides another, and one on what the model leaves out at an angle."""
        impacts = {"impact": self.impact, **{f"threat[{i}]": threat for i, threat in enumerate(self.threat)}}
        oblique = [key for key in impacts if impacts[key].obliquity_deg]
        left_out = [f"{self.file}: {key}.obliquity_deg: {LEFT_OUT_AT_ANGLES}" for key in oblique[:1]]
        return (*self._entries.notes, *left_out)

    def entry(self, kind: Kind, name: str) -> LibraryEntry:
        """Return an entry of the scenario's library; if there is none, an InputError suggests the closest name."""
        return self._entries.entry(kind, name)

    @property
    def entries(self) -> Library:
        """The library that the scenario's names refer to."""
        return self._entries

    def name_of(self, role: str) -> str | None:
        """Return the name of the library entry in a role; None if the scenario names no ceramic."""
        section, key = NAMES[role].split(".")
        return getattr(getattr(self, section), key)

    def entry_of(self, role: str) -> LibraryEntry | None:
        """Return the library entry in a role; None if the scenario names no ceramic."""
        name = self.name_of(role)
        return None if name is None else self.entry(ROLES[role], name)

    def inputs(self) -> dict[str, float]:
        """Return the values of the inputs that the scenario has, by name, in the units of the names.

        A bare plate has no inputs of the ceramic.  The coefficients of a law of its flow stress are inputs only if its
        entry has them, and the yield strength only if other properties of the metal are derived from it.
        """
        return dict(self._inputs)

    @cached_property
    def _inputs(self) -> dict[str, float]:
        """Values of `inputs`, computed once."""
        values: dict[str, float] = {
            name: getattr(getattr(self, definition.section), definition.key)
            for name, definition in INPUTS.items()
            if definition.kind is None and (name != CERAMIC or self.armour.ceramic is not None)
        }
        for role in ROLES:
            if entry := self.entry_of(role):
                values |= entry.inputs_as(role)
        return values

    def check_names(self, names: Iterable[str], file: str, key: str = "") -> None:
        """Raise an InputError unless all names are inputs of the scenario.

        Its messages say where the names are: in `file`, under `key` or, without a key, under the name itself.
        """
        inputs = list(self.inputs())
        problems = []
        for name in names:
            if name not in inputs:
                did_you_mean = f'; did you mean "{NAMES[name]}"?' if name in NAMES else ""
                hint = did_you_mean or key_hint(name, inputs) or choices(name, inputs)
                problems.append(Problem(file, key or name, f'must name an input of the scenario, found "{name}"{hint}'))
        refuse(problems)

    def with_inputs(self, values: Mapping[str, float]) -> "Scenario":
        """Return the scenario with other values of inputs, validated again."""
        self.check_names(values, self.file)
        names = {keys.key_name(self.parts_of_input(name)): name for name in values}
        with restated(lambda problem: problem._replace(key=names.get(problem.key, problem.key))):
            return self.replaced({key: values[name] for key, name in names.items()})

    def parts_of_input(self, name: str) -> keys.Parts:
        """Return the parts of the key that holds an input; an input of a role is held by its entry of the library."""
        section, key = name.split(".")
        entry = self.entry_of(section) if section in ROLES else None
        return (section, key) if entry is None else ("library", entry.kind, entry.name, key)

    def core_armour(self) -> Parameters:
        """Return projectile and armour as parameters of the core, SI units; thicknesses along the line of fire."""
        return self._parameters

    @cached_property
    def _parameters(self) -> Parameters:
        """Parameters of `core_armour`, computed once."""
        fields: dict[str, Any] = dict.fromkeys(Parameters._fields, 0.0) | fields_of(self._inputs, self.impact.cosine)
        return Parameters(**(fields | self.model.laws()))

    def inert(self, key: str) -> float:
        """Return the sum of a quantity over the layers without ballistic effect, by its key, such as "thickness_mm"."""
        return sum((getattr(layer, key) for layer in self.armour.layer), 0.0)

    def cross_section(self) -> list[tuple[str, str, float]]:
        """Return the layers from the front, each as "ceramic", "metal" or "inert" with its name and thickness, mm."""
        armour = self.armour
        front, between, behind = (
            [("inert", layer.name, layer.thickness_mm) for layer in armour.layer if layer.place == place]
            for place in ("front", "between", "behind")
        )
        tile = [("ceramic", armour.ceramic or "", armour.ceramic_thickness_mm)] * (armour.ceramic_thickness_mm > 0.0)
        plate = ("metal", armour.backing, armour.backing_thickness_mm)
        return [*front, *tile, *between, plate, *behind]

    @property
    def interlayers(self) -> int:
        """Number of layers without ballistic effect between tile and back plate, of which no shipped test has one."""
        return sum(layer.place == "between" for layer in self.armour.layer)

    @property
    def counts_backing(self) -> bool:
        """Whether the back plate counts for areal density, thickness and cost: not if it exists already."""
        return self.design is None or self.design.existing is None

    def areal_density_kg_m2(self, *, whole: bool = False) -> float:
        """Return the areal density of the armour, kg/m²; of the `whole` one, with a back plate that exists already."""
        parameters, counts = self.core_armour(), whole or self.counts_backing
        ceramic, backing = self.armour.ceramic_thickness_mm * MM, self.armour.backing_thickness_mm * MM
        return parameters.rho_c * ceramic + parameters.rho_B * backing * counts + self.inert("areal_density_kg_m2")

    def thickness_mm(self, *, whole: bool = False) -> float:
        """Return the thickness of the armour, mm; of the `whole` one, with a back plate that exists already."""
        backing = self.armour.backing_thickness_mm * (whole or self.counts_backing)
        return self.armour.ceramic_thickness_mm + backing + self.inert("thickness_mm")

    def cost_per_m2(self) -> float | None:
        """Return the cost of the armour per m², without a back plate that exists; None unless all layers have costs."""
        if self.design is None or not all(layer.has_cost() for layer in self.armour.layer):
            return None
        total, armour, parameters = self.inert("cost_per_m2"), self.armour, self.core_armour()
        for options, name, density, thickness in (
            (self.design.ceramic, armour.ceramic, parameters.rho_c, armour.ceramic_thickness_mm),
            (self.design.backing, armour.backing, parameters.rho_B, armour.backing_thickness_mm * self.counts_backing),
        ):
            layer = next((option for option in options if option.material == name and option.has_cost()), None)
            if layer is not None:
                total += layer.cost(density, thickness)
            elif thickness > 0.0:
                return None
        return total

    def cosine(self) -> float:
        """Return the cosine of the obliquity."""
        return self.impact.cosine

    def armour_words(self) -> str:
        """Return thicknesses and names of the layers, such as "6.35 mm AD85 on 6.35 mm 6061-T6"."""
        return layers(self.armour, {})

    def subject(self, varied: Varied | None = None, threats: Sequence[schema.Threat] = ()) -> str:
        """Return armour and round, such as "6.35 mm AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s".

        Threats are named in place of the scenario's impact, and values of `varied` in place of its own.
        """
        return f"{layers(self.armour, varied or {})} against {rounds(self.impact, varied or {}, threats)}"

    def __repr__(self) -> str:
        title = f"; scenario: {self.title}" if self.title else ""
        return f"<Scenario: {self.subject()}{title}>"

    __str__ = __repr__

    def named_entries(self) -> list[tuple[Kind, str]]:
        """Return kind and name of each entry of the library that armour, impact, threats and designs name."""
        named = [(kind, self.name_of(role)) for role, kind in ROLES.items()]
        named += [("projectile", threat.projectile) for threat in self.threat]
        if self.design is not None:
            named += [("ceramic", layer.material) for layer in self.design.ceramic]
            named += [("metal", layer.material) for layer in self.design.backing]
        return [(kind, name) for kind, name in named if name is not None]

    def digest(self, *, whole_library: bool = False) -> str:
        """Return a hash of the validated content: every section, and the entries of the library that sections name.

        With ``whole_library``, every entry of the library counts.
        """
        entries: Iterable[LibraryEntry] = (self.entry(*named) for named in self.named_entries())
        if whole_library:
            entries = chain.from_iterable(by_name.values() for by_name in self._entries.entries.values())
        library: dict[str, dict[str, Any]] = {}
        for entry in entries:
            library.setdefault(entry.kind, {})[entry.name] = entry.content()
        content = {**self.model_dump(mode="json"), "library": library}
        return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    def basis(self) -> dict[str, str]:
        """Return hashes of what an answer rests on besides tile, plate, threats and what is required, by key.

        These are settings other than the defaults, layers, prices, and own entries of the library with their own tests.
        """
        settings, design = {"model", "solver", "ballistic_limit", "uncertainty"}, self.design or schema.DesignSection()
        parts = self.model_dump(mode="json", include=settings, exclude_defaults=True)
        for key in ("angles_as_at_normal_incidence", "existing", "scatter_percent"):
            parts[f"design.{key}"] = getattr(design, key)
        # A cost that is given as 0 is known, and one that is left out is not.
        parts["armour.layer"] = [layer.model_dump(exclude={"name"}, exclude_unset=True) for layer in self.armour.layer]
        for key, options in (("design.ceramic", design.ceramic), ("design.backing", design.backing)):
            prices = [each for each in options if each.has_cost()]
            parts[key] = [each.model_dump(exclude={"thickness_mm"}, exclude_unset=True) for each in prices]
        for kind, name in self.named_entries():
            if (entry := self.entry(kind, name)).file:
                parts[keys.key_name(("library", kind, entry.name))] = entry.content()
        return {
            key: sha256(json.dumps(part, sort_keys=True).encode()).hexdigest() for key, part in parts.items() if part
        }

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and self.digest(whole_library=True) == other.digest(whole_library=True)

    def __hash__(self) -> int:
        return hash(self.digest())

    def to_dict(self) -> dict[str, Any]:
        """Return the content of a scenario file as plain data, which `parse_scenario` reads."""
        return deepcopy(self._source.data)

    @checked
    def replaced(self, changes: Mapping[str, object]) -> "Scenario":
        """Return the scenario with other values by dotted key, such as ``{"impact.velocity_m_s": 900.0}``.

        A key may also be an input, such as ``"ceramic.flow_stress_GPa"``.  A table is merged into an existing one.  The
        scenario is validated again; an InputError lists every mistake.
        """
        data, file, folder = self._source
        with restated(lambda problem: problem._replace(file="replaced") if problem.file == file else problem):
            return parse_changed(data, changes, file=file, folder=folder)

    @checked
    def requiring(self, probability: schema.RequiredProbability | None) -> "Scenario":
        """Return the scenario with a least probability of stopping each threat; a higher one that it requires stays."""
        if probability is None:
            return self
        section, most = self.design or schema.DesignSection(), 1.0 - probability
        tables = self.to_dict().get("threat", [])
        for table in tables:
            if table.get("probability_of_perforation", 0.0) > most:
                table["probability_of_perforation"] = most
        least = max(probability, section.probability_of_stopping or 0.0)
        return self.replaced({"design.probability_of_stopping": least, **({"threat": tables} if tables else {})})

    def to_toml(self, folder: str | PathLike[str] | None = None) -> str:
        """Return the scenario as the text of a TOML file, in which paths of library files are relative to a folder.

        By default this is the folder that they are relative to already.
        """
        data = dict(self._source.data)
        if folder is not None and self.library.files:
            files = [relpath(self._source.folder / file, folder) for file in self.library.files]
            data["library"] = {**data["library"], "files": files}
        return tomli_w.dumps(data)

    def check_rows(self, columns: Mapping[str, "NDArray[np.float64]"], place: Place = in_row) -> None:
        """Raise an InputError unless the scenario allows every row of other values of inputs.

        `columns` has the values by name of input, (n,) each, for n rows.  `place` names the row in a problem, given the
        index of the row.
        """
        first_problems: dict[str, Problem] = {}
        for _, row, problems in sorted(self.wrong_rows(columns), key=operator.itemgetter(1)):
            for problem in problems:
                first_problems.setdefault(problem.key, place(row, problem))
        refuse(first_problems.values())

    def wrong_rows(self, columns: Mapping[str, "NDArray[np.float64]"]) -> Iterator[tuple[str, int, Sequence[Problem]]]:
        """Yield the first row that breaks each condition on inputs: an input's name, the row's index and its problems.

        If there is none, `with_inputs` accepts every row.  Only projectiles that are based on the scenario's, which no
        row uses, are not checked.
        """
        # Imported here because a scenario without rows does not need numpy.
        import numpy as np

        self.check_names(columns, self.file)
        conditions = [(name, _within_bounds(name, values)) for name, values in columns.items()]
        if VELOCITY in columns:
            conditions.append((VELOCITY, columns[VELOCITY] > self.solver.arrest_velocity_m_s))
        if changed_rod := [name for name in ROD if name in columns]:
            with np.errstate(all="ignore"):
                conditions.append((changed_rod[-1], is_slender({**self.inputs(), **columns})))
        for name, allowed in conditions:
            if not np.all(allowed):
                row = int(np.argmin(allowed))
                try:
                    self.with_inputs({key: float(values[row]) for key, values in columns.items()})
                except InputError as error:
                    yield name, row, error.problems

    def distributions(self) -> dict[str, schema.Distribution]:
        """Return the distributions of inputs, by name."""
        return {} if self.uncertainty is None else self.uncertainty.inputs()

    def excludes_error(self) -> bool:
        """Return whether the scenario excludes the model error."""
        return bool(self.uncertainty and self.uncertainty.model and not self.uncertainty.model.included)

    def required_probabilities(self) -> tuple[float | None, ...]:
        """Return the probability of stopping each threat that is required; None where none is."""
        bounds = ((self.design or schema.DesignSection()).bound(threat) for threat in self.threats())
        return tuple(None if bound is None else 1.0 - bound for bound in bounds)

    def threats(self) -> tuple[schema.Threat, ...]:
        """Return the threats; without any, the impact."""
        return tuple(self.threat) or (schema.Threat.model_construct(**self.impact.model_dump()),)

    def against(self, threat: schema.Threat) -> "Scenario":
        """Return the scenario with a threat as its impact."""
        return self.replaced(threat.as_impact()) if self.threat else self

    def unused_distributions(self) -> tuple[Note, ...]:
        """Return a warning, for a result that takes inputs as exact, if the scenario has distributions of inputs."""
        return (Note(EXACT_INPUTS, "uncertainty"),) if self.distributions() else ()

    def unused_impact(self) -> tuple[Note, ...]:
        """Return a warning, for a result of the threats, if the impact is not one of them."""
        impact = schema.Threat.model_construct(**self.impact.model_dump())
        if not self.threat or impact.as_impact() in [threat.as_impact() for threat in self.threat]:
            return ()
        words = f"{schema.shot(impact)} of [impact] is not used: the threats of [[threat]] are, and it is none of them"
        return (Note(words, "impact"),)

    def unused_threats(self) -> tuple[Note, ...]:
        """Return a warning, for a result of the section ``impact``, if the scenario has threats of its own."""
        if not self.threat:
            return ()
        text = (
            f"is not used: the results are against the {schema.shot(self.impact)} of [impact]; "
            "armour check gives the probability for every threat"
        )
        return (Note(text, "threat"),)


def rounds(impact: schema.Impact, varied: Varied, threats: Sequence[schema.Threat]) -> str:
    """Return round and velocity, such as "7.62 mm AP at 800 m/s", of threats or, without any, of an impact.

    Values of `varied` replace those of the impact.
    """
    if len(threats) > MAX_LISTED:
        return f"{len(threats)} threats"
    if threats:
        return joined([schema.shot(threat) for threat in threats])
    names = _names(varied.get(NAMES["projectile"], [impact.projectile]), "different rounds")
    speed = "" if VELOCITY in varied else f" at {impact.velocity_m_s:g} m/s"
    return f"{names}{speed}{'' if OBLIQUITY in varied else schema.at_angle(impact)}"


def layers(armour: schema.ArmourSection, varied: Varied) -> str:
    """Return thicknesses and names of the layers, such as "6.35 mm AD85 on 6.35 mm 6061-T6".

    Values of `varied` replace those of the armour.
    """
    ceramic = _names(varied.get(NAMES["ceramic"], [armour.ceramic]), "ceramic")
    plate = _names(varied.get(NAMES["backing"], [armour.backing]), "metal")
    if BACKING not in varied:
        plate = f"{round(armour.backing_thickness_mm, 3):g} mm {plate}"
    if CERAMIC not in varied:
        ceramic = f"{round(armour.ceramic_thickness_mm, 3):g} mm {ceramic}" if armour.ceramic_thickness_mm else ""
    return f"{ceramic} on {plate}" if ceramic else plate


def _names(names: Sequence[object], unknown: str) -> str:
    """List the different names, without None, as words of a title; return the word `unknown` if the list is empty."""
    words = [str(name) for name in dict.fromkeys(names) if name]
    if len(words) > MAX_LISTED:
        words = [*words[:MAX_LISTED], f"{len(words) - MAX_LISTED} more"]
    return joined(words or ["" if names else unknown], "or")


@checked
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
    return parse_changed(read_toml(path), changes or {}, file=named(path), folder=path.parent)


def scenario_file(path: Path, other_files: Mapping[str, Path] | None = None) -> Path:
    """Return the file at a path or, if there is none, the shipped scenario, or other file, of that name."""
    return located(path, {**shipped_files("scenarios", ".toml"), **(other_files or {})})


def files_of(scenario: Scenario) -> list[Path]:
    """Return the files that a scenario is read from: its own, and its library files."""
    source = scenario._source
    return [Path(source.file), *(source.folder / file for file in scenario.library.files)]


@checked
def save_scenario(scenario: Scenario, path: str | PathLike[str]) -> None:
    """Write a scenario to a TOML file, atomically; a file of this name is replaced.

    Parameters
    ----------
    scenario : Scenario
    path : path-like
        Paths of library files in the scenario are made relative to the folder of the file.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    path = Path(path)
    write_file(path, scenario.to_toml(path.parent).encode())


@checked
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
    return parse_changed(data, file=file, folder=Path(folder))


def _parsed(source: _Source) -> Scenario:
    """Make a scenario from its source; an InputError lists every mistake."""
    library, names, problems = _library_of(source)
    try:
        scenario = Scenario.model_validate(source.data, context={"names": names, "library": library})
    except ValidationError as error:
        own = every_problem(error, Scenario, source.data, source.file, lambda rest: _parsed(source._replace(data=rest)))
        raise InputError(list(dict.fromkeys((*problems, *own)))) from None
    looks: set[str] = set()
    for i, threat in enumerate(scenario.threat):
        if (look := keys.plain_name(threat.title)) in looks:
            message = f'must be different for each threat, found "{threat.title}" twice'
            problems.append(Problem(source.file, f"threat[{i}].name", message))
        looks.add(look)
    slowest = min(impact.velocity_m_s for impact in (scenario.impact, *scenario.threat))
    if slowest <= (arrest := scenario.solver.arrest_velocity_m_s):
        message = f"must be below the impact velocity, {slowest:g} m/s, found {arrest:g}"
        problems.append(Problem(source.file, "solver.arrest_velocity_m_s", message))
    refuse(problems)
    scenario._entries = library
    scenario._source = source._replace(data=keys.without_none(source.data))
    return scenario


def parse_changed(data: Mapping[str, Any], *changes: Mapping[str, object], file: str, folder: Path) -> Scenario:
    """Make a scenario from plain data with other values by dotted key or input, one mapping after the other.

    `file` is its name in messages; paths of library files are relative to `folder`.  Inputs are set last, so that they
    take precedence over keys of the library.  Changed numbers of the section ``library`` lose the source of the earlier
    number.
    """
    data, inputs = keys.with_plain_keys(data, file), dict[str, Any]()
    for group in (keys.with_plain_keys(group, file) for group in changes if group):
        by_role = {key: value for key, value in group.items() if _names_a_role(str(key))}
        by_key = {key: value for key, value in group.items() if key not in by_role}
        source, data = _Source(dict(data), file, folder), keys.changed(data, by_key, file)
        inputs |= {keys.key_name(leaf): value for leaf, value in keys.leaves(keys.changed({}, by_role, file))}
        values = keys.values_by_key(by_key)
        data = _with_new_threat(data, values)
        data = keys.changed(data, _bases(data, source, by_key) | _without_sources(values), file)
    scenario = _parsed(_Source(dict(data), file, folder))
    with restated(lambda problem: problem._replace(file=file)):
        return scenario.with_inputs(inputs) if inputs else scenario


def _with_new_threat(data: dict[str, Any], values: Mapping[keys.Parts, object]) -> dict[str, Any]:
    """Return the data of a scenario without its impact's THREAT_KEYS if the changed `values` name another threat.

    The threat then gives them; those that `values` set stay.
    """
    if values.get(("impact", "threat")) is None:
        return data
    earlier = [key for key in THREAT_KEYS if ("impact", key) not in values]
    return {**data, "impact": {key: value for key, value in _table(data, "impact").items() if key not in earlier}}


def _without_sources(values: Mapping[keys.Parts, object]) -> dict[str, object]:
    """Return, by key, the changed numbers of library entries as tables without the source of the earlier number.

    `values` has the changed values by the parts of their keys; numbers that change with their source are not returned.
    """
    return {
        keys.key_name(key[:4]): keys.Whole({NUMBER: value})
        for key, value in values.items()
        if key[0] == "library" and key[4:] == (NUMBER,) and (*key[:4], "source") not in values
    }


def _names_a_role(key: str) -> bool:
    """Return whether a key is an input by role, such as "ceramic.flow_stress_GPa", or a misspelling of one."""
    section = key.partition(".")[0]
    return section not in Scenario.model_fields and bool(suggestion(section, list(ROLES)))


def _bases(data: Mapping[str, Any], source: _Source, changed: Iterable[str]) -> dict[str, object]:
    """Return, by key, the entries of the library on which new entries are based, of which `changed` sets single values.

    New entries are those that the source lacks.  Such an entry is based on the one of its name in the library, unless
    the data name another base.
    """
    bases: dict[str, object] = {}
    for section, *entry in map(keys.parts_of, changed):
        if section == "library" and len(entry) > 2:
            kind, name, *_ = entry
            is_new = name not in _table(source.data, "library", kind)
            if is_new and "based_on" not in _table(data, "library", kind, name):
                library, _, _ = _library_of(source)
                if name in library.entries.get(kind, ()):  # type: ignore[call-overload]
                    bases[keys.key_name(["library", kind, name, "based_on"])] = name
    return bases


def _within_bounds(name: str, values: Any) -> Any:
    """Return whether each value of an input, (n,), lies within the bounds of its key; a NaN does not."""
    kind, section, key = INPUTS[name].kind, INPUTS[name].section, INPUTS[name].key
    model: Any = KINDS[kind] if kind else model_in(Scenario.model_fields[section].annotation)
    field = model.model_fields[key]
    inner = model_in(field.annotation)
    stated = field.metadata if inner is None else inner.model_fields[NUMBER].metadata
    allowed = values == values
    if NOT_TINY in stated:
        allowed &= (values == 0.0) | (abs(values) >= TINY)
    for bound in stated:
        for comparison in ("gt", "ge", "lt", "le"):
            if hasattr(bound, comparison):
                allowed &= getattr(operator, comparison)(values, getattr(bound, comparison))
    return allowed


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario file, with the meaning of each key, for editors.

    It does not cover names of the library, nor conditions on several keys.
    """
    of_keys = Scenario.model_json_schema()
    about = {"title": "armour scenario", "description": "An impact, an armour and settings of the computations."}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **of_keys, **about}


def _library_of(source: _Source) -> tuple[Library, dict[Kind, dict[str, str]], list[Problem]]:
    """Return a scenario's library, the name of each entry by kind and by each of its names, and the problems found.

    The names include those of entries with a mistake.  If a library file has a mistake, no names are returned and none
    are checked, so that each mistake gives one message.
    """
    library = shipped_library()
    problems: list[Problem] = []
    tables = _table(source.data, "library")
    files = tables.get("files")
    for index, file in enumerate(files if isinstance(files, list) else []):
        try:
            library = read_library(source.folder / file, library) if isinstance(file, str) else library
        except InputError as error:
            key = keys.key_name(["library", "files", index])
            for problem in error.problems:
                other = Problem(source.file, key, f'must name a library file, found "{file}", which {problem.message}')
                problems.append(problem if problem.key else other)
    is_unread, names = bool(problems), dict[Kind, dict[str, str]]()
    if not is_unread:
        names = {kind: library.known(kind) | {name: name for name in _table(tables, kind)} for kind in KINDS}
    try:
        library = library.extended(schema.LibrarySection.model_validate(tables), source.file, "library")
    except ValidationError:
        pass  # the validation of the whole scenario reports it
    except InputError as error:
        problems += (problem for problem in error.problems if not (is_unread and problem.key.endswith(".based_on")))
    return library, names, problems


def _table(data: Mapping[str, Any], *parts: str) -> Mapping[str, Any]:
    """Return a table of data that is not validated yet, by the keys that lead to it; {} if there is none."""
    for key in parts:
        table = data.get(key)
        data = table if isinstance(table, dict) else {}
    return data
