"""Design optimisation: the best design that stops every threat, and its comparison with the others."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import chain, groupby
from math import inf
from operator import itemgetter
from typing import Any, Literal

import numpy as np

from armour.analysis.results import OnProgress, TableResult, data_frame, ignore_progress
from armour.analysis.variants import Ints
from armour.design.catalogue import MARGIN_COLUMN, Catalogue, catalogue_of
from armour.design.check import CheckResult, check_of
from armour.design.designs import FAILS, NOT_KNOWN, Designs, Runs
from armour.design.requirements import VERDICTS, Verdict
from armour.design.search import best_place, nearest, pareto
from armour.errors import Note
from armour.scenario.checked import checked
from armour.scenario.inputs import BACKING, CERAMIC, NAMES
from armour.scenario.scenario import Scenario, Varied
from armour.scenario.schema import OBJECTIVES, RequiredProbability
from armour.units import MM

# Most pairs of materials for which the flow stress that a ceramic without tests needs is searched, as it takes time.
MOST_SHOWN = 25
Reason = Literal["", "none passes", "not known"]
# Reason why there is no best design, by the verdict on the nearest; other verdicts give none.
REASONS: dict[Verdict, Reason] = {**dict.fromkeys(VERDICTS[:2], "none passes"), "not known": "not known"}
# Most thicknesses that a warning lists.
MOST_LISTED = 5


@dataclass(frozen=True)
class Design:
    """A design of the catalogue: its layers, what they weigh and cost, and how it stands against the threats.

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
    margin_m_s : float
        Smallest difference between the expected limit or, where no tests tell, that by the model and the velocity, over
        the threats.
    governing : str
        Threat against which the least is left of what is required.
    far_from_tests : tuple of str
        In what the design is far from the tests, against any threat, such as "5083-H3 (tested on 6061-T6)".
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
    margin_m_s: float
    governing: str
    far_from_tests: tuple[str, ...]


@dataclass(frozen=True)
class BestDesign(Design):
    """A design with the check of its armour and what it is short of.

    Attributes
    ----------
    check : CheckResult
        What `armour.check` finds; of the designs of the pairs of materials, without the changes of the armour.
    ceramic_density_kg_m3, backing_density_kg_m3 : float
        Densities of the materials; that of the ceramic is 0 for a bare back plate.
    short_m_s : dict of str to float
        By threat: shortfall of the ballistic limit from the limit required, m/s; the required probability counts if the
        model error is known.
    """

    check: CheckResult
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float
    short_m_s: dict[str, float]

    @property
    def scenario(self) -> Scenario:
        """The scenario with the design as its armour."""
        scenario: Scenario = self.check.question["scenario"]
        return scenario


