"""Sections of a scenario file: keys, types, bounds and defaults."""

import json
from math import floor
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, field_validator, model_validator

from armour.core import equations
from armour.errors import suggestion
from armour.scenario.library import Kind, LibraryTables
from armour.scenario.sections import FREE_TAG, LIST_TAG, NOT_TINY, RANGE_TAG, Items, Section, above
from armour.units import US

# Greatest numbers of values on an axis and of designs on a grid; more are most likely a mistake.
MAX_VALUES = 100_000
MAX_DESIGNS = 1_000_000

Thickness = Annotated[float, Field(gt=0.0, le=1e5), NOT_TINY]
ThicknessOrNone = Annotated[float, Field(ge=0.0, le=1e5), NOT_TINY]
FASTEST_M_S = 1e4
Velocity = Annotated[float, Field(gt=0.0, le=FASTEST_M_S), NOT_TINY]
Positive = Annotated[float, Field(gt=0.0), NOT_TINY]
# Costs and masses per area; the bound catches mistakes.
Amount = Annotated[float, Field(ge=0.0, le=1e9)]


def _in_library(kind: Kind) -> AfterValidator:
    """Return a validator of a name, which must be in the library."""

    def check(name: str, info: ValidationInfo) -> str:
        known: list[str] = info.context["names"][kind] if info.context and kind in info.context["names"] else [name]
        if name not in known:
            raise ValueError(f'must name a {kind} of the library, found "{name}"{suggestion(name, known)}')
        return name

    return AfterValidator(check)


ProjectileName = Annotated[str, _in_library("projectile")]
CeramicName = Annotated[str, _in_library("ceramic")]
MetalName = Annotated[str, _in_library("metal")]


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError(f"must be one line of printable text, found {json.dumps(text)}")
    return text


Line = Annotated[str, AfterValidator(_printable)]


class Impact(Section):
    """The projectile and its impact velocity."""

    projectile: ProjectileName
    """Name of the projectile."""
    velocity_m_s: Velocity
    """Impact velocity."""


class ArmourSection(Section):
    """The armour: a metal back plate, with or without a ceramic tile on it."""

    ceramic: CeramicName | None = None
    """Name of the ceramic, none for a bare plate."""
    ceramic_thickness_mm: ThicknessOrNone
    """Thickness of the ceramic tile, 0 for a bare plate."""
    backing: MetalName
    """Name of the metal of the back plate."""
    backing_thickness_mm: Thickness
    """Thickness of the back plate."""

    @field_validator("ceramic_thickness_mm")
    @classmethod
    def _thickness(cls, thickness: float, info: ValidationInfo) -> float:
        if thickness > 0.0 and info.data.get("ceramic", "") is None:
            raise ValueError(f"must be 0 where no ceramic is named, found {thickness:g}; name one as armour.ceramic")
        return thickness


ShearPerimeter = Literal["conoid", "projectile"]
SHEAR_LAWS: dict[ShearPerimeter, int] = {"conoid": equations.CONOID, "projectile": equations.PROJECTILE}


class Model(Section):
    """Options of the model."""

    shear_perimeter: ShearPerimeter = "conoid"
    """Perimeter of the shear plug while ceramic is ahead: the base of the ceramic conoid, or the projectile."""


class Solver(Section):
    """Settings of the solver."""

    time_step_us: Positive | None = None
    """Time step; by default from size and velocity."""
    arrest_velocity_m_s: Velocity = 1.0
    """Velocity at which the projectile counts as arrested."""

    @property
    def time_step(self) -> float:
        """Given time step, s; 0 if the core chooses it."""
        return 0.0 if self.time_step_us is None else self.time_step_us * US

    @property
    def max_steps(self) -> int:
        """Steps after which a run stops unresolved: a second in plain Python; by default steps most take some tens."""
        return 20_000 if self.time_step_us is None else 500_000


