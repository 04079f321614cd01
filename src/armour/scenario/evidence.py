"""Evidence: the tests that the model was compared with, their ranges, and the error of the ballistic limit on them.

The errors follow from the shipped suites and tests; `tests/validation/test_evidence.py` derives them again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, nan
from typing import Any, NamedTuple

from armour.core.state import Parameters
from armour.errors import InputError, Problem
from armour.units import GPA


@dataclass(frozen=True)
class ModelError:
    """Relative error of the ballistic limit: that of the armour over that of the model, less 1, per cent.

    Attributes
    ----------
    mean_percent, scale_percent : float
        Location and scale of Student's t distribution, %.
    degrees_of_freedom : float
        Of this distribution.
    source : str
        What the error is estimated from.
    extrapolated : tuple of str
        Quantities in which the armour lies outside the tests that the error is estimated from.
    """

    mean_percent: float
    scale_percent: float
    degrees_of_freedom: float
    source: str = ""
    extrapolated: tuple[str, ...] = ()

    def quantile(self, probability: Any) -> Any:
        """Return a quantile, as a fraction, at least -0.99, for a probability of 0 to 1; float or array."""
        # Imported here because most commands that name the error need no quantile.
        import numpy as np
        from scipy.special import stdtrit

        wanted = _numbers("probability", probability, 0.0, 1.0)
        # Versions of scipy differ at 0 and at 1.
        ends = np.where(wanted > 0.5, np.inf, -np.inf)
        deviation = np.where((wanted > 0.0) & (wanted < 1.0), stdtrit(self.degrees_of_freedom, wanted), ends)
        return ((self.mean_percent + self.scale_percent * deviation) / 100.0).clip(min=-0.99)

    def interval(self, limit_m_s: float, tail: float = 0.025) -> tuple[float, float]:
        """Return the interval of the armour's ballistic limit, given that of the model, m/s.

        The probability beyond each end is `tail`, so that by default it has a probability of 95 %.
        """
        _numbers("limit_m_s", limit_m_s, 0.0)
        low, high = (float(limit_m_s * (1.0 + self.quantile(end))) for end in (tail, 1.0 - tail))
        return low, high

    def probability_of_defeat(self, limit_m_s: Any, velocity_m_s: Any) -> Any:
        """Return the probability that the ballistic limit of the armour exceeds a velocity, given that of the model.

        The limit must be above 0; numbers or arrays, m/s.
        """
        from scipy.special import stdtr

        limit, velocity = _numbers("limit_m_s", limit_m_s, 1e-9), _numbers("velocity_m_s", velocity_m_s, 0.0)
        error = 100.0 * (velocity / limit - 1.0)
        return stdtr(self.degrees_of_freedom, (self.mean_percent - error) / self.scale_percent)


def _numbers(name: str, given: Any, low: float, high: float = inf) -> Any:
    """Return a number or numbers as an array; they must lie within bounds."""
    import numpy as np

    found = np.asarray(given)
    is_number = found.dtype.kind in "iuf"
    if not is_number or (found < low).any() or (found > high).any():
        must = f"a number of at least {low:g}" + (f" and at most {high:g}" if high < inf else "")
        raise InputError([Problem("ModelError", name, f"must be {must}, found {str(given)[:40]!r}")])
    return found


# The error of the model as an input.
ERROR = "model.limit_error_percent"
# An error that is not known.
UNKNOWN = ModelError(nan, nan, nan)


class Measure(NamedTuple):
    """A quantity of projectile and armour that was varied in tests."""

    key: str  # key of the scenario that it depends on
    words: str  # what was tested, in the plural
    unit: str
    of: Callable[[Parameters], Any]  # value of one armour, or array of many


CERAMIC_RATIO = Measure("armour.ceramic_thickness_mm", "ceramics", "penetrator diameters thick", lambda p: p.Hc0 / p.D0)
CERAMIC_DENSITY = Measure("ceramic.density_kg_m3", "ceramics of", "kg/m³", lambda p: p.rho_c)
CERAMIC_MODULUS = Measure("ceramic.youngs_modulus_GPa", "ceramics with a modulus of", "GPa", lambda p: p.Ec / GPA)
CERAMIC_STRENGTH = Measure("ceramic.flow_stress_GPa", "a flow stress of", "GPa", lambda p: p.Yc0 / GPA)
BACKING_RATIO = Measure(
    "armour.backing_thickness_mm", "back plates", "penetrator diameters thick", lambda p: p.Hb / p.D0
)
BACKING_DENSITY = Measure("backing.density_kg_m3", "back plates of", "kg/m³", lambda p: p.rho_B)
BACKING_STRENGTH = Measure("backing.flow_stress_GPa", "back plates with a flow stress of", "GPa", lambda p: p.YB / GPA)
SLENDERNESS = Measure("impact.projectile", "penetrators", "diameters long", lambda p: p.L0 / p.D0)
ROD_DENSITY = Measure("projectile.density_kg_m3", "penetrators of", "kg/m³", lambda p: p.rho_p)
ROD_STRENGTH = Measure("projectile.flow_stress_GPa", "penetrators with a flow stress of", "GPa", lambda p: p.Yp / GPA)
BACKING_EXPONENT = Measure("ceramic.flow_stress_backing_exponent", "an exponent of", "", lambda p: p.n_B)
PRODUCT_EXPONENT = Measure("ceramic.flow_stress_product_exponent", "an exponent of", "", lambda p: p.n_cB)
SLOPES = Measure("ceramic.flow_stress_ceramic_slope", "slopes of", "", lambda p: abs(p.a_c) + abs(p.a_B))
LAW_MEASURES = BACKING_EXPONENT, PRODUCT_EXPONENT, SLOPES
CERAMIC_MEASURES = (CERAMIC_DENSITY, CERAMIC_MODULUS, CERAMIC_STRENGTH, *LAW_MEASURES)
# In these an armour may be unusual, see `armour.scenario.applicability.is_unusual`.
OF_CERAMIC = CERAMIC_RATIO, CERAMIC_DENSITY, CERAMIC_STRENGTH
OF_ALL = BACKING_RATIO, BACKING_DENSITY, BACKING_STRENGTH, SLENDERNESS, ROD_DENSITY, ROD_STRENGTH

# Relative differences of density and Young's modulus up to which a ceramic is the same.
SAME_DENSITY, SAME_MODULUS = 0.02, 0.05


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
        return f"{self.measure.words} {self.low:g} to {self.high:g} {self.measure.unit}"


class TestedCeramic(NamedTuple):
    """A ceramic that the model was compared with results of."""

    name: str
    density_kg_m3: float
    youngs_modulus_GPa: float
    strength: DataRange  # flow stresses that were compared
    measured: bool  # else results of the paper's program only

    def ranges(self) -> tuple[DataRange, DataRange]:
        """Return the ranges of density and Young's modulus of such a ceramic."""
        density, modulus = self.density_kg_m3, self.youngs_modulus_GPa
        return (
            DataRange(CERAMIC_DENSITY, density * (1.0 - SAME_DENSITY), density * (1.0 + SAME_DENSITY)),
            DataRange(CERAMIC_MODULUS, modulus * (1.0 - SAME_MODULUS), modulus * (1.0 + SAME_MODULUS)),
        )


