"""Evidence: what the model was compared with, where an armour is unlike that, and the error of its ballistic limit."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property, reduce
from math import expm1, pi
from operator import and_, or_
from typing import TYPE_CHECKING, Any, NamedTuple

from armour.core.state import Parameters
from armour.errors import InputError, Note, Problem
from armour.files import read_toml, shipped
from armour.scenario.inputs import OBLIQUITY, VELOCITY, cosine_of
from armour.units import GPA

if TYPE_CHECKING:
    from armour.scenario.mixture import Mixture

# Factor by which a quantity of an unusual armour lies outside of all that the model was compared with.
FAR = 2.0
# Relative differences of density and Young's modulus up to which a ceramic is the same.
SAME_DENSITY, SAME_MODULUS = 0.02, 0.05
# More respects than any kind of armour has.
MOST = 1000


@dataclass(frozen=True)
class ModelError:
    """Relative error of the ballistic limit: actual limit divided by computed limit, minus 1, per cent.

    Attributes
    ----------
    mean_percent, scale_percent : float or None
        Location and scale of Student's t distribution, %; None if the distribution is a mixture of several.
    degrees_of_freedom : float or None
        Of this distribution.
    source : str
        Tests, or other source, from which the error is estimated.
    extrapolated : tuple of str
        Quantities in which the armour lies outside the tests from which the error is estimated.
    quantiles_percent : dict of str to float
        Quantiles of the error, %, by probability: "0.025", "0.05", "0.5", "0.95" and "0.975"; of an armour.
    """

    mean_percent: float | None
    scale_percent: float | None
    degrees_of_freedom: float | None
    source: str = ""
    extrapolated: tuple[str, ...] = ()
    quantiles_percent: dict[str, float] = field(default_factory=dict, hash=False)

    @classmethod
    def of_ratio(cls, ratio: "Mixture", source: str, extrapolated: tuple[str, ...] = ()) -> "ModelError":
        """Return the error, given the distribution of the ratio of both limits, (k,)."""
        mean = scale = freedom = None
        used = ratio.weights > 0.0
        if used.sum() == 1:
            [mean], [scale], [freedom] = (
                array[used].tolist() for array in (ratio.locations, ratio.scales, ratio.degrees_of_freedom)
            )
            mean, scale = 100.0 * (expm1(mean) if ratio.logarithmic else mean - 1.0), 100.0 * scale
        quantiles = {str(p): 100.0 * (float(ratio.quantile(p)) - 1.0) for p in QUANTILES}
        found = cls(mean, scale, freedom, source, extrapolated, quantiles)
        vars(found)["ratio"] = ratio
        return found

    @cached_property
    def ratio(self) -> "Mixture":
        """Distribution of the ratio of the armour's ballistic limit to that of the model."""
        # Imported here because most commands that name the error need no distribution.
        import numpy as np

        from armour.scenario.mixture import Mixture

        given = (self.mean_percent, self.scale_percent, self.degrees_of_freedom)
        mean, scale, freedom = (np.array([number], dtype=np.float64) for number in given)
        return Mixture(np.ones(1), 1.0 + mean / 100.0, scale / 100.0, freedom, logarithmic=False)

    def quantile(self, probability: Any) -> Any:
        """Return a quantile, as a fraction, at least -0.99, for a probability of 0 to 1; float or array."""
        import numpy as np

        wanted = np.asarray(probability)
        if not ((wanted >= 0.0) & (wanted <= 1.0)).all():
            raise InputError([Problem("quantile", "probability", f"must be 0 to 1, found {probability}")])
        return (self.ratio.quantile(wanted) - 1.0).clip(min=-0.99)

    def interval(self, limit_m_s: float, tail: float = 0.025) -> tuple[float, float]:
        """Return the interval of the armour's ballistic limit, given that of the model, m/s.

        The probability beyond each end is `tail`, so that by default it has a probability of 95 %.
        """
        low, high = (float(limit_m_s * (1.0 + self.quantile(end))) for end in (tail, 1.0 - tail))
        return low, high

    def median(self, limit_m_s: float) -> float:
        """Return the median of the armour's ballistic limit, given that of the model, m/s."""
        return float(limit_m_s * (1.0 + self.quantile(0.5)))

    def probability_of_defeat(self, limit_m_s: Any, velocity_m_s: Any) -> Any:
        """Return the probability that the ballistic limit of the armour exceeds a velocity, given that of the model.

        The limit must be above 0; numbers or arrays, m/s.
        """
        import numpy as np

        return self.ratio.probability_above(np.asarray(velocity_m_s) / limit_m_s)


# The model error as an input.
ERROR = "model.limit_error_percent"
# Probabilities of the quantiles that results give.
QUANTILES = (0.025, 0.05, 0.5, 0.95, 0.975)