class BallisticLimitSection(Section):
    """Range and tolerance of the search for the ballistic limit."""

    velocity_min_m_s: Velocity = 20.0
    """Lowest velocity of the search."""
    velocity_max_m_s: Annotated[Velocity, above("velocity_min_m_s"), Field(validate_default=True)] = 4000.0
    """Highest velocity of the search."""
    tolerance_m_s: Annotated[float, Field(ge=1e-9)] = 0.01
    """Width of the bracket at which the search ends."""


class Range(Section):
    """Evenly spaced values from min; max is included if it is a whole number of steps away."""

    min: ThicknessOrNone
    """Least value."""
    max: Annotated[ThicknessOrNone, above("min", or_equal=True)]
    """Greatest value."""
    step: Positive
    """Distance between values."""

    @model_validator(mode="after")
    def _countable(self) -> "Range":
        if self.count() > MAX_VALUES:
            raise ValueError(f"must hold at most {MAX_VALUES} values, found {self.count():.7g}; widen the step")
        return self

    def count(self) -> float:
        """Return the number of values."""
        return floor(min((self.max - self.min) / self.step, 1e18) + 1e-9) + 1

    def values(self) -> tuple[float, ...]:
        """Return the values, rounded to nine decimals to remove rounding errors."""
        return tuple(round(self.min + i * self.step, 9) for i in range(int(self.count())))


def omission(last: float, end: float, step: float) -> str:
    """Return that the last value of a range is not its end; "" where it is."""
    return f"the last value is {last:g}, since {end:g} is no whole number of steps away" * (end - last > 1e-3 * step)


def _above_zero(thickness: Any) -> Any:
    least = min(thickness) if isinstance(thickness, list) else thickness.min
    if least <= 0.0:
        raise ValueError(f"min must be greater than 0, found {least:g}")
    return thickness


class Optimise(Section):
    """Grid of designs."""

    ceramic_thickness_mm: Range
    """Grid of thicknesses of the ceramic tile."""
    backing_thickness_mm: Annotated[Range, AfterValidator(_above_zero)]
    """Grid of thicknesses of the back plate."""

    @model_validator(mode="after")
    def _not_absurd(self) -> "Optimise":
        designs = self.ceramic_thickness_mm.count() * self.backing_thickness_mm.count()
        if designs > MAX_DESIGNS:
            raise ValueError(f"must hold at most {MAX_DESIGNS} designs, found {designs:.3g}; widen the steps")
        return self


class Threat(Section):
    """A projectile and a velocity that a design must defeat, with a margin."""

    name: Line = ""
    """Name of the threat; by default projectile and velocity."""
    projectile: ProjectileName
    """Name of the projectile."""
    velocity_m_s: Velocity
    """Impact velocity."""
    margin_m_s: Annotated[float, Field(ge=0.0, le=1e4)] = 0.0
    """Required excess of the ballistic limit over the velocity of the threat."""
    probability_of_perforation: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None
    """Greatest probability of perforation by the threat, with the uncertain inputs; in place of the one that the
    confidence gives."""

    @model_validator(mode="after")
    def _within_reach(self) -> "Threat":
        if self.required_m_s > FASTEST_M_S:
            found = f"{self.velocity_m_s:g} and {self.margin_m_s:g}"
            raise ValueError(f"velocity_m_s and margin_m_s must be at most {FASTEST_M_S:g} together, found {found}")
        return self

    @property
    def required_m_s(self) -> float:
        """Velocity that the ballistic limit must exceed, m/s."""
        return self.velocity_m_s + self.margin_m_s

    @property
    def title(self) -> str:
        """Name of the threat, by default projectile and velocity."""
        return self.name or f"{self.projectile} at {self.velocity_m_s:g} m/s"


class FreeRange(Section):
    """Continuous range of thicknesses."""

    min: ThicknessOrNone
    """Least value."""
    max: Annotated[Thickness, above("min")]
    """Greatest value."""


def _kind_of_range(value: object) -> str:
    """Return the tag of the form in which thicknesses are given."""
    if isinstance(value, list):
        return LIST_TAG
    stepped = isinstance(value, Range) or (isinstance(value, dict) and "step" in value)
    return RANGE_TAG if stepped else FREE_TAG