class Evidence(NamedTuple):
    """Tests of a kind of armour against a kind of penetrator, and the error of the ballistic limit on them.

    The error applies to armours of the kind, and is extrapolated outside the ranges of the tests.
    """

    title: str
    bare: bool  # whether the armours are plates without a ceramic
    kind: tuple[DataRange, ...]
    measured: tuple[DataRange, ...]  # ranges of the tests
    velocities_m_s: tuple[float, float]
    error: tuple[float, float, float]  # mean and scale, per cent, and degrees of freedom
    computed: tuple[DataRange, ...] = ()  # ranges of tests and results of the paper's program, where wider

    def ranges(self) -> tuple[DataRange, ...]:
        """Return the ranges outside which the armour is like none that the model was compared with, each measure once.

        The ranges of the ceramic are not among them: see CERAMICS.
        """
        within = self.computed or self.measured
        given = {limits.measure for limits in within}
        kind = (limits for limits in self.kind if limits.measure not in (*given, *CERAMIC_MEASURES))
        return (*kind, *within)


CERAMICS = (
    TestedCeramic("AD85", 3430.0, 267.0, DataRange(CERAMIC_STRENGTH, 4.8, 5.6), measured=True),
    TestedCeramic("AD99.5", 3840.0, 350.0, DataRange(CERAMIC_STRENGTH, 5.7, 6.2), measured=False),
    TestedCeramic("Al-N", 3420.0, 300.0, DataRange(CERAMIC_STRENGTH, 6.7, 8.0), measured=False),
)

_STEEL_ROD = DataRange(ROD_DENSITY, 7700.0, 8000.0)
_ROD = DataRange(ROD_DENSITY, 7700.0, 15000.0)
_CORE, _FRAGMENT = DataRange(SLENDERNESS, 2.0, 5.0), DataRange(SLENDERNESS, 0.9, 1.3)
_ALUMINIUM = DataRange(BACKING_DENSITY, 2600.0, 2900.0)
_STEEL = DataRange(BACKING_DENSITY, 7700.0, 8000.0)
_FLOW_STRESS = DataRange(ROD_STRENGTH, 2.3, 2.4)
AD85 = CERAMICS[0]