@dataclass(frozen=True)
class Pair:
    """A ceramic and a metal on offer, with their best design or, without one, the nearest to passing.

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
    """Result of a design optimisation: the best design and those to compare it with.

    Attributes
    ----------
    minimised : str
        Objective: the key of the quantity that is minimised.
    threats : tuple of str
        Names of the threats.
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
        Back plate thicknesses of the frontier at which a thicker ceramic was found to be perforated where a thinner one
        stops the threats, mm.
    notes : tuple of Note
        Caveats about the best design and those of other pairs, and ranges of thicknesses at whose end it lies.
    """

    minimised: str
    threats: tuple[str, ...]
    best: BestDesign | None
    reason: Reason
    nearest: BestDesign | None
    frontier: tuple[Design, ...]
    pairs: tuple[Pair, ...]
    criteria: tuple[str, ...]
    designs: int
    runs: int
    notes: tuple[Note, ...]
    pareto: tuple[Design, ...] = ()
    not_monotonic_mm: tuple[float, ...] = ()

    @property
    def shown(self) -> BestDesign:
        """The best design or, without one, the nearest."""
        shown = self.best or self.nearest
        assert shown is not None
        return shown

    def to_dataframe(self, designs: Literal["frontier", "pareto"] = "frontier") -> Any:
        """Return the frontier or the Pareto front as a data frame of pandas, a design in each row.

        The frontier has the thinnest ceramic that passes on each back plate of the best pair.
        """
        return data_frame(self._columns(designs))

    def _columns(self, designs: str = "frontier") -> dict[str, Any]:
        """Return the attributes of the designs of the "frontier" or of the front "pareto", by name."""
        columns = {item.name: [getattr(each, item.name) for each in getattr(self, designs)] for item in fields(Design)}
        return columns | {"far_from_tests": list(map(", ".join, columns["far_from_tests"]))}


def armour_in_words(design: Design) -> str:
    """Return the layers of a design in words, such as "11 mm AD85 on 6 mm 5083-H3"."""
    layers = (design.ceramic_thickness_mm, design.ceramic), (design.backing_thickness_mm, design.backing)
    return " on ".join(f"{round(thickness, 3):g} mm {name}" for thickness, name in layers if name and thickness)


@checked
def optimise(
    scenario: Scenario, *, probability: RequiredProbability | None = None, on_progress: OnProgress = ignore_progress
) -> DesignResult:
    """Find the best design of a scenario that stops its threats.

    A design passes if it meets all requirements, as `check` judges them, with its lowest ballistic limits.  The impacts
    of all designs are computed: no monotonic dependence is assumed.  If inputs have distributions and a probability is
    required, designs are sampled in the order of the objective.

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
    designs = Designs(catalogue, Runs(on_progress))
    place, least = best_place(designs)  # `least` is the verdict that a design must have to be compared with it
    shown, pair = _checked_design(designs, place), int(designs.columns.pair[place])
    pairs = _pairs_in_order(designs, place, shown, least)
    reason, criteria = REASONS.get(shown.check.verdict, ""), tuple(catalogue.section.pareto or ())
    notes = [*shown.check.notes, *catalogue.omissions(), *_notes_on_other_pairs(shown, pairs)]
    frontier = front = np.empty(0, dtype=np.int64)
    not_monotonic_mm: tuple[float, ...] = ()
    if least > FAILS:
        frontier = designs.frontier(place, least)
        front = pareto(designs, criteria, least) if criteria else front
        backings_mm, failures = designs.columns.backing_mm[frontier], sorted(designs.thicker_failures())
        not_monotonic_mm = tuple(mm for mm in backings_mm.tolist() if (pair, "ceramic", mm) in failures)
        notes += [*_notes_on_range_ends(catalogue, pair, shown), *_notes_on_thicker_failures(catalogue, failures)]
    return DesignResult(
        minimised=catalogue.section.minimise,
        threats=tuple(threat.title for threat in catalogue.threats),
        best=None if reason else shown,
        reason=reason,
        nearest=shown if reason else None,
        frontier=as_results(designs, frontier),
        pairs=pairs,
        criteria=criteria,
        designs=len(designs.offered),
        runs=designs.runs.count,
        notes=tuple(notes),
        pareto=as_results(designs, front),
        not_monotonic_mm=not_monotonic_mm,
    ).of(_subject(catalogue, is_found=not reason), scenario=scenario)


def _notes_on_other_pairs(shown: BestDesign, pairs: Sequence[Pair]) -> Iterator[Note]:
    """Yield the caveats about the best or nearest designs of the other pairs that are not among those of `shown`."""
    told = {note.about for note in shown.check.notes}
    for design in filter(None, (pair.best or pair.nearest for pair in pairs)):
        for note in design.check.notes:
            if note.said in ("caveat", "too low", "detail") and note.about and note.about not in told:
                told.add(note.about)
                yield replace(note, said="detail" if note.said == "detail" else "pairs")


