"""Design optimisation: the best design on offer that defeats every threat, and how the others compare."""

from dataclasses import asdict, dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from armour.analysis.variants import Bools, Ints, grid_of
from armour.design.catalogue import Catalogue
from armour.design.requirement import Requirement
from armour.design.search import MARGIN, Search, candidates_of
from armour.errors import InputError, NoDesignError, Problem
from armour.scenario.applicability import warnings_of
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC

if TYPE_CHECKING:
    from armour.analysis.estimates import Estimate
    from armour.design.reliability import Reliability

COMPARATIVES = {"areal_density_kg_m2": "heavier", "thickness_mm": "thicker", "cost_per_m2": "dearer"}


@dataclass(frozen=True)
class Design:
    """A design on offer.

    Attributes
    ----------
    ceramic, backing : str
        Names of the materials; the ceramic's is empty for a bare back plate.
    ceramic_thickness_mm, backing_thickness_mm : float
    areal_density_kg_m2, thickness_mm, cost_per_m2 : float
        Including what the section ``design`` adds.
    margin_m_s : float or None
        Least ballistic limit less the velocity of a threat, over the threats; None where it is not computed.
    """

    ceramic: str
    backing: str
    ceramic_thickness_mm: float
    backing_thickness_mm: float
    areal_density_kg_m2: float
    thickness_mm: float
    cost_per_m2: float
    margin_m_s: float | None


@dataclass(frozen=True)
class BestDesign(Design):
    """A design that passes, with its ballistic limits.

    Attributes
    ----------
    ballistic_limit_m_s : float or None
        Against the governing threat; None where it lies outside the range of the section ``ballistic_limit``.
    ceramic_density_kg_m3, backing_density_kg_m3 : float
    margins_m_s : dict of str to float
        By threat: the lowest ballistic limit, at most 10,000 m/s, less the velocity of the threat.
    governing : str
        Threat of which the least remains of the margin that it requires.
    probabilities : dict of str to Estimate
        Probabilities of perforation, by threat that bounds it.
    """

    ballistic_limit_m_s: float | None
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float
    margins_m_s: dict[str, float]
    governing: str
    probabilities: "dict[str, Estimate]"


@dataclass(frozen=True)
class Pair:
    """A ceramic and a metal, with their best design.

    Attributes
    ----------
    ceramic, backing : str
    best : BestDesign or None
    excess_percent : float or None
        Excess of the objective over that of the best of all.
    reason : str
        Why the pair loses; empty for the best.
    """

    ceramic: str
    backing: str
    best: BestDesign | None
    excess_percent: float | None
    reason: str


