"""What a scenario says of an input that is not known for sure: its distribution, and what varies together."""

from collections.abc import Mapping, Sequence
from math import hypot, log1p, sqrt
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from armour.scenario.messages import Section

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# Wide bounds, which keep the arithmetic from overflowing.
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Width = Annotated[float, Field(ge=1e-9, le=1e9)]
# Most samples that a scenario may ask for.
MAX_SAMPLES = 2**22
# Fewer would leave the 5th hundredth without an interval.
MIN_SAMPLES = 128


class Distribution(Section):
    """A distribution of an input, in the input's unit; its mean is the scenario's own value where none is given."""

    distribution: Literal["normal", "lognormal", "uniform"]
    mean: Number | None = None
    standard_deviation: Width | None = None
    standard_deviation_percent: Width | None = None
    min: Number | None = None
    max: Number | None = None

    @model_validator(mode="after")
    def _complete(self) -> "Distribution":
        widths = sum(width is not None for width in (self.standard_deviation, self.standard_deviation_percent))
        if self.distribution == "uniform":
            if self.min is None or self.max is None or widths or self.mean is not None:
                raise ValueError("a uniform distribution must have min and max, and nothing else")
        elif widths != 1:
            raise ValueError("must have standard_deviation or standard_deviation_percent, and not both")
        if self.min is not None and self.max is not None and self.min >= self.max:
            raise ValueError(f"min must be below max, found {self.min:g} and {self.max:g}")
        return self

    @property
    def placed(self) -> bool:
        """Whether it has a place of its own, and is not about whatever value the scenario has."""
        return (self.mean, self.min, self.max) != (None, None, None)

    def lacks(self, own: float) -> str:
        """What the mean must be and is not, where it is the scenario's own value if none is given; else empty."""
        mean = own if self.mean is None else self.mean
        if self.distribution == "lognormal" and mean <= 0.0:
            return f"must have a mean greater than 0 to be lognormal, found {mean:g}"
        if self.standard_deviation_percent is not None and mean == 0.0:
            return "must have a standard_deviation in place of one in per cent, which of a mean of 0 is none"
        return ""

    def quantiles(self, parts: Any, own: float) -> Any:
        """Values below which the parts, 0 to 1, of the distribution lie; ``own`` is the scenario's own value.

        Where that cannot be a mean, as that of a layer that is not there, it is all of them.
        """
        import numpy as np

        if self.lacks(own):
            return np.full(np.shape(parts), own)
        whole = self._untruncated(own)
        below = 0.0 if self.min is None else float(whole.cdf(self.min))
        above = 1.0 if self.max is None else float(whole.cdf(self.max))
        found = whole.ppf(below + np.asarray(parts) * (above - below))
        return np.clip(found, -np.inf if self.min is None else self.min, np.inf if self.max is None else self.max)

    def _untruncated(self, own: float) -> Any:
        from scipy import stats

        if self.distribution == "uniform":
            assert self.min is not None
            assert self.max is not None
            return stats.uniform(self.min, self.max - self.min)
        mean = own if self.mean is None else self.mean
        percent = self.standard_deviation_percent
        deviation = abs(mean) * percent / 100.0 if percent is not None else self.standard_deviation
        assert deviation is not None
        if self.distribution == "normal":
            return stats.norm(mean, deviation)
        shape = sqrt(log1p((deviation / mean) ** 2))
        return stats.lognorm(shape, scale=mean / hypot(1.0, deviation / mean))


class ImpactUncertainty(Section):
    """Distributions of the impact's numbers."""

    velocity_m_s: Distribution | None = None


class ArmourUncertainty(Section):
    """Distributions of the thicknesses."""

    ceramic_thickness_mm: Distribution | None = None
    backing_thickness_mm: Distribution | None = None


class ProjectileUncertainty(Section):
    """Distributions of the projectile's numbers, whichever it is."""

    penetrator_diameter_mm: Distribution | None = None
    penetrator_mass_g: Distribution | None = None
    density_kg_m3: Distribution | None = None
    flow_stress_GPa: Distribution | None = None


class CeramicUncertainty(Section):
    """Distributions of the ceramic's numbers, whichever it is."""

    density_kg_m3: Distribution | None = None
    youngs_modulus_GPa: Distribution | None = None
    flow_stress_GPa: Distribution | None = None


