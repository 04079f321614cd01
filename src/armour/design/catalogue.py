"""Catalogue of a scenario: pairs of materials with thicknesses and costs, threats and constraints."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from armour.analysis.variants import Bools, Floats, Ints, Variants, grid_of
from armour.core.state import Parameters
from armour.design.requirements import EVEN, SLACK_ROUNDING
from armour.engine import batch
from armour.errors import Note, Problem, refuse
from armour.evidence.caveats import is_no_metal
from armour.evidence.tests import Far, Materials, is_untested, lacks_sources, what_was_tested
from armour.scenario.inputs import BACKING, CERAMIC, INPUTS, NAMES, OBLIQUITY, VELOCITY, cosine_of, fields_of
from armour.scenario.scenario import Scenario
from armour.scenario.schema import MAX_DESIGNS, OBJECTIVES, BackingLayer, CeramicLayer, DesignSection, Range, Threat
from armour.units import MM

# Keys of [design] that ask for a search of designs; the others apply to the scenario's own armour, too.
ASKING = {"minimise", "pareto", "runners_up_percent", "ceramic", "backing"}
COST_COLUMN = "cost_per_m2"
# Words of the layers by their names in keys.
LAYER_WORDS = {"ceramic": "ceramic", "backing": "back plate"}
# Criterion that is not a column of the candidates.
MARGIN_COLUMN = "margin_m_s"
# Decimals to which areal densities, thicknesses and costs are rounded, so that equal sums compare equal.
SUM_DECIMALS = 9
# Greatest numbers of pairs of materials, and of designs times threats, whose impacts take about a minute.
MAX_MATERIAL_PAIRS = 10_000
MAX_IMPACTS = 10_000_000


class Offer(NamedTuple):
    """A pair: a ceramic and a metal, each with its thicknesses and costs; the ceramic of a bare plate has no name."""

    ceramic: CeramicLayer
    backing: BackingLayer
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float


class CandidateDesigns(NamedTuple):
    """n candidate designs; each column is an array, (n,)."""

    pair: Ints  # index in `Catalogue.offers`
    ceramic_mm: Floats
    backing_mm: Floats
    areal_density_kg_m2: Floats
    thickness_mm: Floats
    cost_per_m2: Floats  # layers without a cost count as 0, see `Catalogue.costed`

    def at(self, where: Ints | Bools | slice) -> "CandidateDesigns":
        """Return some of the candidates, given their indices, a mask or a slice."""
        pair, *numbers = self
        return CandidateDesigns(pair[where], *(column[where] for column in numbers))


@dataclass(frozen=True)
class Catalogue:
    """The pairs of materials that a scenario offers, its threats and its section ``design``, as arrays for a search.

    Parameters of the core are in SI units; their fields are those of `Parameters`.
    """

    scenario: Scenario
    section: DesignSection
    threats: tuple[Threat, ...]
    margins_m_s: Floats  # required of the limits, 0 if none is given, (threats,)
    required: Bools  # whether a probability is required, (threats,)
    bounds: Floats  # greatest probabilities of perforation, 0.5 where none is required, (threats,)
    sampled: bool  # whether uncertain inputs are sampled to judge the bounds
    offers: tuple[Offer, ...]
    layers: Floats  # parameters of the core that a pair sets, 0 elsewhere, (pairs, fields)
    materials: tuple[Materials, ...]  # by pair
    projectiles: Floats  # parameters of the core that a threat sets, 0 elsewhere, (threats, fields)

    def materials_in(self, pair: int) -> dict[str, object]:
        """Return the names of the materials of a pair, given its index, by key of the scenario."""
        layers = zip(LAYER_WORDS, self.offers[pair][:2], strict=True)
        return {NAMES[role]: layer.material for role, layer in layers if layer.material}

    def against(self, pair: int, threat: int) -> Scenario:
        """Return the scenario with the materials of a pair and the impact of a threat, given their indices."""
        # Without its lists of threats and materials, the scenario is made and checked more quickly.
        alone = {"threat": [], "design": None, **self.threats[threat].as_impact()}
        return self.scenario.replaced({**alone, **self.materials_in(pair)})

    @cached_property
    def exact_bounds(self) -> Floats:
        """Bounds on the probabilities of perforation that are computed with exact inputs, (threats,).

        If inputs are sampled, these bounds, twice the given ones but at most 0.5, only exclude hopeless designs: about
        half of the samples are at least as unfavourable as the design's own values, so that the mean probability is at
        least half of that with exact inputs.  A distribution that is not centred on these values gives no such bound.
        """
        if not self.sampled:
            return self.bounds
        placed = any(distribution.placed for distribution in self.scenario.distributions().values())
        return np.full_like(self.bounds, 0.5) if placed else (2.0 * self.bounds).clip(max=0.5)

    @cached_property
    def lacks_sources(self) -> Bools:
        """Whether the ceramic of each pair has neither tests nor two sources of its flow stress, (pairs,)."""
        return np.array([ceramic is not None and lacks_sources(ceramic) for ceramic, _ in self.materials])

    @cached_property
    def metal(self) -> Bools:
        """Whether the back plate of each pair counts as a metal, (pairs,); designs without a metal get no verdict."""
        return np.array([not is_no_metal(offer.backing_density_kg_m3) for offer in self.offers])

    @cached_property
    def untested(self) -> list[bool]:
        """For each pair, whether no test of its ceramic on a metal plate is known; false for a bare plate."""
        return [ceramic is not None and is_untested(ceramic) for ceramic, _ in self.materials]

    @cached_property
    def velocities_m_s(self) -> Floats:
        """Velocities of the threats, m/s, (threats,)."""
        return np.array([threat.velocity_m_s for threat in self.threats])

    def against_each(self, candidates: CandidateDesigns) -> Variants:
        """Return one impact for each design and threat, (designs * threats,), the first design's first."""
        design_of_row, threat_of_row = np.divmod(np.arange(len(candidates.pair) * len(self.threats)), len(self.threats))
        designs = candidates.at(design_of_row)
        # Keep only the materials that occur: the evidence is looked up once for each.
        pairs, place_of_row = np.unique(designs.pair, return_inverse=True)
        # Layers and projectiles set different parameters and are 0 elsewhere: their sum is the whole row.
        rows = Variants(
            self.layers[designs.pair] + self.projectiles[threat_of_row],
            self.velocities_m_s[threat_of_row],
            np.array([cosine_of(threat.obliquity_deg) for threat in self.threats])[threat_of_row],
            place_of_row,
            self.scenario,
            tuple(self.materials[pair] for pair in pairs),
        )
        return rows.with_thicknesses(ceramic_mm=designs.ceramic_mm, backing_mm=designs.backing_mm)

    def combinations(
        self, pair: int, ceramic_mm: Sequence[float] | Floats, backing_mm: Sequence[float] | Floats
    ) -> CandidateDesigns:
        """Return the designs of a pair, given its index, with all combinations of given thicknesses, mm.

        The first ceramic on every back plate comes first.
        """
        ceramics, backings = np.asarray(ceramic_mm, dtype=np.float64), np.asarray(backing_mm, dtype=np.float64)
        return self.candidates(pair, np.repeat(ceramics, len(backings)), np.tile(backings, len(ceramics)))

    def candidates(self, pair: int, ceramic_mm: Floats, backing_mm: Floats) -> CandidateDesigns:
        """Return n designs of a pair, given its index and their thicknesses, mm, (n,), with areal density and cost."""
        offer, inert = self.offers[pair], self.scenario.inert
        ceramic_mass = offer.ceramic_density_kg_m3 * ceramic_mm * MM
        counted_mm = backing_mm * self.scenario.counts_backing
        backing_mass = offer.backing_density_kg_m3 * counted_mm * MM
        ceramic_cost = offer.ceramic.cost(offer.ceramic_density_kg_m3, ceramic_mm)
        backing_cost = offer.backing.cost(offer.backing_density_kg_m3, counted_mm)
        return CandidateDesigns(
            np.full(len(ceramic_mm), pair),
            ceramic_mm,
            backing_mm,
            np.round(ceramic_mass + backing_mass + inert("areal_density_kg_m2"), SUM_DECIMALS),
            np.round(ceramic_mm + counted_mm + inert("thickness_mm"), SUM_DECIMALS),
            np.round(inert("cost_per_m2") + ceramic_cost + backing_cost, SUM_DECIMALS),
        )

    def every(self) -> CandidateDesigns:
        """Return all designs of the catalogue: each pair in all combinations of its thicknesses, pair by pair."""
        parts = [
            self.combinations(pair, offer.ceramic.thicknesses(), offer.backing.thicknesses())
            for pair, offer in enumerate(self.offers)
        ]
        return CandidateDesigns(*map(np.concatenate, zip(*parts, strict=True)))

    def far_from_tests(self, designs: CandidateDesigns) -> list[list[tuple[Far, ...]]]:
        """Return, by design and threat, in what a design is far from the tests; see `evidence.tests.far_from_tests`."""
        layers = [*zip(*(column.tolist() for column in designs[:3]), strict=True)]
        # What was tested does not depend on the thicknesses, except for whether there is a tile.
        tested = {}
        for pair, has_tile in {(pair, tile_mm > 0.0) for pair, tile_mm, _ in layers}:
            armours = self.against_each(self.candidates(pair, np.array([float(has_tile)]), np.ones(1))).armours
            each_threat = enumerate(self.threats)
            tested[pair, has_tile] = [what_was_tested(threat, armours.at([place])) for place, threat in each_threat]
        return [
            [of_threat.far_of(self.materials[pair].ceramic, *sizes_mm) for of_threat in tested[pair, sizes_mm[0] > 0.0]]
            for pair, *sizes_mm in layers
        ]

    def violations(self, candidates: CandidateDesigns) -> Floats:
        """Return by what fraction each design exceeds the limits on areal density, thickness and cost, (n,)."""
        violations = np.zeros(len(candidates.pair))
        for name, words in OBJECTIVES.items():
            if (most := getattr(self.section, words.bound)) is not None:
                violations = np.maximum(violations, getattr(candidates, name) / most - 1.0 - SLACK_ROUNDING)
        return violations

    def objective(self, candidates: CandidateDesigns) -> Floats:
        """Return what the section ``design`` minimises, such as the areal density, of each design, (n,)."""
        return getattr(candidates, self.section.minimise)

    def ranges(self, pair: int) -> list[tuple[str, str, float, float]]:
        """Return the ranges from which the thicknesses of a pair, given its index, are chosen; lists are left out.

        Each comes as its key in the scenario, its layer, "ceramic" or "back plate", and its ends, mm.
        """
        ranges = []
        places = divmod(pair, len(self.section.backing))
        for layer, place, (role, name) in zip(self.offers[pair][:2], places, LAYER_WORDS.items(), strict=True):
            values = layer.thicknesses()
            if isinstance(layer.thickness_mm, Range) and values[0] < values[-1]:
                ranges.append((self._key(role, place), name, values[0], values[-1]))
        return ranges

    def _key(self, role: str, place: int) -> str:
        """Return the key of the thicknesses of a layer, given its role and its place in the list of materials."""
        in_catalogue = getattr(self.scenario.design, role, ())
        return f"design.{role}[{place}].thickness_mm" if in_catalogue else f"optimise.{role}_thickness_mm"

    def omissions(self) -> Iterator[Note]:
        """Warn of each range of thicknesses that is not a whole number of steps."""
        for role in LAYER_WORDS:
            for place, layer in enumerate(getattr(self.section, role)):
                thickness = layer.thickness_mm
                if isinstance(thickness, Range) and (omission := thickness.omission()):
                    yield Note(omission, self._key(role, place))

    @cached_property
    def costed(self) -> list[bool]:
        """For each pair, whether all layers of its designs have a cost; a back plate that exists already needs none."""
        inert = all(layer.has_cost() for layer in self.scenario.armour.layer)
        counted = 1 + self.scenario.counts_backing
        layers = ((offer.ceramic, offer.backing)[:counted] for offer in self.offers)
        return [inert and all(layer.has_cost() for layer in of_pair if layer.material) for of_pair in layers]


