"""The numbers that a scenario's answers depend on, by name: read, changed, and put into the engine's rows.

A name is a key of the scenario, such as "armour.ceramic_thickness_mm", or what the scenario's projectile, ceramic or
backing has in the library, such as "ceramic.flow_stress_GPa", whichever entry that is.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from armour.errors import InputError, Problem, suggestion
from armour.scenario.library import Kind, LibraryEntry
from armour.scenario.loading import Scenario, changed
from armour.units import GPA, MM, MPA, missing_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

VELOCITY = "impact.velocity_m_s"
CERAMIC, BACKING = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
YIELD = "backing.dynamic_yield_strength_MPa"
ROD = ("penetrator_diameter_mm", "penetrator_mass_g", "density_kg_m3")

# Field of the core's armour that an input is, and its unit; None where it is more than one.
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
INPUTS = tuple(FIELDS)
ROLES: dict[str, Kind] = {"projectile": "projectile", "ceramic": "ceramic", "backing": "metal"}
# Keys of the scenario that name the entries of its library.
NAMES = {"projectile": "impact.projectile", "ceramic": "armour.ceramic", "backing": "armour.backing"}


def name_of(scenario: Scenario, role: str) -> str | None:
    """Name of what a scenario has as its projectile, ceramic or backing; None where it names no ceramic."""
    section, key = NAMES[role].split(".")
    name: str | None = getattr(getattr(scenario, section), key)
    return name


def entry_of(scenario: Scenario, role: str) -> LibraryEntry | None:
    """What a scenario has as its projectile, ceramic or backing; None where it names no ceramic."""
    name = name_of(scenario, role)
    return None if name is None else scenario.entry(ROLES[role], name)


def inputs_of(scenario: Scenario) -> dict[str, float]:
    """The inputs that a scenario has, with its values."""
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


def check_names(names: Iterable[str], scenario: Scenario, file: str, key: str = "") -> None:
    """Make sure that the scenario has the inputs.

    Raises
    ------
    InputError
        With every name that is none of them; ``file`` and ``key`` say where it is found.
    """
    known = list(inputs_of(scenario))
    problems = []
    for name in names:
        if name not in known:
            hint = missing_unit(name, known) or suggestion(name, known) or f"; there are {', '.join(known)}"
            problems.append(Problem(file, key or name, f'must name an input of the scenario, found "{name}"{hint}'))
    if problems:
        raise InputError(problems)


def with_inputs(scenario: Scenario, values: Mapping[str, float]) -> Scenario:
    """The scenario with other inputs, checked again.

    Raises
    ------
    InputError
        If a name is none of the scenario's inputs or a value is not allowed.
    """
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


def check_ranges(scenario: Scenario, columns: Mapping[str, "Floats"]) -> None:
    """Make sure that the scenario allows the least and the greatest values, and with them all between.

    Raises
    ------
    InputError
        If it does not.
    """
    import numpy as np

    check_names(columns, scenario, scenario.file)
    for name, values in columns.items():
        extremes = [values[~np.isfinite(values)][:1], values.min(keepdims=True), values.max(keepdims=True)]
        for value in np.concatenate(extremes).tolist():
            with_inputs(scenario, {name: value})
