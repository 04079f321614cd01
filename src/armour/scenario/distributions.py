"""The section [uncertainty] of a scenario: distributions of uncertain inputs, their correlations and the sampling."""

from collections.abc import Sequence
from math import comb, inf
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, create_model, field_validator, model_validator

from armour.scenario.evidence import ERROR
from armour.scenario.inputs import INPUTS
from armour.scenario.sections import Section, above

# Wide bounds that keep the arithmetic from overflowing.
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Width = Annotated[float, Field(ge=1e-9, le=1e9)]
# Greatest number of samples of a scenario.
MAX_SAMPLES = 2**22
# Fewer for a Latin hypercube, which needs three times the memory.
MAX_HYPERCUBE = 2**21
# Each two inputs once.
MAX_CORRELATIONS = comb(len(INPUTS), 2)
# Fewer samples give no confidence interval for the 5 % quantile.
MIN_SAMPLES = 128

# Standard deviations within which the scenario's own value is near a given mean.
NEAR = 3.0


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
    """Least value, where the distribution is truncated."""
    max: Annotated[Number | None, above("min")] = None
    """Greatest value, where the distribution is truncated."""

    @model_validator(mode="after")
    def _complete(self) -> "Distribution":
        widths = sum(width is not None for width in (self.standard_deviation, self.standard_deviation_percent))
        if self.distribution == "uniform":
            if self.min is None or self.max is None or widths or self.mean is not None:
                raise ValueError("a uniform distribution must have min and max, and nothing else")
        elif widths != 1:
            raise ValueError("must have standard_deviation or standard_deviation_percent, and not both")
        return self

    @property
    def placed(self) -> bool:
        """Whether the distribution has a fixed location or truncation, independent of the scenario's value."""
        return (self.mean, self.min, self.max) != (None, None, None)

    def contains(self, own: float) -> bool:
        """Return whether the scenario's own value lies between min and max and, where a mean is given, near it."""
        low, high = (default if end is None else end for end, default in ((self.min, -inf), (self.max, inf)))
        mean = own if self.mean is None else self.mean
        width = self.standard_deviation or (self.standard_deviation_percent or 0.0) / 100.0 * abs(mean)
        return low <= own <= high and abs(own - mean) <= NEAR * width

    def mean_problem(self, own: float) -> str:
        """Return why the distribution cannot have its mean, by default the scenario's own value; "" if it can."""
        mean = own if self.mean is None else self.mean
        if self.distribution == "lognormal" and mean <= 0.0:
            return f"must have a mean greater than 0 to be lognormal, found {mean:g}"
        if self.standard_deviation_percent is not None and mean == 0.0:
            must = "must have a standard_deviation in place of one in per cent where the mean is 0"
            return f"{must}, found standard_deviation_percent"
        return ""


class ErrorDistribution(Distribution):
    """Student's t distribution of the error of the model, %; `standard_deviation` is its scale."""

    distribution: Literal["student t"] = "student t"  # type: ignore[assignment]
    degrees_of_freedom: float


def _distributions(section: str, of: str) -> type[Section]:
    """Return the section with a distribution for each input of a section of the scenario, or of a role."""
    keys: dict[str, Any] = {
        one.key: (Distribution | None, Field(None, description=f"Distribution of the input {one.name}."))
        for one in INPUTS.values()
        if one.section == section
    }
    name = f"{section.capitalize()}Uncertainty"
    return create_model(name, __base__=Section, __doc__=f"Distributions of {of}.", __module__=__name__, **keys)


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
    """Relative error of the ballistic limit: that of the armour over that of the model, less 1; Student's t."""

    included: bool = True
    """Whether the error of the model is included."""
    mean_percent: Annotated[float, Field(ge=-90.0, le=1000.0)] = 0.0
    """Mean error of the ballistic limit, of the armour over that of the model, less 1."""
    scale_percent: Annotated[float, Field(ge=1e-3, le=100.0)] | None = None
    """Scale of Student's t distribution of this error."""
    degrees_of_freedom: Annotated[float, Field(ge=1.0, le=1e6)] | None = None
    """Degrees of freedom of this distribution; by default infinite: a normal distribution."""
    source: str = ""
    """Where the error comes from."""

    @model_validator(mode="after")
    def _complete(self) -> "ModelSection":
        given = self.model_fields_set - {"included"}
        if not self.included and given:
            raise ValueError(f"must have nothing else where included is false, found {', '.join(sorted(given))}")
        if self.included and self.scale_percent is None:
            raise ValueError("must have scale_percent, or included = false")
        return self


