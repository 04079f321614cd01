"""Sections of a scenario file: keys, types, bounds and defaults."""

import json
from collections.abc import Sequence
from math import floor, inf
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, create_model, model_validator

from armour.core import equations
from armour.errors import suggestion
from armour.scenario.inputs import ERROR, INPUTS, THREAT, Kind, cosine_of
from armour.scenario.keys import plain_name
from armour.scenario.library import THREAT_KEYS, AssumedScatter, LibraryTables, check_scatter, hint, named_threats
from armour.scenario.sections import AS_LIST, AS_RANGE, LIST_OR_RANGE, NOT_TINY, Items, Section, above
from armour.units import MM, US

# Greatest numbers of values on an axis and of designs on a grid; more are most likely a mistake.
MAX_VALUES = 100_000
MAX_DESIGNS = 1_000_000

# Greatest thickness; the bound catches mistakes of unit.
THICKEST_MM = 1000.0
Thickness = Annotated[float, Field(gt=0.0, le=THICKEST_MM), NOT_TINY]
ThicknessOrNone = Annotated[float, Field(ge=0.0, le=THICKEST_MM), NOT_TINY]
# Range of velocities, m/s, that is searched for a ballistic limit outside the range of the section.
SLOWEST_M_S, FASTEST_M_S = 20.0, 1e4
Velocity = Annotated[float, Field(gt=0.0, le=FASTEST_M_S), NOT_TINY]
# The velocity of an impact; the bound catches one in km/s.
ImpactVelocity = Annotated[float, Field(ge=10.0, le=FASTEST_M_S)]
Positive = Annotated[float, Field(gt=0.0), NOT_TINY]
# At greater angles, rounds ricochet and cores break or turn, which the model does not describe.
Obliquity = Annotated[float, Field(ge=0.0, le=60.0), NOT_TINY]
# Costs and masses per area; the bound catches mistakes.
Amount = Annotated[float, Field(ge=0.0, le=1e9)]


def _in_library(kind: Kind) -> AfterValidator:
    """Return a validator of a name, which must be in the library; an alias becomes the name of its entry."""

    def check(name: str, info: ValidationInfo) -> str:
        """Return the name of the entry that a name or an alias means."""
        context: dict[str, Any] = info.context or {"names": {}}
        name = plain_name(name)
        names: dict[str, str] = context["names"].get(kind, {name: name})
        if name not in names:
            entries = context["library"].entries[kind].values()
            raise ValueError(f'must name a {kind} of the library, found "{name}"{hint(name, entries, names)}')
        return names[name]

    return AfterValidator(check)


ProjectileName = Annotated[str, _in_library("projectile")]
CeramicName = Annotated[str, _in_library("ceramic")]
MetalName = Annotated[str, _in_library("metal")]


def _printable(text: str) -> str:
    """Return a text if it is one line of printable characters."""
    if not text.isprintable():
        raise ValueError(f"must be one line of printable text, found {json.dumps(text)}")
    return text


Line = Annotated[str, AfterValidator(_printable)]


def _with_named(schema: dict[str, Any]) -> None:
    """Change the JSON Schema of a section: it requires the name of a threat, or the values that the threat gives."""
    threat_keys = [key for key in schema["required"] if key in THREAT_KEYS]
    schema["required"] = [key for key in schema["required"] if key not in THREAT_KEYS]
    schema["anyOf"] = [{"required": ["threat"]}, {"required": threat_keys}]


