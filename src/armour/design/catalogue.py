"""What a scenario offers for a design: layers, threats, pairs of materials and the table of candidate designs."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints, Settings, Variants, grid_of, settings_of, with_thicknesses
from armour.engine import batch
from armour.errors import InputError, Problem
from armour.scenario.loading import Scenario
from armour.scenario.parameters import VELOCITY, with_inputs
from armour.scenario.schema import BackingLayer, CeramicLayer, DesignSection, Threat
from armour.units import MM

# Largest relative constraint violation that counts as rounding.
ROUNDING = 1e-12
# Decimals to which areal densities, thicknesses and costs are rounded, so that equal sums compare equal.
DIGITS = 9


class Offer(NamedTuple):
    """A ceramic and a metal, each with the thicknesses on offer."""

    ceramic: CeramicLayer
    backing: BackingLayer
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float


class Candidates(NamedTuple):
    """Candidate designs, an entry each."""

    pair: Ints  # index of the offer
    ceramic_mm: Floats
    backing_mm: Floats
    areal_density_kg_m2: Floats
    thickness_mm: Floats
    cost_per_m2: Floats

    def at(self, where: Ints | Bools) -> "Candidates":
        """Return some of the candidates."""
        pair, *numbers = self
        return Candidates(pair[where], *(column[where] for column in numbers))


class Catalogue:
    """The pairs of materials on offer, the threats that they face and the section ``design`` of a scenario.

    Raises
    ------
    InputError
        If something is missing in the scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.section = scenario.design or DesignSection()
        self.threats = threats_of(scenario)
        self.required_m_s = np.array([threat.required_m_s for threat in self.threats])
        pairs = [(ceramic, backing) for ceramic in ceramics_of(scenario) for backing in backings_of(scenario)]
        rows = [
            batch.packed([scenario_of(scenario, *pair, threat).core_armour() for threat in self.threats])
            for pair in pairs
        ]
        self.parameters = np.array(rows)  # (pairs, threats, 13)
        densities = [batch.fields(row[:1]) for row in rows]
        self.offers = [
            Offer(*pair, float(p.rho_c[0]), float(p.rho_B[0])) for pair, p in zip(pairs, densities, strict=True)
        ]

    @cached_property
    def settings(self) -> Settings:
        """Settings of the scenario."""
        return settings_of(self.scenario)

    @property
    def bounded(self) -> bool:
        """Whether a threat bounds the probability of perforation."""
        return any(threat.probability_of_perforation is not None for threat in self.threats)

    def posed(self, pair: int, threat: int) -> Scenario:
        """Return the scenario with a pair of materials against a threat."""
        offer = self.offers[pair]
        return scenario_of(self.scenario, offer.ceramic, offer.backing, self.threats[threat])

    def variants(self, pair: Ints, ceramic_mm: Floats, backing_mm: Floats, threat: int) -> Variants:
        """Return designs against a threat, a row each, at the velocity that it requires."""
        velocities = np.full(len(pair), self.required_m_s[threat])
        rows = Variants(self.parameters[pair, threat], velocities, self.settings)
        return with_thicknesses(rows, ceramic_mm=ceramic_mm, backing_mm=backing_mm)

    def candidates(self, pair: int, ceramic_mm: Floats, backing_mm: Floats) -> Candidates:
        """Return designs of a pair with their areal density, thickness and cost."""
        offer, section = self.offers[pair], self.section
        layers = (
            (offer.ceramic, offer.ceramic_density_kg_m3, ceramic_mm),
            (offer.backing, offer.backing_density_kg_m3, backing_mm),
        )
        areal_density = np.zeros(len(ceramic_mm))
        cost = np.full(len(ceramic_mm), section.added_cost_per_m2)
        for layer, density, thickness in layers:
            mass = density * thickness * MM
            areal_density += mass
            cost += layer.cost_per_kg * mass + np.where(thickness > 0.0, layer.cost_per_m2, 0.0)
        return Candidates(
            np.full(len(ceramic_mm), pair),
            ceramic_mm,
            backing_mm,
            np.round(areal_density + section.added_areal_density_kg_m2, DIGITS),
            np.round(ceramic_mm + backing_mm + section.added_thickness_mm, DIGITS),
            np.round(cost, DIGITS),
        )

    def violations(self, candidates: Candidates) -> Floats:
        """Return the largest relative constraint violation of each design; 0 where it meets all constraints."""
        violations = np.zeros(len(candidates.pair))
        for values, most in (
            (candidates.thickness_mm, self.section.thickness_max_mm),
            (candidates.areal_density_kg_m2, self.section.areal_density_max_kg_m2),
            (candidates.cost_per_m2, self.section.cost_max_per_m2),
        ):
            if most is not None:
                violations = np.maximum(violations, values / most - 1.0 - ROUNDING)
        return violations


def threats_of(scenario: Scenario) -> tuple[Threat, ...]:
    """Return the threats of a scenario; its impact where it lists none.

    Raises
    ------
    InputError
        If two have the same name, or one bounds a probability and a thickness on offer is free.
    """
    own = Threat(projectile=scenario.impact.projectile, velocity_m_s=scenario.impact.velocity_m_s)
    threats = tuple(scenario.threat) or (own,)
    titles = [threat.title for threat in threats]
    seen: set[str] = set()
    problems = []
    for i, title in enumerate(titles):
        if title in seen:
            message = f'must tell the threat from the others, found "{title}" twice'
            problems.append(Problem(scenario.file, f"threat[{i}].name", message))
        seen.add(title)
    if any(threat.probability_of_perforation is not None for threat in threats):
        layers = [*scenario.design.ceramic, *scenario.design.backing] if scenario.design is not None else []
        if any(layer.free for layer in layers):
            message = "must have a step for each thickness_mm where a threat has probability_of_perforation"
            problems.append(Problem(scenario.file, "design", message))
    if problems:
        raise InputError(problems)
    return threats


def ceramics_of(scenario: Scenario) -> Sequence[CeramicLayer]:
    """Return the ceramics on offer: those of the section ``design``, or the scenario's own in the grid's range."""
    if scenario.design is not None and scenario.design.ceramic:
        return scenario.design.ceramic
    section = grid_of(scenario).ceramic_thickness_mm
    if scenario.armour.ceramic is None:
        return [CeramicLayer.model_construct(material="", thickness_mm=[0.0])]
    return [CeramicLayer(material=scenario.armour.ceramic, thickness_mm=section)]


def backings_of(scenario: Scenario) -> Sequence[BackingLayer]:
    """Return the metals on offer: those of the section ``design``, or the scenario's own in the grid's range."""
    if scenario.design is not None and scenario.design.backing:
        return scenario.design.backing
    return [BackingLayer(material=scenario.armour.backing, thickness_mm=grid_of(scenario).backing_thickness_mm)]


def scenario_of(scenario: Scenario, ceramic: CeramicLayer, backing: BackingLayer, threat: Threat) -> Scenario:
    """Return a scenario with other materials and the impact of a threat."""
    changes: dict[str, object] = {
        "armour.backing": backing.material,
        "impact.projectile": threat.projectile,
        VELOCITY: threat.velocity_m_s,
    }
    if ceramic.material:
        changes["armour.ceramic"] = ceramic.material
    made = scenario.replaced(changes)
    densities = {"ceramic.density_kg_m3": ceramic.density_kg_m3, "backing.density_kg_m3": backing.density_kg_m3}
    given = {name: value for name, value in densities.items() if value is not None}
    return with_inputs(made, given) if given else made
