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
    velocity_m_s: Velocity


class ArmourSection(Section):
    """The armour: a metal back plate, with or without a ceramic tile on it."""

    ceramic: CeramicName | None = None
    ceramic_thickness_mm: ThicknessOrNone
    backing: MetalName
    backing_thickness_mm: Thickness

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


class Solver(Section):
    """Settings of the solver."""

    time_step_us: Positive | None = None
    arrest_velocity_m_s: Velocity = 1.0

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
    velocity_max_m_s: Annotated[Velocity, above("velocity_min_m_s"), Field(validate_default=True)] = 4000.0
    tolerance_m_s: Annotated[float, Field(ge=1e-9)] = 0.01


class Range(Section):
    """Evenly spaced values from min; max is included if it is a whole number of steps away."""

    min: ThicknessOrNone
    max: Annotated[ThicknessOrNone, above("min", or_equal=True)]
    step: Positive

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
    backing_thickness_mm: Annotated[Range, AfterValidator(_above_zero)]

    @model_validator(mode="after")
    def _not_absurd(self) -> "Optimise":
        designs = self.ceramic_thickness_mm.count() * self.backing_thickness_mm.count()
        if designs > MAX_DESIGNS:
            raise ValueError(f"must hold at most {MAX_DESIGNS} designs, found {designs:.3g}; widen the steps")
        return self


class Threat(Section):
    """A projectile and a velocity that a design must defeat, with a margin."""

    name: Line = ""
    projectile: ProjectileName
    velocity_m_s: Velocity
    margin_m_s: Annotated[float, Field(ge=0.0, le=1e4)] = 0.0
    probability_of_perforation: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None

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
    max: Annotated[Thickness, above("min")]


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
    thickness_mm: Thicknesses
    cost_per_kg: Amount = 0.0
    cost_per_m2: Amount = 0.0
    density_kg_m3: Annotated[float, Field(ge=100.0, le=30000.0)] | None = None

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


class BackingLayer(Layer):
    """A metal of the catalogue, for the back plate."""

    material: MetalName
    thickness_mm: Annotated[Thicknesses, AfterValidator(_above_zero)]


Objective = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]
Criterion = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2", "margin_m_s"]


def _different(names: list[Criterion]) -> list[Criterion]:
    if len(set(names)) < len(names):
        raise ValueError(f"must not name a criterion twice, found {', '.join(names)}")
    return names


class DesignSection(Section):
    """Catalogue of materials, constraints on a design and the objective."""

    minimise: Objective = "areal_density_kg_m2"
    confidence: Annotated[float, Field(gt=0.5, lt=1.0)] | None = None
    pareto: Annotated[list[Criterion], Field(min_length=2, max_length=3), AfterValidator(_different)] | None = None
    runners_up_percent: Annotated[float, Field(ge=0.0, le=100.0)] = 5.0
    thickness_max_mm: Thickness | None = None
    areal_density_max_kg_m2: Positive | None = None
    cost_max_per_m2: Positive | None = None
    added_thickness_mm: ThicknessOrNone = 0.0
    added_areal_density_kg_m2: Amount = 0.0
    added_cost_per_m2: Amount = 0.0
    ceramic: Items[CeramicLayer] = ()
    backing: Items[BackingLayer] = ()


class LibrarySection(LibraryTables):
    """Library files and entries that the scenario adds to the library."""

    files: Items[str] = ()
