"""Inputs: the numbers of a scenario that results depend on, by name.

A name is either a key of the scenario, such as "armour.ceramic_thickness_mm", or a role and a key of the library, such
as "ceramic.flow_stress_GPa": a property of the scenario's ceramic, independent of the entry's name.
"""

from collections.abc import Mapping
from math import cos, pi, radians
from typing import Any, Literal, NamedTuple

from armour.units import GPA, MM, MPA, G

Kind = Literal["projectile", "ceramic", "metal"]
# Kinds of library entry by role in the scenario.
ROLES: dict[str, Kind] = {"projectile": "projectile", "ceramic": "ceramic", "backing": "metal"}
# Keys of the scenario that name its library entries, by role.
NAMES = {"projectile": "impact.projectile", "ceramic": "armour.ceramic", "backing": "armour.backing"}


# Key that names a threat, and all keys whose values are names.
THREAT = "impact.threat"
NAMING = (*NAMES.values(), THREAT)
# What every impact depends on, whatever its velocity.
ROUND_AND_ARMOUR = ("impact.projectile", THREAT, "impact.obliquity_deg", "armour")


class Input(NamedTuple):
    """A number of a scenario that results depend on."""

    name: str
    field: str = ""  # parameter of the core that it sets; "" for none or several
    factor: float = 1.0  # from its unit to SI

    @property
    def section(self) -> str:
        """Section of the scenario, or role of the library entry."""
        return self.name.split(".")[0]

    @property
    def key(self) -> str:
        """Key in the section or in the entry."""
        return self.name.split(".")[1]

    @property
    def kind(self) -> Kind | None:
        """Kind of library entry that holds the input; None for one of the scenario's own sections."""
        return ROLES.get(self.section)


VELOCITY, OBLIQUITY = "impact.velocity_m_s", "impact.obliquity_deg"
CERAMIC, BACKING = LAYERS = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
YIELD, FLOW_STRESS = "backing.dynamic_yield_strength_MPa", "ceramic.flow_stress_GPa"
# Inputs that determine the penetrator's length.
ROD = ("projectile.penetrator_diameter_mm", "projectile.penetrator_mass_g", "projectile.density_kg_m3")
# The model error as an input, and the keys that it depends on besides projectile, armour, model and solver.
ERROR = "model.limit_error_percent"
OF_ERROR = (
    "uncertainty.model",
    "design.angles_as_at_normal_incidence",
    "design.scatter_percent",
    "design.scatter_source",
)

_INPUTS = (
    Input(VELOCITY),
    Input(OBLIQUITY),
    Input(CERAMIC, "Hc0", MM),
    Input(BACKING, "Hb", MM),
    Input("projectile.penetrator_diameter_mm", "D0", MM),
    Input("projectile.penetrator_mass_g"),
    Input("projectile.density_kg_m3", "rho_p"),
    Input("projectile.flow_stress_GPa", "Yp", GPA),
    Input("ceramic.density_kg_m3", "rho_c"),
    Input("ceramic.youngs_modulus_GPa", "Ec", GPA),
    Input("ceramic.flow_stress_GPa", "Yc0", GPA),
    Input("ceramic.flow_stress_backing_exponent", "n_B"),
    Input("ceramic.flow_stress_product_exponent", "n_cB"),
    Input("ceramic.flow_stress_ceramic_slope", "a_c"),
    Input("ceramic.flow_stress_backing_slope", "a_B"),
    Input("backing.density_kg_m3", "rho_B"),
    Input(YIELD),
    Input("backing.flow_stress_GPa", "YB", GPA),
    Input("backing.shear_strength_MPa", "tau", MPA),
)
# Every input by name.
INPUTS = {definition.name: definition for definition in _INPUTS}


def length_mm(diameter_mm: Any, mass_g: Any, density_kg_m3: Any) -> Any:
    """Compute the length of a cylindrical penetrator, mm, from diameter, mass and density; floats or arrays, (n,)."""
    area = pi * (diameter_mm * MM) ** 2 / 4.0
    return mass_g * G / (density_kg_m3 * area) / MM


def cosine_of(obliquity_deg: float) -> float:
    """Return the cosine of an obliquity in degrees: a layer's thickness over its thickness along the line of fire."""
    return cos(radians(obliquity_deg))


def fields_of(inputs: Mapping[str, Any], cosine: Any) -> dict[str, Any]:
    """Return the parameters of the core that inputs set, by field of `Parameters`, in SI units.

    `inputs` has values by name, in the units of the names; these, and the cosine of the obliquity, are numbers or
    arrays, (n,).  Thicknesses become those along the line of fire.
    """
    fields = {
        INPUTS[name].field: (value / cosine if name in LAYERS else value) * INPUTS[name].factor
        for name, value in inputs.items()
        if INPUTS[name].field
    }
    if ROD[0] in inputs:
        fields["L0"] = length_mm(*(inputs[name] for name in ROD)) * MM
    return fields
