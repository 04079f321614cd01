"""Find tested armours: those nearest to a ballistic limit, and what each entry of the library was tested with."""

from dataclasses import dataclass
from functools import cache
from math import log
from typing import NamedTuple

import numpy as np

from armour.analysis.evaluate import groups_of
from armour.analysis.variants import Floats
from armour.csv_files import shipped_rows
from armour.files import shipped_files
from armour.scenario.inputs import BACKING, CERAMIC, LAYERS, NAMES, OBLIQUITY, ROD, ROLES, Kind
from armour.scenario.library import shipped_library
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics.measured import LIMIT
from armour.units import MM
from armour.validation.formulas import along_fire_kg_m2

# Largest relative difference of cores that are alike in diameter, mass and density.
ALIKE_PART = 0.1
# Wilkins' tests as the paper's suite names them.
COMPARED_TESTS = "table 3, Wilkins' measurements"


class WilkinsTests(NamedTuple):
    """Wilkins' n tests of tiles on plates; arrays, (n,)."""

    scenarios: list[Scenario]
    columns: dict[str, Floats]  # thicknesses, mm, by key
    areal_densities: Floats  # along the line of fire, kg/m²
    limits: Floats  # as measured, m/s

    def words(self) -> str:
        """Return number, round, materials and range of areal densities in words."""
        projectile, ceramic, backing = (self.scenarios[0].name_of(role) for role in ROLES)
        span = f"{self.areal_densities.min():.1f} to {self.areal_densities.max():.1f} kg/m²"
        return f"{len(self.limits)} tests of {projectile} on {ceramic} and {backing}, {span} ({COMPARED_TESTS})"


@cache
def wilkins_tests() -> WilkinsTests:
    """Return Wilkins' tests, with the shipped scenario of this name."""
    wilkins, rows = load_scenario(shipped_files("scenarios", ".toml")["wilkins"]), shipped_rows("tests/wilkins")
    columns = {key: np.array([float(row[key]) for row in rows]) for key in (*LAYERS, LIMIT)}
    limits = columns.pop(LIMIT)
    scenarios = [wilkins.replaced({key: float(row[key]) for key in LAYERS}) for row in rows]
    return WilkinsTests(scenarios, columns, np.array([*map(along_fire_kg_m2, scenarios)]), limits)


@dataclass(frozen=True)
class MeasuredArmour:
    """An armour whose ballistic limit was measured at normal incidence.

    Attributes
    ----------
    armour, projectile : str
        Layers of the armour, and name of the round.
    areal_density_kg_m2, ballistic_limit_m_s : float
        Areal density, kg/m², and measured limit, m/s.
    """

    armour: str
    projectile: str
    areal_density_kg_m2: float
    ballistic_limit_m_s: float


def nearest_measured(scenario: Scenario, limit_m_s: float) -> tuple[MeasuredArmour, ...]:
    """Return the tested armours with limits nearest to one, m/s: one with a ceramic, and a bare plate of each metal.

    Only tests with a core like that of the scenario count.  At an angle there are none.
    """
    core = [scenario.inputs()[name] for name in ROD]
    nearest: dict[str, MeasuredArmour] = {}
    for kind, values, measured in _shipped_measurements() if not scenario.impact.obliquity_deg else ():
        if all(abs(value / own - 1.0) <= ALIKE_PART for value, own in zip(values, core, strict=True)):
            distance = abs(log(measured.ballistic_limit_m_s / limit_m_s))
            if kind not in nearest or distance < abs(log(nearest[kind].ballistic_limit_m_s / limit_m_s)):
                nearest[kind] = measured
    return tuple(nearest.values())


def limits_measured(scenario: Scenario) -> list[float]:
    """Return the ballistic limits, m/s, that the shipped tests measured of this very armour with this very round."""
    core, angle = tuple(scenario.inputs()[name] for name in ROD), scenario.impact.obliquity_deg
    subject = scenario.armour_words(), scenario.impact.projectile
    return [
        each.ballistic_limit_m_s
        for _, values, each in (_shipped_measurements() if not angle else ())
        if ((each.armour, each.projectile), values) == (subject, core)
    ]


@cache
def _shipped_measurements() -> tuple[tuple[str, tuple[float, ...], MeasuredArmour], ...]:
    """Return the shipped tests at normal incidence, each as its kind, its core and its armour.

    The kind is "ceramic" or the metal of a bare plate.  The core has the values of the inputs `ROD`, in their units.
    """
    tests, wilkins = [], wilkins_tests()
    for scenario, limit in zip(wilkins.scenarios, wilkins.limits.tolist(), strict=True):
        density = scenario.areal_density_kg_m2()
        measured = MeasuredArmour(scenario.armour_words(), scenario.impact.projectile, density, limit)
        tests.append(("ceramic", tuple(scenario.inputs()[name] for name in ROD), measured))
    for row in shipped_rows("tests/plates"):
        if float(row[OBLIQUITY]) == 0.0:
            thickness_mm, density = float(row[BACKING]), float(row["backing.density_kg_m3"])
            plate = f"{thickness_mm:g} mm {row['plate']}"
            measured = MeasuredArmour(plate, row["round"], thickness_mm * MM * density, float(row[LIMIT]))
            tests.append((row["metal"], tuple(float(row[name]) for name in ROD), measured))
    return tuple(tests)


@cache
def tested_with() -> dict[tuple[Kind, str], tuple[str, ...]]:
    """Return what each library entry was tested with, by its kind and name: rounds for a material, and vice versa."""
    # Files of the same name in the working folder must not replace the shipped ones.
    library, wilkins = shipped_library(), wilkins_tests().scenarios[0]
    rounds = library.known("projectile")
    plates = [row for row in shipped_rows("tests/plates") if row["round"] in rounds]
    tested: dict[tuple[Kind, str], dict[str, None]] = {}

    def add(kind: Kind, name: str, words: str) -> None:
        """Add what an entry was tested with, in words, once."""
        tested.setdefault((kind, name), {})[words] = None

    bare = {
        NAMES["backing"]: np.array([row["plate"] for row in plates]),
        NAMES["projectile"]: np.array([rounds[row["round"]] for row in plates]),
        BACKING: np.array([float(row[BACKING]) for row in plates]),
    }
    for group in groups_of(wilkins.replaced({CERAMIC: 0.0}), bare):
        if group.variants.errors.known.any():
            metal, projectile = (str(bare[NAMES[role]][group.where[0]]) for role in ("backing", "projectile"))
            add("metal", metal, projectile)
            add("projectile", projectile, metal)
    metal, projectile = wilkins.armour.backing, wilkins.impact.projectile
    for ceramic in library.names("ceramic"):
        [group] = groups_of(wilkins.replaced({NAMES["ceramic"]: ceramic}), wilkins_tests().columns)
        if group.variants.errors.known.any():
            add("ceramic", ceramic, f"{projectile}, on {metal}")
            add("metal", metal, f"{projectile}, with {wilkins.armour.ceramic}")
            add("projectile", projectile, f"{wilkins.armour.ceramic} on {metal}")
    return {entry: tuple(words) for entry, words in tested.items()}