Thicknesses = Annotated[
    Annotated[Annotated[list[ThicknessOrNone], Field(min_length=1)], Tag(LIST_TAG)]
    | Annotated[Range, Tag(RANGE_TAG)]
    | Annotated[FreeRange, Tag(FREE_TAG)],
    Discriminator(_kind_of_range),
]


class Layer(Section):
    """A material of the catalogue, with its thicknesses and costs."""

    material: str
    """Name of the ceramic or metal."""
    thickness_mm: Thicknesses
    """Thicknesses to choose from: a list, a range with a step, or one without for any value."""
    cost_per_kg: Amount = 0.0
    """Cost per mass of the material, in any currency."""
    cost_per_m2: Amount = 0.0
    """Cost per area that does not depend on the thickness."""
    density_kg_m3: Annotated[float, Field(ge=100.0, le=30000.0)] | None = None
    """Density, in place of the library's."""

    def free_range(self, *, refine: bool = False) -> Range | FreeRange | None:
        """Return the range that any thickness may be chosen from, with `refine` also one with a step; None if none."""
        thickness = self.thickness_mm
        if isinstance(thickness, list) or thickness.min == thickness.max:
            return None
        return thickness if refine or isinstance(thickness, FreeRange) else None

    def thicknesses(self) -> tuple[float, ...]:
        """Return the thicknesses, mm, or the ends of a continuous range."""
        if isinstance(self.thickness_mm, Range):
            return self.thickness_mm.values()
        if isinstance(self.thickness_mm, FreeRange):
            return (self.thickness_mm.min, self.thickness_mm.max)
        return tuple(sorted(set(self.thickness_mm)))


class CeramicLayer(Layer):
    """A ceramic of the catalogue."""

    material: CeramicName
    """Name of the ceramic."""


class BackingLayer(Layer):
    """A metal of the catalogue, for the back plate."""

    material: MetalName
    """Name of the metal."""
    thickness_mm: Annotated[Thicknesses, AfterValidator(_above_zero)]
    """Thicknesses to choose from: a list, a range with a step, or one without for any value."""


Objective = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]
Criterion = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2", "margin_m_s"]


def _different(names: list[Criterion]) -> list[Criterion]:
    if len(set(names)) < len(names):
        raise ValueError(f"must not name a criterion twice, found {', '.join(names)}")
    return names


class DesignSection(Section):
    """Catalogue of materials, constraints on a design and the objective."""

    minimise: Objective = "areal_density_kg_m2"
    """Quantity of which the design has the least."""
    confidence: Annotated[float, Field(gt=0.5, lt=1.0)] | None = None
    """Least probability of defeating each threat."""
    pareto: Annotated[list[Criterion], Field(min_length=2, max_length=3), AfterValidator(_different)] | None = None
    """Criteria of the Pareto front; none is drawn up by default."""
    runners_up_percent: Annotated[float, Field(ge=0.0, le=100.0)] = 5.0
    """Excess over the best up to which other pairs of materials are listed."""
    thickness_max_mm: Thickness | None = None
    """Greatest total thickness."""
    areal_density_max_kg_m2: Positive | None = None
    """Greatest areal density."""
    cost_max_per_m2: Positive | None = None
    """Greatest cost per area."""
    added_thickness_mm: ThicknessOrNone = 0.0
    """Thickness of adhesive or cover, without ballistic effect."""
    added_areal_density_kg_m2: Amount = 0.0
    """Areal density of adhesive or cover."""
    added_cost_per_m2: Amount = 0.0
    """Cost per area of adhesive or cover."""
    ceramic: Items[CeramicLayer] = ()
    """Ceramics to choose from."""
    backing: Items[BackingLayer] = ()
    """Metals to choose from for the back plate."""


class LibrarySection(LibraryTables):
    """Library files and entries that the scenario adds to the library."""

    files: Items[str] = ()
    """Library files, relative to the folder of the scenario."""