_WILKINS = (
    DataRange(CERAMIC_RATIO, 0.89, 1.3),
    DataRange(BACKING_RATIO, 0.66, 1.5),
    DataRange(BACKING_STRENGTH, 1.0, 1.1),
    DataRange(SLENDERNESS, 3.2, 3.3),
    _FLOW_STRESS,
)
_WILKINS_AND_PAPER = (
    DataRange(CERAMIC_RATIO, 0.61, 4.1),
    DataRange(BACKING_RATIO, 0.66, 3.0),
    DataRange(BACKING_STRENGTH, 0.9, 1.6),
    DataRange(SLENDERNESS, 3.2, 5.4),
    _FLOW_STRESS,
)
_Ends = tuple[float, float]
_Error = tuple[float, float, float]


def _tiles(
    law: str, backing: _Ends, product: _Ends, velocities_m_s: _Ends, error: _Error, computed: tuple[DataRange, ...] = ()
) -> Evidence:
    """Return the evidence of Wilkins' tests for AD85 by a law of its flow stress with exponents in some ranges."""
    exponents = DataRange(BACKING_EXPONENT, *backing), DataRange(PRODUCT_EXPONENT, *product)
    kind = (*AD85.ranges(), AD85.strength, *exponents, DataRange(SLOPES, 0.0, 0.0), _ALUMINIUM, _STEEL_ROD, _CORE)
    title = f"13 tests of AD85 on 6061-T6 against the 7.62 mm AP (Wilkins){law}"
    return Evidence(title, False, kind, _WILKINS, velocities_m_s, error, computed)


def _plates(
    title: str,
    kind: tuple[DataRange, ...],
    ratios: _Ends,
    strengths_GPa: _Ends,
    velocities_m_s: _Ends,
    error: _Error,
    *slenderness: float,
) -> Evidence:
    """Return the evidence of tests of bare plates, by ends of the ranges; fragments have no range of slenderness."""
    measured = [DataRange(BACKING_RATIO, *ratios), DataRange(BACKING_STRENGTH, *strengths_GPa)]
    if slenderness:
        measured.append(DataRange(SLENDERNESS, *slenderness))
    return Evidence(title, True, kind, (*measured, _FLOW_STRESS), velocities_m_s, error)


_NONE = 0.0, 0.0
EVIDENCE = (
    _tiles("", _NONE, _NONE, (620.0, 1300.0), (0.0, 7.0, 12.0), _WILKINS_AND_PAPER),
    _tiles(", backing law", (0.1, 0.55), _NONE, (620.0, 910.0), (0.0, 5.4, 11.0)),
    _tiles(", product law", _NONE, (0.1, 0.55), (620.0, 910.0), (0.0, 4.9, 11.0)),
    _plates(
        "528 tests of armour-piercing cores on 24 aluminium alloys",
        (_ALUMINIUM, _ROD, _CORE),
        (1.6, 9.7),
        (0.18, 1.5),
        (340.0, 1200.0),
        (-3.1, 7.6, 23.0),
        *(2.4, 3.6),
    ),
    _plates(
        "39 tests of armour-piercing steel cores on 12 steels",
        (_STEEL, _STEEL_ROD, _CORE),
        (0.93, 2.4),
        (2.2, 5.1),
        (460.0, 930.0),
        (-10.3, 11.6, 11.0),
        *(3.2, 3.6),
    ),
    _plates(
        "147 tests of fragment simulators on 14 aluminium alloys",
        (_ALUMINIUM, _STEEL_ROD, _FRAGMENT),
        (0.32, 2.8),
        (0.68, 1.5),
        (160.0, 1500.0),
        (-1.1, 17.0, 13.0),
    ),
    _plates(
        "12 tests of fragment simulators on 7 steels",
        (_STEEL, _STEEL_ROD, _FRAGMENT),
        (0.8, 0.99),
        (2.4, 4.1),
        (700.0, 950.0),
        (-8.2, 17.5, 6.0),
    ),
)


def _covered(measure: Measure, *, bare: bool) -> DataRange:
    """Return the range of a quantity over all armours, bare ones or others, that the model was compared with."""
    of_all = [limits for evidence in EVIDENCE if evidence.bare == bare for limits in evidence.ranges()]
    ceramics = [limits for ceramic in CERAMICS for limits in (ceramic.strength, *ceramic.ranges())]
    found = [limits for limits in (*of_all, *ceramics) if limits.measure is measure]
    return DataRange(measure, min(limits.low for limits in found), max(limits.high for limits in found))


# Ranges over all that the model was compared with, by whether the armour is bare.
COVERED = {
    False: tuple(_covered(measure, bare=False) for measure in (*OF_CERAMIC, *OF_ALL)),
    True: tuple(_covered(measure, bare=True) for measure in OF_ALL),
}
