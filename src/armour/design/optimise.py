"""Design optimisation: the best design that stops every threat, and its comparison with the others."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from math import inf, isnan
from time import perf_counter
from typing import Any, Literal

import numpy as np

from armour.analysis.ballistic_limit import NeededFlowStress, needed_flow_stress
from armour.analysis.estimates import Estimate
from armour.analysis.results import OnProgress, TableResult, data_frame, ignore_progress
from armour.analysis.variants import Ints, outside_words
from armour.core.state import Parameters
from armour.design.catalogue import FIRST_VALUES, MARGIN_COLUMN, NO_BOUND, CandidateDesigns, Catalogue, catalogue_of
from armour.design.designs import NOT_KNOWN, PASSES, Designs, Reliability, Runs, required_of, stopped, verdicts_of
from armour.design.requirements import Requirement, against_threat, of_armour, verdict_of
from armour.design.search import FreeThicknesses, candidates_of, pareto
from armour.errors import Note, joined, listed
from armour.evidence.caveats import caveats, no_metal
from armour.evidence.model_error import INTERLAYER, REMEDY, ModelError, error_of
from armour.evidence.tests import against_each, contradicted, threat_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import BACKING, CERAMIC, NAMES
from armour.scenario.scenario import Scenario, Varied
from armour.scenario.schema import OBJECTIVES, DesignSection, RequiredProbability
from armour.units import MM

# Words that begin the reason of a pair of materials: no test of it is known, but of others; its ceramic's flow stress
# has too few sources; it is nearly as good as the best.
NO_TEST_KNOWN, UNSOURCED, RUNNER_UP = "no test", "fewer than two sources of its flow stress", "runner-up: "
# Words after the threats that a design stops by the computed limit, while its probability is not known.
BY_LIMIT = " by the computed limit"
# Most designs that a result lists, and most pairs for which it has needed flow stresses; most designs to compare in the
# search for the nearest design.
MOST_SHOWN, MOST_COMPARED = 25, 20_000
Reason = Literal["", "none passes", "not known"]
# Number of impacts from which on the time of a search is estimated; about how many thicknesses of each layer are tried
# for the estimate.
MANY_IMPACTS, SOME_THICKNESSES = 500_000, 50
# Most thicknesses that a warning lists.
MOST_LISTED = 5


@dataclass(frozen=True)
class Design:
    """A design of the catalogue.

    Attributes
    ----------
    ceramic, backing : str
        Names of the materials; the ceramic's is empty for a bare back plate.
    ceramic_thickness_mm, backing_thickness_mm : float
    areal_density_kg_m2, thickness_mm : float
        Including layers without ballistic effect, without a back plate that exists already.
    cost_per_m2 : float or None
        Cost of these layers, in the unit of the costs given; None unless each material has a cost.
    margin_m_s : float or None
        Smallest difference between ballistic limit and velocity over the threats; None if not computed.
    untested : bool
        Whether no test of the ceramic on metal is known.
    whole_areal_density_kg_m2, whole_thickness_mm : float
        The same, including a back plate that exists already.
    outside_tests : dict of str to float
        Factor by which the design lies outside the tests, by quantity, the farthest first: above 1 beyond the greatest
        value tested, below 1 beneath the least, infinite (null in JSON) for what no test has, such as its ceramic.
        The threat against which it lies farthest outside counts.  Empty inside the tests.
    """

    ceramic: str
    backing: str
    ceramic_thickness_mm: float
    backing_thickness_mm: float
    areal_density_kg_m2: float
    thickness_mm: float
    cost_per_m2: float | None
    margin_m_s: float | None
    untested: bool
    whole_areal_density_kg_m2: float
    whole_thickness_mm: float
    outside_tests: dict[str, float] = field(hash=False)


@dataclass(frozen=True)
class BestDesign(Design):
    """A design with its ballistic limits and, if it does not pass, its shortfall.

    Attributes
    ----------
    ballistic_limit_m_s : float or None
        Against the governing threat; None if it lies outside the range of the section ``ballistic_limit``.
    ceramic_density_kg_m3, backing_density_kg_m3 : float
    margins_m_s : dict of str to float
        By threat: the lowest ballistic limit, at most 10,000 m/s, minus the velocity of the threat.
    governing : str
        Threat whose required velocity the ballistic limit exceeds by the smallest amount.
    probabilities : dict of str to Estimate
        Probabilities of perforation from samples of uncertain inputs, for the threats that set a bound on it.
    probabilities_of_stopping : dict of str to float or None
        By threat; None if the model error is not known.
    model_error : ModelError or None
        Relative error of the ballistic limit against the governing threat.
    short_m_s : dict of str to float
        By threat: shortfall of the ballistic limit from the limit required, m/s; the required probability counts if the
        model error is known.
    exceeds : dict of str to float
        Excess over each limit of the section ``design`` that is exceeded, by its key.
    flow_stress : dict of str to NeededFlowStress
        By threat: flow stress that a ceramic without tests needs to stop it; empty if it is not computed.
    requirements : tuple of Requirement
        All that is required of the design, with what it has.
    """

    ballistic_limit_m_s: float | None
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float
    margins_m_s: dict[str, float]
    governing: str
    probabilities: dict[str, Estimate]
    probabilities_of_stopping: dict[str, float | None]
    model_error: ModelError | None
    short_m_s: dict[str, float]
    exceeds: dict[str, float]
    flow_stress: dict[str, NeededFlowStress] = field(default_factory=dict)
    requirements: tuple[Requirement, ...] = ()

    def changes_to(self, scenario: Scenario) -> dict[str, str | float]:
        """Return the changes, by key, that make the design the armour of a scenario."""
        names = {"ceramic": self.ceramic or None, "backing": self.backing}
        named = {NAMES[role]: name for role, name in names.items() if name and name != scenario.name_of(role)}
        numbers = {
            CERAMIC: self.ceramic_thickness_mm,
            BACKING: self.backing_thickness_mm,
            "ceramic.density_kg_m3": self.ceramic_density_kg_m3,
            "backing.density_kg_m3": self.backing_density_kg_m3,
        }
        inputs = scenario.replaced(named).inputs()
        return {**named, **{key: value for key, value in numbers.items() if inputs.get(key, value) != value}}


@dataclass(frozen=True)
class Pair:
    """A ceramic and a metal, with their best design.

    Attributes
    ----------
    ceramic, backing : str
    best : BestDesign or None
    excess_percent : float or None
        Excess of its objective over that of the best design of all pairs.
    reason : str
        Reason why its best design is not the best of all pairs, or why it has none.
    ranked : bool
        Whether the pair is ranked with the others: not if the model error is unknown for its best design but known for
        the best of all pairs, nor if its ceramic has neither tests nor two sources of its flow stress.
    untested : bool
        Whether no test of the ceramic on metal is known.
    """

    ceramic: str
    backing: str
    best: BestDesign | None
    excess_percent: float | None
    reason: str
    ranked: bool = True
    untested: bool = False


@dataclass(frozen=True, repr=False)
class DesignResult(TableResult):
    """Result of a design optimisation.

    Attributes
    ----------
    minimised : str
        Objective.
    threats : tuple of str
    best : BestDesign or None
        None if no design is known to pass.
    reason : {"", "none passes", "not known"}
        Why there is no best design: none passes, or it is not known whether one passes.  It is not known if the
        probability is unknown for all designs whose ballistic limit by the model is high enough, or if ballistic
        limits by the model are known to be too low.
    explanation : str
        The reason in a sentence; empty if there is a best design.
    nearest : BestDesign or None
        Without a best design: the best one by the model's ballistic limit or, if none passes, the design within the
        limits of the section ``design`` whose greatest shortfall against a threat is the smallest.
    without_limits : BestDesign or None
        If none passes: the design that would be the best without the limits of the section ``design``, if any.
    frontier : tuple of Design
        For each back plate thickness of the best pair, the design with the thinnest ceramic that passes, bounds on
        probabilities included; of more than 1,000 thicknesses, only for every second, third, and so on.
    frontier_governed_by : tuple of str
        Governing threat of each design of the frontier.
    pairs : tuple of Pair
        Best first.
    criteria : tuple of str
        Criteria of the Pareto front.
    pareto : tuple of Design
        Pareto front; empty if not requested.
    designs : int
        Number of designs that meet the constraints.
    runs : int
        Impacts computed to decide which designs pass, samples of uncertain inputs not counted.
    not_monotonic_mm : tuple of float
        Back plate thicknesses of the frontier at which a thicker ceramic was found not to pass, mm.
    warnings : tuple of str
        Ways in which the best design lies outside the validated range or at an end of a range of thicknesses.
    ceramic_min_mm : float or None
        Least ceramic thickness of the best pair's range, mm: if it passes, less may be required. None if the
        ceramic has no range, or one from zero.
    without_mm : tuple of float
        Back plate thicknesses of the best pair on which no ceramic passes, mm; the frontier leaves them out.
    every : tuple of Design
        All designs that meet the constraints, best first; empty if there are more than 25.
    margins_of_every_m_s : tuple of dict of str to float
        Margin of each design of ``every``, by threat, m/s.
    """

    minimised: str
    threats: tuple[str, ...]
    best: BestDesign | None
    reason: Reason
    explanation: str
    nearest: BestDesign | None
    without_limits: BestDesign | None
    frontier: tuple[Design, ...]
    frontier_governed_by: tuple[str, ...]
    pairs: tuple[Pair, ...]
    criteria: tuple[str, ...]
    designs: int
    runs: int
    warnings: tuple[str, ...]
    pareto: tuple[Design, ...] = ()
    not_monotonic_mm: tuple[float, ...] = ()
    ceramic_min_mm: float | None = None
    without_mm: tuple[float, ...] = ()
    every: tuple[Design, ...] = ()
    margins_of_every_m_s: tuple[dict[str, float], ...] = ()

    @property
    def shown(self) -> BestDesign | None:
        """The best design or, without one, the nearest."""
        return self.best or self.nearest

    @property
    def reported(self) -> BestDesign | None:
        """The design shown or, without one, the best design of the first pair that has one; it is not ranked then."""
        return self.shown or next((pair.best for pair in self.pairs if pair.best is not None), None)

    def to_dataframe(self, designs: Literal["frontier", "pareto"] = "frontier") -> Any:
        """Return the frontier, or the Pareto front, as a data frame of pandas, or else of polars."""
        return data_frame(self._columns(designs))

    def _columns(self, designs: str = "frontier") -> dict[str, Any]:
        names = [item.name for item in fields(Design)]
        columns = {name: [getattr(design, name) for design in getattr(self, designs)] for name in names}
        return columns | {"outside_tests": list(map(outside_words, columns["outside_tests"]))}

    def _words(self) -> str:
        best = self.shown
        if best is None:
            return self.reason
        nearest = f"{self.reason}, nearest " if self.reason else ""
        return f"{nearest}{armour_in_words(best)}, {best.areal_density_kg_m2:.2f} kg/m²"


def armour_in_words(design: Design) -> str:
    """Return the layers of a design, such as "11 mm AD85 on 6 mm 5083-H3"."""
    ceramic = f"{design.ceramic} (untested)" if design.untested else design.ceramic
    layers = (design.ceramic_thickness_mm, ceramic), (design.backing_thickness_mm, design.backing)
    return " on ".join(f"{round(thickness, 3):g} mm {name}" for thickness, name in layers if name and thickness)


@checked
def optimise(
    scenario: Scenario,
    *,
    probability: RequiredProbability | None = None,
    on_progress: OnProgress = ignore_progress,
) -> DesignResult:
    """Find the best design of a scenario that stops its threats.

    A design passes if it meets all requirements, as `check` judges them, with its lowest ballistic limits.  The impacts
    of all designs of given thicknesses are computed: no monotonic dependence is assumed.  For a free thickness, the
    least value that passes is found by bisection.  If inputs have distributions and a probability is required, designs
    are sampled in the order of the objective.

    Parameters
    ----------
    scenario : Scenario
        Its sections ``design`` and ``optimise`` give the materials and thicknesses, its list ``threat`` the threats;
        without them, they are the scenario's own pair of materials and impact.  Where there are threats, the impact is
        not used.
    probability : float, optional
        Least probability of stopping each threat, such as 0.95; a higher one that the scenario requires stays.
    on_progress : callable, optional
        Called with the number of impacts computed since the last call, and None, as their total is not known.

    Returns
    -------
    DesignResult

    Raises
    ------
    InputError
        If something is missing in the scenario, or a run does not end.
    """
    scenario = scenario.requiring(probability)
    catalogue = catalogue_of(scenario)
    search = FreeThicknesses(catalogue, Runs(on_progress))
    designs, place, reason = _best_place(search)
    least = NOT_KNOWN if reason else PASSES
    without_limits = None
    if reason == "none passes" and catalogue.metal.any():
        explanation, without_limits = _failure(designs, search)
        if catalogue.has_free_layer:
            columns = CandidateDesigns.joined(
                [_some_of_range(catalogue, pair) for pair in range(len(catalogue.offers))]
            )
            designs = Designs(catalogue, columns, designs.runs, designs.reliability)
        order = _nearest(designs)
        place, pairs = int(order[0]), _short_pairs(designs, order)
    else:
        order, pairs = designs.offered, _pairs(designs, search, place, least)
        explanation = _why_not_known(designs, place) if reason else ""
    shown = None if place is None else _best(designs, place, named=True)

    warnings = [*scenario.floors, *scenario.unused_impact(), *catalogue.omissions()]
    if place is not None:
        metals = [catalogue.materials[pair].backing for pair in np.flatnonzero(catalogue.metal)]
        warnings += threat_warnings(scenario, designs.rows_of(place).armours, metals)
        warnings += _of_other_pairs(catalogue, warnings)
    warnings += [] if catalogue.sampled else scenario.unused_distributions()
    has_frontier = reason != "none passes"
    is_not_known = shown is not None and verdict_of(row.verdict for row in shown.requirements) == "not known"
    if reason == "none passes" and is_not_known:
        reason, explanation = "not known", f"by the computed limit, {explanation}"
    result = DesignResult(
        minimised=catalogue.section.minimise,
        threats=catalogue.titles,
        best=None if reason else shown,
        reason=reason,
        explanation=explanation,
        nearest=shown if reason else None,
        without_limits=without_limits,
        frontier=(),
        frontier_governed_by=(),
        pairs=pairs,
        criteria=tuple(catalogue.section.pareto or ()),
        designs=len(order),
        runs=search.runs.count,
        warnings=tuple(warnings),
    )
    if place is not None and has_frontier:
        result = _with_frontier(result, designs, search, place, least)
    every = order if len(order) <= MOST_SHOWN else order[:0]
    margins = designs.margins_m_s(every).tolist()
    return replace(
        result,
        runs=search.runs.count,
        every=as_results(designs, every, with_margins=True),
        margins_of_every_m_s=tuple(dict(zip(catalogue.titles, row, strict=True)) for row in margins),
    ).of(_subject(catalogue, is_found=not reason), scenario=scenario)


def _with_frontier(
    result: DesignResult, designs: Designs, search: FreeThicknesses, place: int, least: int
) -> DesignResult:
    """Add the frontier of the design shown and the Pareto front to a result.

    `place` is the place of the design shown; designs on the frontier have at least the verdict `least`.
    """
    catalogue, pair, backings = designs.catalogue, int(designs.columns.pair[place]), designs.columns.backing_mm
    frontier = designs.frontier(place, least)
    frontier_designs = as_results(designs, frontier, with_margins=True)
    without_mm: list[float] = []
    if catalogue.offers[pair].backing.free_range() is None:
        without_mm = np.setdiff1d(designs.frontier_backings(place), backings[frontier]).tolist()
    ceramic_min_mm = next((low for _, name, low, _ in catalogue.ranges(pair) if name == "ceramic"), 0.0) or None
    not_monotonic_mm = designs.not_monotonic_mm(frontier)
    front = _pareto(designs, search, result.criteria, least) if result.criteria else ()
    changing = (*designs.changing(), *((pair, "ceramic", other) for other in not_monotonic_mm))
    warnings = (
        *_untested(result.pairs),
        *_at_the_ends(catalogue, pair, as_results(designs, np.array([place]))[0]),
        *_least_of_the_range(catalogue, pair, frontier_designs, ceramic_min_mm),
        *_changing(search, changing),
    )
    return replace(
        result,
        frontier=frontier_designs,
        frontier_governed_by=tuple(catalogue.titles[threat] for threat in _governing(designs, frontier)),
        pareto=front,
        not_monotonic_mm=not_monotonic_mm,
        ceramic_min_mm=ceramic_min_mm,
        without_mm=tuple(without_mm),
        warnings=(*result.warnings, *warnings),
    )


def effort(scenario: Scenario) -> tuple[int, float]:
    """Return the number of designs on offer, and the estimated time to try each against every threat, s.

    The time is 0 if there are few designs.
    """
    catalogue = catalogue_of(scenario)
    layers = [[np.array(layer.thicknesses()) for layer in offer[:2]] for offer in catalogue.offers]
    count = sum(len(ceramics) * len(backings) for ceramics, backings in layers)
    if count * len(catalogue.threats) < MANY_IMPACTS:
        return count, 0.0
    pair = max(range(len(layers)), key=lambda pair: len(layers[pair][0]) * len(layers[pair][1]))
    some = [values[:: max(len(values) // SOME_THICKNESSES, 1)] for values in layers[pair]]
    rows = catalogue.against_each(catalogue.combinations(pair, *some))
    verdicts_of(catalogue, rows.at(np.arange(len(catalogue.threats))), Runs())  # reads data
    begun = perf_counter()
    verdicts_of(catalogue, rows, Runs())
    return count, (perf_counter() - begun) / (len(some[0]) * len(some[1])) * count


def _table(search: FreeThicknesses, criteria: Sequence[str] = ()) -> Designs:
    """Return the table of designs of a catalogue, see `candidates_of`; of a free thickness, it has the least value."""
    catalogue = search.catalogue
    reliability = Reliability(catalogue, search.runs.on_progress) if catalogue.sampled else None
    return Designs(catalogue, candidates_of(search, criteria), search.runs, reliability)


def _best_place(search: FreeThicknesses) -> tuple[Designs, int | None, Reason]:
    """Return the table of designs, the place of the best design, and the reason if it is not known to pass.

    A design with a ceramic that lacks sources, or on a back plate that may be no metal, is never the best.
    """
    designs = _table(search)
    if not search.catalogue.metal.any():
        return designs, None, "not known" if len(designs.within) else "none passes"
    if (place := _first(designs, designs.offered, PASSES)) is not None:
        return designs, place, ""
    if (search.catalogue.bounded or search.catalogue.scenario.interlayers) and search.catalogue.has_free_layer:
        search.least = NOT_KNOWN
        designs = _table(search)
    if (place := _first(designs, designs.offered, NOT_KNOWN)) is not None:
        return designs, place, "not known"
    passes_by_limit = designs.unsourced.all() and designs.first(designs.offered, NOT_KNOWN) is not None
    return designs, None, "not known" if passes_by_limit else "none passes"


def _first(designs: Designs, where: Ints, least: int) -> int | None:
    """Return the place of the best of some designs with at least the verdict `least`; None if there is none.

    Designs whose model error is known come before the others; ceramics that lack sources are left out.
    """
    return designs.first(designs.ranked(where[~designs.unsourced[where]]), least)


def _unlimited(designs: Designs, search: FreeThicknesses) -> Designs:
    """Return the table of designs without the limits of the section; free thicknesses are searched for anew."""
    if not designs.catalogue.has_free_layer:
        return designs
    unbounded = dict.fromkeys(objective.bound for objective in OBJECTIVES.values())
    section = designs.catalogue.section.model_copy(update=unbounded)
    return _table(replace(search, catalogue=replace(designs.catalogue, section=section)))


def _failure(designs: Designs, search: FreeThicknesses) -> tuple[str, BestDesign | None]:
    """Return why no design passes, and the design that would be the best without the limits, if there is one."""
    catalogue, unlimited = designs.catalogue, _unlimited(designs, search)
    explanation = _why_none(designs, unlimited)
    of_unsourced = designs.offered[designs.unsourced[designs.offered]]
    if (first := designs.first(of_unsourced, NOT_KNOWN)) is not None:
        ceramic = catalogue.offers[designs.columns.pair[first]].ceramic.material
        explanation = f"only {ceramic} would, whose flow stress has fewer than two sources"
    place = _first(unlimited, np.arange(len(unlimited.values)), NOT_KNOWN)
    return explanation, None if place is None else _best(unlimited, place)


def _nearest(designs: Designs, most: int = MOST_COMPARED) -> Ints:
    """Return the places of the designs within the constraints, or nearest to them, the smallest shortfall first.

    The shortfall of a design is the greatest of its shortfalls against the threats; ceramics that lack sources come
    last.
    If there are more than `most` designs, only the thickest ceramic of each pair on each back plate is compared.
    """
    columns, unsourced = designs.columns, designs.unsourced
    violations = designs.catalogue.violations(columns)
    where = np.flatnonzero(violations <= max(float(violations[unsourced == unsourced.min()].min()), 0.0))
    if len(where) > most:
        where = where[np.lexsort((-columns.ceramic_mm[where], columns.backing_mm[where], columns.pair[where]))]
        layers = np.column_stack([columns.pair[where], columns.backing_mm[where]])
        where = where[np.unique(layers, axis=0, return_index=True)[1]]
    short = -designs.slack_m_s(where).min(axis=1)
    return where[np.lexsort((designs.values[where], short, unsourced[where]))]


def _some_of_range(catalogue: Catalogue, pair: int) -> CandidateDesigns:
    """Return the designs of a pair of materials, with `FIRST_VALUES` thicknesses of a free range."""
    layers = [(layer.thicknesses(), layer.free_range()) for layer in catalogue.offers[pair][:2]]
    thicknesses = (np.linspace(mm[0], mm[-1], FIRST_VALUES) if free_range else mm for mm, free_range in layers)
    return catalogue.combinations(pair, *thicknesses)


def _short_pairs(designs: Designs, order: Ints) -> tuple[Pair, ...]:
    """Return each pair of materials with what its nearest design lacks.

    `order` has the places of the nearest designs; a pair without any has one that is farther from the limits.
    """
    catalogue, pairs = designs.catalogue, []
    ordered = designs.columns.pair[order]
    nearest = [(designs, place) for place in order[np.sort(np.unique(ordered, return_index=True)[1])].tolist()]
    for pair in np.setdiff1d(np.flatnonzero(catalogue.metal), ordered).tolist():
        table = Designs(catalogue, _some_of_range(catalogue, pair), designs.runs)
        nearest.append((table, int(_nearest(table, most=0)[0])))
    for table, place in nearest:
        best, unsourced = _best(table, place), bool(table.unsourced[place])
        reason = ": ".join([UNSOURCED] * unsourced + [lacking(best)] * any([*best.short_m_s.values(), best.exceeds]))
        pairs.append(Pair(best.ceramic, best.backing, None, None, reason, not unsourced, best.untested))
    return (*pairs, *(_unlike(catalogue, pair) for pair in np.flatnonzero(~catalogue.metal).tolist()))


def _of_other_pairs(catalogue: Catalogue, warnings: Sequence[str]) -> Iterator[Note]:
    """Yield the caveats of the model about all pairs of materials, except for those that are among `warnings`."""
    told = {note.about for note in warnings if isinstance(note, Note)}
    for pair in np.flatnonzero(catalogue.metal).tolist():
        ceramic_mm = np.array([float(bool(catalogue.offers[pair].ceramic.material))])
        rows = catalogue.against_each(catalogue.candidates(pair, ceramic_mm, np.ones(1)))
        metals, armours = [catalogue.materials[pair].backing], rows.armours
        each_threat = (armours.at([threat]) for threat in range(len(catalogue.threats)))
        by_threat = ((*caveats(each.parameters, metals), *contradicted(each)) for each in each_threat)
        for note, _ in against_each(catalogue.titles, by_threat):
            if note.about not in told:
                told.add(note.about)
                yield Note(note.text, note.key, said="pairs")


def _unlike(catalogue: Catalogue, pair: int) -> Pair:
    """Return a pair whose back plate may be no metal: without a design, but with the reason."""
    offer = catalogue.offers[pair]
    words, names = no_metal(offer.backing_density_kg_m3), (offer.ceramic.material, offer.backing.material)
    return Pair(*names, None, None, f"not known: {words}", untested=catalogue.untested[pair])


def lacking(design: BestDesign) -> str:
    """Describe the shortfall of a design against the threat for which it is the greatest, and its excesses."""
    threat = max(design.short_m_s, key=design.short_m_s.__getitem__)
    short = f"lacks {short_words(design.short_m_s[threat])} against {threat}" if design.short_m_s[threat] else ""
    excess = f"has {'; '.join(excesses(design))}" if design.exceeds else ""
    return f"{armour_in_words(replace(design, untested=False))} {', and '.join(filter(None, (short, excess)))}"


def excesses(design: BestDesign) -> list[str]:
    """Return a phrase for each limit of [design] that a design exceeds, and by how much."""
    units = {objective.bound: objective.unit for objective in OBJECTIVES.values()}
    return [f"{excess:.3g}{units[key]} more than design.{key} allows" for key, excess in design.exceeds.items()]


def short_words(short_m_s: float) -> str:
    """Format a shortfall, such as "44 m/s"; never 0."""
    return f"{short_m_s:.0f} m/s" if short_m_s >= 0.5 else "less than 1 m/s"


def _why_not_known(designs: Designs, place: int | None) -> str:
    """Return why it is not known whether any design passes.

    `place` is that of the best design by the computed limit; None if all designs that stop the threats by this limit
    have a ceramic that lacks sources, or if no back plate is a metal.
    """
    catalogue = designs.catalogue
    if not catalogue.metal.any():
        words = no_metal(catalogue.offers[0].backing_density_kg_m3)
        return words if len(designs.within) else f"no design keeps to the limits of [design]; {words}"
    if place is None:
        pairs = designs.columns.pair[designs.offered[designs.verdicts(designs.offered) >= NOT_KNOWN]]
        names = dict.fromkeys(catalogue.offers[pair].ceramic.material for pair in pairs)
        return (
            f"the flow stress of {listed(list(names))} has fewer than two sources, so no design with it is named best; "
            "name a source of its value and flow_stress_sources_GPa of another, or add own tests (armour calibrate)"
        )
    rows = designs.rows_of(place)
    unknown = np.flatnonzero(required_of(catalogue, rows).unknown).tolist()
    if not unknown:
        return "the interval of a sampled probability contains the one required; raise uncertainty.samples"
    if catalogue.scenario.interlayers:
        return INTERLAYER
    titles = dict[str, list[str]]()
    for i in unknown:
        titles.setdefault(rows.at(np.array([i])).why_error_unknown(), []).append(catalogue.titles[i])
    is_every = len(titles) == 1 and len(unknown) == len(catalogue.titles) > 1
    return "; ".join(
        f"probability of stopping {'every threat' if is_every else listed(names)}: unknown, {why}"
        for why, names in titles.items()
    )


def _untested(pairs: Sequence[Pair]) -> Iterator[str]:
    """Warn of pairs of materials that are ranked after the others, as their model error is not known."""
    names = [
        f"{pair.ceramic} on {pair.backing}"
        for pair in pairs
        if pair.best is not None and not pair.ranked and pair.best.model_error is None
    ]
    if names:
        yield f"the model error is not known for {listed(names)}, ranked after the others; {REMEDY}"


def _changing(search: FreeThicknesses, changes: Sequence[tuple[int, str, float]]) -> Iterator[str]:
    """Warn of each layer of a pair that may fail if it is thicker.

    `changes`, which are added to those of the search, have the pair, the layer and the thickness of the other layer,
    mm.
    """
    changing = search.changing
    for pair, layer, other_mm in changes:
        changing[pair, layer].add(other_mm)
    for (pair, layer), thicknesses in sorted(changing.items()):
        if thicknesses:
            armour = " on ".join(part.material for part in search.catalogue.offers[pair][:2] if part.material)
            words = ", ".join(f"{thickness:.4g}" for thickness in sorted(thicknesses)[:MOST_LISTED])
            omission = " and more" if len(thicknesses) > MOST_LISTED else ""
            yield (
                f"{armour}: a thicker {layer} is perforated at a velocity that a thinner one stops, "
                f"with a {'ceramic' if layer == 'back plate' else 'back plate'} of {words}{omission} mm"
            )


def _at_the_ends(catalogue: Catalogue, pair: int, best: Design) -> Iterator[str]:
    """Warn of each end of a range of thicknesses at which the best design lies."""
    for key, name, low, high in catalogue.ranges(pair):
        thickness = best.ceramic_thickness_mm if name == "ceramic" else best.backing_thickness_mm
        for end, extreme, thinner in ((low, "least", "thinner"), (high, "greatest", "thicker")):
            if thickness == end > 0.0:
                smaller = OBJECTIVES[catalogue.section.minimise].less
                yield (
                    f"{key}: the best design lies at the {extreme} {name} thickness of the range, {end:g} mm; "
                    f"a {thinner} {name} may make the armour {smaller}"
                )


def _least_of_the_range(
    catalogue: Catalogue, pair: int, frontier: Sequence[Design], ceramic_min: float | None
) -> Iterator[str]:
    """Warn if the thinnest ceramic of the range passes: the required thickness is then not known."""
    backings = [design.backing_thickness_mm for design in frontier if design.ceramic_thickness_mm == ceramic_min]
    if backings:
        [key] = [key for key, name, *_ in catalogue.ranges(pair) if name == "ceramic"]
        back_plates = f"back plates of {backings[0]:g} to" if len(backings) > 1 else "a back plate of"
        yield (
            f"{key}: the least ceramic thickness of the range, {ceramic_min:g} mm, passes on {back_plates} "
            f"{backings[-1]:g} mm; less may be required there"
        )


def _pareto(designs: Designs, search: FreeThicknesses, criteria: Sequence[str], least: int) -> tuple[Design, ...]:
    """Return the Pareto front by the given criteria; free thicknesses are refined for each of them."""
    if designs.catalogue.has_free_layer:
        designs = _table(search, criteria)
    return as_results(designs, pareto(designs, criteria, least), with_margins=MARGIN_COLUMN in criteria)


def _governing(designs: Designs, where: Ints) -> list[int]:
    """Return for each design the index of its governing threat, against which it has the smallest slack."""
    return designs.slack_m_s(where).argmin(axis=1).tolist()


def as_results(designs: Designs, where: Ints, *, with_margins: bool = False) -> tuple[Design, ...]:
    """Return the designs at some places of a table as results; their margins are computed only if asked for."""
    catalogue, columns = designs.catalogue, designs.columns.at(where)
    margins = designs.margins_m_s(where).min(axis=1).tolist() if with_margins else [None] * len(where)
    named = ([layer.material for layer in catalogue.offers[pair][:2]] for pair in columns.pair)
    numbers = zip(*(column.tolist() for column in columns[1:5]), strict=True)  # thicknesses, areal density, thickness
    costs = [
        cost if catalogue.costed[pair] else None
        for pair, cost in zip(columns.pair, columns.cost_per_m2.tolist(), strict=True)
    ]
    untested = [catalogue.untested[pair] for pair in columns.pair]
    hulls_mm = columns.backing_mm * (not catalogue.scenario.counts_backing)
    hulls_kg_m2 = hulls_mm * MM * [catalogue.offers[pair].backing_density_kg_m3 for pair in columns.pair]
    whole = (columns.areal_density_kg_m2 + hulls_kg_m2).tolist(), (columns.thickness_mm + hulls_mm).tolist()
    rows = zip(named, numbers, costs, margins, untested, *whole, designs.outside_tests(where), strict=True)
    return tuple(Design(*names, *values, *others) for names, values, *others in rows)


def _best(designs: Designs, place: int, *, named: bool = False) -> BestDesign:
    """Return the design at a place of a table with its ballistic limits and all that is required of it.

    `named` asks, moreover, for the flow stress that a ceramic without tests needs.
    """
    where, catalogue, pair = np.array([place]), designs.catalogue, int(designs.columns.pair[place])
    [design], offer = as_results(designs, where, with_margins=True), catalogue.offers[pair]
    [limits], [slack], [governing] = designs.limits_m_s(where), designs.slack_m_s(where), _governing(designs, where)
    rows = designs.rows_of(place)
    distributions, limit = rows.limit_distributions(limits), float(limits[governing])
    shots, greatest = rows.shot_distributions(limits), rows.errors.greatest.tolist()
    stops = stopped(rows._replace(velocities=rows.velocities + catalogue.margins_m_s), Runs()).tolist()
    sampled = designs.reliability.probabilities(designs.columns, place, quick=False) if designs.reliability else {}
    requirements: list[Requirement] = []
    stopping: dict[str, float | None] = {}
    short: dict[str, float] = {}
    flow_stress: dict[str, NeededFlowStress] = {}
    for i, (threat, limit_m_s) in enumerate(zip(catalogue.threats, limits.tolist(), strict=True)):
        title, estimate = threat.title, sampled.get(threat.title)
        # One by one: for several at once scipy would be imported.
        by_error = float(shots.one(i).probability_above(threat.velocity_m_s))
        chance = (None if isnan(by_error) else by_error) if estimate is None else 1.0 - estimate.value
        armour, ceramic = Parameters(*rows.parameters[i].tolist()), catalogue.materials[pair].ceramic
        required = list(
            against_threat(
                catalogue.scenario,
                threat,
                armour,
                ceramic,
                limit_m_s,
                chance,
                estimate,
                stops=stops[i],
                greatest=greatest[i],
            )
        )
        lacks = (row.required - row.found for row in required if row.quantity == "margin_m_s" and row.found is not None)
        requirements += required
        stopping[title] = None if chance is None else min(chance, greatest[i])
        short[title] = max(-float(slack[i]), 0.0, *lacks)
        if named and chance is None and catalogue.untested[pair]:
            layers = {CERAMIC: design.ceramic_thickness_mm, BACKING: design.backing_thickness_mm}
            scenario, bound = catalogue.against(pair, i).replaced(layers), float(catalogue.bounds[i])
            needed = needed_flow_stress(scenario, threat.required_m_s, 1.0 - bound if bound < NO_BOUND else None)
            flow_stress |= {} if needed is None else {title: needed}
    limits_of_section = tuple(of_armour(catalogue.section, vars(design)))
    searched = catalogue.scenario.ballistic_limit
    ratio = distributions.one(governing).times(1.0 / limit)
    return BestDesign(
        **asdict(design),
        ballistic_limit_m_s=limit if searched.velocity_min_m_s < limit <= searched.velocity_max_m_s else None,
        ceramic_density_kg_m3=offer.ceramic_density_kg_m3,
        backing_density_kg_m3=offer.backing_density_kg_m3,
        margins_m_s=dict(zip(catalogue.titles, (limits - catalogue.velocities_m_s).tolist(), strict=True)),
        governing=catalogue.titles[governing],
        probabilities={
            title: sampled[title].at_least(1.0 - most)
            for title, most in zip(catalogue.titles, greatest, strict=True)
            if title in sampled
        },
        probabilities_of_stopping=stopping,
        model_error=error_of(catalogue.scenario, ratio, rows.armours.at(np.array([governing])), limit),
        short_m_s=short,
        exceeds={
            OBJECTIVES[row.quantity].bound: row.found - row.required
            for row in limits_of_section
            if row.found is not None and row.verdict == "fails"
        },
        requirements=(*requirements, *limits_of_section),
        flow_stress=flow_stress,
    )


def _pairs(designs: Designs, search: FreeThicknesses, best: int | None, least: int) -> tuple[Pair, ...]:
    """Return the pairs of materials, each with its best design: the ranked pairs, best first, then the others.

    `best` is the place of the best design of all pairs, `least` the verdict that the best design of a pair must reach.
    If no design of a pair is known to pass, its best design is the best one by the computed limit.
    """
    catalogue = designs.catalogue
    least_value = inf if best is None else float(designs.values[best])
    greatest = least_value * (1.0 + catalogue.section.runners_up_percent / 100.0)
    possible = [designs.of_pair(pair) for pair in range(len(catalogue.offers))]
    if catalogue.sampled:
        # Only possible runners-up are sampled, as each design takes thousands of impacts.
        possible = [where[designs.values[where] <= greatest] for where in possible]
    best_places = [(designs, designs.first(designs.ranked(where), least)) for where in possible]
    failing = [pair for pair, (_, place) in enumerate(best_places) if place is None and catalogue.metal[pair]]
    if failing and catalogue.bounded:
        search = FreeThicknesses(catalogue, Runs(search.runs.on_progress), NOT_KNOWN)
        by_limit = _table(search) if least == PASSES and catalogue.has_free_layer else designs
        for pair in failing:
            where = by_limit.of_pair(pair)
            best_places[pair] = by_limit, by_limit.first(where[~by_limit.known(where)], NOT_KNOWN, by_samples=False)
    unlimited = _unlimited(designs, search) if any(place is None for _, place in best_places) else designs
    best_is_known = best is not None and bool(designs.known(np.array([best]))[0])
    pairs, few = [], len(catalogue.offers) <= MOST_SHOWN
    for index, (offer, (table, place)) in enumerate(zip(catalogue.offers, best_places, strict=True)):
        if not catalogue.metal[index]:
            pairs.append(_unlike(catalogue, index))
            continue
        design, excess, ranked = None, None, True
        if place is None:
            reason = _why_none(designs, unlimited, index)
        else:
            unsourced = bool(table.unsourced[place])
            untested = best_is_known and not table.known(np.array([place]))[0]
            ranked = not (unsourced or untested)
            design = _best(table, place, named=unsourced or (few and catalogue.untested[index]))
            excess, words = _excess(catalogue.section, float(table.values[place]), least_value, ranked=ranked)
            reason = ": ".join(filter(None, (UNSOURCED if unsourced else NO_TEST_KNOWN if untested else "", words)))
        names = offer.ceramic.material, offer.backing.material
        pairs.append(Pair(*names, design, excess, reason, ranked, catalogue.untested[index]))
    return tuple(sorted(pairs, key=_rank))


def _rank(pair: Pair) -> tuple[bool, bool, float]:
    """Return the sort key of a pair: pairs with a design come first, ranked ones before others, least excess first."""
    excess = pair.excess_percent
    return pair.best is None, not pair.ranked, inf if excess is None else excess


def _excess(section: DesignSection, value: float, least: float, *, ranked: bool) -> tuple[float | None, str]:
    """Return the excess of a value of the objective over the least value, %, and the same in words."""
    objective = OBJECTIVES[section.minimise]
    if value == least:
        return 0.0, ""
    if least == inf:
        return None, ""
    if least <= 0.0:
        return None, objective.more
    excess = 100.0 * (value / least - 1.0)
    if excess < 0.0:
        return excess, f"{-excess:.1f} % {objective.less}"
    runner_up = RUNNER_UP if ranked and excess <= section.runners_up_percent else ""
    return excess, f"{runner_up}{excess:.1f} % {objective.more}"


def _why_none(designs: Designs, unlimited: Designs, pair: int | None = None) -> str:
    """Return why no design, or none of a pair, passes: the limits that the best exceeds, or what the nearest lacks.

    `unlimited` is the table of designs without the limits of the section, see `_unlimited`.
    """
    catalogue, section = designs.catalogue, designs.catalogue.section
    threats = catalogue.titles[0] if len(catalogue.titles) == 1 else "every threat"
    asked = ["the margin"] if catalogue.margins_m_s.any() else []
    required = f" with {joined([*asked, 'the probability'])} required" if catalogue.bounded else ""
    places = np.flatnonzero((unlimited.columns.pair == pair) | (pair is None))
    if (first := unlimited.first(places, NOT_KNOWN, by_samples=False)) is not None:
        is_known = unlimited.verdicts(np.array([first]))[0] == PASSES
        if exceeded := _exceeded(section, unlimited, first, threats + (required if is_known else BY_LIMIT)):
            return exceeded
    if catalogue.sampled and (pair is not None or not asked):
        runners_up = "" if pair is None else f" within {section.runners_up_percent:g} % of the best"
        return f"no design{runners_up} keeps the probability of perforation within the bound of every threat"
    if pair is not None:
        table = Designs(catalogue, _some_of_range(catalogue, pair), Runs(designs.runs.on_progress))
        return lacking(_best(table, int(_nearest(table, most=0)[0])))
    constrained = any(getattr(section, objective.bound) is not None for objective in OBJECTIVES.values())
    thicker = "" if constrained else "; offer thicker layers in [design] or [optimise]"
    return f"no design stops {threats} and all slower impacts{required}{thicker}"


def _exceeded(section: DesignSection, unlimited: Designs, place: int, threats: str) -> str:
    """Describe the limits of the section that the design at a place of `unlimited` exceeds; "" for none.

    `threats` says what this design stops.
    """
    least = OBJECTIVES[section.minimise].least
    [design] = as_results(unlimited, np.array([place]))
    rows = ((row, OBJECTIVES[row.quantity]) for row in of_armour(section, vars(design)) if row.verdict == "fails")
    return "; ".join(
        f"design.{words.bound}: the {least} design that stops {threats} has {row.found:.4g}{words.unit}, "
        f"at most {row.required:g}{words.unit} is allowed"
        for row, words in rows
    )


def _subject(catalogue: Catalogue, *, is_found: bool) -> str:
    """Return the title of a result, such as "Lightest AD85 on 6061-T6 against 7.62 mm AP at 850 m/s"."""
    varied: Varied = {
        NAMES["ceramic"]: [offer.ceramic.material for offer in catalogue.offers],
        NAMES["backing"]: [offer.backing.material for offer in catalogue.offers],
        CERAMIC: (),
        BACKING: (),
    }
    least = OBJECTIVES[catalogue.section.minimise].least
    least = least.capitalize() if is_found else f"Search for the {least}"
    return f"{least} {catalogue.scenario.subject(varied, catalogue.scenario.threat)}"
