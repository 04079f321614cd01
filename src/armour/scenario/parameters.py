"""Inputs: the numbers of a scenario that results depend on, by name.

A name is either a key of the scenario, such as "armour.ceramic_thickness_mm", or a role and a key of the library, such
as "ceramic.flow_stress_GPa": a property of the scenario's ceramic, independent of the entry's name.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from armour.errors import InputError, Problem, choices
from armour.scenario.assignments import changed
from armour.scenario.library import Kind, LibraryEntry
from armour.units import GPA, MM, MPA, missing_unit

if TYPE_CHECKING:
    from armour.scenario.loading import Scenario
    from armour.scenario.sampling import Floats

VELOCITY = "impact.velocity_m_s"
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
YIELD = "backing.dynamic_yield_strength_MPa"
# Keys of the projectile that its penetrator's length follows from.
ROD = ("penetrator_diameter_mm", "penetrator_mass_g", "density_kg_m3")

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
    "backing.density_kg_m3": ("rho_B", 1.0),
    YIELD: None,
    "backing.flow_stress_GPa": ("YB", GPA),
    "backing.shear_strength_MPa": ("tau", MPA),
}
# Names of all inputs.
INPUTS = tuple(FIELDS)
# Kinds of library entry by role in the scenario.
ROLES: dict[str, Kind] = {"projectile": "projectile", "ceramic": "ceramic", "backing": "metal"}
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

    A bare plate has no inputs of the ceramic.  The yield strength is an input only if other properties of the metal
    are derived from it.
    """
    entries = {role: entry_of(scenario, role) for role in ROLES}
    found = {}
    for name in INPUTS:
        role, key = name.split(".")
        entry = entries.get(role)
        if role not in entries:
            found[name] = float(getattr(getattr(scenario, role), key))
        elif entry is not None and key in entry.values and (name != YIELD or entry.derived):
            found[name] = entry[key]
    if scenario.armour.ceramic is None:
        del found[CERAMIC]
    return found


def check_names(names: Iterable[str], scenario: "Scenario", file: str, key: str = "") -> None:
    """Check that names are inputs of a scenario; `file` and `key`, by default the name, say where they come from."""
    known = list(inputs_of(scenario))
    problems = []
    for name in names:
        if name not in known:
            hint = missing_unit(name, known) or choices(name, known)
            problems.append(Problem(file, key or name, f'must name an input of the scenario, found "{name}"{hint}'))
    if problems:
        raise InputError(problems)


def with_inputs(scenario: "Scenario", values: Mapping[str, float]) -> "Scenario":
    """Return the scenario with other values of inputs, validated again."""
    check_names(values, scenario, scenario.file)
    changes: dict[str, Any] = {}
    for name, value in values.items():
        role, key = name.split(".")
        if role not in ROLES:
            changes = changed(changes, {name: value})
            continue
        entry = entry_of(scenario, role)
        assert entry is not None
        own: Mapping[str, Any] = getattr(scenario.library, entry.kind)
        base = {} if entry.name in own else {"based_on": entry.name}
        changes = changed(changes, {"library": {entry.kind: {entry.name: {key: value, **base}}}})
    return scenario.replaced(changes)


def check_ranges(scenario: "Scenario", columns: Mapping[str, "Floats"]) -> None:
    """Check that the scenario allows the least and the greatest value of each input, and thereby all values."""
    check_names(columns, scenario, scenario.file)
    problems: list[Problem] = []
    for name, values in columns.items():
        try:
            # A NaN is both the least and the greatest value of an array.
            for value in (values.min(), values.max()):
                with_inputs(scenario, {name: float(value)})
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