class Uncertainty(Section):
    """Distributions of the uncertain inputs, their correlations, the error of the model and the sampling."""

    method: Literal["sobol", "latin hypercube"] = "sobol"
    """Sampling: scrambled Sobol' points, or a Latin hypercube."""
    samples: Annotated[int, Field(ge=MIN_SAMPLES, le=MAX_SAMPLES)] = 4096
    """Number of samples; of Sobol' points, a power of 2."""
    seed: Annotated[int, Field(ge=0)] = 1
    """Seed of the random numbers."""
    impact: ImpactUncertainty = ImpactUncertainty()  # type: ignore[valid-type]
    """Distribution of the velocity."""
    armour: ArmourUncertainty = ArmourUncertainty()  # type: ignore[valid-type]
    """Distributions of the thicknesses."""
    projectile: ProjectileUncertainty = ProjectileUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the projectile."""
    ceramic: CeramicUncertainty = CeramicUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the ceramic."""
    backing: BackingUncertainty = BackingUncertainty()  # type: ignore[valid-type]
    """Distributions of the properties of the back plate."""
    correlation: Annotated[list[Correlation], Field(max_length=MAX_CORRELATIONS)] = []
    """Correlations between inputs."""
    model: ModelSection | None = None
    """The error of the model."""

    _error: ErrorDistribution | None = PrivateAttr(default=None)

    def with_error(self, error: ErrorDistribution) -> "Uncertainty":
        """Return the section with the error of the model as an input of its own."""
        found = self.model_copy()
        found._error = error
        return found

    def inputs(self) -> dict[str, Distribution]:
        """Return the distributions by name of input, such as "ceramic.flow_stress_GPa"."""
        of_all = {name: getattr(getattr(self, one.section), one.key) for name, one in INPUTS.items()}
        found = {name: distribution for name, distribution in of_all.items() if distribution is not None}
        return found if self._error is None else {**found, ERROR: self._error}

    @field_validator("samples")
    @classmethod
    def _allowed_by_the_method(cls, samples: int, info: ValidationInfo) -> int:
        if info.data.get("method") == "sobol" and samples & (samples - 1):
            near = 2 ** samples.bit_length()
            raise ValueError(f"must be a power of 2 for Sobol' points, such as {near}, found {samples}")
        if info.data.get("method") == "latin hypercube" and samples > MAX_HYPERCUBE:
            raise ValueError(f"must be at most {MAX_HYPERCUBE} for a Latin hypercube, found {samples}")
        return samples

    @model_validator(mode="after")
    def _consistent(self) -> "Uncertainty":
        names = list(self.inputs())
        pairs = [frozenset(correlation.between) for correlation in self.correlation]
        for correlation, pair in zip(self.correlation, pairs, strict=True):
            for name in correlation.between:
                if name not in names:
                    raise ValueError(f'correlation must be between inputs that have a distribution, found "{name}"')
            if len(pair) < 2 or pairs.count(pair) > 1:
                raise ValueError(
                    f"correlation must name two inputs, and each two once, found {', '.join(sorted(pair))}"
                )
        if self.correlation:
            # Imported here because a scenario without correlations does not need numpy.
            import numpy as np

            if np.linalg.eigvalsh(correlation_matrix(names, self.correlation)).min() <= 0.0:
                raise ValueError("correlation coefficients must go together: their matrix is not positive definite")
        return self


def correlation_matrix(names: Sequence[str], correlations: Sequence[Correlation]) -> list[list[float]]:
    """Return the correlation matrix of the normal scores of n inputs, shape (n, n)."""
    matrix = [[float(row == column) for column in names] for row in names]
    for correlation in correlations:
        i, j = (names.index(name) for name in correlation.between)
        matrix[i][j] = matrix[j][i] = correlation.coefficient
    return matrix