class Measure(NamedTuple):
    """A quantity of projectile and armour that was varied in tests."""

    key: str  # key of the scenario that it depends on
    words: str  # what was tested, in the plural
    unit: str
    of: Callable[[Parameters], Any]  # value of one armour, or array of many


_DIAMETERS = "penetrator diameters thick"
MEASURES = {
    "ceramic_thickness_ratio": Measure("armour.ceramic_thickness_mm", "ceramics", _DIAMETERS, lambda p: p.Hc0 / p.D0),
    "ceramic_density_kg_m3": Measure("ceramic.density_kg_m3", "ceramics of", "kg/m³", lambda p: p.rho_c),
    "ceramic_modulus_GPa": Measure(
        "ceramic.youngs_modulus_GPa", "ceramics with a modulus of", "GPa", lambda p: p.Ec / GPA
    ),
    "ceramic_strength_GPa": Measure("ceramic.flow_stress_GPa", "a flow stress of", "GPa", lambda p: p.Yc0 / GPA),
    "backing_thickness_ratio": Measure("armour.backing_thickness_mm", "back plates", _DIAMETERS, lambda p: p.Hb / p.D0),
    "backing_density_kg_m3": Measure("backing.density_kg_m3", "back plates of", "kg/m³", lambda p: p.rho_B),
    "backing_strength_GPa": Measure(
        "backing.flow_stress_GPa", "back plates with a flow stress of", "GPa", lambda p: p.YB / GPA
    ),
    "rod_length_ratio": Measure("impact.projectile", "penetrators", "diameters long", lambda p: p.L0 / p.D0),
    "rod_mass_ratio": Measure(
        "projectile.penetrator_mass_g",
        "penetrators of",
        "g/mm³, the mass over the cube of the diameter",
        lambda p: 0.25e-6 * pi * p.rho_p * p.L0 / p.D0,
    ),
    "rod_density_kg_m3": Measure("projectile.density_kg_m3", "penetrators of", "kg/m³", lambda p: p.rho_p),
    "rod_strength_GPa": Measure(
        "projectile.flow_stress_GPa", "penetrators with a flow stress of", "GPa", lambda p: p.Yp / GPA
    ),
    "backing_exponent": Measure("ceramic.flow_stress_backing_exponent", "an exponent of", "", lambda p: p.n_B),
    "product_exponent": Measure("ceramic.flow_stress_product_exponent", "an exponent of", "", lambda p: p.n_cB),
    "slopes": Measure("ceramic.flow_stress_ceramic_slope", "slopes of", "", lambda p: abs(p.a_c) + abs(p.a_B)),
}


class DataRange(NamedTuple):
    """Range of a quantity within which the model was tested."""

    measure: Measure
    low: float
    high: float

    def fails(self, armour: Parameters) -> Any:
        """Return whether an armour, or each of many, lies outside the range."""
        value = self.measure.of(armour)
        return (value < self.low) | (value > self.high)

    def __str__(self) -> str:
        values = " to ".join(dict.fromkeys(f"{end:g}" for end in (self.low, self.high)))
        return f"{self.measure.words} {values} {self.measure.unit}"


class TestedCeramic(NamedTuple):
    """A ceramic that the model was compared with results of."""

    name: str
    kind: tuple[DataRange, ...]  # densities and Young's moduli of such a ceramic
    strength: DataRange  # flow stresses that were compared
    measured: bool  # else results of the paper's program only


class Evidence(NamedTuple):
    """Tests of a kind of armour against a kind of penetrator, and the error of the ballistic limit on them.

    The error applies to armours of the kind, and is extrapolated outside the ranges of the tests.
    """

    title: str
    source: str  # its key of the bibliography is in brackets
    bare: bool  # whether the armours are plates without a ceramic
    laws: tuple[tuple[DataRange, ...], ...]  # of the ceramic's flow stress, one of which an armour has
    kind: tuple[DataRange, ...]  # of armour and penetrator, the ceramic included
    measured: tuple[DataRange, ...]  # ranges of the tests
    ranges: tuple[DataRange, ...]  # outside them, but for the ceramic, an armour is like none that was compared
    velocities_m_s: tuple[float, float]
    fits: tuple[str, ...]  # of the error, by name; of a ceramic, one for each law
    obliquity_max_deg: float  # greatest angle of the tests

    def differences(self, armour: Parameters) -> Any:
        """Return in how many respects an armour, or each of n, differs; with and without ceramic in most."""
        found = MOST * (self.bare != (armour.Hc0 == 0.0)) + self.of_other_law(armour)
        return sum((limits.fails(armour) for limits in self.kind), start=found)

    def extrapolated(self, armour: Parameters) -> tuple[str, ...]:
        """Return the ranges of the tests, in words, that an armour lies outside of."""
        return tuple(str(limits) for limits in self.measured if limits.fails(armour))

    def of_other_law(self, armour: Parameters) -> Any:
        """Return whether the flow stress of the ceramic of an armour, or of each of n, has none of the laws."""
        return reduce(and_, (is_outside(law, armour) for law in self.laws), bool(self.laws))

    def angles(self) -> str:
        """Return the angles of the tests, in words."""
        if self.obliquity_max_deg:
            return f"tests of such plates at up to {self.obliquity_max_deg:g}° only"
        return f"no test of {'such a plate' if self.bare else 'an armour with a ceramic'} at an angle"

    def fails_angle(self, cosine: Any) -> Any:
        """Return whether there are no tests at such an angle, of which the cosine is given, or each of many."""
        return cosine < cosine_of(self.obliquity_max_deg)