@dataclass(frozen=True)
class DesignResult:
    """Result of a design optimisation.

    Attributes
    ----------
    minimised : str
        Objective.
    threats : tuple of str
    best : BestDesign
    frontier : tuple of Design
        For each back plate of the best pair, the thinnest ceramic that passes, bounds on probabilities aside.
    frontier_governed_by : tuple of str
        Governing threat of each design of the frontier.
    refined : BestDesign or None
        Best design with both layers free within their ranges, where it was asked for.
    pairs : tuple of Pair
        Best first.
    criteria : tuple of str
        Criteria of the Pareto front.
    pareto : tuple of Design
        Pareto front; empty where it was not asked for.
    designs, examined : int
        Number of designs on offer that meet the constraints, and of those that were computed.
    runs : int
        Impacts computed to decide which designs pass, samples of uncertain inputs not counted.
    not_monotonic_mm : tuple of float
        Back plate thicknesses of the frontier at which a thicker ceramic was found not to pass, mm.
    warnings : tuple of str
        Ways in which the best design lies outside the validated range.
    """

    minimised: str
    threats: tuple[str, ...]
    best: BestDesign
    frontier: tuple[Design, ...]
    frontier_governed_by: tuple[str, ...]
    refined: BestDesign | None
    pairs: tuple[Pair, ...]
    criteria: tuple[str, ...]
    pareto: tuple[Design, ...]
    designs: int
    examined: int
    runs: int
    not_monotonic_mm: tuple[float, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data; ``refined`` only where it was asked for."""
        data = asdict(self)
        if self.refined is None:
            del data["refined"]
        return data


def optimise(scenario: Scenario, *, refine: bool = False) -> DesignResult:
    """Find the best design of a scenario that defeats its threats.

    A design passes if it defeats every threat at the threat's velocity plus margin and its lowest ballistic limit does
    not lie below that.  Designs of given thicknesses are examined in the order of the objective until one passes;
    nothing is taken for monotonic.  Where a thickness is free, the least of it that the other layer needs is bisected.
    Under a bound on the probability of perforation, designs that pass are sampled.

    Parameters
    ----------
    scenario : Scenario
        Its sections ``design`` and ``optimise`` give the designs on offer, its list ``threat`` the threats; without
        them, they are the scenario's own pair of materials and impact.
    refine : bool
        Whether to find also the best design with both layers free within their ranges.

    Raises
    ------
    InputError
        If something is missing in the scenario, or a run does not end.
    NoDesignError
        If no design on offer passes.
    """
    catalogue = Catalogue(scenario)
    if refine and catalogue.bounded:
        message = "must be left out where the design is refined, as designs between those on offer are not sampled"
        raise InputError([Problem(scenario.file, "threat.probability_of_perforation", message)])
    requirement = Requirement(catalogue)
    reliability = _reliability(catalogue) if catalogue.bounded else None
    search = Search(requirement, candidates_of(requirement), reliability)
    first = search.first(np.arange(len(search.examined)))
    if first is None:
        raise NoDesignError(_no_design(search))

    best = _best(search, first)
    frontier = search.frontier(int(search.candidates.pair[first]))
    pareto = search.pareto(catalogue.section.pareto) if catalogue.section.pareto is not None else np.empty(0, np.int64)
    with_margins = catalogue.section.pareto is not None and MARGIN in catalogue.section.pareto
    return DesignResult(
        minimised=catalogue.section.minimise,
        threats=tuple(threat.title for threat in catalogue.threats),
        best=best,
        frontier=_designs(search, frontier, with_margins=True),
        frontier_governed_by=tuple(catalogue.threats[i].title for i in _governing(search, frontier).tolist()),
        refined=_refined(requirement, search, first) if refine else None,
        pairs=_pairs(search, first),
        criteria=tuple(catalogue.section.pareto or ()),
        pareto=_designs(search, pareto, with_margins=with_margins),
        designs=len(search.examined),
        examined=int(search.examined.sum()),
        runs=requirement.runs,
        not_monotonic_mm=search.not_monotonic_mm(frontier),
        warnings=warnings_of(*_governed(search, first)),
    )


def _reliability(catalogue: Catalogue) -> "Reliability":
    """Return the bounds on the probability of perforation."""
    from armour.design.reliability import Reliability  # takes half a second to import scipy.stats

    return Reliability(catalogue)


def _refined(requirement: Requirement, search: Search, first: int) -> BestDesign:
    """Find the best design with both layers free; that of the search where none is better."""
    finer = Search(requirement, candidates_of(requirement, refine=True))
    place = finer.first(np.flatnonzero(finer.values < search.values[first]))
    return _best(search, first) if place is None else _best(finer, place)


def _governing(search: Search, where: Ints) -> Ints:
    """Return the threats of which the least remains of the margin that they require."""
    found: Ints = (search.limits(where) - search.catalogue.required_m_s).argmin(axis=1)
    return found


def _governed(search: Search, place: int) -> tuple[Scenario, float]:
    """Return the scenario of a design against its governing threat, and the velocity of that."""
    [threat] = _governing(search, np.array([place])).tolist()
    candidates = search.candidates
    thicknesses = {CERAMIC: float(candidates.ceramic_mm[place]), BACKING: float(candidates.backing_mm[place])}
    posed = search.catalogue.posed(int(candidates.pair[place]), threat).replaced(thicknesses)
    return posed, posed.impact.velocity_m_s


def _designs(search: Search, where: Ints, *, with_margins: bool) -> tuple[Design, ...]:
    """Return designs of a search as results."""
    candidates, offers = search.candidates.at(where), search.catalogue.offers
    margins = search.margins(search.limits(where)).min(axis=1).tolist() if with_margins else [None] * len(where)
    return tuple(
        Design(offers[pair].ceramic.material, offers[pair].backing.material, *numbers)
        for pair, *numbers in zip(*(column.tolist() for column in candidates), margins, strict=True)
    )


def _best(search: Search, place: int) -> BestDesign:
    """Return a design of a search with its ballistic limits."""
    where = np.array([place])
    [design] = _designs(search, where, with_margins=True)
    [limits], [governing] = search.limits(where), _governing(search, where)
    threats = search.catalogue.threats
    offer = search.catalogue.offers[search.candidates.pair[place]]
    section = search.catalogue.settings.ballistic_limit
    limit = float(limits[governing])
    return BestDesign(
        **asdict(design),
        ballistic_limit_m_s=limit if section.velocity_min_m_s < limit <= section.velocity_max_m_s else None,
        ceramic_density_kg_m3=offer.ceramic_density_kg_m3,
        backing_density_kg_m3=offer.backing_density_kg_m3,
        margins_m_s={
            threat.title: margin for threat, margin in zip(threats, search.margins(limits).tolist(), strict=True)
        },
        governing=threats[governing].title,
        probabilities=search.probabilities(place) or {},
    )


def _pairs(search: Search, best: int) -> tuple[Pair, ...]:
    """Compare the best designs of all pairs, best first."""
    least = float(search.values[best])
    most = least * (1.0 + search.catalogue.section.runners_up_percent / 100.0)
    pairs = []
    for index, offer in enumerate(search.catalogue.offers):
        names = offer.ceramic.material, offer.backing.material
        own = search.of_pair(index)
        # Only what can be a runner-up is sampled: each design takes thousands of impacts.
        place = search.first(own[search.values[own] <= most] if search.catalogue.bounded else own)
        if place is None:
            pairs.append(Pair(*names, None, None, _why_none(search, index)))
        else:
            pairs.append(Pair(*names, _best(search, place), *_excess(search, float(search.values[place]), least)))
    return tuple(sorted(pairs, key=lambda pair: inf if pair.excess_percent is None else pair.excess_percent))


def _excess(search: Search, value: float, least: float) -> tuple[float | None, str]:
    """Return the excess of an objective over the least, per cent, and the same in words."""
    section = search.catalogue.section
    comparative = COMPARATIVES[section.minimise]
    if least <= 0.0 < value:
        return None, comparative
    excess = 100.0 * (value / least - 1.0) if least > 0.0 else 0.0
    if excess <= 0.0:
        return excess, ""
    near = "runner-up: " if excess <= section.runners_up_percent else ""
    return excess, f"{near}{excess:.1f} % {comparative}"


def _why_none(search: Search, pair: int) -> str:
    """Return why no design of a pair is found."""
    own = search.of_pair(pair)
    threats = search.catalogue.threats
    if not len(own):
        return "nothing on offer keeps to the limits"
    good = search.examine(own)
    if len(good) and search.catalogue.bounded:
        return f"none within {search.catalogue.section.runners_up_percent:g} % of the best"
    if len(good):
        reached: Bools = np.any(search.reaches(good), axis=0)
        lost = [threat.title for threat, some in zip(threats, reached.tolist(), strict=True) if not some]
        titles = " or ".join(lost) if lost else "all threats at once"
        return f"nothing on offer defeats {titles} at every lower velocity too"
    lost = [threat.title for i, threat in enumerate(threats) if not search.defeats(own, i).any()]
    return f"nothing on offer defeats {' or '.join(lost) if lost else 'all threats at once'}"


def _no_design(search: Search) -> str:
    """Return why no design on offer passes."""
    catalogue, scenario = search.catalogue, search.catalogue.scenario
    if not len(search.examined):
        return "no design: nothing on offer keeps to the limits of the section design"
    good = search.examine(np.arange(len(search.examined)))
    if scenario.design is None and not scenario.threat and not len(good):
        section = grid_of(scenario)
        ceramic, backing = section.ceramic_thickness_mm, section.backing_thickness_mm
        return (
            f"no design: up to {ceramic.max:g} mm of ceramic on {backing.max:g} mm of back plate, all of the grid is "
            f"perforated at {scenario.impact.velocity_m_s:g} m/s; raise the max of optimise.ceramic_thickness_mm "
            "or of optimise.backing_thickness_mm"
        )
    if catalogue.bounded and len(good):
        return "no design: nothing on offer keeps the probability of perforation within the bound of every threat"
    reasons = [_why_none(search, pair) for pair in range(len(catalogue.offers))]
    return f"no design: {'; '.join(dict.fromkeys(reasons))}; offer more thickness in the section design or optimise"