def asks_for_design(scenario: Scenario) -> bool:
    """Return whether a scenario asks to search for a design, and not only about its own armour."""
    section = scenario.design
    return scenario.optimise is not None or (section is not None and not section.model_fields_set.isdisjoint(ASKING))


def catalogue_of(scenario: Scenario) -> Catalogue:
    """Return the catalogue of a scenario; if it lists no threats, its impact is the threat.

    Raise an InputError with every mistake in the section ``design``, such as too many designs.
    """
    section = _completed_section(scenario)
    threats = scenario.threats()
    bounds = [*map(section.bound, threats)]  # None where no probability is required
    required = np.array([bound is not None for bound in bounds])
    sampled = bool(required.any() and scenario.distributions())
    refuse([*_numbers_too_large(scenario.file, section, len(threats)), *_wrong_layers(scenario, section)])

    # A bare plate has no ceramic.
    ceramics = [scenario.entry("ceramic", layer.material) if layer.material else None for layer in section.ceramic]
    metals = [scenario.entry("metal", layer.material) for layer in section.backing]
    projectiles = [scenario.entry("projectile", threat.projectile) for threat in threats]
    rounds = zip(threats, projectiles, strict=True)
    inputs = {
        "ceramic": [{} if entry is None else entry.inputs_as("ceramic") for entry in ceramics],
        "backing": [entry.inputs_as("backing") for entry in metals],
        "projectile": [{OBLIQUITY: each.obliquity_deg, **rod.inputs_as("projectile")} for each, rod in rounds],
    }
    varying = {name for rows in inputs.values() for name in INPUTS if len({row.get(name) for row in rows}) > 1}
    refuse(_placed_distributions(scenario, {VELOCITY, CERAMIC, BACKING} | varying) if sampled else ())
    parameters = {role: np.array([_core_parameters(row) for row in rows]) for role, rows in inputs.items()}
    layers = (parameters["ceramic"][:, None] + parameters["backing"][None]).reshape(-1, len(Parameters._fields))
    for name, law in scenario.model.laws().items():
        getattr(batch.fields(parameters["projectile"]), name)[:] = law
    densities = batch.fields(layers)
    pairs = zip(product(section.ceramic, section.backing), densities.rho_c, densities.rho_B, strict=True)
    offers = tuple(Offer(*pair, float(of_ceramic), float(of_backing)) for pair, of_ceramic, of_backing in pairs)
    return Catalogue(
        scenario=scenario,
        section=section,
        threats=threats,
        margins_m_s=np.array([threat.margin_m_s for threat in threats]),
        required=required,
        bounds=np.array([1.0 - EVEN if bound is None else bound for bound in bounds]),
        sampled=sampled,
        offers=offers,
        layers=layers,
        materials=tuple(Materials(*pair) for pair in product(ceramics, metals)),
        projectiles=parameters["projectile"],
    )