def is_outside(ranges: Iterable[DataRange], armour: Parameters) -> Any:
    """Return whether an armour, or each of n, lies outside any of some ranges."""
    return reduce(or_, (limits.fails(armour) for limits in ranges), False)


def _ranges(data: Mapping[str, tuple[float, float]]) -> tuple[DataRange, ...]:
    return tuple(DataRange(MEASURES[name], *ends) for name, ends in data.items())


@cache
def shipped_data() -> dict[str, Any]:
    """Return configs/evidence.toml."""
    return read_toml(shipped("configs") / "evidence.toml")


@cache
def tested_ceramics() -> dict[str, TestedCeramic]:
    """Return the ceramics that the model was compared with results of, by name."""
    found = {}
    for data in shipped_data()["ceramic"]:
        density, modulus = data["density_kg_m3"], data["youngs_modulus_GPa"]
        kind = {
            "ceramic_density_kg_m3": (density * (1.0 - SAME_DENSITY), density * (1.0 + SAME_DENSITY)),
            "ceramic_modulus_GPa": (modulus * (1.0 - SAME_MODULUS), modulus * (1.0 + SAME_MODULUS)),
        }
        [strength] = _ranges({"ceramic_strength_GPa": data["flow_stress_GPa"]})
        found[data["name"]] = TestedCeramic(data["name"], _ranges(kind), strength, data["measured"])
    return found


@cache
def shipped_evidence() -> tuple[Evidence, ...]:
    """Return the tests that the model was compared with."""
    found = []
    for data in shipped_data()["tests"]:
        laws, kind = shipped_data()["law"], data["kind"]
        tested = tested_ceramics().get(data.get("ceramic", ""))
        ceramic = () if tested is None else (*tested.kind, tested.strength)
        # A mass ratio follows from slenderness and density, of which there are ranges.
        within = {k: ends for k, ends in data.get("computed", data["measured"]).items() if k != "rod_mass_ratio"}
        found.append(
            Evidence(
                title=data["title"],
                source=data["source"],
                bare=tested is None,
                laws=tuple(_ranges(laws[fit]) for fit in data["fits"] if fit in laws),
                kind=(*ceramic, *_ranges(kind)),
                measured=_ranges(data["measured"]),
                ranges=_ranges({name: ends for name, ends in kind.items() if name not in within} | within),
                velocities_m_s=tuple(data["velocities_m_s"]),
                fits=tuple(data["fits"]),
                obliquity_max_deg=data.get("obliquity_max_deg", 0.0),
            )
        )
    return tuple(found)


@cache
def covered(*, bare: bool) -> tuple[DataRange, ...]:
    """Return the ranges over all armours with a ceramic, or bare ones, that the model was compared with."""
    ranges: dict[Measure, list[DataRange]] = {}
    ceramics = [] if bare else [limits for c in tested_ceramics().values() for limits in (c.kind[0], c.strength)]
    tests = [limits for evidence in shipped_evidence() if evidence.bare == bare for limits in evidence.ranges]
    for limits in (*ceramics, *tests):
        ranges.setdefault(limits.measure, []).append(limits)
    return tuple(
        DataRange(measure, min(one.low for one in of), max(one.high for one in of)) for measure, of in ranges.items()
    )


NO_TEST = "no test of such an armour is known"
REMEDY = "own tests (armour calibrate) or [uncertainty.model] can give it"


def why_unknown(armour: Parameters, cosine: float) -> str:
    """Return why the model error is not known for an armour at an angle, and what can give it."""
    evidence = closest(armour)
    reason = NO_TEST
    if not evidence.differences(armour):
        far = ", ".join(evidence.extrapolated(armour))
        reason = f"the armour is too far outside the tests, which are of {far}"
        if evidence.fails_angle(cosine):
            reason = f"the model was compared with {evidence.angles()}"
    return f"{reason}; {REMEDY}"