# Editors are told that the name of a threat gives the projectile and the velocity.
class Impact(Section, json_schema_extra=_with_named):
    """The projectile, its impact velocity and its angle."""

    threat: str | None = None
    """Name of a threat listed by armour library; it supplies the values that are not given here."""
    projectile: ProjectileName
    """Name of the projectile."""
    velocity_m_s: ImpactVelocity
    """Impact velocity."""
    obliquity_deg: Obliquity = 0.0
    """Angle between the line of fire and the normal of the armour."""

    @model_validator(mode="before")
    @classmethod
    def _given_by_the_threat(cls, data: Any) -> Any:
        """Return the data of the section with the values of the threat that it names, unless it gives others."""
        name = data.get("threat") if isinstance(data, dict) else None
        if not isinstance(name, str):
            return data
        threats = named_threats()
        if name not in threats:
            like = suggestion(name, [*threats]) or "; armour library threats lists them"
            raise ValueError(f'threat must name a threat of the library, found "{name}"{like}')
        return threats[name].values() | data

    @property
    def cosine(self) -> float:
        """Cosine of the obliquity."""
        return cosine_of(self.obliquity_deg)

    @property
    def standard(self) -> str:
        """Name of the threat of a standard, with ", changed" if some values differ here; "" if none is named."""
        values = {} if self.threat is None else named_threats()[self.threat].values()
        is_changed = any(getattr(self, key) != value for key, value in values.items())
        return f"{self.threat or ''}{', changed' * is_changed}"


class InertLayer(Section):
    """A layer without ballistic effect, such as adhesive or a cover."""

    name: Annotated[Line, Field(min_length=1)]
    """What the layer is."""
    place: Literal["front", "between", "behind"]
    """Where it is: in front of the armour, between tile and back plate, or behind the armour."""
    thickness_mm: ThicknessOrNone
    """Thickness of the layer."""
    areal_density_kg_m2: Amount
    """Areal density of the layer."""
    cost_per_m2: Amount = 0.0
    """Cost per area of the layer, 0 if it costs nothing; if it is left out, the cost of the armour is not known."""

    def has_cost(self) -> bool:
        """Return whether a cost is given."""
        return "cost_per_m2" in self.model_fields_set


def _needs_a_ceramic(thickness: float, info: ValidationInfo) -> float:
    """Return the thickness of a tile, mm, unless it is above 0 and the armour names no ceramic."""
    if thickness > 0.0 and info.data.get("ceramic", "") is None:
        raise ValueError(f"must be 0 if no ceramic is named, found {thickness:g}; name one as armour.ceramic")
    return thickness


class ArmourSection(Section):
    """The armour: a metal back plate, with or without a ceramic tile on it, and layers without ballistic effect."""

    ceramic: CeramicName | None = None
    """Name of the ceramic; left out for a bare plate."""
    ceramic_thickness_mm: Annotated[ThicknessOrNone, AfterValidator(_needs_a_ceramic)]
    """Thickness of the ceramic tile, 0 for a bare plate."""
    backing: MetalName
    """Name of the metal of the back plate."""
    backing_thickness_mm: Thickness
    """Thickness of the back plate."""
    layer: Items[InertLayer] = ()
    """Layers without ballistic effect."""


ShearPerimeter = Literal["conoid", "projectile"]
SHEAR_LAWS: dict[ShearPerimeter, int] = {"conoid": equations.CONOID, "projectile": equations.PROJECTILE}
PlateDrive = Literal["strength", "interface"]
DRIVE_LAWS: dict[PlateDrive, int] = {"strength": equations.STRENGTH, "interface": equations.INTERFACE}


class Model(Section):
    """Options of the model."""

    shear_perimeter: ShearPerimeter = "conoid"
    """Perimeter of the shear plug while ceramic is ahead: that of the base of the conoid, or of the projectile."""
    plate_drive: PlateDrive = "strength"
    """Force of a rigid projectile on the plate that it penetrates: by the strength of the plate or its own."""

    def laws(self) -> dict[str, int]:
        """Return the parameters of the core that the options set, by name."""
        return {"shear_law": SHEAR_LAWS[self.shear_perimeter], "drive_law": DRIVE_LAWS[self.plate_drive]}


