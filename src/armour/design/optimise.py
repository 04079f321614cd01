"""Design optimisation: the best design that stops every threat, and its comparison with the others."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import chain
from math import inf
from time import perf_counter
from typing import Any, Literal

import numpy as np

from armour.analysis.ballistic_limit import NeededFlowStress
from armour.analysis.estimates import Estimate
from armour.analysis.results import OnProgress, TableResult, data_frame, ignore_progress
from armour.analysis.variants import Ints
from armour.design.catalogue import FIRST_VALUES, MARGIN_COLUMN, CandidateDesigns, Catalogue, catalogue_of
from armour.design.check import CheckResult, check_of
from armour.design.designs import FAILS, NOT_KNOWN, PASSES, Designs, Reliability, Runs, verdicts_of
from armour.design.requirements import Requirement, Verdict
from armour.design.search import FreeThicknesses, candidates_of, pareto
from armour.errors import Note, listed
from armour.evidence.caveats import caveats, is_limit_too_low
from armour.evidence.model_error import REMEDY, ModelError
from armour.evidence.tests import against_each, contradicted, threat_warnings
from armour.scenario.checked import checked
from armour.scenario.inputs import BACKING, CERAMIC, NAMES
from armour.scenario.scenario import Scenario, Varied
from armour.scenario.schema import OBJECTIVES, RequiredProbability
from armour.units import MM

# Most pairs of materials for which the needed flow stress is searched; most designs to compare in the search for the
# nearest design.
MOST_SHOWN, MOST_COMPARED = 25, 20_000
Reason = Literal["", "none passes", "not known"]
# Reason why there is no best design, by the verdict on the nearest; other verdicts give none.
REASONS: dict[Verdict, Reason] = {
    "fails": "none passes",
    "perforated by the model": "none passes",
    "not known": "not known",
}
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
    untested : bool
        Whether no test of the ceramic on metal is known.
    whole_areal_density_kg_m2, whole_thickness_mm : float
        The same, including a back plate that exists already.
    far_from_tests : tuple of str
        In what the design is far from the tests, against any threat, such as "5083-H3 (on 6061-T6)".
    """

    ceramic: str
    backing: str
    ceramic_thickness_mm: float
    backing_thickness_mm: float
    areal_density_kg_m2: float
    thickness_mm: float
    cost_per_m2: float | None
    untested: bool
    whole_areal_density_kg_m2: float
    whole_thickness_mm: float
    far_from_tests: tuple[str, ...]


@dataclass(frozen=True)
class DesignOfFront(Design):
    """A design of a Pareto front.

    Attributes
    ----------
    margin_m_s : float or None
        Smallest difference between ballistic limit and velocity over the threats, if it is a criterion of the front.
    """

    margin_m_s: float | None


@dataclass(frozen=True)
class BestDesign(Design):
    """A design with the check of its armour, from which the other attributes are.

    Attributes
    ----------
    check : CheckResult
        What `armour.check` finds; of the designs of the pairs of materials, without the changes of the armour.
    ballistic_limit_m_s : float or None
        By the model, against the governing threat; None if there is none in the range of the search.
    ceramic_density_kg_m3, backing_density_kg_m3 : float
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
        By threat: flow stress that a ceramic without tests needs to stop it.
    requirements : tuple of Requirement
        All that is required of the design, with what it has.
    """

    check: CheckResult
    ballistic_limit_m_s: float | None
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float
    governing: str
    probabilities: dict[str, Estimate]
    probabilities_of_stopping: dict[str, float | None]
    model_error: ModelError | None
    short_m_s: dict[str, float]
    exceeds: dict[str, float]
    flow_stress: dict[str, NeededFlowStress]
    requirements: tuple[Requirement, ...]

    @property
    def scenario(self) -> Scenario:
        """The scenario with the design as its armour."""
        scenario: Scenario = self.check.question["scenario"]
        return scenario