def _notes_on_thicker_failures(catalogue: Catalogue, failures: Sequence[tuple[int, str, float]]) -> Iterator[Note]:
    """Warn of each layer of a pair that may fail if it is thicker, given the sorted `Designs.thicker_failures`."""
    for (pair, layer), found in groupby(failures, key=itemgetter(0, 1)):
        thicknesses = [other_mm for *_, other_mm in found]
        armour = " on ".join(part.material for part in catalogue.offers[pair][:2] if part.material)
        words = ", ".join(f"{thickness:.4g}" for thickness in thicknesses[:MOST_LISTED])
        omission = " and more" if len(thicknesses) > MOST_LISTED else ""
        yield Note(
            f"a thicker {layer} is perforated at a velocity that a thinner one stops, "
            f"with a {'ceramic' if layer == 'back plate' else 'back plate'} of {words}{omission} mm",
            armour,
        )


def _notes_on_range_ends(catalogue: Catalogue, pair: int, best: Design) -> Iterator[Note]:
    """Warn of each end of a range of thicknesses at which the best design lies; `pair` is the index of its pair."""
    smaller = OBJECTIVES[catalogue.section.minimise].less
    for key, name, low, high in catalogue.ranges(pair):
        thickness = best.ceramic_thickness_mm if name == "ceramic" else best.backing_thickness_mm
        for end, extreme, thinner in ((low, "least", "thinner"), (high, "greatest", "thicker")):
            if thickness == end > 0.0:
                yield Note(
                    f"the design lies at the {extreme} {name} thickness of the range, {end:g} mm; "
                    f"a {thinner} {name} may make the armour {smaller}",
                    key,
                )


def as_results(designs: Designs, where: Ints) -> tuple[Design, ...]:
    """Return the designs at some places of a table, with what results say of them."""
    catalogue, columns = designs.catalogue, designs.columns.at(where)
    offers = [catalogue.offers[pair] for pair in columns.pair]
    costs = zip(columns.pair, columns.cost_per_m2.tolist(), strict=True)
    # Of back plates that exist already, which thickness and areal density leave out.
    hulls_mm = columns.backing_mm * (not catalogue.scenario.counts_backing)
    hulls_kg_m2 = hulls_mm * MM * [offer.backing_density_kg_m3 for offer in offers]
    by_name = {
        "ceramic": [offer.ceramic.material for offer in offers],
        "backing": [offer.backing.material for offer in offers],
        "ceramic_thickness_mm": columns.ceramic_mm.tolist(),
        "backing_thickness_mm": columns.backing_mm.tolist(),
        "areal_density_kg_m2": columns.areal_density_kg_m2.tolist(),
        "thickness_mm": columns.thickness_mm.tolist(),
        "cost_per_m2": [cost if catalogue.costed[pair] else None for pair, cost in costs],
        "untested": [catalogue.untested[pair] for pair in columns.pair],
        "whole_areal_density_kg_m2": (columns.areal_density_kg_m2 + hulls_kg_m2).tolist(),
        "whole_thickness_mm": (columns.thickness_mm + hulls_mm).tolist(),
        "margin_m_s": designs.margins_m_s(where).min(axis=1).tolist(),
        "governing": [catalogue.threats[place].title for place in designs.slack_m_s(where).argmin(axis=1)],
        "far_from_tests": [
            tuple(dict.fromkeys(map(str, chain(*by_threat)))) for by_threat in catalogue.far_from_tests(columns)
        ],
    }
    return tuple(Design(**dict(zip(by_name, values, strict=True))) for values in zip(*by_name.values(), strict=True))


def _checked_design(designs: Designs, place: int, *, changes: bool = True, needed: bool = True) -> BestDesign:
    """Return the design at a place of a table with the check of its armour; `changes` and `needed` as in `check_of`."""
    where, catalogue, pair = np.array([place]), designs.catalogue, int(designs.columns.pair[place])
    [design], [slack], offer = as_results(designs, where), designs.slack_m_s(where).tolist(), catalogue.offers[pair]
    thicknesses = {CERAMIC: design.ceramic_thickness_mm, BACKING: design.backing_thickness_mm}
    armour = catalogue.scenario.replaced({**catalogue.materials_in(pair), **thicknesses})
    found = check_of(armour, designs.runs.on_progress, changes=changes, needed=needed)
    short = {}
    for threat, excess in zip(found.threats, slack, strict=True):
        margins = (row for row in threat.requirements if row.quantity == MARGIN_COLUMN and row.found is not None)
        short[threat.threat] = max(-excess, 0.0, *(row.required - (row.found or 0.0) for row in margins))
    return BestDesign(
        **vars(design),
        check=found,
        ceramic_density_kg_m3=offer.ceramic_density_kg_m3,
        backing_density_kg_m3=offer.backing_density_kg_m3,
        short_m_s=short,
    )