def _placed_distributions(scenario: Scenario, varying: Collection[str]) -> Iterator[Problem]:
    """Yield a problem for each distribution with a mean or an end of its own, of an input in `varying`, by name."""
    for name, distribution in scenario.distributions().items():
        if distribution.placed and name in varying:
            message = (
                "must be centred on the value of each design or threat: normal or lognormal, without mean, min and "
                'max, such as { distribution = "normal", standard_deviation_percent = 1.0 }'
            )
            yield Problem(scenario.file, f"uncertainty.{name}", message)


def _wrong_layers(scenario: Scenario, section: DesignSection) -> Iterator[Problem]:
    """Yield a problem for each material of the catalogue that is listed twice or lacks a cost that is asked for.

    Another is a back plate, said to exist already, that is not the armour's own.
    """
    costs = COST_COLUMN in (section.minimise, *(section.pareto or ())) or section.cost_max_per_m2 is not None
    file, armour = scenario.file, scenario.armour
    for role in LAYER_WORDS:
        layers = getattr(section, role)
        for i, layer in enumerate(layers):
            key = f"design.{role}[{i}]"
            if layer.material in [earlier.material for earlier in layers[:i]]:
                message = f'must be listed once, with all its thicknesses, found "{layer.material}" twice'
                yield Problem(file, f"{key}.material", message)
            if costs and layer.material and role != section.existing and not layer.has_cost():
                message = f'must have a cost if [design] asks for costs, found none for "{layer.material}"'
                yield Problem(file, key, message)
    for i, inert in enumerate(scenario.armour.layer):
        if costs and not inert.has_cost():
            yield Problem(file, f"armour.layer[{i}].cost_per_m2", "must be given if [design] asks for costs")
    for backing in section.backing if section.existing else ():
        if (backing.thicknesses(), backing.material) != ((armour.backing_thickness_mm,), armour.backing):
            message = "must be the back plate of [armour] alone, as it exists: {:g} mm {}"
            yield Problem(file, "design.backing", message.format(armour.backing_thickness_mm, armour.backing))