def _changes_to(scenario: Scenario, design: Design, *densities_kg_m3: float) -> dict[str, str | float]:
    """Return the changes, by key, that make a design, given the densities of its materials, the scenario's armour."""
    names = {"ceramic": design.ceramic or None, "backing": design.backing}
    named = {NAMES[role]: name for role, name in names.items() if name and name != scenario.name_of(role)}
    keys = CERAMIC, BACKING, "ceramic.density_kg_m3", "backing.density_kg_m3"
    values = design.ceramic_thickness_mm, design.backing_thickness_mm, *densities_kg_m3
    inputs = scenario.replaced(named).inputs()
    numbers = zip(keys, values, strict=True)
    return {**named, **{key: value for key, value in numbers if inputs.get(key, value) != value}}


@dataclass(frozen=True)
class Pair:
    """A ceramic and a metal, with their best design.

    Attributes
    ----------
    ceramic, backing : str
    best : BestDesign or None
        None if no design of the pair passes, or is among the best by the model's ballistic limit.
    nearest : BestDesign or None
        Without a best design: the nearest, as of a `DesignResult`; None if samples of uncertain inputs would tell.
    excess_percent : float or None
        Excess of its objective over that of the best design of all pairs.
    ranked : bool
        Whether the pair is ranked with the others: not if the model error is unknown for its best design but known for
        the best of all pairs, nor if its ceramic has neither tests nor two sources of its flow stress.
    untested : bool
        Whether no test of the ceramic on metal is known.
    """

    ceramic: str
    backing: str
    best: BestDesign | None
    nearest: BestDesign | None
    excess_percent: float | None
    ranked: bool
    untested: bool


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
        Why there is no best design: none passes, or it is not known whether one passes.
    nearest : BestDesign or None
        Without a best design: the best one of which it is not known whether it passes, those first whose ballistic
        limit by the model is high enough and whose ceramic has tests or two sources; if all fail, the design within
        the limits of the section ``design`` whose greatest shortfall against a threat is the smallest.
    frontier : tuple of Design
        For each back plate thickness of the best pair, the design with the thinnest ceramic that passes, bounds on
        probabilities included; of more than 1,000 thicknesses, only for every second, third, and so on.
    frontier_governed_by : tuple of str
        Governing threat of each design of the frontier.
    pairs : tuple of Pair
        Best first.
    criteria : tuple of str
        Criteria of the Pareto front.
    pareto : tuple of DesignOfFront
        Pareto front; empty if not requested.
    designs : int
        Number of designs that meet the constraints.
    runs : int
        Impacts computed to decide which designs pass, samples of uncertain inputs not counted.
    not_monotonic_mm : tuple of float
        Back plate thicknesses of the frontier at which a thicker ceramic was found not to pass, mm.
    notes : tuple of Note
        Ways in which the best design lies outside the validated range or at an end of a range of thicknesses.
    ceramic_min_mm : float or None
        Least ceramic thickness of the best pair's range, mm: if it passes, less may be required. None if the
        ceramic has no range, or one from zero.
    without_mm : tuple of float
        Back plate thicknesses of the best pair on which no ceramic passes, mm; the frontier leaves them out.
    """

    minimised: str
    threats: tuple[str, ...]
    best: BestDesign | None
    reason: Reason
    nearest: BestDesign | None
    frontier: tuple[Design, ...]
    frontier_governed_by: tuple[str, ...]
    pairs: tuple[Pair, ...]
    criteria: tuple[str, ...]
    designs: int
    runs: int
    notes: tuple[Note, ...]
    pareto: tuple[DesignOfFront, ...] = ()
    not_monotonic_mm: tuple[float, ...] = ()
    ceramic_min_mm: float | None = None
    without_mm: tuple[float, ...] = ()

    @property
    def shown(self) -> BestDesign:
        """The best design or, without one, the nearest."""
        shown = self.best or self.nearest
        assert shown is not None
        return shown

    reported = shown

    def to_dataframe(self, designs: Literal["frontier", "pareto"] = "frontier") -> Any:
        """Return the frontier, or the Pareto front, as a data frame of pandas."""
        return data_frame(self._columns(designs))

    def _columns(self, designs: str = "frontier") -> dict[str, Any]:
        names = [item.name for item in fields(DesignOfFront if designs == "pareto" else Design)]
        columns = {name: [getattr(design, name) for design in getattr(self, designs)] for name in names}
        return columns | {"far_from_tests": list(map(", ".join, columns["far_from_tests"]))}


def armour_in_words(design: Design) -> str:
    """Return the layers of a design, such as "11 mm AD85 on 6 mm 5083-H3"."""
    layers = (design.ceramic_thickness_mm, design.ceramic), (design.backing_thickness_mm, design.backing)
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
    designs, place, least = _best_place(search)
    shown, pair, has_frontier = _best(designs, place), int(designs.columns.pair[place]), least > FAILS
    pairs = _pairs(designs, search, place, shown, least)
    notes = [*scenario.unused_impact(), *catalogue.omissions()]
    metals = [catalogue.materials[each].backing for each in np.flatnonzero(catalogue.metal)]
    notes += threat_warnings(scenario, designs.rows_of(place).armours, metals)
    notes += _of_other_pairs(catalogue, notes)
    notes += [] if catalogue.sampled else scenario.unused_distributions()
    reason, criteria = REASONS.get(shown.check.verdict, ""), tuple(catalogue.section.pareto or ())
    frontier = designs.frontier(place, least) if has_frontier else np.empty(0, dtype=np.int64)
    without_mm, ceramic_min_mm, changes_again = list[float](), None, tuple[float, ...]()
    frontier_designs = as_results(designs, frontier)
    if has_frontier:
        if catalogue.offers[pair].backing.free_range() is None:
            backings = designs.columns.backing_mm[frontier]
            without_mm = np.setdiff1d(designs.frontier_backings(place), backings).tolist()
        ceramic_min_mm = next((low for _, name, low, _ in catalogue.ranges(pair) if name == "ceramic"), 0.0) or None
        changes_again = designs.not_monotonic_mm(frontier)
        notes += [*_untested(pairs), *_at_the_ends(catalogue, pair, shown)]
        notes += _least_of_the_range(catalogue, pair, frontier_designs, ceramic_min_mm)
        notes += _changing(search, (*designs.changing(), *((pair, "ceramic", other) for other in changes_again)))
    return DesignResult(
        minimised=catalogue.section.minimise,
        threats=catalogue.titles,
        best=None if reason else shown,
        reason=reason,
        nearest=shown if reason else None,
        frontier=frontier_designs,
        frontier_governed_by=tuple(catalogue.titles[threat] for threat in _governing(designs, frontier)),
        pairs=pairs,
        criteria=criteria,
        designs=len(designs.offered),
        runs=search.runs.count,
        notes=tuple(notes),
        pareto=_pareto(designs, search, criteria, least) if criteria and has_frontier else (),
        not_monotonic_mm=changes_again,
        ceramic_min_mm=ceramic_min_mm,
        without_mm=tuple(without_mm),
    ).of(_subject(catalogue, is_found=not reason), scenario=scenario)


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


def _best_place(search: FreeThicknesses) -> tuple[Designs, int, int]:
    """Return the table of designs, the place of the best or nearest, and the verdict that impacts give: at least this.

    A design with a ceramic that lacks sources, or on a back plate that may be no metal, is never the best.
    """
    catalogue = search.catalogue
    search.least = NOT_KNOWN if catalogue.scenario.excludes_error() else PASSES
    designs = _table(search)
    if search.least == PASSES:
        if (place := _first(designs, PASSES)) is not None:
            return designs, place, PASSES
        search.least = NOT_KNOWN
        designs = _table(search) if catalogue.has_free_layer else designs
    for unsourced in (False, True):
        if (place := _first(designs, NOT_KNOWN, unsourced=unsourced)) is not None:
            return designs, place, NOT_KNOWN
    if catalogue.has_free_layer:
        columns = CandidateDesigns.joined([_some_of_range(catalogue, pair) for pair in range(len(catalogue.offers))])
        designs = Designs(catalogue, columns, designs.runs, designs.reliability)
    return designs, _nearest(designs), FAILS


def _first(designs: Designs, least: int, *, unsourced: bool = False) -> int | None:
    """Return the place of the best of the designs with at least the verdict `least`; None if there is none.

    They are those with a ceramic that has sources, or that lacks them if `unsourced`.  Designs whose model error is
    known come before the others.
    """
    where = designs.offered[designs.unsourced[designs.offered] == unsourced]
    return designs.first(designs.ranked(where), least)


def _nearest(designs: Designs, most: int = MOST_COMPARED) -> int:
    """Return the place of the design that is nearest to passing, of those within the constraints or nearest to them.

    It is one of which it is not known whether it passes, if there is one: the limit is known to be too low or, last,
    the back plate may be no metal.  Otherwise, its shortfall is the smallest, the greatest of those against the
    threats; ceramics that lack sources come last.  If there are more than `most` designs, only the thickest ceramic of
    each pair on each back plate is compared.
    """
    columns, unsourced, catalogue = designs.columns, designs.unsourced, designs.catalogue
    violations = catalogue.violations(columns)
    where = np.flatnonzero(violations <= max(float(violations[unsourced == unsourced.min()].min()), 0.0))
    if len(where) > most:
        where = where[np.lexsort((-columns.ceramic_mm[where], columns.backing_mm[where], columns.pair[where]))]
        layers = np.column_stack([columns.pair[where], columns.backing_mm[where]])
        where = where[np.unique(layers, axis=0, return_index=True)[1]]
    is_metal = catalogue.metal[columns.pair[where]]
    short, not_known = np.zeros(len(where)), ~is_metal
    slack = designs.slack_m_s(where[is_metal])
    short[is_metal] = -slack.min(axis=1)
    too_low = is_limit_too_low(designs.rows(where[is_metal]).armours.parameters).reshape(slack.shape)
    not_known[is_metal] = (too_low | (slack >= 0.0)).all(axis=1)
    not_known &= violations[where] <= 0.0
    return int(where[np.lexsort((designs.values[where], short, unsourced[where], ~is_metal, ~not_known))[0]])


def _some_of_range(catalogue: Catalogue, pair: int) -> CandidateDesigns:
    """Return the designs of a pair of materials, with `FIRST_VALUES` thicknesses of a free range."""
    layers = [(layer.thicknesses(), layer.free_range()) for layer in catalogue.offers[pair][:2]]
    thicknesses = (np.linspace(mm[0], mm[-1], FIRST_VALUES) if free_range else mm for mm, free_range in layers)
    return catalogue.combinations(pair, *thicknesses)


def _of_other_pairs(catalogue: Catalogue, notes: Sequence[Note]) -> Iterator[Note]:
    """Yield the caveats of the model about all pairs of materials, except for those that are among `notes`."""
    told = {note.about for note in notes}
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


def _untested(pairs: Sequence[Pair]) -> Iterator[Note]:
    """Warn of pairs of materials that are ranked after the others, as their model error is not known."""
    names = [
        f"{pair.ceramic} on {pair.backing}"
        for pair in pairs
        if pair.best is not None and not pair.ranked and pair.best.model_error is None
    ]
    if names:
        yield Note(f"the model error is not known for {listed(names)}, ranked after the others; {REMEDY}")


def _changing(search: FreeThicknesses, changes: Sequence[tuple[int, str, float]]) -> Iterator[Note]:
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
            yield Note(
                f"a thicker {layer} is perforated at a velocity that a thinner one stops, "
                f"with a {'ceramic' if layer == 'back plate' else 'back plate'} of {words}{omission} mm",
                armour,
            )


def _at_the_ends(catalogue: Catalogue, pair: int, best: Design) -> Iterator[Note]:
    """Warn of each end of a range of thicknesses at which the best design lies."""
    for key, name, low, high in catalogue.ranges(pair):
        thickness = best.ceramic_thickness_mm if name == "ceramic" else best.backing_thickness_mm
        for end, extreme, thinner in ((low, "least", "thinner"), (high, "greatest", "thicker")):
            if thickness == end > 0.0:
                smaller = OBJECTIVES[catalogue.section.minimise].less
                yield Note(
                    f"the design lies at the {extreme} {name} thickness of the range, {end:g} mm; "
                    f"a {thinner} {name} may make the armour {smaller}",
                    key,
                )


def _least_of_the_range(
    catalogue: Catalogue, pair: int, frontier: Sequence[Design], ceramic_min: float | None
) -> Iterator[Note]:
    """Warn if the thinnest ceramic of the range passes: the required thickness is then not known."""
    backings = [design.backing_thickness_mm for design in frontier if design.ceramic_thickness_mm == ceramic_min]
    if backings:
        [key] = [key for key, name, *_ in catalogue.ranges(pair) if name == "ceramic"]
        back_plates = f"back plates of {backings[0]:g} to" if len(backings) > 1 else "a back plate of"
        yield Note(
            f"the least ceramic thickness of the range, {ceramic_min:g} mm, holds on {back_plates} "
            f"{backings[-1]:g} mm; less may be required there",
            key,
        )


def _pareto(
    designs: Designs, search: FreeThicknesses, criteria: Sequence[str], least: int
) -> tuple[DesignOfFront, ...]:
    """Return the Pareto front by the given criteria; free thicknesses are refined for each of them."""
    if designs.catalogue.has_free_layer:
        designs = _table(search, criteria)
    where = pareto(designs, criteria, least)
    margins = designs.margins_m_s(where).min(axis=1).tolist() if MARGIN_COLUMN in criteria else [None] * len(where)
    front = zip(as_results(designs, where), margins, strict=True)
    return tuple(DesignOfFront(**vars(design), margin_m_s=margin) for design, margin in front)


def _governing(designs: Designs, where: Ints) -> list[int]:
    """Return for each design the index of its governing threat, against which it has the smallest slack."""
    return designs.slack_m_s(where).argmin(axis=1).tolist()


def as_results(designs: Designs, where: Ints) -> tuple[Design, ...]:
    """Return the designs at some places of a table as results."""
    catalogue, columns = designs.catalogue, designs.columns.at(where)
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
    far = (tuple(dict.fromkeys(chain.from_iterable(by_threat))) for by_threat in catalogue.far_from_tests(columns))
    rows = zip(named, numbers, costs, untested, *whole, far, strict=True)
    return tuple(Design(*names, *values, *others) for names, values, *others in rows)


def _best(designs: Designs, place: int, *, changes: bool = True, needed: bool = True) -> BestDesign:
    """Return the design at a place of a table with the check of its armour, see `check_of`."""
    where, catalogue = np.array([place]), designs.catalogue
    [design], offer = as_results(designs, where), catalogue.offers[designs.columns.pair[place]]
    densities = offer.ceramic_density_kg_m3, offer.backing_density_kg_m3
    armour = catalogue.scenario.replaced(_changes_to(catalogue.scenario, design, *densities))
    found = check_of(armour, designs.runs.on_progress, changes=changes, needed=needed)
    [slack], [governing] = designs.slack_m_s(where).tolist(), _governing(designs, where)
    short = {}
    for threat, excess in zip(found.threats, slack, strict=True):
        margins = (row for row in threat.requirements if row.quantity == "margin_m_s" and row.found is not None)
        short[threat.threat] = max(-excess, 0.0, *(row.required - (row.found or 0.0) for row in margins))
    return BestDesign(
        **vars(design),
        check=found,
        ballistic_limit_m_s=found.threats[governing].ballistic_limit_m_s,
        ceramic_density_kg_m3=densities[0],
        backing_density_kg_m3=densities[1],
        governing=found.threats[governing].threat,
        probabilities={threat.threat: threat.sampled for threat in found.threats if threat.sampled is not None},
        probabilities_of_stopping={threat.threat: threat.probability_of_stopping for threat in found.threats},
        model_error=found.threats[governing].model_error,
        short_m_s=short,
        exceeds={
            OBJECTIVES[row.quantity].bound: row.found - row.required
            for row in found.requirements
            if row.found is not None and row.verdict == "fails"
        },
        flow_stress={threat.threat: threat.flow_stress for threat in found.threats if threat.flow_stress is not None},
        requirements=found.all_requirements(),
    )


def _pairs(designs: Designs, search: FreeThicknesses, place: int, shown: BestDesign, least: int) -> tuple[Pair, ...]:
    """Return the pairs of materials, each with its best design: the ranked pairs, best first, then the others.

    `place` is that of the design shown, and `least` the verdict that the best design of a pair must reach, by impacts.
    If no design of a pair is known to pass, its best design is the best one by the computed limit.
    """
    catalogue = designs.catalogue
    best_places: list[tuple[Designs, int | None]] = [(designs, None)] * len(catalogue.offers)
    least_value, best_is_known = float(designs.values[place]), False
    if least > FAILS:
        best_is_known = bool(designs.known(np.array([place]))[0])
        possible = [designs.of_pair(pair) for pair in range(len(catalogue.offers))]
        if catalogue.sampled:
            # Only possible runners-up are sampled, as each design takes thousands of impacts.
            greatest = least_value * (1.0 + catalogue.section.runners_up_percent / 100.0)
            possible = [where[designs.values[where] <= greatest] for where in possible]
        best_places = [(designs, designs.first(designs.ranked(where), least)) for where in possible]
        failing = [pair for pair, (_, found) in enumerate(best_places) if found is None and catalogue.metal[pair]]
        if failing:
            search = FreeThicknesses(catalogue, Runs(search.runs.on_progress), NOT_KNOWN)
            by_limit = _table(search) if least == PASSES and catalogue.has_free_layer else designs
            for pair in failing:
                where = by_limit.of_pair(pair)
                where = where[~by_limit.known(where)]
                best_places[pair] = by_limit, by_limit.first(where, NOT_KNOWN, by_samples=False)
    pairs, few = [], len(catalogue.offers) <= MOST_SHOWN
    for index, (offer, (table, found)) in enumerate(zip(catalogue.offers, best_places, strict=True)):
        is_nearest, excess, is_known = found is None, None, True
        if found is not None:
            excess = 100.0 * (float(table.values[found]) / least_value - 1.0) if least_value > 0.0 else None
            is_known = not best_is_known or bool(table.known(np.array([found]))[0])
        elif designs.columns.pair[place] == index:
            found = place
        elif least == FAILS or not catalogue.sampled:
            table = Designs(catalogue, _some_of_range(catalogue, index), Runs(search.runs.on_progress))
            found = _nearest(table, most=0)
        design, ranked = None, is_known
        if found is not None:
            needed, ranked = few or bool(table.unsourced[found]), is_known and not table.unsourced[found]
            design = shown if table is designs and found == place else _best(table, found, changes=False, needed=needed)
        names = offer.ceramic.material, offer.backing.material
        best, nearest = (None, design) if is_nearest else (design, None)
        pairs.append(Pair(*names, best, nearest, excess, ranked, catalogue.untested[index]))
    return tuple(sorted(pairs, key=_rank))


def _rank(pair: Pair) -> tuple[bool, bool, float, float]:
    """Return the sort key of a pair: pairs with a design come first, ranked ones before others, the nearest best."""
    if pair.best is not None:
        return False, not pair.ranked, 0.0, inf if pair.excess_percent is None else pair.excess_percent
    if pair.nearest is None:
        return True, not pair.ranked, inf, inf
    exceeded = (
        row.found / row.required for row in pair.nearest.check.requirements if row.verdict == "fails" and row.found
    )
    return True, not pair.ranked, max(exceeded, default=0.0), max(pair.nearest.short_m_s.values())


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