class BackingUncertainty(Section):
    """Distributions of the back plate's numbers, whichever its metal."""

    density_kg_m3: Distribution | None = None
    dynamic_yield_strength_MPa: Distribution | None = None
    flow_stress_GPa: Distribution | None = None
    shear_strength_MPa: Distribution | None = None


class Correlation(Section):
    """Two inputs that vary together."""

    between: Annotated[list[str], Field(min_length=2, max_length=2)]
    coefficient: Annotated[float, Field(gt=-1.0, lt=1.0)]


class Uncertainty(Section):
    """What of a scenario is not known for sure, and how it is sampled."""

    samples: Annotated[int, Field(ge=MIN_SAMPLES, le=MAX_SAMPLES)] = 4096
    seed: Annotated[int, Field(ge=0)] = 1
    method: Literal["sobol", "latin hypercube"] = "sobol"
    impact: ImpactUncertainty = ImpactUncertainty()
    armour: ArmourUncertainty = ArmourUncertainty()
    projectile: ProjectileUncertainty = ProjectileUncertainty()
    ceramic: CeramicUncertainty = CeramicUncertainty()
    backing: BackingUncertainty = BackingUncertainty()
    correlation: list[Correlation] = []

    def inputs(self) -> dict[str, Distribution]:
        """Distributions by the name of the input."""
        found = {}
        for role in ("impact", "armour", "projectile", "ceramic", "backing"):
            section = getattr(self, role)
            for key in type(section).model_fields:
                distribution = getattr(section, key)
                if distribution is not None:
                    found[f"{role}.{key}"] = distribution
        return found

    @model_validator(mode="after")
    def _consistent(self) -> "Uncertainty":
        if self.method == "sobol" and self.samples & (self.samples - 1):
            near = 2 ** self.samples.bit_length()
            raise ValueError(f"samples must be a power of 2 for Sobol' points, such as {near}, found {self.samples}")
        names = list(self.inputs())
        pairs = [frozenset(correlation.between) for correlation in self.correlation]
        for correlation, pair in zip(self.correlation, pairs, strict=True):
            for name in correlation.between:
                if name not in names:
                    raise ValueError(f'correlation must be between inputs that have a distribution, found "{name}"')
            if len(pair) < 2 or pairs.count(pair) > 1:
                raise ValueError(f"correlation must name two inputs, and each two once, found {sorted(pair)}")
        if self.correlation:
            import numpy as np

            if np.linalg.eigvalsh(correlation_matrix(names, self.correlation)).min() <= 0.0:
                raise ValueError("correlation coefficients must go together: their matrix is not positive definite")
        return self


def correlation_matrix(names: Sequence[str], correlations: Sequence[Correlation]) -> "Floats":
    """Correlations of the normal scores of inputs, (n, n)."""
    import numpy as np

    matrix = np.eye(len(names))
    for correlation in correlations:
        i, j = (names.index(name) for name in correlation.between)
        matrix[i, j] = matrix[j, i] = correlation.coefficient
    return matrix


def columns_of(uncertainty: Uncertainty, own: Mapping[str, float], points: "Floats") -> dict[str, "Floats"]:
    """Values of the inputs at points of the unit cube, correlated by a Gaussian copula.

    Parameters
    ----------
    uncertainty : Uncertainty
    own : mapping of str to float
        The scenario's own values.
    points : array, (n, k)
        One coordinate per input, evenly distributed.
    """
    import numpy as np
    from scipy.special import ndtr, ndtri

    inputs = uncertainty.inputs()
    if uncertainty.correlation:
        factor = np.linalg.cholesky(correlation_matrix(list(inputs), uncertainty.correlation))
        points = ndtr(ndtri(points) @ factor.T)
    return {
        name: distribution.quantiles(points[:, i], own[name]) for i, (name, distribution) in enumerate(inputs.items())
    }


def points_of(uncertainty: Uncertainty) -> "Floats":
    """Points of the unit cube, (samples, inputs): of a scrambled Sobol' sequence, or a Latin hypercube."""
    import numpy as np
    from scipy.stats import qmc

    width = len(uncertainty.inputs())
    rng = np.random.default_rng(uncertainty.seed)
    if uncertainty.method == "sobol":
        points = qmc.Sobol(width, rng=rng).random_base2((uncertainty.samples - 1).bit_length())
    else:
        points = qmc.LatinHypercube(width, rng=rng).random(uncertainty.samples)
    # A coordinate of 0 would be the lowest value that there is.
    return np.clip(points, 2.0**-53, 1.0 - 2.0**-53)