def _pairs_in_order(designs: Designs, place: int, shown: BestDesign, least: int) -> tuple[Pair, ...]:
    """Return the pairs of materials in the order of `_pair_order`, each with its best or else its nearest design.

    `place` is that of the design `shown`, and `least` the verdict that the best design of a pair must reach, by
    impacts.  If no design of a pair is known to pass, its best design is the best one by the computed limit.
    """
    catalogue, least_value = designs.catalogue, float(designs.values[place])
    best_is_known = least > FAILS and bool(designs.known(np.array([place]))[0])
    # Only possible runners-up are sampled, as each design takes thousands of impacts.
    greatest_value = least_value * (1.0 + catalogue.section.runners_up_percent / 100.0) if catalogue.sampled else inf
    pairs, few = [], len(catalogue.offers) <= MOST_SHOWN
    for index, offer in enumerate(catalogue.offers):
        found = excess = design = None
        is_known = True
        if least > FAILS:
            possible = designs.of_pair(index)
            found = designs.first(designs.known_first(possible[designs.values[possible] <= greatest_value]), least)
            if found is None:
                found = designs.first(possible[~designs.known(possible)], NOT_KNOWN)
        is_nearest = found is None
        if found is not None:
            excess = 100.0 * (float(designs.values[found]) / least_value - 1.0) if least_value > 0.0 else None
            is_known = not best_is_known or bool(designs.known(np.array([found]))[0])
        elif index == designs.columns.pair[place]:
            found = place
        elif least == FAILS or not catalogue.sampled:
            found = nearest(designs, np.flatnonzero(designs.columns.pair == index), most=0)
        ranked = is_known
        if found is not None:
            needed, ranked = few or bool(designs.unsourced[found]), is_known and not designs.unsourced[found]
            design = shown if found == place else _checked_design(designs, found, changes=False, needed=needed)
        names = offer.ceramic.material, offer.backing.material
        best, nearest_design = (None, design) if is_nearest else (design, None)
        pairs.append(Pair(*names, best, nearest_design, excess, ranked, catalogue.untested[index]))
    return tuple(sorted(pairs, key=_pair_order))


def _pair_order(pair: Pair) -> tuple[bool, bool, float, float]:
    """Return a sort key, lowest for the best pair.

    Pairs with a best design come first, by its objective, then those with a nearest one, by what it exceeds and is
    short of; of each kind, the ranked ones come before the others.
    """
    if pair.best is not None:
        return False, not pair.ranked, 0.0, inf if pair.excess_percent is None else pair.excess_percent
    if pair.nearest is None:
        return True, not pair.ranked, inf, inf
    exceeded = (
        row.found / row.required for row in pair.nearest.check.requirements if row.verdict == "fails" and row.found
    )
    return True, not pair.ranked, max(exceeded, default=0.0), max(pair.nearest.short_m_s.values())


def _subject(catalogue: Catalogue, *, is_found: bool) -> str:
    """Return the title of a result, such as "Lightest AD85 on 6061-T6 against 7.62 mm AP at 850 m/s".

    Unless a design `is_found`, it begins with "Search for".
    """
    varied: Varied = {
        NAMES["ceramic"]: [offer.ceramic.material for offer in catalogue.offers],
        NAMES["backing"]: [offer.backing.material for offer in catalogue.offers],
        CERAMIC: (),
        BACKING: (),
    }
    least = OBJECTIVES[catalogue.section.minimise].least
    least = least.capitalize() if is_found else f"Search for the {least}"
    return f"{least} {catalogue.scenario.subject(varied, catalogue.scenario.threat)}"