class Solver(Section):
    """Settings of the solver."""

    time_step_us: Positive | None = None
    """Length of every step; by default each is chosen by its error."""
    arrest_velocity_m_s: Velocity = 1.0
    """Velocity below which the projectile is treated as stopped."""

    @property
    def time_step(self) -> float:
        """Given time step, s; 0 if the core chooses it."""
        return 0.0 if self.time_step_us is None else self.time_step_us * US

    @property
    def max_steps(self) -> int:
        """Steps after which a run stops unresolved: a second in plain Python; most runs take tens of default steps."""
        return 20_000 if self.time_step_us is None else 500_000


class BallisticLimitSection(Section):
    """Range and tolerance of the search for the ballistic limit."""

    velocity_min_m_s: Velocity = 20.0
    """Lowest velocity of the search."""
    velocity_max_m_s: Annotated[Velocity, above("velocity_min_m_s"), Field(validate_default=True)] = 4000.0
    """Highest velocity of the search."""
    tolerance_m_s: Annotated[float, Field(ge=1e-9)] = 0.01
    """Width of the bracket at which the search ends."""


class ThicknessSteps(Section):
    """Evenly spaced values from min; max is included if it is a whole number of steps away."""

    min: float
    """Least value."""
    max: Annotated[float, above("min", or_equal=True)]
    """Greatest value."""
    step: Positive
    """Distance between values."""

    @model_validator(mode="after")
    def _countable(self) -> Self:
        """Refuse a range of too many values."""
        if self.count() > MAX_VALUES:
            raise ValueError(f"must contain at most {MAX_VALUES:,} values, found {self.count():,.7g}; widen the step")
        return self

    def count(self) -> int:
        """Return the number of values."""
        return floor(min((self.max - self.min) / self.step, 1e18) + 1e-9) + 1

    def values(self) -> tuple[float, ...]:
        """Return the values, rounded to nine decimals to remove rounding errors."""
        return tuple(round(self.min + i * self.step, 9) for i in range(self.count()))

    def omission(self) -> str:
        """Return a warning if the last value is not max; "" if it is."""
        last = self.values()[-1]
        omitted = self.max - last > 1e-3 * self.step
        return f"the last value is {last:g}, since {self.max:g} is not a whole number of steps away" if omitted else ""


class Range(ThicknessSteps):
    """Evenly spaced thicknesses from min; max is included if it is a whole number of steps away."""

    min: ThicknessOrNone
    max: Annotated[ThicknessOrNone, above("min", or_equal=True)]
    step: Positive = 0.1
    """Distance between values."""


def _above_zero(thickness: Any) -> Any:
    """Return a list or a range of thicknesses unless its least value is 0."""
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


class Threat(Impact):
    """A projectile and a velocity that a design must stop, with a margin."""

    name: Line = ""
    """Name of the threat; by default the value of threat, or projectile and velocity."""
    margin_m_s: Annotated[float, Field(ge=0.0, le=1e4)] = 0.0
    """Required excess over the velocity of the threat, of the expected limit or else of the limit by the model."""
    probability_of_perforation: Annotated[float, Field(gt=0.0, lt=0.5)] | None = None
    """Greatest allowed probability of perforation, given the uncertain inputs; overrides the one that follows from
    [design]."""

    @model_validator(mode="after")
    def _within_reach(self) -> "Threat":
        """Refuse a velocity with a margin that no ballistic limit can exceed."""
        if self.required_m_s > FASTEST_M_S:
            must = f"velocity_m_s and margin_m_s must be at most {FASTEST_M_S:g} together"
            raise ValueError(f"{must}, found {self.velocity_m_s:g} and {self.margin_m_s:g}")
        return self

    @property
    def required_m_s(self) -> float:
        """Velocity that the ballistic limit must exceed, m/s."""
        return self.velocity_m_s + self.margin_m_s

    def as_impact(self) -> dict[str, object]:
        """Return the values of the section ``impact``, by key of the scenario."""
        return {THREAT: None, **{f"impact.{key}": getattr(self, key) for key in THREAT_KEYS}}

    @property
    def title(self) -> str:
        """Name of the threat, by default that of the standard, or projectile and velocity."""
        return self.name or (f"{self.standard}{at_angle(self)}" if self.standard else shot(self))

    @property
    def round_name(self) -> str:
        """Name of the threat without its numbers, by default that of the standard, or the projectile."""
        return self.name or self.standard or self.projectile