def _numbers_too_large(file: str, section: DesignSection, threats: int) -> Iterator[Problem]:
    """Yield a problem for too many pairs, designs or threats of a catalogue; `threats` is the number of threats."""
    roles = section.ceramic, section.backing
    pairs = len(section.ceramic) * len(section.backing)
    ceramics, backings = (sum(len(layer.thicknesses()) for layer in layers) for layers in roles)
    designs = ceramics * backings
    if pairs > MAX_MATERIAL_PAIRS:
        yield Problem(file, "design", f"must contain at most {MAX_MATERIAL_PAIRS} pairs of materials, found {pairs}")
    if designs > MAX_DESIGNS:
        yield Problem(file, "design", f"must contain at most {MAX_DESIGNS} designs, found {designs}")
    elif designs * threats > MAX_IMPACTS:
        message = f"must list at most {MAX_IMPACTS // designs} threats for {designs} designs, found {threats}"
        yield Problem(file, "threat", message)


def _core_parameters(inputs: Mapping[str, float]) -> list[float]:
    """Return the parameters of the core that some inputs set, by field and in SI units; 0 for the others."""
    fields = fields_of(inputs, 1.0)
    return [fields.get(name, 0.0) for name in Parameters._fields]


def _completed_section(scenario: Scenario) -> DesignSection:
    """Return the section ``design``; if it lists no ceramic, or no back plate, add the scenario's own.

    The thicknesses of the added layer are those of the section ``optimise``; a back plate that exists has its own.
    """
    section, armour = scenario.design or DesignSection(), scenario.armour
    ceramics, backings = section.ceramic, section.backing
    if not ceramics:
        if armour.ceramic is None:
            ceramics = (CeramicLayer.model_construct(material="", thickness_mm=[0.0]),)
        else:
            ceramics = (CeramicLayer(material=armour.ceramic, thickness_mm=grid_of(scenario).ceramic_thickness_mm),)
    if not backings:
        own = [armour.backing_thickness_mm] if section.existing else grid_of(scenario).backing_thickness_mm
        backings = (BackingLayer(material=armour.backing, thickness_mm=own),)
    return section.model_copy(update={"ceramic": ceramics, "backing": backings})
