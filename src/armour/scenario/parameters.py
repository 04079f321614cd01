"""Inputs: the numbers of a scenario that results depend on, by name.

A name is either a key of the scenario, such as "armour.ceramic_thickness_mm", or a role and a key of the library, such
as "ceramic.flow_stress_GPa": a property of the scenario's ceramic, independent of the entry's name.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from operator import ge, gt, itemgetter, le, lt
from typing import TYPE_CHECKING, Any

from armour.errors import InputError, Problem, choices, refuse
from armour.scenario.library import FLOW_STRESS_LAW, KINDS, ROD, Entry, Kind, LibraryEntry, is_rod
from armour.scenario.messages import NOT_TINY, NUMBER, TINY, Section, key_name, model_in
from armour.scenario.schema import ArmourSection, Impact
from armour.units import GPA, MM, MPA, missing_unit

if TYPE_CHECKING:
    from armour.scenario.loading import Scenario
    from armour.scenario.sampling import Floats

# Completes a problem in the row of an index.
Place = Callable[[int, Problem], Problem]

VELOCITY = "impact.velocity_m_s"
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
YIELD = "backing.dynamic_yield_strength_MPa"

# Parameter of the core that an input sets, and the unit's factor; None for an input that sets none or several.
FIELDS: dict[str, tuple[str, float] | None] = {
    VELOCITY: None,
    CERAMIC: ("Hc0", MM),
    BACKING: ("Hb", MM),
    "projectile.penetrator_diameter_mm": ("D0", MM),
    "projectile.penetrator_mass_g": None,
    "projectile.density_kg_m3": ("rho_p", 1.0),
    "projectile.flow_stress_GPa": ("Yp", GPA),
    "ceramic.density_kg_m3": ("rho_c", 1.0),
    "ceramic.youngs_modulus_GPa": ("Ec", GPA),
    "ceramic.flow_stress_GPa": ("Yc0", GPA),
    **{
        f"ceramic.{key}": (field, 1.0)
        for key, field in zip(FLOW_STRESS_LAW, ("n_B", "n_cB", "a_c", "a_B"), strict=True)
    },
    "backing.density_kg_m3": ("rho_B", 1.0),
    YIELD: None,
    "backing.flow_stress_GPa": ("YB", GPA),
    "backing.shear_strength_MPa": ("tau", MPA),
}
# Names of all inputs.
INPUTS = tuple(FIELDS)
_SECTIONS: dict[str, type[Section]] = {"impact": Impact, "armour": ArmourSection}
# Kinds of library entry by role in the scenario.
ROLES: dict[str, Kind] = {"projectile": "projectile", "ceramic": "ceramic", "backing": "metal"}
# Keys of the library by name of input, for each role.
_KEYS = {role: {name: name.split(".")[1] for name in INPUTS if name.startswith(f"{role}.")} for role in ROLES}
# Keys of the scenario that name its library entries, by role.
NAMES = {"projectile": "impact.projectile", "ceramic": "armour.ceramic", "backing": "armour.backing"}


def name_of(scenario: "Scenario", role: str) -> str | None:
    """Return the name of the library entry in a role; None if the scenario names no ceramic."""
    section, key = NAMES[role].split(".")
    name: str | None = getattr(getattr(scenario, section), key)
    return name


def entry_of(scenario: "Scenario", role: str) -> LibraryEntry | None:
    """Return the library entry in a role; None if the scenario names no ceramic."""
    name = name_of(scenario, role)
    return None if name is None else scenario.entry(ROLES[role], name)


def inputs_of(scenario: "Scenario") -> dict[str, float]:
    """Return the values of the inputs that a scenario has, by name.

    A bare plate has no inputs of the ceramic.  The coefficients of a law of its flow stress are inputs only if its
    entry has them, and the yield strength only if other properties of the metal are derived from it.
    """
    found = {VELOCITY: scenario.impact.velocity_m_s}
    if scenario.armour.ceramic is not None:
        found[CERAMIC] = scenario.armour.ceramic_thickness_mm
    found[BACKING] = scenario.armour.backing_thickness_mm
    for role in ROLES:
        entry = entry_of(scenario, role)
        if entry is not None:
            found |= inputs_of_entry(role, entry)
    return found


def inputs_of_entry(role: str, entry: LibraryEntry) -> dict[str, float]:
    """Return the values of the inputs that an entry of the library gives in a role, by name."""
    return {
        name: entry[key]
        for name, key in _KEYS[role].items()
        if key in entry.values and (name != YIELD or entry.derived)
    }


def fields_of(inputs: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of the core that inputs set, by field, SI units."""
    targets = ((FIELDS[name], value) for name, value in inputs.items())
    return {target[0]: value * target[1] for target, value in targets if target is not None}


def check_names(names: Iterable[str], scenario: "Scenario", file: str, key: str = "") -> None:
    """Check that names are inputs of a scenario; `file` and `key`, by default the name, say where they come from."""
    known = list(inputs_of(scenario))
    problems = []
    for name in names:
        if name not in known:
            named = f'; did you mean "{NAMES[name]}"?' if name in NAMES else ""
            hint = named or missing_unit(name, known) or choices(name, known)
            problems.append(Problem(file, key or name, f'must name an input of the scenario, found "{name}"{hint}'))
    refuse(problems)