def shot(impact: Impact) -> str:
    """Return round, velocity and angle, such as "7.62 mm AP at 800 m/s, 30° obliquity"."""
    return f"{impact.projectile} at {impact.velocity_m_s:g} m/s{at_angle(impact)}"


def at_angle(impact: Impact) -> str:
    """Return the angle, such as ", 30° obliquity"; "" at normal incidence."""
    return f", {impact.obliquity_deg:g}° obliquity" if impact.obliquity_deg else ""


def _listed(value: object) -> object:
    """Return a single thickness as a list; leave anything else as it is."""
    return [value] if isinstance(value, int | float) else value


_Thicknesses = Annotated[
    Annotated[list[ThicknessOrNone], Field(min_length=1), AS_LIST] | Annotated[Range, AS_RANGE], LIST_OR_RANGE
]
Thicknesses = Annotated[_Thicknesses, BeforeValidator(_listed, json_schema_input_type=ThicknessOrNone | _Thicknesses)]


class Layer(Section):
    """A material of the catalogue, with its thicknesses and costs."""

    material: str
    """Name of the ceramic or metal."""
    thickness_mm: Thicknesses
    """Thicknesses to choose from: one, a list, or a range, in steps of 0.1 mm unless it gives another."""
    cost_per_kg: Amount = 0.0
    """Cost per mass of the material, in any currency."""
    cost_per_m2: Amount = 0.0
    """Cost per area that does not depend on the thickness."""

    def has_cost(self) -> bool:
        """Return whether a cost is given."""
        return bool(self.model_fields_set & {"cost_per_kg", "cost_per_m2"})

    def cost(self, density_kg_m3: float, thickness_mm: Any) -> Any:
        """Return the cost of the layer per m², for a thickness or an array of them, (n,); 0 where it is 0."""
        return self.cost_per_kg * density_kg_m3 * thickness_mm * MM + self.cost_per_m2 * (thickness_mm > 0.0)

    def thicknesses(self) -> tuple[float, ...]:
        """Return the thicknesses to choose from, mm, ascending."""
        if isinstance(self.thickness_mm, Range):
            return self.thickness_mm.values()
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