class Limit(NamedTuple):
    """A respect in which an armour, or each of n, may lie outside what the model was compared with."""

    key: str
    words: str  # what the model was compared with
    outside: Any  # bool or array of bool, (n,)
    value: Any = None  # number or array, (n,); None if the name of the ceramic tells it


def closest(armour: Parameters) -> Evidence:
    """Return the evidence whose kind of armour and penetrator an armour differs from in the fewest respects."""
    return min(shipped_evidence(), key=lambda evidence: evidence.differences(armour))


def is_unusual(armour: Parameters) -> Any:
    """Return whether an armour, or each of n, is far from all of its kind that the model was compared with.

    A strength, a density, the slenderness or a thickness over the diameter is then outside by more than a factor of
    two, and the outcome may change more than once with the velocity or a thickness.  A NaN is not outside.
    """
    found = False
    for bare in (False, True):
        for limits in covered(bare=bare):
            value = limits.measure.of(armour)
            outside = (value < limits.low / FAR) | (value > limits.high * FAR)
            found = found | (outside & ((armour.Hc0 == 0.0) == bare))
    return found


def armour_warnings(
    armour: Parameters, ceramic: str | None, velocity: float, cosine: float, keys: Mapping[str, str]
) -> tuple[Note, ...]:
    """Return the ways in which an armour is unlike what the model was compared with, as "key: what, value found".

    `ceramic` is the name of its ceramic, and `keys` are keys to name in place of others.
    """
    limits = limits_of(closest(armour), armour, velocity, cosine)
    outside = (limit for limit in limits if limit.outside)
    return tuple(Note(f"{limit.words}{_found(ceramic, limit)}", keys.get(limit.key, limit.key)) for limit in outside)


def _found(ceramic: str | None, limit: Limit) -> str:
    if limit.key == OBLIQUITY:
        return ""
    if limit.value is None:
        return f', found "{ceramic}"'
    return f", found {limit.value:.0f}" if limit.value >= 100.0 else f", found {limit.value:.3g}"


def limits_of(evidence: Evidence, armour: Parameters, velocity: Any, cosine: Any) -> Iterator[Limit]:
    """Give the limits of some evidence, and whether an armour, a velocity and an angle, or each of many, are outside.

    The velocity is None if none is to be compared.
    """
    yield Limit(OBLIQUITY, f"the model was compared with {evidence.angles()}", evidence.fails_angle(cosine))
    if velocity is not None:
        low, high = evidence.velocities_m_s
        words = f"the model was compared with results at {low:g} to {high:g} m/s"
        yield Limit(VELOCITY, words, (velocity < low) | (velocity > high), velocity)
    if not evidence.bare:
        yield from _of_ceramic(evidence, armour)
    for limits in evidence.ranges:
        words = f"the model was compared with results for {limits}"
        yield Limit(limits.measure.key, words, limits.fails(armour), limits.measure.of(armour))


def _of_ceramic(evidence: Evidence, armour: Parameters) -> Iterator[Limit]:
    """Give the limits of the ceramics that were tested, or that the paper's program computed."""
    ceramics = tested_ceramics().values()
    untested = unknown = True
    for ceramic in ceramics:
        different = is_outside(ceramic.kind, armour)
        unknown = unknown & different
        if ceramic.measured:
            untested = untested & different
        words = f"the model was compared with results of {ceramic.name} with {ceramic.strength}"
        measure = ceramic.strength.measure
        yield Limit(measure.key, words, ceramic.strength.fails(armour) & (different ^ True), measure.of(armour))
    other = evidence.of_other_law(armour)
    yield Limit("armour.ceramic", "the model was compared with no test by such a law of the flow stress", other)
    names = ", ".join(ceramic.name for ceramic in ceramics)
    yield Limit("armour.ceramic", f"the model was compared with results of {names} only", unknown)
    words = "the model was compared with results of the paper's program for such a ceramic, with no test"
    yield Limit("armour.ceramic", words, untested ^ unknown)


def row_limits(armour: Any, velocities: Any, cosines: Any) -> Iterator[tuple[str, int]]:
    """Yield the limits, as "key: words", that some of n armours lie outside of, and how many do.

    The parameters of the armours are arrays, (n,), as are the cosines of the obliquities and the velocities, which are
    None if none are to be compared.
    """
    import numpy as np

    nearest = np.argmin([evidence.differences(armour) for evidence in shipped_evidence()], axis=0)
    for index in np.unique(nearest):
        where = nearest == index
        some = Parameters(*(values[where] for values in armour))
        speeds = None if velocities is None else velocities[where]
        for limit in limits_of(shipped_evidence()[index], some, speeds, cosines[where]):
            count = int(np.count_nonzero(limit.outside))
            if count:
                yield f"{limit.key}: {limit.words}", count