def with_inputs(scenario: "Scenario", values: Mapping[str, float]) -> "Scenario":
    """Return the scenario with other values of inputs, validated again."""
    check_names(values, scenario, scenario.file)
    changes: dict[str, Any] = {}
    for name, value in values.items():
        role, key = name.split(".")
        if role not in ROLES:
            changes[name] = value
            continue
        entry = entry_of(scenario, role)
        assert entry is not None
        changes[key_name(["library", entry.kind, entry.name, key])] = value
        if entry.name not in getattr(scenario.library, entry.kind):
            changes[key_name(["library", entry.kind, entry.name, "based_on"])] = entry.name
    return scenario.replaced(changes)


def in_row(row: int, problem: Problem) -> Problem:
    """Return a problem with the number of its row, from 1."""
    return problem._replace(key=f"row {row + 1}: {problem.key}")


def check_rows(scenario: "Scenario", columns: Mapping[str, "Floats"], place: Place = in_row) -> None:
    """Check that the scenario allows every row of values of inputs, (n,) each.

    `place` completes the problem that `with_inputs` finds in a row, given the index of the row.
    """
    found: dict[str, Problem] = {}
    for _, row, problems in sorted(wrong_rows(scenario, columns), key=itemgetter(1)):
        for problem in problems:
            found.setdefault(problem.key, place(row, problem))
    refuse(found.values())


def wrong_rows(scenario: "Scenario", columns: Mapping[str, "Floats"]) -> Iterator[tuple[str, int, Sequence[Problem]]]:
    """Yield the first row that breaks each condition on inputs: one of their names, and the row with its problems.

    The rows that are left are those that `with_inputs` accepts.
    """
    # Imported here because a scenario without rows does not need numpy.
    import numpy as np

    check_names(columns, scenario, scenario.file)
    found = []
    with np.errstate(all="ignore"):
        for name, values in columns.items():
            for compare, bound in _bounds(name):
                # A comparison with a NaN is false.
                found.append((name, compare(values, bound)))
        for rod in _rods(scenario, columns):
            name = next(f"projectile.{key}" for key in reversed(ROD) if f"projectile.{key}" in columns)
            found.append((name, is_rod(*rod)))
    for name, allowed in found:
        if not np.all(allowed):
            row = int(np.argmin(allowed))
            try:
                with_inputs(scenario, {key: float(values[row]) for key, values in columns.items()})
            except InputError as error:
                yield name, row, error.problems


# Comparisons by their names in pydantic.
_COMPARISONS: dict[str, Callable[[Any, float], Any]] = {"gt": gt, "ge": ge, "lt": lt, "le": le}


@cache
def _bounds(name: str) -> tuple[tuple[Callable[[Any, float], Any], float], ...]:
    """Return the bounds of an input that its section states, as comparisons with numbers."""
    section, key = name.split(".")
    model: type[Section] = KINDS[ROLES[section]] if section in ROLES else _SECTIONS[section]
    field = model.model_fields[key]
    inner = model_in(field.annotation)
    stated = field.metadata if inner is None else inner.model_fields[NUMBER].metadata
    bounds = [(compare, getattr(m, word)) for m in stated for word, compare in _COMPARISONS.items() if hasattr(m, word)]
    return (*bounds, (_is_not_tiny, TINY)) if NOT_TINY in stated else tuple(bounds)


def _is_not_tiny(values: Any, tiny: float) -> Any:
    return (values == 0.0) | (abs(values) >= tiny)


def _rods(scenario: "Scenario", columns: Mapping[str, "Floats"]) -> Iterator[list[Any]]:
    """Yield the values of ROD, numbers or columns, of the projectiles whose length the columns change.

    These are the scenario's own and those of its section [library] that are based on it.
    """
    name = scenario.impact.projectile
    own = scenario.library.projectile
    for other in dict.fromkeys((name, *own)):
        chain = bases_of(scenario, "projectile", other)
        if name not in chain:
            continue
        between = [own[base] for base in chain[: chain.index(name)]]
        follows = [all(getattr(entry, key) is None for entry in between) for key in ROD]
        if any(f"projectile.{key}" in columns for key, free in zip(ROD, follows, strict=True) if free):
            entry = scenario.entry("projectile", other)
            yield [
                columns.get(f"projectile.{key}", entry[key]) if free else entry[key]
                for key, free in zip(ROD, follows, strict=True)
            ]


def bases_of(scenario: "Scenario", kind: Kind, name: str) -> list[str]:
    """Return an entry and those that it is based on, one on the next, up to the first from outside the scenario."""
    own: Mapping[str, Entry] = getattr(scenario.library, kind)
    chain: dict[str, None] = {}
    base: str | None = name
    while base is not None and base not in chain:
        chain[base] = None
        base = own[base].based_on if base in own else None
    return list(chain)