Objective = Literal["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]


class ObjectiveWords(NamedTuple):
    """A quantity to minimise: words for less and more of it, its unit, and the key of [design] that bounds it."""

    least: str
    less: str
    more: str
    unit: str
    bound: str


OBJECTIVES = {
    "areal_density_kg_m2": ObjectiveWords("lightest", "lighter", "heavier", " kg/m²", "areal_density_max_kg_m2"),
    "thickness_mm": ObjectiveWords("thinnest", "thinner", "thicker", " mm", "thickness_max_mm"),
    "cost_per_m2": ObjectiveWords("cheapest", "cheaper", "dearer", " per m²", "cost_max_per_m2"),
}
Criterion = Literal[Objective, "margin_m_s"]


def _different(names: list[Criterion]) -> list[Criterion]:
    """Return the names of criteria if all differ."""
    if len(set(names)) < len(names):
        raise ValueError(f"must not name a criterion twice, found {', '.join(names)}")
    return names


# Required probability of stopping a threat.
RequiredProbability = Annotated[float, Field(gt=0.5, lt=1.0)]


class DesignSection(Section):
    """Catalogue of materials, constraints on a design and the objective."""

    minimise: Objective = "areal_density_kg_m2"
    """Quantity to minimise."""
    probability_of_stopping: RequiredProbability | None = None
    """Least probability of stopping a shot of each threat."""
    angles_as_at_normal_incidence: bool = False
    """Whether an armour with a ceramic is taken to stop a projectile at an angle as it does at normal incidence, for no
    test of that is known."""
    thickness_tolerance_mm: ThicknessOrNone = 1.0
    """Amount by which armour check makes each layer thinner."""
    pareto: Annotated[list[Criterion], Field(min_length=2, max_length=3), AfterValidator(_different)] | None = None
    """Criteria of the Pareto front; by default there is none."""
    runners_up_percent: Annotated[float, Field(ge=0.0, le=100.0)] = 5.0
    """Other pairs of materials are listed if their best design exceeds the best of all by at most this."""
    thickness_max_mm: Thickness | None = None
    """Greatest total thickness."""
    areal_density_max_kg_m2: Positive | None = None
    """Greatest areal density."""
    cost_max_per_m2: Positive | None = None
    """Greatest cost per area."""
    ceramic: Items[CeramicLayer] = ()
    """Ceramics to choose from."""
    backing: Items[BackingLayer] = ()
    """Metals to choose from for the back plate."""
    existing: Literal["backing"] | None = None
    """Part of the armour that exists already, such as a hull: it counts for the ballistic limit, but not for the limits
    of areal density, thickness and cost, nor for what is minimised."""

    scatter_percent: AssumedScatter | None = None
    """Standard deviation of the velocities that single shots need to perforate, per cent of V50, at least 2.5; an entry
    of the library may give another. By default it is 2.54, which is assumed."""
    scatter_source: str = ""
    """Source of this scatter."""

    @model_validator(mode="after")
    def _has_source_of_scatter(self) -> "DesignSection":
        """Refuse a scatter of shots without its source."""
        check_scatter(self.scatter_percent, self.scatter_source)
        return self

    @model_validator(mode="before")
    @classmethod
    def _with_former_name(cls, data: Any) -> Any:
        """Read ``confidence``, the former name of ``probability_of_stopping``."""
        if isinstance(data, dict) and "confidence" in data and "probability_of_stopping" not in data:
            return {("probability_of_stopping" if key == "confidence" else key): value for key, value in data.items()}
        return data

    def bound(self, threat: "Threat") -> float | None:
        """Return the greatest allowed probability that a threat perforates; None if no probability is required."""
        if threat.probability_of_perforation is not None or self.probability_of_stopping is None:
            return threat.probability_of_perforation
        return 1.0 - self.probability_of_stopping


# Wide bounds that keep the arithmetic from overflowing.
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Width = Annotated[float, Field(ge=1e-9, le=1e9)]


class Distribution(Section):
    """Distribution of an input, in the input's unit; by default `mean` is the scenario's own value.

    `mean` and the standard deviation are those before `min` and `max` truncate the distribution, which moves both.
    """

    distribution: Literal["normal", "lognormal", "uniform"]
    """Kind of distribution."""
    mean: Number | None = None
    """Mean, in the unit of the input; by default the scenario's own value."""
    standard_deviation: Width | None = None
    """Standard deviation, in the unit of the input."""
    standard_deviation_percent: Width | None = None
    """Standard deviation, per cent of the mean."""
    min: Number | None = None
    """Least value; it truncates a normal or lognormal distribution."""
    max: Annotated[Number | None, above("min")] = None
    """Greatest value; it truncates a normal or lognormal distribution."""

    @model_validator(mode="after")
    def _complete(self) -> "Distribution":
        """Refuse a distribution with too few or too many of the values that its kind needs."""
        widths = sum(width is not None for width in (self.standard_deviation, self.standard_deviation_percent))
        if self.distribution == "uniform":
            if self.min is None or self.max is None or widths or self.mean is not None:
                raise ValueError("a uniform distribution must have min and max, and nothing else")
        elif widths != 1:
            raise ValueError("must have standard_deviation or standard_deviation_percent, and not both")
        elif self.distribution == "lognormal" and self.max is not None and self.max <= 0.0:
            raise ValueError(f"a lognormal distribution must have a max greater than 0, found {self.max:g}")
        return self

    @property
    def placed(self) -> bool:
        """Whether a mean, min or max is given, so that the distribution does not follow the scenario's value."""
        return (self.mean, self.min, self.max) != (None, None, None)

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the greatest value, infinite if there is none."""
        return -inf if self.min is None else self.min, inf if self.max is None else self.max

    def moments(self, value: float) -> tuple[float, float]:
        """Return mean and standard deviation before truncation, in the input's unit; `value` is the scenario's own."""
        mean, percent = value if self.mean is None else self.mean, self.standard_deviation_percent
        return mean, abs(mean) * percent / 100.0 if percent is not None else self.standard_deviation or 0.0

    def contains(self, value: float) -> bool:
        """Return whether the scenario's value lies between min and max, and within 3 deviations of a given mean."""
        low, high = self.ends
        mean, deviation = self.moments(value)
        return low <= value <= high and abs(value - mean) <= 3.0 * deviation

    def mean_problem(self, value: float) -> str:
        """Return why the distribution cannot have its mean, by default the scenario's value; "" if it can."""
        mean, _ = self.moments(value)
        if self.distribution == "lognormal" and mean <= 0.0:
            return f"must have a mean greater than 0 to be lognormal, found {mean:g}"
        if self.standard_deviation_percent is not None and mean == 0.0:
            must = "must have standard_deviation, and not one in per cent, if the mean is 0"
            return f"{must}, found standard_deviation_percent"
        return ""


# Distribution of the probabilities at which the model error is drawn.
UNIFORM_CHANCES = Distribution(distribution="uniform", min=0.0, max=1.0)


def _distributions(section: str, subject: str) -> type[Section]:
    """Create the class of a section of distributions, such as `CeramicUncertainty`: one for each input of `section`.

    `subject` names these inputs in the docstring of the class.
    """
    keys: dict[str, Any] = {
        definition.key: (Distribution | None, Field(None, description=f"Distribution of the input {name}."))
        for name, definition in INPUTS.items()
        if definition.section == section
    }
    name = f"{section.capitalize()}Uncertainty"
    return create_model(name, __base__=Section, __doc__=f"Distributions of {subject}.", __module__=__name__, **keys)


ImpactUncertainty = _distributions("impact", "the impact's inputs")
ArmourUncertainty = _distributions("armour", "the thicknesses")
ProjectileUncertainty = _distributions("projectile", "the projectile's properties")
CeramicUncertainty = _distributions("ceramic", "the ceramic's properties")
BackingUncertainty = _distributions("backing", "the back plate's properties")


class Correlation(Section):
    """Correlation coefficient between the normal scores of two inputs."""

    between: Annotated[list[str], Field(min_length=2, max_length=2)]
    """Names of the two inputs."""
    coefficient: Annotated[float, Field(gt=-1.0, lt=1.0)]
    """Correlation coefficient of their normal scores."""


class ModelSection(Section):
    """Model error: actual / computed ballistic limit - 1, with Student's t distribution."""

    included: bool = True
    """Whether the model error is included: that given here or else that of tests."""
    mean_percent: Annotated[float, Field(ge=-90.0, le=1000.0)] = 0.0
    """Mean model error: actual / computed ballistic limit - 1."""
    scale_percent: Annotated[float, Field(ge=1e-3, le=100.0)] | None = None
    """Scale of Student's t distribution of this error."""
    degrees_of_freedom: Annotated[float, Field(ge=1.0, le=1e6)] | None = None
    """Degrees of freedom of this distribution, such as the number of tests less 1."""
    source: str = ""
    """Source of the error; without it or without degrees_of_freedom, no probability is known."""

    @model_validator(mode="after")
    def _complete(self) -> "ModelSection":
        """Refuse an error without its scale, and one that is given but not included."""
        other_keys = self.model_fields_set - {"included"}
        if not self.included and other_keys:
            raise ValueError(f"must have nothing else if included is false, found {', '.join(sorted(other_keys))}")
        if other_keys and self.scale_percent is None:
            raise ValueError("must have scale_percent")
        return self

    @property
    def is_bare(self) -> bool:
        """Whether an error is given without its source or its degrees of freedom."""
        return self.scale_percent is not None and not (self.source and self.degrees_of_freedom)


def _power_of_2(samples: int) -> int:
    """Return a number of samples if it is a power of 2."""
    if samples & (samples - 1):
        near = 2 ** samples.bit_length()
        raise ValueError(f"must be a power of 2 for Sobol' points, such as {near}, found {samples}")
    return samples


class Uncertainty(Section):
    """Distributions of the uncertain inputs, their correlations, the model error and the sampling."""

    # Fewer samples give no confidence interval for the 5 % quantile.
    samples: Annotated[int, Field(ge=128, le=2**22), AfterValidator(_power_of_2)] = 4096
    """Number of samples, which are scrambled Sobol' points: a power of 2."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Seed of the random numbers."""
    impact: ImpactUncertainty = ImpactUncertainty()  # type: ignore[valid-type]
    """Distributions of the velocity and the obliquity."""
    armour: ArmourUncertainty = ArmourUncertainty()  # type: ignore[valid-type]
    """Distributions of the thicknesses."""
    projectile: ProjectileUncertainty = ProjectileUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the projectile."""
    ceramic: CeramicUncertainty = CeramicUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the ceramic."""
    backing: BackingUncertainty = BackingUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the back plate."""
    correlation: list[Correlation] = []
    """Correlations between inputs."""
    model: ModelSection | None = None
    """The model error."""

    _error: bool = False

    def with_error(self) -> "Uncertainty":
        """Return the section with the model error as another input, sampled as probabilities of its quantiles."""
        section = self.model_copy()
        section._error = True
        return section

    def inputs(self) -> dict[str, Distribution]:
        """Return the distributions by name of input, such as "ceramic.flow_stress_GPa"."""
        slots = {name: getattr(getattr(self, entry.section), entry.key) for name, entry in INPUTS.items()}
        distributions = {name: distribution for name, distribution in slots.items() if distribution is not None}
        return {**distributions, ERROR: UNIFORM_CHANCES} if self._error else distributions

    @model_validator(mode="after")
    def _consistent(self) -> "Uncertainty":
        """Refuse correlations of other inputs than those with a distribution, and those that cannot go together."""
        names = list(self.inputs())
        pairs = [frozenset(correlation.between) for correlation in self.correlation]
        for correlation, pair in zip(self.correlation, pairs, strict=True):
            for name in correlation.between:
                if name not in names:
                    raise ValueError(f'correlation must be between inputs that have a distribution, found "{name}"')
            if len(pair) < 2 or pairs.count(pair) > 1:
                listed = ", ".join(sorted(pair))
                raise ValueError(f"correlation must name two different inputs, once for each pair, found {listed}")
        if self.correlation:
            # Imported here because a scenario without correlations does not need numpy.
            import numpy as np

            if np.linalg.eigvalsh(correlation_matrix(names, self.correlation)).min() <= 0.0:
                raise ValueError("correlation coefficients must go together: their matrix is not positive definite")
        return self


def correlation_matrix(names: Sequence[str], correlations: Sequence[Correlation]) -> list[list[float]]:
    """Return the correlation matrix of the normal scores of n named inputs, (n, n)."""
    matrix = [[float(row == column) for column in names] for row in names]
    for correlation in correlations:
        i, j = (names.index(name) for name in correlation.between)
        matrix[i][j] = matrix[j][i] = correlation.coefficient
    return matrix


class LibrarySection(LibraryTables):
    """Library files and entries that the scenario adds to the library."""

    files: Items[str] = ()
    """Library files, relative to the folder of the scenario."""
